"""The functions along a link of which its section forces are combined: see :mod:`.section_law`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Array
from ..base.tables import Terms
from ..declare.density import NumericDensity
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

    def of_force(self, terms: Terms, columns: Sequence[Array]) -> tuple[list[Array], Array]:
        """Columns and rows of a force, by the ``columns`` of its law and of what acts along the link.

        The two planes of bending are of the same rows: where signs differ, columns have them.
        """
        if not terms.arm:
            return list(columns), self.force[: len(columns)]
        return _signed(terms, columns), self.bending

    def of_thick(self, terms: Terms, columns: Sequence[Array], spreads: Sequence[SpreadLoad]) -> tuple[list[Array], Array]:
        """The same of a link whose slices have rotary inertia, by the ``columns`` of its law alone.

        Of what acts along such a link each force feels its own: loads by their arms, and couples without.
        """
        found, plain = _signed(terms, columns), self.bending if terms.arm else self.force
        rows, first = [*plain[: len(columns)]], 0
        sign, own = terms.arm or 1, 3 + (len(self.bending) - len(self.force) if terms.arm else 0)
        for spread in spreads:
            for values, there, start in (
                ([sign * value for value in spread.terms.get(terms.spread, ())], plain, own),
                (spread.terms.get(terms.couple, ()), self.force, 3),
            ):
                found += values
                rows += [*there[start + first : start + first + len(values)]]
            first += spread.powers
        return found, np.stack(rows)


def _signed(terms: Terms, columns: Sequence[Array]) -> list[Array]:
    """Columns with the sign of a moment's arm; the first one is a moment itself."""
    return [*columns[:1], *(-column for column in columns[1:])] if (terms.arm or 1) < 0 else list(columns)


def by_force(u: Array, length: float, t0: Array, t1: Array) -> list[Array]:
    """The rows of a law's forces, by the moments of the matter beyond."""
    return [np.ones_like(t0), t0, length * (u * t0 + t1)]
