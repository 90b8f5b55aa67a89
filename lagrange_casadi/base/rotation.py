"""Rotations as the directions of turned axes; one about the ground's z alone is known by its cosine
and sine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from .scalars import less, product, products_added, products_less
from .vectors import AXES, Expression, Vector, cross, dot, plus, times


@dataclass(frozen=True, eq=False)
class Rotation:
    """The directions ``x`` and ``y`` of turned axes, in the axes that they are turned from.

    ``angle`` is there for those who count turns: that about z, of a rotation about z alone; any
    other has None. ``third`` is the direction of the third axis where it is known in a shorter way
    than from the other two.
    """

    x: Vector = AXES[0]
    y: Vector = AXES[1]
    angle: Expression | None = 0.0
    third: Vector | None = None

    @classmethod
    def flat(cls, c: Expression, s: Expression, angle: Expression) -> Rotation:
        """The rotation about z with a cosine and a sine, by an angle [rad]."""
        return cls((c, s, 0.0), (-s, c, 0.0), angle)

    @classmethod
    def by(cls, angle: Expression) -> Rotation:
        """The rotation about z by an angle [rad]; a number within rounding of a right angle is
        meant to be one.
        """
        return cls.flat(*direction(angle), angle)

    @classmethod
    def about(cls, axis: Vector, c: Expression, s: Expression, angle: Expression) -> Rotation:
        """The rotation about an axis of length 1 by an angle [rad] with a cosine and a sine
        (Rodrigues).
        """
        if _same(axis, AXES[2]):
            return cls.flat(c, s, angle)
        # Linear in cosine and sine, by which loops are known that have a closed form.
        x, y, z = (
            plus(
                plus(times(c, e), times(s, cross(axis, e))),
                times(product(less(1, c), dot(axis, e)), axis),
            )
            for e in AXES
        )
        return cls(x, y, None, z)

    @classmethod
    def of(cls, x: Vector, y: Vector) -> Rotation:
        """The rotation that turns the axes x and y there."""
        return cls() if _same(x, AXES[0]) and _same(y, AXES[1]) else cls(x, y, None)

    @property
    def c(self) -> Expression:
        """Cosine of a rotation about z."""
        return self.x[0]

    @property
    def s(self) -> Expression:
        """Sine of a rotation about z."""
        return self.x[1]

    @cached_property
    def z(self) -> Vector:
        """The direction of the third axis."""
        return self.third or (AXES[2] if self.angle is not None else cross(self.x, self.y))

    def apply(self, v: Vector) -> Vector:
        """Components in the axes turned from of a vector given in the turned axes."""
        if self.angle is not None:
            return (
                products_less(self.c, v[0], self.s, v[1]),
                products_added(self.s, v[0], self.c, v[1]),
                v[2],
            )
        x, y, z = (
            times(component, axis)
            for component, axis in zip(v, (self.x, self.y, self.z), strict=True)
        )
        return plus(plus(x, y), z)

    def resolve(self, v: Vector) -> Vector:
        """Components in the turned axes of a vector given in the axes turned from."""
        if self.angle is not None:
            return (
                products_added(self.c, v[0], self.s, v[1]),
                products_less(self.c, v[1], self.s, v[0]),
                v[2],
            )
        return dot(self.x, v), dot(self.y, v), dot(self.z, v)

    def then(self, other: Rotation) -> Rotation:
        """The rotation followed by another, which is given in the axes turned by this one."""
        if self.angle is not None and other.angle is not None:
            c, s, _ = self.apply(other.x)
            return Rotation.flat(c, s, self.angle + other.angle)
        return Rotation(self.apply(other.x), self.apply(other.y), None, self.apply(other.z))

    def against(self, other: Rotation) -> Rotation:
        """The direction as seen from another."""
        if self.angle is not None and other.angle is not None:
            c, s, _ = other.resolve(self.x)
            return Rotation.flat(c, s, self.angle - other.angle)
        return Rotation(other.resolve(self.x), other.resolve(self.y), None, other.resolve(self.z))

    @property
    def inverse(self) -> Rotation:
        """The rotation back."""
        if self.angle is not None:
            return Rotation.flat(self.c, -self.s, -self.angle)
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = self.x, self.y, self.z
        return Rotation((xx, yx, zx), (xy, yy, zy), None, (xz, yz, zz))


def direction(angle: Expression) -> tuple[Expression, Expression]:
    """Cosine and sine of an angle [rad]; a number within rounding of a right angle is meant to be
    one.
    """
    if isinstance(angle, ca.SX):
        return ca.cos(angle), ca.sin(angle)
    c, s = math.cos(angle), math.sin(angle)
    return 0.0 if abs(c) < 2e-16 else c, 0.0 if abs(s) < 2e-16 else s


def _same(a: Vector, b: Vector) -> bool:
    """Return whether vectors are numbers, and equal."""
    return all(isinstance(one, float) and one == other for one, other in zip(a, b, strict=True))
