"""Angles that loads see with their turns, against vector Newton-Euler that is followed from the
start in small steps. The oracle carries directions as numbers that go on continuously: it
counts turns by having been there.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from balance import columns_at, oracle_of, postures
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanisms import (
    DAMPING,
    DRAG_LINK,
    FREE,
    STIFFNESS,
    coil,
    sprung,
)

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

SMALL = 0.05


class Coil:
    """The same spring for the oracle; its angle starts in (-pi, pi]."""

    def __init__(self, joint):
        self.child, self.parent = (
            (p.body.name, float(p.x), float(p.y)) for p in (joint.child, joint.parent)
        )
        self.turns = None

    def __call__(self, place):
        child, parent = place(self.child)[2], place(self.parent)[2]
        bend = child - parent
        if self.turns is None:
            self.turns = -math.ceil(bend.v / math.tau - 0.5)
        couple = -STIFFNESS * (bend.v + math.tau * self.turns - FREE) - DAMPING * bend.d
        return [(self.child, 0.0, 0.0, couple), (self.parent, 0.0, 0.0, -couple)]


def assert_followed(scene, joints, count=5, **keywords):
    """Efforts, reactions, section forces and springs at some instants, with the oracle followed to
    them.
    """
    m, (start, stop, _) = scene.mechanism, scene.t
    values = m.values(keywords.get("parameters"))
    solution = evaluate(scene, t=(start, stop, count), **keywords)
    program = derive(scene)
    oracle = oracle_of(m, values, loads=[Coil(m.joints[joint]) for joint in joints])
    found, drives = columns_at(program, start, values)
    guess, before, worst = postures(m, found, drives, 0.02), start, 0.0
    for joint, (drive, *_) in drives.items():
        parent, child = (guess.get(body.name, (0.0, 0.0, 0.0)) for body in m.joints[joint].bodies)
        if m.joints[joint].coordinate == "angle":
            # The oracle wants the drive's turns between its two bodies.
            turns = round((parent[2] + drive - child[2]) / math.tau)
            guess[m.joints[joint].child.body.name] = (*child[:2], child[2] + math.tau * turns)
    size = max(
        np.abs(solution.reaction(name).fx).max() + np.abs(solution.reaction(name).fy).max()
        for name in m.joints
    )
    for i, t in enumerate(solution.t):
        fast = max(
            abs(rate)
            for moment in (before, t)
            for rate in program.motion(moment, list(values.values()))[1].full().ravel()
        )
        for step in np.linspace(before, t, 2 + int(fast * (t - before) / SMALL))[1:] if i else [t]:
            d = [x.full().ravel() for x in program.motion(step, list(values.values()))]
            drives = {joint: tuple(row[k] for row in d) for k, joint in enumerate(program.driven)}
            # On the way the motion is enough.
            solved = oracle.solve(drives, guess) if step == t else oracle.move(drives, guess)
            guess = {body: tuple(x.v for x in q) for body, q in solved.q.items()}
        before = t
        gaps = [solution.effort(joint)[i] - effort for joint, effort in solved.efforts.items()]
        for name, (fx, fy, _) in solved.reactions.items():
            gaps += [solution.reaction(name).fx[i] - fx, solution.reaction(name).fy[i] - fy]
        for link in solution.links_with_sections:
            law = solution.section(link).law
            for u in (0.0, 0.37, 0.81):
                forces = zip(("axial", "shear", "bending"), solved.sections[link](u), strict=True)
                gaps += [
                    law.at(force, np.full((count, 1), u))[i, 0] - true for force, true in forces
                ]
        worst = max(worst, *map(abs, gaps))
    assert worst < 1e-10 * size
    return solution


@pytest.mark.sampled(7)
@pytest.mark.parametrize("joint", ["A", "B", "C"])
@pytest.mark.parametrize("kind", [{}, DRAG_LINK], ids=["crank_rocker", "drag_link"])
def test_a_torsion_spring_goes_on_past_half_a_turn(kind, joint):
    """Two turns: of a crank-rocker the crank's joint goes round, of a drag link both joints at the
    ground do.
    """
    scene = sprung(joint, **kind)
    solution = assert_followed(scene, joint)
    angle = solution.motion(joint)
    fine = evaluate(scene)
    torque, angle = fine.series[f"load:coil_{joint}:mz"], fine.motion(joint)
    np.testing.assert_allclose(
        torque, -STIFFNESS * (angle.value - FREE) - DAMPING * angle.rate, rtol=0, atol=1e-12
    )
    rounds = (angle.value[-1] - angle.value[0]) / math.tau
    assert rounds == pytest.approx(
        {("A", False): -2.0, ("C", True): 2.0}.get((joint, kind == DRAG_LINK), 0.0), abs=1e-12
    )


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_random_four_bars(seed):
    """Whatever goes round, from whatever posture, in either branch, backwards too: right, or the
    loop does not close.
    """
    generator = np.random.default_rng(seed)
    lengths, frame = generator.uniform(0.1, 0.5, 3), generator.uniform(-0.4, 0.4, 2)
    rate, start = generator.uniform(-9.0, 9.0), generator.uniform(-20.0, 20.0)
    joints = generator.choice(["A", "B", "C"], generator.integers(1, 4), replace=False).tolist()
    scene = sprung(
        joints,
        tuple(lengths),
        tuple(frame),
        generator.uniform(-3.0, 3.0),
        polynomial(start, rate),
        count=201,
    )
    try:
        evaluate(scene, backend="vm")
    except (AssemblyError, DeclarationError) as error:
        if not any(
            words in str(error)
            for words in ("cannot be closed", "dead centre", "assembled in two ways")
        ):
            raise
        return
    assert_followed(scene, joints, count=3)


def whitworth(direction=False):
    """A crank's pin in the slot of a link whose pivot lies within the crank's circle: the slotted
    link goes all the way round.
    """
    m = Mechanism("whitworth")
    a, b = m.link("a", length=0.3, mass=0.3), m.link("b", length=0.6, mass=0.5)
    m.revolute("O", m.ground, a)
    pivot = m.revolute("Q", m.ground.at(0.12, -0.05), b)
    m.slot("S", b, a.tip)
    if direction:
        m.torque("coil_Q", b, -STIFFNESS * (m.direction(b) - FREE) - DAMPING * m.rate(pivot))
    else:
        coil(m, "Q")
    return Scene(m, {"O": polynomial(0.4, 5.0)}, posture={"b": 0.7}, t=(0.0, 2.0, 101))


def test_a_link_s_direction_counts_as_its_joint_at_the_ground():
    solution = assert_followed(whitworth(), "Q")
    other = evaluate(whitworth(direction=True), t=(0.0, 2.0, 5))
    np.testing.assert_allclose(other.effort("O"), solution.effort("O"), rtol=1e-13)
    assert np.ptp(solution.motion("Q").value) > 2.5 * math.pi


@pytest.mark.parametrize("precision", ["double", "single"])
def test_many_turns_keep_their_phase(precision):
    """A spring that only swings, between links that go round a million times: no digit is lost on
    how many.
    """
    near, far = (
        sprung("B", law=polynomial(start, 9.0), **DRAG_LINK) for start in (0.2, 0.2 + 2e6 * math.pi)
    )
    graphs = [derive(scene, ["load:coil_B"]) for scene in (near, far)]
    assert all("_turned:B" in program.names for program in graphs)
    one, other = (
        evaluate(scene, wanted=["load:coil_B"], precision=precision).series["load:coil_B:mz"]
        for scene in (near, far)
    )
    np.testing.assert_allclose(other, one, rtol=0, atol=1e-5 if precision == "single" else 1e-8)


def led(span):
    """Two slides lead a pin round the pivot of a slotted link: it goes round, and no drive does."""
    m = Mechanism("led")
    carriage = m.link("carriage", length=0.1, mass=1.0)
    pin = m.point_mass("pin", 1.0)
    b = m.link("b", length=0.6, mass=0.5)
    m.prismatic("X", m.ground, carriage, axis=(1, 0))
    m.prismatic("Y", carriage, pin, axis=(0, 1))
    m.revolute("Q", m.ground, b)
    m.slot("S", b, pin)
    coil(m, "Q")
    motion = {"X": harmonic(0.0, 0.3, 1.0, math.pi / 2), "Y": harmonic(0.0, 0.3, 1.0)}
    return Scene(m, motion, posture={"b": 0.0}, t=(0.0, span, 65))


def test_an_angle_whose_turns_nothing_tells_is_refused():
    """A part of a turn is no turn; and beyond what the scene showed nothing is known."""
    solution = evaluate(led(0.7))
    assert solution.motion("Q").value[-1] == pytest.approx(0.7 * math.tau)
    np.testing.assert_allclose(
        solution.series["load:coil_Q:mz"],
        -STIFFNESS * (0.7 * math.tau * np.linspace(0, 1, 65) - FREE) - DAMPING * math.tau,
    )
    with pytest.raises(
        AssemblyError,
        match=r"the angle of 'Q', on whose number of revolutions a load depends, is -?1\d\d deg",
    ):
        evaluate(led(0.7), t=(0.0, 2.0, 201))
    with pytest.raises(
        DeclarationError,
        match=(
            "load 'coil_Q': the angle of 'Q' enters with its number of revolutions, which cannot"
            " be determined"
        ),
    ):
        evaluate(led(1.5))
    evaluate(led(1.5), wanted=["motion"])
