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
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Flags
from ..base.scalars import column
from ..base.vectors import ZERO
from ..model.declared_parts import Point
from .multibody import Multibody
from .released_loops import ReleasedLoops, State
from .sizes import extent
from .substitution import Numbers

_STARTS, _TRIED, _STEPS = 4, 40, 40
"""Postures from which loops are closed, steps for each, and steps of :meth:`Nearest.least`."""

_LARGEST, _RANK, _FLAT = 0.3, 1e-9, 1e-10
"""Largest step of a coordinate, singular values that are none, and a step that is none."""

_TRIALS, _WEAK, _TIGHT, _OPEN = 20, 1e-3, 1e-4, 1e-9
"""Values of a parameter that are tried, slopes of a gap that are too small for one, the part of a
change with less of which a loop must be open, and what is open of an equation that is to hold.
"""


@dataclass(frozen=True, eq=False)
class Nearest:
    """The loops of a mechanism near a state.

    Of the coordinates some are ``driven``, the others in the equations are ``free``, and some are
    ``posed``, given by a posture. ``numbers`` are those of the mechanism's symbols, and follow
    :meth:`note`.
    """

    multibody: Multibody
    numbers: Numbers
    released: ReleasedLoops
    driven: Flags
    free: Flags
    posed: Flags

    @classmethod
    def of(cls, multibody: Multibody, numbers: Numbers, posed: Collection[str]) -> Nearest:
        """The loops of a mechanism near the numbers of its coordinates; ``posed`` names what is in
        a posture.
        """
        released, coordinates = ReleasedLoops.of(multibody, numbers), multibody.coordinates
        present = released.gaps.sparsity_out(1).get_triplet()[1]
        driven = np.array([c.driven for c in coordinates], bool)
        return cls(
            multibody,
            numbers,
            released,
            driven,
            np.isin(np.arange(len(coordinates)), present) & ~driven,
            np.array([c.posture_key in posed for c in coordinates], bool),
        )

    @property
    def drives(self) -> tuple[str, ...]:
        """The driven coordinates."""
        return tuple(c.name for c in self.multibody.coordinates if c.driven)

    @property
    def size(self) -> float:
        """The mechanism's size [m]."""
        return self.numbers.of(extent(self.multibody.mechanism))[0]

    def note(self, state: State) -> None:
        """Take the coordinates of a state for the numbers of the mechanism's symbols."""
        values = self.released.placed(*state).full().ravel()
        self.numbers.note(self.released.variables, values.tolist())

    @cached_property
    def placed(self) -> ca.SX:
        """The place of each body's origin, and its axes, in ground axes, over coordinates (12 a
        body); the x axis of a two-force link is stretched between its ends.
        """
        rows = [
            row
            for frame in self.multibody.frames.values()
            for turn in (frame.rotation,)
            for row in (frame.place_of(ZERO), turn.x, turn.y, turn.z)
        ]
        return column(itertools.chain(*rows))

    def poses(self) -> dict[str, Array]:
        """The place of the origin of each body, and its axes, rows (4, 3), in ground axes."""
        found = np.array(self.numbers.of(self.placed)).reshape(-1, 4, 3)
        # A two-force link that does not fit between its ends is not stretched.
        found[:, 1] /= np.linalg.norm(found[:, 1], axis=1, keepdims=True)
        return dict(zip(self.multibody.frames, found, strict=True))

    def place(self, point: Point) -> Array:
        """A point of a body, in ground axes [m]."""
        frame = self.multibody.frames[point.body.name]
        return np.array(self.numbers.of(column(frame.place_of(point.place))))

    def held(self, state: State, closed: Flags) -> set[str]:
        """The bodies that do not move where equations are kept that are ``closed``."""
        across = _kernel(self.released.at(state)[1][np.ix_(closed, self.free)])
        moving = np.flatnonzero(self.free)[np.abs(across).max(axis=1, initial=0.0) > _RANK]
        symbols = column(self.multibody.coordinates[k].variables for k in moving)
        return {
            body
            for body, frame in self.multibody.frames.items()
            if not ca.depends_on(
                column([*frame.place_of(ZERO), *frame.rotation.x, *frame.rotation.y]), symbols
            )
        }

    def closed(self, state: State, rows: Flags | None = None) -> State | None:
        """A state near another in which equations hold, by default all."""
        return self.released.closed(state, self.free, rows, _TRIED)

    def found(self, state: State) -> tuple[State, list[int]]:
        """The state that comes nearest, and the loops that it leaves open."""
        if not self.released.loops:
            return state, []
        for start in self._starts(state):
            if (found := self.closed(start)) is not None:
                return found, []
        closed, left = self.rows([]), []
        for k in range(len(self.released.loops)):
            closed |= self.rows([k])
            if (found := self.closed(state, closed)) is None:
                closed &= ~self.rows([k])
                left.append(k)
            else:
                state = found
        # Where a sum of squares is largest its slopes are zero too.
        beside = np.where(self.free, 1e-3 * np.cos(np.arange(self.free.size)), 0.0)
        state = self.least(self.released.moved(state, beside), closed, ~closed)
        apart = np.abs(self.released.at(state)[0]) > _OPEN
        return state, [k for k in left if apart[self.released.loops[k]].any()]

    def rows(self, loops: Sequence[int]) -> Flags:
        """The equations of loops, marked."""
        marked = np.zeros(self.released.residuals.numel(), bool)
        for k in loops:
            marked[self.released.loops[k]] = True
        return marked

    @cached_property
    def _by_parameters(self) -> ca.Function:
        """The derivatives of the equations by the parameters."""
        slope = ca.jacobian(self.released.residuals, self.released.given[-1])
        return ca.Function("by_parameters", self.released.given, [slope])

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

    def least(self, state: State, closed: Flags, left: Flags) -> State:
        """The state near another with the least sum of squares of equations that are ``left``,
        while those that are ``closed`` hold.
        """
        for _ in range(_STEPS):
            residual, slope = self.released.at(state)
            if not np.isfinite(slope).all():
                break
            slope = slope[:, self.free]
            gradient, linear = self._gradient(residual, slope, closed, left)
            bend = np.nan_to_num(self._bend(*state, left, linear).full())
            bend = bend[np.ix_(self.free, self.free)]
            back = -np.linalg.pinv(slope[closed], rcond=_RANK) @ residual[closed]
            across = _kernel(slope[closed])
            turns, ways = np.linalg.eigh(across.T @ bend @ across)
            down = ways.T @ (across.T @ (gradient + bend @ back))
            flat = np.abs(turns) <= np.abs(turns).max(initial=0.0) * _RANK
            along = -ways @ np.where(flat, 0.0, down / np.where(flat, 1.0, np.abs(turns)))
            step = np.zeros(self.free.size)
            step[self.free] = back + across @ along
            moves = np.abs(step).max(initial=0.0)
            state = self.released.moved(state, step * min(1.0, _LARGEST / (moves + 1e-300)))
            if moves < _FLAT:
                break
        return state

    def _gradient(
        self, residual: Array, slope: Array, closed: Flags, left: Flags
    ) -> tuple[Array, Array]:
        """The derivatives of half the sum of squares of equations that are ``left``, and the
        multipliers of those that are ``closed``, zero for the others.
        """
        gradient = slope[left].T @ residual[left]
        multipliers = np.zeros(residual.size)
        multipliers[closed] = -np.linalg.pinv(slope[closed], rcond=_RANK).T @ gradient
        return gradient, multipliers

    def closing(self, state: State, closed: Flags, left: Flags, k: int) -> float | None:
        """The value of a parameter, by its number, nearest to its own, with which equations hold
        that are ``left``, and those that are ``closed`` too; None where none is found.

        By Newton's method on the root of the least sum of squares, whose slope is that at fixed
        coordinates; between a value that does not close and one that does.
        """
        p, size = [*state[3]], self.size
        own = p[k]
        shut: float | None = None

        def given(value: float, *at: Any) -> State:
            """A state with another value of the parameter."""
            return *at, [*p[:k], value, *p[k + 1 :]]

        for _ in range(_TRIALS):
            residual, slope = self.released.at(state)
            _, multipliers = self._gradient(residual, slope[:, self.free], closed, left)
            wide = float(np.linalg.norm(residual[left]))
            if wide == 0.0:
                return float(state[3][k])
            by_value = self._by_parameters(*state).full()[:, k]
            rate = float((residual * left / wide + multipliers / wide) @ by_value)
            if abs(rate) * size < _WEAK:
                return shut
            value = float(state[3][k])
            ahead = value - wide / rate
            if shut is not None and not min(value, shut) < ahead < max(value, shut):
                ahead = (value + shut) / 2.0
            if abs(ahead - own) > size:
                return None
            if self.closed(given(ahead, *state[:3]), closed | left) is None:
                state = self.least(given(ahead, *state[:3]), closed, left)
                if np.abs(self.released.at(state)[0][closed]).max(initial=0.0) > _OPEN:
                    return shut
                continue
            shut, before = ahead, ahead + _TIGHT * (value - ahead)
            if self.closed(given(before, *state[:3]), closed | left) is None:
                return shut
            shut = before
        return shut


def _kernel(slope: Array) -> Array:
    """Directions at right angles, columns, in which equations with some slopes do not change."""
    _, values, across = np.linalg.svd(slope)
    return np.asarray(across[np.count_nonzero(values > _RANK * values.max(initial=0.0)) :].T)
