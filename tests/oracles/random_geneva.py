"""Geneva drives of random mechanisms: a pin in a slot, or a locking arc at a wheel's horn, by where
they touch; nothing of the package is used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import oracle
from jets import Jet
from random_draft import Draft, Spot
from random_elements import Contact, _after, _axis, _beside, _wheel
from random_formula import joint_coordinate
from random_growth import MisfitError


@dataclass(frozen=True)
class Engagement:
    """A crank's pin and a wheel with slots: ``crank`` and ``wheel`` are their joints on a carrier,
    ``reach`` leads from one axis to the other in its axes, and ``sense`` is 1 for slots inside.

    The ``horn`` is the angle at the crank's axis from the line of the axes to where the arc locks.
    """

    slots: int
    sense: int
    crank: oracle.Joint
    wheel: oracle.Joint
    pin: Spot
    reach: tuple[float, float]
    horn: float

    def where(self, q: float) -> tuple[bool, float, float]:
        """Whether the pin is in a slot, the crank's angle from the nearest middle of an engagement,
        and the wheel's in that middle or where it is locked.

        In a slot the pin stays until it moves along that, at a right angle of crank and slot.
        """
        x, y = self.pin.x - self.crank.child[1], self.pin.y - self.crank.child[2]
        middle = math.atan2(-self.sense * self.reach[1], -self.sense * self.reach[0])
        zero = math.remainder(middle - math.atan2(y, x), math.tau)
        turns, pitch = round((q - zero) / math.tau), self.sense * math.tau / self.slots
        within = q - zero - math.tau * turns
        engaged = abs(within) < (math.pi + pitch) / 2
        return (
            engaged,
            within,
            pitch * turns + (0.0 if engaged else math.copysign(pitch / 2, within * pitch)),
        )

    def posture(self, q: float) -> float:
        """The wheel's coordinate for one of the crank."""
        engaged, within, turned = self.where(q)
        r = self.sense * math.sin(math.pi / self.slots)
        return turned + engaged * math.atan2(r * math.sin(within), 1.0 + r * math.cos(within))

    def jet(self, place, t) -> Jet:
        """The pin's distance from the middle of its slot, by that of the axes; or what is left of
        the angle at which the wheel is locked.
        """
        engaged, _, turned = self.where(joint_coordinate(self.crank, place).v)
        if not engaged:
            left = joint_coordinate(self.wheel, place) - turned
            return left - math.tau * round(left.v / math.tau)
        (body, x, y), way = self.wheel.child, math.atan2(-self.reach[1], -self.reach[0]) - turned
        (hx, hy, _), (px, py, _) = place(self.wheel.child), place(self.pin.point)
        ex, ey, _ = place((body, x + math.cos(way), y + math.sin(way)))
        return ((ex - hx) * (py - hy) - (ey - hy) * (px - hx)) * (1 / math.hypot(*self.reach))

    def acts(self, place, torque: float = 1.0, pressed: float = 0.0):
        """A torque on the wheel from the pin, or from the arc with what presses along the line of
        the axes: at the wheel's axis, with the couple about that.
        """
        engaged = self.where(joint_coordinate(self.crank, place).v)[0]
        at = self.pin.point if engaged else self.crank.child
        (hx, hy, _), (x, y, _) = place(self.wheel.child), place(at)
        dx, dy = x.v - hx.v, y.v - hy.v
        far, press = dx * dx + dy * dy, 0.0 if engaged else pressed / math.tan(self.horn)
        fx, fy = (-torque * dy - press * dx) / far, (torque * dx - press * dy) / far
        return [(self.wheel.child, fx, fy, torque), (at, -fx, -fy, 0.0)]

    def presses(self, place, torque: float):
        """Off the crank, whichever horn the arc is at."""
        return self.acts(place, 0.0, abs(torque))


def geneva(d: Draft) -> None:
    """A wheel with slots beside a body that turns, which carries its pin."""
    joint, crank, carrier = _axis(d)
    if d.joints[joint].parent[0] != carrier:
        raise MisfitError
    slots, inside, r = int(d.rng.integers(3, 13)), d.chance(0.4), d.between(0.03, 0.08)
    far = r / math.sin(math.pi / slots)
    pin = _pin(d, crank, r)
    hub = _beside(d, carrier, d.place(crank), far)
    body = _wheel(d, far * math.cos(math.pi / slots))
    wheel = d.base(body)
    d.put(wheel, d.place(hub), 0.0)
    other = d.joint("revolute", hub, wheel)
    mouth = far * math.cos(math.pi / slots)
    lock = float(f"{far - mouth + (r - far + mouth) * d.rng.uniform(0.3, 0.9):.6g}")
    horn = math.acos((lock**2 + far**2 - mouth**2) / (2 * lock * far))
    parent = d.joints[joint].parent
    reach = hub.x - parent[1], hub.y - parent[2]
    sense, horn = (1, math.pi / 2) if inside else (-1, horn)
    made = Engagement(slots, sense, d.joints[joint], d.joints[other], pin, reach, horn)
    turn = made.posture(d.coordinate(joint))
    d.put(wheel, d.place(hub), math.remainder(d.pose(carrier)[2] + turn, math.tau))
    name = d.new("e")
    d.lines.append(
        f'geneva(m, "{name}", {joint}, {other}, slots={slots}, pin={pin.text}, lock={lock!r},'
        f" internal={inside})" + _after(d, joint, other)
    )
    d.contacts[name] = Contact(made, made.acts, made.presses)


def _pin(d: Draft, crank: Spot, r: float) -> Spot:
    """A point of a crank so far from its axis."""
    length = d.bodies[crank.body].length
    for way in (d.angle() for _ in range(8)):
        x, y = crank.x + r * math.cos(way), crank.y + r * math.sin(way)
        if crank.body not in d.limited or 0.05 * length < x < 0.95 * length:
            return d.at(crank.body, x, y)
    raise MisfitError
