"""Engine of a sweep: many designs in, the peaks of each out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from ...base.arrays import Array
from ...equations.program import Program
from ...instants.solution import Provenance
from ..designs.outcome import Outcome


class Engine(Protocol):
    """A scene compiled once, for any designs."""

    @property
    def quantities(self) -> tuple[str, ...]:
        """Full names of what peaks are found of."""

    @property
    def efforts(self) -> tuple[str, ...]:
        """Full names of the efforts."""

    @property
    def sampled(self) -> bool:
        """True if peaks are those of the instants, with an error."""

    @property
    def indeterminate(self) -> tuple[str, ...]:
        """Full names of quantities, and of what histories hold, that equilibrium may leave open for
        some designs: NaN there.
        """

    @property
    def columns(self) -> tuple[str, ...]:
        """Full names of what histories hold."""

    @property
    def cost(self) -> float:
        """Seconds that a core takes for a design, about: counted, not measured, so that it is the
        same everywhere.
        """

    @property
    def capacity(self) -> int:
        """Bytes of memory that a core takes while it evaluates."""

    @property
    def provenance(self) -> Provenance:
        """Origin of the numbers."""

    def evaluate(self, p: Array, *, threads: int | None = None, histories: bool = False) -> Outcome:
        """Evaluate designs ``p`` (designs, parameters), every parameter in the order of
        declaration; default: a thread a core.
        """

    def slopes_at(self, p: Array, outcome: Outcome) -> Array:
        """The derivatives of the peaks of the outcome of designs ``p`` by all parameters, (designs,
        quantities, parameters).
        """

    def mean_slopes_at(self, p: Array, outcome: Outcome) -> Array:
        """Derivatives of means over time, and of root mean squares, (designs, 2, efforts,
        parameters).
        """

    def failures(self, p: Array, whole: Program) -> Mapping[str, float]:
        """Failures of one design that has a result, (parameters,), by a graph of all outputs; none
        if all is well.
        """
