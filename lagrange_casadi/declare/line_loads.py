"""Loads along a link: what may be declared as one."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from ..errors import DeclarationError
from .density import Density
from .parts import Body, Expression, LineLoad, Link

Spread: TypeAlias = "Expression | tuple[Expression, Expression]"
"""A value along a link: one throughout, or one at its base and one at its tip."""


def line_load(name: str, body: Body, x: Spread, y: Spread, turning: bool, checked: Callable[[Expression], Expression]) -> LineLoad:
    """A load along a link; ``checked`` takes an expression.

    Raises :class:`DeclarationError` for a body whose mass does not lie evenly along it, and for more than two values.
    """
    if not (isinstance(body, Link) and isinstance(body.mass, Density) and body.mass.even):
        raise DeclarationError(
            f"load '{name}': a line load needs a link whose mass lies evenly along it, and '{body.name}' is none; give the link "
            "its mass alone, or take forces at several of its stations"
        )
    pairs = [tuple(value) if isinstance(value, tuple | list) else (value, value) for value in (x, y)]
    if any(len(pair) != 2 for pair in pairs):
        raise DeclarationError(f"load '{name}': expected one value, or two, at the base and at the tip, got {x!r} and {y!r}")
    (x0, x1), (y0, y1) = ((checked(first), checked(last)) for first, last in pairs)
    return LineLoad(name, body, (x0, x1), (y0, y1), turning)
