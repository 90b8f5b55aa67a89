"""Designs whose motion cannot be though all their instants have numbers: by what is beyond a
curve's ends, and by kinks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, Flags
from ...base.status import Status
from ...engine.program import Program
from ...model.beyond_ends import BEYOND

_OK = int(Status.OK)


@dataclass(frozen=True, eq=False)
class Watch:
    """Conditions on motions and constraints of a graph, for the parameters of each design."""

    program: Program

    @cached_property
    def _seen(self) -> dict[str, list[int]]:
        """The columns of what each constraint sees."""
        constraints = self.program.data.corners.constraints
        return {name: self.program.seen_columns(name) for name in constraints}

    def __bool__(self) -> bool:
        """Return whether there are any conditions."""
        laws = self.program.data.corners.laws
        return self.program.laws.beyond is not None or bool(laws) or self.columns

    @property
    def columns(self) -> bool:
        """True if columns of designs may be needed, as arguments of constraints."""
        return bool(self.program.data.corners.constraints)

    def statuses(
        self,
        p: Array,
        t: Array,
        status: npt.NDArray[np.int8],
        near: Flags,
        columns: Callable[[Array, Array], Array],
    ) -> npt.NDArray[np.int8]:
        """The statuses of designs ``p`` (n, parameters) that had ``status``, at instants ``t`` (1
        or n, t).

        Those are looked at whose marks come ``near`` (n,); ``columns`` evaluates the columns (n,
        columns, t) of some designs at instants, for what constraints see.
        """
        found: npt.NDArray[np.int8] = status.copy()
        ends, corners = self.program.laws.beyond, self.program.data.corners
        if ends is not None:
            for k, row in enumerate(p):
                share = float(ends(t[min(k, len(t) - 1)][None], row).full().max(initial=0.0))
                if not share <= BEYOND["double"] and np.isfinite(row).all():
                    found[k] = Status.BEYOND_ENDS
        some = np.flatnonzero((found == _OK) & (near | corners.hidden))
        if not some.size:
            return found
        p, t = p[some], t[some] if len(t) > 1 else t
        broken = corners.broken_laws(t, p)
        if self.columns:
            rows = columns(p, t)
            broken |= corners.broken_constraints(lambda name: rows[:, self._seen[name]], p)
        found[some[broken]] = Status.CORNER
        return found
