"""Screws: what counts their turns carries them, and what would close a loop is refused."""

import math

import pytest

from lagrange_casadi import Scene, SpatialMechanism, derive, evaluate
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

MASS, LEAD, G = 50.0, 0.01, 9.81


def jack():
    """A spindle that turns upright, and a nut that is guided and lifted by it."""
    m = SpatialMechanism("jack")
    spindle = m.link(
        "spindle", length=0.3, mass=1.0, centre=(0.15, 0, 0), inertia=(1e-3, 1e-2, 1e-2)
    )
    nut = m.link("nut", length=0.1, mass=MASS, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.1))
    m.revolute("O", m.ground, spindle, turned=[("y", "-90 deg")])
    m.prismatic("guide", m.ground, nut, axis=(0, 0, 1))
    m.screw("thread", spindle, nut, axis=(1, 0, 0), lead=LEAD, turned=[("y", "90 deg")])
    return m


def test_a_guided_nut_is_lifted():
    """By virtual work the spindle's torque is the weight times the lead of a radian; the nut, which
    does not turn, runs back.
    """
    solution = evaluate(
        Scene(jack(), {"O": polynomial(0, 3.0)}, t=(0, 1, 11), posture={"thread": 0.0})
    )
    assert solution.effort("O") == pytest.approx(-MASS * G * LEAD / math.tau, rel=1e-12)
    assert solution.motion("guide").value[-1] == pytest.approx(-3.0 * LEAD / math.tau, rel=1e-12)
    assert solution.certified


def test_a_screw_that_would_close_a_loop_is_named():
    with pytest.raises(
        DeclarationError,
        match="joint 'thread' is a screw between bodies whose positions already follow from drives",
    ):
        derive(Scene(jack(), {"O": polynomial(0, 3.0), "guide": polynomial(0, 1.0)}))


@pytest.mark.parametrize("turns", [0.6, 3.2, -40.0])
def test_a_screw_counts_the_turns_of_what_turns_it(turns):
    """A loop tells its direction alone; many turns lift the nut by as many leads, at whatever
    instant one begins.
    """
    scene = Scene(
        jack(), {"O": polynomial(0.4, math.tau * turns)}, t=(0, 1, 5), posture={"thread": 0.0}
    )
    solution = evaluate(scene)
    assert solution.certified
    assert solution.motion("guide").value == pytest.approx(
        -LEAD * (0.4 / math.tau + turns * solution.t), abs=1e-14
    )
    assert solution.motion("thread").value == pytest.approx(
        -0.4 - math.tau * turns * solution.t, abs=1e-12
    )
    late = evaluate(scene, t=(0.75, 1.0, 2))
    assert late.motion("guide").value[0] == pytest.approx(
        solution.motion("guide").value[3], abs=1e-14
    )
