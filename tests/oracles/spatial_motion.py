"""Places, rates and accelerations of free bodies whose joints' gaps are closed.

The unknowns are six a body and one for every coordinate that is not driven. Every joint leads from
its parent to where its child must be; the gap is a difference of two places and two orientations.
Where none of a joint's three turns is driven, its orientations are let go instead, so that nothing
is singular by parametrisation. Newton's method closes the gaps; rates and accelerations are linear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from arithmetic import TOLERANCE
from spatial_algebra import (
    Factored,
    InconsistentError,
    angle_about,
    cross,
    orthonormal,
    skew,
    small_turn,
    turn,
    vector,
)
from spatial_bodies import GROUND, Joint, Mechanism

_STEPS = 100
_TURN = 0.5
_STILL_FAR = 1e-10


class OpenLoopError(AssertionError):
    """No posture near the guess closes all gaps."""


@dataclass(frozen=True)
class Pose:
    """A body's place and axes (columns) in ground axes, the velocities and the accelerations of its
    origin and its axes.
    """

    r: np.ndarray
    R: np.ndarray
    v: Any = None
    w: Any = None
    a: Any = None
    alpha: Any = None

    def at(self, point):
        """The place of a point in its axes."""
        return self.r + self.R @ point

    def velocity(self, point):
        return self.v + cross(self.w, self.R @ point)

    def acceleration(self, point):
        arm = self.R @ point
        return self.a + cross(self.alpha, arm) + cross(self.w, cross(self.w, arm))


@dataclass(frozen=True)
class Passage:
    """Where a joint leads from its parent: the end's pose, and its axes' directions, ground axes.

    Each axis of a turn passes through the end, whatever the joint.
    """

    end: Pose
    directions: list


class Motion:
    """The equations of a mechanism whose coordinates ``known`` (joint, index) are given; see
    :func:`solve_motion`.

    Coordinates of ``pushed`` and coupled ones are followed, though they be not known.
    """

    def __init__(self, mechanism: Mechanism, known, pushed=()) -> None:
        self.mechanism, self.known = mechanism, set(known)
        self.pushed = {*pushed}
        self.coupled = {key for coupling in mechanism.couplings for key in coupling.terms}
        self.coupled |= {key for row in mechanism.rows for key in row.keys}
        counted = self.known | self.pushed | self.coupled
        self.axes = {j.name: j.axes() for j in mechanism.joints}
        self.at_parent = {j.name: vector(j.at_parent) for j in mechanism.joints}
        self.at_child = {j.name: vector(j.at_child) for j in mechanism.joints}
        self.zero = {j.name: orthonormal(j.orientation) for j in mechanism.joints}
        self.column = {b.name: 6 * i for i, b in enumerate(mechanism.bodies)}
        self.loose = {
            j.name
            for j in mechanism.joints
            if len(j.turning) == 3 and not {(j.name, k) for k in j.turning} & counted
        }
        for name, k in counted:
            assert k in range(mechanism.joint(name).count), (
                f"'{name}' has {mechanism.joint(name).count} coordinates, not number {k}"
            )
        self.free = [
            (j.name, k)
            for j in mechanism.joints
            for k in range(j.count)
            if (j.name, k) not in self.known and not (j.name in self.loose and k in j.turning)
        ]
        self.count = 6 * len(mechanism.bodies) + len(self.free)
        self.number = {key: 6 * len(mechanism.bodies) + i for i, key in enumerate(self.free)}
        size = mechanism.size
        free = [1.0 if self.axes[name][k].turns else size for name, k in self.free]
        self.units = np.array(([size] * 3 + [1.0] * 3) * len(mechanism.bodies) + free)
        nil = np.zeros(3)
        self.ground = Pose(nil, np.eye(3), nil, nil, nil, nil)

    def kept(self, joint: Joint) -> list[int]:
        """The indices of the axes that lead from parent to child: all but the turns of a loose
        joint.
        """
        return [
            k for k in range(joint.count) if not (joint.name in self.loose and k in joint.turning)
        ]

    def passage(self, joint: Joint, parent: Pose, values) -> Passage:
        """From the parent's pose, with rates and accelerations where it has them; ``values`` hold
        (q, q', q'') by axis.
        """
        moving, axes = parent.w is not None, self.axes[joint.name]
        p = parent.at(self.at_parent[joint.name])
        R, w, alpha = parent.R, parent.w, parent.alpha
        v = a = None
        if moving:
            v = parent.velocity(self.at_parent[joint.name])
            a = parent.acceleration(self.at_parent[joint.name])
        directions = []
        for k in self.kept(joint):
            u, (q, rate, acceleration) = R @ axes[k].direction, values[joint.name, k]
            directions.append(u)
            if axes[k].turns:
                R = R @ turn(axes[k].direction, q)
                if moving:
                    alpha = alpha + u * acceleration + cross(w, u) * rate
                    w = w + u * rate
            if axes[k].slide:
                d, speed = u * (axes[k].slide * q), u * (axes[k].slide * rate)
                p = p + d
                if moving:
                    v = v + cross(w, d) + speed
                    a = (
                        a
                        + cross(alpha, d)
                        + cross(w, cross(w, d))
                        + cross(w, speed) * 2
                        + u * (axes[k].slide * acceleration)
                    )
        return Passage(Pose(p, R @ self.zero[joint.name], v, w, a, alpha), directions)

    def gaps(self, poses, values, kind: int):
        """Gaps (``kind`` 0), their rates (1) or their accelerations (2), a joint after another."""
        found = []
        for joint in self.mechanism.joints:
            child, point = poses[joint.child], self.at_child[joint.name]
            end = self.passage(joint, poses[joint.parent], values).end
            if kind == 0:
                pair = child.at(point) - end.r, _between(end.R, child.R)
            elif kind == 1:
                pair = child.velocity(point) - end.v, child.w - end.w
            else:
                pair = child.acceleration(point) - end.a, child.alpha - end.alpha
            found += pair[:1] if joint.name in self.loose else pair
        for coupling in self.mechanism.couplings:
            total = -float(0 if kind else coupling.offset)
            for key, coefficient in coupling.terms.items():
                total += float(coefficient) * values[key][kind]
            for (body, point), way in coupling.points.items():
                pose = poses[body]
                of = (pose.at, pose.velocity, pose.acceleration)[kind]
                total += vector(way) @ of(vector(point))
            found.append([total])
        return np.concatenate(found) if found else np.zeros(0)

    def slope(self, poses, values):
        """The slope of the gaps' rates by all rates."""
        rows = []
        for joint in self.mechanism.joints:
            passage = self.passage(joint, poses[joint.parent], values)
            block = np.zeros((6, self.count))
            for name, sign, point in (
                (joint.child, 1, poses[joint.child].at(self.at_child[joint.name])),
                (joint.parent, -1, passage.end.r),
            ):
                if name != GROUND:
                    c = self.column[name]
                    block[:3, c : c + 3] += np.eye(3) * sign
                    block[:3, c + 3 : c + 6] += skew(point - poses[name].r) * -sign
                    block[3:, c + 3 : c + 6] += np.eye(3) * sign
            for k, u in zip(self.kept(joint), passage.directions, strict=True):
                if (joint.name, k) in self.number:
                    axis, c = self.axes[joint.name][k], self.number[joint.name, k]
                    block[:3, c] = -u * axis.slide
                    if axis.turns:
                        block[3:, c] = -u
            rows.append(block[:3] if joint.name in self.loose else block)
        for coupling in self.mechanism.couplings:
            line = np.zeros((1, self.count))
            for key in {*coupling.terms} & {*self.number}:
                line[0, self.number[key]] = float(coupling.terms[key])
            for (body, point), way in coupling.points.items():
                way, c = vector(way), self.column[body]
                arm = poses[body].R @ vector(point)
                line[0, c : c + 3] += way
                line[0, c + 3 : c + 6] += cross(arm, way)
            rows.append(line)
        return np.concatenate(rows) if rows else np.zeros((0, self.count))

    def factored(self, poses, values) -> Factored:
        size = self.mechanism.size
        rows = [
            u
            for j in self.mechanism.joints
            for u in ([size] * 3 if j.name in self.loose else [size] * 3 + [1.0] * 3)
        ]
        rows += [size if coupling.points else 1.0 for coupling in self.mechanism.couplings]
        return Factored.of(self.slope(poses, values), np.array(rows), self.units)

    def start(self, guess, drives):
        """Poses and coordinates from a guess: poses by body's name, coordinates by (joint, index);
        what is missing follows.
        """
        values = {key: vector(given) for key, given in drives.items()}
        poses = {GROUND: self.ground}
        for name, (r, R) in ((n, g) for n, g in guess.items() if isinstance(n, str)):
            poses[name] = Pose(vector(r), orthonormal(R))
        told = {key: (float(q), 0.0, 0.0) for key, q in guess.items() if not isinstance(key, str)}
        told = (
            {(j.name, k): (0.0, 0.0, 0.0) for j in self.mechanism.joints for k in range(j.count)}
            | told
            | values
        )
        whole = Motion(self.mechanism, told)
        for _ in self.mechanism.bodies:
            for joint in self.mechanism.joints:
                if joint.parent in poses and joint.child not in poses:
                    end = whole.passage(joint, replace(poses[joint.parent], w=None), told).end
                    poses[joint.child] = Pose(end.r - end.R @ self.at_child[joint.name], end.R)
        assert len(poses) == len(self.mechanism.bodies) + 1, (
            "no joints lead from the ground to every body: guess its pose"
        )
        for joint in self.mechanism.joints:
            if [key for key in self.free if key[0] == joint.name and key not in guess]:
                found = coordinates(joint, self, poses)
                values |= {
                    (joint.name, k): (found[k], 0.0, 0.0)
                    for k in self.kept(joint)
                    if (joint.name, k) not in values
                }
        return poses, values | {key: told[key] for key in self.free if key not in values}

    def moved(self, poses, values, step):
        """Poses and coordinates a step on."""
        new = {GROUND: self.ground}
        for name, c in self.column.items():
            new[name] = Pose(
                poses[name].r + step[c : c + 3],
                small_turn(step[c + 3 : c + 6]) @ poses[name].R,
            )
        return new, values | {
            key: (values[key][0] + step[c], *values[key][1:]) for key, c in self.number.items()
        }

    def moving(self, poses, values, rates, accelerations):
        """Poses and coordinates with rates and accelerations."""
        new = {GROUND: self.ground}
        for name, c in self.column.items():
            v = rates[c : c + 3]
            w = rates[c + 3 : c + 6]
            a = accelerations[c : c + 3]
            alpha = accelerations[c + 3 : c + 6]
            new[name] = replace(poses[name], v=v, w=w, a=a, alpha=alpha)
        return new, values | {
            key: (values[key][0], rates[c], accelerations[c]) for key, c in self.number.items()
        }


def _between(a, b):
    """A small turn from ``a`` to ``b``, ground axes; far from one its sine."""
    m = b @ a.T
    return np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / 2


def coordinates(joint: Joint, motion: Motion, poses) -> list:
    """Coordinates of a joint whose bodies have these poses, about: exact where the
    poses fit the joint.
    """
    parent, child, axes = poses[joint.parent], poses[joint.child], motion.axes[joint.name]
    e = [x.direction for x in axes]
    turned = parent.R.T @ child.R @ motion.zero[joint.name].T
    way = parent.R.T @ (
        child.at(motion.at_child[joint.name]) - parent.at(motion.at_parent[joint.name])
    )
    found = [0.0 if x.turns else float(e[k] @ way) for k, x in enumerate(axes)]
    turning = [*joint.turning]
    if len(turning) == 1:
        aside = np.cross(e[turning[0]], np.eye(3)[np.argmin(np.abs(e[turning[0]]))])
        found[turning[0]] = angle_about(e[turning[0]], aside, turned @ aside)
        if joint.kind == "screw" and joint.lead:
            # Whole turns are seen by the slide alone.
            found[0] += (
                2
                * math.pi
                * round((float(e[0] @ way) / float(axes[0].slide) - found[0]) / (2 * math.pi))
            )
    elif len(turning) == 2:
        first, second = (e[k] for k in turning)
        found[turning[0]] = angle_about(first, second, turned @ second)
        found[turning[1]] = angle_about(turned @ second, first, turned @ first)
    elif len(turning) == 3:
        x, y, z = (e[k] for k in turning)
        m = np.array([x, y, z]) @ turned @ np.array([x, y, z]).T
        found[turning[0]] = math.atan2(-m[1, 2], m[2, 2])
        found[turning[1]] = math.asin(max(-1.0, min(1.0, m[0, 2])))
        found[turning[2]] = math.atan2(-m[0, 1], m[0, 0])
    return [float(x) for x in found]


def solve_motion(motion: Motion, drives, guess):
    """Poses with rates and accelerations, (q, q', q'') of every coordinate that has them, and the
    factored slope.

    Raises :class:`OpenLoopError` where Newton's method closes nothing.
    """
    poses, values = motion.start(guess, drives)
    factored, before, left = None, math.inf, math.inf
    for _ in range(_STEPS):
        if left > _STILL_FAR or factored is None:
            factored = motion.factored(poses, values)
        gap = motion.gaps(poses, values, 0)
        if not gap.size or not motion.count:
            break
        step = factored.inverse @ -gap
        turned = max((max(abs(step[c + 3 : c + 6])) for c in motion.column.values()), default=0.0)
        step = step * min(1.0, _TURN / turned if turned else 1.0)
        poses, values = motion.moved(poses, values, step)
        before, left = left, max(abs(step / motion.units))
        if left < TOLERANCE / 10 or (before <= 1e4 * TOLERANCE and left > before / 2):
            break
    left = np.max(np.abs(motion.gaps(poses, values, 0)), initial=0.0) / motion.mechanism.size
    flipped = [
        j.name
        for j in motion.mechanism.joints
        if j.name not in motion.loose
        and np.trace(motion.passage(j, poses[j.parent], values).end.R.T @ poses[j.child].R) < 2.9
    ]
    if not left < 1e4 * TOLERANCE or flipped:
        raise OpenLoopError(
            f"the spatial oracle does not close its loops: {left:.1e} open, turned over at"
            f" {flipped}"
        )
    factored = motion.factored(poses, values)
    zeros = np.zeros(motion.count)
    still = {
        key: (q, 0.0 if key in motion.number else rate, acceleration)
        for key, (q, rate, acceleration) in values.items()
    }
    moving, still = motion.moving(poses, still, zeros, zeros)
    try:
        rates = factored.solve(
            -motion.gaps(moving, still, 1), "the drives' rates contradict each other"
        )
        moving, rated = motion.moving(poses, values, rates, zeros)
        accelerations = factored.solve(
            -motion.gaps(moving, rated, 2), "the drives' accelerations contradict each other"
        )
    except InconsistentError as error:
        raise OpenLoopError(str(error)) from error
    return (*motion.moving(poses, values, rates, accelerations), factored)
