"""The size of a vector of which each component is an array, and the largest size of numbers."""

from __future__ import annotations

import functools
from collections.abc import Iterable

import numpy as np

from ..base.arrays import Array


def size_of(components: Iterable[Array]) -> Array:
    """The size."""
    return np.asarray(functools.reduce(np.hypot, components))


def largest(values: Array, axis: int | None = None) -> Array:
    """The place of the value that is largest in size, as of ``np.argmax``; of what is no number
    only where nothing else is.
    """
    sizes = np.abs(values)
    if axis is None and not np.isnan(sizes.flat[place := np.argmax(sizes)]):  # else a NaN is there
        return np.asarray(place)
    return np.asarray(np.argmax(np.where(np.isnan(sizes), -1.0, sizes), axis=axis))


def most(values: Array) -> float:
    """The largest size among values, 0 where none is a number."""
    return float(np.fmax.reduce(np.abs(values), axis=None, initial=0.0))
