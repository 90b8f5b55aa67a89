"""Vectors over instants, (3, t), in plain arithmetic: (3, 1) where they are the same throughout.

Axes are their three directions, (3, 3, t).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array

_ACROSS = np.cross(np.eye(3)[:, None], np.eye(3)).reshape(3, 9)
"""Vector products of each direction with all three."""


def constant(values: npt.ArrayLike) -> Array:
    """A vector or axes that are the same throughout."""
    return np.asarray(values, float)[..., None]


NIL = constant(np.zeros(3))
"""The vector of nothing."""

GROUND = constant(np.eye(3))
"""Axes that are not turned."""


def size(vector: Array) -> Array:
    """The length (t,); no square of a component under- or overflows."""
    x, y, z = vector
    found = np.hypot(x, y)
    return np.asarray(np.hypot(found, z) if z.any() else found)  # in a plane at half the cost


def dot(a: Array, b: Array) -> Array:
    """The scalar product (t,)."""
    return np.asarray((a * b).sum(axis=0))


def cross(a: Array, b: Array) -> Array:
    """The vector product."""
    (x, y, z), (u, v, w) = a, b
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def turn(axes: Array, vector: Array) -> Array:
    """A vector that is given on axes."""
    return np.asarray(np.einsum("kit,kt->it", axes, vector))


def resolve(axes: Array, vector: Array) -> Array:
    """A vector on axes."""
    return np.asarray(np.einsum("kit,it->kt", axes, vector))


def carry(axes: Array, other: Array) -> Array:
    """Other axes that are given on axes."""
    return np.asarray(np.einsum("kit,jkt->jit", axes, other))


def about(direction: npt.ArrayLike, angle: Array) -> Array:
    """The ground's axes turned about a fixed direction, of length 1, by an angle (Rodrigues)."""
    along = np.multiply.outer(direction, direction).ravel()
    parts = np.array([along, np.eye(3).ravel() - along, np.dot(direction, _ACROSS)])
    shares = np.array([np.ones_like(angle), np.cos(angle), np.sin(angle)])
    return np.asarray(parts.T @ shares).reshape(3, 3, -1)


def most(values: npt.ArrayLike) -> Array:
    """The largest size among numbers (..., t), at each instant."""
    rows = np.abs(values)
    return np.asarray(rows.reshape(-1, rows.shape[-1]).max(axis=0))
