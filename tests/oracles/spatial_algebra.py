"""Vectors, turns and linear equations in space."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from arithmetic import TOLERANCE

_LEAST = 1e-9
_VAGUE = (1e-11, 1e-6)
_PASSES = 60


def vector(values):
    """Numbers of any kind, strings among them, as doubles."""
    return np.array(values, dtype=float)


def cross(a, b):
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def skew(a):
    """The matrix of ``a x``."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def unit(a):
    length = math.sqrt(a @ a)
    assert length > 0, "a direction has a length"
    return a / length


def turn(axis, angle):
    """The rotation about a unit ``axis``."""
    k, c, s = skew(axis), math.cos(angle), math.sin(angle)
    return np.eye(3) + k * s + k @ k * (1 - c)


def small_turn(d):
    """An exact rotation near the one by the small vector ``d`` (Cayley's)."""
    k = skew(d / 2)
    return np.eye(3) + (k + k @ k) * (2 / (1 + (d @ d) / 4))


def orthonormal(matrix):
    """A right-handed matrix of unit columns at right angles, of one that is so nearly."""
    columns = vector(matrix).T
    x = unit(columns[0])
    y = unit(columns[1] - x * (x @ columns[1]))
    z = cross(x, y)
    for given, column in zip(columns, (x, y, z), strict=True):
        assert max(abs(given - column)) < 1e-4, (
            "an orientation is three unit columns at right angles, right-handed"
        )
    return np.array([x, y, z]).T


def angle_about(axis, a, b):
    """The angle from ``a`` to ``b`` about a unit ``axis``."""
    return math.atan2(axis @ np.cross(a, b), a @ b - (axis @ a) * (axis @ b))


class InconsistentError(AssertionError):
    """Equations that no unknowns fulfil."""


@dataclass(frozen=True)
class Factored:
    """A matrix with its pseudo-inverse, its rows and columns in comparable units.

    ``null`` spans what the matrix sends to zero, in those units; ``vague`` where a singular value
    is neither zero nor clearly another number; ``least`` is the smallest one that is not zero.
    """

    matrix: np.ndarray
    inverse: np.ndarray
    null: np.ndarray
    vague: bool
    least: float

    @classmethod
    def of(cls, matrix, row_units, column_units):
        """``row_units`` divide rows, ``column_units`` multiply columns."""
        scaled = matrix / row_units[:, None] * column_units
        left, values, right = np.linalg.svd(scaled)
        largest = values[0] if values.size and values[0] else 1.0
        rank = int(np.sum(values > _LEAST * largest))
        inverse = (right[:rank].T / values[:rank]) @ left[:, :rank].T
        values = values / largest
        return cls(
            matrix,
            column_units[:, None] * inverse / row_units,
            right[rank:].T,
            bool(np.any((values > _VAGUE[0]) & (values < _VAGUE[1]))),
            float(values[rank - 1]) if rank else 0.0,
        )

    def solve(self, right, complaint):
        """The unknowns for a right side. Raises :class:`InconsistentError` where there are none."""
        found, before = np.zeros(self.matrix.shape[1]), None
        if not found.size or not right.size:
            return found
        for _ in range(_PASSES):
            step = self.inverse @ (right - self.matrix @ found)
            found = found + step
            size = max(abs(step))
            if size <= TOLERANCE * max(abs(found)) / 100 or (
                before is not None and size >= before / 2
            ):
                break
            before = size
        left = max(abs(right - self.matrix @ found))
        terms = np.max(np.abs(self.matrix) @ np.abs(found)) + max(abs(right))
        if left > 1000 * TOLERANCE * terms:
            raise InconsistentError(complaint)
        return found
