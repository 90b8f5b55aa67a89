"""Vectors over instants in plain arithmetic: (3, t), or (3, 1) where they are the same throughout.
In a plane places and forces have x and y, (2, t), and what turns has z, (1, t).

Axes are the directions of them, (3, 3, t) or (2, 2, t).
"""

from __future__ import annotations

from functools import reduce

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array

_ACROSS = {
    1: np.array([[[0.0], [1.0]], [[-1.0], [0.0]]]),
    3: np.moveaxis(np.cross(np.eye(3)[:, None], np.eye(3)), 0, -1),
}
"""Vector products of each direction about which something turns with all axes, by their number."""

_PAIRS = {1: np.array([[0], [0]]), 2: np.array([[0], [1]]), 3: np.array([[1, 2, 0], [2, 0, 1]])}
"""The components of which each component of a vector product is made, by the number of those."""


def constant(values: npt.ArrayLike) -> Array:
    """A vector or axes that are the same throughout."""
    return np.asarray(values, float)[..., None]


NIL = np.zeros((1, 1))
"""The vector of nothing, with any number of components."""


def size(vector: Array) -> Array:
    """Lengths (..., t) of vectors (..., 3, t); no square of a component under- or overflows."""
    rows = [vector[..., k, :] for k in range(vector.shape[-2])]
    return np.asarray(reduce(np.hypot, rows) if rows[1:] else np.abs(rows[0]))


def dot(a: Array, b: Array) -> Array:
    """The scalar product (..., t)."""
    return np.asarray((a * b).sum(axis=-2))


def cross(a: Array, b: Array) -> Array:
    """The vector product of places or forces, or of what turns: in a plane none of the latter."""
    one, other = _PAIRS[max(a.shape[-2], b.shape[-2])]
    # Of nothing there is one component, which is taken for all.
    first = a.take(one, -2, mode="clip") * b.take(other, -2, mode="clip")
    return np.asarray(first - a.take(other, -2, mode="clip") * b.take(one, -2, mode="clip"))


def across(vectors: Array) -> Array:
    """Axes (..., 3, 3, t) that turn what is given on them into the vector product with it."""
    terms = _ACROSS[vectors.shape[-2]]
    found = terms.reshape(-1, terms.shape[-1]) @ vectors
    return np.asarray(found).reshape(*vectors.shape[:-2], *terms.shape[:2], -1)


def turn(axes: Array, vector: Array) -> Array:
    """Vectors, (..., 3, t), that are given on axes; or other axes. In a plane couples stay."""
    return np.einsum("kit,...kt->...it", axes, vector) if vector.shape[-2] == len(axes) else vector


def resolve(axes: Array, vector: Array) -> Array:
    """Vectors, (..., 3, t), on axes. In a plane couples stay."""
    there = vector.shape[-2] == axes.shape[-2]
    return np.asarray(np.einsum("kit,...it->...kt", axes, vector)) if there else vector


def about(direction: Array, angle: Array) -> Array:
    """The ground's axes turned about a fixed direction, (3, 1) of length 1, by an angle
    (Rodrigues).
    """
    moves = across(direction)[..., 0]
    off = -moves @ moves  # the share of each axis that is at right angles to the direction
    parts = np.array([np.eye(len(moves)) - off, off, moves])
    shares = np.array([np.ones_like(angle), np.cos(angle), np.sin(angle)])
    return np.asarray(parts.reshape(3, -1).T @ shares).reshape(*moves.shape, -1)


def most(values: npt.ArrayLike) -> Array:
    """The largest size among numbers (..., t), at each instant."""
    rows = np.abs(values)
    return np.asarray(rows.reshape(-1, rows.shape[-1]).max(axis=0))
