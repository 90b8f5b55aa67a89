"""Bars: slender links between two spherical joints, whose spin about their own axis nothing holds
and nothing depends on.

A bar has no coordinates. It lies between its two ends, wherever these are, and its length is one
equation: the square of their distance. Its points move as its ends do, in proportion. So its
energy, and the work of forces on its axis, hold nothing of a spin.

Its cross-section is turned as the declaration says: at every instant its y axis is the part across
the bar of the direction ``beside``, which is fixed in the ground. Without that no stress of a
cross-section that is not round is determined.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.frames import Frame
from ..base.rotation import Rotation
from ..base.vectors import ZERO, cross, dot, minus, nil, plus, times
from ..model.declared_parts import Body, Link, Point, Vector
from ..model.joints import Joint
from ..model.limits import parameter_values
from ..model.link_density import Density
from ..model.loads import Friction, Torque
from ..model.mechanism import Mechanism


@dataclass(frozen=True, eq=False)
class TwoForceLink:
    """A link that is a bar, and its joints: first that nearer its base.

    Its y axis is the part across it of the direction ``aside`` in ground axes: the link's
    ``beside``, or where none was declared symbols for that of the ground's axes that is most across
    the bar at the start.
    """

    link: Link
    joints: tuple[Joint, Joint]
    aside: tuple[Any, Any, Any]

    @property
    def aimed(self) -> bool:
        """True if the y axis was declared."""
        return self.link.beside is not None

    def other(self, joint: Joint) -> Point:
        """A joint's point on the other body."""
        return joint.parent if joint.child.body is self.link else joint.child

    @property
    def start(self) -> Expression:
        """Position of the first joint along the bar [m]."""
        return self.joints[0].on(self.link).x

    @property
    def length(self) -> Expression:
        """Distance of the joints [m]."""
        return self.joints[1].on(self.link).x - self.start


@dataclass(frozen=True, eq=False)
class TwoForceFrame(Frame):
    """The motion of a bar: that of its first joint, and what the bar's direction does: its rate,
    and the change of that.
    """

    course: tuple[Vector, Vector] = (ZERO, ZERO)

    def motion_of(self, point: Vector) -> tuple[Vector, Vector]:
        """Velocity and acceleration of the bar's point: on its axis in
        proportion between its ends.
        """
        x, y, z = point
        if not (nil(y) and nil(z)):
            return super().motion_of(point)
        reach = x - self.anchor[0]
        return plus(self.speed, times(reach, self.course[0])), plus(
            self.acceleration, times(reach, self.course[1])
        )


def find_two_force_links(mechanism: Mechanism, driven: Collection[str]) -> tuple[TwoForceLink, ...]:
    """The links that are bars; none where something drives, measures or loads what a spin would
    change.
    """
    found: dict[Body, TwoForceLink] = {}
    ends: dict[Body, list[Joint]] = {}
    for joint in mechanism.joints.values():
        for body in joint.bodies:
            ends.setdefault(body, []).append(joint)
    checked = {
        measure.of.name
        for measure in mechanism.measures.asked.values()
        if isinstance(measure.of, Joint)
    }
    checked |= {load.joint.name for load in mechanism.loads.values() if isinstance(load, Friction)}
    checked |= {joint.name for name, (joint, _) in mechanism.coordinates.items() if name in driven}
    off = mechanism.rounding and mechanism.rounding * mechanism.ownership.at_defaults(
        sum(ca.SX(link.length) for link in mechanism.links.values())
    )
    for link in mechanism.links.values():
        joints = ends.get(link, [])
        if len(joints) != 2 or not isinstance(link.mass, Density) or link.mass.slices is not None:
            continue
        points = [*(joint.on(link) for joint in joints), *_marked(mechanism, link)]
        others = [body for joint in joints for body in joint.bodies if body is not link]
        if (
            all(joint.kind == "spherical" and joint.name not in checked for joint in joints)
            and all(_on_axis(point, off) for point in points)
            and not any(body in found for body in others)
            and not _twisted(mechanism, link)
        ):
            values = parameter_values(mechanism.parameters, None)
            first, second = sorted(joints, key=lambda joint: _place(mechanism, joint, link, values))
            if _place(mechanism, first, link, values) < _place(mechanism, second, link, values):
                x, y, z = (ca.SX.sym(f"{link.name}_aside_{component}") for component in "xyz")
                found[link] = TwoForceLink(link, (first, second), link.beside or (x, y, z))
    return tuple(found.values())


def unaimed(link: str) -> str:
    """Reason why a bar has no stress if its cross-section is not round and its y axis was not
    declared.
    """
    return (
        f"link '{link}' can spin freely about its own axis, and its cross-section is not round, so"
        " its stresses are not determined; declare it with between= and beside=, the direction of"
        " its y axis, or use a universal joint for one of its spherical ones"
    )


def idle_spins(mechanism: Mechanism, driven: Collection[str]) -> list[str]:
    """Describe spins between two spherical joints that nothing holds, of links that are no bars,
    and what to do.
    """
    two_force_links = [one.link for one in find_two_force_links(mechanism, driven)]
    joints = mechanism.joints.values()
    found = []
    for link in mechanism.links.values():
        attached = [joint for joint in joints if link in joint.bodies]
        moved = any(
            mechanism.coordinates[name][0] in attached
            for name in driven
            if name in mechanism.coordinates
        )
        if (
            link not in two_force_links
            and not moved
            and len(attached) == 2
            and all(joint.kind == "spherical" for joint in attached)
        ):
            first, second = (joint.name for joint in attached)
            found.append(
                f"the spin of link '{link.name}' about the line from '{first}' to '{second}' is"
                " not determined: give one of their rotations a motion, or the link its mass"
                " alone, so that it is a two-force link; if one of them has friction, make the"
                " other one universal"
            )
    return found


def two_force_frame(
    two_force_link: TwoForceLink, frames: Mapping[str, Frame], released: Mapping[str, ca.SX]
) -> tuple[TwoForceFrame, tuple[Expression, Expression, Expression]]:
    """A bar's frame between the bodies of its joints, displaced by the mobilities that are
    ``released``; and its length's equation.

    The latter is Phi, Phi' and Phi'' of half the square of the distance over the length, less half
    the length [m].
    """
    ends: list[tuple[Vector, Vector, Vector]] = []
    for joint in two_force_link.joints:
        point, frame = two_force_link.other(joint), frames[two_force_link.other(joint).body.name]
        speed, acceleration = frame.motion_of(point.place)
        if joint.name in released:
            along, across, out = ca.vertsplit(released[joint.name])
            speed = plus(speed, (along, across, out))
        ends.append((frame.place_of(point.place), speed, acceleration))
    apart, rate, change = map(minus, ends[1], ends[0])
    length = two_force_link.length
    x, course = times(1 / length, apart), (times(1 / length, rate), times(1 / length, change))
    aside = across_link(two_force_link, x)
    rotation = Rotation(x, times(1 / ca.sqrt(dot(aside, aside)), aside), None)
    frame = TwoForceFrame(
        *ends[0],
        rotation,
        cross(x, course[0]),
        cross(x, course[1]),
        (two_force_link.start, 0.0, 0.0),
        course=course,
    )
    residual = (
        (dot(apart, apart) / length - length) / 2,
        dot(x, rate),
        dot(x, change) + dot(course[0], rate),
    )
    return frame, residual


def across_link(two_force_link: TwoForceLink, x: Vector) -> Vector:
    """The part of a bar's direction ``aside`` that is across it, for its axis ``x``."""
    return minus(two_force_link.aside, times(dot(two_force_link.aside, x), x))


def _marked(mechanism: Mechanism, link: Link) -> Iterator[Point]:
    """Points of a link where something acts, or is measured."""
    for load in mechanism.loads.values():
        yield from (point for point in load.points if point.body is link)
    for measure in mechanism.measures.asked.values():
        if isinstance(measure.of, Point) and measure.of.body is link:
            yield measure.of


def _twisted(mechanism: Mechanism, link: Link) -> bool:
    """Return whether a load may twist a link, or turns with it."""
    return any(
        (isinstance(load, Torque) or getattr(load, "turning", False))
        and any(point.body is link for point in load.points)
        for load in mechanism.loads.values()
    )


def _on_axis(point: Point, off: float) -> bool:
    """Return whether a point is on its link's axis, or by no more than ``off`` it [m]."""
    return all(
        nil(aside) or (isinstance(aside, float) and abs(aside) <= off)
        for aside in (point.y, point.z)
    )


def _place(mechanism: Mechanism, joint: Joint, link: Link, values: Mapping[str, float]) -> float:
    return mechanism.number(joint.on(link).x, values)
