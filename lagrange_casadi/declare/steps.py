"""Straight steps of paths, and what functions give at shares of them and beside."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ..arithmetic.running_errors import running_errors
from ..base.arrays import Array, Operand
from .clearance import bound
from .limits_beside import Side

if TYPE_CHECKING:
    import casadi as ca

_HALVINGS = 64
"""Number of times that a step is halved."""

_WIDEST, _LIMITS = 2048.0, 47
"""Number of steps away from which a limit is taken, and number of distances, each half of the one
before.
"""


@dataclass(frozen=True, eq=False)
class Steps:
    """Straight steps of paths: from ``x`` by ``change`` (symbols, m), ``p`` (fixed, m), and of
    which path (``owner``).

    A share of a step is looked at, from ``low`` to ``high``; ``least`` and ``most`` are where the
    path ends.
    """

    x: Array
    change: Array
    p: Array
    owner: npt.NDArray[np.intp]
    low: Array
    high: Array
    least: Array
    most: Array

    @classmethod
    def of(cls, paths: Array, p: Array) -> Steps:
        """All steps of paths (d, symbols, n) for values ``p`` (d, fixed)."""
        count, symbols, n = paths.shape
        x, direction = (
            np.moveaxis(rows, 1, 0).reshape(symbols, -1)
            for rows in (paths[..., :-1], np.diff(paths))
        )
        number = np.tile(np.arange(n - 1.0), count)
        owner, none = np.repeat(np.arange(count), n - 1), np.zeros(count * (n - 1))
        return cls(x, direction, p.T[:, owner], owner, none, none + 1.0, -number, n - 1.0 - number)

    @classmethod
    def through(cls, paths: Array, p: Array) -> Steps:
        """Values from all instants on, or, if the path rests there, in the direction from which it
        came; as far as asked for.

        A single one goes anywhere.
        """
        count, symbols, n = paths.shape
        ahead = np.diff(paths, append=paths[..., -1:])
        came = np.diff(paths, prepend=paths[..., :1])
        directions = (
            np.where((ahead != 0.0).any(axis=1, keepdims=True), ahead, came)
            if n > 1
            else np.ones(paths.shape)
        )
        x, direction = (
            np.moveaxis(rows, 1, 0).reshape(symbols, -1) for rows in (paths, directions)
        )
        owner, none = np.repeat(np.arange(count), n), np.zeros(count * n)
        return cls(x, direction, p.T[:, owner], owner, none, none, none - np.inf, none + np.inf)

    @classmethod
    def joined(cls, parts: Sequence[Steps]) -> Steps:
        """Several as one."""
        return cls(
            *(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in _STEPS)
        )

    def some(self, which: Operand) -> Steps:
        """Some of the steps."""
        which = np.asarray(which) if len(which) else np.zeros(0, np.intp)
        return Steps(*(getattr(self, name)[..., which] for name in _STEPS))

    def to(self, low: Operand, high: Operand) -> Steps:
        """Other shares of the steps."""
        return replace(self, low=low + 0.0 * self.low, high=high + 0.0 * self.high)

    def at(self, share: Operand) -> Array:
        """The places at shares of the steps, not beyond the path."""
        return np.asarray(self.x + np.clip(share, self.least, self.most) * self.change)

    def off(self, roundings: float, least: float) -> Array:
        """The shares that move by so many roundings of places, or of ``least``."""
        sizes = np.maximum(np.maximum(np.abs(self.x), np.abs(self.x + self.change)), least)
        moves = np.abs(self.change) / np.spacing(sizes)
        return np.asarray(roundings / np.maximum(moves.max(axis=0, initial=0.0), 1.0))

    def halved(self, state: Callable[[Array], Array | npt.NDArray[np.bool_]]) -> Steps:
        """Bisect to where the state of each, (rows, m), changes from that at its low share."""
        low, high = self.low, self.high
        before = state(low)
        for _ in range(_HALVINGS if self.owner.size else 0):
            middle = (low + high) / 2
            if not ((low < middle) & (middle < high)).any():
                # No number is between them.
                break
            same = (state(middle) == before).all(axis=0)
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        return self.to(low, high)


_STEPS = tuple(entry.name for entry in fields(Steps))


def called(function: ca.Function, *columns: Array) -> Array:
    """The rows (rows, m) of a function of columns."""
    if not columns[0].shape[1]:
        return np.zeros((function.size1_out(0), 0))
    given, found, call, _ = bound(function, columns[0].shape[1])
    for array, values in zip(given, columns, strict=True):
        array[...] = values.T
    call()
    return np.ascontiguousarray(found[0].T)


def sides_of(function: ca.Function, steps: Steps, middle: Array) -> tuple[Side, Side]:
    """Values of a function of places, fixed symbols and paths at ever smaller distances before and
    after a share of each step.
    """
    far = (_WIDEST * 0.5 ** np.arange(_LIMITS))[:, None]
    wide, shape = (
        Steps.joined([steps] * _LIMITS),
        (function.size1_out(0), _LIMITS, steps.owner.size),
    )
    sides = []
    for direction in (-1, 1):
        share = middle + direction * far
        given, there = (
            (wide.at(share.ravel()), wide.p, wide.change),
            (share >= steps.least) & (share <= steps.most),
        )
        value, off = (
            of(function, *given[: function.n_in()]).reshape(shape)
            for of in (called, running_errors)
        )
        sides.append(Side(value, off, there & (far > steps.off(64.0, 0.0))))
    return sides[0], sides[1]
