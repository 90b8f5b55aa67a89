"""Tables of numbers within graphs of scalars: in which of many cells a number lies, and what a
table has for that cell.

A graph calls a table as a function of one number. CasADi's own machine evaluates it; whoever
follows a graph (:mod:`.interpret`) or writes it as C finds the numbers in the function, by
:func:`lookup`. So a graph does not grow with its tables.
"""

from __future__ import annotations

import functools
import hashlib
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import casadi as ca
import numpy as np
import numpy.typing as npt

from .arrays import Array, Operand

Kind = Literal["cell", "entry"]

PREFIX = "lagrange_casadi"
_NAME = re.compile(rf"{PREFIX}_(cell|entry)(_ends)?_[0-9a-f]{{16}}")
_BITS = 64
"""Entries are kept as whole numbers of so many bits: what is smaller beside the largest is zero."""

_LEAST = -1074
"""No number is smaller than this power of two."""


@dataclass(frozen=True, eq=False)
class Lookup:
    """Kind of a lookup: the number of the ``cell`` between neighbours of rising ``numbers``, or the
    ``entry`` of a number.

    A break belongs to the cell after it; beyond the ends the first and the last cell go on. Of a
    cell ``ends`` says whether a number may be beyond them, which is for others to refuse.
    """

    kind: Kind
    numbers: npt.NDArray[Any]
    function: ca.Function
    ends: bool = False

    @property
    def alone(self) -> bool:
        """True for the only cell between two ends, whose number is zero for all numbers."""
        return self.kind == "cell" and len(self.numbers) == 2

    def at(self, x: Array) -> Operand:
        """Look real numbers ``x`` of any shape up; of complex ones the real part counts."""
        x = np.real(x)
        if self.kind == "cell":
            return np.searchsorted(self.numbers[1:-1], x, side="right").astype(float)
        return self.numbers[np.asarray(x, int)]

    def parts(self, kind: npt.DTypeLike) -> tuple[Operand, Operand | None]:
        """The functions of the entries rounded to numbers of a kind, and of what that leaves of
        them; None if it leaves nothing.
        """
        high = self.numbers.astype(kind).astype(float)
        low = self.numbers - high
        rest = _function("entry", tuple(low.tolist())) if low.any() else None
        return _function("entry", tuple(high.tolist())), rest


def cell(breaks: Sequence[float], x: ca.SX, *, ends: bool) -> ca.SX:
    """The number of the cell in which an expression lies, as a scalar expression."""
    found: ca.SX = _function("cell", tuple(map(float, breaks)), ends)(x)
    return found


def ends(low: float, high: float, x: ca.SX) -> ca.SX:
    """Zero, as an expression in which others find the ends that ``x`` must be between."""
    # Rounding has no derivative, as in `entries`.
    return ca.ceil(cell([low, high], x, ends=True))


def entries(numbers: Sequence[float], number: ca.SX) -> ca.SX:
    """The entry of a table of finite numbers that an expression numbers; its derivative is zero.

    It is to 64 binary digits of the largest one.
    """
    largest = max(map(abs, numbers))
    if all(entry == numbers[0] for entry in numbers):
        return ca.SX(numbers[0])
    scale = math.ldexp(1.0, max(math.frexp(largest)[1] - _BITS, _LEAST))
    whole: ca.SX = _function("entry", tuple(float(round(entry / scale)) for entry in numbers))(
        number
    )
    # Rounding changes no whole number, and has no derivative: CasADi would differentiate a call by
    # calls of further functions.
    return ca.ceil(whole) * scale


def pieces(
    breaks: Sequence[float], cells: Sequence[Sequence[float]], x: ca.SX, *, ends: bool
) -> ca.SX:
    """A polynomial in pieces between breaks, as a scalar expression: of each of the ``cells`` the
    coefficients of rising powers of the distance from its first break.
    """
    number = cell(breaks, x, ends=ends) if len(cells) > 1 else ca.SX(0)
    u = x - entries(breaks[:-1], number)
    *lower, found = (entries(coefficients, number) for coefficients in zip(*cells, strict=True))
    for coefficient in reversed(lower):
        found = found * u + coefficient
    return found


def is_entry(x: ca.SX) -> bool:
    """Return whether a scalar expression is a table's value for a cell, as a whole number."""
    if not x.is_output():
        return False
    found = lookup(x.dep(0).which_function())
    return found is not None and found.kind == "entry"


@functools.lru_cache(maxsize=256)
def lookup(function: ca.Function) -> Lookup | None:
    """Lookup of a function; None for any other function."""
    found = _NAME.fullmatch(function.name())
    if found is None or not function.is_a("MXFunction"):
        return None
    kind: Kind = "cell" if found[1] == "cell" else "entry"
    constants = [
        k for k in range(function.n_instructions()) if function.instruction_id(k) == ca.OP_CONST
    ]
    return Lookup(
        kind,
        function.instruction_MX(constants[0]).to_DM().full().ravel(),
        function,
        ends=bool(found[2]),
    )


@functools.lru_cache(maxsize=256)
def _function(kind: Kind, numbers: tuple[float, ...], ends: bool = False) -> ca.Function:
    digest = hashlib.sha256(" ".join(number.hex() for number in numbers).encode()).hexdigest()[:16]
    x, table = ca.MX.sym("x"), ca.DM(numbers)
    found = ca.low(table, x, {"lookup_mode": "binary"}) if kind == "cell" else ca.MX(table)[x]
    return ca.Function(
        f"{PREFIX}_{kind}{'_ends' if ends else ''}_{digest}", [x], [found], {"never_inline": True}
    )
