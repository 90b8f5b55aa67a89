"""How far a point moves because links bend: closed forms, and a frame solver with the drives
locked.
"""

import frames
import numpy as np
import pytest
import strong

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, beams, evaluate, tool_deflection
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

STEEL = strong.STEEL


def sections_of(m):
    found = {}
    for name, link in m.links.items():
        p = link.beam.course.cells[0][0].properties()
        found[name] = (
            p,
            link.beam.material.elasticity,
            link.beam.material.shear_modulus,
            link.beam.material.density * p.area,
        )
    return found


def test_two_arms_that_hold_a_load():
    """An arm of two links at rest: its tip sinks as a frame's does, drives locked; the parts of
    both links add up to it.
    """
    m = Mechanism("arms")
    upper = m.link("upper", length=0.5, beam=beams.Beam(beams.rectangle(0.03, 0.01), STEEL))
    fore = m.link("fore", length=0.4, beam=beams.Beam(beams.round_bar(0.02), STEEL))
    m.revolute("shoulder", m.ground, upper)
    m.revolute("elbow", upper.tip, fore)
    m.force("load", fore.tip, x=20.0, y=-60.0)
    scene = Scene(m, {"shoulder": polynomial(0.3), "elbow": polynomial(0.5)}, t=(0, 0, 1))
    found = tool_deflection(scene, fore.tip)
    _, moved = frames.of_solution(
        evaluate(scene), 0, sections_of(m), [("fore", 0.4, (20.0, -60.0, 0), (0, 0, 0))]
    )
    assert found.moved[0] == pytest.approx(moved["fore", 0.4][:2], rel=1e-9)
    assert set(found.by_link) == {"upper", "fore"}
    assert found.largest == pytest.approx(np.hypot(*moved["fore", 0.4][:2]))


def test_two_arms_on_a_line_by_hand():
    """A load at the tip of two links without mass, their drives locked: what bends each, and how
    the first turns the second.
    """
    m = Mechanism("arms")
    light = STEEL.but(density=1e-9)
    a, b, force = 0.5, 0.4, -60.0
    upper = m.link("upper", length=a, beam=beams.Beam(beams.rectangle(0.03, 0.01), light))
    fore = m.link("fore", length=b, beam=beams.Beam(beams.rectangle(0.02, 0.01), light))
    m.revolute("shoulder", m.ground, upper)
    m.revolute("elbow", upper.tip, fore)
    m.force("load", fore.tip, y=force)
    found = tool_deflection(
        Scene(m, {"shoulder": polynomial(0.0), "elbow": polynomial(0.0)}, t=(0, 0, 1)), fore.tip
    )
    e, ga = STEEL.elasticity, STEEL.shear_modulus * 0.01 * 10 * 1.3 / (12 + 11 * 0.3)
    first, second = e * 0.01 * 0.03**3 / 12, e * 0.01 * 0.02**3 / 12
    sag = force * (a**3 / 3 + a**2 * b / 2) / first + force * a / (0.03 * ga)
    turn = force * (a**2 / 2 + a * b) / first
    own = force * b**3 / (3 * second) + force * b / (0.02 * ga)
    assert found.by_link["upper"][0][1] == pytest.approx(sag + turn * b, rel=1e-8)
    assert found.by_link["fore"][0][1] == pytest.approx(own, rel=1e-8)
    assert found.moved[0][1] == pytest.approx(sag + turn * b + own, rel=1e-8)


def test_an_over_constrained_loop_in_space():
    """A four-bar of pins in space at rest, loaded aside: a place of its coupler moves as a frame's
    does.
    """
    m = SpatialMechanism("four_bar")
    a = m.link("a", length=0.1, beam=beams.Beam(beams.rectangle(0.03, 0.012), STEEL))
    b = m.link("b", length=0.3, beam=beams.Beam(beams.rectangle(0.02, 0.01), STEEL))
    c = m.link("c", length=0.25, beam=beams.Beam(beams.tube(0.02, 0.003), STEEL))
    axis = (0, 0, 1)
    m.revolute("O", m.ground, a, axis=axis)
    m.revolute("A", a.tip, b, axis=axis)
    m.revolute("B", b.tip, c.tip, axis=axis)
    m.revolute("C", m.ground.at(0.3, 0, 0), c, axis=axis)
    m.force("side", b.at(0.15), x=20.0, y=-300.0, z=100.0)
    scene = Scene(
        m, {"O": polynomial(0.2)}, posture={"A": 0.5, "C": 1.5}, t=(0, 0, 1), elastic=True
    )
    found = tool_deflection(scene, b.at(0.15))
    solution = evaluate(scene)
    _, moved = frames.of_solution(
        solution, 0, sections_of(m), [("b", 0.15, (20.0, -300.0, 100.0), (0, 0, 0))]
    )
    assert found.moved[0] == pytest.approx(moved["b", 0.15][:3], rel=1e-7)


def test_only_links_that_have_a_beam_give_way():
    scene = strong.press(beams.rectangle(0.012, 0.006))
    found = tool_deflection(scene, scene.mechanism.bodies["ram"], t=(0, 0.1, 11))
    assert set(found.by_link) == {"rod"}
    assert found.moved.shape == (11, 2)
    assert np.abs(found.moved[:, 0]).max() < 1e-9 * found.largest


def test_what_has_no_meaning_is_one_line():
    scene = strong.press(beams.rectangle(0.012, 0.006))
    with pytest.raises(
        DeclarationError, match="tool_deflection: expected a point of the mechanism, got 'ram'"
    ):
        tool_deflection(scene, "ram")
    with pytest.raises(
        DeclarationError,
        match="tool_deflection: the point is on 'ground', expected a moving body of 'press'",
    ):
        tool_deflection(scene, scene.mechanism.ground.at(0.0, 0.0))
    m = Mechanism("bare")
    bar = m.link("bar", length=1.0, mass=1.0)
    m.revolute("O", m.ground, bar)
    with pytest.raises(DeclarationError, match="tool_deflection: no link has a beam"):
        tool_deflection(Scene(m, {"O": polynomial(0.0)}, t=(0, 0, 1)), bar.tip)
