"""Derivatives of a design's peaks by all parameters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...instants.statistics import counted, shares
from ...sensitivity.curvatures import Curvatures
from ...sensitivity.ends import end_bends, end_slopes
from ...sensitivity.peak_curvatures import peak_bends
from ...sensitivity.peaks import PeakSlopes, peak_slopes
from ...sensitivity.slopes import Numbers, Slopes
from ...sensitivity.ties import ties
from ...summits.search import NOTHING
from .times import DesignTimes


def gradient(
    slopes: Slopes,
    times: DesignTimes,
    units: npt.NDArray[np.intp],
    p: Array,
    value: Array,
    t: Array,
    xi: Array,
) -> PeakSlopes:
    """Gradient of the peaks (q,) of a design ``p`` (parameters,): they are at times ``t`` and
    ratios ``xi``.

    ``units`` (q,) are numbers of units: what is nothing beside the largest of its unit moves with
    nothing.
    """
    instants = times.of(p[None], asked=False)[0][0]
    chosen, ends = np.arange(value.size, dtype=np.intc), _ends(slopes, times, instants, p)
    return peak_slopes(slopes, instants, p, chosen, (value, t, xi), ends, _nothing(units, value))


class MeanSlopes(NamedTuple):
    """The derivatives of means over time, and of roots of mean squares, by all parameters, (e,
    parameters); NaN of a root of 0.
    """

    mean: Array
    rms: Array


def mean_slopes(slopes: Slopes, times: DesignTimes, p: Array, chosen: Numbers) -> MeanSlopes:
    """Derivatives of the means of the ``chosen`` quantities (e,) of a design ``p`` (parameters,):
    of sums by trapezia, whose instants may move.
    """
    instants = times.of(p[None], asked=False)[0][0]
    first, last = _ends(slopes, times, instants, p)
    share = np.linspace(0.0, 1.0, instants.size)[:, None]
    moved = (1.0 - share) * first + share * last
    z, nowhere = slopes.iterated(instants, p, instants), np.full(instants.size, np.nan)
    mean, rms = np.empty((2, chosen.size, p.size))
    for k, number in enumerate(chosen):
        found = slopes.at(instants, z, p, np.full(instants.size, number, np.intc), nowhere)
        counts = counted(found.value)
        weights, value = shares(instants, counts), np.where(counts, found.value, 0.0)
        whole = np.where(counts[:, None], found.slopes + found.rate[:, None] * moved, 0.0)
        mean[k] = weights @ whole
        with np.errstate(all="ignore"):
            rms[k] = (weights * value) @ whole / np.sqrt(weights @ value**2)
    return MeanSlopes(mean, rms)


def curvature(
    curvatures: Curvatures,
    times: DesignTimes,
    units: npt.NDArray[np.intp],
    p: Array,
    peaks: tuple[Array, Array, Array],
    own: PeakSlopes,
) -> Array:
    """The second derivatives (q, parameters, parameters) of the peaks (value, t, xi) of a design,
    whose gradient is ``own``.
    """
    instants = times.of(p[None], asked=False)[0][0]
    chosen = np.arange(own.kinds.size, dtype=np.intc)
    ends = end_bends(
        curvatures.slopes.graph.laws, times.timing, float(instants[0]), float(instants[-1]), p
    )
    return peak_bends(curvatures, instants, p, chosen, peaks, own, ends, _nothing(units, peaks[0]))


def tied(
    slopes: Slopes,
    times: DesignTimes,
    units: npt.NDArray[np.intp],
    p: Array,
    value: Array,
    own: PeakSlopes,
    others: Array,
) -> npt.NDArray[np.bool_]:
    """Return which peaks (q,) tie with another peak; ``others`` (q, n, 4) are those that are as
    large: see :func:`.ties`.
    """
    instants = times.of(p[None], asked=False)[0][0]
    chosen, ends = np.arange(value.size, dtype=np.intc), _ends(slopes, times, instants, p)
    return ties(slopes, instants, p, chosen, value, own, ends, others) & ~_nothing(units, value)


def _ends(slopes: Slopes, times: DesignTimes, instants: Array, p: Array) -> Array:
    return end_slopes(slopes.graph.laws, times.timing, float(instants[0]), float(instants[-1]), p)


def _nothing(units: npt.NDArray[np.intp], value: Array) -> npt.NDArray[np.bool_]:
    """Return which peaks are zero within rounding, relative to the largest of their unit."""
    sizes, largest = np.abs(value), np.zeros(units.size)
    np.maximum.at(largest, units, np.where(np.isfinite(sizes), sizes, 0.0))
    return np.asarray(sizes <= NOTHING * largest[units])
