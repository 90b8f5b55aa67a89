"""Bounds of rounding errors of a function's results, computed beside its operations.

Every operation hands on what its operands may be off, by what it makes of them itself, and adds its
own rounding (N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, section 3.3).
Errors are taken as if they never made up for each other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from .interpret import ROUNDINGS, Arithmetic, followable, interpret, numpy_arithmetic

_Pair = tuple[Any, Any]
_KNOWN = numpy_arithmetic().operations


def running_errors(
    function: ca.Function, *columns: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """The errors (rows, m) of the one output of an SX function of columns (rows, m); zeros where it
    cannot be followed.

    Numbers that are put in are known to half a unit in the last place, as constants are that are
    not whole.
    """
    rows, count = function.size1_out(0), columns[0].shape[1]
    if not rows or not count or not followable(function):
        return np.zeros((rows, count))
    given = [[(row, np.spacing(np.abs(row)) / 2) for row in column] for column in columns]
    with np.errstate(all="ignore"):
        found = interpret(
            function, given, Arithmetic(_constant, {code: _rule(code) for code in _KNOWN})
        )[0]
        return np.array(
            [np.broadcast_to(np.where(np.isnan(error), np.inf, error), count) for _, error in found]
        )


def _constant(value: float) -> _Pair:
    return value, 0.0 if value == np.rint(value) else float(np.spacing(abs(value)) / 2)


def _rule(code: int) -> Callable[..., _Pair]:
    known: Callable[..., Any] = _KNOWN[code]
    part = ROUNDINGS.get(code, 0.0) / 2

    def rule(*given: Any) -> _Pair:
        if code == ca.OP_CALL:
            lookup, (x, _) = given
            return known(lookup, x), 0.0
        pairs: Sequence[_Pair] = given
        values = [value for value, _ in pairs]
        result = known(*values)
        off = part * np.where(result == 0.0, 0.0, np.spacing(np.abs(result)))
        for k, (value, error) in enumerate(pairs):
            if not np.any(error):
                continue
            # Less than a unit in the last place would change nothing.
            move: Any = np.where(error > 0.0, np.maximum(error, np.spacing(np.abs(value))), error)
            beside = [
                np.abs(known(*values[:k], value + step * move, *values[k + 1 :]) - result)
                for step in (-1, 1)
            ]
            # Beyond the end of where a function is defined there is nothing to hand on.
            off = off + np.fmax(*beside)
        return result, off

    return rule
