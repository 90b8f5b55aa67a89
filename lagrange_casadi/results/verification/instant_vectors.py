"""Vectors over instants, in plain arithmetic: each component is an array (t,), or a number where it
is the same throughout.

A component that is the number 0.0 is zero by structure, and nothing is computed with it. So what
lies in a plane costs what it would with two components.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

Scalar = Any
"""An array (t,), or a number."""


def total(a: Scalar, b: Scalar) -> Scalar:
    """Return a + b."""
    if type(a) is float and a == 0.0:
        return b
    return a if type(b) is float and b == 0.0 else a + b


def less(a: Scalar, b: Scalar) -> Scalar:
    """Return a - b."""
    if type(b) is float and b == 0.0:
        return a
    return -b if type(a) is float and a == 0.0 else a - b


def product(a: Scalar, b: Scalar) -> Scalar:
    """Return a b."""
    if type(a) is float:
        if a == 0.0 or a == 1.0:
            return b if a else 0.0
    elif type(b) is float and (b == 0.0 or b == 1.0):
        return a if b else 0.0
    return a * b


@dataclass(slots=True, eq=False)
class Vector:
    """Three components."""

    __array_ufunc__ = None
    """An array by a vector is a vector."""

    x: Scalar
    y: Scalar
    z: Scalar

    def __add__(self, other: Vector) -> Vector:
        if self is NIL:
            return other
        if other is NIL:
            return self
        return Vector(total(self.x, other.x), total(self.y, other.y), total(self.z, other.z))

    def __sub__(self, other: Vector) -> Vector:
        if other is NIL:
            return self
        return Vector(less(self.x, other.x), less(self.y, other.y), less(self.z, other.z))

    def __neg__(self) -> Vector:
        return Vector(less(0.0, self.x), less(0.0, self.y), less(0.0, self.z))

    def __rmul__(self, factor: Scalar) -> Vector:
        if self is NIL:
            return NIL
        return Vector(product(factor, self.x), product(factor, self.y), product(factor, self.z))

    def dot(self, other: Vector) -> Scalar:
        """The scalar product."""
        return total(
            total(product(self.x, other.x), product(self.y, other.y)), product(self.z, other.z)
        )

    def cross(self, other: Vector) -> Vector:
        """The vector product."""
        if self is NIL or other is NIL:
            return NIL
        x, y, z, u, v, w = self.x, self.y, self.z, other.x, other.y, other.z
        return Vector(
            less(product(y, w), product(z, v)),
            less(product(z, u), product(x, w)),
            less(product(x, v), product(y, u)),
        )

    @property
    def size(self) -> Scalar:
        """The length; no square of a component under- or overflows."""
        found: Scalar = 0.0
        for component in (self.x, self.y, self.z):
            if not (type(component) is float and component == 0.0):
                found = (
                    np.abs(component)
                    if type(found) is float and found == 0.0
                    else np.hypot(found, component)
                )
        return found

    @property
    def components(self) -> tuple[Scalar, Scalar, Scalar]:
        """All three."""
        return self.x, self.y, self.z


NIL = Vector(0.0, 0.0, 0.0)
"""The vector of nothing."""


@dataclass(slots=True, eq=False)
class Axes:
    """The directions of turned axes."""

    x: Vector
    y: Vector
    z: Vector

    @classmethod
    def about(cls, axis: Vector, angle: Scalar) -> Axes:
        """The ground's axes turned about a fixed axis, of length 1, by an angle (Rodrigues)."""
        c, s = np.cos(angle), np.sin(angle)

        def turned(direction: Vector) -> Vector:
            along = axis.dot(direction) * axis
            found: Vector = along + c * (direction - along) + s * axis.cross(direction)
            return found

        return cls(turned(GROUND.x), turned(GROUND.y), turned(GROUND.z))

    @classmethod
    def of(cls, rows: Sequence[Sequence[Scalar]]) -> Axes:
        """Three directions, of three numbers each."""
        x, y, z = rows
        return GROUND if rows == _IDENTITY else cls(Vector(*x), Vector(*y), Vector(*z))

    def turn(self, vector: Vector) -> Vector:
        """A vector that is given on these axes."""
        if self is GROUND or vector is NIL:
            return vector
        found = NIL
        for component, axis in zip(vector.components, (self.x, self.y, self.z), strict=True):
            if not (type(component) is float and component == 0.0):
                found = found + component * axis
        return found

    def resolve(self, vector: Vector) -> Vector:
        """A vector on these axes."""
        if self is GROUND or vector is NIL:
            return vector
        return Vector(self.x.dot(vector), self.y.dot(vector), self.z.dot(vector))

    def carry(self, other: Axes) -> Axes:
        """Other axes that are given on these."""
        if self is GROUND:
            return other
        if other is GROUND:
            return self
        return Axes(self.turn(other.x), self.turn(other.y), self.turn(other.z))

    def under(self, other: Axes) -> Axes:
        """Other axes on these."""
        if self is GROUND:
            return other
        return Axes(self.resolve(other.x), self.resolve(other.y), self.resolve(other.z))

    @property
    def inverse(self) -> Axes:
        """The ground's axes on these."""
        (a, b, c), (d, e, f), (g, h, i) = self.x.components, self.y.components, self.z.components
        return Axes(Vector(a, d, g), Vector(b, e, h), Vector(c, f, i))

    def off(self, other: Axes) -> Scalar:
        """The largest difference of a component from that of other axes."""
        residuals = (self.x - other.x, self.y - other.y, self.z - other.z)
        return most(component for residual in residuals for component in residual.components)


_IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

GROUND = Axes(*(Vector(*row) for row in _IDENTITY))
"""Axes that are not turned."""


def most(values: Iterable[Scalar]) -> Scalar:
    """The largest size among numbers and arrays, at each instant."""
    found: Scalar = 0.0
    for value in values:
        if not (type(value) is float and value == 0.0):
            size = np.abs(value)
            found = size if type(found) is float and found == 0.0 else np.maximum(found, size)
    return found
