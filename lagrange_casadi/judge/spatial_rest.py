"""Bodies of a spatial solution that are taken where they are reported: bars, and what hangs on points without a direction.

Their rates and accelerations follow from what their joints and the users' equations leave them, by least squares. The spin of a bar
about its own axis is idle, and none is taken.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..base.arrays import Array
from ..declare.description import Description, oriented
from ..instants.solution import Solution
from .affine import rates_and_changes
from .spatial_placing import Moving, Reported, cross, measured, place, relative, spot, told, turn
from .written import Written

_LEAST = 1e-12
"""Of the largest: what is smaller decides nothing."""


def place_all(reported: Reported, written: Sequence[Written] = ()) -> dict[str, Moving]:
    """The motion of every body, the ground's included; of those alone that are placed, where joints do not decide the others."""
    bodies = place(reported)
    for names in _together(reported.solution, bodies, written):
        bodies |= _Rest(reported, bodies, names, written).motions()
    return bodies


def axes_of(solution: Solution, name: str) -> Array:
    """The reported axes of a body, as columns."""
    axes = solution.pose(name).axes
    return Moving.at_rest(solution.t.size).axes if axes is None else np.swapaxes(axes, 1, 2)


def _together(solution: Solution, bodies: Mapping[str, Moving], written: Sequence[Written]) -> list[list[str]]:
    """The bodies that are not placed, those that are joined to each other together."""
    groups = [[name] for name in solution.description["bodies"] if name not in bodies]
    joined = [{joint["parent"]["body"], joint["child"]["body"]} for joint in solution.description["joints"].values()]
    joined += [{entry.part for entry in equation.entries if entry.kind != "coordinate"} for equation in written]
    for ends in joined:
        own = [group for group in groups if ends & {*group}]
        if len(own) > 1:
            groups = [group for group in groups if group not in own] + [[name for group in own for name in group]]
    return groups


@dataclass(frozen=True, eq=False)
class _Rest:
    """Bodies that are taken where they are reported, and whose rates and accelerations are solved for, all together.

    What joints and equations leave of velocities is affine in those of the bodies, so its slopes are differences.
    """

    reported: Reported
    bodies: dict[str, Moving]
    names: list[str]
    written: Sequence[Written]

    @property
    def solution(self) -> Solution:
        """What is reported."""
        return self.reported.solution

    def motions(self) -> dict[str, Moving]:
        """The motions of the bodies; none where their joints do not decide them."""
        found = rates_and_changes(self._left, sum(self._sizes), self.solution.t.size, _decided)
        return {} if found is None else self._trial(*found)

    def _left(self, rates: Array | None, x: Array) -> Array:
        """What is left of velocities ``x``; or of accelerations ``x``, where the rates are known."""
        return self._gaps(self._trial(x, None), 1) if rates is None else self._gaps(self._trial(rates, x), 2)

    @property
    def _sizes(self) -> list[int]:
        return [6 if oriented(self.solution.description, name) else 3 for name in self.names]

    def _trial(self, rates: Array, accelerations: Array | None) -> dict[str, Moving]:
        """The bodies with velocities, and accelerations, each (unknowns, t)."""
        found: dict[str, Moving] = {}
        start = 0
        still = np.zeros_like(rates) if accelerations is None else accelerations
        nil = np.zeros((self.solution.t.size, 3))
        for name, size in zip(self.names, self._sizes, strict=True):
            pose = self.solution.pose(name)
            own, more = (rows[start : start + size].T for rows in (rates, still))
            turning = (own[:, 3:], more[:, 3:]) if size > 3 else (nil, nil)
            at = np.stack([pose.x, pose.y, pose.z], axis=1)  # type: ignore[list-item]
            found[name] = Moving(at, own[:, :3], more[:, :3], axes_of(self.solution, name), *turning)
            start += size
        return found

    def _gaps(self, trial: dict[str, Moving], order: Literal[1, 2]) -> Array:
        """What joints and equations leave of velocities (1), or of accelerations (2)."""
        bodies = self.bodies | trial
        found: list[Any] = []
        for joint in self.solution.description["joints"].values():
            near, far = joint["parent"]["body"], joint["child"]["body"]
            if (near in trial or far in trial) and near in bodies and far in bodies:
                for gap in gaps_of(self.reported, joint, bodies)[2 * order - 2 : 2 * order]:
                    found += [*gap.T]
        for name in self.names:
            if name in self.solution.description["bars"]:
                bar = trial[name]
                found.append(np.sum(bar.axes[:, :, 0] * (bar.rate if order == 1 else bar.acceleration), axis=1))
        for equation in self.written:
            parts = {entry.part for entry in equation.entries if entry.kind != "coordinate"}
            if not equation.row and parts & {*trial} and parts <= {*bodies}:
                motion = [measured(self.solution, bodies, entry) for entry in equation.entries]
                found.append(equation.at(motion, self.solution.t)[order])
        return np.array(found).reshape(len(found), self.solution.t.size)


def _decided(triangle: Array) -> Array:
    """Whether a triangle (t, n, n) is one of full rank, (t,)."""
    sizes = np.abs(np.diagonal(triangle, axis1=1, axis2=2))
    return np.asarray(sizes.min(axis=1) > _LEAST * sizes.max(axis=1))


def gaps_of(reported: Reported, joint: Description, bodies: Mapping[str, Moving]) -> tuple[Array, Array, Array, Array]:
    """What a joint leaves of velocities and angular velocities, and of both their changes: what moves otherwise than is reported.

    Each is (t, 3), in ground axes; those of turning are nil where it is not told how the joint turns.
    """
    near, far, motion = bodies[joint["parent"]["body"]], bodies[joint["child"]["body"]], relative(reported, joint)
    own = far.point(spot(joint["child"]))
    under = near.point(near.under(own[0]))
    speed = own[1] - under[1]
    change = own[2] - under[2] - 2.0 * cross(near.rate, speed) - turn(near.axes, motion.slide[2])
    spin, gains = far.rate - near.rate, far.acceleration - near.acceleration
    if told(reported.description, joint):
        about = spin - turn(near.axes, motion.rate), gains - cross(near.rate, spin) - turn(near.axes, motion.acceleration)
    else:
        about = np.zeros_like(spin), np.zeros_like(spin)
    return speed - turn(near.axes, motion.slide[1]), about[0], change, about[1]
