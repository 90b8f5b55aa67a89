"""Results from elasticity in a solution."""

from __future__ import annotations

from dataclasses import dataclass

from ..base.quantities import Output
from ..renamed import renamed


@renamed
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
