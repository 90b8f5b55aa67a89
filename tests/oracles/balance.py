"""A scene beside the oracle: what links the package's declarations to it, and every force of both
compared.
"""

from __future__ import annotations

import bisect

import casadi as ca
import numpy as np
import oracle
from mechanisms import INSTANT

from lagrange_casadi import derive, evaluate

TOLERANCE = 1e-12


def assert_balanced(scene, t=INSTANT, **beside):
    """An instant of a scene has all that the oracle has, forces relative to the largest force.

    ``beside`` goes to the oracle: loads and extras.
    """
    m, program = scene.mechanism, derive(scene)
    values = m.values()
    found, drives = columns_at(program, t, values)
    model = oracle_of(m, values, pushed=scene.drives and list(scene.drives), **beside)
    solved = model.solve(drives, postures(m, found, drives, 0.02))
    size = max((abs(x) for forces in solved.reactions.values() for x in forces), default=0.0) or 1.0
    gaps = {
        f"effort:{joint}": (found[f"effort:{joint}"] - effort) / size
        for joint, effort in solved.efforts.items()
    }
    for name, multiplier in solved.multipliers.items():
        gaps[f"multiplier:{name}"] = (found[f"multiplier:{name}"] - multiplier) / size
    for joint, forces in solved.reactions.items():
        for member, force in zip(("fx", "fy", "mz"), forces, strict=True):
            name = f"reaction:{joint}:{member}"
            gaps[name] = (found.get(name, 0.0) - force) / size
    for body in m.moving:
        q = solved.q[body.name]
        gaps[f"{body.name} x"] = found[f"pose:{body.name}:x"] - q[0].v
        gaps[f"{body.name} y"] = found[f"pose:{body.name}:y"] - q[1].v
    solution = evaluate(scene, t=(t, t, 1), backend="vm")
    for link in solution.links_with_sections:
        law = solution.section(link).law
        for u in (0.0, 0.1234567, 0.3719283, 0.5012345, 0.8176543, 0.9034567, 1.0):
            for k, force in enumerate(("axial", "shear", "bending")):
                mine = law.at(force, np.array([[u]]))[0, 0]
                gaps[f"{force} of {link} at {u}"] = (mine - solved.sections[link](u)[k]) / size
    assert not {name: gap for name, gap in gaps.items() if not abs(gap) < TOLERANCE}


def columns_at(program, t, values):
    """A graph's columns at an instant, by name, and its drives
    as (coordinate, rate, acceleration).
    """
    p = list(values.values())
    driven = np.array([x.full().ravel() for x in program.motion(t, p)])
    found = (
        program.instant(t, *driven, settle(program, t, p, program.data.span[0]), p).full().ravel()
    )
    return dict(zip(program.names, found, strict=True)), {
        joint: tuple(driven[:, i]) for i, joint in enumerate(program.driven)
    }


def postures(m, found, drives, nudge):
    """Rough (x, y, angle) of every body, off by ``nudge`` from a graph's columns."""
    size = (
        max(abs(v) for k, v in found.items() if k.startswith("pose:") and not k.endswith("angle"))
        or 1.0
    )
    at = {
        b.name: (
            found[f"pose:{b.name}:x"] + nudge * size / 5,
            found[f"pose:{b.name}:y"] - nudge * size / 5,
            found.get(f"pose:{b.name}:angle", 0.0) + nudge,
        )
        for b in m.moving
    }
    # Where a drive from the ground counts turns, so must the oracle's guess.
    ends = {joint: m.joints[joint] for joint in drives}
    turned = {
        joint.child.body.name: drives[name][0]
        for name, joint in ends.items()
        if joint.parent.body is m.ground and f"pose:{joint.child.body.name}:angle" in found
    }
    return {body: (x, y, turned.get(body, angle)) for body, (x, y, angle) in at.items()}


def instant_at(program, t, p=()):
    """Every column of a graph without iteration at an instant."""
    return program.instant(t, *program.motion(t, p), [], p)


def settle(program, t, p, start):
    """The iterated coordinates at an instant, followed from the start of the motion."""
    z = ca.DM(program.newton.guess if program.newton else [])
    for moment in np.linspace(start, t, 40) if program.newton else []:
        for _ in range(20):
            z += program.newton.step(z, moment, program.motion(moment, p)[0], p)[0]
    return z


def oracle_of(m, values, **beside):
    """The oracle of a mechanism: its numbers, and nothing else of the package."""

    def number(expression):
        return m.number(expression, values)

    def point(p):
        return p.body.name, number(p.x), number(p.y)

    def body(b):
        if b.name not in m.links:
            return oracle.Body(b.name, number(b.mass), oriented=False)
        if hasattr(b.mass, "centre"):
            centre = tuple(number(c) for c in b.mass.centre[:2])
            return oracle.Body(
                b.name, number(b.mass.mass), number(b.length), centre, number(b.mass.inertia[2][2])
            )
        length, breaks = number(b.length), [number(ratio) for ratio in b.mass.breaks]
        cells = [
            [number(c) * (length if b.mass.per_length else 1.0) for c in cell]
            for cell in b.mass.cells
        ]

        def density(u):
            i = min(max(bisect.bisect_right(breaks, u) - 1, 0), len(cells) - 1)
            return sum(c * u**j for j, c in enumerate(cells[i]))

        return oracle.from_density(b.name, length, density, breaks)

    joints = [
        oracle.Joint(
            j.name,
            j.kind,
            point(j.parent),
            point(j.child),
            tuple(map(number, j.triad[0][:2])),
            number(j.turned.angle),
        )
        for j in m.joints.values()
    ]
    gravity = (number(m.gravity[0]), number(m.gravity[1]))
    return oracle.Oracle([body(b) for b in m.moving], joints, gravity, **beside)
