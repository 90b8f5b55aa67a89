"""Loops as nearly closed as they can be: those that can be are closed, and the others have the
least sum of squares of their equations.

Where a loop does not close its links lie on one line, and the slopes of its equations leave that
direction open: steps of Gauss and Newton do not end there. So these are Newton's, on the second
derivatives too, in the directions that closed loops leave (J. Nocedal and S. Wright, *Numerical
Optimization*, 2006, ch. 18).
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from ..base.arrays import Array, Flags
from .multibody import Multibody
from .released_loops import ReleasedLoops, State

_STARTS, _TRIED, _STEPS = 8, 60, 100
"""Postures from which loops are closed, steps for each, and steps of :meth:`Nearest.least`."""

_LARGEST, _RANK, _FLAT = 0.3, 1e-9, 1e-12
"""Largest step of a coordinate, singular values that are none, and a step that is none."""


@dataclass(frozen=True, eq=False)
class Nearest:
    """Loops, by the rows of their equations. Of the coordinates some are ``driven``, the others in
    the equations are ``free``, and some are ``posed``, given by a posture.
    """

    released: ReleasedLoops
    loops: Sequence[slice]
    driven: Flags
    free: Flags
    posed: Flags

    @classmethod
    def of(cls, multibody: Multibody, released: ReleasedLoops, posed: Collection[str]) -> Nearest:
        """The loops of a mechanism; ``posed`` names what is in a posture."""
        ends = np.cumsum([0, *(loop.residual.numel() for loop in multibody.loop_equations)])
        present = released.gaps.sparsity_out(1).get_triplet()[1]
        held = np.isin(np.arange(released.sizes.size), present)
        driven = np.array([c.driven for c in multibody.coordinates], bool)
        given = np.array([c.posture_key in posed for c in multibody.coordinates], bool)
        loops = [slice(*pair) for pair in itertools.pairwise(ends.tolist())]
        return cls(released, loops, driven, held & ~driven, given)

    def closed(self, state: State, rows: Flags | None = None) -> State | None:
        """A state near another in which equations hold, by default all."""
        return self.released.closed(state, self.free, rows, _TRIED)

    def found(self, state: State) -> tuple[State, list[int]]:
        """The state that comes nearest, and the loops that it leaves open."""
        if not self.loops:
            return state, []
        for start in self._starts(state):
            if (found := self.closed(start)) is not None:
                return found, []
        closed, left = self.rows([]), []
        for k in sorted(range(len(self.loops)), key=self._size):
            closed |= self.rows([k])
            if (found := self.closed(state, closed)) is None:
                closed &= ~self.rows([k])
                left.append(k)
            else:
                state = found
        return self.least(state, closed), left

    def rows(self, loops: Sequence[int]) -> Flags:
        """The equations of loops, marked."""
        marked = np.zeros(self.released.residuals.numel(), bool)
        for k in loops:
            marked[self.loops[k]] = True
        return marked

    def _size(self, k: int) -> int:
        """The number of free coordinates of a loop."""
        _, slope = self.released.at(self.released.first)
        return int(np.any(slope[self.loops[k]] != 0.0, axis=0)[self.free].sum())

    def _starts(self, state: State) -> Iterator[State]:
        """A state, and others spread beside it, but for the coordinates of a posture."""
        yield state
        spread = self.free & ~self.posed
        number = np.arange(1, spread.size + 1)
        for k in range(1, _STARTS if spread.any() else 1):
            yield self.released.moved(state, spread * 2.0 * np.sin(2.4 * k * number))

    @cached_property
    def _bend(self) -> ca.Function:
        """The second derivatives by u of the sum of squares of equations, halved and weighed by
        ``squares``, and of a sum of equations weighed by ``linear``.
        """
        residuals, (u, *rest) = self.released.residuals, self.released.given
        squares, linear = (ca.SX.sym(name, residuals.numel()) for name in ("squares", "linear"))
        total = ca.dot(squares, residuals**2) / 2 + ca.dot(linear, residuals)
        return ca.Function("bend", [u, *rest, squares, linear], [ca.hessian(total, u)[0]])

    def least(self, state: State, closed: Flags) -> State:
        """The state near another with the least sum of squares of the other equations, while those
        that are ``closed`` hold.
        """
        size = self.free.sum()
        for number in range(_STEPS):
            residual, slope = self.released.at(state)
            slope = slope[:, self.free]
            gradient = slope[~closed].T @ residual[~closed]
            inverse = np.linalg.pinv(slope[closed], rcond=_RANK)
            linear = np.zeros(residual.size)
            linear[closed] = -inverse.T @ gradient
            bend = self._bend(*state, ~closed, linear).full()
            bend = bend[np.ix_(self.free, self.free)]
            back = -inverse @ residual[closed]
            across = _kernel(slope[closed])
            turns, ways = np.linalg.eigh(across.T @ bend @ across)
            least = max(np.abs(turns).max(initial=0.0) * _RANK, 1e-300)
            down = ways.T @ (across.T @ (gradient + bend @ back))
            small = np.abs(turns) < least
            along = -ways @ np.where(small, 0.0, down / np.where(small, 1.0, np.abs(turns)))
            step = np.zeros(self.free.size)
            step[self.free] = back + across @ along
            if number == 0:
                # Where a sum of squares is largest its slopes are zero too.
                step[self.free] += 1e-3 * np.cos(np.arange(size))
            moves = np.abs(step).max(initial=0.0)
            state = self.released.moved(state, step * min(1.0, _LARGEST / (moves + 1e-300)))
            if moves < _FLAT:
                break
        return state


def _kernel(slope: Array) -> Array:
    """Directions at right angles, columns, in which equations with some slopes do not change."""
    _, values, across = np.linalg.svd(slope)
    return np.asarray(across[np.count_nonzero(values > _RANK * values.max(initial=0.0)) :].T)
