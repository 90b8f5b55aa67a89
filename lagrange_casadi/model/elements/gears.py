"""Gears that mesh, of any kind by how their axes lie, with the real forces of their teeth on
bearings and shafts.

Parallel axes make spur and helical gears, and a gear in a ring where one is inside the other; axes
that meet make bevel gears; axes that cross make a worm and its wheel; a body that slides makes a
rack. One function declares all of them, because they are one thing: a force along the teeth at the
pitch point, and what presses the gears apart.

A part of the power that they pass on is lost by a couple between the gears against the turning of
one on the other: it stands for the force of the teeth beside the pitch point. So nothing but the
gears bears it, as with real teeth. With the ratio q of the rate of one gear on the other to that of
the first, and the cosine k between their axes of turning, the couple is

    c = (1 - efficiency) r |W|/(q - (1 - efficiency) k)             where the first drives,
    c = (1 - efficiency) r |W|/(efficiency q + (1 - efficiency) k)  where the second does.

In place of it there may be the friction of teeth that slide on each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import casadi as ca

from ...base.arguments import public
from ...base.brief import Brief
from ...base.vectors import cross, dot, minus, norm, plus, times
from ...errors import DeclarationError
from ..constraints import Constraint
from ..declared_parts import Body, Expression, PitchCircles, Point
from ..mechanism import Mechanism
from ..meshes import Loss, Mesh, Transmission, Wrench
from .contact import output_loss, touching
from .courses import Course, along, courses_on, keep_on_axis
from .fits import LEAST, Fits
from .pitch import Pitch, Teeth, pitch_of


@dataclass(frozen=True, eq=False, repr=False)
class Gears(Brief):
    """Gears that mesh: their ``constraint``, whose multiplier is the force along the pitch circle
    [N], and their ``kind``.

    ``ratio`` is the second coordinate's rate over the first one's.
    """

    constraint: Constraint
    kind: str
    ratio: Expression


@public
def gears(
    mechanism: Mechanism,
    name: str,
    first: Body | Point,
    second: Body | Point | Sequence[Body | Point],
    *,
    teeth: Sequence[Expression] | None = None,
    module: Expression | None = None,
    radii: Sequence[Expression] | None = None,
    pressure_angle: Expression = "20 deg",
    helix_angle: Expression = 0.0,
    hand: Literal["right", "left"] = "right",
    efficiency: Expression | None = None,
    mu: Expression | None = None,
    carrier: Body | None = None,
    offset: Expression = 0.0,
) -> Gears:
    """Let two gears mesh, or a gear and a rack, and bear the force of their teeth where they touch.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    first, second
        The centres of the gears: points of bodies, on the axes about which revolute joints let
        these turn. A link stands for its base, the ground for its origin. A rack is a point of a
        body that slides, on its pitch line. Several second gears, alike, share the load evenly;
        what ties their own turning must be declared beside.
    teeth, module
        Numbers of teeth, and the module in the plane at right angles to the teeth [m]: the radii
        are module teeth/(2 cos helix). A rack takes the teeth of its gear alone.
    radii
        Radii of the pitch circles [m] in place of the module: of bevel gears in the middle of the
        teeth's width. Crossed axes need both the numbers of teeth and the radii.
    pressure_angle, helix_angle
        Angles [rad, or text as ``"20 deg"``] at right angles to the teeth, and between the teeth
        and the axis (or the cone's side): positive where the teeth of the first gear are a
        right-handed screw. A plane has no helix.
    hand
        Of crossed axes, the hand of the first gear's teeth.
    efficiency
        What comes out of the mesh over what goes into it, whichever gear drives, seen from the
        carrier; by default nothing is lost.
    mu
        Of crossed axes in its place the friction coefficient of the teeth, which slide on each
        other.
    carrier
        The body on which both turn; by default it follows from the joints.
    offset
        The way that the first pitch circle is ahead where both coordinates are zero [m].

    Returns
    -------
    Gears
        The mesh. Its multiplier is the force along the pitch circle on the first gear, positive
        where it turns this forward; its sign decides which flanks touch, and both flanks press the
        gears apart. Outputs are NAME_tangential, NAME_radial toward the axis of the first gear, or
        off it of a ring, and in space NAME_axial on the first gear along its joint's axis [N]:
        without friction. With friction NAME_loss is the power that all meshes take [W]; at rest it
        is indeterminate, as in joints with friction.

    Raises
    ------
    DeclarationError
        For bodies that do not turn about axes through these points, centres that do not fit the
        radii, numbers of teeth that are not whole, and angles out of range. Values of parameters
        that violate these are refused as well.
    """
    what, ownership = f"gears '{name}'", mechanism.ownership
    if hand not in ("right", "left"):
        raise DeclarationError(f"{what}: hand must be 'right' or 'left', got {hand!r}")
    centre = ownership.point(what, first)
    many = [
        ownership.point(what, one) for one in (second if isinstance(second, Sequence) else [second])
    ]
    if not many:
        raise DeclarationError(f"{what}: expected a second gear")
    found = [courses_on(mechanism, what, centre, one, carrier) for one in many]
    fits = Fits(what, ownership.at_defaults)
    angles, right = (pressure_angle, helix_angle), hand == "right"
    toothing = _teeth(fits, mechanism, found[0], teeth, module, radii, angles, right)
    pitches = [pitch_of(fits, *pair, toothing) for pair in found]
    loss = _loss_of(fits, mechanism, name, found[0][0], pitches[0], toothing, efficiency, mu)
    meshes, circles = [], {}
    for k, (pair, pitch, point) in enumerate(zip(found, pitches, many, strict=True), 1):
        if pitch.kind == "crossed" and (teeth is None or radii is None):
            raise DeclarationError(
                f"{what}: gears with crossed axes need teeth= and radii= of both gears"
            )
        mesh = _mesh(mechanism, centre, point, *pair, pitch)
        meshes.append(mesh if loss is None else replace(mesh, braking=_braking_of(pitch)))
        keep_on_axis(fits, *pair)
        circles[f"{name}_{k}" if len(many) > 1 else name] = PitchCircles(
            pair[0].carrier.name,
            (pair[0].place, pair[1].place),
            (pair[0].axis, pair[1].axis),
            (toothing.radii[0], 0.0 if pair[1].slides else toothing.radii[1]),
            rack=point.on_body if pair[1].slides else None,
        )
    directions = [course.displacement(mechanism) for course in found[0]]
    ahead = ownership.expression(f"{what}: offset", offset, "m")
    phi = toothing.radii[0] * directions[0] + pitches[0].other * directions[1] - ahead
    transmission = Transmission(name, tuple(meshes), 0.0, tuple(fits.found), loss)
    constraint = touching(mechanism, name, phi, transmission=transmission)
    mechanism.pitch_circles |= circles
    _outputs(mechanism, name, constraint, pitches[0])
    if loss is not None:
        output_loss(mechanism, constraint, loss, len(meshes) * norm(pitches[0].relative))
    return Gears(constraint, pitches[0].kind, -(toothing.radii[0] / pitches[0].other))


def _teeth(
    fits: Fits,
    mechanism: Mechanism,
    pair: tuple[Course, Course],
    teeth: Sequence[Expression] | None,
    module: Expression | None,
    radii: Sequence[Expression] | None,
    angles: tuple[Expression, Expression],
    right: bool,
) -> Teeth:
    """Radii, ratio and angles."""
    what, ownership, count = fits.what, mechanism.ownership, 1 if pair[1].slides else 2

    def each(word: str, values: Expression, unit: str = "1") -> list[Expression]:
        listed = list(values) if isinstance(values, (list, tuple)) else [values]
        if len(listed) != count:
            raise DeclarationError(f"{what}: expected {count} {word}, got {len(listed)}")
        return [ownership.expression(f"{what}: {word}", value, unit) for value in listed]

    if (module is None) == (radii is None) or (radii is None and teeth is None):
        raise DeclarationError(f"{what}: expected module= and teeth=, or radii=")
    pressure = ownership.expression(f"{what}: pressure_angle", angles[0], "rad")
    helix = ownership.expression(f"{what}: helix_angle", angles[1], "rad")
    fits.within("pressure_angle", pressure, 0.0, 45.0)
    fits.within("helix_angle", helix, -75.0, 75.0)
    if not mechanism.space and not (isinstance(helix, float) and helix == 0.0):
        raise DeclarationError(
            f"{what}: gears in a plane have no helix; in space declare a SpatialMechanism"
        )
    z = [] if teeth is None else each("numbers of teeth", teeth)
    for value in z:
        fits.whole("numbers of teeth", value)
    if module is not None:
        size = ownership.expression(f"{what}: module", module, "m")
        fits.positive("module", size)
        r = [size * value / (2 * ca.cos(helix)) for value in z]
    else:
        r = each("radii", radii, "m")
        for value in r:
            fits.positive("radii", value)
    first, *second = z or r
    return Teeth(tuple(r), second[0] / first if second else 1.0, pressure, helix, right)


def _mesh(
    mechanism: Mechanism, first: Point, second: Point, one: Course, two: Course, pitch: Pitch
) -> Mesh:
    """Place where two gears touch; on a rack the place moves."""
    if two.slides:
        direction = two.displacement(mechanism)
        way = minus(plus(one.place, pitch.arm), plus(two.place, times(direction, two.axis)))
        x, y, z = plus(second.place, two.seen.resolve(way))
        second = Point(second.body, x, y, z=z)
    wrenches = (Wrench(force, cross(pitch.arm, force)) for force in (pitch.force, pitch.apart))
    return Mesh(first, second, one.carrier, one.place, pitch.reach, *wrenches)


def _outputs(mechanism: Mechanism, name: str, constraint: Constraint, pitch: Pitch) -> None:
    force = mechanism.results.multiplier(constraint)
    size = ca.fabs(force)
    radial = ca.fabs(ca.SX(dot(pitch.apart, pitch.outward)))
    mechanism.output(f"{name}_tangential", force, unit="N")
    mechanism.output(f"{name}_radial", radial * size, unit="N")
    if mechanism.space:
        along, apart = (dot(one, pitch.axis) for one in (pitch.force, pitch.apart))
        mechanism.output(f"{name}_axial", along * force + apart * size, unit="N")


def _braking_of(pitch: Pitch) -> Wrench:
    """Action of a unit of friction on the first gear: a couple against its turning on the second,
    or a force against sliding.
    """
    direction = along(pitch.relative, norm(pitch.relative))
    if pitch.kind == "crossed":
        return Wrench(direction, cross(pitch.arm, direction))
    return Wrench(couple=direction)


def _loss_of(
    fits: Fits,
    mechanism: Mechanism,
    name: str,
    first: Course,
    pitch: Pitch,
    teeth: Teeth,
    efficiency: Expression | None,
    mu: Expression | None,
) -> Loss | None:
    """The law of a loss, if there is one. Raises :class:`.DeclarationError` for numbers that cannot
    be.
    """
    what, ownership = fits.what, mechanism.ownership
    if mu is None and efficiency is None:
        return None
    if (mu is None) == (pitch.kind == "crossed") or (mu is not None and efficiency is not None):
        raise DeclarationError(f"{what}: expected mu= for crossed axes, efficiency= for others")
    if mu is not None:
        value = ownership.expression(f"{what}: mu", mu)
        fits.at_least("mu must not be negative", value, 0.0, value)
        # The force at right angles to the teeth, of that along the pitch circle.
        arm = value * norm(pitch.force) / ca.cos(teeth.pressure)
        return Loss(f"{name}:loss", arm, 0.0, first.rotations)
    value = ownership.expression(f"{what}: efficiency", efficiency)
    fits.share(value)
    q, radius = norm(pitch.relative), teeth.radii[0]
    k = dot(pitch.axis, pitch.relative) / q
    slip = 1 - value
    driving, driven = q - slip * k, value * q + slip * k
    for divisor in (driving, driven):
        fits.at_least("efficiency is too low for a gear in this ring", divisor, LEAST, value)
    ahead, back = slip * radius / driving, slip * radius / driven
    return Loss(f"{name}:loss", (ahead + back) / 2, (back - ahead) / 2, first.rotations)
