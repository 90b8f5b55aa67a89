"""Contact of gears: the pitch point, the direction of the force of the teeth there, and the radii
about which it turns them.

All is in the carrier's axes. At the pitch point e leads from the first gear's axis outward, t = u x
e is the way in which it moves when the gear turns about its axis u. The force of the teeth on the
first gear is lambda f + s a: f, with f . t = 1, at right angles to the teeth in the pitch plane,
and a at right angles to that plane, off the other gear.

Sources: J. E. Shigley, C. R. Mischke, *Mechanical Engineering Design*, chapter 13 (forces of spur,
helical, bevel and worm gears); G. Niemann, H. Winter, *Maschinenelemente* II, chapter 21.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from ...base.vectors import cross, dot, minus, norm, plus, times
from ...errors import DeclarationError
from ..declared_parts import Expression, Vector
from ..meshes import FITTING
from .courses import Course, along
from .fits import Fits


@dataclass(frozen=True, eq=False)
class Teeth:
    """Declared numbers of gears: radii [m] of their pitch circles, ratio of their teeth, pressure
    and helix angle [rad], hand.
    """

    radii: tuple[Expression, ...]
    ratio: Expression
    pressure: Expression
    helix: Expression
    right: bool


@dataclass(frozen=True, eq=False)
class Pitch:
    """A pitch point: its ``arm`` from the first centre, forces ``force`` and ``apart`` there, the
    ``second`` gear's place.

    The equation is radius way_1 + ``other`` way_2 = 0. ``outward`` is e, ``axis`` u. ``relative``
    is the angular velocity of the first against the second, of crossed axes the velocity with which
    it slides on that, for a unit of the first one's rate.
    """

    kind: str
    arm: Vector
    force: Vector
    apart: Vector
    reach: Vector
    other: Expression
    outward: Vector
    axis: Vector
    relative: Vector


def pitch_of(fits: Fits, first: Course, second: Course, teeth: Teeth) -> Pitch:
    """The pitch point of two gears, or of a gear and a rack, by how their axes lie.

    Raises :class:`.DeclarationError` where these do not fit.
    """
    if second.slides:
        return _rack(fits, first, second, teeth)
    number = fits.number
    across = cross(first.axis, second.axis)
    sine = number(norm(across))
    if sine < FITTING:
        return _parallel(fits, first, second, teeth)
    apart = dot(minus(second.place, first.place), across)
    scale = sine * (number(teeth.radii[0]) + number(teeth.radii[1]))
    if abs(number(apart)) < FITTING * scale:
        return _bevel(fits, first, second, teeth)
    return _crossed(fits, first, second, teeth)


def _parallel(fits: Fits, first: Course, second: Course, teeth: Teeth) -> Pitch:
    u, (r1, r2), number = first.axis, teeth.radii, fits.number
    away = minus(second.place, first.place)
    beside, sense = dot(away, u), math.copysign(1.0, number(dot(u, second.axis)))
    away = minus(away, times(beside, u))
    distance = norm(away)
    between = number(distance)
    sides = {1: r1 + r2, -1: r2 - r1, -2: r1 - r2}
    side = min(sides, key=lambda one: abs(between - number(sides[one])))
    if abs(between - number(sides[side])) > FITTING * number(r1 + r2) or between == 0.0:
        raise DeclarationError(
            f"{fits.what}: its centres are {between:.9g} m apart; expected {number(r1 + r2):.9g} m"
            f" by the radii, or {abs(number(r1 - r2)):.9g} m for a gear in a ring"
        )
    words = "its centres are {got} m apart; expected {meant} m by the radii"
    fits.same(words, distance, sides[side], r1 + r2)
    words = "its gears are offset by {got} m along the axis; expected {meant} m"
    fits.same(words, beside, 0.0, r1 + r2)
    # The pitch point is beyond the first centre where the second gear is a ring.
    e = along(away, distance if side != -1 else -distance)
    # Off the teeth: toward the axis of a gear, away from that of a ring.
    off = times(1 if side == -2 else -1, e)
    other = r2 * sense if side == 1 else -(r2 * sense)
    relative = plus(u, times(r1 / other, second.axis))
    lean = times(-ca.tan(teeth.helix), u)
    return _pitch("parallel", first, second, teeth, e, lean, off, other, relative)


def _bevel(fits: Fits, first: Course, second: Course, teeth: Teeth) -> Pitch:
    """Both cones have their apex where the axes meet; their mean circles, of the radii, touch."""
    u, v, (r1, r2) = first.axis, second.axis, teeth.radii
    # How far the centres are from where the axes meet: the feet of the common perpendicular are
    # one.
    away, slope = minus(second.place, first.place), dot(u, v)
    steep = 1 - slope * slope
    far1 = -(dot(away, u) - slope * dot(away, v)) / steep
    far2 = (dot(away, v) - slope * dot(away, u)) / steep
    one, two = (math.copysign(1.0, fits.number(far)) for far in (far1, far2))
    w1, w2, cosine = times(one, u), times(two, v), one * two * slope
    sine = ca.sqrt(1 - cosine * cosine)
    heights = (r2 + r1 * cosine) / sine, (r1 + r2 * cosine) / sine
    for k, (far, height) in enumerate(zip((one * far1, two * far2), heights, strict=True), 1):
        words = (
            f"the centre of its gear {k} is {{got}} m from where the axes meet; expected"
            " {meant} m by the radii"
        )
        fits.same(words, far, height, r1 + r2)
    words = "the axes of its gears are {got} m apart; expected {meant} m"
    fits.same(words, dot(away, cross(u, v)) / sine, 0.0, r1 + r2)
    e = along(minus(w2, times(cosine, w1)), sine)
    slant = ca.sqrt(heights[0] * heights[0] + r1 * r1)
    generator = along(plus(times(heights[0], w1), times(r1, e)), slant)
    off = along(minus(times(r1, w1), times(heights[0], e)), slant)
    lean = times(-ca.tan(teeth.helix) * one, generator)
    other = one * two * r2
    relative = plus(u, times(r1 / other, v))
    return _pitch("bevel", first, second, teeth, e, lean, off, other, relative)


def _crossed(fits: Fits, first: Course, second: Course, teeth: Teeth) -> Pitch:
    """A worm and its wheel, or crossed helical gears: the teeth lie so that the ratio is that of
    their numbers.
    """
    u, v, (r1, r2) = first.axis, second.axis, teeth.radii
    away = minus(second.place, first.place)
    distance = norm(away)
    for k, axis in ((1, u), (2, v)):
        words = (
            f"the centre of its gear {k} is {{got}} m along its axis from the common"
            " perpendicular of both axes; expected {meant} m"
        )
        fits.same(words, dot(away, axis), 0.0, r1 + r2)
    words = "its centres are {got} m apart; expected {meant} m as the sum of their radii"
    fits.same(words, distance, r1 + r2, r1 + r2)
    e = along(away, distance)
    cosine, sine = dot(u, v), dot(u, cross(v, e))
    leans = [(sign * teeth.ratio * r1 / r2 - cosine) / sine for sign in (1, -1)]
    right = [fits.number(lean) < 0.0 for lean in leans]
    if right[0] == right[1]:
        raise DeclarationError(
            f"{fits.what}: radii and numbers of teeth do not fit the angle between its axes"
        )
    sign = 1 if right[0] == teeth.right else -1
    lean = times(leans[0] if sign == 1 else leans[1], u)
    other = sign * teeth.ratio * r1
    sliding = minus(times(r1, cross(u, e)), times(r1 * r2 / other, cross(v, e)))
    return _pitch("crossed", first, second, teeth, e, lean, times(-1, e), other, sliding)


def _rack(fits: Fits, first: Course, second: Course, teeth: Teeth) -> Pitch:
    u, d, (radius, *_) = first.axis, second.axis, teeth.radii
    if abs(fits.number(dot(u, d))) > FITTING:
        raise DeclarationError(
            f"{fits.what}: its rack must slide at right angles to the axis of its gear"
        )
    away = minus(second.place, first.place)
    across = minus(away, times(dot(away, d), d))
    beside = dot(across, u)
    across = minus(across, times(beside, u))
    distance = norm(across)
    words = (
        "the pitch line of its rack is {got} m from the axis of its gear; expected its radius,"
        " {meant} m"
    )
    fits.same(words, distance, radius, radius)
    words = "its rack is offset by {got} m from its gear; expected {meant} m"
    fits.same(words, beside, 0.0, radius)
    e = along(across, distance)
    lean = times(-ca.tan(teeth.helix), u)
    other = math.copysign(1.0, -fits.number(dot(cross(u, e), d)))
    return _pitch("rack", first, second, teeth, e, lean, times(-1, e), other, u)


def _pitch(
    kind: str,
    first: Course,
    second: Course,
    teeth: Teeth,
    outward: Vector,
    lean: Vector,
    off: Vector,
    other: Expression,
    relative: Vector,
) -> Pitch:
    """A pitch point at which teeth ``lean`` along the pitch surface, of which ``off`` leads at
    right angles off the second gear.
    """
    arm = times(teeth.radii[0], outward)
    force = plus(cross(first.axis, outward), lean)
    apart = times(ca.tan(teeth.pressure) * ca.sqrt(1 + dot(lean, lean)), off)
    reach = arm if second.slides else minus(second.place, first.place)
    return Pitch(kind, arm, force, apart, reach, other, outward, first.axis, relative)
