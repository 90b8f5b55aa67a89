"""Random parts of mechanisms in space: bodies, orientations, loads, laws of motion."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from spatial_bodies import (
    AXES,
    GROUND,
    NIL,
    Coupling,
    Joint,
    Load,
    Mechanism,
    Rigid,
    Rod,
    Rotor,
    Spread,
    Spring,
    second_moments,
)
from spatial_motion import Motion, solve_motion
from spatial_oracle import Result, solve


@dataclass(frozen=True)
class Law:
    """A coordinate's law: offset + speed t + amplitude sin(frequency t + phase)."""

    offset: float = 0.0
    speed: float = 0.0
    amplitude: float = 0.0
    frequency: float = 0.0
    phase: float = 0.0

    def at(self, t):
        """The coordinate, its rate and its acceleration."""
        turned = self.frequency * t + self.phase
        s, c = math.sin(turned), math.cos(turned)
        size, w = self.amplitude, self.frequency
        return (
            self.offset + self.speed * t + size * s,
            self.speed + size * w * c,
            -size * w * w * s,
        )


@dataclass(frozen=True)
class Sum:
    """A law that several add up to."""

    parts: tuple[Law, ...]

    def at(self, t):
        """The coordinate, its rate and its acceleration."""
        return tuple(
            sum(values[1:], values[0])
            for values in zip(*(law.at(t) for law in self.parts), strict=True)
        )


@dataclass(frozen=True)
class Drawn:
    """A mechanism, its laws by (joint, index), a guess at t = 0, and what bears efforts.

    It moves from 0 to ``span``, and is followed there in ``steps``. So many spins are ``idle``:
    nothing holds them. ``hard`` are bodies that are told by places: of the posture that is guessed,
    in which all coordinates are zero.
    """

    mechanism: Mechanism
    laws: dict
    guess: dict = field(default_factory=dict)
    pushed: Sequence | None = None
    span: float = 1.0
    steps: int = 8
    idle: int = 0
    hard: frozenset[str] = frozenset()
    rotors: tuple[Rotor, ...] = ()

    def is_hard(self, joint: Joint) -> bool:
        """Whether a joint is told by its place: both its bodies are."""
        return {joint.parent, joint.child} <= self.hard

    def drives(self, t) -> dict:
        """(q, q', q'') by (joint, index)."""
        return {key: law.at(t) for key, law in self.laws.items()}

    def solve(self, t, guess=None) -> Result:
        """The instant t; followed from the guess at 0 unless another one is given."""
        guess = guess or self.followed(t)
        drives = self.drives(t)
        found = solve(self.mechanism, drives, guess, self.pushed)
        return self._spun(found, drives) if self.rotors else found

    def _spun(self, found: Result, drives) -> Result:
        """The same with rotors as free bodies, geared to their joints, and told no further."""
        bodies = {b.name: b for b in self.mechanism.bodies}
        pins, gears = [], []
        guess = {
            name: (pose.r.astype(float), pose.R.astype(float)) for name, pose in found.poses.items()
        }
        guess |= {key: float(q) for key, (q, *_) in found.coordinates.items()}
        for rotor in self.rotors:
            joint = self.mechanism.joint(rotor.joint)
            axis = np.array(joint.axis, float) / np.linalg.norm(np.array(joint.axis, float))
            for inertia, ratio in rotor.spinning:
                own = inertia / 2 * (np.eye(3) + np.outer(axis, axis))
                name, parent = f"rotor{len(pins)}", joint.parent
                if parent != GROUND:
                    held = np.array(bodies[parent].inertia, float) - own
                    bodies[parent] = dataclasses.replace(bodies[parent], inertia=held)
                bodies[name] = Rigid(name, 0.0, inertia=own)
                pins.append(Joint(name, "revolute", parent, name, joint.at_parent, axis=axis))
                gears.append(Coupling(f"{name}_gear", {(name, 0): 1.0, (rotor.joint, 0): -ratio}))
                guess[name, 0] = ratio * float(found.coordinates[rotor.joint, 0][0])
        whole = dataclasses.replace(
            self.mechanism,
            bodies=[*bodies.values()],
            joints=[*self.mechanism.joints, *pins],
            couplings=[*self.mechanism.couplings, *gears],
        )
        spun = solve(whole, drives, guess, drives if self.pushed is None else self.pushed)

        def without(told):
            return {key: x for key, x in told.items() if "rotor" not in str(key)}

        return dataclasses.replace(
            spun,
            poses=without(spun.poses),
            coordinates=without(spun.coordinates),
            reactions=without(spun.reactions),
            multipliers=without(spun.multipliers),
            idle=without(spun.idle),
        )

    def move(self, t, guess=None):
        """Poses, coordinates and the factored slope of the motion at t; see :meth:`solve`."""
        return solve_motion(
            Motion(self.mechanism, self.laws, self.pushed or ()),
            self.drives(t),
            guess or self.followed(t),
        )

    def followed(self, t) -> dict:
        """The nearest of the postures that are followed from the one at 0; none of an open tree,
        which needs none.
        """
        if not self.guess:
            return {}
        step = round(self.steps * float(t) / self.span) if self.span else 0
        return self.path[min(max(step, 0), self.steps)][0]

    @cached_property
    def path(self) -> list:
        """The postures, each a guess, at 0 and after every step to the end, with the
        factored slope of the motion there.
        """
        guess, found = self.guess, []
        for k in range(self.steps + 1):
            poses, coordinates, slope = self.move(self.span * k / self.steps, guess)
            guess = {b.name: (poses[b.name].r, poses[b.name].R) for b in self.mechanism.bodies}
            guess |= {key: q for key, (q, *_) in coordinates.items()}
            found.append((guess, slope))
        return found

    @property
    def rods(self) -> list[str]:
        return [b.name for b in self.mechanism.bodies if isinstance(b, Rod)]


def direction(rng):
    """A unit vector, of no direction above others."""
    found = rng.normal(size=3)
    return found / np.linalg.norm(found)


def orientation(rng):
    """A rotation matrix, of no rotation above others."""
    w, x, y, z = (q := rng.normal(size=4)) / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def across(rng, axis):
    """A unit vector at right angles to another."""
    found = np.cross(axis, direction(rng))
    return found / np.linalg.norm(found)


def frame(x, rng):
    """A rotation matrix whose first column is along ``x``."""
    x = np.asarray(x) / np.linalg.norm(x)
    y = across(rng, x)
    return np.array([x, y, np.cross(x, y)]).T


def rod(rng, name, length=None, slender=False) -> Rod:
    """A rod: uniform or tapered, slender or with second moments of its section."""
    length = length or rng.uniform(0.2, 0.8)
    density = [rng.uniform(0.5, 3.0)]
    if rng.random() < 0.5:
        density += [density[0] * rng.uniform(-0.7, 0.7)]
    moments = {}
    if not slender and rng.random() < 0.4:
        yy, zz = rng.uniform(1e-4, 1e-3, 2)
        yz = rng.uniform(-0.5, 0.5) * math.sqrt(yy * zz)
        moments = second_moments([yy, 0.3 * yy], [zz, 0.2 * zz], [yz])
    return Rod(name, length, density, **moments)


def rigid(rng, name, size=0.3) -> Rigid:
    """A rigid body: a cloud of a few points has an inertia that can be."""
    points, masses = rng.normal(size=(5, 3)) * size / 2, rng.uniform(0.1, 0.6, 5)
    centre = masses @ points / sum(masses)
    arms = points - centre
    inertia = sum(
        m * ((x @ x) * np.eye(3) - np.outer(x, x)) for m, x in zip(masses, arms, strict=True)
    )
    return Rigid(name, float(sum(masses)), centre, inertia)


def body(rng, name, length=None, slender=False) -> Rod | Rigid:
    """A rod or, one in three times, a rigid body."""
    return (
        rigid(rng, name)
        if not slender and rng.random() < 1 / 3
        else rod(rng, name, length, slender)
    )


def point_on(rng, one):
    """A point of a body: a rod's tip, a point along it, or one aside."""
    if isinstance(one, Rigid):
        return rng.normal(size=3) * 0.2
    chance = rng.random()
    if chance < 0.4:
        return np.array([one.length, 0.0, 0.0])
    return np.array(
        [
            rng.uniform(0.1, 1.0) * one.length,
            *(rng.normal(size=2) * 0.1 if chance > 0.8 else (0.0, 0.0)),
        ]
    )


def swing(rng, around=0.0, size=1.0) -> Law:
    """A law that swings."""
    return Law(
        around, 0.0, size * rng.uniform(0.3, 1.0), rng.uniform(1.0, 4.0), rng.uniform(0.0, 6.0)
    )


def acting(rng, bodies) -> dict:
    """Gravity, loads and springs; ``bodies`` may also be found at the ground."""
    loads = [
        Load(
            b.name,
            point_on(rng, b),
            rng.normal(size=3) * 5,
            rng.normal(size=3),
            bool(rng.random() < 0.5),
        )
        for b in bodies
        if rng.random() < 0.4
    ]
    springs = []
    if rng.random() < 0.5:
        first, last = bodies[0], bodies[-1]
        start = (
            (GROUND, direction(rng) * 1.5)
            if first is last
            else (first.name, np.array([0.0, 0.05, 0.0]) + point_on(rng, first))
        )
        springs = [
            Spring(
                (start, (last.name, point_on(rng, last))),
                rng.uniform(10, 50),
                rng.uniform(0.1, 0.4),
                rng.uniform(0, 3),
            )
        ]
    gravity = direction(rng) * 9.81
    # By a generator of its own, so that the rest is drawn as it was without.
    own = np.random.default_rng(int(1e9 * abs(gravity[0])))
    spreads = [spread(own, b) for b in bodies if isinstance(b, Rod) and own.random() < 0.4]
    return {"gravity": gravity, "loads": loads, "spreads": spreads, "springs": springs}


def spread(rng, rod) -> Spread:
    """A load along a rod, or a part of it."""
    start, end = (
        (0.0, 1.0) if rng.random() < 0.4 else (rng.uniform(0.0, 0.4), rng.uniform(0.5, 1.0))
    )
    powers = [[float(rng.normal() * 10) for _ in range(int(rng.integers(1, 6)))] for _ in range(3)]
    return Spread(
        rod.name,
        float(start * rod.length),
        float(end * rod.length),
        powers,
        bool(rng.random() < 0.5),
    )


def joint(rng, name, kind, parent, child, at_parent=NIL, at_child=NIL) -> Joint:
    """A joint whose axes and orientation are anyhow."""
    axis = direction(rng)
    lead = rng.uniform(0.05, 0.4) * rng.choice([-1, 1]) if kind == "screw" else 0
    turns = orientation(rng).T if rng.random() < 0.5 else AXES
    return Joint(
        name,
        kind,
        parent,
        child,
        at_parent,
        at_child,
        axis,
        across(rng, axis),
        lead,
        turns,
        orientation(rng),
    )


def turning(drawn: Drawn, seed: int) -> Drawn:
    """The same with rotors in some of its joints that have one coordinate, whose parents have an
    inertia.
    """
    rng = np.random.default_rng([seed, 7])
    rods = {*drawn.rods}
    found = [
        Rotor(joint.name, *map(float, (rng.uniform(1e-4, 2e-2), rng.uniform(-8, 8))), armature)
        for joint in drawn.mechanism.joints
        for armature in [float(rng.choice([0.0, rng.uniform(0.0, 0.2)]))]
        if joint.kind in ("revolute", "prismatic")
        and joint.parent not in rods
        and rng.random() < 0.5
    ]
    return dataclasses.replace(drawn, rotors=tuple(found))
