"""Where the bodies of a solution are and how they move, in plain arithmetic, from the motions that it reports.

It shares nothing with the graphs that made the solution. A joint's reported motion places what hangs on it. What no joint of a
known coordinate holds, as a link between point masses, is taken where it is reported, and its rates follow from what its joints and
the users' equations leave it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..declare.description import Description, oriented
from ..instants.solution import Solution
from .affine import rates_and_changes
from .written import Entry, Written

Complex = npt.NDArray[np.complexfloating[Any, Any]]


@dataclass(frozen=True, eq=False)
class Moving:
    """Place of a body's origin, direction, and both their derivatives: arrays of (t,), complex numbers for vectors."""

    at: Complex
    speed: Complex
    change: Complex
    angle: Array
    rate: Array
    acceleration: Array

    @classmethod
    def holding(
        cls, at: tuple[Complex, Complex, Complex], point: Description, angle: Array, rate: Array, acceleration: Array
    ) -> Moving:
        """The motion of a body that turns as said and whose ``point`` has the given place, velocity and acceleration."""
        turning = np.exp(1j * angle) * (point["x"] + 1j * point["y"])
        change = at[2] - (1j * acceleration - rate**2) * turning
        return cls(at[0] - turning, at[1] - 1j * rate * turning, change, angle, rate, acceleration)

    def point(self, x: Any, y: Any) -> tuple[Complex, Complex, Complex]:
        """Place, velocity and acceleration of the body's point (x, y)."""
        arm = (x + 1j * y) * np.exp(1j * self.angle)
        return (
            self.at + arm,
            self.speed + 1j * self.rate * arm,
            self.change + (1j * self.acceleration - self.rate**2) * arm,
        )


def place(solution: Solution, written: Sequence[Written] = ()) -> dict[str, Moving]:
    """The motion of every body that the reported motions place, the ground's included."""
    zero = np.zeros_like(solution.t)
    bodies = {"ground": Moving(zero + 0j, zero + 0j, zero + 0j, zero, zero, zero)}
    waiting = dict(solution.description["joints"])
    moved = True
    while waiting and moved:
        moved = False
        for name, joint in list(waiting.items()):
            near, far = joint["parent"], joint["child"]
            reverse = near["body"] not in bodies
            if reverse:
                near, far = far, near
            if near["body"] not in bodies or far["body"] in bodies:
                continue
            motion = _hang(solution, name, joint, bodies[near["body"]], near, far, reverse)
            if motion is not None:
                bodies[far["body"]] = motion
                del waiting[name]
                moved = True
        if not moved:
            moved = _span(solution, bodies)
    rest = [name for name in solution.description["bodies"] if name not in bodies]
    return bodies | (_Rest(solution, bodies, rest, written).motions() if rest else {})


def axis_of(joint: Description, parent: Moving) -> Complex:
    """The axis that a joint's parent carries, in ground axes."""
    return np.asarray((joint["axis"][0] + 1j * joint["axis"][1]) * np.exp(1j * parent.angle))


def _span(solution: Solution, bodies: dict[str, Moving]) -> bool:
    """Place a link that is pinned at two points to bodies already placed, from where these move; whether there was one."""
    pins: dict[str, list[tuple[Description, Description]]] = {}
    for joint in solution.description["joints"].values():
        for own, other in ((joint["parent"], joint["child"]), (joint["child"], joint["parent"])):
            if joint["kind"] == "revolute" and own["body"] not in bodies and other["body"] in bodies:
                pins.setdefault(own["body"], []).append((own, other))
    for name, found in pins.items():
        first = found[0]
        second = next((pin for pin in found if (pin[0]["x"], pin[0]["y"]) != (first[0]["x"], first[0]["y"])), None)
        if second is None or not oriented(solution.description, name):
            continue
        (a, va, ca), (b, vb, cb) = (bodies[other["body"]].point(other["x"], other["y"]) for _, other in (first, second))
        reach = np.abs(b - a) ** 2
        rate, acceleration = (np.conj(b - a) * (vb - va)).imag / reach, (np.conj(b - a) * (cb - ca)).imag / reach
        local = (second[0]["x"] - first[0]["x"]) + 1j * (second[0]["y"] - first[0]["y"])
        angle = np.angle((b - a) / local)
        bodies[name] = Moving.holding((a, va, ca), first[0], angle, rate, acceleration)
        return True
    return False


def _hang(
    solution: Solution, name: str, joint: Description, base: Moving, near: Description, far: Description, reverse: bool
) -> Moving | None:
    """The motion of the body at a joint's far side, or None where the joint does not give it."""
    turns = oriented(solution.description, far["body"])
    kind, sign = joint["kind"], -1.0 if reverse else 1.0
    zero = np.zeros_like(solution.t)
    slides = kind in ("prismatic", "slot")
    if slides and turns and kind == "slot":
        return None
    if slides and reverse and not oriented(solution.description, joint["child"]["body"]):
        return None
    motion = solution.motion(name) if joint["coordinate"] else None
    if turns and kind == "revolute":
        if motion is None:
            return None
        angle = base.angle + sign * motion.value
        rate, acceleration = base.rate + sign * motion.rate, base.acceleration + sign * motion.acceleration
    elif turns:
        angle, rate, acceleration = base.angle + sign * joint["angle"], base.rate, base.acceleration
    else:
        angle, rate, acceleration = zero, zero, zero
    at, speed, change = base.point(near["x"], near["y"])
    if slides:
        assert motion is not None
        axis = (joint["axis"][0] + 1j * joint["axis"][1]) * np.exp(1j * (angle if reverse else base.angle))
        turn, spin = (rate, acceleration) if reverse else (base.rate, base.acceleration)
        at = at + sign * axis * motion.value
        speed = speed + sign * axis * (motion.rate + 1j * turn * motion.value)
        along = motion.acceleration - turn**2 * motion.value + 1j * (spin * motion.value + 2 * turn * motion.rate)
        change = change + sign * axis * along
    return Moving.holding((at, speed, change), far, angle, rate, acceleration)


@dataclass(frozen=True, eq=False)
class _Rest:
    """Bodies that are taken where they are reported, and whose rates and accelerations are solved for, all together.

    What joints and equations leave of velocities is affine in those of the bodies, so its slopes are differences.
    """

    solution: Solution
    bodies: dict[str, Moving]
    names: list[str]
    written: Sequence[Written]

    def motions(self) -> dict[str, Moving]:
        """The motions of the bodies; none where their joints do not decide them."""
        found = rates_and_changes(self._left, sum(self._sizes), self.solution.t.size, lambda r: np.abs(np.linalg.det(r)) > 0.0)
        return {} if found is None else self._trial(*found)

    def _left(self, rates: Array | None, x: Array) -> Array:
        """What is left of velocities ``x``; or of accelerations ``x``, where the rates are known."""
        return self._gaps(self._trial(x, None), 1) if rates is None else self._gaps(self._trial(rates, x), 2)

    @property
    def _sizes(self) -> list[int]:
        return [3 if oriented(self.solution.description, name) else 2 for name in self.names]

    def _trial(self, rates: Array, accelerations: Array | None) -> dict[str, Moving]:
        """The bodies with velocities, and accelerations, each (unknowns, t)."""
        found: dict[str, Moving] = {}
        start = 0
        still = np.zeros_like(rates) if accelerations is None else accelerations
        for name, size in zip(self.names, self._sizes, strict=True):
            pose, own, more = self.solution.pose(name), rates[start : start + size], still[start : start + size]
            angle = np.zeros_like(pose.x) if pose.angle is None else pose.angle
            turning = (own[2], more[2]) if size == 3 else (np.zeros_like(pose.x), np.zeros_like(pose.x))
            found[name] = Moving(pose.x + 1j * pose.y, own[0] + 1j * own[1], more[0] + 1j * more[1], angle, *turning)
            start += size
        return found

    def _gaps(self, trial: dict[str, Moving], order: Literal[1, 2]) -> Array:
        """What joints and equations leave of velocities (1), or of accelerations (2)."""
        bodies = self.bodies | trial
        found: list[Any] = []
        for name, joint in self.solution.description["joints"].items():
            near, far = joint["parent"], joint["child"]
            if near["body"] in trial or far["body"] in trial:
                found += self._of_joint(name, joint, bodies[near["body"]], bodies[far["body"]], order)
        for equation in self.written:
            if not equation.row:
                motion = [measured(self.solution, bodies, entry) for entry in equation.entries]
                found.append(equation.at(motion, self.solution.t)[order])
        return np.array(found).reshape(len(found), self.solution.t.size)

    def _of_joint(self, name: str, joint: Description, near: Moving, far: Moving, order: Literal[1, 2]) -> Iterator[Array]:
        own = far.point(joint["child"]["x"], joint["child"]["y"])
        motion = self.solution.motion(name) if joint["coordinate"] else None
        along = None if motion is None else (motion.rate, motion.acceleration)[order - 1]
        if joint["kind"] in ("prismatic", "slot"):
            under = (own[0] - near.at) * np.exp(-1j * near.angle)
            apart = (own[order] - near.point(under.real, under.imag)[order]) * np.conj(axis_of(joint, near))
            # The line turns under what slides on it (Coriolis).
            yield apart.imag - (2.0 * near.rate * motion.rate if order == 2 and motion is not None else 0.0)
            if along is not None:
                yield apart.real - along
        else:
            apart = own[order] - near.point(joint["parent"]["x"], joint["parent"]["y"])[order]
            yield apart.real
            yield apart.imag
        turned = (far.rate - near.rate, far.acceleration - near.acceleration)[order - 1]
        if joint["kind"] == "revolute" and along is not None:
            yield turned - along
        elif joint["kind"] in ("prismatic", "weld") and oriented(self.solution.description, joint["child"]["body"]):
            yield turned


def measured(solution: Solution, bodies: Mapping[str, Moving], entry: Entry) -> tuple[Array, Array, Array]:
    """An entry of an equation, its rate and its acceleration."""
    if entry.kind == "coordinate":
        motion = solution.motion(entry.part)
        return motion.value, motion.rate, motion.acceleration
    body = bodies[entry.part]
    if entry.kind == "direction":
        angle = solution.pose(entry.part).angle
        return body.angle if angle is None else angle, body.rate, body.acceleration
    at, speed, change = body.point(*entry.point)
    found: tuple[Any, Any, Any] = (at.real, speed.real, change.real) if entry.kind == "x" else (at.imag, speed.imag, change.imag)
    return found
