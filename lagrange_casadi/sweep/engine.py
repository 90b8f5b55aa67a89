"""What a sweep asks of an engine: many designs in, the peaks of each out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from ..density import Array
from ..solution import Provenance

STATUSES: Mapping[int, tuple[str, str]] = {
    0: ("ok", "there is a result"),
    1: ("not_assembled", "a loop cannot be closed, or is singular, at some instant"),
    2: ("impossible", "a part is impossible at these parameters"),
}
"""A word and a sentence for each status."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """What designs give, a row each; where ``status`` is not 0 the row is NaN.

    ``value``, ``t`` and ``xi`` (designs, quantities) are the peak of each quantity with its sign, its instant [s], and its ratio
    xi/l, NaN off a link; ``mean`` and ``rms`` (designs, efforts) are those of each effort over time. Where histories are kept,
    ``series`` (designs, columns, t) holds all columns.
    """

    status: npt.NDArray[np.int8]
    value: Array
    t: Array
    xi: Array
    mean: Array
    rms: Array
    series: Array | None = None


class Engine(Protocol):
    """A scene compiled once, for any designs."""

    @property
    def quantities(self) -> tuple[str, ...]:
        """Full names of what peaks are found of; ``reaction:JOINT`` is the resultant."""

    @property
    def efforts(self) -> tuple[str, ...]:
        """Full names of the efforts."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Full names of what histories hold."""

    @property
    def provenance(self) -> Provenance:
        """How the numbers are made."""

    def evaluate(self, p: Array, *, threads: int | None = None, histories: bool = False) -> Outcome:
        """Evaluate designs ``p`` (designs, parameters), every parameter in the order of declaration; default: a thread a core."""
