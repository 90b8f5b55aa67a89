"""An independent solution of mechanisms in space: Newton-Euler on free bodies.

It imports nothing of the package. :mod:`spatial_bodies` says how a mechanism is told,
:mod:`spatial_motion` finds how it moves, :mod:`spatial_balance` what its joints pass,
:mod:`spatial_sections` what is inside its rods. A swinging rod:

    rod = Rod("rod", 0.6, [1.5]) found = solve(Mechanism([rod], [Joint("pin", "revolute", "ground",
    "rod")]), {("pin", 0): ("0.2", 8, 10)}) found.efforts["pin", 0],
    found.reactions["pin"], found.sections["rod"].at("0.25"), found.open

An effort's power is the effort times its coordinate's rate. A screw's effort is a couple; that of
one of three turns is a couple that has no power on the two others.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from spatial_algebra import vector
from spatial_balance import Balance, Wrenches
from spatial_bodies import Mechanism, Rod
from spatial_motion import Motion, Pose, solve_motion
from spatial_sections import Section

REACTION = ("fx", "fy", "fz", "mx", "my", "mz")
SECTION = ("axial", "shear_y", "shear_z", "torsion", "bending_y", "bending_z")
_OPEN = 1e-7


@dataclass(frozen=True)
class Result:
    """Everything at one instant.

    ``coordinates`` are (q, q', q'') by (joint, index), of all that are followed; ``efforts`` by
    (joint, index); ``reactions`` six numbers by joint: force and moment of the parent on the child,
    ground axes, about the child's point, without efforts and couplings; ``multipliers`` by coupling
    or row, which act on its coordinates as efforts, times its coefficients, and on its points as
    forces; ``sections`` by rod.

    ``idle`` are the motions that the drives leave open, six a body (v, w) in columns. Numbers that
    are ``open`` are one choice of many.
    """

    poses: dict[str, Pose]
    coordinates: dict
    efforts: dict
    reactions: dict[str, np.ndarray]
    multipliers: dict
    sections: dict[str, Section]
    idle: dict[str, np.ndarray]
    balance: Balance
    wrenches: Wrenches

    @property
    def size(self) -> float:
        return self.balance.mechanism.size

    @property
    def units(self) -> np.ndarray:
        """Of forces and moments."""
        return np.array([1.0] * 3 + [self.size] * 3)

    @cached_property
    def open(self) -> set:
        """What is open: (joint, member) of reactions, (joint, index) of efforts, and (name,
        "multiplier").
        """
        sizes = dict.fromkeys(((name, "multiplier") for name in self.multipliers), 0.0)
        for way in self.wrenches.null:
            for name in self.multipliers:
                sizes[name, "multiplier"] += float(way[name] / self.size) ** 2
            for joint in self.balance.mechanism.joints:
                efforts, reaction = self.balance.split(joint, way)
                parts = dict(zip(REACTION, reaction / self.units, strict=True))
                for member, x in (parts | {k: x / self.size for k, x in efforts.items()}).items():
                    key = (joint.name, member)
                    sizes[key] = sizes.get(key, 0.0) + float(x) ** 2
        return {key for key, size in sizes.items() if size > _OPEN**2}

    def open_section(self, rod: str, xi) -> tuple[bool, ...]:
        """Which of a section's six forces are open."""
        ways = [
            replace(self.sections[rod], acting=_on(rod, self.balance.passed(way)))
            for way in self.wrenches.null
        ]
        found = np.array([one.at(xi, weight=False) for one in ways], float).reshape(-1, 6)
        return tuple(bool(x) for x in np.linalg.norm(found / self.units, axis=0) > _OPEN)


def _on(body, acting):
    return [one for one in acting if one.body == body]


def solve(mechanism: Mechanism, drives, guess=None, pushed=None) -> Result:
    """One instant.

    ``drives`` are (q, q', q'') by (joint, index), ``pushed`` the keys that bear efforts, by default
    the same.

    The ``guess`` holds poses (place, axes as a 3x3 matrix of columns) by body's name and
    coordinates by (joint, index); what is missing follows through the joints from coordinates at
    zero. Raises :class:`spatial_motion.OpenLoopError` or
    :class:`spatial_algebra.InconsistentError`.
    """
    pushed = frozenset(drives if pushed is None else pushed)
    motion = Motion(mechanism, drives, pushed)
    poses, values, factored = solve_motion(motion, drives, guess or {})
    balance = Balance(motion, poses, values, pushed)
    wrenches = balance.solve()
    acting = balance.given() + balance.passed(wrenches.found)
    gravity = vector(mechanism.gravity)
    sections = {
        rod.name: Section(rod, poses[rod.name], gravity, _on(rod.name, acting))
        for rod in mechanism.bodies
        if isinstance(rod, Rod)
    }
    efforts, reactions = {}, {}
    for joint in mechanism.joints:
        own, reactions[joint.name] = balance.split(joint, wrenches.found)
        efforts |= {(joint.name, k): effort for k, effort in own.items()}
    units = np.array([mechanism.size] * 3 + [1.0] * 3)[:, None]
    return Result(
        {b.name: poses[b.name] for b in mechanism.bodies},
        values,
        efforts,
        reactions,
        {tie.name: wrenches.found[tie.name] for tie in balance.ties},
        sections,
        {name: units * factored.null[c : c + 6] for name, c in motion.column.items()},
        balance,
        wrenches,
    )
