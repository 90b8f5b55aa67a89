"""Contacts with the ground: closed forms, and where they pull or slide."""

import numpy as np
import pytest
from mechanisms import standing_rod

from lagrange_casadi import Mechanism, Scene, evaluate, optimise
from lagrange_casadi.errors import AssemblyError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


def test_a_contact_bears_what_moves_the_centre():
    solution = evaluate(standing_rod(), parameters={"pull": 3.0})
    angle, rate, acceleration = np.pi / 3 - solution.t**2, -2.0 * solution.t, -2.0
    c, s = np.cos(angle), np.sin(angle)
    across = -(acceleration * s + rate**2 * c)  # with 2 kg at 0.5 m
    normal = acceleration * c - rate**2 * s + 2.0 * 9.81 - 3.0
    assert solution.output("foot_normal") == pytest.approx(normal, rel=1e-13)
    margin = (0.5 * normal - np.abs(across)) / np.sqrt(1.25)
    assert solution.output("foot_margin") == pytest.approx(margin, rel=1e-12)


LOST = r"contact 'foot' {} at t = 0 s, where foot = 1.0472 rad \(60 deg\): its {} N"


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"mu": 0.05}, LOST.format("slides", "force is outside the cone of friction by 0.8001")),
        ({"pull": 30.0}, LOST.format("pulls", "normal force is -11.38")),
    ],
)
def test_a_lost_contact_is_refused_where_forces_are_wanted(given, says):
    with pytest.raises(AssemblyError, match=says):
        evaluate(standing_rod(), wanted=["effort"], parameters=given)
    assert evaluate(standing_rod(), wanted=["motion"], parameters=given).certified


def test_a_contact_that_equilibrium_leaves_open_is_not_judged():
    """How two feet push along the line between them is open, also where nothing else does."""
    m = Mechanism("table")
    top = m.link("top", length=1.0, mass=2.0)
    m.contact("left", top, friction=0.0, at=(0.0, 0.0))
    m.contact("right", top.tip, friction=0.0, at=(1.0, 0.0))
    m.output("square", m.results.reaction(m.joints["left"])[0] ** 2)
    m.torque("turn", top, m.parameter("turning", 5.0, "N m"))
    scene = Scene(m, {}, posture={"top": 0.0})
    solution = evaluate(scene)
    assert solution.output("left_normal") == pytest.approx(9.81 + 5.0)
    assert np.isnan([solution.output("left_margin"), solution.output("square")]).all()
    with pytest.raises(AssemblyError, match="contact 'left' pulls"):
        evaluate(scene, parameters={"turning": -10.0})


def test_no_search_calls_a_design_an_optimum_beside_those_whose_contacts_slide():
    """Of a parameter alone no force is asked for, and contacts are judged all the same."""
    asked = {"minimise": "mu", "over": {"mu": (0.01, 1.0)}, "starts": 1, "screen": 8}
    found = optimise(standing_rod(), **asked)
    assert not found.converged
    assert found.start.ending == "a design beside it fails: a contact pulls or slides"
    limited = optimise(standing_rod(), **asked, subject_to=["min:output:foot_margin >= 0"])
    assert limited.converged
    assert limited.objective == pytest.approx(found.objective, rel=1e-3)
