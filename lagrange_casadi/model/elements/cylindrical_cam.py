"""Cylindrical cams with the real forces of their contact: a roller in a groove round a drum, on a
follower that slides or swings.

The centre A of the roller is at a(theta) where the drum has turned by theta, and the roller turns
about p, across the groove. The groove is what the roller leaves of the drum: its flanks touch the
roller along the normal n, at right angles to p and to the way of A on the drum, a' - u x (a - c),
with u the drum's axis through c. So the contact pushes along n through A. On the drum that is given
by two points of its axis, c and q = c + h u, and the drum's angle: forces g1 + g2 = n there, with h
u x g2 that part of the moment (a - c) x n that is across the axis. The part about the axis is the
slope of the equation of contact by theta,

    n . (A - a) - g1 . (C - c) - g2 . (Q - q) = 0,

whose multiplier is the force of the contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ...base.arguments import Count, Elastic, Symbolic, public
from ...base.arrays import Array
from ...base.brief import Brief
from ...base.rotation import Rotation, direction
from ...base.scalars import column, graph
from ...base.vectors import ZERO, Vector, cross, dot, minus, norm, plus, times
from ...errors import DeclarationError
from ..constraints import Constraint
from ..declared_parts import Expression, Link, Point, Track
from ..joints import Joint
from ..mechanism import Mechanism
from .cam_profile import turn_in
from .follower import (
    ANGLES,
    STEEL,
    Touch,
    contact,
    held_by,
    output_pressure,
    positive,
    rise_of,
    sampled,
    stiffness_of,
    unit,
)

_SAME = 1e-9
"""A cosine, or a share of a size, that is smaller is zero."""

_CORNERS = 120


@dataclass(frozen=True, eq=False, repr=False)
class Groove(Touch):
    """Position of the roller, by its centre.

    ``bend`` is the curvature of its path on the drum, in the plane across the roller [1/m],
    positive where it curves along the normal.
    """

    bend: Any


@public
@dataclass(frozen=True, eq=False, repr=False)
class CylindricalCam(Brief):
    """A cylindrical cam: its ``constraint``, whose multiplier is the force of its contact, and its
    ``design``.

    Outputs are NAME_force [N], positive where it pushes the follower along its coordinate: where
    the sign changes, the roller goes over to the other flank; NAME_pressure_angle [rad] between the
    force and the way of the roller; and with a width NAME_hertz, the largest pressure between the
    roller and the flank that it touches [Pa].
    """

    name: str
    mechanism: Mechanism
    constraint: Constraint
    design: Groove
    cam: Joint

    def groove(self, parameters: dict[str, float] | None = None, *, count: Count = 720) -> Array:
        """Return the path of the roller's centre on the drum at angles of one turn.

        Parameters
        ----------
        parameters : dict, optional
            Values by name; by default the parameters' defaults.
        count : int
            Number of angles, 16 to a million.

        Returns
        -------
        array (count, 3)
            Places in the drum's own axes [m].

        Raises
        ------
        UnknownNameError
            For a name that is not a parameter.
        ParameterError
            For values that are out of range, or make a part impossible.
        DeclarationError
            For another count.
        """
        angles = turn_in(self.name, count)[:-1]
        values = self.mechanism.values(parameters)
        way = _way(self.mechanism, self.design, self.cam)
        return np.asarray(way(angles[None], list(values.values())).full().T)


@public
def cylindrical_cam(
    mechanism: Mechanism,
    name: str,
    cam: Joint,
    follower: Joint,
    lift: Callable[[Expression], Expression],
    *,
    start: Expression = 0.0,
    point: Point | None = None,
    roller: Symbolic | None = None,
    width: Symbolic | None = None,
    elastic: Elastic = STEEL,
) -> CylindricalCam:
    """Declare the contact of a drum's groove with the roller of its follower in space, from the
    follower's motion.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    cam, follower
        The revolute joint of the drum on the ground, and the joint of the follower on the ground:
        prismatic along the drum's axis, or revolute about an axis at right angles to it.
    lift
        The follower's way [m], or its swing [rad], as a function of the drum's angle: a motion of
        ``moves``, a ``curve``, or any function that takes and returns CasADi's expressions. It must
        be periodic by a turn.
    start
        The coordinate of the follower's joint where the lift is zero [m or rad].
    point
        The centre of the roller, in the middle of the groove's depth; by default the point at which
        the joint holds the follower.
    roller, width, elastic
        The radius of the roller and the width of its contact [m], for the pressure of Hertz, and
        Young's modulus [Pa] and Poisson's ratio of both bodies. The flank is that of the middle of
        the groove's depth: a curve beside the path of the centre.

    Returns
    -------
    CylindricalCam
        The contact, with its constraint. The roller of a follower that slides turns about the line
        from the drum's axis to its centre; that of one that swings, about an axis along its
        joint's.

    Raises
    ------
    DeclarationError
        For joints of other kinds, a roller on the drum's axis or too large for the groove's bends,
        and a lift that is not periodic by a turn.
    """
    what, ownership = f"cam '{name}'", mechanism.ownership
    stiffness = stiffness_of(what, elastic)
    held = held_by(what, mechanism, cam, follower, point, space=True)
    x, rise = rise_of(what, mechanism, lift)
    begin = ownership.expression(
        f"{what}: start", start, "rad" if follower.kind == "revolute" else "m"
    )
    design = _groove(what, mechanism, x, begin + rise, cam, follower, held)
    _check(what, mechanism, design, cam, follower)
    gap = _gap(mechanism, cam, held, design)
    made = CylindricalCam(
        name, mechanism, contact(mechanism, name, cam, design, gap, rise), design, cam
    )
    size = 0.0 if roller is None else ownership.expression(f"{what}: roller", roller, "m")
    way, drawn = _way(mechanism, design, cam), np.linspace(0.0, math.tau, _CORNERS + 1)[:-1]
    corners = [ca.vertsplit(way(ca.SX(turn), mechanism.symbols)) for turn in drawn.tolist()]
    mechanism.tracks[name] = Track(
        cam.child.on_body,
        cam.turned.resolve(cam.triad[0]),
        tuple((x, y, z) for x, y, z in corners),
        held.on_body,
        size,
    )
    if width is not None:
        if roller is None:
            raise DeclarationError(f"{what}: width needs roller, the roller's radius [m]")
        round_ = positive(mechanism, what, "roller", roller)
        _refuse_undercut(what, mechanism, design, round_)
        force = mechanism.results.multiplier(made.constraint)
        # The flank is as far beside the path as the roller's radius, on the side from which it
        # pushes.
        bend = ca.substitute(ca.SX(design.bend), design.angle, mechanism.coordinate(cam))
        curvature = 1.0 / (round_ * (1.0 + ca.sign(force) * bend * round_))
        output_pressure(mechanism, name, ca.fabs(force), curvature, width, stiffness)
    return made


def _way(mechanism: Mechanism, design: Groove, cam: Joint) -> ca.Function:
    """The place of the roller's centre in the drum's axes, by the angle and the parameters."""
    turned = _carried(cam, design.angle)
    here = plus(turned.resolve(minus(design.place, cam.parent.place)), cam.child.place)
    return graph("groove", {"angle": design.angle, "p": mechanism.symbols}, way=column(here))


def _carried(joint: Joint, angle: Expression) -> Rotation:
    """Rotation of the child of a joint on the ground, at an angle of the joint."""
    if joint.kind == "prismatic":
        return joint.turned
    return Rotation.about(joint.triad[0], *direction(angle), angle).then(joint.turned)


def _groove(
    what: str,
    mechanism: Mechanism,
    x: Expression,
    coordinate: Expression,
    cam: Joint,
    follower: Joint,
    held: Point,
) -> Groove:
    axis, centre, line = cam.triad[0], cam.parent.place, follower.triad[0]
    slides = follower.kind == "prismatic"
    arm = _carried(follower, coordinate).apply(minus(held.place, follower.child.place))
    place = plus(plus(follower.parent.place, times(coordinate, line) if slides else ZERO), arm)
    seat = minus(place, centre)
    direction = line if slides else unit(cross(line, arm))
    about = unit(_across(seat, axis)) if slides else line
    # Its way and its second derivative as the drum sees them, which turns.
    on_drum = minus(_slope(place, x), cross(axis, seat))
    bent = minus(_slope(on_drum, x), cross(axis, on_drum))
    # Along the follower's coordinate, where the drum alone moves.
    ahead = ca.SX(dot(cross(about, cross(axis, seat)), direction))
    side = mechanism.ownership.at_defaults(ca.substitute(ahead, x, 0.0))
    if not abs(side) > 0.0:
        raise DeclarationError(
            f"{what}: the drum's surface does not pass the roller; expected the roller off the"
            " axis, and a follower along the axis"
        )
    beside = times(1.0 if side > 0.0 else -1.0, cross(on_drum, about))
    normal = unit(beside)
    return Groove(x, place, normal, direction, dot(bent, normal) / dot(beside, beside))


def _across(vector: Vector, axis: Vector) -> Vector:
    """The part of a vector at right angles to an axis of length 1."""
    return minus(vector, times(dot(vector, axis), axis))


def _slope(vector: Vector, x: Expression) -> Vector:
    a, b, c = (ca.jacobian(ca.SX(component), x) for component in vector)
    return a, b, c


def _refuse_undercut(what: str, mechanism: Mechanism, design: Groove, roller: Expression) -> None:
    """Raise :class:`.DeclarationError` where the groove's flanks have no room for its roller in its
    bends.
    """
    bends, radii = np.abs(sampled(mechanism, design.angle, ANGLES, design.bend, roller))
    tight = int(np.argmax(bends))
    if bends[tight] * radii[0] >= 1.0:
        raise DeclarationError(
            f"{what}: its groove is undercut at {math.degrees(ANGLES[tight]):.4g} deg of the cam,"
            f" where its path has a radius of {1.0 / bends[tight]:.3g} m; expected a smaller roller"
            " or a slower lift"
        )


def _check(what: str, mechanism: Mechanism, design: Groove, cam: Joint, follower: Joint) -> None:
    """Raise :class:`.DeclarationError` for axes that do not lie as they must, and a roller on the
    drum's axis.
    """
    axis, slides = cam.triad[0], follower.kind == "prismatic"
    cosine = mechanism.ownership.at_defaults(dot(follower.triad[0], axis))
    if abs(abs(cosine) - (1.0 if slides else 0.0)) > _SAME:
        place = "along the drum's axis" if slides else "at right angles to the drum's axis"
        raise DeclarationError(f"{what}: joint '{follower.name}' must be {place}")
    away = norm(_across(minus(design.place, cam.parent.place), axis))
    (reach,) = sampled(mechanism, design.angle, ANGLES, away)
    if not reach.min() > _SAME * reach.max():
        raise DeclarationError(f"{what}: the roller reaches the drum's axis; move it away")


def _gap(mechanism: Mechanism, cam: Joint, held: Point, design: Groove) -> Expression:
    """The equation of the contact, in places, so that its force acts where it is."""
    drum, axis, centre = cam.child.body, cam.triad[0], cam.parent.place
    assert isinstance(drum, Link)
    # At the distance of a metre; of the moment about the axis nothing is left in it.
    far = cross(cross(minus(design.place, centre), design.normal), axis)
    ends = drum.at(*plus(cam.child.place, cam.turned.resolve(axis)))
    gap: Any = 0.0
    for point, arm, there in (
        (held, design.normal, design.place),
        (cam.child, minus(far, design.normal), centre),
        (ends, times(-1.0, far), plus(centre, axis)),
    ):
        x, y, z = mechanism.place(point)
        gap = gap + dot(arm, minus((x, y, z), there))
    return gap
