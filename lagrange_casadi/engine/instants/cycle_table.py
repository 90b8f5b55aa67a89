"""A cycle in a table: what a drive's angle decides, as periodic splines, to be read at any angle,
rate and acceleration.

Each column is  out = A(angle) acceleration + B(angle) rate^2 + D(angle) rate + C(angle) + slope
angle,  with A, B, C and D quintic B-splines over equal distances: six coefficients a term, whose
weights are polynomials, so that reading takes no sine. Compiled code reads the table.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ..codegen.calls import Call
from ..codegen.compiler import find_compiler, loaded, no_compiler, written

if TYPE_CHECKING:
    from _ctypes import CFuncPtr

_MORE = 5
_TILE = 32
_OPTIONS = ("-O3", "-march=native", "-fno-trapping-math")
_TURN = Fraction(math.tau) + Fraction(2.4492935982947064e-16)
"""Twice the digits of a turn: what they leave out adds up over many turns."""

_REAL = {"float64": "double", "float32": "float"}

INTERPOLATE = Call(
    "lagrange_casadi_interpolate_call",
    {
        "n": "long long",
        "stride": "long long",
        "angle": "const real*",
        "rate": "const real*",
        "acceleration": "const real*",
        "nodes": "int",
        "cell": "const real*",
        "terms": "int",
        "coefficients": "const real*",
        "columns": "int",
        "order": "const int*",
        "drift": "const real*",
        "count": "int",
        "runs": "const int*",
        "out": "real*",
    },
)
"""Arguments of compiled code that reads a table; ``interpolate.c`` describes each."""

_ENTRY = """
#ifdef __GNUC__
__attribute__((visibility("default")))
#endif
void lagrange_casadi_interpolate(const lagrange_casadi_interpolate_call* call) {
  interpolate(call->n, call->stride, call->angle, call->rate, call->acceleration, call->nodes,
              call->cell, call->terms, call->coefficients, call->columns, call->order, call->drift,
              call->count, call->runs, call->out);
}
"""

Integers = npt.NDArray[np.int32]
Reals = npt.NDArray[Any]


@dataclass(frozen=True, eq=False)
class CycleTable:
    """The columns of a scene over the cycle of its one drive.

    Parameters
    ----------
    turns
        The period of all that does not drift, in whole turns.
    columns
        Names, one a row of what :meth:`evaluate` fills.
    kept
        Which terms are not zero (factors, columns); factors are 1, the rate, the rate's square and
        the acceleration.
    coefficients
        Of the splines, over 120, (nodes + 5, terms), as float64 or float32, in the order of
        ``terms``: row k belongs to node k - 2, and the last five rows are the first ones again, so
        that no index wraps.
    drift
        What a column gains with the angle beside, as an angle does that counts turns (columns).
    rates
        The largest rate [rad/s] and acceleration [rad/s^2] for which ``peaks`` and ``errors`` hold.
    peaks
        The largest value of each column over the cycle at such rates (columns).
    errors
        The largest error of each column halfway between nodes at such rates, over its peak
        (columns).
    """

    turns: int
    columns: tuple[str, ...]
    kept: npt.NDArray[np.bool_]
    coefficients: Reals
    drift: Array
    rates: tuple[float, float]
    peaks: Array
    errors: Array

    @property
    def nodes(self) -> int:
        """Number of tabulated angles of a period."""
        return int(self.coefficients.shape[0]) - _MORE

    @property
    def error(self) -> float:
        """The largest of ``errors``."""
        return float(self.errors.max(initial=0.0))

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """The type of numbers that it is read in: float64 or float32."""
        return self.coefficients.dtype

    def single(self) -> CycleTable:
        """Table in single precision; ``errors`` then include its rounding, at angles of the first
        period.
        """
        table = replace(self, coefficients=self.coefficients.astype(np.float32))
        period, halves = math.tau * self.turns, 2 * self.nodes
        angle = (period / halves * np.arange(halves)).astype(np.float32)
        worst = np.zeros(len(self.columns))
        for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            rate, acceleration = (
                np.full(angle.size, s * size, np.float32)
                for s, size in zip(signs, self.rates, strict=True)
            )
            rounded, exact = (
                np.empty((len(self.columns), angle.size), dtype)
                for dtype in (np.float32, np.float64)
            )
            table.evaluate(angle, rate, acceleration, rounded)
            self.evaluate(angle, rate, acceleration, exact)
            np.maximum(worst, np.abs(rounded - exact).max(axis=1), out=worst)
        relative = np.divide(worst, self.peaks, out=np.zeros_like(worst), where=self.peaks > 0.0)
        return replace(table, errors=self.errors + relative)

    def evaluate(self, angle: Reals, rate: Reals, acceleration: Reals, out: Reals) -> None:
        """Fill ``out`` (columns, n) for angles [rad], of any number of turns, rates and
        accelerations of the drive, (n) each.

        ``out`` is of the table's own ``dtype``, its rows contiguous; where an angle, a rate or an
        acceleration is not finite, neither are the columns that it goes into.

        Raises :class:`.CompilerError` where there is no compiler.
        """
        angle, rate, acceleration = (
            np.ascontiguousarray(row, dtype=self.dtype) for row in (angle, rate, acceleration)
        )
        layout = self.layout
        _compiled(self.dtype.name)(
            INTERPOLATE.made(
                n=angle.size,
                stride=out.strides[0] // out.itemsize,
                angle=angle.ctypes.data,
                rate=rate.ctypes.data,
                acceleration=acceleration.ctypes.data,
                nodes=self.nodes,
                cell=self.cell.ctypes.data,
                terms=self.coefficients.shape[1],
                coefficients=self.coefficients.ctypes.data,
                columns=len(self.columns),
                order=layout.order.ctypes.data,
                drift=self.slopes.ctypes.data,
                count=len(layout.runs),
                runs=layout.runs.ctypes.data,
                out=out.ctypes.data,
            )
        )

    @functools.cached_property
    def layout(self) -> Layout:
        """Order of terms in a row."""
        return arranged(self.kept)

    @functools.cached_property
    def cell(self) -> Reals:
        """The inverse of the distance of nodes, the distance in two parts, and 1/nodes, as compiled
        code takes them.
        """
        width = _TURN * self.turns / self.nodes
        # The first part has half of the digits.
        digits = (np.finfo(self.dtype.name).nmant + 1) // 2 - math.frexp(width)[1]
        first = math.ldexp(round(math.ldexp(width, digits)), -digits)
        return np.array(
            [1 / width, first, width - Fraction(first), Fraction(1, self.nodes)]
        ).astype(self.dtype)

    @functools.cached_property
    def slopes(self) -> Reals:
        """The drift of the columns in the layout's order."""
        return self.drift[self.layout.order].astype(self.dtype)


@dataclass(frozen=True, eq=False)
class Layout:
    """Order of terms in a row: ``order`` (columns), the column in each place; ``runs`` (k, 3) of
    neighbouring terms, the number of a factor, the first place and the number of them.
    """

    order: Integers
    runs: Integers
    terms: tuple[tuple[int, int], ...]


def arranged(kept: npt.NDArray[np.bool_]) -> Layout:
    """The layout of the terms that are kept (factors, columns), in as few runs as may be."""
    # In the order of a Gray code neighbours differ by one factor, so most factors go on from one
    # kind of column to the next.
    codes = kept.T @ np.array([4, 8, 1, 2])
    ranks = codes ^ (codes >> 1) ^ (codes >> 2) ^ (codes >> 3)
    order = np.argsort(ranks, kind="stable").astype(np.int32)
    runs: list[tuple[int, int, int]] = []
    for start in range(0, order.size, _TILE):
        tile = order[start : start + _TILE]
        for factor, row in enumerate(kept):
            edges = np.flatnonzero(np.diff(row[tile].astype(int), prepend=0, append=0))
            runs += [
                (factor, start + int(i), int(j - i))
                for i, j in zip(edges[::2], edges[1::2], strict=True)
            ]
    terms = tuple(
        (factor, int(k)) for factor, first, count in runs for k in order[first : first + count]
    )
    return Layout(order, np.array(runs, dtype=np.int32).reshape(-1, 3), terms)


def splines(values: Array) -> Array:
    """The coefficients of periodic splines through ``values`` (terms, nodes), as a table holds
    them: (nodes + 5, terms).
    """
    nodes = values.shape[1]
    turn = 2.0 * np.pi / nodes * np.arange(nodes // 2 + 1)
    inside = np.fft.irfft(
        np.fft.rfft(values) / (66.0 + 52.0 * np.cos(turn) + 2.0 * np.cos(2.0 * turn)), nodes
    )
    return np.ascontiguousarray(inside[:, np.arange(-2, nodes + _MORE - 2) % nodes].T)


def source() -> str:
    """The C that reads tables of numbers of type ``REAL``."""
    return written("interpolate.c") + INTERPOLATE.text("real") + _ENTRY


@functools.cache
def _compiled(dtype: str) -> CFuncPtr:
    """The C function for numbers of a type. Raises :class:`CompilerError` without a compiler."""
    if (compiler := find_compiler()) is None:
        raise no_compiler("a table needs a compiler", "c")
    library = loaded(source(), compiler, (*_OPTIONS, f"-DREAL={_REAL[dtype]}"))
    return INTERPOLATE.declare(library.lagrange_casadi_interpolate)
