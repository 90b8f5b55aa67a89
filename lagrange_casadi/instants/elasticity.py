"""Results from elasticity in a solution."""

from __future__ import annotations

from dataclasses import dataclass

from ..base.quantities import Output


@dataclass(frozen=True)
class Elasticity:
    """The outputs that equilibrium leaves open and least strain energy ``told``, and ``reasons``
    why others stay open.
    """

    told: tuple[Output, ...] = ()
    reasons: tuple[str, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """Results in lines."""
        lines = (
            [
                (
                    f"{len(self.told)} statically indeterminate series are determined by least"
                    " strain energy"
                )
            ]
            if self.told
            else []
        )
        return (
            *lines,
            *(f"elasticity does not determine some forces: {reason}" for reason in self.reasons),
        )
