"""Position and motion of the bodies of a solution, in plain vectors, from the reported motions.

It shares nothing with the graphs that made the solution. A joint's reported motion places what
hangs on it, by Rodrigues' formula. What no joint of a known motion holds, as a bar, is taken where
it is reported (:mod:`.unplaced`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.description import AxisNumbers, Description, JointNumbers, LoadNumbers
from ...model.stated import Entry, Stated
from .instant_vectors import GROUND, NIL, Axes, Scalar, Vector, most
from .reported import Reported

Motion = tuple[Vector, Vector, Vector]
"""A vector over time, its rate, and its acceleration."""


@dataclass(frozen=True, eq=False)
class Moving:
    """Place of a body's origin, the directions of its axes, and both their derivatives, in ground
    axes.
    """

    at: Vector
    speed: Vector
    change: Vector
    axes: Axes
    rate: Vector
    acceleration: Vector

    @classmethod
    def holding(
        cls, at: Motion, point: Vector, axes: Axes, rate: Vector, acceleration: Vector
    ) -> Moving:
        """The motion of a body that turns as said and whose ``point`` has the given place, velocity
        and acceleration.
        """
        anchor = cls(NIL, NIL, NIL, axes, rate, acceleration).point(point)
        return cls(
            at[0] - anchor[0], at[1] - anchor[1], at[2] - anchor[2], axes, rate, acceleration
        )

    @classmethod
    def directionless(cls, at: Motion, point: Vector) -> Moving:
        """The motion of a body without a direction whose ``point`` moves as said."""
        return cls.holding(at, point, GROUND, NIL, NIL)

    def point(self, point: Vector) -> Motion:
        """Place, velocity and acceleration of the body's point."""
        arm = self.axes.turn(point)
        moves = self.rate.cross(arm)
        return (
            self.at + arm,
            self.speed + moves,
            self.change + self.acceleration.cross(arm) + self.rate.cross(moves),
        )

    def under(self, place: Vector) -> Vector:
        """The body's point at a place."""
        return self.axes.resolve(place - self.at)

    def speed_at(self, place: Vector) -> Vector:
        """The velocity of the body's point at a place."""
        return self.speed + self.rate.cross(place - self.at)

    def change_at(self, place: Vector) -> Vector:
        """The acceleration of the body's point at a place."""
        arm = place - self.at
        return self.change + self.acceleration.cross(arm) + self.rate.cross(self.rate.cross(arm))

    @cached_property
    def sizes(self) -> tuple[Scalar, Scalar, Scalar, Scalar]:
        """The sizes of speed, change, rate and acceleration."""
        return self.speed.size, self.change.size, self.rate.size, self.acceleration.size


AT_REST = Moving(NIL, NIL, NIL, GROUND, NIL, NIL)
"""Motion of what lies along the ground's axes, at its origin."""


@dataclass(frozen=True, eq=False)
class Relative:
    """Motion of a joint's child against its parent, in the parent's axes: its point by a ``slide``,
    and its rotation ``turned``.

    ``about`` are the directions of its turns at the moment, by coordinate. ``whole`` says whether
    all of its turning is known.
    """

    slide: Motion
    turned: Axes
    rate: Vector
    acceleration: Vector
    about: Mapping[str, Vector]
    whole: bool


@dataclass(frozen=True, eq=False)
class Placed:
    """A mechanism as it was declared in numbers, and what was ``stated`` of it as expressions, its
    results, how each of its joints moves, and the bodies that are placed.
    """

    declared: Description
    stated: Stated
    reported: Reported
    relatives: Mapping[str, Relative]
    bodies: Mapping[str, Moving]

    def ends(self, joint: str) -> tuple[Moving, Moving]:
        """The motions of a joint's parent and child."""
        numbers = self.declared.joints[joint]
        return self.bodies[numbers.parent.body], self.bodies[numbers.child.body]

    def pin(self, joint: str) -> Motion:
        """Motion of a joint's point on its child."""
        child = self.declared.joints[joint].child
        return self.bodies[child.body].point(Vector(*child.at))

    @cached_property
    def pins(self) -> Mapping[str, Motion]:
        """Motions of all joints' points on their children."""
        return {name: self.pin(name) for name in self.declared.joints}

    @cached_property
    def rates(self) -> tuple[Scalar, Scalar, Scalar]:
        """The largest rate of turning at each instant, of joints too; and a speed and an
        acceleration that none exceeds.

        The acceleration is at least (largest speed)^2 / size: uniform motion has none but rounding.
        """
        reported, declared = self.reported, self.declared
        angles = [
            name
            for name, kind in declared.coordinates.items()
            if kind == "angle" and name not in reported.unmeasured
        ]
        speeds, changes, turning, gains = zip(
            *(body.sizes for body in self.bodies.values()), strict=True
        )
        turned = most([*turning, *map(reported.rate, angles)])
        gained = most([*gains, *map(reported.acceleration, angles)])
        fastest = most(speeds) + turned * declared.extent
        changed = most(changes) + (gained + turned**2) * declared.extent
        return turned, fastest, np.maximum(changed, fastest**2 / declared.size)

    @property
    def frictions(self) -> Iterator[tuple[str, LoadNumbers, str]]:
        """Each friction by its name, and the joint that it is in."""
        for name, load in self.declared.loads.items():
            if load.friction is not None:
                yield name, load, load.coordinate.partition(":")[0]

    def along(self, joint: str, axis: AxisNumbers, effort: Array) -> tuple[Vector, Vector]:
        """The force and the couple of an effort along an axis of a joint, on its child at the
        joint's point.

        It does no work along other coordinates: along a slide it is a force, about one of several
        axes a couple at right angles to the other axes.
        """
        near = self.ends(joint)[0]
        if axis.kind == "slide":
            return effort * near.axes.turn(Vector(*axis.direction)), NIL
        about = self.relatives[joint].about
        rotations = [near.axes.turn(direction) for direction in about.values()]
        return NIL, effort * _reciprocal(rotations, [*about].index(axis.coordinate))

    def is_angle(self, entry: Entry) -> bool:
        """Return whether an entry of an equation is an angle."""
        return entry.kind == "direction" or (
            entry.kind == "coordinate" and self.declared.coordinates[entry.part] == "angle"
        )

    def measured(self, entry: Entry) -> tuple[Scalar, Scalar, Scalar]:
        """An entry of an equation, its rate and its acceleration."""
        reported = self.reported
        if entry.kind == "coordinate":
            return (
                reported.value(entry.part),
                reported.rate(entry.part),
                reported.acceleration(entry.part),
            )
        body = self.bodies[entry.part]
        if entry.kind == "direction":
            return (
                reported.outputs[Output("pose", entry.part, "angle")],
                body.rate.z,
                body.acceleration.z,
            )
        place, speed, change = body.point(Vector(*entry.point))
        return getattr(place, entry.kind), getattr(speed, entry.kind), getattr(change, entry.kind)


def place(declared: Description, stated: Stated, reported: Reported) -> Placed:
    """The motion of every body that the reported motions of joints place, the ground's included."""
    relatives = {
        name: _relative(declared, reported, joint) for name, joint in declared.joints.items()
    }
    bodies = {"ground": AT_REST}
    waiting, moved = dict(declared.joints), True
    while waiting and moved:
        moved = False
        for name, joint in list(waiting.items()):
            parent, child = joint.parent.body, joint.child.body
            if (parent in bodies) == (child in bodies):
                continue
            outward = parent in bodies
            found = (_outward if outward else _inward)(
                declared, joint, relatives[name], bodies[parent if outward else child]
            )
            if found is not None:
                bodies[child if outward else parent] = found
                del waiting[name]
                moved = True
    return Placed(declared, stated, reported, relatives, bodies)


def _relative(declared: Description, reported: Reported, joint: JointNumbers) -> Relative:
    """Motion of a joint by its reported motions; motions that are not reported are zero.

    A screw slides by its turns too.
    """
    slide, speed, change, turned, rate, acceleration = NIL, NIL, NIL, GROUND, NIL, NIL
    about: dict[str, Vector] = {}
    for axis in joint.axes:
        if axis.coordinate in reported.unmeasured:
            continue
        direction, name = Vector(*axis.direction), axis.coordinate
        moves, gains = reported.rate(name), reported.acceleration(name)
        along = direction if axis.kind == "slide" else joint.pitch * direction
        if any(along.components):
            slide = slide + reported.value(name) * along
            speed = speed + moves * along
            change = change + gains * along
        if axis.kind == "slide":
            continue
        about[name] = turned.turn(direction)
        # Each turn is carried by those before it.
        acceleration = acceleration + gains * about[name] + rate.cross(moves * about[name])
        rate = rate + moves * about[name]
        turned = turned.carry(Axes.about(direction, reported.phase(Output("motion", name))))
    # In a plane a slot turns about an axis that no coordinate describes.
    whole = (
        (declared.space or joint.kind != "slot")
        and reported.unmeasured.isdisjoint(axis.coordinate for axis in joint.axes)
        and all(declared.oriented(end.body) for end in joint.ends)
    )
    return Relative(
        (slide, speed, change),
        turned.carry(Axes.of(joint.turned)),
        rate,
        acceleration,
        about,
        whole,
    )


def _reciprocal(axes: Sequence[Vector], number: int) -> Vector:
    """The couple that does a unit of work for a turn about one of axes, and none for turns about
    the others.
    """
    if len(axes) < 3:
        return axes[number]
    first, second, third = (axes[(number + k) % 3] for k in range(3))
    across = second.cross(third)
    with np.errstate(all="ignore"):
        return (1.0 / np.asarray(first.dot(across))) * across


def _outward(
    declared: Description, joint: JointNumbers, motion: Relative, base: Moving
) -> Moving | None:
    """The motion of a joint's child, or None where the joint does not give it."""
    if not motion.whole and declared.oriented(joint.child.body):
        return None
    at, speed, change = motion.slide
    place, moves, changes = base.point(Vector(*joint.parent.at) + at)
    slides = base.axes.turn(speed)
    there = place, moves + slides, changes + 2.0 * base.rate.cross(slides) + base.axes.turn(change)
    if not motion.whole:
        return Moving.directionless(there, Vector(*joint.child.at))
    spin = base.axes.turn(motion.rate)
    gains = base.axes.turn(motion.acceleration) + base.rate.cross(spin)
    turning = base.axes.carry(motion.turned), base.rate + spin, base.acceleration + gains
    return Moving.holding(there, Vector(*joint.child.at), *turning)


def _inward(
    declared: Description, joint: JointNumbers, motion: Relative, far: Moving
) -> Moving | None:
    """The motion of a joint's parent, or None where the joint does not give it."""
    place, moves, changes = far.point(Vector(*joint.child.at))
    if not motion.whole:
        if declared.oriented(joint.parent.body):
            return None
        return Moving.directionless((place, moves, changes), Vector(*joint.parent.at))
    at, speed, change = motion.slide
    axes = far.axes.carry(motion.turned.inverse)
    spin, slides = axes.turn(motion.rate), axes.turn(speed)
    rate = far.rate - spin
    acceleration = far.acceleration - axes.turn(motion.acceleration) - rate.cross(spin)
    under = place, moves - slides, changes - 2.0 * rate.cross(slides) - axes.turn(change)
    return Moving.holding(under, Vector(*joint.parent.at) + at, axes, rate, acceleration)
