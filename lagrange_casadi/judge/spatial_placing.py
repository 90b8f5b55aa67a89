"""Where the bodies of a spatial solution are and how they move, in plain vectors, from the motions that it reports.

It shares nothing with the graphs that made the solution. A joint's reported motion places what hangs on it, by Rodrigues' formula.
What no joint of a known motion holds, as a bar, is taken where it is reported (:mod:`.spatial_rest`). Vectors are arrays (t, 3),
rotations (t, 3, 3): their columns are the turned axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.arrays import Array
from ..declare.description import Description, oriented
from ..instants.solution import Solution
from .written import Entry

Motion = tuple[Array, Array, Array]
"""A vector or a number over time, its rate, and its acceleration."""


@dataclass(frozen=True, eq=False)
class Moving:
    """Place of a body's origin, the directions of its axes, and both their derivatives, in ground axes."""

    at: Array
    speed: Array
    change: Array
    axes: Array
    rate: Array
    acceleration: Array

    @classmethod
    def at_rest(cls, count: int) -> Moving:
        """What lies along the ground's axes, at its origin, at so many instants."""
        nil = np.zeros((count, 3))
        return cls(nil, nil, nil, np.broadcast_to(np.eye(3), (count, 3, 3)), nil, nil)

    @classmethod
    def holding(cls, at: Motion, point: Any, axes: Array, rate: Array, acceleration: Array) -> Moving:
        """The motion of a body that turns as said and whose ``point`` has the given place, velocity and acceleration."""
        nil = np.zeros_like(at[0])
        body = cls(nil, nil, nil, axes, rate, acceleration)
        place, speed, change = (one - own for one, own in zip(at, body.point(point), strict=True))
        return cls(place, speed, change, axes, rate, acceleration)

    def point(self, point: Any) -> Motion:
        """Place, velocity and acceleration of the body's point, (3,) or (t, 3)."""
        arm = turn(self.axes, point)
        moves = cross(self.rate, arm)
        return self.at + arm, self.speed + moves, self.change + cross(self.acceleration, arm) + cross(self.rate, moves)

    def under(self, place: Array) -> Array:
        """The body's point at a place."""
        return resolve(self.axes, place - self.at)


@dataclass(frozen=True, eq=False)
class Relative:
    """How a joint moves its child against its parent, in the parent's axes: its point by a ``slide``, and how it is ``turned``.

    ``about`` are the directions of its turns at the moment, in sequence.
    """

    slide: Motion
    turned: Array
    rate: Array
    acceleration: Array
    about: tuple[Array, ...]


@dataclass(frozen=True, eq=False)
class Reported:
    """What a solution reports of motion, and angles in ``turned`` without their turns, which are known more closely."""

    solution: Solution
    turned: Solution

    @property
    def count(self) -> int:
        """The number of instants."""
        return int(self.solution.t.size)

    @property
    def description(self) -> Description:
        """The mechanism."""
        return self.solution.description


def place(reported: Reported) -> dict[str, Moving]:
    """The motion of every body that the reported motions of joints place, the ground's included."""
    bodies = {"ground": Moving.at_rest(reported.count)}
    waiting = dict(reported.description["joints"])
    moved = True
    while waiting and moved:
        moved = False
        for name, joint in list(waiting.items()):
            parent, child = joint["parent"]["body"], joint["child"]["body"]
            if (parent in bodies) == (child in bodies):
                continue
            found = _hang(reported, joint, bodies)
            if found is not None:
                bodies[child if parent in bodies else parent] = found
                del waiting[name]
                moved = True
    return bodies


def relative(reported: Reported, joint: Description) -> Relative:
    """How a joint moves, by its reported motions; of what is not told, nothing. A screw slides by its turns too."""
    count, solution = reported.count, reported.solution
    nil = np.zeros((count, 3))
    slide, speed, change, turned, rate, acceleration = nil, nil, nil, np.broadcast_to(np.eye(3), (count, 3, 3)), nil, nil
    about: list[Array] = []
    for (name, kind), direction in zip(joint["coordinates"].items(), map(np.array, joint["axes"]), strict=True):
        if name in solution.description["unmeasured"]:
            continue
        motion = solution.motion(name)
        way = direction if kind == "slide" else joint["pitch"] * direction
        if way.any():
            slide, speed = slide + motion.value[:, None] * way, speed + motion.rate[:, None] * way
            change = change + motion.acceleration[:, None] * way
        if kind == "slide":
            continue
        axis = turn(turned, direction)
        about.append(axis)
        # Each turn is carried by those before it.
        acceleration = acceleration + motion.acceleration[:, None] * axis + cross(rate, motion.rate[:, None] * axis)
        rate = rate + motion.rate[:, None] * axis
        turned = turned @ _rotation(direction, reported.turned.motion(name).value)
    return Relative((slide, speed, change), turned @ np.array(joint["turned"]).T, rate, acceleration, tuple(about))


def told(description: Description, joint: Description) -> bool:
    """Whether how a joint is turned is told: whether both its bodies have directions, and its angles are measured."""
    ends = (joint["parent"]["body"], joint["child"]["body"])
    return all(oriented(description, body) for body in ends) and not {*joint["coordinates"]} & {*description["unmeasured"]}


def spot(point: Description) -> Array:
    """A described point in its body's axes, (3,)."""
    return np.array([point["x"], point["y"], point["z"]])


def turn(axes: Array, vector: Any) -> Array:
    """A vector that is given on turned axes."""
    return np.asarray((axes @ np.asarray(vector)[..., None])[..., 0])


def resolve(axes: Array, vector: Array) -> Array:
    """A vector on turned axes."""
    return turn(np.swapaxes(axes, -1, -2), vector)


def cross(a: Array, b: Array) -> Array:
    """a x b of vectors (..., 3), (3,) or one each instant, to the bit as NumPy's own, which takes three times as long."""
    x, y, z, u, v, w = a[..., 0], a[..., 1], a[..., 2], b[..., 0], b[..., 1], b[..., 2]
    first = y * w - z * v
    found = np.empty((*first.shape, 3))
    found[..., 0], found[..., 1], found[..., 2] = first, z * u - x * w, x * v - y * u
    return found


def measured(solution: Solution, bodies: Mapping[str, Moving], entry: Entry) -> Motion:
    """An entry of an equation, its rate and its acceleration."""
    if entry.kind == "coordinate":
        motion = solution.motion(entry.part)
        return motion.value, motion.rate, motion.acceleration
    k = "xyz".index(entry.kind)
    place, speed, change = (vector[:, k] for vector in bodies[entry.part].point(np.array(entry.point)))
    return place, speed, change


def _hang(reported: Reported, joint: Description, bodies: Mapping[str, Moving]) -> Moving | None:
    """The motion of the body of a joint that is not placed yet, or None where the joint does not give it."""
    description, parent, child = reported.description, joint["parent"], joint["child"]
    whole, motion = told(description, joint), relative(reported, joint)
    at, speed, change = motion.slide
    if parent["body"] in bodies:
        base = bodies[parent["body"]]
        if not whole and oriented(description, child["body"]):
            return None
        place, moves, changes = base.point(spot(parent) + at)
        slides = turn(base.axes, speed)
        moves, changes = moves + slides, changes + 2.0 * cross(base.rate, slides) + turn(base.axes, change)
        if not whole:
            return Moving.holding((place, moves, changes), spot(child), *_undirected(reported.count))
        spin = turn(base.axes, motion.rate)
        gains = turn(base.axes, motion.acceleration) + cross(base.rate, spin)
        axes, rate, acceleration = base.axes @ motion.turned, base.rate + spin, base.acceleration + gains
        return Moving.holding((place, moves, changes), spot(child), axes, rate, acceleration)
    far = bodies[child["body"]]
    place, moves, changes = far.point(spot(child))
    if not whole:
        if oriented(description, parent["body"]):
            return None
        return Moving.holding((place, moves, changes), spot(parent), *_undirected(reported.count))
    axes = far.axes @ np.swapaxes(motion.turned, 1, 2)
    spin, slides = turn(axes, motion.rate), turn(axes, speed)
    rate = far.rate - spin
    acceleration = far.acceleration - turn(axes, motion.acceleration) - cross(rate, spin)
    under = place, moves - slides, changes - 2.0 * cross(rate, slides) - turn(axes, change)
    return Moving.holding(under, spot(parent) + at, axes, rate, acceleration)


def _undirected(count: int) -> tuple[Array, Array, Array]:
    """Axes and their rates of what has none."""
    still = Moving.at_rest(count)
    return still.axes, still.rate, still.acceleration


def _rotation(axis: Array, angle: Array) -> Array:
    """The rotations about an axis by angles (Rodrigues)."""
    x, y, z = axis
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    c, s = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    return np.asarray(c * np.eye(3) + s * across + (1.0 - c) * np.outer(axis, axis))
