"""A mechanism in space whose body hangs on balls, one of them in gimbal lock at an instant."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from spatial_bodies import GROUND, Joint, Load, Mechanism
from spatial_draft import Drawn, Law, frame, rigid, rod

LOCK = 0.2
"""The instant [s]."""


def locked(drawn: Drawn, name: str, t: float) -> Drawn:
    """The same, with a joint's three turns told from where its second one is at a right angle at an
    instant.
    """
    joint, poses = drawn.mechanism.joint(name), drawn.move(t)[0]
    (R, S), (u, v, w) = (
        (
            np.asarray(poses[b].R, float) if b in poses else np.eye(3)
            for b in (joint.parent, joint.child)
        ),
        joint.frame,
    )
    turned = np.outer(u, w) + np.outer(v, v) - np.outer(w, u)
    changed = dataclasses.replace(joint, orientation=turned.T @ R.T @ S)
    joints = [changed if one is joint else one for one in drawn.mechanism.joints]
    return dataclasses.replace(drawn, mechanism=dataclasses.replace(drawn.mechanism, joints=joints))


def platform(seed: int) -> Drawn:
    """A plate on three legs of two links each, whose feet turn as they are told; all that holds it
    are balls (3-RRS).
    """
    rng = np.random.default_rng(seed)
    at = np.array([0.0, 0.0, 0.7]) + rng.normal(size=3) * 0.02
    plate = rigid(rng, "plate", 0.2)
    bodies = []
    joints = []
    laws = {}
    guess = {"plate": (at, np.eye(3))}
    for k in range(3):
        out = np.array([math.cos(2.1 * k), math.sin(2.1 * k), 0.0])
        foot, top = 0.35 * out, at + 0.2 * out
        knee = (foot + top) / 2 + 0.15 * out + rng.normal(size=3) * 0.01
        lower, upper = (
            rod(rng, f"{name}{k}", float(np.linalg.norm(way)), slender=True)
            for name, way in _ways(foot, knee, top)
        )
        bodies += [lower, upper]
        (_, down), (_, up) = _ways(foot, knee, top)
        guess |= {lower.name: (foot, frame(down, rng)), upper.name: (knee, frame(up, rng))}
        (_, R), (_, S) = guess[lower.name], guess[upper.name]
        axis = np.cross(out, (0.0, 0.0, 1.0)) + rng.normal(size=3) * 0.05
        joints += [
            Joint(f"O{k}", "revolute", GROUND, lower.name, foot, axis=axis, orientation=R),
            Joint(
                f"K{k}",
                "revolute",
                lower.name,
                upper.name,
                (lower.length, 0, 0),
                axis=R.T @ axis,
                orientation=R.T @ S,
            ),
        ]
        ends = (upper.length, 0.0, 0.0), 0.2 * out
        joints.append(Joint(f"S{k}", "spherical", upper.name, "plate", *ends))
        laws["O" + str(k), 0] = Law(0.0, 0.0, rng.uniform(0.1, 0.25), rng.uniform(3, 6), 0.0)
    one = Mechanism(
        [plate, *bodies],
        joints,
        loads=[Load("plate", (0.1, 0, 0), rng.normal(size=3) * 20, (1, 0, 0))],
        gravity=(0, 0, -9.81),
    )
    return locked(Drawn(one, laws, guess, span=2 * LOCK), "S0", LOCK)


def _ways(foot, knee, top):
    return ("lower", knee - foot), ("upper", top - knee)
