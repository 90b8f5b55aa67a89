"""The functions along a link of which its section forces are combined: see :mod:`.section_law`."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.arrays import Array
from ..base.interpret import interpret, numpy_arithmetic
from ..base.tables import Terms
from ..engine.instants.grids import Functions
from ..engine.section_function import along
from ..model.density import NumericDensity
from .loads import DistributedLoad

_NUMPY = numpy_arithmetic()

_FEW = 1 << 12
"""Ratios up to which functions along a link are kept."""


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

    @property
    def force(self) -> Array:
        """Basis of a force."""
        return self.functions[0].rows

    @property
    def bending(self) -> Array:
        """Basis of a bending moment."""
        return self.functions[1].rows

    @cached_property
    def functions(self) -> tuple[Functions, Functions]:
        """Functions of a force, and of a bending moment."""
        # Width and end are those of the first instant; of n laws, which have (n, t), ratios give
        # (n, u).
        spans = [
            values[..., :1] for load in self.distributed_loads for values in (load.width, load.end)
        ]
        powers = tuple([load.powers for load in self.distributed_loads])
        if self.u.ndim == 1 and self.u.size <= _FEW and isinstance(self.length, float):
            given = tuple([float(span[0]) for span in spans])
            return _kept(self.length, self.density, given, powers, self.u.tobytes())
        return _interpreted(self.length, self.density, spans, powers, self.u)

    def of(
        self, terms: Terms, law: Sequence[Array], distributed_loads: Sequence[DistributedLoad]
    ) -> tuple[list[Array], Functions]:
        """Columns and rows of a force, by the coefficients of its ``law`` and of what acts along
        the link.

        Of that each force carries its own: loads by their arms, and couples of slices without. The
        two planes of bending are of the same rows: where signs differ, columns have them.
        """
        sign, k, width = (terms.arm, 1, 4) if terms.arm else (1, 0, 3)
        columns = [*law[:1], *(-column for column in law[1:])] if sign < 0 else list(law)
        if not distributed_loads:
            return columns, self.functions[k]
        plain = self.functions[k].rows
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
        return columns, Functions(np.stack(rows))


@functools.lru_cache(maxsize=64)
def _kept(
    length: float,
    density: NumericDensity,
    spans: tuple[float, ...],
    powers: tuple[int, ...],
    u: bytes,
) -> tuple[Functions, Functions]:
    """Functions along a link, which depend on parameters and ratios only."""
    places = [np.array([span]) for span in spans]
    found = _interpreted(length, density, places, powers, np.frombuffer(u))
    for functions in found:
        functions.rows.setflags(write=False)  # shared by all who ask for them
    return found


def _interpreted(
    length: Array | float,
    density: NumericDensity,
    spans: Sequence[Array],
    powers: tuple[int, ...],
    u: Array,
) -> tuple[Functions, Functions]:
    """The functions of a force and of a bending moment."""
    cells, found = density.cells, []
    mass_properties = [length, *(coefficient for cell in cells for coefficient in cell)]
    function = along(density.breaks, tuple(map(len, cells)), powers)
    for rows in interpret(function, [mass_properties, spans, [u]], _NUMPY):
        whole = np.empty((len(rows), *np.broadcast(length, u).shape))
        for row, values in zip(whole, rows, strict=True):
            row[...] = values
        found.append(Functions(whole))
    force, bending = found
    return force, bending
