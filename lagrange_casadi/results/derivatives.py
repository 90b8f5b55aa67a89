"""The derivatives of a solution's quantities by parameters, as arrays that go with it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output, quotient
from ..errors import check_known
from ..model.wanted_names import SENSITIVITY
from .histories import Histories


@dataclass(frozen=True, eq=False)
class Derivatives:
    """The derivatives of quantities ``by`` parameters: of each parameter those of all that
    equilibrium determines, by output.

    They are exact and total: of loops, motions and densities too. Series have (t,), section forces
    (t, xi). Instants and ratios xi/l stand still; at a station, a section force is that on its
    tip's side.
    """

    by: Mapping[str, Mapping[Output, Array]] = field(default_factory=dict)

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters."""
        return tuple(self.by)

    @property
    def quantities(self) -> tuple[str, ...]:
        """The full names of the quantities."""
        return tuple(str(output) for output in next(iter(self.by.values()), {}))

    def array(self, name: str | Output, parameter: str) -> Array:
        """The derivative of a quantity by a parameter, in the quantity's unit over the parameter's.

        Raises :class:`.UnknownNameError` for a parameter by which there is none, and a quantity
        that has none.
        """
        check_known("parameter with sensitivities", [parameter], self.by)
        found = {str(output): values for output, values in self.by[parameter].items()}
        check_known("quantity with sensitivities", [str(name)], found)
        return found[str(name)]

    def notes(self) -> Iterator[str]:
        """Notes on derivatives that are not finite at some instants, as at a square root of
        zero.
        """
        for name, found in self.by.items():
            for output, x in found.items():
                if many := int((~np.isfinite(x.reshape(len(x), -1)).all(axis=1)).sum()):
                    yield (
                        f"the derivative of {output} by {name} is not finite at {many} of {len(x)}"
                        " instants"
                    )


@dataclass(frozen=True, eq=False)
class Series:
    """A quantity or a derivative of one: its full ``name``, as ``sensitivity:l:effort:O``, what it
    is of, its values and unit, what a file says of it.
    """

    name: str
    output: Output
    values: Array
    unit: str
    attributes: dict[str, str]


def derivatives(histories: Histories, sensitivities: Derivatives) -> Iterator[Series]:
    """All derivatives of histories."""
    parameters = histories.description.parameters
    for name, found in sensitivities.by.items():
        for output, values in found.items():
            unit = quotient(histories.unit(output), parameters[name].unit)
            quantity = output.meant(histories.table)
            words = quantity.attributes | {
                "long_name": f"{quantity.long_name}: derivative by {name}"
            }
            yield Series(f"{SENSITIVITY}:{name}:{output}", output, values, unit, words)
