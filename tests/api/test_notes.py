"""Points that slide beyond the end of a link: the forces are those of a bracket, in every program,
and it is said.
"""

import math

import numpy as np
import pytest
from balance import assert_balanced
from internals import DesignEngine, EvaluationMethod
from mechanisms import bracket

from lagrange_casadi import Mechanism, Scene, evaluate, load, save
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def slotted(x=0.05):
    """A crank's pin in the slot of a rocker that is too short for it."""
    m = Mechanism("slotted")
    a, b = m.link("a", length=0.1, mass=0.3), m.link("b", length=0.32, mass=0.5)
    m.revolute("O", m.ground, a)
    m.revolute("Q", m.ground.at(x, -0.3), b)
    m.slot("S", b, a.tip)
    return Scene(m, {"O": polynomial(0.2, 6.0)}, posture={"b": 1.5}, t=(0.0, 1.1, 111))


def test_it_is_said_which_joint_leaves_when_and_how_far():
    (note,) = evaluate(bracket()).notes
    assert note.startswith(
        "joint 'S' leaves link 'arm' at t = 0.05 s (xi/l from -1.3 to 2.3); beyond the end of the"
        " link the joint's force acts on that end"
    )
    # The pivot is 0.3041 m from the crank's.
    (note,) = evaluate(slotted()).notes
    assert note.startswith(
        "joint 'S' leaves link 'b' at t = 0 s (xi/l from 0.6379 to 1.263); beyond the end of the"
        " link the joint's force acts on that end"
    )
    assert evaluate(bracket(reach=0.2)).notes == ()


@pytest.mark.parametrize("wanted", [["motion"], ["section:arm"], ["all"]])
def test_it_is_said_by_what_there_is(wanted):
    (note,) = evaluate(bracket(), wanted=wanted).notes
    assert "xi/l from -1.3 to 2.3" in note
    assert evaluate(bracket(), wanted=["effort"]).notes == ()


def test_an_end_missed_by_rounding_is_no_leaving():
    m = Mechanism("m")
    arm, p = m.link("arm", length=0.3, mass=1.0), m.point_mass("p", 2.0)
    m.revolute("J", m.ground, arm)
    m.prismatic("S", arm, p, axis=(1, 0))
    assert evaluate(Scene(m, {"J": polynomial(0, 1), "S": polynomial(0.1 + 0.2)})).notes == ()


def test_a_file_tells_it_again(tmp_path):
    solution = evaluate(bracket())
    save(solution, tmp_path / "bracket.h5")
    assert load(tmp_path / "bracket.h5").notes == solution.notes != ()


@pytest.mark.parametrize("t", [0.0, 0.25, 0.5, 0.75, 1.0])
@pytest.mark.parametrize("scene", [bracket, slotted])
def test_forces_beyond_the_ends_are_those_of_newton(scene, t):
    """At 1/4 of the period it is beyond the tip, at 3/4 before the base."""
    assert_balanced(scene(), t=t)


def test_nothing_vanishes_before_the_base_or_beyond_the_tip():
    """The arm's weight and the mass's: a lever of 1.15 m beyond a tip at 0.5 m, one of 0.65 m
    before the base.
    """
    m = Mechanism("still")
    arm, p = m.link("arm", length=0.5, mass=0.0), m.point_mass("p", 2.0)
    m.revolute("J", m.ground, arm.at(0.1))
    m.prismatic("S", arm, p, axis=(1, 0))
    scene = Scene(
        m,
        {"J": polynomial(0.0), "S": harmonic(0.25, 0.9, 0.0, math.pi / 2)},
        t=(0, 1, 2),
        xi=(0, 1, 11),
    )
    section, weight = evaluate(scene).section("arm"), 2.0 * 9.81
    u = np.linspace(0, 1, 11)
    inside = u >= 0.2  # the joint bears it there
    np.testing.assert_allclose(section.shear[0], np.where(inside, -weight, 0.0), atol=1e-12)
    np.testing.assert_allclose(
        section.bending[0], np.where(inside, -weight * (1.15 - 0.5 * u), 0.0), atol=1e-12
    )
    before = Scene(
        m,
        {"J": polynomial(0.0), "S": harmonic(0.25, -0.9, 0.0, math.pi / 2)},
        t=(0, 1, 2),
        xi=(0, 1, 11),
    )
    section = evaluate(before).section("arm")
    # The mass hangs from the base: between it and the joint the arm bears it, beyond nothing.
    np.testing.assert_allclose(section.shear[0], np.where(inside, 0.0, weight), atol=1e-12)
    np.testing.assert_allclose(
        section.bending[0], np.where(inside, 0.0, -weight * (0.65 + 0.5 * u)), atol=1e-12
    )


@pytest.mark.sampled(7)
@pytest.mark.parametrize("backend", ["auto", "c", "vm"])
@pytest.mark.parametrize("scene", [bracket, slotted])
def test_designs_have_the_peaks_of_the_api(scene, backend):
    given = scene()
    solution = evaluate(given, t=(0.0, 1.0, 2001))
    engine = DesignEngine.of(given, None, None, EvaluationMethod(backend))
    found = engine.evaluate(np.array([list(given.mechanism.values().values())]))
    peaks = dict(zip(engine.quantities, np.abs(found.value[0]), strict=True))
    sections = [name for name in peaks if name.startswith("section:")]
    assert sections
    for name in sections:
        peak = abs(solution.peak(name).value)
        assert peaks[name] == pytest.approx(peak, rel=2e-4)
        assert peaks[name] >= peak * (1 - 1e-9)
