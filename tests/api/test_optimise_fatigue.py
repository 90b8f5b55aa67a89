"""Fatigue as a limit and as an objective of a search, against solutions and sweeps of the designs
that it finds.
"""

import casadi as ca
import numpy as np
import pytest
from internals import Question, Solver
from strong import STEEL, press, robot, slider

from lagrange_casadi import Mechanism, Scene, beams, evaluate, optimise, sweep
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial


def used(scene, link, values):
    """Utilisation against fatigue, by the code that judges one solution."""
    solution = evaluate(
        scene, parameters=values, wanted=[f"section:{link}"], certificate=False, backend="vm"
    )
    return 1.0 / solution.safety(link).against("fatigue")


def test_the_lightest_that_does_not_tire_is_found():
    scene = slider(80e6)
    found = optimise(
        scene,
        minimise="mass:all",
        over={"h": (0.004, 0.04)},
        subject_to=["least:fatigue:crank >= 2"],
        starts=1,
        screen=4,
    )
    assert found.converged
    assert found.feasible
    (limit,) = found.limits
    assert limit.active
    h = found.values["h"]
    # The worst place is the base of the crank, at which a solution and a search look alike.
    assert used(scene, "crank", {"h": h}) == pytest.approx(0.5, rel=1e-7)
    slope = (used(scene, "crank", {"h": h * 1.001}) - used(scene, "crank", {"h": h * 0.999})) / (
        0.002 * h
    )
    assert limit.multiplier == pytest.approx(-7850.0 * 0.012 * 0.5 / slope, rel=1e-3)


def iterated(endurance=80e6):
    """A slider-crank whose loop is closed by a constraint."""
    m = Mechanism("iterated")
    h = m.parameter("h", 0.02, "m", low=0.0)
    bar = beams.Beam(beams.rectangle(h, 0.012), STEEL.but(endurance=endurance))
    crank, rod = m.link("crank", length=0.1, mass=1.0), m.link("rod", length=0.4, beam=bar)
    o, a = m.revolute("O", m.ground, crank), m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, m.point_mass("ram", 15.0))
    one, two = m.coordinate(o), m.coordinate(a)
    m.constraint("guide", 0.1 * ca.cos(one) + 0.4 * ca.cos(one + two))
    return Scene(m, {"O": polynomial(0, 30.0)}, t=(0, 0.2094395, 65), posture={"rod": 1.5})


@pytest.mark.long
def test_of_loops_that_are_iterated():
    scene = iterated()
    found = optimise(
        scene,
        minimise="mass:rod",
        over={"h": (0.004, 0.04)},
        subject_to=["least:fatigue:rod >= 2"],
        starts=1,
        screen=4,
    )
    assert found.converged
    assert found.feasible
    assert found.limits[0].active
    assert used(scene, "rod", found.values) == pytest.approx(0.5, rel=1e-3)


@pytest.mark.long
def test_as_an_objective_in_space_where_stresses_are_out_of_phase():
    """Shear counts there, and swings are counted: the multiplier of the bound it ends at, against
    differences of sweeps.
    """
    scene = robot(beams.tube(0.03, 0.003), STEEL.but(endurance=220e6))
    term = "peak:utilisation:upper:fatigue"
    found = optimise(scene, minimise=term, over={"pull": (200.0, 300.0)}, starts=1, screen=4)
    assert found.converged
    assert found.unit == "1"
    pull = found.values["pull"]
    swept = sweep(scene, {"pull": [pull, pull + 0.01, pull + 0.02]}, wanted=["safety:upper"])
    here, _, high = (1.0 / x for x in swept["least:fatigue:upper"])
    assert found.objective == pytest.approx(here, rel=1e-9)
    assert pull == pytest.approx(200.0, rel=1e-6)
    assert found.bounds["pull"] == pytest.approx(-(high - here) / 0.02, rel=1e-3)


def test_it_is_that_of_the_instants_that_are_asked_for():
    """Of a crank that speeds up, equal steps of its angle are none of time; the worst place is its
    base.
    """
    m = Mechanism("crank")
    h = m.parameter("h", 0.02, "m", low=0.0)
    bar = beams.Beam(beams.rectangle(h, 0.012), STEEL.but(endurance=80e6))
    m.revolute("O", m.ground, m.link("crank", length=0.3, beam=bar))
    scene = Scene(m, {"O": polynomial(0, 2.0, 30.0)}, over=("O", 0.0, 6.2, 9))
    words = {"transmission": 0.05, "t": None, "parameters": None, "backend": "vm"}
    question = Question.of(
        scene, "peak:utilisation:crank:fatigue", {"h": (0.01, 0.03)}, (), **words
    )
    evaluated = Solver.of(question, question.engine(scene)).evaluator.evaluate(np.array([0.015]))
    (value,) = evaluated.values.values()
    assert value == pytest.approx(used(scene, "crank", {"h": 0.015}), rel=1e-9)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (slider, "'C45.QT' has no endurance, which fatigue by goodman needs"),
        pytest.param(
            lambda: press(
                beams.rectangle(0.03, 0.012),
                material=STEEL.but(endurance=2e8),
                sliding=True,
                t=(0, 0.2, 9),
            ),
            "a load moves along link 'rod'; its fatigue is available in sweeps only",
            marks=pytest.mark.long,
        ),
    ],
)
def test_what_cannot_be_limited(make, told):
    scene = make()
    name = next(iter(scene.mechanism.parameters))
    with pytest.raises(DeclarationError, match=told):
        optimise(
            scene,
            minimise="peak:effort:O",
            over={name: (0.05, 0.1)},
            subject_to=["least:fatigue:rod >= 2"],
            starts=1,
            screen=2,
        )
