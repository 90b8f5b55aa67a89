"""Friction in joints: what may be declared as one."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from ..errors import DeclarationError
from .joints import Axis, Joint
from .ownership import Ownership
from .parts import POSITIVE, Expression, Friction

_UNITS = {"radius": "m", "length": "m", "stribeck": "m/s"}
_IN_PLANE, _IN_SPACE = (
    ("revolute", "prismatic", "slot"),
    ("revolute", "prismatic", "cylindrical", "screw", "spherical"),
)


def friction(
    own: Ownership, name: str, joint: Joint, along: str, given: Mapping[str, Expression | None]
) -> Friction:
    """Friction in a joint of a mechanism, with the numbers ``given``; ``along`` names a coordinate
    of a joint of two.

    Raises :class:`DeclarationError` where the joint has no such friction, and where a number is
    missing or says nothing.
    """
    own.free("load", name, own.mechanism.loads)
    what = f"friction '{name}'"
    axis, beside = _axes(own, what, joint, along)
    units = _UNITS | {"smooth": "rad/s" if axis.kind == "angle" else "m/s"}
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
    if beside is not None and "smooth" in numbers:
        raise DeclarationError(
            f"{what}: joint '{joint.name}' slides and turns at once, for which smooth= is not"
            " available; leave smooth out"
        )
    symbol = ca.SX.sym(f"friction_{name}")
    return Friction(name, joint, axis, symbol, beside=beside, **numbers)


def _axes(own: Ownership, what: str, joint: Joint, along: str) -> tuple[Axis, Axis | None]:
    """The coordinate along which it acts, and the other one of a joint that has two."""
    own.joint(joint)
    valid = _IN_SPACE if own.mechanism.space else _IN_PLANE
    if joint.kind not in valid:
        where = "space" if own.mechanism.space else "a plane"
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
    if "mu" not in numbers and "viscous" not in numbers:
        raise DeclarationError(f"{what}: expected mu=, a friction coefficient, or viscous=")
    if "mu" not in numbers:
        needless = [
            key for key in ("radius", "length", "static", "stribeck", "smooth") if key in numbers
        ]
        if needless:
            raise DeclarationError(f"{what}: {needless[0]} needs mu=, a friction coefficient")
        return
    space, moment = joint.turned is not None, joint.bears_moment
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
