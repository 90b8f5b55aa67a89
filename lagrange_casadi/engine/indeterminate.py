"""Forces with nothing for what equilibrium leaves open, and how much each of them changes with
that.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.quantities import Check, Column, Output
from ..base.scalars import column, entries

SOME = 577.0
"""Value of what is open [N or N m] at which it is seen what changes with it: with nothing, a force
that is zero has a size without a slope, and a square of slope zero.
"""


@dataclass(frozen=True, eq=False)
class Forces:
    """Forces ``values`` with nothing for what is open, and of those that change with that how much
    they do, ``open``.

    What does not change with it by structure is determined. Any other force is determined where
    that is zero, for parameters and at instants that are looked at then. Where elasticity has
    completed them, ``before`` is how much they changed before.
    """

    values: Mapping[Column, Any]
    open: Mapping[Output, Any]
    before: Mapping[Output, Any] | None = None

    @classmethod
    def over(
        cls, acting: Mapping[Column, ca.SX], free: ca.SX, units: Mapping[Output, Expression]
    ) -> Forces:
        """Forces ``acting`` that are expressions of what is open, ``free``; and by how much those
        that are neither forces nor moments change beside a force, ``units``.
        """
        if not free.numel():
            return cls(acting, {})
        forces = column(map(ca.SX, acting.values()))
        slopes = ca.jacobian(forces, free)
        slopes, forces = (
            ca.substitute(part, free, value * ca.SX.ones(free.numel()))
            for part, value in ((slopes, SOME), (forces, 0.0))
        )
        doubted = {
            key: slopes[k, :]
            for k, key in enumerate(acting)
            if slopes[k, :].nnz() and isinstance(key, Output)
        }
        sizes = {
            output: ca.sum2(ca.fabs(slope)) / units.get(output, 1)
            for output, slope in doubted.items()
        }
        # What is lost is open where the friction is, however slowly it slides.
        for output in sizes:
            if output.member == "loss":
                sizes[output] = sizes[replace(output, member="along")]
        return cls(dict(zip(acting, entries(forces), strict=True)), sizes)

    def with_those_of(
        self, made: Callable[[Mapping[Column, Expression]], Mapping[Column, Expression]]
    ) -> Forces:
        """Add what is ``made`` of these forces, which is open with what goes into it."""
        symbols: dict[Column, Any] = {output: ca.SX.sym(str(output)) for output in self.open}
        more = made({**self.values, **symbols})
        if not symbols or not more:
            return replace(self, values={**self.values, **more})
        found, names = column(map(ca.SX, more.values())), column(symbols.values())
        sparsity = ca.jacobian_sparsity(found, names)
        into = {
            key: [output for j, output in enumerate(self.open) if sparsity.has_nz(k, j)]
            for k, key in enumerate(more)
        }
        placed = ca.substitute(found, names, column(self.values[output] for output in symbols))
        values = {**self.values, **dict(zip(more, entries(placed), strict=True))}
        sums = {
            key: sum(self.open[output] for output in each)
            for key, each in into.items()
            if isinstance(key, Output) and each
        }
        return replace(self, values=values, open={**self.open, **sums})

    @property
    def columns(self) -> dict[Column, ca.SX]:
        """The forces, and checks by which it is seen whether they are open."""
        return {
            **self.values,
            **{Check("open", output): size for output, size in self.open.items()},
        }
