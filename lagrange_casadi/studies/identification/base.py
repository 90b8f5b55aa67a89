"""Base parameters: the combinations of parameters that a regressor determines, by a pivoted QR
factorization.

Gautier, *Numerical calculation of the base inertial parameters of robots*, J. Robotic Systems 8,
1991.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...base.arrays import Array

RANK = 1e-10
"""Least distance of a column from those before it, relative to its norm, that is not rounding."""

_ROUNDING = 1e-13
"""Largest share of a quantity in what a parameter changes that is rounding."""

_WORSE = 100.0
"""Factor by which the condition may be worse with the parameters that rank first."""

_FAINT = 1e-8
"""Least share of a parameter in a combination, in columns of norm 1, that is not rounding."""


@dataclass(frozen=True, eq=False)
class Base:
    """Combinations that the columns of a regressor determine.

    ``chosen`` are the numbers of the parameters that stand for them, and ``dependent`` those of the
    others. A combination is ``chosen + weights @ dependent``, ``weights`` (chosen, dependent).
    ``absent`` are the numbers of those that change nothing. ``condition`` is that of the chosen
    columns, each scaled to norm 1.
    """

    chosen: tuple[int, ...]
    dependent: tuple[int, ...]
    absent: tuple[int, ...]
    weights: Array
    condition: float

    def rows(self, count: int) -> Array:
        """Return the rows by which ``count`` parameters make the combinations."""
        found: Array = np.zeros((len(self.chosen), count))
        found[:, self.chosen] = np.eye(len(self.chosen))
        found[:, self.dependent] = self.weights
        return found

    def words(self, names: Sequence[str]) -> tuple[str, ...]:
        """Write each combination as ``m_rod + 0.5 m_slider``."""
        found = []
        for row, k in zip(self.weights, self.chosen, strict=True):
            words = names[k]
            for weight, other in zip(row.tolist(), self.dependent, strict=True):
                if weight:
                    size = f"{abs(weight):.6g} "
                    sign = "-" if weight < 0.0 else "+"
                    words += f" {sign} {'' if size == '1 ' else size}{names[other]}"
            found.append(words)
        return tuple(found)


class Ranking(NamedTuple):
    """Usual sizes of parameters (k,), and the order in which they may stand for combinations."""

    scales: Array
    order: tuple[int, ...]


def triangle(columns: Array) -> Array:
    """Return the triangular factor of columns (n, k), which has their norms and products."""
    return np.asarray(np.linalg.qr(columns, mode="r"))


def base_of(columns: Array, ranking: Ranking, whole: float = 0.0) -> Base:
    """Return the base of the columns (n, k) of parameters.

    A column that is rounding beside the others, each times its scale, or beside the norm of the
    ``whole`` of which they are derivatives, is absent. The first of the ranking stand for
    combinations, unless others make a far better condition.
    """
    norms = np.linalg.norm(columns, axis=0)
    sizes = norms * ranking.scales
    present = np.flatnonzero(sizes > max(RANK * sizes.max(initial=0.0), _ROUNDING * whole))
    left = triangle(columns[:, present] / norms[present])
    order = _independent(left)
    plain = _independent(left, np.argsort(np.argsort(ranking.order)[present]).tolist())
    conditions = [float(np.linalg.cond(left[:, some])) if some else 1.0 for some in (order, plain)]
    if len(plain) == len(order) and conditions[1] <= _WORSE * conditions[0]:
        order = plain
    chosen = np.sort(np.array(order, int))
    dependent = np.setdiff1d(np.arange(present.size), chosen)
    weights = np.linalg.lstsq(left[:, chosen], left[:, dependent], rcond=None)[0]
    weights[np.abs(weights) < _FAINT] = 0.0
    chosen, dependent = present[chosen], present[dependent]
    return Base(
        tuple(chosen.tolist()),
        tuple(dependent.tolist()),
        tuple(np.setdiff1d(np.arange(norms.size), present).tolist()),
        weights * norms[dependent] / norms[chosen][:, None],
        conditions[1 if order is plain else 0],
    )


def _independent(columns: Array, ranks: Sequence[int] = ()) -> list[int]:
    """Return as many columns of norm 1 as the rank: in an order those that do not depend on the
    ones before them, or without one, each the farthest from those before it.

    Each column is orthogonalized twice, which is enough (Giraud, Langou, 2002).
    """
    rest, order = columns.copy(), []
    for k in range(columns.shape[1]):
        far = np.linalg.norm(rest, axis=0)
        best = ranks[k] if ranks else int(np.argmax(far))
        if far[best] > RANK:
            order.append(best)
            direction = rest[:, best] / far[best]
            for _ in range(2):
                rest -= np.outer(direction, direction @ rest)
            rest[:, best] = 0.0
    return order
