"""Stresses and factors of safety between instants, against closed forms, finer instants, and what
the graph's own series say.
"""

import math

import numpy as np
import pytest
from internals import KINDS, strength_lines
from strong import STEEL, press, robot, slider

from lagrange_casadi import Mechanism, Scene, beams, evaluate, refine
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import polynomial
from lagrange_casadi.peaks import refine_safety, refine_stress

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

SPEED, PUSH, LENGTH, HEIGHT, WIDTH = 40.0, 500.0, 0.4, 0.03, 0.012


@pytest.fixture(scope="module")
def turning():
    """A bar that turns evenly without weight, with a force on its tip that keeps its direction; and
    its solution.
    """
    m = Mechanism("turning")
    m.set_gravity(0.0, 0.0)
    bar = m.link("bar", length=LENGTH, beam=beams.Beam(beams.rectangle(HEIGHT, WIDTH), STEEL))
    m.revolute("O", m.ground, bar)
    m.force("push", bar.tip, y=-PUSH)
    scene = Scene(m, {"O": polynomial(0.0, SPEED)}, t=(0.003, 0.003 + 2 * math.pi / SPEED, 14))
    return scene, evaluate(scene, certificate=False, backend="vm")


def test_the_stress_of_a_turning_bar_is_its_closed_form(turning):
    """N/A + M/W at the base: the mass beyond it pulls evenly, and the force is N at one angle and M
    a quarter turn away.
    """
    scene, solution = turning
    area, modulus = HEIGHT * WIDTH, WIDTH * HEIGHT**2 / 6
    exact = 7850.0 * SPEED**2 * LENGTH**2 / 2 + PUSH * math.hypot(1 / area, LENGTH / modulus)
    peak = refine_stress(scene, solution, "bar", "normal")
    assert peak.value == pytest.approx(exact, rel=1e-12)
    assert solution.stress("bar").peak("normal").value < exact * (1 - 1e-4)
    angle = math.atan2(LENGTH / modulus, 1 / area)
    times = np.mod(np.array([angle - math.pi / 2, -angle - math.pi / 2]), 2 * math.pi) / SPEED
    assert np.abs(times - peak.t).min() < 1e-6 / SPEED
    assert peak.xi == 0.0
    assert refine_safety(scene, solution, "bar").against("yield") == pytest.approx(
        STEEL.yield_strength / exact, rel=1e-6
    )


NOTCHES = [beams.Notch(0.25, bending=3.0)]
LINKS = {
    "rod": (lambda: slider(200e6), "rod"),
    "notched": (lambda: press(beams.i_section(0.04, 0.03, 0.004, 0.005), NOTCHES), "rod"),
    "space": (lambda: robot(beams.round_bar(0.03)), "upper"),
}


@pytest.mark.parametrize(
    "name", ["rod", *(pytest.param(name, marks=pytest.mark.long) for name in ("notched", "space"))]
)
def test_peaks_are_those_of_finer_instants_and_of_the_graph(name):
    make, link = LINKS[name]
    scene = make()
    start, stop, _ = scene.t
    coarse, fine = (
        evaluate(scene, t=(start, stop, n), wanted=[f"section:{link}"], certificate=False)
        for n in (33, 257)
    )
    for kind in KINDS:
        for notches in {False, name == "notched"}:
            peak = refine_stress(scene, coarse, link, kind, notches=notches)
            below = fine.stress(link).peak(kind, notches=notches)
            assert below.value * (1 - 1e-12) <= peak.value <= below.value * (1 + 5e-4)
            assert abs(coarse.stress(link).peak(kind, notches=notches).value) <= peak.value
    program = evaluate(scene, t=(start, stop, 33), wanted=[f"safety:{link}"], certificate=False)
    used = refine(scene, program, [f"utilisation:{link}:{way}" for way in ("yield", "buckling")])
    safety = refine_safety(scene, coarse, link)
    assert safety.against("yield") == pytest.approx(1 / used[0].value, rel=1e-9)
    assert safety.against("buckling") == pytest.approx(1 / used[1].value, rel=1e-5)
    assert [verdict.against for verdict in safety.verdicts] == [
        v.against for v in coarse.safety(link).verdicts
    ]
    assert safety.against("fatigue") == pytest.approx(
        coarse.safety(link).against("fatigue"), nan_ok=True
    )


def test_of_one_instant_and_of_steps_that_are_not_equal(turning):
    scene, even = turning
    one = evaluate(scene, t=(0.01, 0.01, 1), certificate=False)
    assert refine_stress(scene, one, "bar") == one.stress("bar").peak("von_mises")
    uneven = even.during(~np.isin(np.arange(even.t.size), (3, 4, 9)))
    assert refine_stress(scene, uneven, "bar").value == pytest.approx(
        refine_stress(scene, even, "bar").value, rel=1e-12
    )


def test_what_cannot_be_refined(turning):
    scene, solution = turning
    with pytest.raises(UnknownNameError, match="unknown kind of stress 'von'"):
        refine_stress(scene, solution, "bar", "von")
    with pytest.raises(DeclarationError, match="is not one of this scene"):
        refine_stress(
            Scene(scene.mechanism, {"O": polynomial(0.0, 50.0)}, t=scene.t), solution, "bar"
        )


def test_lines_are_of_all_times_where_the_scene_is_told(turning):
    scene, solution = turning
    peak = refine_stress(scene, solution, "bar", "normal")
    told, sampled = (list(strength_lines(solution, ["stress:bar"], s)) for s in (scene, None))
    assert f"{peak.value / 1e6:>13.6g} MPa  at t = {peak.t:.5g} s" in told[1]
    assert told[1] != sampled[1]
    assert [line.split()[0] for line in told] == [line.split()[0] for line in sampled]
