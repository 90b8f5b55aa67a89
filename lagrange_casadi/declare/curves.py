"""Curves given by points: smooth ones, and tables with corners."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..arguments import fitting, public
from ..arithmetic import lookups
from ..base.arrays import Expression
from ..base.units import number
from ..errors import DeclarationError, NumberError, shown
from .splines import Cell, smoothed, through

_SAME = 1e-12
"""Largest relative difference of the ends of a periodic curve that is rounding."""


def rows(
    what: str, places: Sequence[float], values: Sequence[float], least: int
) -> tuple[list[float], list[float]]:
    """Two rows of one length, at increasing places.

    Raises :class:`DeclarationError`, saying ``what`` is wrong where.
    """
    try:
        at = [number(p, finite=False) for p in places]
        to = [number(v, finite=False) for v in values]
    except (TypeError, NumberError):
        raise DeclarationError(
            f"{what}: expected two rows of finite numbers, got {shown(places)} and {shown(values)}"
        ) from None
    if len(at) != len(to) or len(at) < least:
        raise DeclarationError(
            f"{what}: expected two rows of one length, at least {least}, got {len(at)} and"
            f" {len(to)}"
        )
    if not all(math.isfinite(number) for number in (*at, *to)):
        raise DeclarationError(f"{what}: all numbers must be finite")
    for i in range(len(at) - 1):
        if not at[i] < at[i + 1]:
            raise DeclarationError(
                f"{what}: places must increase, but entry {i + 1} is at {at[i + 1]:g} after"
                f" {at[i]:g}"
            )
    return at, to


@public
def table(x: Expression, places: Sequence[float], values: Sequence[float]) -> ca.SX:
    """Return a piecewise linear curve of an expression, for loads; beyond its ends it is straight.

    Constraints and motions refuse it, because slopes must not jump there: use :func:`curve`.

    Parameters
    ----------
    x
        An expression, such as a joint's coordinate.
    places
        Increasing abscissas (n,), in the unit of ``x``.
    values
        Ordinates (n,), in the unit of the load.

    Returns
    -------
    casadi.SX
        The value of the curve at ``x``.

    Raises
    ------
    DeclarationError
        For abscissas that do not increase.
    """
    at, to = rows("table", places, values, 2)
    try:
        return ca.pw_lin(ca.SX(x), ca.DM(at), ca.DM(to))
    except (NotImplementedError, RuntimeError):  # CasADi's of a kind or a shape
        raise DeclarationError(f"table: expected a number or an expression, got {x!r}") from None


@dataclass(frozen=True, eq=False)
class Curve:
    """A smooth curve of cubic pieces, from :func:`curve`: value, slope and second derivative are
    continuous.

    ``cells`` are c in c0 + c1 u + c2 u^2 + c3 u^3 with u = x - origin - start, where ``starts`` are
    those of the pieces. A periodic curve goes on as it began; another one is defined from ``low``
    to ``high`` only.
    """

    low: float
    high: float
    periodic: bool
    origin: float
    starts: tuple[float, ...]
    cells: tuple[Cell, ...]

    @fitting
    def __call__(self, x: Expression) -> Expression:
        """The curve of an expression, as a ``casadi.SX`` expression; of numbers, as numbers.

        Raises :class:`DeclarationError` for what is neither a scalar expression nor numbers, or for
        a number beyond the ends of a curve that is not periodic. Instants at which an expression is
        beyond them are refused when they are evaluated.
        """
        if isinstance(x, ca.SX) and x.numel() == 1:
            return self._expression(x)
        try:
            numbers = (
                np.array(np.nan) if isinstance(x, ca.SX | ca.MX | ca.DM) else np.asarray(x, float)
            )
        except (TypeError, ValueError, OverflowError):
            numbers = np.array(np.nan)
        if not np.isfinite(numbers).all():
            raise DeclarationError(
                f"curve: expected a scalar casadi.SX expression or finite numbers, got {shown(x)}"
            )
        if not (self.periodic or ((numbers >= self.low) & (numbers <= self.high)).all()):
            raise DeclarationError(
                f"curve: {x!r} is outside its range, {self.low:g} to {self.high:g}"
            )
        within = numbers - self.origin
        if self.periodic:
            within = within - (self.high - self.low) * np.rint(within / (self.high - self.low))
        cell = np.clip(
            np.searchsorted(self.starts, within, side="right") - 1, 0, len(self.cells) - 1
        )
        u, c = within - np.array(self.starts)[cell], np.array(self.cells)[cell]
        found = c[..., 0] + u * (c[..., 1] + u * (c[..., 2] + u * c[..., 3]))
        return found if np.ndim(x) else float(found)

    def __repr__(self) -> str:
        return (
            f"<Curve of {len(self.cells) + 1} points, {'period' if self.periodic else 'from'}"
            f" {self.low:g} to {self.high:g}>"
        )

    def _expression(self, x: Expression) -> Expression:
        within = x - self.origin if self.origin else x
        if self.periodic:
            # A remainder is exact, and goes on with whole turns where angles count them.
            within = ca.remainder(within, self.high - self.low)
        number = lookups.cell(
            (*self.starts, self.high - self.origin), within, ends=not self.periodic
        )
        u = within - lookups.entries(self.starts, number)
        found = lookups.entries([cell[3] for cell in self.cells], number)
        for k in (2, 1, 0):
            found = found * u + lookups.entries([cell[k] for cell in self.cells], number)
        return found


@public
def curve(
    x: Sequence[float], y: Sequence[float], *, periodic: bool = False, smoothing: float = 0.0
) -> Curve:
    """Return a smooth curve through points, for constraints, motions, loads and densities.

    Call it on an expression: ``curve(angles, lifts, periodic=True)(m.coordinate(cam))`` is the lift
    of a cam. Between the points it is a cubic spline with a continuous second derivative,
    not-a-knot at its ends.

    Parameters
    ----------
    x
        Increasing abscissas (n,), at least four, in the unit of the expression.
    y
        Ordinates (n,), in the unit of the result.
    periodic
        Let the curve repeat; its first and last ordinate must be equal.
    smoothing
        Root mean square of the distances from the points, in the unit of ``y``, that the smoothest
        such curve may have: the size of the noise of measured points. Default: 0.

    Returns
    -------
    Curve
        The curve, a function of expressions.

    Raises
    ------
    DeclarationError
        For fewer than four points, different lengths, abscissas that do not increase, numbers that
        are not finite, ends of a periodic curve that differ, and a smoothing that is negative or
        makes the curve a straight line.
    """
    at, to = rows("curve", x, y, 4)
    span = max(to) - min(to)
    if periodic and abs(to[-1] - to[0]) > _SAME * max(span, abs(to[0])):
        raise DeclarationError(
            f"curve: a periodic curve ends as it begins, but its values are {to[0]:.9g} at"
            f" {at[0]:g} and {to[-1]:.9g} at {at[-1]:g}; give the first value once more at the end"
            " of the period"
        )
    if not (isinstance(smoothing, (int, float)) and 0.0 <= smoothing < math.inf):
        raise DeclarationError(
            f"curve: smoothing must be a finite number that is not negative, got {smoothing!r}"
        )
    if periodic:
        to[-1] = to[0]
    if smoothing:
        to = smoothed(at, to, float(smoothing), periodic=periodic)
    origin = (at[0] + at[-1]) / 2 if periodic else 0.0
    starts, cells = through(at, to, periodic=periodic, origin=origin)
    if not all(math.isfinite(number) for cell in cells for number in cell):
        raise DeclarationError(
            "curve: the points are so close to each other that the slopes overflow;"
            " expected fewer or more distant points"
        )
    return Curve(at[0], at[-1], periodic, origin, tuple(starts), tuple(cells))
