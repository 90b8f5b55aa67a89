"""Curves given by points: smooth ones, and tables with corners.

Splines are computed in many digits, and each of their numbers is rounded once, so that pieces join.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Context, Decimal, localcontext

import casadi as ca
import numpy as np

from ..base import lookups
from ..base.arguments import fitting, public
from ..base.arrays import Array, Expression
from ..base.units import number
from ..base.vocabulary import BEYONDS, Beyond
from ..errors import DeclarationError, NumberError, shown

_SAME = 1e-12
"""Largest relative difference of the ends of a periodic curve that is rounding."""

_DIGITS = 40
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
    places: Sequence[float],
    values: Sequence[float],
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
        Increasing abscissas (n,), in the unit of ``x``.
    values
        Ordinates (n,), in the unit of the load.
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
    if beyond not in (None, *BEYONDS):
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
        to = _smoothed(at, to, float(smoothing), periodic=periodic)
    origin = (at[0] + at[-1]) / 2 if periodic else 0.0
    starts, cells = _through(at, to, periodic=periodic, origin=origin)
    if not all(math.isfinite(number) for cell in cells for number in cell):
        raise DeclarationError(
            "curve: the points are so close to each other that the slopes overflow;"
            " expected fewer or more distant points"
        )
    return Curve(at[0], at[-1], periodic, origin, tuple(starts), tuple(cells))


def _through(
    x: Sequence[float], y: Sequence[float], *, periodic: bool, origin: float = 0.0
) -> tuple[list[float], list[Cell]]:
    """Starts of the pieces, less an ``origin``, and of each piece c in c0 + c1 u + c2 u^2 + c3 u^3,
    u from its start.

    The second derivative is continuous, over the seam too where ``periodic``, and else not-a-knot:
    the first two pieces are one cubic, and the last two. De Boor, *A Practical Guide to Splines*,
    1978, chapter IV.
    """
    with localcontext(Context(prec=_DIGITS)):
        at, to = [Decimal(number) for number in x], [Decimal(number) for number in y]
        h = [b - a for a, b in itertools.pairwise(at)]
        slopes = [(b - a) / width for a, b, width in zip(to, to[1:], h, strict=False)]
        bends = _bends_around(h, slopes) if periodic else _bends(h, slopes)
        cells = [
            (
                to[i],
                slopes[i] - h[i] * (2 * bends[i] + bends[i + 1]) / 6,
                bends[i] / 2,
                (bends[i + 1] - bends[i]) / (6 * h[i]),
            )
            for i in range(len(h))
        ]
        starts = [float(place - Decimal(origin)) for place in at[:-1]]
        return starts, [(float(a), float(b), float(c), float(d)) for a, b, c, d in cells]


def _smoothed(
    x: Sequence[float], y: Sequence[float], distance: float, *, periodic: bool
) -> list[float]:
    """The values at the points of the least bent curve whose distance from the points has the root
    mean square ``distance``.

    Reinsch, *Smoothing by spline functions*, Numer. Math. 10, 1967. Raises
    :class:`DeclarationError` for a distance that leaves nothing but a straight line.
    """
    at, to = np.array(x), np.array(y[:-1] if periodic else y)
    h = np.diff(at)
    # Scaled, so that the search for a weight is the same in all units.
    h, size = h / h.mean(), float(np.ptp(to)) or 1.0
    rows, columns = (h.size, to.size) if periodic else (h.size - 1, to.size)
    second: dict[tuple[int, int], float] = {}
    mass: dict[tuple[int, int], float] = {}
    for row in range(rows):
        before, after = (h[row - 1], h[row]) if periodic else (h[row], h[row + 1])
        places = [(row + k) % columns for k in ((-1, 0, 1) if periodic else (0, 1, 2))]
        weights = (1 / before, -1 / before - 1 / after, 1 / after)
        second |= {(row, place): weight for place, weight in zip(places, weights, strict=True)}
        mass[row, row] = (before + after) / 3
        beside = {
            (row, (row + k) % rows): width / 6
            for k, width in ((-1, before), (1, after))
            if periodic or 0 <= row + k < rows
        }
        mass |= beside
    Q, R, values = _sparse(second, rows, columns), _sparse(mass, rows, rows), ca.DM(to / size)
    square, bent = Q @ Q.T, Q @ values
    solver = ca.Linsol("smoothing", "ldl", (R + square).sparsity())

    def off(weight: float) -> np.ndarray:
        """Distance of the curve from the points."""
        return np.asarray(
            (weight * Q.T @ solver.solve(R + weight * square, bent)).full().ravel() * size
        )

    line = float(np.sqrt(np.mean((to - to.mean()) ** 2))) if periodic else _off_line(at, to)
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
    return [float(value) for value in ([*found, found[0]] if periodic else found)]


def _sparse(entries: dict[tuple[int, int], float], rows: int, columns: int) -> ca.DM:
    places = list(zip(*entries, strict=True))
    return ca.DM.triplet(
        list(places[0]), list(places[1]), ca.DM(list(entries.values())), rows, columns
    )


def _off_line(at: np.ndarray, to: np.ndarray) -> float:
    line = np.polynomial.Polynomial.fit(at, to, 1)
    return float(np.sqrt(np.mean((to - line(at)) ** 2)))


def _bends(h: list[Decimal], slopes: list[Decimal]) -> list[Decimal]:
    """Second derivatives at all points, not-a-knot at the ends."""
    n = len(h) - 1
    below, diagonal, above = h[:n], [2 * (a + b) for a, b in itertools.pairwise(h)], h[1:]
    right = [6 * (b - a) for a, b in itertools.pairwise(slopes)]
    diagonal[0] += h[0] + h[0] * h[0] / h[1]
    above[0] -= h[0] * h[0] / h[1]
    diagonal[-1] += h[-1] + h[-1] * h[-1] / h[-2]
    below[-1] -= h[-1] * h[-1] / h[-2]
    inner = _tridiagonal(below, diagonal, above, right)
    first = inner[0] - h[0] / h[1] * (inner[1] - inner[0])
    last = inner[-1] + h[-1] / h[-2] * (inner[-1] - inner[-2])
    return [first, *inner, last]


def _bends_around(h: list[Decimal], slopes: list[Decimal]) -> list[Decimal]:
    """Second derivatives at all points of a curve that goes round: by Sherman and Morrison's
    formula.
    """
    n = len(h)
    below = [h[i - 1] for i in range(n)]
    diagonal = [2 * (h[i - 1] + h[i]) for i in range(n)]
    above = h[:]
    right = [6 * (slopes[i] - slopes[i - 1]) for i in range(n)]
    corner = h[-1]
    diagonal[0] -= corner
    diagonal[-1] -= corner
    ends = [corner, *[Decimal(0)] * (n - 2), corner]
    found = _tridiagonal(below, diagonal, above, right)
    other = _tridiagonal(below, diagonal, above, ends)
    share = (found[0] + found[-1]) / (1 + other[0] + other[-1])
    bends = [a - share * b for a, b in zip(found, other, strict=True)]
    return [*bends, bends[0]]


def _tridiagonal(
    below: list[Decimal], diagonal: list[Decimal], above: list[Decimal], right: list[Decimal]
) -> list[Decimal]:
    """Solve for a diagonal that dominates; ``below[0]`` and ``above[-1]`` do not count."""
    over, found = [above[0] / diagonal[0]], [right[0] / diagonal[0]]
    for i in range(1, len(diagonal)):
        pivot = diagonal[i] - below[i] * over[-1]
        over.append(above[i] / pivot)
        found.append((right[i] - below[i] * found[-1]) / pivot)
    for i in reversed(range(len(found) - 1)):
        found[i] -= over[i] * found[i + 1]
    return found
