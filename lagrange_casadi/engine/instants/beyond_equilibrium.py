"""Results of a solution that equilibrium alone does not determine: by elasticity, and where
friction helps to hold the mechanism.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output


@dataclass(frozen=True)
class Elasticity:
    """The indeterminate outputs that least strain energy determined, ``completed``, and the
    ``reasons`` why others stay indeterminate.
    """

    completed: tuple[Output, ...] = ()
    reasons: tuple[str, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """Results in lines."""
        lines = (
            [
                (
                    f"{len(self.completed)} statically indeterminate series are determined by least"
                    " strain energy"
                )
            ]
            if self.completed
            else []
        )
        return (
            *lines,
            *(f"elasticity does not determine some forces: {reason}" for reason in self.reasons),
        )


ENDS = ("least", "largest")


@dataclass(frozen=True, eq=False)
class Holding:
    """The ``least`` and the ``largest`` effort, in ``unit``, that a drive may need at each instant,
    by sign, (t,).

    Both are the effort where equilibrium determines it. Where joints rest, their frictions may make
    it anything between. Where that range is not evaluated both are NaN, and ``reason`` says why;
    else it is empty.
    """

    least: Array
    largest: Array
    unit: str
    reason: str = ""

    @property
    def worst(self) -> Array:
        """The one of both that is larger in size, (t,)."""
        return np.where(np.abs(self.least) > np.abs(self.largest), self.least, self.largest)


def held_outputs(held: Mapping[str, Holding]) -> dict[Output, Array]:
    """Both ends of the ranges of drives, by the names that they have in a file."""
    return {
        Output("holding", name, end): getattr(found, end)
        for name, found in held.items()
        for end in ENDS
    }


def held_notes(held: Mapping[str, Holding]) -> Iterator[str]:
    """The range of each effort that friction at rest makes indeterminate, or why there is none."""
    for name, found in held.items():
        there = found.least < found.largest
        if found.reason:
            yield f"held at rest: effort:{name} is not evaluated: {found.reason}"
        elif there.any():
            least, largest = found.least[there].min(), found.largest[there].max()
            yield (
                f"held at rest: effort:{name} may be anything from {least:.5g} to {largest:.5g}"
                f" {found.unit}"
            )
