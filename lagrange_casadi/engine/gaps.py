"""Gaps of loops that do not close: between what ends, and how wide they are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..base.arrays import Array
from ..base.scalars import column
from .joint_closure import carried, held_directions, off
from .multibody import LoopEquations, Multibody
from .substitution import Numbers


@dataclass(frozen=True, eq=False)
class Gap:
    """A loop that does not close.

    ``name`` is that of the joint, the two-force link or the constraint that closes it, which is its
    ``kind``. ``bodies`` are the two that it joins, none of a constraint. ``ends`` (2, 3) are the
    places on these, in ground axes [m], that should be one. ``size`` is how wide the gap is, in its
    ``unit``; that of a constraint is its residual, which has none. ``sentence`` says it in words.
    """

    name: str
    kind: str
    bodies: tuple[str, ...]
    ends: Array
    size: float
    unit: Literal["m", "rad", ""]
    sentence: str


def gap_of(multibody: Multibody, loop: LoopEquations, numbers: Numbers, size: float) -> Gap:
    """The gap of a loop, where coordinates have some numbers, of a mechanism of a ``size`` [m]."""
    if loop.two_force_link is not None:
        bar = loop.two_force_link
        points = [bar.other(joint) for joint in bar.joints]
        bodies = tuple(point.body.name for point in points)
        first, last = (
            np.array(numbers.of(column(multibody.frames[p.body.name].place_of(p.place))))
            for p in points
        )
        (length,) = numbers.of(bar.length)
        along = (last - first) / (np.linalg.norm(last - first) or 1.0)
        ends, angle = np.array([first + length * along, last]), 0.0
    elif loop.joint is not None:
        joint = loop.joint
        parent, child = (multibody.frames[body.name] for body in joint.bodies)
        bodies = tuple(body.name for body in joint.bodies)
        there = carried(joint, parent, child)
        ends = np.array(
            [
                numbers.of(column(parent.place_of(there))),
                numbers.of(column(child.place_of(joint.child.place))),
            ]
        )
        angle = _turned(multibody, loop, numbers)
    else:
        (residual,) = numbers.of(loop.residual)
        return Gap(
            loop.name,
            loop.kind,
            (),
            np.zeros((0, 3)),
            abs(residual),
            "",
            f"constraint '{loop.name}' is {residual:.6g} in place of 0",
        )
    apart = float(np.linalg.norm(ends[1] - ends[0]))
    one, other = bodies
    where = f"at {loop.kind} '{loop.name}'"
    if angle > apart / size:
        sentence = f"{one} and {other} are turned by {math.degrees(angle):.3g} deg too far {where}"
        return Gap(loop.name, loop.kind, bodies, ends, angle, "rad", sentence)
    sentence = f"{one} and {other} are {apart:.3g} m apart {where}"
    return Gap(loop.name, loop.kind, bodies, ends, apart, "m", sentence)


def _turned(multibody: Multibody, loop: LoopEquations, numbers: Numbers) -> float:
    """The angle by which a joint's directions miss what the joint holds [rad]."""
    assert loop.joint is not None
    sines = loop.residual[loop.residual.numel() - held_directions(loop.joint) :]
    frames = [multibody.frames[body.name] for body in loop.joint.bodies]
    turned = off(loop.joint, *frames) if loop.joint.bears_moment else None
    sine = float(np.linalg.norm(numbers.of(sines)))
    if turned is None:
        return math.asin(min(sine, 1.0))
    return math.atan2(sine, 1.0 - numbers.of(turned)[0])
