"""Random mechanisms as users tell them: any joints, told from either body, in loops or not, with
hard points or relative.

Bodies are put anywhere, and joints where they are then, so that all coordinates are zero at the
start. Axes are anyhow, or along the axes of a body or of the ground. What is driven is drawn from
all coordinates, what bears the efforts once more.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from spatial_bodies import AXES, GROUND, Coupling, Joint, Mechanism, Rigid, Rod
from spatial_bridge import across_axis
from spatial_draft import (
    Drawn,
    Law,
    across,
    acting,
    body,
    direction,
    frame,
    orientation,
    point_on,
    rod,
)
from spatial_mechanisms import STEADY, steady
from spatial_motion import Motion, OpenLoopError

HANGING = {
    "revolute": 5,
    "prismatic": 2,
    "cylindrical": 2,
    "universal": 2,
    "spherical": 2,
    "screw": 1,
    "planar": 1,
    "slot": 1,
    "weld": 1,
    "free": 1,
}
"""The joints on which bodies hang, and how often each."""

CLOSING = {
    "revolute": 1,
    "prismatic": 1,
    "cylindrical": 3,
    "universal": 3,
    "spherical": 5,
    "planar": 2,
    "slot": 3,
}
"""Those that close loops. A screw there is told to be driven itself."""

DRIVEN = ("revolute", "prismatic", "cylindrical", "universal", "screw", "planar")
"""The joints whose coordinates may be driven wherever they are."""


class _Draft:
    """Bodies, where they are, and the joints between them."""

    def __init__(self, rng, hard) -> None:
        self.rng, self.is_hard = rng, hard
        self.bodies: dict[str, Rod | Rigid] = {}
        self.poses = {GROUND: (np.zeros(3), np.eye(3))}
        self.joints: list[Joint] = []
        self.hard = {GROUND}

    def pick(self, kinds) -> str:
        return str(self.rng.choice([*kinds], p=np.array([*kinds.values()]) / sum(kinds.values())))

    def place(self, name):
        """A place on a body, in ground axes."""
        r, R = self.poses[name]
        if name == GROUND:
            return self.rng.normal(size=3) * 0.4
        return r + R @ (
            point_on(self.rng, self.bodies[name]) if self.rng.random() < 0.8 else np.zeros(3)
        )

    def put(self, one, r, R) -> None:
        self.bodies[one.name], self.poses[one.name] = one, (r, R)
        if self.rng.random() < self.is_hard:
            self.hard.add(one.name)

    def join(self, name, kind, parent, child, at) -> None:
        """A joint at a place, told from either body to the other."""
        rng = self.rng
        if rng.random() < 0.3 and GROUND not in (parent, child):
            parent, child = child, parent
        (r, R), (s, S) = self.poses[parent], self.poses[child]
        axis = direction(rng)
        if rng.random() < 0.5:
            axis = (np.eye(3), R, S)[rng.integers(3)][:, rng.integers(3)] * rng.choice([-1.0, 1.0])
        u, v = R.T @ axis, R.T @ across(rng, axis)
        turns = np.array([u, v, np.cross(u, v)]) if rng.random() < 0.6 else np.array(AXES, float)
        if kind == "slot":
            turns = (
                np.array(across_axis(axis)) @ R if {parent, child} <= self.hard else across_axis(u)
            )
        lead = rng.uniform(0.05, 0.4) * rng.choice([-1, 1]) if kind == "screw" else 0
        ends = self._on(parent, R.T @ (at - r)), self._on(child, S.T @ (at - s))
        self.joints.append(Joint(name, kind, parent, child, *ends, u, v, lead, turns, R.T @ S))

    def _on(self, name, point):
        """A point of a rod lies within it, and on its axis or at its ends to the last digit where
        it does at all.
        """
        one = self.bodies.get(name)
        if not isinstance(one, Rod):
            return point
        x, *aside = (0.0 if abs(number) < 1e-12 else float(number) for number in point)
        x = float(one.length) if abs(x - one.length) < 1e-12 else x
        if not 0.0 <= x <= one.length:
            raise OpenLoopError(f"'{name}' does not reach its joint")
        return np.array([x, *aside])

    def hang(self, one, name) -> None:
        """Hang a body on one before it, or on the ground; now and then its axes lie along the
        other's.
        """
        rng = self.rng
        parent = str(rng.choice([*self.bodies])) if self.bodies and rng.random() < 0.75 else GROUND
        at, R = self.place(parent), orientation(rng)
        if parent != GROUND and rng.random() < 0.2:
            R = np.roll(self.poses[parent][1], rng.integers(3), axis=1)
        own = np.zeros(3) if rng.random() < 0.5 else point_on(rng, one)
        self.put(one, at - R @ own, R)
        self.join(name, self.pick(HANGING), parent, one.name, at)

    def close(self, number) -> None:
        """Close a loop by a joint between two bodies, or by a rod between them; it may be a bar."""
        rng = self.rng
        one, other = (str(name) for name in rng.choice([*self.bodies, GROUND], 2, replace=False))
        if rng.random() < 0.5:
            one, other = (GROUND, one) if other == GROUND else (one, other)
            self.join(f"c{number}", self.pick(CLOSING), one, other, self.place(other))
            return
        start, end = self.place(one), self.place(other)
        if np.array_equal(start, end):
            raise OpenLoopError("a rod has no length")
        bar = rng.random() < 0.3
        link = rod(
            rng,
            f"bar{number}" if bar else f"rod{number}",
            float(np.linalg.norm(end - start)),
            slender=bar,
        )
        self.put(link, start, frame(end - start, rng))
        for name, far, at in ((f"p{number}", one, start), (f"q{number}", other, end)):
            self.join(name, "spherical" if bar else self.pick(CLOSING), far, link.name, at)

    def couple(self, rng, number) -> Coupling:
        """An equation of a user's own: of coordinates, or of a point on a plane, which may follow a
        coordinate.
        """
        keys = [(j.name, k) for j in self.joints if j.kind in DRIVEN for k in range(j.count)]
        count = min(len(keys), int(rng.integers(2, 4)))
        if count == 2 and rng.random() < 0.6:
            name = str(rng.choice([one for one in self.bodies if not one.startswith("bar")]))
            (r, R), point = self.poses[name], point_on(rng, self.bodies[name])
            way = direction(rng)
            terms = {keys[rng.integers(len(keys))]: rng.uniform(-0.5, 0.5)}
            terms = terms if rng.random() < 0.5 else {}
            points = {(name, tuple(map(float, point))): tuple(map(float, way))}
            return Coupling(f"plane{number}", terms, float(way @ (r + R @ point)), points)
        if count < 2:
            raise OpenLoopError("there is nothing to couple")
        chosen = rng.permutation(len(keys))[:count]
        return Coupling(f"tie{number}", {keys[k]: float(rng.uniform(-1.5, 1.5)) for k in chosen})


def _driven(rng, mechanism, guess, idle):
    """Coordinates that together place all but the spins of bars, steadily."""
    keys = [(j.name, k) for j in mechanism.joints if j.kind in DRIVEN for k in range(j.count)]
    found, left = [], None
    for key in [None, *(keys[k] for k in rng.permutation(len(keys)))]:
        zero = dict.fromkeys([*found, *([] if key is None else [key])], (0.0, 0.0, 0.0))
        motion = Motion(mechanism, zero)
        slope = motion.factored(*motion.start(guess, zero))
        many = slope.null.shape[1]
        if left is None or (many < left and slope.least > STEADY):
            found, left = [*zero], many
        if left == idle:
            break
    if left != idle or not found:
        raise OpenLoopError("what may be driven does not place all")
    return found


@steady
def anyhow(rng) -> Drawn:
    """Two to five bodies, and up to two loops."""
    draft = _Draft(rng, hard=rng.choice([0.0, 0.7, 1.0]))
    for k in range(rng.integers(2, 6)):
        draft.hang(body(rng, f"b{k}"), f"j{k}")
    for k in range(rng.integers(0, 3)):
        draft.close(k)
    bodies = [*draft.bodies.values()]
    bars = [one.name for one in bodies if one.name.startswith("bar")]
    if any(sum(bar in (joint.parent, joint.child) for joint in draft.joints) > 2 for bar in bars):
        raise OpenLoopError("a bar carries more than its ends, and does not spin freely")
    acts = acting(rng, [one for one in bodies if one.name not in bars])
    own = np.random.default_rng(int(1e9 * abs(acts["gravity"][1])))
    couplings = [draft.couple(own, k) for k in range(own.choice([0, 1, 2], p=[0.7, 0.2, 0.1]))]
    mechanism = Mechanism(bodies, draft.joints, **acts, couplings=couplings)
    guess = {name: pose for name, pose in draft.poses.items() if name != GROUND}
    laws = {
        key: Law(0.0, rng.uniform(-1, 1), rng.uniform(0, 0.05), 3.0)
        for key in _driven(rng, mechanism, guess, len(bars))
    }
    pushed = _driven(rng, mechanism, guess, len(bars)) if rng.random() < 0.35 else None
    drawn = Drawn(mechanism, laws, guess, pushed, span=0.3, idle=len(bars))
    return dataclasses.replace(drawn, hard=frozenset(draft.hard))
