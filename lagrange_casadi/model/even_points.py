"""Evenly spaced points, as a user says them: start, stop and count."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.space import require
from ..base.units import number
from ..errors import DeclarationError, NumberError, shown

EvenPoints = tuple[float, float, int]
"""Evenly spaced: start, stop and count; both ends are included."""

_MADE_FROM = 3
"""Number of arrays of points, with those from which they are made."""

_EXACT = 2**53
"""Up to which doubles hold all whole numbers, so that a quotient of two is rounded once."""

_UNEVEN = 1e-9
"""Fraction of a step that is rounding."""


def checked(what: str, even: EvenPoints, unit: str = "1", *, falls: bool = False) -> EvenPoints:
    """Even points in numbers, of a unit, which may be those of a way that ``falls``.

    Raises :class:`DeclarationError` for a count below 1, ends that are not finite, or too far apart
    for a double, are one, or fall where they may not.
    """
    try:
        if isinstance(even, str | Mapping) or len(even) != 3:
            raise TypeError
        start, stop = (number(end, unit, finite=False) for end in (even[0], even[1]))
        count = int(number(even[2]))
    except NumberError as error:
        raise DeclarationError(
            f"{what}: expected (start, stop, count), got {shown(even)}: {error}"
        ) from None
    except (TypeError, ValueError, LookupError, OverflowError):
        raise DeclarationError(
            f"{what}: expected (start, stop, count), got {shown(even)}"
        ) from None
    if count < 1 or count != even[2]:
        raise DeclarationError(
            f"{what}: COUNT must be a whole number from 1 to 2^63 - 1, got {shown(even[2])}"
        )
    if not (math.isfinite(start) and math.isfinite(stop)):
        raise DeclarationError(f"{what}: START and STOP must be finite, got {start:g} and {stop:g}")
    if not math.isfinite(stop - start):
        raise DeclarationError(
            f"{what}: START and STOP are too far apart, got {start:g} and {stop:g}"
        )
    if (stop < start and not falls) or (count > 1 and stop == start):
        raise DeclarationError(f"{what}: STOP must be after START, got {start:g} and {stop:g}")
    if count == 1 and stop != start:
        raise DeclarationError(
            f"{what}: COUNT must be 2 or more to reach from {start:g} to {stop:g}, got 1"
        )
    return start, stop, count


def points(even: EvenPoints, numbers: npt.NDArray[np.int64] | None = None) -> Array:
    """All of some even points, or those of given numbers.

    Each is rounded once from what the decimals of the ends say, so that 0.2:0.4:3 has 0.3, not
    0.30000000000000004; where these take more than the digits of a double, they are those of
    ``numpy.linspace``. Raises :class:`SizeError` for more than memory holds.
    """
    start, stop, count = even
    if numbers is None:
        require(f"the points from {start:g} to {stop:g}", (_MADE_FROM, count))
    numbers = np.arange(count) if numbers is None else numbers
    base, by, whole = _whole(float(start), float(stop), count)
    if max(abs(base), abs(base + by * (count - 1)), whole) <= _EXACT:
        return np.asarray((base + by * numbers) / whole)
    values = numbers * ((stop - start) / max(count - 1, 1)) + start
    return np.asarray(np.where(numbers == count - 1, float(stop), values))


@functools.lru_cache(maxsize=256)
def _whole(start: float, stop: float, count: int) -> tuple[int, int, int]:
    """Whole numbers of even points: the first, the step, and that over which both are."""
    first, last = (Fraction(repr(end)) for end in (start, stop))
    step = (last - first) / max(count - 1, 1)
    whole = math.lcm(first.denominator, step.denominator)
    return int(first * whole), int(step * whole), whole


def are_even(values: Array) -> bool:
    """Return whether values are in equal steps, within rounding."""
    if values.size < 3:
        return True
    gaps = np.abs(values - np.linspace(values[0], values[-1], values.size))
    step = abs(values[-1] - values[0]) / (values.size - 1)
    return bool(gaps.max() <= _UNEVEN * step + 4.0 * np.spacing(np.abs(values).max()))


def checked_ratios(even: EvenPoints) -> EvenPoints:
    """Even section ratios xi/l in numbers. Raises :class:`DeclarationError` outside [0, 1]."""
    start, stop, count = checked("xi", even)
    if start < 0.0 or stop > 1.0:
        raise DeclarationError(f"xi: ratios xi/l must lie in [0, 1], got {start:g} to {stop:g}")
    return start, stop, count
