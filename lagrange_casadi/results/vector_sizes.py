"""The size of a vector of which each component is an array, and how it changes with these."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Sequence

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


def growth_of_size(components: Sequence[Array], changes: Sequence[Array]) -> Array:
    """Change of the size with the components; nothing of it cancels."""
    before = size_of(components)
    after = size_of(value + change for value, change in zip(components, changes, strict=True))
    product = sum(
        (2.0 * value + change) * change for value, change in zip(components, changes, strict=True)
    )
    return _quotient(np.asarray(product), before + after)


def slope_of_size(components: Sequence[Array], slopes: Sequence[Array]) -> Array:
    """The derivative of the size by those of the components; zero where the size is."""
    product = sum(value * slope for value, slope in zip(components, slopes, strict=True))
    return _quotient(np.asarray(product), size_of(components))


def _quotient(product: Array, size: Array) -> Array:
    size = np.broadcast_to(size, product.shape)
    return np.divide(product, size, out=np.zeros(product.shape), where=size != 0.0)
