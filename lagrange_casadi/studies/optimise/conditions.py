"""The conditions of an optimum: of the first order by Karush, Kuhn and Tucker, and of the second
order.

Nocedal and Wright, Numerical Optimization, 2nd edition, theorems 12.1, 12.5 and 12.6.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...base.arrays import Array

if TYPE_CHECKING:
    import casadi as ca

_ACTIVE, _COUNTS = 1e-7, 1e-6
"""Distance from zero within which a row is active; and the least relative multiplier, of the
largest term or of the objective, that counts.
"""

_STEP = 1e-5
"""Step of differences of slopes, relative to the bounds."""

DOWN = -1e-6
"""Curvature, of the objective over the square of the bounds, from which it is negative beyond
rounding: the objective falls to the second order, within all limits, at a saddle or a maximum.
"""


@dataclass(frozen=True, eq=False)
class Conditions:
    """Optimality of a solution.

    ``residual`` is what is left of the first-order conditions, over the largest of their terms, or
    the objective. ``curvature`` is the least second derivative of the Lagrangian along what limits
    with a multiplier leave free: infinite where that is nothing, NaN where it has none. ``least``
    is the same along what all active limits leave free: below zero at what is no minimum, which is
    left along ``direction``.
    """

    residual: float
    curvature: float
    least: float
    direction: Array


def conditions(
    slopes: ca.Function,
    at: Array,
    objective: float,
    by_g: Array,
    by_x: Array,
    given: Array,
    chosen: int,
    *,
    formed: bool,
) -> Conditions:
    """Optimality conditions of a program's solution ``at``, with the multipliers of its rows, and
    of bounds, of which ``chosen`` has some.

    Where nothing is active all terms of the first-order conditions are nearly zero: then the
    ``objective`` is what is large.

    ``slopes(at, by_g, given)`` has the Lagrangian's gradient without bounds, its parts, the rows
    and their Jacobian, and the Lagrangian's second derivatives where these are ``formed``;
    elsewhere they are differences of the gradient.
    """
    slope, parts, rows, jacobian, hessian = (part.full() for part in slopes(at, by_g, given))
    size = max(
        float(np.abs(parts).max()),
        float(np.abs(by_x).max(initial=0.0)),
        abs(objective),
        np.finfo(float).tiny,
    )
    residual = float(np.abs(slope.ravel() + by_x).max()) / size
    if not formed:
        hessian = _differences(lambda x: slopes(x, by_g, given)[0].full().ravel(), at, chosen)
    if not (np.isfinite(hessian).all() and np.isfinite(jacobian).all()):
        return Conditions(residual, math.nan, math.nan, np.zeros(chosen))
    bounded = np.zeros(at.size, bool)
    bounded[:chosen] = np.minimum(at[:chosen], 1.0 - at[:chosen]) <= _ACTIVE
    held, pressed = np.abs(by_g) > _COUNTS * size, np.abs(by_x) > _COUNTS * size
    curvature, _ = _least(hessian, np.vstack([jacobian[held], np.eye(at.size)[pressed]]))
    held, pressed = held | (rows.ravel() > -_ACTIVE), pressed | bounded
    least, direction = _least(hessian, np.vstack([jacobian[held], np.eye(at.size)[pressed]]))
    return Conditions(residual, curvature, least, direction[:chosen])


def _least(hessian: Array, active: Array) -> tuple[float, Array]:
    """The least eigenvalue along what leaves active limits as they are, and its direction."""
    from scipy.linalg import null_space  # imported where it is needed, as it takes long

    free = null_space(active, 1e-9) if len(active) else np.eye(len(hessian))
    if not free.size:
        return math.inf, np.zeros(len(hessian))
    values, vectors = np.linalg.eigh(free.T @ hessian @ free)
    return float(values[0]), free @ vectors[:, 0]


def _differences(slope: Callable[[Array], Array], at: Array, chosen: int) -> Array:
    """Second derivatives by differences of first ones, within the bounds; what is no parameter
    enters linearly.
    """
    hessian = np.zeros((at.size, at.size))
    for k in range(chosen):
        ends = np.tile(at, (2, 1))
        ends[:, k] = np.clip([at[k] - _STEP, at[k] + _STEP], 0.0, 1.0)
        hessian[:, k] = (slope(ends[1]) - slope(ends[0])) / (ends[1, k] - ends[0, k])
    hessian[chosen:] = hessian[:, chosen:].T
    return np.asarray((hessian + hessian.T) / 2)
