"""Loads along a link: what may be declared as one, and the polynomials along the link that it is
kept as.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import casadi as ca

from ..errors import DeclarationError
from .expressions import expressed
from .ownership import Ownership
from .parts import Expression, LineLoad, Link
from .polynomials import powers

LoadDensity: TypeAlias = "Expression | tuple[Expression, Expression] | Callable[[Any], Expression]"
"""A value along a link: one throughout, a pair for where it begins and ends, or a polynomial of the
distance from the base.
"""

Between: TypeAlias = "tuple[Expression, Expression] | None"
"""Distances from the base of a link [m], between which a load acts; None is the whole link."""

HIGHEST = 7
"""The highest power of the distance that a load may have."""


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
    own.free("load", name, own.mechanism.loads)
    what = f"load '{name}'"
    body = own.point(what, link).body
    if not isinstance(body, Link):
        raise DeclarationError(
            f"{what}: expected a link for a line load, got '{body.name}'; use a force at a point"
        )

    def checked(value: Expression) -> Expression:
        return own.expression(what, value, moving=True)

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
        return _of_function(what, value, start, end, checked)
    pair = tuple(value) if isinstance(value, tuple | list) else (value,)
    if len(pair) > 2 or not pair:
        raise DeclarationError(
            f"{what}: expected one value, two values at its start and end, or a function of the"
            f" distance from the base [m], got {value!r}"
        )
    first, last = checked(pair[0]), checked(pair[-1])
    return [last, first - last] if len(pair) == 2 else [last]


def _of_function(
    what: str,
    function: Callable[[ca.SX], Expression],
    start: Expression,
    end: Expression,
    checked: Callable[[Expression], Expression],
) -> list[Expression]:
    """Line load as a polynomial of the distance xi."""
    distance = ca.SX.sym("xi")
    value = expressed(what, function, [distance], "the distance from the base")
    if not isinstance(value, ca.SX):
        return [checked(value)]
    if value.numel() != 1:
        raise DeclarationError(f"{what} must be a scalar, got one of shape {value.shape}")
    # With numbers for ends the polynomial is rounded once; a symbol that is foreign is refused by
    # the coefficients.
    found = powers(value, distance, (ca.SX(end), ca.SX(start - end)))
    if found is None or len(found) > HIGHEST + 1:
        raise DeclarationError(
            f"{what} must be a polynomial of the distance from the base, of degree {HIGHEST} at"
            " most; use one load for each part of the link on which it is a polynomial"
        )
    return [checked(coefficient) for coefficient in found]
