"""Angles that loads see with their turns: springs that go on past half a turn, phases after many
turns, and turns that nothing tells.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from mechanisms import (
    DAMPING,
    DRAG_LINK,
    FREE,
    STIFFNESS,
    coil,
    sprung,
)

from lagrange_casadi import Mechanism, Scene, derive, evaluate, prepare
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.mark.sampled(7)
@pytest.mark.parametrize("joint", ["A", "B", "C"])
@pytest.mark.parametrize("kind", [{}, DRAG_LINK], ids=["crank_rocker", "drag_link"])
def test_a_torsion_spring_goes_on_past_half_a_turn(kind, joint):
    """Two turns: of a crank-rocker the crank's joint goes round, of a drag link both joints at the
    ground do.
    """
    solution = evaluate(sprung(joint, **kind))
    torque, angle = solution.series[f"load:coil_{joint}:mz"], solution.motion(joint)
    np.testing.assert_allclose(
        torque, -STIFFNESS * (angle.value - FREE) - DAMPING * angle.rate, rtol=0, atol=1e-12
    )
    rounds = (angle.value[-1] - angle.value[0]) / math.tau
    assert rounds == pytest.approx(
        {("A", False): -2.0, ("C", True): 2.0}.get((joint, kind == DRAG_LINK), 0.0), abs=1e-12
    )


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
    solution, other = (
        evaluate(whitworth(direction=told), t=(0.0, 2.0, 5)) for told in (False, True)
    )
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
    for count, told in ((65, True), (2, False)):
        refused = prepare(led(0.8), t=(0.0, 0.8, count)).designs([[]]).status.any()
        assert told is not bool(refused)
