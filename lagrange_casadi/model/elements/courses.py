"""Motion of a body relative to another one: its axis of rotation or sliding, and coordinates of
joints.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ...base.rotation import Rotation
from ...base.vectors import ZERO, cross, dot, minus, norm, plus
from ...errors import DeclarationError
from ..declared_parts import Body, Expression, Point, Vector
from ..joints import Joint
from ..mechanism import Mechanism
from ..meshes import FITTING, Fit
from .fits import Fits

_KINDS = ("revolute", "prismatic", "weld")
_AS_IT_IS = Rotation()


@dataclass(frozen=True, eq=False)
class Course:
    """Motion of a point of a body relative to a carrier: the point stays on an ``axis``, or
    ``slides`` along it.

    ``place`` and ``axis``, of length one, are in the carrier's axes where all coordinates are zero;
    ``rotations`` are the joints whose coordinates, each with its sign, add up to the angle about
    the axis, or the way along it; without them the axis is zero. ``joints`` are all joints between,
    and ``shifted`` how far the point is from their axes. ``seen`` turns the carrier's axes from
    those of the body.
    """

    carrier: Body
    place: Vector
    axis: Vector
    rotations: tuple[tuple[int, Joint], ...]
    slides: bool
    joints: tuple[Joint, ...]
    shifted: tuple[Expression, ...] = ()
    seen: Rotation = _AS_IT_IS

    def displacement(self, mechanism: Mechanism) -> ca.SX:
        """The angle about its axis, or the way along it, as an expression of coordinates."""
        return sum((sign * mechanism.coordinate(joint) for sign, joint in self.rotations), ca.SX(0))


def along(vector: Vector, by: Expression) -> Vector:
    """A vector over a number."""
    return vector[0] / by, vector[1] / by, vector[2] / by


def courses_on(
    mechanism: Mechanism,
    what: str,
    first: Point,
    second: Point,
    carrier: Body | None,
    *,
    rack: bool = True,
) -> tuple[Course, Course]:
    """Motions of two points on the one body on which both turn, or the second slides.

    Raises :class:`.DeclarationError` where there is none, or where that is not the ``carrier``.
    """
    found = [
        {course.carrier.name: course for course in _courses(mechanism, point)}
        for point in (first, second)
    ]
    both = [
        name
        for name in found[0]
        if name in found[1] and not found[0][name].slides and (rack or not found[1][name].slides)
    ]
    if carrier is not None:
        carrier = mechanism.ownership.point(what, carrier).body
        both = [name for name in both if name == carrier.name]
    if not both:
        where = f"'{carrier.name}'" if carrier is not None else "one body"
        names = [", ".join(f"'{name}'" for name in one) or "nothing" for one in found]
        axes = "; ".join(
            f"'{point.body.name}' turns on {on}"
            for point, on in zip((first, second), names, strict=True)
        )
        raise DeclarationError(
            f"{what}: expected the centres of two bodies that turn on {where} by revolute joints"
            f" through these; {axes}"
        )
    nearest = min(both, key=lambda name: sum(len(one[name].joints) for one in found))
    return found[0][nearest], found[1][nearest]


def keep_on_axis(fits: Fits, *courses: Course) -> None:
    """Note that the axes of all joints of a course are one, for other values of parameters too."""
    for course in courses:
        joints = ", ".join(joint.name for joint in course.joints)
        words = f"its centre and joints {joints} must be on one axis, {{got}} m off"
        fits.found.extend(
            Fit(words, off, 0.0, 1.0)
            for off in course.shifted
            if isinstance(off, ca.SX) and not off.is_constant()
        )


def _courses(mechanism: Mechanism, point: Point) -> list[Course]:
    """All courses of a point: to every body on which it turns about one axis, or slides."""
    start = Course(point.body, point.place, ZERO, (), False, ())
    reached, found = {point.body.name}, [start]
    for course in found:
        for joint in mechanism.joints.values():
            if joint.kind not in _KINDS or course.carrier not in joint.bodies:
                continue
            other = joint.child.body if joint.parent.body is course.carrier else joint.parent.body
            if (
                other.name not in reached
                and (further := _through(mechanism, course, joint, other)) is not None
            ):
                reached.add(other.name)
                found.append(further)
    return [course for course in found if course.rotations]


def _through(mechanism: Mechanism, course: Course, joint: Joint, other: Body) -> Course | None:
    """A course seen from beyond a joint of its carrier; None where it does not stay on one axis."""
    outward, number = joint.child.body is other, mechanism.ownership.at_defaults
    near, far = joint.on(course.carrier), joint.on(other)
    axis, rotations, slides = course.axis, course.rotations, course.slides
    shifted = course.shifted
    if joint.kind != "weld":
        if not joint.axes or slides or (joint.kind == "prismatic" and rotations):
            return None
        # The joint's axis is in its parent's axes, and the same in its child's, turned.
        direction = joint.axes[0].direction
        here = direction if outward else joint.turned.resolve(direction)
        sign = -1 if outward else 1
        if not rotations:
            axis = here
        elif number(norm(cross(axis, here))) > FITTING:
            return None
        elif number(dot(axis, here)) < 0.0:
            sign = -sign
        if joint.kind == "revolute":
            off = cross(minus(course.place, near.place), here)
            if number(norm(off)) > FITTING * max(1.0, number(norm(course.place))):
                return None
            shifted = (*shifted, *off)
        rotations, slides = (*rotations, (sign, joint)), joint.kind == "prismatic"
    # From the carrier's axes to those of the other body.
    turn = joint.turned.inverse if outward else joint.turned
    place = plus(far.place, turn.apply(minus(course.place, near.place)))
    joints = (*course.joints, joint)
    seen = turn.then(course.seen)
    return Course(other, place, turn.apply(axis), rotations, slides, joints, shifted, seen)
