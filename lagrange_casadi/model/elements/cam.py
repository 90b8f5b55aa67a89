"""Disc cams with the real forces of their contact: translating and swinging followers with a
roller, a knife edge or a flat face.

A follower's motion is given as a law of the cam's angle. Where the contact is, and along which
normal it acts, follows from that: a point A of the follower is at a(theta), and the contact acts
along n(theta) through it, with a moment tau(theta) about it where it acts beside it. The equation
of contact is n . (A - C - a) + tau sin(turn), C the cam's centre and turn how far the follower is
from where it should be turned. Its multiplier is the force of the contact, on both bodies along its
true line of action.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import casadi as ca
import numpy as np

from ...base.arguments import Count, Elastic, public
from ...base.brief import Brief
from ...base.rotation import Rotation
from ...base.scalars import column, graph
from ...base.vectors import Vector, cross, dot, minus, norm, plus, times
from ...errors import DeclarationError
from ..constraints import Constraint
from ..declared_parts import Expression, Link, Outline, Point, Roller
from ..joints import Joint
from ..mechanism import Mechanism
from .cam_profile import CamProfile, turn_in
from .follower import (
    STEEL,
    Touch,
    contact,
    held_by,
    output_pressure,
    positive,
    rise_of,
    stiffness_of,
    unit,
)

_SAME = 1e-9
"""Relative gap of a closed profile that is rounding."""

_CORNERS = 240
"""Corners by which pictures show a profile."""


@dataclass(frozen=True, eq=False, repr=False)
class Design(Touch):
    """Position of the contact of a disc cam, from the cam's centre.

    ``arm`` leads from the follower's point to where the cam touches it. ``turned`` is the direction
    of the follower's own axis, None where nothing depends on it.
    """

    arm: Vector
    turned: Vector | None

    @property
    def contact(self) -> Vector:
        """The place at which both touch."""
        return plus(self.place, self.arm)

    @property
    def progress(self) -> Expression:
        """Speed of the contact along the cam by its angle [m], counter-clockwise round it: undercut
        if it is not negative.
        """
        (x, y, _), angle = self.contact, self.angle
        moved = ca.jacobian(x, angle) + y, ca.jacobian(y, angle) - x, 0.0
        return cross(self.normal, moved)[2]

    @property
    def curvature(self) -> Expression:
        """The radius of curvature of the profile [m]: positive where it is convex; infinite where
        it is straight.
        """
        lean = -ca.atan2(self.normal[0], self.normal[1]) - self.angle
        return self.progress / ca.jacobian(lean, self.angle)


@public
@dataclass(frozen=True, eq=False, repr=False)
class Cam(Brief):
    """A disc cam: its ``constraint``, whose multiplier is the force of its contact, and its
    ``design``.

    Outputs are NAME_force [N], positive where the cam pushes, NAME_pressure_angle [rad] between the
    force and the way of the follower's point, NAME_radius [m] of the cam's profile, positive where
    that is convex, and with a width NAME_hertz [Pa].
    """

    name: str
    mechanism: Mechanism
    constraint: Constraint
    design: Design

    def profile(
        self, parameters: dict[str, float] | None = None, *, count: Count = 720
    ) -> CamProfile:
        """Return the cam's profile at angles of one turn.

        Parameters
        ----------
        parameters : dict, optional
            Values by name; by default the parameters' defaults.
        count : int
            Number of angles, 16 to a million.

        Returns
        -------
        CamProfile
            The profile, in the cam's own axes.

        Raises
        ------
        UnknownNameError
            For a name that is not a parameter.
        ParameterError
            For values that are out of range, or make a part impossible.
        DeclarationError
            For another count, and if the follower cannot touch the cam.
        """
        design, x, values = self.design, self.design.angle, self.mechanism.values(parameters)
        back = Rotation.by(-x)
        rows = [
            *back.apply(design.contact)[:2],
            *back.apply(design.place)[:2],
            design.pressure_angle,
            design.curvature,
            design.progress,
        ]
        given = {"angle": x, "p": self.mechanism.symbols}
        function = graph("profile", given, rows=column(rows))
        angle = turn_in(self.name, count)
        found = function(angle[None], list(values.values())).full()
        # A straight profile has no radius.
        if not np.isfinite(np.delete(found, 5, axis=0)).all():
            raise DeclarationError(
                f"cam '{self.name}': the follower cannot touch the base circle, because the"
                " follower is too short or too close to the cam's shaft; point= says which of its"
                " points touches, its tip by default"
            )
        size = float(np.abs(found[:2]).max())
        closes = bool(np.abs(found[:2, -1] - found[:2, 0]).max() <= _SAME * size)
        x, y, pitch_x, pitch_y, pressure, radius, progress = found[:, :-1]
        return CamProfile(
            self.name, angle[:-1], x, y, pitch_x, pitch_y, pressure, radius, progress >= 0.0, closes
        )


@public
def disc_cam(
    mechanism: Mechanism,
    name: str,
    cam: Joint,
    follower: Joint,
    lift: Callable[[Expression], Expression],
    *,
    base_radius: Expression,
    point: Point | None = None,
    roller: Expression | None = None,
    flat: bool = False,
    side: int = 1,
    width: Expression | None = None,
    elastic: Elastic = STEEL,
) -> Cam:
    """Declare the contact of a disc cam with its follower in a plane, from the follower's motion.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    cam, follower
        The revolute joint of the cam on the ground, and the joint of the follower on the ground:
        prismatic for a translating one, whose line leads away from the cam, or revolute for a
        swinging one.
    lift
        The follower's rise [m], or its swing [rad] away from the cam, as a function of the cam's
        angle: a motion of ``moves``, a ``curve``, or any function that takes and returns CasADi's
        expressions. It must be periodic by a turn and zero at its least.
    base_radius
        The radius of the cam's base circle [m].
    point
        The centre of the follower's roller, or its knife edge; by default the point at which the
        joint holds it.
    roller, flat
        The radius of the roller [m]; a ``flat`` face instead, at right angles to the way of a
        translating follower, or along the axis of a swinging one, through its pin; a knife edge
        without both.
    side
        1 for a swinging follower that swings counter-clockwise away from the cam, -1 for one that
        swings clockwise.
    width, elastic
        The width of the contact [m], for the pressure of Hertz, and Young's modulus [Pa] and
        Poisson's ratio of both bodies.

    Returns
    -------
    Cam
        The contact, with its constraint and the numbers of its profile.

    Raises
    ------
    DeclarationError
        For joints of other kinds, a lift that is no function, and a profile that is undercut with
        the default parameters.
    """
    what = f"cam '{name}'"
    stiffness = stiffness_of(what, elastic)
    layout = layout_of(what, mechanism, cam, follower, point, roller, flat, side)
    base = positive(mechanism, what, "base_radius", base_radius)
    x, rise = rise_of(what, mechanism, lift)
    make = (
        (_translating_flat if flat else _translating)
        if follower.kind == "prismatic"
        else (_swinging_flat if flat else _swinging)
    )
    design = make(base, x, rise, layout)
    gap = _gap(mechanism, cam, layout.held, design)
    made = Cam(name, mechanism, contact(mechanism, name, cam, design, gap, rise), design)
    mechanism.one_way[f"{name}_force"] = f"cam '{name}': the follower lifts off"
    radius = ca.substitute(design.curvature, x, mechanism.coordinate(cam))
    mechanism.output(f"{name}_radius", radius, unit="m")
    if width is not None:
        force = ca.fmax(mechanism.results.multiplier(made.constraint), 0.0)
        curved = 1.0 / radius if roller is None else 1.0 / radius + 1.0 / layout.roller
        output_pressure(mechanism, name, force, curved, width, stiffness)
    mechanism.outlines.setdefault(cam.child.body.name, []).append(_outline(made, cam.child))
    if roller is not None:
        mechanism.rollers[name] = Roller(layout.held.on_body, layout.roller)
    profile = made.profile()
    if profile.undercut.any():
        raise DeclarationError(
            f"{what}: {profile.undercut_summary}; expected a larger base radius, a smaller roller"
            " or a slower lift"
        )
    return made


@dataclass(frozen=True, eq=False)
class Layout:
    """Positions of a cam and its follower."""

    cam: Joint
    follower: Joint
    held: Point
    roller: Expression
    side: int

    @property
    def away(self) -> Vector:
        """Vector from the cam's centre to the place on the ground at which the follower is
        guided.
        """
        return minus(self.follower.parent.place, self.cam.parent.place)

    @property
    def arm(self) -> Vector:
        """Vector from the point at which the follower is guided to the one that touches, in the
        follower's axes.
        """
        return minus(self.held.place, self.follower.child.place)

    @property
    def offset(self) -> tuple[Expression, Vector, Vector]:
        """Distance of a translating follower's line from the cam's centre, the direction across
        the line in which it is, and the direction of the line.
        """
        up, across, _ = self.follower.triad
        aside = times(-1, across)
        seat = plus(self.away, self.follower.turned.apply(self.arm))
        return dot(seat, aside), aside, up


def layout_of(
    what: str,
    mechanism: Mechanism,
    cam: Joint,
    follower: Joint,
    point: Point | None,
    roller: Expression | None,
    flat: bool,
    side: int,
) -> Layout:
    """Check the arguments of :func:`disc_cam` on a cam and its follower.

    Raises :class:`.DeclarationError` as that does.
    """
    held = held_by(what, mechanism, cam, follower, point, space=False)
    if flat and (roller is not None or point is not None):
        raise DeclarationError(f"{what}: a flat face has neither a roller nor a point")
    if side not in (1, -1):
        raise DeclarationError(f"{what}: side must be 1 or -1, got {side!r}")
    radius = 0.0 if roller is None else positive(mechanism, what, "roller", roller)
    return Layout(cam, follower, held, radius, side)


def _rolling(x: Expression, place: Vector, travel: Vector, roller: Expression) -> Design:
    """A design whose normal is that outward of the curve which the follower's point makes on the
    cam.
    """
    # At right angles to how the point moves on the cam.
    normal = unit((place[0] - ca.jacobian(place[1], x), place[1] + ca.jacobian(place[0], x), 0.0))
    return Design(x, place, normal, travel, times(-roller, normal), None)


def _translating(base: Expression, x: Expression, rise: Expression, layout: Layout) -> Design:
    offset, aside, up = layout.offset
    height = ca.sqrt((base + layout.roller) ** 2 - offset * offset) + rise
    place = plus(times(offset, aside), times(height, up))
    return _rolling(x, place, up, layout.roller)


def _translating_flat(base: Expression, x: Expression, rise: Expression, layout: Layout) -> Design:
    offset, aside, up = layout.offset
    place = plus(times(offset, aside), times(base + rise, up))
    # It touches beside the line through the cam's centre by the slope of the lift.
    arm = times(ca.jacobian(rise, x) - offset, aside)
    return Design(x, place, up, up, arm, layout.follower.turned.x)


def _swinging(base: Expression, x: Expression, rise: Expression, layout: Layout) -> Design:
    length, distance, prime = norm(layout.arm), norm(layout.away), base + layout.roller
    cosine = (length**2 + distance**2 - prime**2) / (2.0 * length * distance)
    along, across = _swung(layout, rise, cosine, distance)
    return _rolling(x, plus(layout.away, times(length, along)), across, layout.roller)


def _swinging_flat(base: Expression, x: Expression, rise: Expression, layout: Layout) -> Design:
    away, distance = layout.away, norm(layout.away)
    sine = base / distance
    along, normal = _swung(layout, rise, ca.sqrt(1.0 - sine * sine), distance)
    # The normal passes through the point at which both turn alike.
    arm = times(-dot(away, along) / (1.0 - layout.side * ca.jacobian(rise, x)), along)
    return Design(x, away, normal, normal, arm, along)


def _swung(
    layout: Layout, rise: Expression, cosine: Expression, distance: Expression
) -> tuple[Vector, Vector]:
    """The direction of the arm of a swinging follower, and that in which it swings away from the
    cam.

    On the base circle the arm is at an angle of this ``cosine`` to the line from its pin to the
    cam's centre.
    """
    x, y = -layout.away[0] / distance, -layout.away[1] / distance
    sine = layout.side * ca.sqrt(1.0 - cosine * cosine)
    least = cosine * x - sine * y, sine * x + cosine * y, 0.0
    along = Rotation.by(layout.side * rise).apply(least)
    return along, (-layout.side * along[1], layout.side * along[0], 0.0)


def _gap(mechanism: Mechanism, cam: Joint, touched: Point, design: Design) -> Expression:
    """The equation of the contact, in places, so that its force acts where it is."""
    (x, y), (x0, y0) = mechanism.place(cam.child), mechanism.place(touched)
    gap = dot(design.normal, minus((x0 - x, y0 - y, 0.0), design.place))
    if design.turned is not None:
        lean = mechanism.direction(cast(Link, touched.body))
        seen = cross(design.turned, (ca.cos(lean), ca.sin(lean), 0.0))[2]
        gap = gap + cross(design.arm, design.normal)[2] * seen
    return gap


def _outline(made: Cam, shaft: Point) -> Outline:
    """Corners of the profile in the axes of the cam's link, whose point is on the ``shaft`` [m]."""
    design, symbols = made.design, made.mechanism.symbols
    x, y, _ = plus(shaft.place, Rotation.by(-design.angle).apply(design.contact))
    corner = ca.Function("corner", [design.angle, symbols], [ca.SX(x), ca.SX(y)])
    return [corner(ca.SX(math.tau * k / _CORNERS), symbols) for k in range(_CORNERS)]
