"""Vectors over instants, (3, t), in plain arithmetic: (3, 1) where they are the same throughout.

Axes are their three directions, (3, 3, t).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array

_ACROSS = np.cross(np.eye(3)[:, None], np.eye(3)).reshape(3, 9)
"""Vector products of each direction with all three."""

_NEXT, _LAST = np.roll(np.arange(3), -1), np.roll(np.arange(3), 1)


def constant(values: npt.ArrayLike) -> Array:
    """A vector or axes that are the same throughout."""
    return np.asarray(values, float)[..., None]


NIL = constant(np.zeros(3))
"""The vector of nothing."""

GROUND = constant(np.eye(3))
"""Axes that are not turned."""


def size(vector: Array) -> Array:
    """Lengths (..., t) of vectors (..., 3, t); no square of a component under- or overflows."""
    x, y, z = (vector[..., k, :] for k in range(3))
    found = np.hypot(x, y)
    return np.asarray(np.hypot(found, z) if z.any() else found)  # in a plane at half the cost


def dot(a: Array, b: Array) -> Array:
    """The scalar product (..., t)."""
    return np.asarray((a * b).sum(axis=-2))


def cross(a: Array, b: Array) -> Array:
    """The vector product."""
    first, second = a.take(_NEXT, -2) * b.take(_LAST, -2), a.take(_LAST, -2) * b.take(_NEXT, -2)
    return np.asarray(first - second)


def across(vectors: Array) -> Array:
    """Axes (..., 3, 3, t) that turn what is given on them into the vector product with it."""
    return np.asarray(_ACROSS.T @ vectors).reshape(*vectors.shape[:-2], 3, 3, -1)


def turn(axes: Array, vector: Array) -> Array:
    """Vectors, (..., 3, t), that are given on axes; or other axes."""
    return np.asarray(np.einsum("kit,...kt->...it", axes, vector))


def resolve(axes: Array, vector: Array) -> Array:
    """Vectors, (..., 3, t), on axes."""
    return np.asarray(np.einsum("kit,...it->...kt", axes, vector))


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
