"""The functions along a link of which its section forces are combined: see :mod:`.section_law`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..declare.density import Array, NumericDensity
from ..tables import Terms
from .spread_loads import SpreadLoad


@dataclass(frozen=True, eq=False)
class Basis:
    """Ratios ``u`` along a link, and there the functions that its forces are combined of: a row each, of shape (terms, u...).

    First are those of its law, three of a ``force`` and four of a ``bending`` moment, then those of what acts along it.
    """

    u: Array
    force: Array
    bending: Array

    @classmethod
    def of(cls, u: Array, length: float, density: NumericDensity, spreads: Sequence[SpreadLoad]) -> Basis:
        """Those of a link."""
        t0, t1, t2 = density.tails(u)
        force = by_force(u, length, t0, t1)
        bending = [np.ones_like(t0), length * (1.0 - u), length * t1, length * length * (u * t1 + t2)]
        for spread in spreads:
            for rows, more in zip((force, bending), spread.rows(u, length), strict=True):
                rows += more
        return cls(u, np.stack(force), np.stack(bending))

    def of_force(self, terms: Terms, many: int) -> Array:
        """The rows of a force that has so many columns."""
        if not terms.arm:
            return self.force[:many]
        return self.bending if terms.arm > 0 else np.concatenate([self.bending[:1], -self.bending[1:]])

    def of_thick(self, terms: Terms, columns: Sequence[Array], spreads: Sequence[SpreadLoad]) -> tuple[list[Array], Array]:
        """Columns and rows of a force of a link whose slices have rotary inertia, by the ``columns`` of its law.

        Of what acts along such a link each force feels its own: loads by their arms, and couples without.
        """
        found, own = list(columns), self.of_force(terms, len(self.force))
        rows, first = [*own[: len(columns)]], 0
        beside = len(self.bending) - len(self.force)
        for spread in spreads:
            for values, there, start in (
                (spread.terms.get(terms.spread, ()), own, 3 + (beside if terms.arm else 0)),
                (spread.terms.get(terms.couple, ()), self.force, 3),
            ):
                found += values
                rows += [*there[start + first : start + first + len(values)]]
            first += spread.powers
        return found, np.stack(rows)


def by_force(u: Array, length: float, t0: Array, t1: Array) -> list[Array]:
    """The rows of a law's forces, by the moments of the matter beyond."""
    return [np.ones_like(t0), t0, length * (u * t0 + t1)]
