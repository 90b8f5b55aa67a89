"""The balance of force and moment of every free body, for the wrenches that all joints pass.

The unknowns are six a joint: what the parent does to the child, ground axes, its moment about the
child's point. A coordinate without an effort passes no power: one more equation each. The effort of
another is its power for a unit rate, and what that effort does is taken out of the reaction. A
coupling is one more unknown: its multiplier acts on its coordinates as efforts do. So does that of
a non-holonomic constraint, and on points as forces; the motion is given, and looked at whether it
fulfils it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from arithmetic import GAUSS, TOLERANCE
from spatial_algebra import Factored, InconsistentError, cross, skew, vector
from spatial_bodies import GROUND, Joint, Mechanism, Spread
from spatial_motion import Motion


@dataclass(frozen=True)
class Acting:
    """A force and a moment on a body at a place, ground axes; ``of`` is the load along the body
    that it is a share of.
    """

    body: str
    place: np.ndarray
    force: np.ndarray
    moment: np.ndarray
    of: Spread | None = None


def shares(spread, pose, low, high) -> list[Acting]:
    """Forces that do what a load along a body does between two distances."""
    found = []
    for node, weight in zip(*GAUSS, strict=True) if low < high else ():
        x = low + (high - low) * (node + 1.0) / 2.0
        force = vector(spread.at(x)) * (weight * (high - low) / 2.0)
        force = pose.R @ force if spread.turning else force
        found.append(
            Acting(spread.body, pose.at(np.array([x, 0.0, 0.0])), force, force * 0, spread)
        )
    return found


@dataclass(frozen=True)
class Tie:
    """What a unit of a multiplier does: efforts by (joint, index), and forces at places, each
    (body, place, force).
    """

    name: str
    terms: dict
    forces: list


@dataclass(frozen=True)
class Wrenches:
    """What all joints pass, ``found`` six numbers each, and multipliers by tie; ``null`` varies
    them at will.
    """

    found: dict[str, Any]
    null: list[dict[str, Any]]


@dataclass(frozen=True)
class Balance:
    """The balances of a mechanism's bodies at an instant."""

    motion: Motion
    poses: dict
    values: dict
    pushed: frozenset

    @property
    def active(self) -> set:
        """The coordinates that pass power."""
        return self.pushed | self.motion.coupled

    @cached_property
    def ties(self) -> list[Tie]:
        """Couplings and rows.

        Raises :class:`spatial_algebra.InconsistentError` where the motion does not fulfil a row.
        """
        found = [
            Tie(
                c.name,
                {key: float(x) for key, x in c.terms.items()},
                [
                    (body, self.poses[body].at(vector(point)), vector(way))
                    for (body, point), way in c.points.items()
                ],
            )
            for c in self.mechanism.couplings
        ]
        for row in self.mechanism.rows:
            terms, directions = row.of(math, {key: self.values[key][0] for key in row.keys})
            points = [(body, vector(point), way) for (body, point), way in directions.items()]
            parts = [x * self.values[key][1] for key, x in terms.items()]
            parts += [
                x * v
                for body, point, way in points
                for x, v in zip(way, self.poses[body].velocity(point), strict=True)
            ]
            if abs(sum(parts)) > 1000 * TOLERANCE * max(map(abs, parts)):
                raise InconsistentError(f"the motion does not fulfil '{row.name}'")
            found.append(
                Tie(
                    row.name,
                    terms,
                    [
                        (body, self.poses[body].at(point), vector(way))
                        for body, point, way in points
                    ],
                )
            )
        return found

    @property
    def mechanism(self) -> Mechanism:
        return self.motion.mechanism

    def point(self, joint: Joint):
        """The child's point, where what a joint passes is."""
        return self.poses[joint.child].at(self.motion.at_child[joint.name])

    def twists(self, joint: Joint):
        """Of every axis, what the child's point and the child do for a unit rate: index (None for a
        loose turn), v, w.
        """
        kept = self.motion.kept(joint)
        passage = self.motion.passage(joint, self.poses[joint.parent], self.values)
        idle = (
            len(joint.turning) == 3 and not {(joint.name, k) for k in joint.turning} & self.active
        )
        for k, u in zip(kept, passage.directions, strict=True):
            axis = self.motion.axes[joint.name][k]
            if not (idle and axis.turns):
                yield k, u * axis.slide, u if axis.turns else u * 0
        if idle:
            # Three turns, whatever their axes: no moment about any, so that nothing is singular
            # where axes meet.
            for e in np.eye(3):
                yield None, e * 0, e

    def given(self) -> list[Acting]:
        """Loads, springs and dampers."""
        found = []
        for load in self.mechanism.loads:
            pose = self.poses[load.body]
            force, torque = vector(load.force), vector(load.torque)
            if load.turning:
                force, torque = pose.R @ force, pose.R @ torque
            found.append(Acting(load.body, pose.at(vector(load.point)), force, torque))
        for spring in self.mechanism.springs:
            (a, at_a), (b, at_b) = ((name, vector(point)) for name, point in spring.ends)
            way = self.poses[b].at(at_b) - self.poses[a].at(at_a)
            length = math.sqrt(way @ way)
            speed = (self.poses[b].velocity(at_b) - self.poses[a].velocity(at_a)) @ way / length
            tension = float(spring.stiffness) * (length - float(spring.free))
            tension += float(spring.damping) * speed
            pull = way * (tension / length)
            found += [
                Acting(a, self.poses[a].at(at_a), pull, way * 0),
                Acting(b, self.poses[b].at(at_b), -pull, way * 0),
            ]
        for spread in self.mechanism.spreads:
            ends = float(spread.start), float(spread.end)
            found += shares(spread, self.poses[spread.body], *ends)
        return [one for one in found if one.body != GROUND]

    def passed(self, wrenches) -> list[Acting]:
        """What joints do to bodies."""
        found = []
        for joint in self.mechanism.joints:
            force, moment = wrenches[joint.name][:3], wrenches[joint.name][3:]
            at = self.point(joint)
            found += [
                Acting(joint.child, at, force, moment),
                Acting(joint.parent, at, -force, -moment),
            ]
        for tie in self.ties:
            found += [
                Acting(body, place, force * wrenches[tie.name], force * 0)
                for body, place, force in tie.forces
            ]
        return [one for one in found if one.body != GROUND]

    def inertia(self, body):
        """What a body needs: force, and moment about its centre; and that centre's place."""
        pose, (mass, centre, inertia) = self.poses[body.name], body.inertias()
        inertia = pose.R @ inertia @ pose.R.T
        force = (pose.acceleration(centre) - vector(self.mechanism.gravity)) * mass
        return force, inertia @ pose.alpha + cross(pose.w, inertia @ pose.w), pose.at(centre)

    def solve(self) -> Wrenches:
        """The wrenches of all joints.

        Raises :class:`spatial_algebra.InconsistentError` where no forces balance the bodies.
        """
        joints = self.mechanism.joints
        bodies = self.mechanism.bodies
        size = self.mechanism.size
        needs = {b.name: self.inertia(b) for b in bodies}
        row = {b.name: 6 * i for i, b in enumerate(bodies)}
        width = 6 * len(joints) + len(self.ties)
        matrix = np.zeros((6 * len(bodies), width))
        right = np.concatenate([x for b in bodies for x in needs[b.name][:2]])
        for i, joint in enumerate(joints):
            for name, sign in ((joint.child, 1), (joint.parent, -1)):
                if name != GROUND:
                    block = matrix[row[name] : row[name] + 6, 6 * i : 6 * i + 6]
                    block[:3, :3] += np.eye(3) * sign
                    block[3:, 3:] += np.eye(3) * sign
                    block[3:, :3] += skew(self.point(joint) - needs[name][2]) * sign
        for c, tie in enumerate(self.ties, 6 * len(joints)):
            for name, place, force in tie.forces:
                matrix[row[name] : row[name] + 3, c] += force
                matrix[row[name] + 3 : row[name] + 6, c] += cross(place - needs[name][2], force)
        for one in self.given():
            r = row[one.body]
            right[r : r + 3] -= one.force
            right[r + 3 : r + 6] -= one.moment + cross(one.place - needs[one.body][2], one.force)
        powers, units = [], []
        for i, joint in enumerate(joints):
            for k, v, w in self.twists(joint):
                if (joint.name, k) not in self.pushed:
                    line = np.zeros(width)
                    line[6 * i : 6 * i + 3], line[6 * i + 3 : 6 * i + 6] = v, w
                    for c, tie in enumerate(self.ties, 6 * len(joints)):
                        line[c] = -tie.terms.get((joint.name, k), 0.0)
                    powers.append(line)
                    units.append(size if any(w) else 1.0)
        matrix = np.concatenate([matrix, *(line[None] for line in powers)])
        right = np.concatenate([right, np.zeros(len(powers))])
        columns = np.array(([1.0] * 3 + [size] * 3) * len(joints) + [size] * len(self.ties))
        rows = np.array(([1.0] * 3 + [size] * 3) * len(bodies) + units)
        factored = Factored.of(matrix, rows, columns)
        found = factored.solve(right, "the spatial oracle's forces do not balance its bodies")

        def named(column):
            multipliers = {tie.name: column[c] for c, tie in enumerate(self.ties, 6 * len(joints))}
            return {j.name: column[6 * i : 6 * i + 6] for i, j in enumerate(joints)} | multipliers

        return Wrenches(named(found), [named(columns * column) for column in factored.null.T])

    def split(self, joint: Joint, wrenches):
        """The efforts of a joint's pushed axes by index, and its reaction without them and
        couplings, of what all joints pass.
        """
        wrench = wrenches[joint.name]
        force, moment, efforts = wrench[:3], wrench[3:], {}
        twists = {k: (v, w) for k, v, w in self.twists(joint) if k is not None}
        for k, (v, w) in twists.items():
            if (joint.name, k) not in self.active:
                continue
            power = wrench[:3] @ v + wrench[3:] @ w
            if (joint.name, k) in self.pushed:
                coupled = [
                    tie.terms.get((joint.name, k), power * 0) * wrenches[tie.name]
                    for tie in self.ties
                ]
                efforts[k] = power - sum(coupled, power * 0)
            if k not in joint.turning:
                force = force - v * power
            elif len(joint.turning) < 3:
                moment = moment - w * power
            else:
                # A couple that does its power on this turn and none on the two others.
                _, b, c = (
                    twists[joint.turning[(joint.turning.index(k) + i) % 3]][1] for i in range(3)
                )
                across = cross(b, c)
                moment = moment - across * (power / (across @ w))
        return efforts, np.concatenate([force, moment])
