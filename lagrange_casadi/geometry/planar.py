"""Poses, velocities and accelerations in the plane, and what joints look like there.

Directions are carried as (cosine, sine) pairs. An extra mobility *displaces* what it moves: a translation in ground axes and a
rotation about a point, small and at rest, whose generalized force is the action of the fixed side on the displaced side. Only
its rates are ever needed, see :mod:`.lagrange`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca

from ..declare.parts import Expression, Joint

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
class Frame:
    """Direction and motion of a body: it turns by ``rotation`` at ``rate``, and its point ``anchor`` is at ``at`` with ``speed``.

    ``acceleration`` is the anchor's, ``angular`` the rate's change. The anchor is the joint that holds the body, so what sits there
    moves with the joint exactly, without a lever that cancels.
    """

    at: Pair = (0.0, 0.0)
    speed: Pair = (0.0, 0.0)
    acceleration: Pair = (0.0, 0.0)
    rotation: Rotation = Rotation()
    rate: Expression = 0.0
    angular: Expression = 0.0
    anchor: Pair = (0.0, 0.0)

    def place_of(self, x: Expression, y: Expression) -> Pair:
        """The place of the body's point (x, y)."""
        rx, ry = self._lever(x, y)
        return self.at[0] + rx, self.at[1] + ry

    def motion_of(self, x: Expression, y: Expression) -> tuple[Pair, Pair]:
        """Velocity and acceleration of the body's point (x, y)."""
        return self._motion(*self._lever(x, y))

    def motion_at(self, place: Pair) -> tuple[Pair, Pair]:
        """Velocity and acceleration of the body's point at a place."""
        return self._motion(place[0] - self.at[0], place[1] - self.at[1])

    def local(self, place: Pair) -> Pair:
        """The body's point at a place."""
        x, y = self.rotation.resolve(place[0] - self.at[0], place[1] - self.at[1])
        return self.anchor[0] + x, self.anchor[1] + y

    def displaced(self, rates: Any) -> Frame:
        """This frame displaced at the anchor, by the rates of two translations and, where there are three, a rotation."""
        speed = (self.speed[0] + rates[0], self.speed[1] + rates[1])
        return replace(self, speed=speed, rate=self.rate + rates[2] if rates.numel() == 3 else self.rate)

    def about_anchor(self) -> Frame:
        """The body as it turns about its anchor, which rests."""
        return replace(self, at=(0.0, 0.0), speed=(0.0, 0.0), acceleration=(0.0, 0.0))

    def along_axis(self) -> Frame:
        """The body at its origin, seen in axes at rest that lie along its own at the instant."""
        speed, acceleration = (self.rotation.resolve(*v) for v in self.motion_of(0.0, 0.0))
        return Frame(speed=speed, acceleration=acceleration, rate=self.rate, angular=self.angular)

    def _lever(self, x: Expression, y: Expression) -> Pair:
        return self.rotation.apply(x - self.anchor[0], y - self.anchor[1])

    def _motion(self, rx: Expression, ry: Expression) -> tuple[Pair, Pair]:
        centripetal = self.rate * self.rate
        return (
            (self.speed[0] - self.rate * ry, self.speed[1] + self.rate * rx),
            (
                self.acceleration[0] - (centripetal * rx + self.angular * ry),
                self.acceleration[1] + (self.angular * rx - centripetal * ry),
            ),
        )


@dataclass(frozen=True, eq=False)
class Velocities:
    """Velocities that energies and powers are written in, as :class:`.LagrangeSystem` takes them."""

    symbols: list[Any] = field(default_factory=list)
    graphs: list[Any] = field(default_factory=list)
    rates: list[Any] = field(default_factory=list)
    forces: list[Any] = field(default_factory=list)

    def point(self, motion: tuple[Pair, Pair], force: Pair = (0.0, 0.0)) -> Any:
        """The symbols of a velocity that moves so, with the force that works along it."""
        speed, acceleration = motion
        return ca.vertcat(*(self._add(*entry) for entry in zip(speed, acceleration, force, strict=True)))

    def turn(self, rate: Expression, angular: Expression, couple: Expression = 0.0) -> Any:
        """The symbol of a rate of turning, with the couple that works along it."""
        return self._add(rate, angular, couple)

    def _add(self, graph: Any, rate: Any, force: Any) -> Any:
        self.symbols.append(ca.SX.sym(f"w{len(self.symbols)}"))
        for column, entry in ((self.graphs, graph), (self.rates, rate), (self.forces, force)):
            column.append(ca.SX(entry))
        return self.symbols[-1]


def slide(joint: Joint, parent: Frame, child: Frame) -> Pair:
    """Along and across the axis of a joint that slides: where the child's point is, in the parent's axes."""
    x, y = parent.local(child.place_of(joint.child.x, joint.child.y))
    dx, dy = x - joint.parent.x, y - joint.parent.y
    ax, ay = joint.axis
    return dx * ax + dy * ay, dy * ax - dx * ay


def gap_motion(joint: Joint, parent: Frame, child: Frame) -> tuple[Pair, Pair]:
    """Velocity and acceleration of a joint's point on the child, less those of the parent's point that it is at, in ground axes."""
    x, y = joint.child.x, joint.child.y
    own = child.motion_of(x, y)
    under = parent.motion_at(child.place_of(x, y)) if joint.slides else parent.motion_of(joint.parent.x, joint.parent.y)
    (vx, vy), (ax, ay) = ((a[0] - b[0], a[1] - b[1]) for a, b in zip(own, under, strict=True))
    return (vx, vy), (ax, ay)


def slide_motion(joint: Joint, parent: Frame, child: Frame) -> Pair:
    """Rate and acceleration along the axis of a joint that slides, while nothing moves across it."""
    tx, ty = parent.rotation.apply(*joint.axis)
    (vx, vy), (ax, ay) = gap_motion(joint, parent, child)
    return vx * tx + vy * ty, ax * tx + ay * ty


def closing_gaps(joint: Joint, parent: Frame, child: Frame) -> tuple[Any, Any, Any]:
    """Phi of a joint that closes a loop (paper eq. 5) with Phi' and Phi''.

    Phi are gaps in ground axes or across a line, and of direction where it is held; its multipliers are the action of the parent
    on the child along these gaps.
    """
    (vx, vy), (ax, ay) = gap_motion(joint, parent, child)
    if joint.slides:
        tx, ty = parent.rotation.apply(*joint.axis)
        across, along = vy * tx - vx * ty, vx * tx + vy * ty
        # The line turns under what slides on it (Coriolis).
        gaps = [(slide(joint, parent, child)[1], across, ay * tx - ax * ty - 2 * parent.rate * along)]
    else:
        a, b = child.place_of(joint.child.x, joint.child.y), parent.place_of(joint.parent.x, joint.parent.y)
        gaps = [(a[0] - b[0], vx, ax), (a[1] - b[1], vy, ay)]
    if joint.holds_direction:
        turn, rate = misalignment(joint, parent, child), child.rate - parent.rate
        gaps.append((turn.s, turn.c * rate, turn.c * (child.angular - parent.angular) - turn.s * (rate * rate)))
    phi, phi_rate, phi_acceleration = (ca.vertcat(*column) for column in zip(*gaps, strict=True))
    return phi, phi_rate, phi_acceleration


def reaction(joint: Joint, parent: Frame, child: Frame, action: Any, *, closing: bool) -> dict[str, Any]:
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
        members["mz"] = misalignment(joint, parent, child).c * action[-1] if closing else action[2]
    return members


def misalignment(joint: Joint, parent: Frame, child: Frame) -> Rotation:
    """How far a joint that holds its child's direction misses it."""
    return child.rotation.against(parent.rotation.then(Rotation.by(joint.angle)))
