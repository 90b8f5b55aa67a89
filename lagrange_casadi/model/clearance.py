"""Paths along which nothing comes near to where it may make a kink: by bounds over whole stretches
of them.

Most motions and constraints of most designs are far from every kink, and need not be looked at
instant by instant.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Flags
from ..base.boxes import boxed
from ..base.symbolic import symbolic_property

_STRETCHES = 64
"""Number of parts of a path whose bounds as a whole do not suffice."""

_KEPT = 4
"""Number of sizes of batches whose arrays are kept."""

_NEAR = 1e-6
"""Fraction of the largest value on a path below which a value is examined."""


class _Kept(threading.local):
    """Arrays of each thread, by the number of designs."""

    def __init__(self) -> None:
        self.calls: dict[int, tuple[list[Array], list[Array], Callable[[], None], Any]] = {}


class Clearance:
    """Proof that ``marks(x, p)`` stay off zero, or off whole numbers if ``whole``, all along a
    path.

    A mark that does not change along the path makes no kink either.
    """

    def __init__(self, marks: ca.Function, whole: Flags, crossing: Flags) -> None:
        self._marks, self._whole, self._open = marks, whole, crossing
        self._kept = _Kept()

    @symbolic_property
    def _near(self) -> ca.Function:
        """The function ``(low, high, p, most) -> (near, most)`` of bounds of what is seen: whether
        any mark may come near.

        ``most`` are the largest sizes that marks are compared with, beside their own.
        """
        symbols, rows, width = boxed(self._marks)
        beside = ca.SX.sym("most", len(rows))
        clear, sizes = ca.SX(width < np.inf), []
        for (low, high), whole, crossing, of in zip(
            rows, self._whole, self._open, ca.vertsplit(beside), strict=True
        ):
            sizes.append(ca.fmax(of, ca.fmax(ca.fabs(low), ca.fabs(high))))
            capacity = _NEAR * sizes[-1]
            off = (
                ca.floor(low - capacity) == ca.floor(high + capacity)
                if whole
                else ca.logic_or(low > capacity, high < -capacity)
            )
            clear = ca.logic_and(clear, off if crossing else ca.logic_or(off, low == high))
        found = [1.0 - clear, ca.vertcat(*sizes)]
        return ca.Function(
            "near", [*symbols, beside], [ca.densify(one) for one in found], {"cse": True}
        )

    def near(self, low: Array, high: Array, p: Array, paths: Callable[[Flags], Array]) -> Flags:
        """Return which paths within ``low`` and ``high`` (d, symbols) may have a mark near zero,
        for values ``p`` (d, fixed) of each.

        ``paths`` gives some of them, (d, symbols, n), of straight steps.
        """
        near, most = self._looked(low, high, p, 0.0)
        if not near.any():
            return near
        rows = paths(near)
        # No more stretches than steps, each with both its ends.
        ends = np.unique(np.linspace(0, rows.shape[2] - 1, _STRETCHES + 1).astype(int))
        first, last, many = ends[:-1], ends[1:], ends.size - 1
        if many < 2:
            return near
        bounds = [
            of(of.reduceat(rows, first, axis=2)[..., :many], rows[..., last])
            for of in (np.minimum, np.maximum)
        ]
        low, high = (np.moveaxis(of, 1, 2).reshape(-1, rows.shape[1]) for of in bounds)
        found, _ = self._looked(
            low, high, np.repeat(p[near], many, axis=0), np.repeat(most[near], many, axis=0)
        )
        near[near] = found.reshape(-1, many).any(axis=1)
        return near

    def _looked(
        self, low: Array, high: Array, p: Array, most: Array | float
    ) -> tuple[Flags, Array]:
        """Return whether any mark comes near within boxes (d, symbols), and the size of marks there
        (d, marks).
        """
        count = len(low)
        calls = self._kept.calls
        if count not in calls:
            # Blocks of designs, and prepared scenes, go on asking for as many, and as many
            # stretches of a few.
            if len(calls) >= _KEPT:
                calls.clear()
            calls[count] = bound(self._near, count)
        given, found, call, _ = calls[count]
        for array, values in zip(given, (low, high, p, most), strict=True):
            array[...] = values
        call()
        return found[0][:, 0] != 0.0, found[1]


def bound(
    function: ca.Function, count: int
) -> tuple[list[Array], list[Array], Callable[[], None], ca.FunctionBuffer]:
    """Arrays (count, rows) of the arguments and results of a function, what fills these by those,
    and what must live for it.
    """
    given = [np.empty((count, function.size1_in(k))) for k in range(function.n_in())]
    found = [np.empty((count, function.size1_out(k))) for k in range(function.n_out())]
    mapped = function.map(count) if count > 1 else function
    buffer, call = mapped.buffer()
    for number, array in enumerate(given):
        buffer.set_arg(number, array.data)
    for number, array in enumerate(found):
        buffer.set_res(number, array.data)
    return given, found, call, buffer
