"""Estimates of errors against the errors themselves, which fifty digits tell."""

import importlib
import math
from dataclasses import replace

import casadi as ca
import extremes
import numpy as np
import pytest
from arithmetic import ROUNDING
from conftest import CASES
from estimates import COUNT, assert_near, looked_at, methods, random
from mechanisms import slider_crank
from outside import doubled
from random_mechanisms import KINDS
from spatial_solutions import scene_of
from stepped import iterated
from truth import true_errors, truth

from lagrange_casadi import Mechanism, Scene, evaluate, load_case
from lagrange_casadi.motion import harmonic, polynomial


@pytest.mark.filterwarnings(
    "ignore:the certificate fails"
)  # of a loop that few Newton steps leave open: how far is told
@pytest.mark.sampled(13)
@pytest.mark.parametrize("seed", range(3, 5))
@pytest.mark.parametrize("kind", KINDS)
def test_random_mechanisms_by_every_method(kind, seed):
    """As far as each goes: steps that are too few are refused where they are no solution at all."""
    scene, given = random(kind, seed)
    for found in looked_at(scene, methods(scene).values(), **given):
        assert_near(found)


@pytest.mark.parametrize("family", ["tree", "loop"])
def test_random_mechanisms_in_space(family):
    _, scene = scene_of(family, 0)
    assert_near(*looked_at(replace(scene, wanted=["effort", "reaction"]), [{}]))


def test_a_friction_on_the_wrong_side_of_a_reversal_is_an_error_of_singles():
    """At dead centres that are instants, singles put a rate of rounding before the reversal, and
    doubles after it, where its friction is told: the two are apart by a jump.
    """
    scene = load_case(CASES / "v_twin").scene
    double, single = (evaluate(scene, precision=name) for name in ("double", "single"))
    gaps = {
        name: float(np.max(np.abs(values - single.series[name])))
        for name, values in double.series.items()
        if not name.endswith("angle")
    }
    assert gaps["effort:main"] > 1e-4 * abs(double.peak("effort:main").value)
    for name, gap in gaps.items():
        assert gap <= 1.001 * (single.errors[name] + double.errors[name]), name


def test_digits_where_long_doubles_are_no_longer_than_doubles(monkeypatch):
    """At few instants, of loops in closed form and iterated ones, and on the side of a jump."""
    accuracy = importlib.import_module("lagrange_casadi.results.verification.accuracy")
    scenes = [slider_crank(["all"]), iterated(), load_case(CASES / "connecting_rod").scene]
    for scene in (replace(scene, t=(*scene.span, COUNT), over=None) for scene in scenes):
        monkeypatch.undo()
        measured = evaluate(scene).errors
        monkeypatch.setattr(accuracy, "LONG", ROUNDING["double"])
        found = evaluate(scene).errors
        ratios = [found[name] / error for name, error in measured.items()]
        assert min(ratios) > 0.1
        assert 0.5 < np.median(ratios) < 2.0


def arm(load):
    m = Mechanism("arm")
    link = m.link("arm", length=1, mass=1)
    joint = m.revolute("J", m.ground, link)
    m.torque("t", link, load(m.coordinate(joint)))
    return Scene(m, {"J": polynomial(0.3, 1)}, t=(0, 2, 41))


def test_graphs_that_call_functions_have_no_estimates():
    assert evaluate(arm(doubled), backend="vm").errors == {}
    assert set(evaluate(arm(ca.sin), backend="vm").errors) >= {"effort:J", "load:t:mz"}
    assert evaluate(arm(ca.sin), backend="vm", certificate=False).errors == {}


def test_what_vanishes_is_as_uncertain_as_the_largest_of_its_unit():
    """A load that is exactly zero, beside an effort of 1 N m."""
    scene = replace(arm(lambda angle: 0.0 * angle), motion={"J": polynomial(0.0)}, t=(0, 1, 11))
    solution = evaluate(scene, backend="vm")
    effort, load = (abs(solution.peak(name).value) for name in ("effort:J", "load:t:mz"))
    assert load == 0.0
    assert solution.errors["load:t:mz"] == ROUNDING["double"] * effort


def test_half_a_turn_is_as_good_as_less_half_a_turn():
    """A rod that swings about the direction of -x: where longer numbers fall on the other side,
    nothing is off by a turn.
    """
    scene = replace(extremes.slider_crank(harmonic(0.0, 1.0, 1.0)), posture={"rod": math.pi})
    solution = evaluate(scene, t=(0.0, 1.0, 41))
    assert np.min(np.abs(np.abs(solution.pose("rod").angle) - math.pi)) < 1e-15
    assert solution.errors["pose:rod:angle"] < 1e-13


def test_a_remainder_is_as_good_as_one_less_by_its_period():
    """3 * 0.1 is the period in doubles, and less than that in longer numbers."""
    scene = replace(arm(lambda angle: ca.fmod(angle, 3 * 0.1)), motion={"J": polynomial(0.0, 0.1)})
    assert evaluate(scene, t=(0, 3, 4), backend="vm").errors["load:t:mz"] < 1e-13


def test_the_instant_nearest_to_a_dead_centre_is_looked_at():
    """One of twenty thousand: between those that are evenly spread, errors are less than a
    hundredth of those there.
    """
    scene = slider_crank(["all"], t=(0.0, 0.08, 20_001))
    solution = evaluate(scene, parameters={"l": 0.1 * (1 + 1e-7)})
    worst = int(np.argmax(solution.certificate["condition"]))
    spread = np.linspace(0, 20_000, 48).astype(int)
    assert np.min(np.abs(spread - worst)) > 10
    parameters = scene.mechanism.values({"l": 0.1 * (1 + 1e-7)})
    true = true_errors(
        solution.during(slice(worst, worst + 1)),
        truth(scene, solution.t[worst : worst + 1], parameters),
    )
    for name in ("effort:O", "reaction:guide:fy", "motion:A_acceleration"):
        assert 0.1 < solution.errors[name] / true[name] < 1e3, name


@pytest.mark.parametrize("backend", ["vm", "lanes", pytest.param("c", marks=pytest.mark.long)])
def test_one_step_an_instant_begins_with_a_closed_loop(backend):
    """Whatever the parameters: the guess of the graph is that of their defaults."""
    parameters = {"r": 0.07, "l": 0.35}
    one, closed = (
        evaluate(iterated(), backend=backend, newton=n, parameters=parameters, t=(0.013, 0.08, 401))
        for n in (1, None)
    )
    for name in ("motion:guide", "effort:O"):
        gap = np.abs(one.series[name] - closed.series[name])
        assert gap[0] < 1e-9 * np.max(np.abs(closed.series[name]))
        assert 0.1 * np.max(gap) < one.errors[name] < 2.0 * np.max(gap)
        assert 1e-9 < np.max(gap) / np.max(np.abs(closed.series[name])) < 1e-2
