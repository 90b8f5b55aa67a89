"""Rows of numbers that parameters scale and shift as a whole: times and values of samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Expression
from ..errors import DeclarationError

_POINTS = 8
_SAME = 1e-11


@dataclass(frozen=True, eq=False)
class Scaled:
    """A row that is shift + scale n_i; where it holds no parameters, the ``numbers`` themselves,
    with no shift and no scale.
    """

    numbers: Sequence[float]
    scale: Any = None
    shift: Any = None

    @classmethod
    def of(cls, what: str, row: ca.SX | Sequence[Expression]) -> Scaled:
        """A row of numbers or of expressions in parameters.

        Raises :class:`DeclarationError`, naming ``what``, for expressions that are not one scale
        times numbers, plus one shift.
        """
        if not isinstance(row, ca.SX) and (
            isinstance(row, str) or not hasattr(row, "__len__") or not getattr(row, "shape", (1,))
        ):
            raise DeclarationError(f"{what}: expected a row of numbers, got {row!r}")
        entries = ca.vertsplit(ca.vec(row)) if isinstance(row, ca.SX) else row
        if not any(isinstance(entry, ca.SX) and not entry.is_constant() for entry in entries):
            return cls([float(entry) for entry in entries] if isinstance(row, ca.SX) else row)
        column = ca.vertcat(*entries)
        symbols = ca.symvar(column)
        drawn = np.random.default_rng(0).uniform(0.5, 1.5, (len(symbols), _POINTS))
        with np.errstate(all="ignore"):
            values = ca.Function("row", [ca.vertcat(*symbols)], [ca.densify(column)])(drawn).full()
            off = values - values[0]
            last = int(np.argmax(np.abs(off[:, 0])))
            numbers = off[:, 0] / off[last, 0]
            alike = np.abs(off - numbers[:, None] * off[last]) <= _SAME * np.abs(values).max(axis=0)
        if not alike.all():
            raise DeclarationError(
                f"{what}: parameters may only scale and shift all of them together; expected"
                " NUMBERS*(expression) + (expression), or a motion.expression of"
                " lagrange_casadi.curve(times, values)"
            )
        return cls(numbers.tolist(), column[last] - column[0], column[0])
