"""Uncertainty of residuals by its finite number of digits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.compensated import DTYPES, ROUNDING
from ...base.quantities import Output
from ...base.vocabulary import Precision
from ..histories import Histories

ROUNDINGS = 4.0
NEARBY = 32.0
"""So many roundings may be between what is reported, and what a law has seen of it."""

TOLERANCE, COARSE = 1e-9, 1e-3
"""A residual above it means that the solution is wrong, not that it is rounded; in doubles, and
where less was asked for.
"""


def blur(histories: Histories) -> float:
    """Uncertainty of a phase by the reported angles: one rounding of the largest of them [rad]."""
    angles = [
        Output("motion", name)
        for name, kind in histories.description.coordinates.items()
        if kind == "angle"
    ]
    angles += [Output("pose", name, "angle") for name in histories.description.bodies]
    reported = (histories.outputs[angle] for angle in angles if angle in histories.outputs)
    return Digits.of(histories).rounding * max(
        (float(np.max(np.abs(values))) for values in reported), default=0.0
    )


@dataclass(frozen=True)
class Digits:
    """Uncertainty by a precision.

    ``rounding`` is the largest relative error of one rounding, ``least`` the force beside which
    what underflows is as small as a rounding, and ``tolerance`` the least residual that fails.
    """

    rounding: float
    least: float
    tolerance: float

    @property
    def doubted(self) -> float:
        """Limit of a residual by the roundings of a law alone; a larger one is examined more
        closely.
        """
        return 256.0 * self.rounding

    @property
    def coarseness(self) -> float:
        """A rounding as a share of the least residual that fails."""
        return ROUNDINGS * self.rounding / self.tolerance

    @classmethod
    def of(cls, histories: Histories) -> Digits:
        """The digits that histories were made with."""
        single = histories.provenance.precision == "single"
        precision: Precision = "single" if single else "double"
        rounding = ROUNDING[precision]
        least = float(np.finfo(DTYPES[precision]).tiny) / rounding
        return cls(rounding, least, COARSE if single else TOLERANCE)
