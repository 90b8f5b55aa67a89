"""Poses and velocities in the plane, and what joints and links look like there.

Directions are carried as (cosine, sine) pairs. A *displacement* is an extra mobility: a translation in ground axes and a
rotation about a point, small and at rest, whose generalized force is the action of the fixed side on the displaced side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import casadi as ca

from .parts import Expression, Joint

Pair = tuple[Any, Any]


@dataclass(frozen=True, eq=False)
class Rotation:
    """A direction, as its cosine and sine; the angle itself is there for those who count turns."""

    c: Expression = 1.0
    s: Expression = 0.0
    angle: Expression = 0.0

    @classmethod
    def by(cls, angle: Expression) -> Rotation:
        """The rotation by an angle [rad]; a number within rounding of a right angle is meant to be one."""
        if isinstance(angle, ca.SX):
            return cls(ca.cos(angle), ca.sin(angle), angle)
        c, s = math.cos(angle), math.sin(angle)
        return cls(0.0 if abs(c) < 2e-16 else c, 0.0 if abs(s) < 2e-16 else s, angle)

    def apply(self, x: Expression, y: Expression) -> Pair:
        """Components in the ground's axes of a vector given in the rotated axes."""
        return self.c * x - self.s * y, self.s * x + self.c * y

    def resolve(self, x: Expression, y: Expression) -> Pair:
        """Components in the rotated axes of a vector given in the ground's axes."""
        return self.c * x + self.s * y, self.c * y - self.s * x

    def then(self, other: Rotation) -> Rotation:
        """This rotation followed by another."""
        return Rotation(*self.apply(other.c, other.s), self.angle + other.angle)

    def against(self, other: Rotation) -> Rotation:
        """This direction as seen from another."""
        return Rotation(*other.resolve(self.c, self.s), self.angle - other.angle)

    @property
    def inverse(self) -> Rotation:
        """The rotation back."""
        return Rotation(self.c, -self.s, -self.angle)


@dataclass(frozen=True, eq=False)
class Displacement:
    """The symbols of an extra mobility: two translations and, where ``rotates``, a rotation; and their rates."""

    symbols: Any
    rates: Any

    @classmethod
    def named(cls, name: str, *, rotates: bool) -> Displacement:
        """Fresh symbols."""
        size = 3 if rotates else 2
        return cls(ca.SX.sym(f"e_{name}", size), ca.SX.sym(f"ed_{name}", size))

    @property
    def rotates(self) -> bool:
        """Whether it turns what it displaces."""
        return bool(self.symbols.numel() == 3)


@dataclass(frozen=True, eq=False)
class Frame:
    """Direction and motion of a body: it turns by ``rotation`` at ``rate``, and its point ``anchor`` is at ``at`` with ``speed``.

    The anchor is the joint that holds the body, so what sits there moves with the joint exactly, without a lever that cancels.
    """

    at: Pair = (0.0, 0.0)
    speed: Pair = (0.0, 0.0)
    rotation: Rotation = Rotation()
    rate: Expression = 0.0
    anchor: Pair = (0.0, 0.0)

    def place_of(self, x: Expression, y: Expression) -> Pair:
        """The place of the body's point (x, y)."""
        rx, ry = self._lever(x, y)
        return self.at[0] + rx, self.at[1] + ry

    def speed_of(self, x: Expression, y: Expression) -> Pair:
        """The velocity of the body's point (x, y)."""
        rx, ry = self._lever(x, y)
        return self.speed[0] - self.rate * ry, self.speed[1] + self.rate * rx

    def local(self, place: Pair) -> Pair:
        """The body's point at a place."""
        x, y = self.rotation.resolve(place[0] - self.at[0], place[1] - self.at[1])
        return self.anchor[0] + x, self.anchor[1] + y

    def displaced(self, displacement: Displacement, x: Expression, y: Expression, drift: Pair = (0.0, 0.0)) -> Frame:
        """This frame displaced, a rotation being about its point (x, y), which moves in the frame with ``drift``."""
        e, ed = displacement.symbols, displacement.rates
        at, speed = self.place_of(x, y), self.speed_of(x, y)
        rotation, rate = self.rotation, self.rate
        if displacement.rotates:
            rotation, rate = rotation.then(Rotation(1.0, e[2], e[2])), rate + ed[2]
            across = self.rotation.apply(-drift[1], drift[0])
            speed = (speed[0] - e[2] * across[0], speed[1] - e[2] * across[1])
        return Frame((at[0] + e[0], at[1] + e[1]), (speed[0] + ed[0], speed[1] + ed[1]), rotation, rate, (x, y))

    def _lever(self, x: Expression, y: Expression) -> Pair:
        return self.rotation.apply(x - self.anchor[0], y - self.anchor[1])


@dataclass(frozen=True, eq=False)
class Moments:
    """Mass, first moment along and beside the axis, and second moment of a body or a piece of one, about its origin."""

    mass: Expression
    first: Expression = 0.0
    second: Expression = 0.0
    beside: Expression = 0.0

    def kinetic(self, frame: Frame) -> Any:
        """Kinetic energy (paper eq. 16), linear in the moments."""
        nx, ny = frame.rotation.apply(-self.beside, self.first)
        vx, vy = frame.speed_of(0.0, 0.0)
        return self.mass * (vx * vx + vy * vy) / 2 + frame.rate * (vx * nx + vy * ny) + self.second * frame.rate * frame.rate / 2

    def force_function(self, frame: Frame, gravity: Pair) -> Any:
        """Work of gravity (paper eq. 18), linear in the moments."""
        ex, ey = frame.rotation.apply(self.first, self.beside)
        x, y = frame.place_of(0.0, 0.0)
        return gravity[0] * (self.mass * x + ex) + gravity[1] * (self.mass * y + ey)

    def without(self, piece: Moments) -> Moments:
        """What is left when a piece on the axis is taken off."""
        return Moments(self.mass - piece.mass, self.first - piece.first, self.second - piece.second, self.beside)


def slide(joint: Joint, parent: Frame, child: Frame) -> Pair:
    """Along and across the axis of a joint that slides: where the child's point is, in the parent's axes."""
    x, y = parent.local(child.place_of(joint.child.x, joint.child.y))
    dx, dy = x - joint.parent.x, y - joint.parent.y
    ax, ay = joint.axis
    return dx * ax + dy * ay, dy * ax - dx * ay


def closure(joint: Joint, parent: Frame, child: Frame) -> Any:
    """Phi of a joint that closes a loop (paper eq. 5): gaps in ground axes or across a line, and of direction where it is held.

    The multipliers of Phi are the action of the parent on the child along these gaps.
    """
    if joint.slides:
        gaps = [ca.SX(slide(joint, parent, child)[1])]
    else:
        a, b = child.place_of(joint.child.x, joint.child.y), parent.place_of(joint.parent.x, joint.parent.y)
        gaps = [ca.SX(a[0] - b[0]), ca.SX(a[1] - b[1])]
    if joint.holds_direction:
        gaps.append(ca.SX(child.rotation.against(parent.rotation.then(Rotation.by(joint.angle))).s))
    return ca.vertcat(*gaps)


def reaction(joint: Joint, parent: Frame, action: Any, *, closing: bool) -> dict[str, Any]:
    """The reaction by member, from the generalized forces ``action`` of its mobility, or of Phi where it closes a loop.

    What slides bears no force along its axis: what its mobility feels there is the drive's, not the joint's.
    """
    if joint.slides:
        nx, ny = parent.rotation.apply(-joint.axis[1], joint.axis[0])
        normal = action[0] if closing else action[0] * nx + action[1] * ny
        members = {"fx": normal * nx, "fy": normal * ny}
    else:
        members = {"fx": action[0], "fy": action[1]}
    if joint.holds_direction:
        members["mz"] = action[1 if closing and joint.slides else 2]
    return members
