"""First bending frequencies and whether rigid links are enough: closed forms, published tapers,
bounds, and the steady swing of a beam.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import strong
from hypothesis import given, settings
from hypothesis import strategies as st

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
from lagrange_casadi.motion import harmonic

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


ROOTS = {
    ("free", "pinned"): 3.92660231,
    ("free", "free"): 4.73004074,
    ("clamped", "free"): 1.87510407,
    ("pinned", "pinned"): math.pi,
    ("clamped", "pinned"): 3.92660231,
    ("clamped", "clamped"): 4.73004074,
    ("guided", "pinned"): math.pi / 2,
    ("guided", "guided"): math.pi,
    ("clamped", "guided"): 2.36502037,
    ("free", "guided"): 2.36502037,
}
"""Roots of cos(b) cosh(b) = 1, -1 and the others, of tables of uniform beams (Blevins, Formulas for
Natural Frequency and Mode Shape, table 8-1).
"""


def natural(shape=SHAPE, ends=("pinned", "pinned"), length=1.0, second="iz"):
    """Return the first bending frequency of a uniform beam [Hz]."""
    p, steel = shape.properties(), strong.STEEL
    stiff = steel.elasticity * getattr(p, second) / (steel.density * p.area)
    return (ROOTS[ends] / length) ** 2 * math.sqrt(stiff) / math.tau


def bar(shape):
    """Evaluate a bar of 1 m that swings."""
    m = Mechanism("bar")
    link = m.link("bar", length=1.0, beam=beams.Beam(shape, strong.STEEL))
    m.revolute("O", m.ground, link)
    scene = Scene(m, {"O": harmonic(0.0, 0.1, 1.0)}, t=(0, 1, 9), wanted=["section:bar"])
    return evaluate(scene, certificate=False)


@pytest.mark.parametrize("ends", ROOTS, ids="-".join)
def test_a_uniform_beam_has_the_frequency_of_books(ends):
    """Whichever end is the base; the least and the largest value that is possible enclose it."""
    solution, told = bar(SHAPE), natural(ends=ends)
    for way in (ends, ends[::-1]):
        found = vibration(solution, "bar", way)
        assert found.frequency == pytest.approx(told, rel=1e-6)
        if found.lower is not None:
            assert told * (1 - 1e-4) <= found.lower <= told * (1 + 1e-7)
        moves = ("free" in ends and ends != ("clamped", "free")) or ends == ("guided", "guided")
        assert (found.lower is None) == moves


def test_a_wedge_is_that_of_kirchhoff():
    """A wedge clamped at its thick end: w = 5.315 sqrt(EI/(m l^4)) of its base (Kirchhoff 1879;
    Timoshenko, Vibration Problems).
    """
    base = beams.rectangle(0.02, 0.01)
    found = vibration(
        bar(beams.tapered(base, beams.rectangle(2e-6, 0.01))), "bar", ("clamped", "free")
    )
    told = natural(base, ("clamped", "free")) * 5.315 / ROOTS["clamped", "free"] ** 2
    assert found.frequency == pytest.approx(told, rel=2e-3)


@settings(max_examples=6, deadline=None)
@given(
    st.lists(st.floats(0.004, 0.02), min_size=4, max_size=4),
    st.floats(0.2, 0.8),
    st.sampled_from([ends for ends in ROOTS if "free" not in ends and ends[0] != ends[1]]),
)
def test_bounds_enclose_and_mirrored_beams_swing_alike(heights, step, ends):
    shapes = [beams.rectangle(height, 0.01) for height in heights]
    course = beams.along([0.0, step, step, 1.0], shapes)
    mirrored = beams.along([0.0, 1 - step, 1 - step, 1.0], shapes[::-1])
    one, other = vibration(bar(course), "bar", ends), vibration(bar(mirrored), "bar", ends[::-1])
    assert one.lower <= one.frequency * (1 + 1e-12)
    assert one.frequency == pytest.approx(one.lower, rel=1e-2)
    assert other.frequency == pytest.approx(one.frequency, rel=1e-3)


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


def test_what_is_no_cycle_is_told():
    scene = shaken(10.0)
    half = vibration(evaluate(scene, t=(0.0, 0.03, 65), certificate=False), "bar")
    assert half.excess is None
    assert half.enough is None
    assert "the last bending moment differs from the first" in half.words
    assert (
        "more instants" in vibration(evaluate(scene, t=(0, 0.1, 3), certificate=False), "bar").words
    )


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
    soft = natural(beams.rectangle(0.03, 0.01), ("clamped", "free"), 0.8, "iy")
    assert found.ends == ("clamped", "free")
    assert found.frequency == pytest.approx(soft, rel=1e-6)
    # It is swung in its stiff plane, and its weight at rest bends the soft one: off by a few per
    # cent of what the stiff one says.
    assert 0.0 < found.excess < 0.05
    assert np.isfinite(found.excess)


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
