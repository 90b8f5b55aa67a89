"""Selection of values of a parameter or an axis: a number that is there, a list of such numbers, or
all within a range.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, TypeAlias

import numpy as np
import numpy.typing as npt

from ...base.arguments import LATER
from ...base.arrays import Array
from ...base.units import Number, quantity
from ...errors import DeclarationError, shown

_NEAR = 1e-9

Selected: TypeAlias = Annotated[Number | Iterable[Number], LATER]
"""A number, some numbers, or (low, high)."""


def near(values: Array, number: float) -> npt.NDArray[np.bool_]:
    """Return where values are a number, within the rounding of a grid."""
    if math.isinf(number):
        return np.asarray(values == number)
    return np.asarray(np.abs(values - number) <= _NEAR * np.maximum(np.abs(values), abs(number)))


def matches(name: str, there: Array, wanted: Selected, unit: str) -> npt.NDArray[np.bool_]:
    """Return where values are wanted, in their ``unit``; they may be texts, as ``"30 deg"``.

    Raises :class:`DeclarationError` for what cannot be, and for what no value is.
    """
    each: Iterable[object] = [wanted]
    if isinstance(wanted, list | tuple | set | frozenset | range) or (
        isinstance(wanted, np.ndarray) and wanted.ndim == 1
    ):
        each = wanted
    numbers = np.array([quantity(f"select: {name}", one, unit, finite=False) for one in each])
    pair = isinstance(wanted, tuple)
    if not numbers.size or np.isnan(numbers).any() or (pair and numbers.size != 2):
        raise DeclarationError(
            f"select: {name}: expected a number, a list of numbers, or a tuple (low, high), got"
            f" {shown(wanted)}"
        )
    if not pair:
        return np.asarray(
            np.any(
                [_found(name, there, near(there, number), number, "=") for number in numbers],
                axis=0,
            )
        )
    low, high = numbers
    if high < low:
        raise DeclarationError(
            f"select: {name}: expected (low, high), got {shown(wanted)}: the range is reversed"
        )
    within = ((there > low) | near(there, low)) & ((there < high) | near(there, high))
    return _found(name, there, within, low, f"up to {high:.10g} and from")


def absent(name: str, there: Array, number: float, words: str = "=") -> str:
    """Say of a number that no value is it, with the nearest that are."""
    values = np.unique(there)
    close = ", ".join(
        f"{value:.10g}" for value in values[np.argsort(np.abs(values - number), kind="stable")[:2]]
    )
    return f"no design has {name} {words} {number:.10g}; nearest: {close}"


def _found(
    name: str, there: Array, satisfied: npt.NDArray[np.bool_], number: float, words: str
) -> npt.NDArray[np.bool_]:
    if not satisfied.any():
        raise DeclarationError(absent(name, there, number, words))
    return satisfied
