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
from ...base.vectors import ZERO, Vector, cross, dot, minus, norm, plus, times
from ...errors import DeclarationError
from ..constraints import Constraint
from ..declared_parts import Expression, Link, Point, Track
from ..joints import Joint
from ..mechanism import Mechanism
from .cam_profile import turn_in
from .follower import STEEL, held_by, largest_pressure, rise_of, stiffness_of

_SAME = 1e-9
"""A cosine, or a share of a size, that is smaller is zero."""

_SAMPLED, _CORNERS = 721, 120


@dataclass(frozen=True, eq=False, repr=False)
class Groove(Brief):
    """Position of the roller, by the symbol ``angle`` of the drum [rad], in ground axes.

    ``place`` is its centre, ``normal`` of length one along the contact's force, ``travel`` the
    direction in which the follower moves the centre; ``axis`` is that of the drum through
    ``centre``. ``bend`` is the curvature of its path on the drum, in the plane across the roller
    [1/m], positive where it curves along the normal.
    """

    angle: Any
    place: Vector
    normal: Vector
    travel: Vector
    axis: Vector
    centre: Vector
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
    ownership.free("constraint", name, mechanism.constraints)
    stiffness = stiffness_of(what, elastic)
    held = held_by(what, mechanism, cam, follower, point, space=True)
    x = ca.SX.sym("angle")
    rise = rise_of(what, mechanism, lift, x)
    design = _groove(
        what,
        mechanism,
        x,
        ownership.expression(f"{what}: start", start, "rad" if follower.kind == "revolute" else "m")
        + rise,
        cam,
        follower,
        held,
    )
    _check(what, mechanism, design, rise, follower)
    constraint = _contact(mechanism, name, cam, held, design, rise)
    made = CylindricalCam(name, mechanism, constraint, design, cam)
    size = 0.0 if roller is None else ownership.expression(f"{what}: roller", roller, "m")
    way, drawn = _way(mechanism, design, cam), np.linspace(0.0, math.tau, _CORNERS + 1)[:-1]
    corners = [ca.vertsplit(way(ca.SX(turn), mechanism.symbols)) for turn in drawn.tolist()]
    mechanism.tracks[name] = Track(
        cam.child.on_body,
        _carried(cam, 0.0).resolve(design.axis),
        tuple((x, y, z) for x, y, z in corners),
        held.on_body,
        size,
    )
    turn = mechanism.coordinate(cam)
    beside = cross(design.normal, design.travel)
    lean = dot(design.normal, design.travel), norm(beside)
    cosine, across = (ca.substitute(ca.SX(value), x, turn) for value in lean)
    mechanism.output(f"{name}_force", mechanism.results.multiplier(constraint), unit="N")
    mechanism.output(f"{name}_pressure_angle", ca.atan2(across, cosine), unit="rad")
    if width is not None:
        if roller is None:
            raise DeclarationError(f"{what}: width needs roller, the roller's radius [m]")
        round_ = _round(what, mechanism, design, size)
        force = mechanism.results.multiplier(constraint)
        # The flank is as far beside the path as the roller's radius, on the side from which it
        # pushes.
        bend = ca.sign(force) * ca.substitute(ca.SX(design.bend), x, turn)
        curvature = 1.0 / (round_ * (1.0 + bend * round_))
        pressure = largest_pressure(what, mechanism, ca.fabs(force), curvature, width, stiffness)
        mechanism.output(f"{name}_hertz", pressure, unit="Pa")
    return made


def _way(mechanism: Mechanism, design: Groove, cam: Joint) -> ca.Function:
    """The place of the roller's centre in the drum's axes, by the angle and the parameters."""
    turned = _carried(cam, design.angle)
    here = plus(turned.resolve(minus(design.place, design.centre)), cam.child.place)
    x, y, z = map(ca.SX, here)
    column = ca.densify(ca.vertcat(x, y, z))
    return ca.Function("groove", [design.angle, mechanism.symbols], [column])


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
    direction = line if slides else _unit(cross(line, arm))
    about = _unit(minus(seat, times(dot(seat, axis), axis))) if slides else line
    moved = tuple(ca.jacobian(ca.SX(component), x) for component in place)
    on_drum = minus((moved[0], moved[1], moved[2]), cross(axis, seat))
    normal = _unit(cross(on_drum, about))
    # Its way and its second derivative as the drum sees them, which turns.
    again = tuple(ca.jacobian(ca.SX(component), x) for component in on_drum)
    bent = minus((again[0], again[1], again[2]), cross(axis, on_drum))
    beside = cross(on_drum, about)
    bend = dot(bent, normal) / dot(beside, beside)
    # Along the follower's coordinate, where the drum alone moves.
    values = list(mechanism.values().values())
    ahead = ca.Function(
        "ahead", [x, mechanism.symbols], [ca.SX(dot(cross(about, cross(axis, seat)), direction))]
    )
    side = float(ahead(0.0, values))
    if not abs(side) > 0.0:
        raise DeclarationError(
            f"{what}: the drum's surface does not pass the roller; expected the roller off the"
            " axis, and a follower along the axis"
        )
    normal, bend = (normal, bend) if side > 0.0 else (times(-1.0, normal), -bend)
    return Groove(x, place, normal, direction, axis, centre, bend)


def _round(what: str, mechanism: Mechanism, design: Groove, roller: Expression) -> Expression:
    """The radius of the roller, for which the groove's flanks must have room in its bends."""
    angles = np.linspace(0.0, math.tau, _SAMPLED)
    bend_functions = ca.Function(
        "bends", [design.angle, mechanism.symbols], [ca.SX(design.bend), ca.SX(roller)]
    )
    values = list(mechanism.values().values())
    bends, radius = (
        np.broadcast_to(row.full().ravel(), angles.shape)
        for row in bend_functions(angles[None], values)
    )
    if radius[0] <= 0.0:
        raise DeclarationError(f"{what}: roller must be positive, got {radius[0]:g} m")
    tight = int(np.argmax(np.abs(bends)))
    if abs(bends[tight]) * radius[0] >= 1.0:
        where = (
            f"{math.degrees(angles[tight]):.4g} deg of the cam, where its path has a radius of"
            f" {1.0 / abs(bends[tight]):.3g} m"
        )
        raise DeclarationError(
            f"{what}: its groove is undercut at {where}; expected a smaller roller or a slower lift"
        )
    return roller


def _check(
    what: str, mechanism: Mechanism, design: Groove, rise: Expression, follower: Joint
) -> None:
    """Raise :class:`.DeclarationError` for axes that do not lie as they must, and for a lift that
    is another after a turn.
    """
    x, p, values = design.angle, mechanism.symbols, list(mechanism.values().values())
    cosine = dot(follower.triad[0], design.axis)
    ends = [ca.substitute(rise, x, turn) for turn in (0.0, math.tau)]
    seat = minus(design.place, design.centre)
    radius = ca.norm_2(
        ca.vertcat(*map(ca.SX, minus(seat, times(dot(seat, design.axis), design.axis))))
    )
    angles = np.linspace(0.0, math.tau, 181)
    checks = ca.Function("checks", [x, p], [ca.SX(cosine), *ends, rise, radius])
    lean, first, last, direction, reach = (
        np.broadcast_to(row.full().ravel(), angles.shape) for row in checks(angles[None], values)
    )
    slides = follower.kind == "prismatic"
    if abs(abs(lean[0]) - (1.0 if slides else 0.0)) > _SAME:
        place = "along the drum's axis" if slides else "at right angles to the drum's axis"
        raise DeclarationError(f"{what}: joint '{follower.name}' must be {place}")
    if not np.isfinite(direction).all() or not reach.min() > _SAME * reach.max():
        raise DeclarationError(f"{what}: the roller reaches the drum's axis; move it away")
    if abs(last[0] - first[0]) > _SAME * (np.ptp(direction) or 1.0):
        raise DeclarationError(
            f"{what}: its lift must be the same after a turn of the cam; expected a period of 2 pi"
        )


def _contact(
    mechanism: Mechanism, name: str, cam: Joint, held: Point, design: Groove, rise: Expression
) -> Constraint:
    """The equation of the contact, in places, so that its force acts where it is."""
    drum, turn = cam.child.body, mechanism.coordinate(cam)
    assert isinstance(drum, Link)
    moment = cross(minus(design.place, design.centre), design.normal)
    # At the distance of a metre; of the moment about the axis nothing is left in it.
    far = cross(moment, design.axis)
    near = minus(design.normal, far)
    along = plus(cam.child.place, _carried(cam, 0.0).resolve(design.axis))
    ends = drum.at(*along)
    gap: Any = 0.0
    for point, arm, there in (
        (held, design.normal, design.place),
        (cam.child, times(-1.0, near), design.centre),
        (ends, times(-1.0, far), plus(design.centre, design.axis)),
    ):
        position = mechanism.place(point)
        off = minus((position[0], position[1], position[2]), there)
        gap = gap + dot(arm, off)
    phi = mechanism.ownership.expression(
        f"cam '{name}'", ca.substitute(gap, design.angle, turn), moving=True
    )
    return mechanism.constraints.setdefault(
        name, Constraint(name, phi, lift=ca.substitute(rise, design.angle, turn))
    )


def _unit(vector: Vector) -> Vector:
    return times(1.0 / norm(vector), vector)
