"""The arm by vector Newton-Euler in ground axes, an instant at a time, tip to base: the reference
of errors.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .arm_data import AXES, GRAVITY, LENGTHS, MASSES, SECOND, UPRIGHT, motion
from .paper_case import Array


def efforts(t: Array) -> Array:
    """Efforts of the joints, (6, t)."""
    rows = [_instant(*row)[0] for row in zip(*(x.T for x in motion(t)), strict=True)]
    return np.asarray(np.array(rows).T)


def sections(t: Array, xi: Array) -> Array:
    """Six section forces of the second link, (6, t, xi)."""
    rows = [
        [_instant(*row)[1](ratio) for ratio in xi]
        for row in zip(*(x.T for x in motion(t)), strict=True)
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def resultants(t: Array, xi: Array) -> Array:
    """The sizes of shear and of bending, (2, t, xi)."""
    _, shear_y, shear_z, _, bending_y, bending_z = sections(t, xi)
    return np.stack([np.hypot(shear_y, shear_z), np.hypot(bending_y, bending_z)])


def _instant(q: Array, v: Array, a: Array) -> tuple[list[Any], Callable[[float], Array]]:
    """Efforts, and what gives the second link's section forces at a ratio."""
    frame, rate, turn, base = np.eye(3), np.zeros(3), np.zeros(3), -np.array(GRAVITY)
    links = []
    for k, axis in enumerate(AXES):
        own = frame @ axis
        turn, rate = turn + own * a[k] + np.cross(rate, own * v[k]), rate + own * v[k]
        frame = frame @ _rotation(np.array(axis), q[k]) @ (UPRIGHT if k == 0 else np.eye(3))
        along = LENGTHS[k] * frame[:, 0]
        links.append((own, frame, base, _accelerated(along, rate, turn), along))
        base = base + links[-1][3]
    force, moment = np.zeros(3), np.zeros(3)
    found: list[Any] = []
    piece: tuple[Any, ...] = ()
    for k in reversed(range(len(links))):
        own, frame, base, gained, along = links[k]
        if k == SECOND:
            piece = (frame, base, gained, along, MASSES[k], force, moment)
        # Of a slender link: mass times the mean acceleration, and its first moment about the base.
        moment = (
            moment + np.cross(along, force) + MASSES[k] * np.cross(along, base / 2 + gained / 3)
        )
        force = force + MASSES[k] * (base + gained / 2)
        found.append(own @ moment)
    return found[::-1], lambda ratio: _section(ratio, *piece)


def _section(
    ratio: float,
    frame: Array,
    base: Array,
    gained: Array,
    along: Array,
    mass: float,
    force: Array,
    moment: Array,
) -> Array:
    """What the piece beyond a ratio does to the rest: less what it needs."""
    left, middle = 1 - ratio, (1 + ratio) / 2
    own = mass * left * (base + middle * gained)
    first = (
        left**2 / 2
    )  # of the places from the section on, and with the acceleration's growth along the link
    second = (1 - ratio**3) / 3 - ratio * (1 - ratio**2) / 2
    about = (
        moment
        + np.cross(left * along, force)
        + mass * np.cross(along, first * base + second * gained)
    )
    return -np.concatenate([frame.T @ (force + own), frame.T @ about])


def _accelerated(r: Array, rate: Array, turn: Array) -> Array:
    return np.asarray(np.cross(turn, r) + np.cross(rate, np.cross(rate, r)))


def _rotation(axis: Array, angle: float) -> Array:
    x, y, z = axis
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across)
