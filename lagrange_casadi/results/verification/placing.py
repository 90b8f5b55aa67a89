"""Position and motion of the bodies of a solution, in plain vectors, from the reported motions.

It shares nothing with the graphs that made the solution. A joint's reported motion places what
hangs on it, by Rodrigues' formula. What no joint of a known motion holds, as a bar, is taken where
it is reported (:mod:`.unplaced`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.description import Description, JointNumbers, LoadNumbers
from ...model.stated import Entry, Stated
from .instant_vectors import NIL, about, across, cross, dot, resolve, size, turn
from .reported import Reported

NO_SLIDE = np.zeros((3, 1, 1))
"""The motion of a point that does not move, with any number of components."""


@dataclass(frozen=True, eq=False)
class Moving:
    """Motion of a body: of its origin, (3, 3, t), and of the directions of its axes, (3, 3, 3, t):
    their places, rates and accelerations; and its angular velocity and acceleration, (2, 3, t).
    """

    origin: Array
    rotation: Array
    spin: Array

    @classmethod
    def of(cls, origin: Array, axes: Array, spin: Array) -> Moving:
        """The motion of a body by its axes and its angular velocity and acceleration."""
        moved, changed = across(spin)
        moves = turn(moved, axes)
        changes = turn(changed, axes) + turn(moved, moves)
        return cls(origin, np.array([np.broadcast_to(axes, moves.shape), moves, changes]), spin)

    def holding(self, point: npt.ArrayLike, motion: Array, slide: Array = NO_SLIDE) -> Moving:
        """The motion of a body that turns like this, and whose point, which slides, moves as
        said.
        """
        return Moving(motion + self.origin - self.point(point, slide), self.rotation, self.spin)

    @property
    def at(self) -> Array:
        """The place of the origin."""
        return np.asarray(self.origin[0])

    @property
    def axes(self) -> Array:
        """The directions of the axes."""
        return np.asarray(self.rotation[0])

    @cached_property
    def sizes(self) -> tuple[Array, Array, Array, Array]:
        """The sizes of speed, change, rate and acceleration."""
        (speed, change), (rate, acceleration) = size(self.origin[1:]), size(self.spin)
        return speed, change, rate, acceleration

    def point(self, point: npt.ArrayLike, slide: Array = NO_SLIDE) -> Array:
        """The motion of the body's point, (3, 3, t), which slides on the body's axes."""
        place = np.asarray(point, float)[: len(self.axes)]
        found = np.asarray(self.origin + np.einsum("okit,k->oit", self.rotation, place))
        if not slide.any():
            return found
        axes, rates, accelerations = self.rotation
        carried, moves = turn(rates, slide[:2])
        found = found + turn(axes, slide)
        found[1:] += carried, 2.0 * moves + turn(accelerations, slide[0])
        return found

    def speed_at(self, place: Array) -> Array:
        """The velocity of the body's point at a place."""
        return np.asarray(self.origin[1] + turn(across(self.spin[0]), place - self.at))

    def turning(self, inertia: Array) -> Array:
        """The moment that turns what has an inertia about its centre, on the body's axes: of a body
        in a plane (3, 3, t) too.
        """
        spin, about = resolve(self.axes, self.spin), slice(-self.spin.shape[1], None)
        momentum, change = turn(inertia[about, about], spin)
        return turn(self.axes, change + cross(spin[0], momentum))


@dataclass(frozen=True, eq=False)
class Relative:
    """Motion of a joint's child against its parent, in the parent's axes: of its point by a
    ``slide`` (3, 3, t), its axes, and its angular velocity and acceleration ``spin`` (2, 3, t).

    ``about`` are the directions of its turns at the moment, by coordinate. ``whole`` says whether
    all of its turning is known.
    """

    slide: Array
    axes: Array
    spin: Array
    about: Mapping[str, Array]
    whole: bool


@dataclass(frozen=True, eq=False)
class Placed:
    """A mechanism as it was declared in numbers, and what was ``stated`` of it as expressions, its
    results, how each of its joints moves, the bodies that are placed, and the joints that place
    none.
    """

    declared: Description
    stated: Stated
    reported: Reported
    relatives: Mapping[str, Relative]
    bodies: Mapping[str, Moving]
    closing: Collection[str]

    def ends(self, joint: str) -> tuple[Moving, Moving]:
        """The motions of a joint's parent and child."""
        numbers = self.declared.joints[joint]
        return self.bodies[numbers.parent.body], self.bodies[numbers.child.body]

    def pin(self, joint: str) -> Array:
        """Motion of a joint's point on its child."""
        child = self.declared.joints[joint].child
        return self.bodies[child.body].point(child.at)

    @cached_property
    def rates(self) -> tuple[Array, Array, Array]:
        """The largest rate of turning at each instant, of joints too; and a speed and an
        acceleration that none exceeds.

        The acceleration is at least (largest speed)^2 / size: uniform motion has none but rounding.
        """
        reported, declared = self.reported, self.declared
        angles = (
            reported.motion(name)
            for name, kind in declared.coordinates.items()
            if kind == "angle" and name not in reported.unmeasured
        )
        sizes = [body.sizes for body in self.bodies.values()]
        sizes += [(NIL[0], NIL[0], np.abs(rate), np.abs(change)) for _, rate, change in angles]
        speed, change, turned, gained = (reduce(np.maximum, of) for of in zip(*sizes, strict=True))
        fastest = speed + turned * declared.extent
        changed = change + (gained + turned**2) * declared.extent
        return turned, fastest, np.maximum(changed, fastest**2 / declared.size)

    @property
    def frictions(self) -> Iterator[tuple[str, LoadNumbers, str]]:
        """Each friction by its name, and the joint that it is in."""
        for name, load in self.declared.loads.items():
            if load.friction is not None:
                yield name, load, load.coordinate.partition(":")[0]

    def along(self, coordinate: str, effort: Array) -> tuple[Array, Array]:
        """The force and the couple of an effort along a coordinate of a joint, on its child at the
        joint's point.

        It does no work along other coordinates: along a slide it is a force, about one of several
        axes a couple at right angles to the other axes.
        """
        joint = coordinate.partition(":")[0]
        axes = self.ends(joint)[0].axes
        (axis,) = (one for one in self.declared.joints[joint].axes if one.coordinate == coordinate)
        if axis.kind == "slide":
            return effort * turn(axes, self.reported.straight(axis.direction)), NIL
        about = self.relatives[joint].about
        turns = [turn(axes, direction) for direction in about.values()]
        number = [*about].index(coordinate)
        first, *others = turns[number:] + turns[:number]
        if len(others) < 2:
            return NIL, effort * first
        across = cross(*others)
        with np.errstate(all="ignore"):
            return NIL, effort / dot(first, across) * across

    def missed(self, joint: str) -> tuple[Array, Array, Array]:
        """Residuals of a joint against its reported motion: of its point's motion, (3, 3, t), of
        its child's axes, (3, 3, t), and of their angular velocity and acceleration, (2, 3, t); nil
        where it is not known how the joint turns.
        """
        (near, far), motion = self.ends(joint), self.relatives[joint]
        there = near.point(self.declared.joints[joint].parent.at, motion.slide)
        if not motion.whole:
            return self.pin(joint) - there, NO_SLIDE, np.zeros((2, 1, self.reported.t.size))
        axes, spin = _turned(near, motion.axes, motion.spin)
        return self.pin(joint) - there, far.axes - axes, far.spin - spin

    def is_angle(self, entry: Entry) -> bool:
        """Return whether an entry of an equation is an angle."""
        return entry.kind == "direction" or (
            entry.kind == "coordinate" and self.declared.coordinates[entry.part] == "angle"
        )

    def measured(self, entry: Entry) -> Array:
        """An entry of an equation, its rate and its acceleration, (3, t)."""
        if entry.kind == "coordinate":
            return self.reported.motion(entry.part)
        body = self.bodies[entry.part]
        if entry.kind == "direction":
            angle = self.reported.outputs[Output("pose", entry.part, "angle")]
            return np.array(np.broadcast_arrays(angle, *body.spin[:, -1]))
        return body.point(entry.point)[:, "xyz".index(entry.kind)]


def place(declared: Description, stated: Stated, reported: Reported) -> Placed:
    """The motion of every body that the reported motions of joints place, the ground's included."""
    relatives = {
        name: _relative(declared, reported, joint) for name, joint in declared.joints.items()
    }
    at_rest = Moving.of(NO_SLIDE, reported.ground, np.zeros((2, len(reported.turns), 1)))
    bodies = {"ground": at_rest}
    waiting = dict(declared.joints)
    for _ in declared.joints:
        for name, joint in list(waiting.items()):
            parent, child = joint.parent.body, joint.child.body
            if (parent in bodies) == (child in bodies):
                continue
            outward, motion = parent in bodies, relatives[name]
            base, sought = (bodies[parent], child) if outward else (bodies[child], parent)
            if declared.oriented(sought) and not motion.whole:
                continue
            body, axes, spin = at_rest, motion.axes, motion.spin
            if motion.whole:
                back = axes.swapaxes(0, 1), -resolve(axes, spin)
                body = Moving.of(NO_SLIDE, *_turned(base, *((axes, spin) if outward else back)))
            bodies[sought] = (
                body.holding(joint.child.at, base.point(joint.parent.at, motion.slide))
                if outward
                else body.holding(joint.parent.at, base.point(joint.child.at), motion.slide)
            )
            del waiting[name]
    return Placed(declared, stated, reported, relatives, bodies, [*waiting])


def _relative(declared: Description, reported: Reported, joint: JointNumbers) -> Relative:
    """Motion of a joint by its reported motions; motions that are not reported are zero.

    A screw slides by its turns too.
    """
    slide, turned, spin = NO_SLIDE, reported.ground, NO_SLIDE[1:]
    directions = dict[str, Array]()
    for axis in joint.axes:
        if (name := axis.coordinate) in reported.unmeasured:
            continue
        pitch, motion = 1.0 if axis.kind == "slide" else joint.pitch, reported.motion(name)
        slides = pitch * reported.straight(axis.direction)
        slide = slide + motion[:, None] * slides if pitch else slide
        if axis.kind == "angle":
            along = reported.turning(axis.direction)
            directions[name] = turn(turned, along)
            # Each turn is carried by those before it.
            carried = cross(spin[0], motion[1] * directions[name])
            spin = spin + motion[1:, None] * directions[name]
            spin[1] += carried
            turned = turn(turned, about(along, reported.phase(Output("motion", name))))
    # In a plane a slot turns about an axis that no coordinate describes.
    whole = (
        (declared.space or joint.kind != "slot")
        and reported.unmeasured.isdisjoint(axis.coordinate for axis in joint.axes)
        and all(declared.oriented(end.body) for end in joint.ends)
    )
    first = np.array([*map(reported.straight, joint.turned[: len(turned)])])
    return Relative(slide, turn(turned, first), spin, directions, whole)


def _turned(base: Moving, axes: Array, spin: Array) -> tuple[Array, Array]:
    """Axes that are given on those of a body and turn against it, and their angular velocity and
    acceleration.
    """
    whole = base.spin + turn(base.axes, spin)
    whole[1] += cross(base.spin[0], whole[0])
    return turn(base.axes, axes), whole
