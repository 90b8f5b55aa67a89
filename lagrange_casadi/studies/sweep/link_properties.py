"""The section laws of designs, from their columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ...base.arrays import Array
from ...base.quantities import Output
from ...declare.density import Density
from ...equations.model_data import ModelData
from ...instants.laws import law_of
from ...instants.section_law import SectionLaw


@dataclass(frozen=True, eq=False)
class LinkProperties:
    """A link's length and density over the parameters, without deriving either anew for each
    design.

    Laws are made of what was evaluated in a ``precision``.
    """

    link: str
    density: Density
    numbers: Any
    precision: str

    @classmethod
    def of(cls, data: ModelData, name: str, precision: str) -> LinkProperties:
        """Make it for a link."""
        length, density = data.mass_properties(name, data.symbols)
        cells = [c for cell in density.cells for c in cell]
        numbers = ca.Function(
            "matter", [data.symbols], [ca.densify(ca.vertcat(ca.SX(0, 1), length, *cells))]
        )
        return cls(name, density, numbers, precision)

    def law(self, members: Mapping[Output, Array], p: Array) -> SectionLaw:
        """The law from its coefficients and loads, (t,), of a design (parameters,).

        Or the laws of n designs: members are (n, t), length and density (n, 1).
        """
        length, *cells = (
            self.numbers(p.T).full()[..., None]
            if p.ndim > 1
            else self.numbers(p).full().ravel().tolist()
        )
        rest = iter(cells)
        density = self.density.at(lambda _: next(rest), length)
        return law_of(self.link, members, length, density, self.precision)
