"""Steps between instants that begin or end at rest: where in them the curves that friction at rest leaves open are numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Array
from .between import Flags
from .panels import INNER, SPACING, CurveSource, Samples, joined

_CUTS = 40
"""How often what is between rest and motion is cut into nine."""


@dataclass(frozen=True, eq=False)
class Piece:
    """What of a step some ``curves`` (c,) are numbers in: between two times, and at these.

    Rest is at most ``beside`` before it or after it.
    """

    curves: Flags
    start: float
    stop: float
    first: Samples
    last: Samples
    beside: float


def pieces(source: CurveSource, t: Array, samples: Samples, side: float) -> Iterator[Piece]:
    """The pieces of all steps between instants ``t`` that begin or end at rest, as near to it as ``side``, if times tell.

    Curves that rest at all instants are left out. A step that rests at both ends has pieces if it moves in its middle.
    """
    rests = np.isnan(samples.values)
    some = ~rests.all(axis=1)
    side = max(side, SPACING * float(np.abs(t).max()))
    for step in np.flatnonzero((rests[some, :-1] | rests[some, 1:]).any(axis=0)).tolist():
        resting = some & (rests[:, step] | rests[:, step + 1])
        if rests[resting, step : step + 2].all():
            resting &= ~np.isnan(source.at(np.array([(t[step] + t[step + 1]) / 2])).values[:, 0])
        if t[step + 1] - t[step] > 8 * side:
            yield from _pieces(source, float(t[step]), float(t[step + 1]), samples.some(slice(step, step + 2)), resting, side)


def _pieces(source: CurveSource, start: float, stop: float, ends: Samples, resting: Flags, side: float) -> Iterator[Piece]:
    """Those of a step, of curves in groups that rest at the same times."""
    if not resting.any():
        return
    inside = start + np.arange(1, INNER + 1) * ((stop - start) / (INNER + 1))
    t: Array = np.concatenate([[start, start + side], inside, [stop - side, stop]])
    around = joined(ends.some(slice(0, 1)), source.at(t[1:-1]), ends.some(slice(1, 2)))
    while resting.any():
        leader = int(np.argmax(resting))
        group, none = _alike(resting, leader, around), np.isnan(around.values[leader])
        edges = np.flatnonzero(np.diff(none.astype(int), prepend=1, append=1))
        for a, b in edges.reshape(-1, 2).tolist():
            first, last = (t[a], around.some(slice(a, a + 1))), (t[b - 1], around.some(slice(b - 1, b)))
            if a > 0:
                group, first = _begins(source, t[a - 1], first, group, leader, side)
            if b < t.size:
                group, last = _begins(source, t[b], last, group, leader, side)
            yield Piece(group, float(first[0]), float(last[0]), first[1], last[1], side)
        resting = resting & ~group


def _begins(
    source: CurveSource, none: float, some: tuple[float, Samples], group: Flags, leader: int, side: float
) -> tuple[Flags, tuple[float, Samples]]:
    """Where a group is a number next to where it is none, and what there is; those of the group that are alike on the way."""
    for _ in range(_CUTS):
        if abs(some[0] - none) <= side:
            break
        t = np.array([none + k * ((some[0] - none) / (INNER + 1)) for k in range(1, INNER + 1)])
        found = source.at(t)
        group = _alike(group, leader, found)
        open_ = np.flatnonzero(np.isnan(found.values[leader]))
        k = int(open_[-1]) + 1 if open_.size else 0
        if k < INNER:
            some = t[k], found.some(slice(k, k + 1))
        none = t[k - 1] if k else none
    return group, some


def _alike(group: Flags, leader: int, samples: Samples) -> Flags:
    """The curves of a group that are no numbers where its leader is none."""
    rests = np.isnan(samples.values)
    return np.asarray(group & (rests == rests[leader]).all(axis=1))
