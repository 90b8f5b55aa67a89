"""Dead centres between two instants: where the determinant of a loop changes its sign.

Let C be the square of the sine of a loop's transmission angle, or of any other closure. C is a
smooth function of time, at a dead centre it is zero, and the determinant is +sqrt(C) or -sqrt(C).
Closed forms keep to one sign, Newton's method to none: C at instants does not show that the
mechanism itself went on into the other assembly. What shows it are the rate C' and the slopes
dC/d(t, d) by time and drives. Near a dead centre at t0, C = A |t - t0|^n, so from two instants
a < t0 < b follows

    n = (b - a)/(C(b)/C'(b) - C(a)/C'(a)):

* n below 1: C has a positive minimum, the loop only comes near a dead centre;
* n = 2: the sine has a simple zero, so the determinant changes its sign;
* n above 3: the drives stop, or move along the dead centres. The slopes of C are twice the sine
  times those of the sine, so the sign changes if slopes at a and at b point opposite ways; else
  the loop touches the dead centre and turns back, unless it rests there.

The step between the instants is divided around its least C, again and again, until n is below 1, or
what is between a and b is a dead centre within rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeAlias

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Expression
from ..base.scalars import graph, inputs_of
from .iteration import NewtonLoop
from .verdicts import Bound

CLOSURES = ("CLOSURE", "BRANCH")
"""Bounds that come to zero at a dead centre, by what they are seen beside: of a ``BRANCH`` the
column is a sine, of a ``CLOSURE`` a square.
"""

POINTS, ROUNDS = 8, 20
"""Number of instants at which a step is divided, both ends included, and how often at most."""

FAR = 16.0
"""Share of the limit of C above which C and C' have digits enough for n."""

TOUCHES = 3.0, 10.0
"""Range of n of a loop that touches its dead centre and turns back. Where n is above, the loop
rests at its dead centre, or its links do not reach there.
"""

Path: TypeAlias = Callable[[Array], tuple[Array, Array, Array]]
"""Function of fractions (k,) of a step: C (k,), C' for a unit of the fraction (k,), and the slopes
(1 + drives, k). All are NaN where Newton's method does not close loops: C is taken for zero there.
"""


def closing_of(
    instant: ca.Function, bounds: Iterable[Bound], newton: NewtonLoop | None
) -> ca.Function:
    """The function ``closing(t, d, d_rate, d_acceleration, z, p) -> (squares, rates, slopes)`` of
    the m ``bounds`` of :data:`CLOSURES`: C (m,), C' [1/s] (m,), and dC/d(t, d), (m (1 + drives),),
    those of the first bound first.
    """
    given = inputs_of(instant)
    t, d, rate, acceleration, z, p = given.values()
    out, u = instant(*given.values()), ca.vertcat(t, d)
    squares: Expression = ca.vertcat(
        *(
            out[bound.column] ** 2 if bound.beside == "BRANCH" else out[bound.column]
            for bound in bounds
            if bound.beside in CLOSURES
        )
    )
    slopes = ca.jacobian(squares, u)
    if newton is not None:
        # At a solution the correction's slopes are those of the solution itself.
        slopes += ca.jacobian(squares, z) @ ca.jacobian(newton.step(z, t, d, p)[0], u)
    rates = slopes @ ca.vertcat(1, rate) + ca.jtimes(squares, rate, acceleration)
    return graph("closing", given, squares=squares, rates=rates, slopes=ca.vec(slopes.T))


def steps_near(squares: Array, t: Array, limit: float) -> npt.NDArray[np.intp]:
    """Return the numbers of the steps in which C may come to zero, from C at all instants ``t``.

    In such a step C has a minimum, so no neighbour is below its lower end; and a straight line
    through the two instants before, or after, the step comes below half of that end within the
    step, for C is convex where it is small.
    """
    step = np.diff(t)
    with np.errstate(all="ignore"):
        slope = np.concatenate(([np.nan], np.diff(squares) / step, [np.nan]))
    wide = np.concatenate(([np.nan], squares, [np.nan]))
    least = np.minimum(squares[:-1], squares[1:])
    lowest = ~(wide[: least.size] < least) & ~(wide[3:] < least) & (least > limit)
    before, after = squares[:-1] + step * slope[:-2], squares[1:] - step * slope[2:]
    return np.flatnonzero(lowest & ~(np.fmin(before, after) >= 0.5 * least))


def passes(path: Path, limit: float) -> bool:
    """Return whether a determinant changes its sign in a step along which C is on a ``path``, or
    is negative there; C at both ends is above the ``limit`` below which it is zero within rounding.
    """
    low, high, touches = 0.0, 1.0, False
    for _ in range(ROUNDS):
        x = np.linspace(low, high, POINTS)
        square, rate, slopes = path(x)
        if (square < -limit).any():
            return True
        square = np.where(np.isnan(square), 0.0, square)
        least = int(np.argmin(square))
        touches |= bool(square[least] <= limit)
        a = least if rate[least] < 0.0 else least - 1
        b = a + 1
        while a > 0 and square[a] <= FAR * limit:
            a -= 1
        while b < POINTS - 1 and square[b] <= FAR * limit:
            b += 1
        if a < 0 or b == POINTS or not rate[a] < 0.0 < rate[b]:
            return False
        with np.errstate(all="ignore"):  # squares of lengths beyond numbers
            order = (x[b] - x[a]) / (square[b] / rate[b] - square[a] / rate[a])
        if order < 1.0:
            return False
        opposed = slopes[:, a] @ slopes[:, b] < 0.0
        if b - a == POINTS - 1:
            break
        low, high = x[a], x[b]
    return touches and not (TOUCHES[0] <= order <= TOUCHES[1] and not opposed)
