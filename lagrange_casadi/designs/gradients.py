"""How the peaks of a design change with all parameters."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..declare.density import Array
from ..sensitivity.ends import end_slopes
from ..sensitivity.peaks import PeakSlopes, peak_slopes
from ..sensitivity.slopes import Slopes
from ..summits.search import NOTHING
from .times import DesignTimes


def gradient(
    slopes: Slopes, times: DesignTimes, units: npt.NDArray[np.intp], p: Array, value: Array, t: Array, xi: Array
) -> PeakSlopes:
    """That of the peaks (q,) of a design ``p`` (parameters,): they are at times ``t`` and ratios ``xi``.

    ``units`` (q,) are numbers of units: what is nothing beside the largest of its unit moves with nothing.
    """
    instants = times.of(p[None])[0][0]
    ends = end_slopes(slopes.graph.scene, times.timing, float(instants[0]), float(instants[-1]), p)
    sizes, largest = np.abs(value), np.zeros(units.size)
    np.maximum.at(largest, units, np.where(np.isfinite(sizes), sizes, 0.0))
    chosen = np.arange(value.size, dtype=np.intc)
    return peak_slopes(slopes, instants, p, chosen, (value, t, xi), ends, sizes <= NOTHING * largest[units])
