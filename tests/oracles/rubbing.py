"""Friction beside the oracle: its law by fixed-point iteration, to convergence, around vector
Newton-Euler on free bodies.

It shares nothing with the package: rates come from the oracle's power series. Reactions are linear
in the frictions' forces, so a balance of all bodies for each of these alone tells them all; the one
with what was found in the end must agree.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from arithmetic import TOLERANCE
from oracle import Joint, Oracle, Result
from random_formula import Measure, axis_of, joint_coordinate

PASSES, ROUNDS = 20000, 30


@dataclass
class Rub:
    """Friction in a joint of the oracle's, by the numbers that declare it."""

    joint: Joint
    mu: float = 0.0
    coulomb: float | None = None
    radius: float | None = None
    length: float | None = None
    viscous: float = 0.0
    static: float | None = None
    stribeck: float = 1.0
    smooth: float | None = None
    force: Any = field(default=0.0, init=False)

    def acts(self, place: Callable) -> list:
        """What it does to the joint's child, and back to its parent, where the child's point is."""
        return Measure("coordinate", self.joint).does(place, self.force)

    def rate(self, place: Callable) -> float:
        """The rate of the joint's coordinate: of the angle, or of the distance along the carried
        line.
        """
        return joint_coordinate(self.joint, place).d

    def law(self, reaction, place: Callable) -> float:
        """What the law says of a reaction."""
        v, (fx, fy, mz) = self.rate(place), reaction
        sign = math.tanh(v / self.smooth) if self.smooth else 1 if v > 0 else -1
        if self.coulomb is not None:
            return -sign * self.coulomb - self.viscous * v
        if not self.joint.slides:
            pressed, speed = self.radius * math.sqrt(fx * fx + fy * fy), v * self.radius
        else:
            x, y = (along.v for along in axis_of(self.joint, place))
            normal, speed = -y * fx + x * fy, v
            pressed = abs(normal)
            if self.length is not None:
                pressed = abs(normal / 2 + mz / self.length) + abs(normal / 2 - mz / self.length)
        mu = self.mu
        if self.static is not None:
            mu += (self.static - mu) * math.exp(-((speed / self.stribeck) ** 2))
        return -sign * mu * pressed - self.viscous * v


def converge(balanced: Callable, laws: Sequence[Callable]) -> tuple[Any, Any]:
    """What ``balanced`` returns for the forces that laws tell of its reactions, and these forces.

    ``balanced(forces)`` is an instant, and the reactions of joints. Fails where the iteration does
    not converge.
    """
    n = len(laws)
    alone = balanced(np.zeros(n))[1]
    size = 1 + np.max(np.abs(alone))
    slopes = np.stack([(balanced(unit)[1] - alone) / size for unit in size * np.eye(n)], axis=-1)
    forces, left = np.zeros(n), None
    for _ in range(ROUNDS):
        for _ in range(PASSES):
            before, reactions = forces, alone + slopes @ forces
            forces = np.array([law(r) for law, r in zip(laws, reactions, strict=True)])
            if np.max(np.abs(forces - before)) <= TOLERANCE / 10 * size:
                break
        result, reactions = balanced(forces)
        left = max(abs(law(r) - x) for law, r, x in zip(laws, reactions, forces, strict=True))
        if left <= 1000 * TOLERANCE * size:
            return result, forces
        # What presses gears apart has kinks, beside which reactions are linear.
        alone = reactions - slopes @ forces
    raise AssertionError(f"the friction of the oracle does not converge: {left}")


def solve_rubbing(oracle: Oracle, rubs: Sequence[Rub], drives, guess) -> Result:
    """The instant with friction."""
    rubbed = replace(oracle, loads=(*oracle.loads, *(rub.acts for rub in rubs)))
    place = oracle.places(oracle.move(drives, guess))

    def balanced(forces):
        for rub, force in zip(rubs, forces, strict=True):
            rub.force = force
        result = rubbed.solve(drives, guess)
        return result, np.array([result.reactions[rub.joint.name] for rub in rubs])

    laws = [lambda reaction, rub=rub: rub.law(reaction, place) for rub in rubs]
    return converge(balanced, laws)[0]


def solve(oracle: Oracle, m, values, drives, guess) -> Result:
    """The oracle of a mechanism of the package's, with the frictions that are declared in that, if
    any.
    """
    joints = {joint.name: joint for joint in oracle.joints}
    rubs: dict[str, Rub] = {}
    for load in m.loads.values():
        if type(load).__name__ == "Friction":
            numbers = {word: m.number(number, values) for word, number in load.numbers.items()}
            rubs[load.name] = Rub(joints[load.joint.name], **numbers)
    if not rubs:
        return oracle.solve(drives, guess)
    result = solve_rubbing(oracle, [*rubs.values()], drives, guess)
    place = oracle.places(result)
    for name, rub in rubs.items():
        result.frictions |= {
            f"friction:{name}:along": rub.force,
            f"friction:{name}:loss": -rub.force * rub.rate(place),
        }
    return result
