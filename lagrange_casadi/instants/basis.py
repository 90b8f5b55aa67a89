"""The functions along a link of which its section forces are combined: see :mod:`.section_law`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arithmetic.interpret import interpret, numpy_arithmetic
from ..base.arrays import Array
from ..base.tables import Terms
from ..declare.density import NumericDensity
from ..equations.section_function import along
from .loads import DistributedLoad

_NUMPY = numpy_arithmetic()


@dataclass(frozen=True, eq=False)
class Basis:
    """Ratios ``u`` along a link, and there the functions that its forces are combined of: a row
    each, of shape (terms, u...).

    First are those of its law, three of a ``force`` and four of a ``bending`` moment, then those of
    what acts along it.
    """

    u: Array
    length: Array | float
    density: NumericDensity
    distributed_loads: Sequence[DistributedLoad]

    @cached_property
    def force(self) -> Array:
        """Basis of a force."""
        return self._rows(bends=False)

    @cached_property
    def bending(self) -> Array:
        """Basis of a bending moment."""
        return self._rows(bends=True)

    def _rows(self, *, bends: bool) -> Array:
        cells = self.density.cells
        function = along(
            self.density.breaks,
            tuple(map(len, cells)),
            tuple(load.powers for load in self.distributed_loads),
            bends=bends,
        )
        mass_properties = [self.length, *(coefficient for cell in cells for coefficient in cell)]
        # Width and end are those of the first instant; of n laws, which have (n, t), ratios give
        # (n, u).
        spans = [
            values[..., :1] for load in self.distributed_loads for values in (load.width, load.end)
        ]
        (rows,) = interpret(function, [mass_properties, spans, [self.u]], _NUMPY)
        found = np.empty((len(rows), *np.broadcast(self.length, self.u).shape))
        for row, values in zip(found, rows, strict=True):
            row[...] = values
        return found

    def of(
        self, terms: Terms, law: Sequence[Array], distributed_loads: Sequence[DistributedLoad]
    ) -> tuple[list[Array], Array]:
        """Columns and rows of a force, by the coefficients of its ``law`` and of what acts along
        the link.

        Of that each force carries its own: loads by their arms, and couples of slices without. The
        two planes of bending are of the same rows: where signs differ, columns have them.
        """
        sign, plain, width = (terms.arm, self.bending, 4) if terms.arm else (1, self.force, 3)
        columns = [*law[:1], *(-column for column in law[1:])] if sign < 0 else list(law)
        if not distributed_loads:
            return columns, plain[: len(law)]
        rows, first = [*plain[: len(law)]], 0
        for load in distributed_loads:
            for values, there in (
                (
                    [sign * value for value in load.terms.get(terms.distributed, ())],
                    plain[width + first :],
                ),
                (
                    load.terms.get(terms.couple, ()),
                    self.force[3 + first :] if terms.couple in load.terms else (),
                ),
            ):
                columns += values
                rows += [*there[: len(values)]]
            first += load.powers
        return columns, np.stack(rows)
