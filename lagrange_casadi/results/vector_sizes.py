"""The size of a vector of which each component is an array, and the largest size of numbers."""

from __future__ import annotations

import functools
from collections.abc import Iterable

import numpy as np

from ..base.arrays import Array


def size_of(components: Iterable[Array]) -> Array:
    """The size."""
    return np.asarray(functools.reduce(np.hypot, components))


def highest(values: Array) -> int:
    """The place of the largest value, as of ``np.argmax``; of what is no number only where nothing
    else is.
    """
    if not np.isnan(values.flat[place := np.argmax(values)]):  # else a NaN is there
        return int(place)
    return int(np.argmax(np.where(np.isnan(values), -np.inf, values)))


def largest(values: Array) -> int:
    """The place of the value that is largest in size, as :func:`highest` finds it."""
    return highest(np.abs(values))


def most(values: Array) -> float:
    """The largest size among values, 0 where none is a number."""
    return float(np.fmax.reduce(np.abs(values), axis=None, initial=0.0))
