"""Bodies that no joint of a known motion places, as bars and what hangs on points without a
direction: taken where reported.

Their rates and accelerations follow from what their joints and the users' equations leave them, by
least squares. The spin of a bar about its own axis is idle, and none is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ...base.arrays import Array
from ...model.stated import Equation, LoadLaw
from .instant_vectors import NIL, Scalar, Vector
from .placing import Motion, Moving, Placed
from .reported import Reported

_LEAST = 1e-12
"""Fraction of the largest value below which a value decides nothing."""


def place_all(placed: Placed) -> Placed:
    """All bodies; of those alone that are placed, where joints do not decide the others."""
    for names in _together(placed):
        placed = replace(placed, bodies={**placed.bodies, **_Unplaced(placed, names).motions()})
    return placed


def joint_residuals(
    placed: Placed, joint: str, pin: Motion
) -> tuple[Vector, Vector, Vector, Vector]:
    """Residuals of a joint in velocities and angular velocities, and in both their changes, against
    the reported motion.

    All are in ground axes; those of turning are nil where it is not known how the joint turns.
    ``pin`` is how its point moves.
    """
    (near, far), motion = placed.ends(joint), placed.relatives[joint]
    place, moves, changes = pin
    speed = moves - near.speed_at(place)
    change = (
        changes
        - near.change_at(place)
        - 2.0 * near.rate.cross(speed)
        - near.axes.turn(motion.slide[2])
    )
    about = NIL, NIL
    if motion.whole:
        spin, gains = far.rate - near.rate, far.acceleration - near.acceleration
        turning = gains - near.rate.cross(spin) - near.axes.turn(motion.acceleration)
        about = spin - near.axes.turn(motion.rate), turning
    return speed - near.axes.turn(motion.slide[1]), about[0], change, about[1]


def stacked(placed: Placed, equation: Equation | LoadLaw) -> tuple[Array, Array, Array]:
    """Places, rates and accelerations of what an equation or a law measures, each (entries, t)."""
    found = np.empty((3, len(equation.entries), placed.reported.t.size))
    for k, entry in enumerate(equation.entries):
        for row, values in zip(found[:, k], placed.measured(entry), strict=True):
            row[:] = values
    return found[0], found[1], found[2]


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
    are differences.
    """

    placed: Placed
    names: list[str]

    @property
    def reported(self) -> Reported:
        """The results."""
        return self.placed.reported

    def motions(self) -> dict[str, Moving]:
        """The motions of the bodies; none where their joints do not decide them."""
        _, fastest, changes = self.placed.rates
        rates = self._zero(lambda x: self._residuals(self._trial(x, None), 1), fastest)
        if rates is None:
            return {}
        found = self._zero(lambda x: self._residuals(self._trial(rates, x), 2), changes)
        return {} if found is None else self._trial(rates, found)

    @property
    def _lengths(self) -> Array:
        """The mechanism's size [m] for an unknown that turns, one for any other, (unknowns,)."""
        size = self.placed.declared.size
        return np.array([1.0 if k < 3 else size for name in self.names for k in self._free(name)])

    def _free(self, name: str) -> Sequence[int]:
        """The components of a body's velocity and angular velocity, by number, that are unknown."""
        rotations = self.placed.declared.oriented(name)
        if self.reported.space:
            return range(6 if rotations else 3)
        return (0, 1, 5) if rotations else (0, 1)

    def _trial(self, rates: Array, accelerations: Array | None) -> dict[str, Moving]:
        """The bodies with velocities, and accelerations, each (unknowns, t)."""
        found: dict[str, Moving] = {}
        given = [iter(() if rows is None else rows) for rows in (rates, accelerations)]
        for name in self.names:
            vectors: list[Vector] = []
            for rows in given:
                components: list[Scalar] = [0.0] * 6
                for k, row in zip(self._free(name), rows, strict=False):
                    components[k] = row
                vectors += [Vector(*components[:3]), Vector(*components[3:])]
            speed, rate, change, acceleration = vectors
            place, axes = self.reported.place(name), self.reported.axes(name)
            found[name] = Moving(place, speed, change, axes, rate, acceleration)
        return found

    def _residuals(self, trial: Mapping[str, Moving], order: Literal[1, 2]) -> Array:
        """Residuals of joints and equations in velocities (1), or in accelerations (2), (gaps,
        t).
        """
        placed = replace(self.placed, bodies={**self.placed.bodies, **trial})
        found: list[Scalar] = []
        for name, joint in placed.declared.joints.items():
            near, far = joint.parent.body, joint.child.body
            if (near in trial or far in trial) and near in placed.bodies and far in placed.bodies:
                for residual in joint_residuals(placed, name, placed.pin(name))[
                    2 * order - 2 : 2 * order
                ]:
                    found += residual.components
        for name in self.names:
            if name in self.reported.two_force_links:
                two_force_link = trial[name]
                found.append(
                    two_force_link.axes.x.dot(
                        two_force_link.rate if order == 1 else two_force_link.acceleration
                    )
                )
        for equation in placed.stated.equations:
            parts = _parts(equation)
            if not equation.row and parts & {*trial} and parts <= {*placed.bodies}:
                found.append(equation.at(*stacked(placed, equation), self.reported.t)[order])
        rows = [row for row in found if not (type(row) is float and row == 0.0)]
        return np.array([np.broadcast_to(row, self.reported.t.shape) for row in rows]).reshape(
            len(rows), self.reported.t.size
        )

    def _zero(self, residuals: Callable[[Array], Array], largest: Scalar) -> Array | None:
        """The unknowns (count, t) at which gaps that are affine in them are zero; None where they
        are not decided.

        Steps are no less than ``largest``, what no speed or acceleration exceeds, nor than gaps:
        they may be too large, but smaller ones would be lost in the rounding of gaps. What is
        decided is seen by shares: unknowns in steps, and each gap by its own slopes.
        """
        t, lengths = self.reported.t, self._lengths
        count = lengths.size
        rest = residuals(np.zeros((count, t.size)))
        gap = float(np.max(np.abs(rest), initial=0.0)) * max(1.0, self.placed.declared.size)
        steps = ((max(float(np.max(largest)), gap) or 1.0) / lengths)[:, None]
        if len(rest) < count:
            return None
        ones = (np.broadcast_to(row[:, None], (count, t.size)) * steps for row in np.eye(count))
        slopes = np.stack([residuals(one) - rest for one in ones], axis=1)
        sizes = np.linalg.norm(slopes, axis=1, keepdims=True)
        sizes[sizes == 0.0] = 1.0
        q, r = np.linalg.qr(np.moveaxis(slopes / sizes, -1, 0))
        shares = np.abs(np.diagonal(r, axis1=1, axis2=2))
        if not (shares.min(axis=1) > _LEAST * shares.max(axis=1)).all():
            return None
        right = np.swapaxes(q, 1, 2) @ (-rest / sizes[:, 0]).T[..., None]
        return np.asarray(np.linalg.solve(r, right)[..., 0].T * steps)
