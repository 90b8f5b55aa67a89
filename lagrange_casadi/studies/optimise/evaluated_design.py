"""A design as it was judged: the values of terms, and where their peaks are."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from ...base.arrays import Array
from .sampled_design import Point, SampledDesign
from .terms import Term

Signed = tuple[Point, float]
"""A point, and the sign by which its value counts."""


@dataclass(frozen=True, eq=False)
class EvaluatedDesign:
    """A design after its evaluation: the value of every term, NaN without a result.

    ``closure`` is the least square of the sine of a transmission angle, NaN without loops;
    ``closing`` by how much it is below its limit, relative to the limit. ``sampled`` and the local
    ``points`` of the terms, the largest first, are None and empty unless they were asked for.
    """

    p: Array
    values: Mapping[Term, float]
    sampled: SampledDesign | None = None
    closure: float = math.nan
    closing: float = -math.inf
    points: Mapping[Term, tuple[Signed, ...]] = field(default_factory=dict)

    def value(self, term: Term) -> float:
        """Value of a term."""
        return self.values[term]

    @property
    def has_result(self) -> bool:
        """True if there is a result."""
        return all(math.isfinite(value) for value in self.values.values())
