"""Test whether another peak of a quantity is as large as the reported one, and changes differently
with parameters.

The largest of both then has a kink at these parameters, and no derivative. What is as large and
changes alike, as the same peak in the next turn, is no tie.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.vocabulary import Precision
from .peaks import PeakSlopes, peak_slopes
from .slopes import Numbers, Slopes

AS_LARGE: dict[Precision, float] = {"double": 1e-9, "single": 1e-5}
"""Largest relative difference of two peaks that tie."""

_OTHERWISE = 1e-4
"""Relative difference of two slopes that differ."""

_NOISE, _FAINT = 1e-9, 1e-12
"""Fraction of the largest slope by a parameter, and of the peak, that counts as no slope."""


def ties(
    slopes: Slopes,
    instants: Array,
    p: Array,
    chosen: Numbers,
    value: Array,
    own: PeakSlopes,
    ends: Array,
    others: Array,
) -> npt.NDArray[np.bool_]:
    """Return which of the peaks (q,) of the ``chosen`` quantities tie with another one: see
    :func:`.peak_slopes`, which gave ``own``.

    ``others`` (q, n, 4) are the local peaks that are as large, as :class:`.Peaks` has them.
    """
    found = np.zeros(value.size, bool)
    there = (
        ~np.isnan(others[..., 0])
        & (np.isfinite(value) & np.isfinite(own.slopes).all(axis=1))[:, None]
    )
    # Of one there is no other.
    there &= np.count_nonzero(there, axis=1)[:, None] > 1
    if not there.any() or not p.size:
        return found
    numbers, (_, t, xi, values) = np.nonzero(there)[0], others[there].T
    changed = peak_slopes(
        slopes, instants, p, chosen[numbers], (values, t, xi), ends, np.zeros(numbers.size, bool)
    ).slopes
    sized, told = (
        np.sign(values)[:, None] * changed,
        np.sign(value[numbers])[:, None] * own.slopes[numbers],
    )
    # What rounding leaves of a slope that is nothing is no difference.
    noise = _NOISE * np.nanmax(np.abs(own.slopes), axis=0) + _FAINT * np.abs(
        value[numbers, None]
    ) / np.where(p == 0.0, 1.0, np.abs(p))
    found[
        numbers[
            (
                np.abs(sized - told) > _OTHERWISE * np.maximum(np.abs(sized), np.abs(told)) + noise
            ).any(axis=1)
        ]
    ] = True
    return found
