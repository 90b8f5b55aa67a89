"""Limits of parts together, and of values of parameters: lengths, masses, densities, load
points.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import casadi as ca

from ..base.vocabulary import Precision
from ..errors import DeclarationError, ParameterError, check_known
from .declared_parts import Body, Expression, Ground, Link, Parameter, Point
from .joints import Joint

END: dict[Precision, float] = {"double": 1e-12, "single": 1e-6}
"""Fraction of a link's length within which a point is at the link's end."""

ROUNDED = 1e-6
"""Largest rounding of a drawing, of directions [rad] and places [of a link's length]."""

FITS = 1e-13
"""Largest residual of redundant equations that count as consistent, relative to the links'
length.
"""

MISSES, APART = 10.0, 100.0
"""By how many times the rounding of its axes and places a loop may miss; and so many times that,
what does not follow from the rounding is at least: slopes, coefficients and singular values.
"""

_LISTED = 8
"""Parameters that a message names."""


def check_connected(
    name: str, ground: Ground, bodies: Iterable[Body], joints: Iterable[Joint]
) -> None:
    """Raise :class:`DeclarationError` for bodies that no chain of joints connects to the ground."""
    joined = list(joints)
    neighbours: dict[str, set[str]] = {}
    for joint in joined:
        parent, child = (body.name for body in joint.bodies)
        neighbours.setdefault(parent, set()).add(child)
        neighbours.setdefault(child, set()).add(parent)
    reached, waiting = {ground.name}, [ground.name]
    while waiting:
        new = neighbours.get(waiting.pop(), set()) - reached
        reached |= new
        waiting += new
    apart = [f"'{body.name}'" for body in bodies if body.name not in reached]
    if apart:
        raise DeclarationError(
            f"mechanism '{name}': {', '.join(apart)} {'is' if len(apart) == 1 else 'are'} not"
            " connected to the ground by any chain of joints; joints declared:"
            f" {', '.join(joint.name for joint in joined) or 'none'}"
        )


def parameter_values(
    parameters: Mapping[str, Parameter], overrides: Mapping[str, float] | None
) -> dict[str, float]:
    """Defaults with overrides, each checked against its range.

    Raises :class:`UnknownNameError` for names, :class:`ParameterError` for values, all of them at
    once, and :class:`DeclarationError` for what has no names.
    """
    overrides = {} if overrides is None else overrides
    check_known("parameter", overrides, parameters)
    if faults := parameter_faults(parameters, overrides):
        raise ParameterError("; ".join(faults))
    return {
        name: parameter.number(overrides.get(name, parameter.default))
        for name, parameter in parameters.items()
    }


def parameter_faults(parameters: Mapping[str, Parameter], values: Mapping[str, float]) -> list[str]:
    """Faults of values of parameters, each in words of its own."""
    return [fault for name, value in values.items() if (fault := parameters[name].fault(value))]


def at_end(point: Point) -> Expression:
    """Position of a fixed point along its link [m]: at an end, if it misses that by rounding."""
    assert isinstance(point.body, Link)
    x, length = point.x, point.body.length
    if isinstance(x, float) and x == 0.0:
        return x
    slack = END["double"] * length
    if isinstance(x, float) and isinstance(length, float):
        return 0.0 if abs(x) <= slack else length if abs(x - length) <= slack else x
    return ca.if_else(ca.fabs(x) <= slack, 0.0, ca.if_else(ca.fabs(x - length) <= slack, length, x))


def no_sections(name: str, *, link: bool, links: Iterable[str]) -> str:
    """Reason why a body has no sections, in words: a link whose distribution of mass is not known,
    or none of the links.
    """
    if link:
        return (
            f"link '{name}' has sections only if its mass is given along it: give it a mass alone"
            " or a density, in place of centre and inertia"
        )
    return f"'{name}' is not a link and has no sections; links: {', '.join(links)}"


def parameters_note(parameters: Mapping[str, Parameter], values: Mapping[str, float]) -> str:
    """Values of parameters of a result, to end a message with: the defaults, or others; empty if
    there are no parameters.
    """
    return values_note(
        values or {name: parameter.default for name, parameter in parameters.items()},
        not values,
    )


def values_note(values: Mapping[str, float], default: bool = False) -> str:
    """Name the values of all parameters, to end a message with; nothing where there are none."""
    listed = [f"{name} = {value:.6g}" for name, value in values.items()]
    if len(listed) > _LISTED:
        listed = [*listed[:_LISTED], f"{len(listed) - _LISTED} more"]
    if listed:
        return f"; with the {'default ' if default else ''}parameters {', '.join(listed)}"
    return ""
