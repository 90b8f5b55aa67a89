"""The way of one start, in plain numbers: to be kept, and to be sent."""

from __future__ import annotations

import math
from dataclasses import dataclass

HOLDS = 1e-7
"""Violation of a constraint, relative to its limit, that is allowed."""

CONVERGED, STOPPED = "converged", "stopped"
"""Endings of a run; other endings describe a failure."""


@dataclass(frozen=True)
class SearchRun:
    """Run from a ``start`` to its ``end``, values of all parameters each.

    ``objective`` and ``excess`` are those of the end, ``scale`` is about how large the objective
    is, ``ending`` says why it ended. ``history`` has a row for every design on the way: objective,
    excess, 1 where it has a result, and the values that were chosen. ``multipliers`` are of the
    constraints, ``bounds`` of the chosen parameters' bounds as shares; both are empty where no
    program led there. See :class:`.Conditions` for ``residual`` and ``curvature``.
    """

    start: tuple[float, ...]
    end: tuple[float, ...]
    objective: float
    excess: float
    scale: float
    ending: str
    history: tuple[tuple[float, ...], ...]
    multipliers: tuple[float, ...]
    bounds: tuple[float, ...]
    residual: float
    curvature: float
    evaluations: int

    @property
    def merit(self) -> tuple[float, float]:
        """Key by which runs are compared: the better one has less."""
        return merit(self.excess, rounded(self.objective, self.scale))


def merit(excess: float, objective: float) -> tuple[float, float]:
    """Key by which designs are compared: the better one has less. Without a result the excess is
    NaN.
    """
    if math.isnan(excess):
        return math.inf, math.inf
    return (excess if excess > HOLDS else 0.0), objective


def rounded(objective: float, scale: float) -> float:
    """An objective less its last digits, so that of designs as good the one that converged is
    taken.
    """
    return round(objective / scale, 8) * scale if math.isfinite(objective) else objective
