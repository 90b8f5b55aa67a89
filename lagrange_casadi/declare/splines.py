"""Cubic splines through points, and points smoothed; in many digits, each number rounded once, so
that pieces join.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from decimal import Context, Decimal, localcontext

import casadi as ca
import numpy as np

from ..errors import DeclarationError

_DIGITS = 40
_HALVINGS = 50

Cell = tuple[float, float, float, float]


def through(
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


def smoothed(
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
