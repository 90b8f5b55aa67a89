"""Bodies that no joint of a known motion places, as bars and what hangs on points without a
direction: taken where reported.

Their rates and accelerations follow from what their joints and the users' equations leave them, by
least squares. The spin of a bar about its own axis is idle, and none is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...base.arrays import Array
from ...model.stated import Equation, LoadLaw
from .instant_vectors import dot
from .placing import Moving, Placed

_LEAST = 1e-12
"""Fraction of the largest value below which a value decides nothing."""


def place_all(placed: Placed) -> Placed:
    """All bodies; of those alone that are placed, where joints do not decide the others."""
    for names in _together(placed):
        placed = replace(placed, bodies={**placed.bodies, **_Unplaced(placed, names).motions()})
    return placed


def stacked(placed: Placed, equation: Equation | LoadLaw) -> Array:
    """Places, rates and accelerations of what an equation or a law measures, (3, entries, t)."""
    found = np.empty((3, len(equation.entries), placed.reported.t.size))
    for k, entry in enumerate(equation.entries):
        found[:, k] = placed.measured(entry)
    return found


def _together(placed: Placed) -> list[list[str]]:
    """The bodies that are not placed, those that are joined to each other together."""
    declared = placed.declared
    groups = [[name] for name in declared.bodies if name not in placed.bodies]
    joined = [{joint.parent.body, joint.child.body} for joint in declared.joints.values()]
    joined += [_parts(equation) for equation in placed.stated.equations]
    for ends in joined:
        groups_here = [group for group in groups if ends & {*group}]
        if len(groups_here) > 1:
            groups = [group for group in groups if group not in groups_here] + [
                [name for group in groups_here for name in group]
            ]
    return groups


def _parts(equation: Equation) -> set[str]:
    """The bodies that an equation measures."""
    return {entry.part for entry in equation.entries if entry.kind != "coordinate"}


@dataclass(frozen=True, eq=False)
class _Unplaced:
    """Bodies of given ``names`` whose rates and accelerations are solved for, all together.

    What joints and equations leave of velocities is affine in those of the bodies, so its slopes
    are differences; what they leave of accelerations has the same slopes.
    """

    placed: Placed
    names: list[str]

    @cached_property
    def lengths(self) -> Array:
        """Lengths [m] by which components of the bodies' velocities and angular velocities are
        speeds, (bodies, 6): 1 and the mechanism's size; 0 of those that are not unknown.
        """
        declared, reported = self.placed.declared, self.placed.reported
        turned = [declared.size * declared.oriented(name) for name in self.names]
        many = len(reported.lines), len(reported.turns)
        return np.repeat([[1.0, length] for length in turned], many, axis=1)

    def motions(self) -> dict[str, Moving]:
        """The motions of the bodies; none where their joints do not decide them.

        Steps are no less than what no speed exceeds, nor than gaps: they may be too large, but
        smaller ones would be lost in the rounding of gaps. What is decided is seen by shares:
        unknowns in steps, and each gap by its own slopes.
        """
        size, fastest = self.placed.declared.size, float(np.max(self.placed.rates[1]))
        lengths = self.lengths[self.lengths > 0.0]
        nothing = np.zeros((lengths.size, self.placed.reported.t.size))
        rest = self._residuals(nothing, nothing)[0]
        gap = float(np.max(np.abs(rest), initial=0.0)) * max(1.0, size)
        steps = (max(fastest, gap) or 1.0) / lengths
        if len(rest) < steps.size:
            return {}
        ones = (nothing + one[:, None] for one in np.diag(steps))
        slopes = np.stack([self._residuals(one, nothing)[0] - rest for one in ones], axis=1)
        sizes = np.linalg.norm(slopes, axis=1, keepdims=True)
        sizes[sizes == 0.0] = 1.0
        q, r = np.linalg.qr(np.moveaxis(slopes / sizes, -1, 0))
        shares = np.abs(np.diagonal(r, axis1=1, axis2=2))
        if not (shares.min(axis=1) > _LEAST * shares.max(axis=1)).all():
            return {}

        def zero(residuals: Array) -> Array:
            right = np.swapaxes(q, 1, 2) @ (-residuals / sizes[:, 0]).T[..., None]
            return np.asarray(np.linalg.solve(r, right)[..., 0].T * steps[:, None])

        rates = zero(rest)
        return self._trial(rates, zero(self._residuals(rates, nothing)[1]))

    def _trial(self, rates: Array, accelerations: Array) -> dict[str, Moving]:
        """The bodies with velocities and accelerations, each (unknowns, t)."""
        found = np.zeros((2, *self.lengths.shape, rates.shape[1]))
        found[:, self.lengths > 0.0] = rates, accelerations
        trial, reported = {}, self.placed.reported
        for name, moving in zip(self.names, found.swapaxes(0, 1), strict=True):
            moves, spin = np.split(moving, [len(reported.lines)], axis=1)
            origin = np.array([reported.place(name), *moves])
            trial[name] = Moving.of(origin, reported.axes(name), spin)
        return trial

    def _residuals(self, rates: Array, accelerations: Array) -> Array:
        """Residuals of joints and equations in velocities, and in accelerations, (2, gaps, t)."""
        trial, t = self._trial(rates, accelerations), self.placed.reported.t
        placed = replace(self.placed, bodies={**self.placed.bodies, **trial})
        found = [np.zeros((2, 0, t.size))]
        for name in placed.closing:
            ends = {end.body for end in placed.declared.joints[name].ends}
            if ends & {*trial} and ends <= {*placed.bodies}:
                points, _, spins = placed.missed(name)
                found += [points[1:], spins]
        for name in self.names:
            if name in placed.declared.bars:
                along = trial[name].axes[0]
                found.append(np.array([[dot(along, one)] for one in trial[name].spin]))
        for equation in placed.stated.equations:
            parts = _parts(equation)
            if not equation.row and parts & {*trial} and parts <= {*placed.bodies}:
                found.append(equation.at(stacked(placed, equation), t)[1:, None])
        return np.concatenate(found, axis=1)
