"""Poses, velocities and accelerations of bodies.

A plane is space without its z: what is zero there is zero by structure.

An extra mobility *displaces* what it moves: a translation in ground axes and a rotation about a
point, small and at rest, whose generalized force is the action of the fixed side on the displaced
side. Only its rates are ever needed, see :mod:`.lagrange`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import casadi as ca

from .rotation import Rotation
from .scalars import added, as_expression, less, product, products_added, products_less
from .vectors import ZERO, Expression, Vector, minus, nil, plus

_UNTURNED = Rotation()


@dataclass(frozen=True, eq=False)
class Frame:
    """Direction and motion of a body: it turns by ``rotation`` at ``rate``, and its point
    ``anchor`` is at ``at`` with ``speed``.

    ``acceleration`` is the anchor's; ``rate`` is the angular velocity in ground axes, ``angular``
    its change. The anchor is the joint that holds the body, so what sits there moves with the joint
    exactly, without a lever that cancels.

    In space ``carried`` is the motion in axes at rest that lie along the body's own at the instant,
    by the same anchor: there levers are short and a turn keeps a component. ``rotations`` lead to
    it from the ground. After a single one, about an axis of the ground's, the motion is as short in
    the ground's axes, where others want it too.
    """

    at: Vector = ZERO
    speed: Vector = ZERO
    acceleration: Vector = ZERO
    rotation: Rotation = _UNTURNED
    rate: Vector = ZERO
    angular: Vector = ZERO
    anchor: Vector = ZERO
    carried: Frame | None = None
    rotations: int = 0

    def place_of(self, point: Vector) -> Vector:
        """The place of the body's point."""
        return plus(self.at, self._lever(point))

    def motion_of(self, point: Vector) -> tuple[Vector, Vector]:
        """Velocity and acceleration of the body's point."""
        return self._motion(self._lever(point))

    def motion_at(self, place: Vector) -> tuple[Vector, Vector]:
        """Velocity and acceleration of the body's point at a place."""
        return self._motion(minus(place, self.at))

    def local(self, place: Vector) -> Vector:
        """The body's point at a place."""
        return plus(self.anchor, self.rotation.resolve(minus(place, self.at)))

    def displaced(self, translation: Vector, turning: Vector) -> Frame:
        """The frame displaced at the anchor, by the rates of a translation and of a rotation."""
        local = self.carried and self.carried.displaced(
            self.rotation.resolve(translation), self.rotation.resolve(turning)
        )
        return replace(
            self, speed=plus(self.speed, translation), rate=plus(self.rate, turning), carried=local
        )

    def displaced_along(self, translation: Vector, turning: Vector) -> Frame:
        """Displacement by rates in the body's own axes."""
        there = self.displaced(self.rotation.apply(translation), self.rotation.apply(turning))
        return replace(there, carried=self.shortest.displaced(translation, turning))

    @property
    def shortest(self) -> Frame:
        """The motion of the body in those axes at rest in which it is shortest."""
        return self.carried if self.carried is not None and self.rotations > 1 else self

    def along_axis(self) -> Frame:
        """The body at its origin, seen in axes at rest that lie along its own at the instant."""
        seen = self.shortest
        speed, acceleration = (seen.rotation.resolve(v) for v in seen.motion_of(ZERO))
        rate, angular = seen.rotation.resolve(seen.rate), seen.rotation.resolve(seen.angular)
        return Frame(speed=speed, acceleration=acceleration, rate=rate, angular=angular)

    def _lever(self, point: Vector) -> Vector:
        return self.rotation.apply(minus(point, self.anchor))

    @cached_property
    def _squares(self) -> tuple[Vector, Vector]:
        """The products of two components of the rate: of y and z, z and x, x and y; and the sums of
        squares of those two.
        """
        x, y, z = self.rate
        xx, yy, zz = product(x, x), product(y, y), product(z, z)
        return (product(y, z), product(z, x), product(x, y)), (
            added(yy, zz),
            added(zz, xx),
            added(xx, yy),
        )

    def _motion(self, r: Vector) -> tuple[Vector, Vector]:
        """Velocity and acceleration of what a lever leads to; the latter is that of the anchor and
        ([alpha] + w w' - w^2) r.
        """
        (x, y, z), (ax, ay, az), (yz, zx, xy), (xc, yc, zc) = (
            self.rate,
            self.angular,
            *self._squares,
        )
        u, v, w = self.speed
        a, b, c = self.acceleration
        return (
            (
                less(u, products_less(z, r[1], y, r[2])),
                added(v, products_less(z, r[0], x, r[2])),
                less(w, products_less(y, r[0], x, r[1])),
            ),
            (
                less(
                    a,
                    less(
                        products_added(xc, r[0], less(az, xy), r[1]), product(added(ay, zx), r[2])
                    ),
                ),
                added(
                    b,
                    less(products_less(added(az, xy), r[0], yc, r[1]), product(less(ax, yz), r[2])),
                ),
                less(
                    c,
                    added(
                        products_less(less(ay, zx), r[0], added(ax, yz), r[1]), product(zc, r[2])
                    ),
                ),
            ),
        )


@dataclass(frozen=True, eq=False)
class Velocities:
    """Velocities that energies and powers are written in, as :class:`.LagrangeSystem` takes them.

    What is at rest by structure, and stays so, has no symbol, and is zero.
    """

    symbols: list[Any] = field(default_factory=list)
    graphs: list[Any] = field(default_factory=list)
    rates: list[Any] = field(default_factory=list)
    forces: list[Any] = field(default_factory=list)

    def vector(self, motion: tuple[Vector, Vector], force: Vector = ZERO) -> Expression:
        """The symbols of a velocity that moves so, of a point or of a direction, with the force
        that works along it.
        """
        speed, acceleration = motion
        return ca.vertcat(
            *(self.number(*entry) for entry in zip(speed, acceleration, force, strict=True))
        )

    def number(self, rate: Expression, angular: Expression, couple: Expression = 0.0) -> Expression:
        """The symbol of a rate, with what works along it."""
        if nil(rate) and nil(angular):
            return ca.SX(0)
        self.symbols.append(ca.SX.sym(f"w{len(self.symbols)}"))
        for column, entry in ((self.graphs, rate), (self.rates, angular), (self.forces, couple)):
            column.append(as_expression(entry))
        return self.symbols[-1]
