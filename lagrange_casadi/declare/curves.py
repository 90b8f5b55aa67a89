"""Curves given by tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import casadi as ca

from ..errors import DeclarationError


def rows(what: str, places: Sequence[float], values: Sequence[float], least: int) -> tuple[list[float], list[float]]:
    """Two rows of one length, at increasing places. Raises :class:`DeclarationError`, saying ``what`` is wrong where."""
    try:
        at, to = [float(p) for p in places], [float(v) for v in values]
    except (TypeError, ValueError):
        raise DeclarationError(f"{what}: expected two rows of numbers, got {places!r} and {values!r}") from None
    if len(at) != len(to) or len(at) < least:
        raise DeclarationError(f"{what}: expected two rows of one length, at least {least}, got {len(at)} and {len(to)}")
    if not all(math.isfinite(number) for number in (*at, *to)):
        raise DeclarationError(f"{what}: all numbers must be finite")
    for i in range(len(at) - 1):
        if not at[i] < at[i + 1]:
            raise DeclarationError(f"{what}: places must increase, but entry {i + 1} is at {at[i + 1]:g} after {at[i]:g}")
    return at, to


def table(x: Any, places: Sequence[float], values: Sequence[float]) -> Any:
    """A curve for loads: linear between values at increasing places, and straight on beyond them.

    ``x`` is an expression, such as a joint's coordinate; ``places`` are in its unit, and ``values`` in that of the load. Returns a
    ``casadi.SX`` expression. Constraints and motions refuse it, for there slopes must not jump. Raises :class:`DeclarationError`
    for places that do not increase.
    """
    at, to = rows("table", places, values, 2)
    return ca.pw_lin(ca.SX(x), ca.DM(at), ca.DM(to))
