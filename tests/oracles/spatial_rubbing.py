"""Friction beside the spatial oracle: its laws by fixed-point iteration, around vector Newton-Euler
on free bodies.

It shares nothing with the package. What a friction does is a load on both bodies of its joint. What
all joints bear is linear in the frictions' forces, so a balance of all bodies for each of these
alone tells them all; the instant that is solved again with what was found must agree.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from rubbing import converge
from spatial_bodies import GROUND, Joint, Load
from spatial_draft import Drawn
from spatial_oracle import Result


@dataclass(frozen=True)
class Rub:
    """Friction along a coordinate of a joint that turns about one axis, slides along it, or both;
    or in a spherical joint, against the way in which it turns; by what declares it.
    """

    joint: Joint
    index: int
    numbers: dict[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return f"rub_{self.joint.name}_{self.index}"

    @property
    def along(self) -> str:
        """The coordinate's name, of a joint that has two."""
        return "" if self.joint.count != 2 else "turn" if self.turns else "slide"

    @property
    def turns(self) -> bool:
        return self.index in self.joint.turning

    def axis(self, found: Result) -> np.ndarray:
        """The joint's axis in ground axes; of a spherical joint that about which it turns."""
        if self.joint.kind == "spherical":
            spin = self.spin(found)
            return spin / np.linalg.norm(spin)
        R = np.eye(3) if self.joint.parent == GROUND else found.poses[self.joint.parent].R
        own = np.asarray(self.joint.axis, float)
        return R @ (own / np.linalg.norm(own))

    def spin(self, found: Result) -> np.ndarray:
        """The angular velocity of the child beside the parent."""
        nil = np.zeros(3)
        return found.poses[self.joint.child].w - (
            nil if self.joint.parent == GROUND else found.poses[self.joint.parent].w
        )

    def rate(self, found: Result) -> float:
        if self.joint.kind == "spherical":
            return float(np.linalg.norm(self.spin(found)))
        return found.coordinates[self.joint.name, self.index][1]

    def loads(self, found: Result, force: float) -> list[Load]:
        """What a force or couple along the coordinate does to both bodies."""
        child, way = found.poses[self.joint.child], self.axis(found) * force
        place = child.at(np.asarray(self.joint.at_child, float))
        acts = []
        for body, sign in ((self.joint.child, 1.0), (self.joint.parent, -1.0)):
            if body != GROUND:
                pose = found.poses[body]
                told = {"torque" if self.turns else "force": sign * way}
                acts.append(Load(body, pose.R.T @ (place - pose.r), **told))
        return acts

    def law(self, found: Result, reaction: np.ndarray) -> float:
        """What the law says of a reaction: bearings by statics, threads by the angles of lead and
        of friction.
        """
        n, kind, u = self.numbers, self.joint.kind, self.axis(found)
        v, mu, radius = self.rate(found), n.get("mu", 0.0), n.get("radius", 0.0)
        steady = -n.get("viscous", 0.0) * v
        force, moment = reaction[:3], reaction[3:]
        axial, torque = force @ u, moment @ u
        if kind == "screw":
            lead = abs(self.joint.lead) / math.tau / radius
            lifts = axial * self.joint.lead * v > 0.0
            angle, phi = math.atan(lead if lifts else -lead), math.atan(mu)
            return steady - math.copysign(
                radius * abs(axial) * (math.tan(angle + phi) - math.tan(angle)), v
            )
        if kind == "spherical":
            pressed, speed = np.linalg.norm(force), radius * v
        else:
            across, apart = force - axial * u, 2.0 / n["length"] * np.cross(moment, u)
            pressed = np.linalg.norm(across + apart) / 2 + np.linalg.norm(across - apart) / 2
            pressed += {
                "revolute": abs(axial),
                "prismatic": abs(torque) / radius,
                "cylindrical": 0.0,
            }[kind]
            slides = [
                found.coordinates[self.joint.name, k][1]
                * (radius if k in self.joint.turning else 1.0)
                for k in range(self.joint.count)
            ]
            speed = math.hypot(*slides)
        if "static" in n:
            mu += (n["static"] - mu) * math.exp(-((speed / n["stribeck"]) ** 2))
        share = v * (radius if self.turns else 1.0) / speed
        return steady - share * mu * pressed * (radius if self.turns else 1.0)


def solve_rubbing(drawn: Drawn, rubs: Sequence[Rub], t: float) -> tuple[Result, dict[str, float]]:
    """The instant with friction, and the frictions' forces by name."""
    still = drawn.solve(t)
    guess = {name: (pose.r, pose.R) for name, pose in still.poses.items()} | {
        k: q for k, (q, *_) in still.coordinates.items()
    }

    def balanced(forces):
        more = [
            load
            for rub, force in zip(rubs, forces, strict=True)
            for load in rub.loads(still, force)
        ]
        loaded = replace(drawn.mechanism, loads=[*drawn.mechanism.loads, *more])
        result = replace(drawn, mechanism=loaded).solve(t, guess=guess)
        return result, np.array([result.reactions[rub.joint.name] for rub in rubs])

    laws = [lambda reaction, rub=rub: rub.law(still, reaction) for rub in rubs]
    result, forces = converge(balanced, laws)
    return result, {rub.name: float(force) for rub, force in zip(rubs, forces, strict=True)}
