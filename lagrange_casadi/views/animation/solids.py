"""Solids as triangles: bodies of revolution, prisms and plates, with normals at their corners."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ..shapes.poses import frame_along

_ROUND = 20


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles between ``places`` (n, 3) [m] with ``normals`` (n, 3) of length 1; ``corners`` (m,
    3) are counter-clockwise, seen from outside.
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


def revolved(start: Array, axis: Array, profile: Sequence[tuple[float, float]]) -> Mesh:
    """The body of revolution about an ``axis`` from ``start``, whose profile has these distances
    along the axis and radii [m].
    """
    frame = frame_along(np.asarray(axis, float))
    k, on = np.arange(_ROUND), (np.arange(_ROUND) + 1) % _ROUND
    angles = 2.0 * np.pi * k / _ROUND
    first = np.stack([k, on, on + _ROUND], 1)
    second = np.stack([k, on + _ROUND, k + _ROUND], 1)

    def around(along: float, radius: float) -> Array:
        ring = np.stack([along + 0.0 * k, radius * np.cos(angles), radius * np.sin(angles)], 1)
        return np.asarray(ring @ frame)

    bands = []
    for (x, r), (x2, r2) in itertools.pairwise(profile):
        normals = np.tile(around(r - r2, x2 - x) / np.hypot(x2 - x, r2 - r), (2, 1))
        places = np.asarray(start, float) + np.concatenate([around(x, r), around(x2, r2)])
        corners = [first] * (r > 0.0) + [second] * (r2 > 0.0)
        bands.append(Mesh(places, normals, np.concatenate(corners)))
    return together(bands)


def cylinder(start: Array, stop: Array, radius: float) -> Mesh:
    """A cylinder between two places that are apart."""
    way = np.subtract(stop, start)
    length = float(np.linalg.norm(way))
    return revolved(start, way, [(0.0, 0.0), (0.0, radius), (length, radius), (length, 0.0)])


def arrow(heads: int) -> Mesh:
    """An arrow along x from 0 to 1: of a force with one head, of a moment with two."""
    tips = [1.0 - 0.16 * k for k in reversed(range(heads))]
    cones = [ring for tip in tips for ring in ((tip - 0.16, 0.05), (tip, 0.0))]
    shaft = [(0.0, 0.0), (0.0, 0.018), (tips[0] - 0.16, 0.018)]
    return revolved(np.zeros(3), np.eye(3)[0], [*shaft, *cones])


def sphere(centre: Array, radius: float) -> Mesh:
    """A ball."""
    turns = np.linspace(np.pi, 0.0, 10)[1:-1]
    rings = [(radius * float(np.cos(one)), radius * float(np.sin(one))) for one in turns]
    found = revolved(centre, np.eye(3)[0], [(-radius, 0.0), *rings, (radius, 0.0)])
    return Mesh(found.places, (found.places - centre) / radius, found.corners)


def block(centre: Array, axes: Array, sides: Sequence[float]) -> Mesh:
    """A block with so long sides along its axes (3, 3), rows."""
    a, b = axes[1] * sides[1] / 2, axes[2] * sides[2] / 2
    return prism(centre + np.array([-a - b, a - b, a + b, b - a]), sides[0])


def prism(corners: Array, thickness: float) -> Mesh:
    """A polygon (n, 3) that lies in a plane, all of its edge seen from its middle, made as thick as
    that.
    """
    normal = sum(
        np.cross(a - corners[0], b - corners[0]) for a, b in itertools.pairwise(corners[1:])
    )
    normal = np.asarray(normal) / np.linalg.norm(normal)
    top, bottom = corners + normal * thickness / 2, corners - normal * thickness / 2
    sides = [np.array([bottom[k - 1], bottom[k], top[k], top[k - 1]]) for k in range(len(corners))]
    faces = [_plate(side, np.cross(side[1] - side[0], normal)) for side in sides]
    return together([_plate(top, normal), _plate(bottom[::-1], -normal), *faces])


def _plate(corners: Array, outward: Array) -> Mesh:
    """A flat polygon, counter-clockwise about a direction ``outward`` across it, all of its edge
    seen from its middle.
    """
    places = np.vstack([np.mean(corners, axis=0), corners])
    k = np.arange(1, len(places))
    fan = np.stack([np.zeros_like(k), k, np.roll(k, -1)], 1)
    return Mesh(places, np.tile(outward / np.linalg.norm(outward), (len(places), 1)), fan)
