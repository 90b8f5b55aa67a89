"""Solid shapes as triangles: cylinders, balls, blocks and plates, each with its corners and their
normals.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array

_ROUND, _RINGS = 24, 12


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles between ``places`` (n, 3) [m] with ``normals`` (n, 3) of length 1; ``corners`` (m,
    3) are counter-clockwise.
    """

    places: Array
    normals: Array
    corners: npt.NDArray[np.int64]


def together(meshes: Sequence[Mesh]) -> Mesh:
    """Several as one."""
    starts = np.cumsum([0, *(len(mesh.places) for mesh in meshes)])
    corners = [mesh.corners + start for mesh, start in zip(meshes, starts, strict=False)]
    return Mesh(
        np.concatenate([mesh.places for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate(corners),
    )


def frame_along(inward: Array) -> Array:
    """Three axes at right angles (3, 3), rows, of which the first has a direction."""
    x = inward / np.linalg.norm(inward)
    y = np.cross(np.eye(3)[np.argmin(np.abs(x))], x)
    y /= np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)])


def cylinder(start: Array, stop: Array, radius: float) -> Mesh:
    """A cylinder between two places that are apart, with flat ends."""
    start, stop = np.asarray(start, float), np.asarray(stop, float)
    x, y, z = frame_along(stop - start)
    angles = 2.0 * np.pi * np.arange(_ROUND) / _ROUND
    around = np.cos(angles)[:, None] * y + np.sin(angles)[:, None] * z
    rims = [end + radius * around for end in (start, stop)]
    k, on = np.arange(_ROUND), (np.arange(_ROUND) + 1) % _ROUND
    side = Mesh(
        np.concatenate(rims), np.concatenate([around, around]),
        np.concatenate([np.stack([k, on, on + _ROUND], 1), np.stack([k, on + _ROUND, k + _ROUND],
            1)]),
    )  # fmt: skip
    return together([_outward(side), plate(rims[0][::-1], -x), plate(rims[1], x)])


def cone(start: Array, tip: Array, radius: float) -> Mesh:
    """A cone from the middle of its base to its tip."""
    start, tip = np.asarray(start, float), np.asarray(tip, float)
    x, y, z = frame_along(tip - start)
    height = float(np.linalg.norm(tip - start))

    k = np.arange(_ROUND)
    angles = 2.0 * np.pi * np.concatenate([k, k + 0.5])[:, None] / _ROUND
    rim, between = np.split(np.cos(angles) * y + np.sin(angles) * z, 2)
    # The tip is there once for each side, for each has a direction of its own.
    normals = np.concatenate([height * rim + radius * x, height * between + radius * x]) / np.hypot(
        height, radius
    )
    places = np.concatenate([start + radius * rim, np.tile(tip, (_ROUND, 1))])
    side = Mesh(places, normals, np.stack([k, (k + 1) % _ROUND, k + _ROUND], 1))
    return together([_outward(side), plate((start + radius * rim)[::-1], -x)])


def arrow(heads: int) -> Mesh:
    """An arrow along x from 0 to 1: of a force with one head, of a moment with two."""
    ahead = np.eye(3)[0]
    ends = [1.0 - 0.16 * k for k in range(heads)]
    shaft = cylinder(np.zeros(3), (ends[-1] - 0.16) * ahead, 0.018)
    return together([shaft, *(cone((end - 0.16) * ahead, end * ahead, 0.05) for end in ends)])


def sphere(centre: Array, radius: float) -> Mesh:
    """A ball."""
    up, around = np.meshgrid(
        np.linspace(0.0, np.pi, _RINGS + 1), 2.0 * np.pi * np.arange(_ROUND) / _ROUND, indexing="ij"
    )
    normals = np.stack(
        [np.sin(up) * np.cos(around), np.sin(up) * np.sin(around), np.cos(up)], -1
    ).reshape(-1, 3)
    ring, k = (
        part.ravel() for part in np.meshgrid(np.arange(_RINGS), np.arange(_ROUND), indexing="ij")
    )
    a, b = ring * _ROUND + k, ring * _ROUND + (k + 1) % _ROUND
    lower, upper = (
        np.stack([a, a + _ROUND, b + _ROUND], 1)[ring < _RINGS - 1],
        np.stack([a, b + _ROUND, b], 1)[ring > 0],
    )
    return _outward(
        Mesh(np.asarray(centre, float) + radius * normals, normals, np.concatenate([lower, upper]))
    )


def block(centre: Array, axes: Array, sides: Sequence[float]) -> Mesh:
    """A block with so long sides along its axes (3, 3), rows."""
    faces = []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for sign in (1.0, -1.0):
            out, a, b = (
                sign * axes[i] * sides[i] / 2,
                axes[j] * sides[j] / 2,
                sign * axes[k] * sides[k] / 2,
            )
            faces.append(
                plate(
                    np.asarray(centre, float) + out + np.array([-a - b, a - b, a + b, -a + b]),
                    sign * axes[i],
                )
            )
    return together(faces)


def prism(corners: Array, thickness: float) -> Mesh:
    """A polygon (n, 3) that lies in a plane, all of its edge seen from its middle, made as thick as
    that.
    """
    corners = np.asarray(corners, float)
    normal = sum(
        np.cross(a - corners[0], b - corners[0]) for a, b in itertools.pairwise(corners[1:])
    )
    normal = np.asarray(normal) / np.linalg.norm(normal)
    top, bottom = corners + normal * thickness / 2, corners - normal * thickness / 2
    sides = []
    for k in range(len(corners)):
        on = (k + 1) % len(corners)
        inward = np.cross(corners[on] - corners[k], normal)
        sides.append(
            plate(
                np.array([bottom[k], bottom[on], top[on], top[k]]), inward / np.linalg.norm(inward)
            )
        )
    return together([plate(top, normal), plate(bottom[::-1], -normal), *sides])


def plate(corners: Array, normal: Array) -> Mesh:
    """A flat polygon, all of its edge seen from its middle, and from where its normal points to."""
    places = np.vstack([np.mean(corners, axis=0), corners])
    k = np.arange(1, len(places))
    fan = np.stack([np.zeros_like(k), k, np.roll(k, -1)], 1)
    return _outward(Mesh(places, np.tile(np.asarray(normal, float), (len(places), 1)), fan))


def _outward(mesh: Mesh) -> Mesh:
    """Turn every triangle counter-clockwise, seen from outside."""
    a, b, c = (mesh.places[mesh.corners[:, k]] for k in range(3))
    inward = np.sum(np.cross(b - a, c - a) * mesh.normals[mesh.corners].sum(axis=1), axis=1) < 0.0
    return Mesh(
        mesh.places, mesh.normals, np.where(inward[:, None], mesh.corners[:, ::-1], mesh.corners)
    )
