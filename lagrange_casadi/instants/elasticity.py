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
        told = (
            [f"equilibrium leaves {len(self.told)} series open that least strain energy tells"]
            if self.told
            else []
        )
        return (*told, *(f"elasticity leaves forces open: {reason}" for reason in self.reasons))
