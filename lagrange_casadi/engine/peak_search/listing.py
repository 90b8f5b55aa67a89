"""Local peaks of curves: values counted one way, and the largest that a search comes upon."""

from __future__ import annotations

import math

import numpy as np

from ...base.arrays import Array
from .between import Numbers
from .intervals import TOPS, CurveSource, Samples


def base_of(quantity: Numbers, values: Array, count: int) -> Array:
    """Base of each quantity's values: as far below the least as the largest is above it."""
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.fmin.at(low, quantity, np.fmin.reduce(values, axis=1))
    np.fmax.at(high, quantity, np.fmax.reduce(values, axis=1))
    return np.where(low <= high, 2 * low - high, 0.0)


class Counted:
    """Curves times a ``sign``, counted from a ``base``."""

    def __init__(self, source: CurveSource, sign: int, base: Array) -> None:
        self.source, self.sign, self.base = source, sign, base

    def at(self, t: Array) -> Samples:
        """Sample times of the span."""
        return self.counted(self.source.at(t))

    def counted(self, samples: Samples) -> Samples:
        """Samples relative to the base."""
        return samples._replace(values=self.sign * samples.values - self.base)


class Tops:
    """Local peaks of quantities, of curves in steps so long: the largest of each, at most
    :data:`.TOPS`.
    """

    def __init__(self, quantity: Numbers, count: int, step: float) -> None:
        self.quantity, self.step = quantity, step
        self.rows: list[list[tuple[int, float, float, float]]] = [[] for _ in range(count)]

    def add(self, curve: int, value: float, t: float, xi: float) -> None:
        """List what a curve is at a time: the largest of what is less than a step apart."""
        q = self.quantity[curve]
        rows = self.rows[q]
        near = [row for row in rows if row[0] == curve and abs(row[1] - t) <= self.step]
        out = near[:1] or (
            sorted(rows, key=lambda row: abs(row[3]))[:1] if len(rows) == TOPS else []
        )
        if not any(abs(row[3]) >= abs(value) for row in out):
            self.rows[q] = [row for row in rows if row not in out] + [(curve, t, xi, value)]

    def listing(
        self, t: Array, given: Samples, least: Array, limit: Array, rounding: Array
    ) -> Array:
        """Local peaks that are the largest of their step and far from larger ones, (q,
        :data:`.TOPS`, 4): see :class:`.Peaks`.

        At instants too, where these reach the ``least`` of their curve; of what is level some, and
        one where it has no limit.
        """
        sizes = np.nan_to_num(np.abs(given.values), nan=0.0, posinf=np.inf)
        around, off = np.pad(sizes, ((0, 0), (1, 1)), constant_values=-1.0), rounding[:, None]
        before, after = around[:, :-2], around[:, 2:]
        tops = (
            (sizes >= before - off)
            & (sizes >= after - off)
            & (sizes >= least[:, None])
            & ~np.isnan(given.values)
        )
        level = np.maximum(sizes - before, sizes - after) <= off
        for curve in range(len(sizes)):
            flat = np.flatnonzero(tops[curve] & level[curve])
            every = 1 + 2 * flat.size // TOPS if math.isfinite(limit[curve]) else t.size
            for i in (*np.flatnonzero(tops[curve] & ~level[curve]), *flat[::every]):
                self.add(curve, given.values[curve, i], float(t[i]), given.places[curve, i])
        found = np.full((len(self.rows), TOPS, 4), np.nan)
        for q, rows in enumerate(self.rows):
            kept: list[tuple[int, float, float, float]] = []
            for row in sorted(rows, key=lambda row: -abs(row[3])):
                curve, time, _, value = row
                i = int(np.clip((time - t[0]) // self.step, 0, t.size - 2)) if t.size > 1 else 0
                size = abs(value) + rounding[curve]
                near = any(
                    other[0] == curve and abs(other[1] - time) <= self.step for other in kept
                )
                if size >= least[curve] and (size >= sizes[curve, i : i + 2]).all() and not near:
                    kept.append(row)
            found[q, : len(kept)] = np.reshape(kept, (-1, 4))
            found[q, :, 0] -= int(np.argmax(self.quantity == q))
        return found
