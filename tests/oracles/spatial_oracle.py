"""An independent solution of mechanisms in space: Newton-Euler on free bodies, in any number of
digits.

It imports nothing of the package. :mod:`spatial_bodies` says how a mechanism is told,
:mod:`spatial_motion` finds how it moves, :mod:`spatial_balance` what its joints pass,
:mod:`spatial_sections` what is inside its rods. A swinging rod, in 40 digits:

    rod = Rod("rod", 0.6, [1.5]) found = solve(Mechanism([rod], [Joint("pin", "revolute", "ground",
    "rod")]), {("pin", 0): ("0.2", 8, 10)}, digits=40) found.efforts["pin", 0],
    found.reactions["pin"], found.sections["rod"].at("0.25"), found.open

An effort's power is the effort times its coordinate's rate. A screw's effort is a couple; that of
one of three turns is a couple that has no power on the two others.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from spatial_algebra import arithmetic_of
from spatial_balance import Balance, Wrenches
from spatial_bodies import Mechanism, Rod
from spatial_motion import Motion, Pose, solve_motion
from spatial_sections import Section, section

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

    Known in doubles only: ``loose_reactions`` (six, n) are the n ways in which ideal joints leave a
    reaction open, ``loose_efforts`` (n) an effort, and ``loose_section(rod, xi)`` (six, n) a
    section's forces; ``idle`` are the motions that the drives leave open, six a body (v, w) in
    columns; ``steadiness`` is how far from singular the motion is; ``vague`` where a rank is not
    clear. Numbers that are open are one choice of many.
    """

    poses: dict[str, Pose]
    coordinates: dict
    efforts: dict
    reactions: dict[str, np.ndarray]
    multipliers: dict
    sections: dict[str, Section]
    loose_reactions: dict[str, np.ndarray]
    loose_efforts: dict
    loose_section: Callable
    idle: dict[str, np.ndarray]
    steadiness: float
    vague: bool
    size: float
    balance: Balance
    wrenches: Wrenches

    @property
    def open(self) -> set:
        """What is open: (joint, member) of reactions, (joint, index) of efforts, and (name,
        "multiplier").
        """
        unit = np.array([1.0] * 3 + [self.size] * 3)[:, None]
        found = set()
        for joint, ways in self.loose_reactions.items():
            found |= {
                (joint, m)
                for m, row in zip(REACTION, ways / unit, strict=True)
                if np.linalg.norm(row) > _OPEN
            }
        rows = self.loose_efforts | {
            (name, "multiplier"): np.array([float(way[name]) for way in self.wrenches.null])
            for name in self.multipliers
        }
        return found | {key for key, row in rows.items() if np.linalg.norm(row) > _OPEN * self.size}

    def open_section(self, rod: str, xi) -> tuple[bool, ...]:
        """Which of a section's six forces are open."""
        ways = self.loose_section(rod, xi) / np.array([1.0] * 3 + [self.size] * 3)[:, None]
        return tuple(bool(x) for x in np.linalg.norm(ways, axis=1) > _OPEN)


def solve(mechanism: Mechanism, drives, guess=None, digits=None, pushed=None) -> Result:
    """One instant.

    ``drives`` are (q, q', q'') by (joint, index), ``pushed`` the keys that bear efforts, by default
    the same.

    The ``guess`` holds poses (place, axes as a 3x3 matrix of columns) by body's name and
    coordinates by (joint, index); what is missing follows through the joints from coordinates at
    zero. Raises :class:`spatial_motion.OpenLoopError` or
    :class:`spatial_algebra.InconsistentError`.
    """
    arithmetic = arithmetic_of(digits)
    pushed = frozenset(drives if pushed is None else pushed)
    motion = Motion(mechanism, drives, arithmetic, pushed)
    poses, values, factored = solve_motion(motion, drives, guess or {})
    balance = Balance(motion, poses, values, pushed)
    wrenches = balance.solve()
    acting = balance.given() + balance.passed(wrenches.found)
    rods = [b for b in mechanism.bodies if isinstance(b, Rod)]
    sections = {
        rod.name: section(arithmetic, rod, poses[rod.name], mechanism.gravity, acting)
        for rod in rods
    }
    efforts, reactions, loose_efforts, loose_reactions = {}, {}, {}, {}
    for joint in mechanism.joints:
        own, reactions[joint.name] = balance.split(joint, wrenches.found)
        efforts |= {(joint.name, k): effort for k, effort in own.items()}
        ways = [_floats(*balance.split(joint, way)) for way in wrenches.null]
        loose_reactions[joint.name] = np.array([reaction for _, reaction in ways]).reshape(-1, 6).T
        loose_efforts |= {(joint.name, k): np.array([own[k] for own, _ in ways]) for k in own}

    def loose_section(rod, xi):
        bare = (
            section(arithmetic, sections[rod].rod, poses[rod], mechanism.gravity, balance.passed(w))
            for w in wrenches.null
        )
        return np.array([one.at(xi, weight=False).astype(float) for one in bare]).reshape(-1, 6).T

    units = np.array([mechanism.size] * 3 + [1.0] * 3)[:, None]
    return Result(
        poses={b.name: poses[b.name] for b in mechanism.bodies},
        coordinates=values,
        efforts=efforts,
        reactions=reactions,
        multipliers={tie.name: wrenches.found[tie.name] for tie in balance.ties},
        sections=sections,
        loose_reactions=loose_reactions,
        loose_efforts=loose_efforts,
        loose_section=loose_section,
        idle={name: units * factored.null[c : c + 6] for name, c in motion.column.items()},
        steadiness=factored.least,
        vague=factored.vague or wrenches.vague,
        size=mechanism.size,
        balance=balance,
        wrenches=wrenches,
    )


def _floats(efforts, reaction):
    return {k: float(x) for k, x in efforts.items()}, np.asarray(reaction, dtype=float)
