"""Arguments that are more than numbers: friction and drives of joints, and loads along a link."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

import casadi as ca

from ..errors import DeclarationError
from .declared_parts import Expression, Link
from .drives import Drive
from .expressions import expressed
from .joints import Axis, Joint
from .loads import POSITIVE, Friction, LineLoad
from .ownership import Ownership
from .polynomials import powers

LoadDensity: TypeAlias = "Expression | tuple[Expression, Expression] | Callable[[Any], Expression]"
"""A value along a link: one throughout, a pair for where it begins and ends, or a polynomial of the
distance from the base.
"""

Between: TypeAlias = "tuple[Expression, Expression] | None"
"""Distances from the base of a link [m], between which a load acts; None is the whole link."""

HIGHEST = 7
"""The highest power of the distance that a load may have."""

_UNITS = {"radius": "m", "length": "m", "stribeck": "m/s"}
_IN_PLANE = ("revolute", "prismatic", "slot")
_IN_SPACE = ("revolute", "prismatic", "cylindrical", "screw", "spherical")


def line_load(
    own: Ownership,
    name: str,
    link: Link,
    components: Sequence[LoadDensity],
    between: Between,
    turning: bool,
) -> LineLoad:
    """A load along a link of a mechanism, of so many ``components``.

    Raises :class:`DeclarationError` for what is no link, for ends that are no pair, and for what is
    no polynomial along the link.
    """
    own.free("load", name, own.declared.loads)
    what = f"load '{name}'"
    body = own.point(what, link).body
    if not isinstance(body, Link):
        raise DeclarationError(
            f"{what}: expected a link for a line load, got '{body.name}'; use a force at a point"
        )

    def checked(value: Expression) -> Expression:
        return own.expression(what, value, "N/m", moving=True)

    if between is None:
        start: Expression = 0.0
        end = body.length
    else:
        if not isinstance(between, tuple | list) or len(between) != 2:
            raise DeclarationError(
                f"{what}: between must be two distances from the base of '{body.name}' [m], got"
                f" {between!r}"
            )
        places = (own.expression(f"{what}: between", place, "m") for place in between)
        start, end = (own.along(what, place, body) for place in places)
        if isinstance(start, float) and isinstance(end, float) and not start < end:
            raise DeclarationError(
                f"{what}: between must be two increasing distances from the base, got {start:g}"
                f" and {end:g} m"
            )
    found = [_powers(what, value, start, end, checked) for value in components]
    many = max(map(len, found))
    x, y, *z = ((*coefficients, *[0.0] * (many - len(coefficients))) for coefficients in found)
    return LineLoad(name, body, (start, end), x, y, z[0] if z else (0.0,) * many, turning)


def _powers(
    what: str,
    value: LoadDensity,
    start: Expression,
    end: Expression,
    checked: Callable[[Expression], Expression],
) -> list[Expression]:
    """Coefficients by powers of (end - xi)/(end - start)."""
    if callable(value):
        distance = ca.SX.sym("xi")
        given = expressed(what, value, [distance], "the distance from the base")
        if not isinstance(given, ca.SX) or given.numel() != 1:
            return [checked(given)]
        # With numbers for ends the polynomial is rounded once; a symbol that is foreign is refused
        # by the coefficients.
        found = powers(given, distance, (ca.SX(end), ca.SX(start - end)))
        if found is None or len(found) > HIGHEST + 1:
            raise DeclarationError(
                f"{what} must be a polynomial of the distance from the base, of degree {HIGHEST} at"
                " most; use one load for each part of the link on which it is a polynomial"
            )
        return [checked(coefficient) for coefficient in found]
    pair = tuple(value) if isinstance(value, tuple | list) else (value,)
    if len(pair) > 2 or not pair:
        raise DeclarationError(
            f"{what}: expected one value, two values at its start and end, or a function of the"
            f" distance from the base [m], got {value!r}"
        )
    first, last = checked(pair[0]), checked(pair[-1])
    return [last, first - last] if len(pair) == 2 else [last]


def friction(
    own: Ownership, name: str, joint: Joint, along: str, given: Mapping[str, Expression | None]
) -> Friction:
    """Friction in a joint of a mechanism, with the numbers ``given``; ``along`` names a coordinate
    of a joint of two.

    Raises :class:`DeclarationError` where the joint has no such friction, and where a number is
    missing or says nothing.
    """
    own.free("load", name, own.declared.loads)
    what = f"friction '{name}'"
    axis, beside = _axes(own, what, joint, along)
    angular = axis.kind == "angle"
    units = _UNITS | {
        "coulomb": "N m" if angular else "N",
        "smooth": "rad/s" if angular else "m/s",
        "viscous": "N m s/rad" if angular else "N s/m",
    }
    numbers = {
        key: _number(own, what, key, value, units.get(key, "1"))
        for key, value in given.items()
        if value is not None
    }
    _require(what, joint, axis, numbers)
    if numbers.get("static") is not None and "stribeck" not in numbers:
        raise DeclarationError(
            f"{what}: static needs stribeck=, the sliding speed [m/s] within which friction falls"
            " from static to mu"
        )
    if "stribeck" in numbers and "static" not in numbers:
        raise DeclarationError(
            f"{what}: stribeck needs static=, the friction coefficient at the start of sliding"
        )
    if "coulomb" in numbers:
        beside = None
    if beside is not None and "smooth" in numbers:
        raise DeclarationError(
            f"{what}: joint '{joint.name}' slides and turns at once, for which smooth= is not"
            " available; leave smooth out"
        )
    symbol = ca.SX.sym(f"friction_{name}")
    return Friction(name, joint, axis, symbol, beside=beside, **numbers)


def drive(
    own: Ownership, name: str, joint: Joint, ratio: Expression, given: Mapping[str, Expression]
) -> Drive:
    """A drive of a joint of a mechanism, with the numbers ``given``.

    Raises :class:`DeclarationError` for a joint that has not one coordinate, or has a drive, and
    for numbers that no drive has.
    """
    own.free("drive", name, own.declared.drives)
    what = f"drive '{name}'"
    if len(own.joint(joint).axes) != 1:
        raise DeclarationError(
            f"{what}: expected a joint of one coordinate, got {joint.kind} joint '{joint.name}';"
            " use a chain of joints of one coordinate each"
        )
    (axis,) = joint.axes
    for other in own.declared.drives.values():
        if other.joint is joint:
            raise DeclarationError(f"{what}: joint '{joint.name}' has one already, '{other.name}'")
    angular = axis.kind == "angle"
    kinds = ("N m", "rad/s", "kg m^2") if angular else ("N", "m/s", "kg")
    units = dict(zip(("effort", "speed", "armature"), kinds, strict=True))
    units["rotor_inertia"] = "kg m^2"
    numbers = {
        word: _number(own, what, word, value, units.get(word, "1"))
        for word, value in given.items()
        if value is not None
    }
    ratio = own.expression(f"{what}: ratio", ratio, "1" if angular else "rad/m")
    if not isinstance(ratio, ca.SX) and ratio == 0.0:
        raise DeclarationError(f"{what}: ratio must not be 0: the rotor would stand still")
    return Drive(name, joint, axis, ratio=ratio, **numbers)


def _axes(own: Ownership, what: str, joint: Joint, along: str) -> tuple[Axis, Axis | None]:
    """The coordinate along which it acts, and the other one of a joint that has two."""
    own.joint(joint)
    valid = _IN_SPACE if own.declared.space else _IN_PLANE
    if joint.kind not in valid:
        where = "space" if own.declared.space else "a plane"
        raise DeclarationError(
            f"{what}: joint '{joint.name}' is {joint.kind}; in {where} friction is possible in"
            f" these joints: {', '.join(valid)}"
        )
    if not joint.axes:
        points = [body.name for body in joint.bodies if not body.oriented]
        raise DeclarationError(
            f"{what}: joint '{joint.name}' has no angle: '{points[0]}' is a point mass; declare it"
            " as a link with mass, centre and inertia"
        )
    if joint.kind == "spherical":
        if along:
            raise DeclarationError(
                f"{what}: joint '{joint.name}' has its friction along its rotation, not along"
                f" '{along}'"
            )
        return joint.axes[0], None
    names = [axis.name for axis in joint.axes if axis.name]
    if len(names) == 2:
        if along not in names:
            raise DeclarationError(
                f"{what}: joint '{joint.name}' has two coordinates; expected along='{names[0]}' or"
                f" '{names[1]}'"
            )
        first, second = joint.axes
        return (first, second) if along == names[0] else (second, first)
    if along and along not in names:
        raise DeclarationError(
            f"{what}: joint '{joint.name}' has one coordinate and none called"
            f" '{along}'; leave along= out"
        )
    return joint.axes[0], None


def _require(what: str, joint: Joint, axis: Axis, numbers: Mapping[str, Expression]) -> None:
    """Raise for a length or radius that is missing, or that has no meaning."""
    if numbers.keys().isdisjoint(("mu", "coulomb", "viscous")):
        raise DeclarationError(
            f"{what}: expected mu=, a friction coefficient, coulomb= or viscous="
        )
    if "mu" not in numbers:
        needless = [key for key in ("radius", "length", "static", "stribeck") if key in numbers]
        needless += ["smooth"] if "smooth" in numbers and "coulomb" not in numbers else []
        if needless:
            raise DeclarationError(f"{what}: {needless[0]} needs mu=, a friction coefficient")
        return
    if "coulomb" in numbers:
        raise DeclarationError(
            f"{what}: mu= and coulomb= exclude each other; declare two frictions"
        )
    space, moment = not joint.planar, joint.bears_moment
    turns = axis.kind == "angle" or joint.kind == "cylindrical"
    bearings = space and moment and joint.kind in ("revolute", "cylindrical")
    radius, length = "radius" in numbers, "length" in numbers
    refused = (
        (
            joint.kind == "screw" and "static" in numbers,
            (
                "is a screw, whose thread has one friction coefficient; valid: mu, radius, viscous,"
                " smooth"
            ),
        ),
        (
            space and moment and joint.kind == "prismatic" and not radius,
            (
                "transmits a moment about its axis; expected radius= [m], at which friction acts"
                " against that"
            ),
        ),
        (turns and not radius, "turns; expected radius=, that of its pin [m]"),
        (
            turns and bearings and not length,
            "transmits a moment; expected length=, the distance of its two bearings [m]",
        ),
        (
            turns and length and not bearings,
            "turns and has no guide length; expected radius= in place of length=",
        ),
        (
            radius and not turns and not (space and moment),
            "slides and has no radius; expected length=, the guide length [m], in place of radius=",
        ),
        (
            moment and not turns and not length,
            "transmits a moment; expected length=, the guide length [m]",
        ),
        (length and not turns and not moment, "transmits no moment; leave length= out"),
    )
    for here, words in refused:
        if here:
            raise DeclarationError(f"{what}: joint '{joint.name}' {words}")


def _number(own: Ownership, what: str, word: str, value: Expression, unit: str) -> Expression:
    found, positive = own.expression(f"{what}: {word}", value, unit), word in POSITIVE
    if isinstance(found, float) and (found < 0.0 or (found == 0.0 and positive)):
        raise DeclarationError(
            f"{what}: {word} must be {'positive' if positive else 'at least 0'}, got {found:g}"
        )
    return found
