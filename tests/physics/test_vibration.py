"""Whether rigid links are enough: against the steady swing of a beam in many modes."""

import math

import numpy as np
import pytest
import strong
from internals import bending_modes_closed as closed

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    evaluate,
    load,
    save,
    vibration,
)
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

SHAPE = beams.rectangle(0.006, 0.02)


def shaken(rate, count=65):
    """A bar on two pins that a guide shakes up and down, over one swing."""
    m = Mechanism("shaken")
    m.set_gravity(0.0, 0.0)
    frame = m.link("frame", length=1.0, mass=1.0)
    bar = m.link("bar", length=1.0, beam=beams.Beam(SHAPE, strong.STEEL))
    foot = m.point_mass("foot", 0.0)
    m.prismatic("up", m.ground, frame, axis=(0, 1), angle=0)
    m.revolute("A", frame, bar)
    m.prismatic("slide", frame.tip, foot, axis=(1, 0))
    m.revolute("B", bar.tip, foot)
    return Scene(
        m,
        {"up": harmonic(0.0, 1e-3, rate)},
        posture={"bar": 0.0, "slide": 0.0},
        t=(0, 1 / rate, count),
    )


def natural():
    p = SHAPE.properties()
    return (
        closed(
            strong.STEEL.elasticity * p.iz, strong.STEEL.density * p.area, 1.0, ("pinned", "pinned")
        )
        / math.tau
    )


@pytest.mark.sampled(2)
@pytest.mark.parametrize("part", [0.05, 0.25, 0.31, 0.8, 1.6])
def test_a_bar_shaken_by_a_sine(part):
    """One harmonic alone: by swinging its bending is off by r^2/(1 - r^2)."""
    frequency = natural()
    found = vibration(evaluate(shaken(part * frequency), certificate=False), "bar")
    assert found.ends == ("pinned", "pinned")
    assert found.frequency == pytest.approx(frequency, rel=1e-6)
    assert found.lower == pytest.approx(frequency, rel=1e-4)
    assert found.cycle == pytest.approx(part * frequency)
    assert found.harmonic == 1
    assert found.excess == pytest.approx(abs(part**2 / (1 - part**2)), rel=1e-4)
    assert found.enough == (part in (0.05, 0.25))
    assert ("rigid links are not enough" in found.words) == (not found.enough)


def test_a_result_says_that_rigid_links_are_not_enough(tmp_path):
    """In its notes, which commands and pages show, where its deflection is wanted; a file that is
    read again says so too.
    """
    slow, fast = (
        evaluate(shaken(part * natural()), wanted=["deflection:bar"], certificate=False)
        for part in (0.05, 0.8)
    )
    assert slow.notes == ()
    (note,) = fast.notes
    assert note == f"link 'bar': {vibration(fast, 'bar').words}"
    assert "rigid links are not enough: harmonic 1" in note
    assert evaluate(shaken(0.8 * natural()), wanted=["section:bar"], certificate=False).notes == ()
    save(fast, tmp_path / "fast.h5")
    assert load(tmp_path / "fast.h5").notes == fast.notes


def test_a_span_of_two_swings_has_the_second_harmonic():
    frequency = natural()
    scene = shaken(0.2 * frequency)
    found = vibration(evaluate(scene, t=(0, 2 / (0.2 * frequency), 65), certificate=False), "bar")
    assert found.harmonic == 2
    assert found.excess == pytest.approx(0.04 / 0.96, rel=1e-4)


def test_what_is_no_cycle_is_told():
    scene = shaken(10.0)
    half = vibration(evaluate(scene, t=(0.0, 0.03, 65), certificate=False), "bar")
    assert half.excess is None
    assert half.enough is None
    assert "the last bending moment differs from the first" in half.words
    assert (
        "more instants" in vibration(evaluate(scene, t=(0, 0.1, 3), certificate=False), "bar").words
    )


def test_uneven_instants_are_told():
    m = Mechanism("swing")
    arm = m.link("arm", length=0.4, beam=beams.Beam(SHAPE, strong.STEEL))
    m.revolute("O", m.ground, arm)
    scene = Scene(m, {"O": polynomial(0.0, 1.0, 2.0)}, t=(0, 1, 3), over=("O", 0.0, 1.0, 9))
    assert "equally spaced instants" in vibration(evaluate(scene, certificate=False), "arm").words


def test_joints_tell_how_ends_are_held():
    press = evaluate(strong.press(SHAPE), certificate=False)
    assert vibration(press, "rod").ends == ("pinned", "pinned")
    arms = evaluate(strong.arms(), certificate=False)
    assert vibration(arms, "upper").ends == ("clamped", "guided")
    assert vibration(arms, "plate").ends == ("clamped", "free")
    assert (
        vibration(arms, "plate", ("clamped", "clamped")).frequency
        > vibration(arms, "plate").frequency
    )


def test_in_space_the_softer_plane_counts():
    m = SpatialMechanism("arm")
    arm = m.link("arm", length=0.8, beam=beams.Beam(beams.rectangle(0.03, 0.01), strong.STEEL))
    m.revolute("O", m.ground, arm, axis=(0, 0, 1))
    found = vibration(
        evaluate(Scene(m, {"O": harmonic(0.0, 1.0, 5.0)}, t=(0, 0.2, 65)), certificate=False), "arm"
    )
    p = beams.rectangle(0.03, 0.01).properties()
    soft = (
        closed(
            strong.STEEL.elasticity * p.iy, strong.STEEL.density * p.area, 0.8, ("clamped", "free")
        )
        / math.tau
    )
    assert found.ends == ("clamped", "free")
    assert found.frequency == pytest.approx(soft, rel=1e-6)
    # It is swung in its stiff plane, and its weight at rest bends the soft one: off by a few per
    # cent of what the stiff one says.
    assert 0.0 < found.excess < 0.05
    assert np.isfinite(found.excess)


def test_other_words_are_refused():
    with pytest.raises(
        DeclarationError,
        match="expected how base and tip are held, two of pinned, clamped, free, guided",
    ):
        vibration(evaluate(strong.press(SHAPE), certificate=False), "rod", ("pinned", "loose"))


@pytest.mark.parametrize("kind", [Mechanism, SpatialMechanism])
def test_a_link_without_mass_has_no_frequency_and_swings_nowhere(kind):
    m = kind("light")
    arm = m.link("arm", length=0.4, mass=0.0, beam=beams.Beam(SHAPE, strong.STEEL))
    m.force("push", arm.tip, y=-20.0)
    m.revolute("O", m.ground, arm, **({"axis": (0, 0, 1)} if kind is SpatialMechanism else {}))
    scene = Scene(m, {"O": harmonic(0.0, 1.0, 5.0)}, t=(0, 0.2, 65), wanted=("deflection",))
    solution = evaluate(scene, certificate=False)
    found = vibration(solution, "arm")
    assert (found.frequency, found.lower, found.excess, found.enough) == (
        math.inf,
        math.inf,
        0.0,
        True,
    )
    assert found.words == "no bending frequency of its own, because it has no mass"
    assert solution.notes == ()
