"""Rainflow counting by ASTM E1049-85: the stress cycles of a history of loads."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...base.arguments import public
from ...base.arrays import Array
from ...errors import DeclarationError


class StressCycle(NamedTuple):
    """A cycle between two values of a history, at the indices ``first`` and ``last``: its range
    ``size``, its ``mean``, and its count ``times``, 1 or 1/2.
    """

    size: float
    mean: float
    times: float
    first: int
    last: int


def reversals(history: Array) -> Array:
    """The indices at which a history turns, its ends among them; of equal neighbours the first."""
    kept = np.append(0, np.flatnonzero(np.diff(history) != 0.0) + 1)
    rising = np.diff(history[kept]) > 0.0
    turning_points = np.flatnonzero(rising[1:] != rising[:-1]) + 1
    return np.unique([kept[0], *kept[turning_points], kept[-1]])


@public
def rainflow(history: Array | Sequence[float], *, repeating: bool = False) -> list[StressCycle]:
    """Count the cycles of a history by rainflow counting (ASTM E1049-85).

    Parameters
    ----------
    history : array of float
        Values (n,) in the order of time.
    repeating : bool
        False: count once (section 5.4.4), with half cycles. True: the history is repeated (section
        5.4.5), it begins at its largest value, and every cycle counts 1.

    Returns
    -------
    list of StressCycle
        The cycles: their ranges, means, counts and places.

    Raises
    ------
    DeclarationError
        If the values are not a row of finite numbers.
    """
    values = np.asarray(history, float)
    if values.ndim != 1 or not values.size or not np.isfinite(values).all():
        raise DeclarationError("rainflow: expected a row of finite numbers")
    return counted(values, repeating=repeating)


def counted(values: Array, *, repeating: bool) -> list[StressCycle]:
    """Count the cycles of a history of finite numbers, as :func:`rainflow` does."""
    order = np.arange(values.size)
    if repeating:
        start = int(np.argmax(values))
        order = np.concatenate([order[start:], order[: start + 1]])
    turning_points = order[reversals(values[order])]
    found: list[StressCycle] = []
    stack: list[int] = []

    def cycle(first: int, last: int, times: float) -> None:
        a, b = float(values[first]), float(values[last])
        found.append(StressCycle(abs(b - a), (a + b) / 2, times, first, last))

    level = values.tolist()
    for index in turning_points.tolist():
        stack.append(index)
        while len(stack) > 2:
            newest = abs(level[stack[-1]] - level[stack[-2]])
            before = abs(level[stack[-2]] - level[stack[-3]])
            if newest < before:
                break
            if len(stack) > 3:
                cycle(stack[-3], stack[-2], 1.0)
                del stack[-3:-1]
            elif repeating:
                break
            else:
                cycle(stack[0], stack[1], 0.5)
                del stack[0]
    # Of a repeated history there is left the way from the largest value to the smallest and back.
    for first, last in itertools.pairwise(stack[:2] if repeating else stack):
        cycle(first, last, 1.0 if repeating else 0.5)
    return found
