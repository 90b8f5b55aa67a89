"""Range of a drive's effort at each instant if friction helps to hold the mechanism."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.quantities import Output

ENDS = ("least", "largest")


@dataclass(frozen=True, eq=False)
class Holding:
    """The ``least`` and the ``largest`` effort, in ``unit``, that a drive may need at each instant,
    by sign, (t,).

    Both are the effort where that is told. Where joints at rest leave it open, frictions that are
    there may make it anything between. Where that range is not told either both are NaN, and
    ``untold`` says why, else it is empty.
    """

    least: Array
    largest: Array
    unit: str
    untold: str = ""

    @property
    def worst(self) -> Array:
        """The one of both that is larger in size, (t,)."""
        return np.where(np.abs(self.least) > np.abs(self.largest), self.least, self.largest)

    def during(self, instants: slice | npt.NDArray[np.bool_]) -> Holding:
        """Ranges at some of the instants."""
        return replace(self, least=self.least[instants], largest=self.largest[instants])


def held_outputs(held: Mapping[str, Holding]) -> dict[Output, Array]:
    """Both ends of the ranges of drives, by the names that they have in a file."""
    return {
        Output("holding", name, end): getattr(found, end)
        for name, found in held.items()
        for end in ENDS
    }


def held_notes(held: Mapping[str, Holding]) -> Iterator[str]:
    """The range of each effort that friction at rest leaves open, or why it is not told."""
    for name, found in held.items():
        there = found.least < found.largest
        if found.untold:
            yield f"held at rest: effort:{name} is not told: {found.untold}"
        elif there.any():
            least, largest = found.least[there].min(), found.largest[there].max()
            yield (
                f"held at rest: effort:{name} may be anything from {least:.5g} to {largest:.5g}"
                f" {found.unit}"
            )
