"""Curves given by points: smooth ones, and tables with corners.

Splines come from their second derivatives at the points, by sparse matrices of CasADi's: importing
SciPy's would take three times as long as CasADi and NumPy together.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

import casadi as ca
import numpy as np

from ..base import lookups
from ..base.arguments import Row, array, fitting, public
from ..base.arrays import Array, Expression
from ..base.units import number
from ..base.vocabulary import Beyond
from ..errors import DeclarationError, NumberError, shown

_SAME = 1e-12
"""Largest relative difference of the ends of a periodic curve that is rounding."""

_HALVINGS = 50

Cell = tuple[float, float, float, float]


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
def table(
    x: Expression,
    places: Row,
    values: Row,
    *,
    beyond: Beyond | None = None,
) -> ca.SX:
    """Return a piecewise linear curve of an expression, for loads.

    Constraints and motions refuse it, because slopes must not jump there: use :func:`curve`.

    Parameters
    ----------
    x
        An expression, such as a joint's coordinate.
    places
        Increasing abscissas (n,), in the unit of ``x``, or texts as ``"45 deg"``.
    values
        Ordinates (n,), in the unit of the load, or texts as ``"5 kN"``.
    beyond
        How the curve goes on beyond its ends: ``"hold"`` keeps the value at the end, and
        ``"line"`` goes on in a straight line. Default: instants at which ``x`` is beyond the ends
        are refused.

    Returns
    -------
    casadi.SX
        The value of the curve at ``x``.

    Raises
    ------
    DeclarationError
        For abscissas that do not increase, and another word for ``beyond``.
    """
    at, to = rows("table", places, values, 2)
    if beyond not in (None, *get_args(Beyond)):
        raise DeclarationError(f"table: beyond must be 'hold' or 'line', got {shown(beyond)}")
    try:
        given: ca.SX = ca.SX(x)
        within: ca.SX = ca.fmin(ca.fmax(given, at[0]), at[-1]) if beyond == "hold" else given
        found: ca.SX = ca.pw_lin(within, ca.DM(at), ca.DM(to))
        # A constant goes on alike in every way.
        ended = beyond is None and min(to) < max(to)
        return found + lookups.ends(at[0], at[-1], given) if ended else found
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
        numbers = array(x)
        if numbers is None or not np.isfinite(numbers).all():
            raise DeclarationError(
                f"curve: expected a scalar casadi.SX expression or finite numbers, got {shown(x)}"
            )
        if not (self.periodic or ((numbers >= self.low) & (numbers <= self.high)).all()):
            raise DeclarationError(
                f"curve: {x!r} is outside its range, {self.low:g} to {self.high:g}"
            )
        found = derivatives(self, numbers)[0]
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
        breaks = (*self.starts, self.high - self.origin)
        return lookups.pieces(breaks, self.cells, within, ends=not self.periodic)


def derivatives(curve: Curve, x: Array) -> Array:
    """Return value, slope and second derivative (3, ...) of a curve at numbers in its range."""
    within = x - curve.origin
    if curve.periodic:
        within = within - (curve.high - curve.low) * np.rint(within / (curve.high - curve.low))
    cell = np.searchsorted(curve.starts, within, side="right") - 1
    cell = np.clip(cell, 0, len(curve.cells) - 1)
    u, (a, b, c, d) = within - np.array(curve.starts)[cell], np.array(curve.cells).T[:, cell]
    slope, bend = b + u * (2.0 * c + 3.0 * u * d), 2.0 * c + 6.0 * u * d
    return np.array([a + u * (b + u * (c + u * d)), slope, bend])


@public
def curve(x: Row, y: Row, *, periodic: bool = False, smoothing: float = 0.0) -> Curve:
    """Return a smooth curve through points, for constraints, motions, loads and densities.

    Call it on an expression: ``curve(angles, lifts, periodic=True)(m.coordinate(cam))`` is the lift
    of a cam. Between the points it is a cubic spline with a continuous second derivative,
    not-a-knot at its ends.

    Parameters
    ----------
    x
        Increasing abscissas (n,), at least four, in the unit of the expression, or texts as
        ``"45 deg"``.
    y
        Ordinates (n,), in the unit of the result, or texts as ``"5 kN"``.
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
    places, values = np.array(at), np.array(to)
    if smoothing:
        values = _smoothed(places, values, float(smoothing), periodic=periodic)
    origin = (at[0] + at[-1]) / 2 if periodic else 0.0
    starts, cells = _through(places, values, periodic=periodic, origin=origin)
    if not np.isfinite(cells).all():
        raise DeclarationError(
            "curve: the points are so close to each other that the slopes overflow;"
            " expected fewer or more distant points"
        )
    return Curve(at[0], at[-1], periodic, origin, tuple(starts), tuple(cells))


def _through(
    x: Array, y: Array, *, periodic: bool, origin: float = 0.0
) -> tuple[list[float], list[Cell]]:
    """Starts of the pieces, less an ``origin``, and of each piece c in c0 + c1 u + c2 u^2 + c3 u^3,
    u from its start.

    The second derivative is continuous, over the seam too where ``periodic``, and else not-a-knot:
    the first two pieces are one cubic, and the last two. De Boor, *A Practical Guide to Splines*,
    1978, chapter IV.
    """
    with np.errstate(all="ignore"):
        h = np.diff(x)
        slopes = np.diff(y) / h
        bends = _bends(h, slopes, periodic=periodic)
        first = slopes - h * (2.0 * bends[:-1] + bends[1:]) / 6.0
        cells = np.column_stack([y[:-1], first, bends[:-1] / 2.0, np.diff(bends) / (6.0 * h)])
    return (x[:-1] - origin).tolist(), [(a, b, c, d) for a, b, c, d in cells.tolist()]


def _bends(h: Array, slopes: Array, *, periodic: bool) -> Array:
    """Second derivatives at all points (n + 1,), for distances ``h`` (n,) and ``slopes`` of chords
    between them: R M = jumps of slopes, and where the ends are not-a-knot the second differences
    of M vanish there.
    """
    unit = float(h.mean())
    Q, R = _second(h / unit, periodic=periodic)
    scale = ca.diag(1.0 / ca.sum2(R))
    R, jumps = scale @ R, scale @ np.diff(slopes, prepend=slopes[-1:] if periodic else slopes[:0])
    if not periodic:
        ends = [Q[k, :] / ca.mmax(ca.fabs(Q[k, :])) for k in (0, -1)]
        R, jumps = ca.vertcat(ends[0], R, ends[1]), ca.vertcat(0.0, jumps, 0.0)
    bends = ca.solve(R, jumps, "qr").full().ravel() / unit
    return np.append(bends, bends[0]) if periodic else bends


def _second(h: Array, *, periodic: bool) -> tuple[ca.DM, ca.DM]:
    """Sparse matrices Q and R of rows at inner points, or at all where ``periodic``, and columns at
    all points: Q y are jumps of the slopes of chords, and equal to R M for second derivatives M of
    a spline.
    """
    before, after = (np.roll(h, 1), h) if periodic else (h[:-1], h[1:])
    rows, columns = np.arange(before.size), h.size + (not periodic)
    places = [(rows + k) % columns for k in ((-1, 0, 1) if periodic else (0, 1, 2))]
    at = np.tile(rows, 3).tolist(), np.concatenate(places).tolist()
    each = (1 / before, -1 / before - 1 / after, 1 / after), (before, 2 * (before + after), after)
    Q, R = (
        ca.DM.triplet(*at, ca.DM(np.concatenate(weights)), rows.size, columns) for weights in each
    )
    return Q, R / 6.0


def _smoothed(x: Array, y: Array, distance: float, *, periodic: bool) -> Array:
    """The values at the points of the least bent curve whose distance from the points has the root
    mean square ``distance``.

    Reinsch, *Smoothing by spline functions*, Numer. Math. 10, 1967. Raises
    :class:`DeclarationError` for a distance that leaves nothing but a straight line.
    """
    at, to = (x[:-1], y[:-1]) if periodic else (x, y)
    h, size = np.diff(x), float(np.ptp(to)) or 1.0
    # Scaled, so that the search for a weight is the same in all units.
    Q, R = _second(h / h.mean(), periodic=periodic)
    R, square, bent = R if periodic else R[:, 1:-1], Q @ Q.T, Q @ (to / size)
    solver = ca.Linsol("smoothing", "ldl", (R + square).sparsity())

    def off(weight: float) -> np.ndarray:
        """Distance of the curve from the points."""
        return np.asarray(
            (weight * Q.T @ solver.solve(R + weight * square, bent)).full().ravel() * size
        )

    straight = np.polynomial.Polynomial.fit(at, to, 0 if periodic else 1)
    line = float(np.sqrt(np.mean((to - straight(at)) ** 2)))
    if not distance < line:
        what = "a constant" if periodic else "a straight line"
        raise DeclarationError(
            f"curve: a smoothing of {distance:g} leaves only {what}, with a root mean square"
            f" residual of {line:.6g}; expected less"
        )
    low, high = -16.0, 24.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (
            (low, middle) if np.sqrt(np.mean(off(10.0**middle) ** 2)) > distance else (middle, high)
        )
    found = to - off(10.0**low)
    return np.append(found, found[0]) if periodic else found
