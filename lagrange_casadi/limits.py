"""What the parts must be together, and what the values of parameters may make of them: lengths, masses, densities, stations."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from .density import Density
from .errors import DeclarationError, ParameterError, UnknownNameError
from .parts import Body, Ground, Joint, Link, Load, Parameter, Point, PointMass, RigidMass

Number = Callable[[Any], float]


def check_connected(name: str, ground: Ground, bodies: Iterable[Body], joints: Iterable[Joint]) -> None:
    """Raise :class:`DeclarationError` for bodies that no chain of joints connects to the ground."""
    joined, reached = list(joints), {ground.name}
    while new := {
        body.name
        for joint in joined
        for body in joint.bodies
        if body.name not in reached and reached & {other.name for other in joint.bodies}
    }:
        reached |= new
    loose = [f"'{body.name}'" for body in bodies if body.name not in reached]
    if loose:
        raise DeclarationError(
            f"mechanism '{name}': {', '.join(loose)} {'is' if len(loose) == 1 else 'are'} not connected to the ground by any chain "
            f"of joints; joints declared: {', '.join(joint.name for joint in joined) or 'none'}"
        )


def parameter_values(parameters: Mapping[str, Parameter], overrides: Mapping[str, float]) -> dict[str, float]:
    """Defaults with overrides, each checked against its range.

    Raises :class:`UnknownNameError` for names, :class:`ParameterError` for values, all of them at once.
    """
    if unknown := [name for name in overrides if name not in parameters]:
        raise UnknownNameError("parameter", unknown, parameters)
    if faults := parameter_faults(parameters, overrides):
        raise ParameterError("; ".join(faults))
    return {name: float(overrides.get(name, parameter.default)) for name, parameter in parameters.items()}


def parameter_faults(parameters: Mapping[str, Parameter], values: Mapping[str, float]) -> list[str]:
    """What is wrong with values of parameters, each in words of its own."""
    return [fault for name, value in values.items() if (fault := parameters[name].fault(value))]


def check_parts(
    name: str, bodies: Iterable[Link | PointMass], joints: Iterable[Joint], loads: Iterable[Load], number: Number
) -> None:
    """Raise :class:`ParameterError` for a part that is impossible at the values that ``number`` puts into expressions."""
    if sum(_mass(body, number) for body in bodies) == 0.0:
        raise ParameterError(f"mechanism '{name}' is massless: at least one link or point mass needs a mass")
    for joint in joints:
        for point in (joint.parent, joint.child):
            _check_station(f"joint '{joint.name}'", point, number)
    for load in loads:
        for point in load.points:
            _check_station(f"load '{load.name}'", point, number)


def _mass(body: Link | PointMass, number: Number) -> float:
    """The mass of a body, once everything about it is possible."""
    what = f"link '{body.name}'" if isinstance(body, Link) else f"point mass '{body.name}'"
    if isinstance(body, Link):
        length = number(body.length)
        if not (length > 0.0 and math.isfinite(length)):
            raise ParameterError(f"{what}: length must be positive, got {length:.17g} m")
        if isinstance(body.mass, Density):
            return _density_mass(what, body.mass, length, number)
    matter = body.mass
    mass = number(matter.mass if isinstance(matter, RigidMass) else matter)
    if not (mass >= 0.0 and math.isfinite(mass)):
        raise ParameterError(f"{what}: mass must not be negative, got {mass:.17g} kg")
    if isinstance(matter, RigidMass) and not number(matter.inertia) >= 0.0:
        raise ParameterError(f"{what}: inertia must not be negative, got {number(matter.inertia):.17g} kg m^2")
    return mass


def _density_mass(what: str, matter: Density, length: float, number: Number) -> float:
    density = matter.at(number, length)
    place, lowest = density.lowest()
    if not lowest >= 0.0:
        if density.uniform:
            raise ParameterError(f"{what}: mass must not be negative, got {lowest:.17g} kg")
        raise ParameterError(f"{what}: density must not be negative, got {lowest / length:.17g} kg/m at xi/l = {place:.6g}")
    return density.mass


def _check_station(what: str, point: Point, number: Number) -> None:
    if isinstance(point.body, Link) and isinstance(point.body.mass, Density) and point.end is None:
        x, length = number(point.x), number(point.body.length)
        if not 0.0 <= x <= length:
            raise ParameterError(f"{what}: station {x:.17g} m is outside link '{point.body.name}', 0 to {length:.17g} m")
