"""Designs found by gradients: beside closed forms, golden sections of the peaks, and what relaxed
limits gain.
"""

import math

import casadi as ca
import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import Mechanism, Scene, load_case, optimise, prepare
from lagrange_casadi.errors import DeclarationError, NoDesignError, ParameterError, UnknownNameError
from lagrange_casadi.motion import harmonic, samples


def case(name):
    return load_case(CASES / name).scene


def balanced():
    """An arm that swings, with a counterweight: at rest nothing need hold it where the moments are
    equal.
    """
    m = Mechanism("balanced")
    weight = m.parameter("weight", 1.0, "kg", low=0.0)
    reach = m.parameter("reach", 0.2, "m", low=0.0)
    arm, tail = m.link("arm", length=0.5, mass=2.0), m.link("tail", length=reach, mass=1e-9)
    m.revolute("O", m.ground, arm)
    m.weld("rear", arm.base, tail, angle=math.pi)
    m.weld("held", tail.tip, m.point_mass("counterweight", weight))
    return Scene(m, {"O": harmonic(0.0, 0.4, 0.01)}, t=(0.0, 100.0, 65))


def golden(f, low, high, name, quantity, steps=60):
    """The least peak by golden section, with no derivative."""
    ratio = (math.sqrt(5) - 1) / 2
    k = f.quantities.index(quantity)

    def value(x):
        return abs(float(f.peaks(**{name: x}).value[k]))

    for _ in range(steps):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (low, b) if value(a) < value(b) else (a, high)
    return (low + high) / 2, value((low + high) / 2)


@pytest.mark.long
def test_a_counterweight_balances_a_slow_arm():
    """The moments about the pin are equal where weight x reach is 2 kg x 0.25 m; of a motion this
    slow gravity is all.
    """
    found = optimise(balanced(), minimise="peak:effort:O", over={"weight": (0.0, 8.0)}, starts=2)
    assert found.converged
    assert found.feasible
    assert found.values["weight"] == pytest.approx(2.5, rel=1e-3)
    assert found.objective <= 1e-2
    assert found.residual <= 1e-8


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("name", "parameter", "bounds", "quantity"),
    [
        ("beam_pump", "counterweight", (0.0, 6000.0), "effort:shaft"),
        ("four_bar", "c", (0.2, 0.32), "section:coupler:bending"),
        ("spatial_slider_crank", "l", (0.28, 0.4), "effort:A"),
    ],
)
def test_the_least_peak_is_that_of_a_golden_section(name, parameter, bounds, quantity):
    """Of a motion with jumps, of a section, and of loops that are iterated."""
    scene = case(name)
    group, part = quantity.split(":")[:2]
    f = prepare(scene, wanted=[group if group == "effort" else f"{group}:{part}"])
    x, least = golden(f, *bounds, parameter, quantity)
    found = optimise(scene, minimise=f"peak:{quantity}", over={parameter: bounds}, starts=2)
    assert found.feasible
    assert found.converged
    assert found.objective <= least * (1 + 1e-7)
    assert found.values[parameter] == pytest.approx(x, abs=2e-4 * (bounds[1] - bounds[0]))


@pytest.mark.long
def test_a_limit_of_a_parameter_and_what_it_costs():
    """Its multiplier is what the objective, a mean, gains where it is relaxed."""
    scene = case("slider_crank")
    words = {"minimise": "rms:effort:O", "over": {"m3": (0.02, 0.4), "l": (0.12, 0.4)}, "starts": 2}
    found, relaxed = (
        optimise(scene, subject_to=["peak:section:rod:bending <= 0.9", f"m3 >= {limit}"], **words)
        for limit in (0.05, 0.0499)
    )
    for one in (found, relaxed):
        assert one.feasible
        assert one.converged
    _, mass = found.limits
    assert mass.active
    assert mass.value == pytest.approx(0.05)
    assert (found.objective - relaxed.objective) / 1e-4 == pytest.approx(mass.multiplier, rel=1e-2)


@pytest.mark.long
def test_an_active_limit_has_the_multiplier_of_its_slope():
    """The longest rod is best, but bends: the limit is met, and each of ten starts ends where it
    is.
    """
    scene = case("slider_crank")
    words = {"minimise": "peak:effort:O", "over": {"l": (0.12, 0.8)}}
    starts = [{"l": float(l)} for l in np.linspace(0.12, 0.8, 10)]
    found = optimise(scene, subject_to=["peak:section:rod:bending <= 1.2"], starts=starts, **words)
    assert found.feasible
    assert all(
        one.objective == pytest.approx(found.objective, rel=1e-6)
        for one in found.starts
        if one.excess <= 1e-7
    )
    (limit,) = found.limits
    assert limit.active
    more = optimise(
        scene, subject_to=["peak:section:rod:bending <= 1.2012"], starts=[found.values], **words
    )
    assert (found.objective - more.objective) / 0.0012 == pytest.approx(limit.multiplier, rel=2e-2)


def test_what_seems_better_by_the_violation_that_passes_is_not_taken_for_what_converged():
    """A program's design may be a little beyond a limit, and gain much by it where the limit costs
    much.
    """
    limits, starts = ["peak:section:rod:bending <= 0.745724140959767"], [{"l": 0.2}, {"l": 0.8}]
    found = optimise(
        case("slider_crank"),
        minimise="peak:effort:O",
        over={"l": (0.12, 0.8)},
        subject_to=limits,
        starts=starts,
    )
    assert found.limits[0].multiplier > 500.0
    assert [start.ending for start in found.starts] == ["converged", "converged"]
    assert found.converged


def test_the_search_stays_away_from_dead_centres():
    """The shortest rod: the sine of its transmission angle at its worst is the
    root of 1 - (r/l)^2.
    """
    scene = case("slider_crank")
    sine = 0.6
    found = optimise(scene, minimise="l", over={"l": (0.05, 0.5)}, transmission=sine, starts=3)
    r = scene.mechanism.values()["r"]
    assert found.feasible
    assert found.values["l"] == pytest.approx(r / math.sqrt(1 - sine**2), rel=1e-6)


def test_a_largest_and_a_smallest_value_are_held():
    """A path within limits: the slider goes from l - r to l + r."""
    scene = case("slider_crank")
    found = optimise(
        scene,
        minimise="l",
        over={"l": (0.15, 0.5), "r": (0.02, 0.1)},
        subject_to=["min:pose:slider:x >= 0.2", "max:pose:slider:x <= 0.4", "r >= 0.06"],
        starts=2,
    )
    assert found.feasible
    assert found.values["l"] == pytest.approx(0.26, rel=1e-6)
    lowest, highest, _ = found.limits
    assert lowest.active
    assert not highest.active
    assert highest.value == pytest.approx(0.32, rel=1e-6)


def test_a_stop_leaves_the_best_so_far():
    seen = []

    def stop(start, objective, excess):
        seen.append(objective)
        if len(seen) == 2:
            raise KeyboardInterrupt

    found = optimise(
        case("four_bar"), minimise="peak:effort:O", over={"c": (0.2, 0.32)}, progress=stop
    )
    assert found.stopped
    assert len(seen) == 2
    assert found.objective <= seen[0]


@pytest.mark.parametrize(
    ("words", "error", "said"),
    [
        (
            {"minimise": "effort:O"},
            DeclarationError,
            "'effort:O' is neither a parameter nor peak:QUANTITY",
        ),
        ({"minimise": "peak:effort:X"}, UnknownNameError, "effort:X"),
        (
            {"minimise": "mean:reaction:O:fx"},
            DeclarationError,
            "means exist of effort, friction, output only",
        ),
        ({"minimise": "min:effort:O"}, DeclarationError, "use max:effort:O"),
        ({"over": {"k": (0.1, 0.2)}}, UnknownNameError, "parameter"),
        (
            {"over": {"l": (0.2, 0.3), "m2": (0.1, 0.2)}, "minimise": "max:pose:slider:x"},
            DeclarationError,
            "no objective .* depends on 'm2'",
        ),
        ({"over": {}}, DeclarationError, "expected bounds by parameter"),
        ({"over": {"l": 0.3}}, DeclarationError, "expected \\(least, largest\\) for 'l'"),
        ({"over": {"l": (0.4, 0.3)}}, DeclarationError, "must be below the largest"),
        ({"over": {"l": (-0.4, 0.3)}}, ParameterError, "out of its range"),
        ({"subject_to": ["peak:effort:O < "]}, DeclarationError, "expected a constraint such as"),
        ({"subject_to": ["peak:effort:O >= 3"]}, DeclarationError, "limited from above only"),
        ({"subject_to": ["min:effort:O <= 3"]}, DeclarationError, "use max:effort:O"),
        ({"subject_to": ["peak:effort:O <= -3"]}, DeclarationError, "a peak is a magnitude"),
        ({"starts": 0}, DeclarationError, "starts: expected a whole number from 1 to 16777216"),
        ({"starts": [{"r": 0.1}]}, UnknownNameError, "parameter that is chosen"),
        ({"starts": [{"l": 0.7}]}, DeclarationError, "l = 0.7 is not within its bounds"),
        ({"starts": 2.0}, DeclarationError, "starts: expected a whole number from 1 to 16777216"),
        ({"screen": 0}, DeclarationError, "screen: expected a whole number from 1"),
        ({"points": 1}, DeclarationError, "points: expected a whole number from 2 to 16777216"),
        ({"minimise": []}, DeclarationError, "minimise: expected a text"),
        ({"minimise": "peak:torque"}, UnknownNameError, "unknown output 'torque'"),
        ({"minimise": ["r", "r"]}, DeclarationError, "a term is listed twice: r, r"),
        ({"subject_to": "r <= 1"}, DeclarationError, "subject_to: expected a list of texts"),
        ({"resume": True}, DeclarationError, "resume: expected out"),
        ({"resume": True, "force": True}, DeclarationError, "exclude each other"),
        ({"transmission": 2.0}, DeclarationError, "transmission: expected a sine"),
    ],
)
def test_mistakes(words, error, said):
    with pytest.raises(error, match=said):
        optimise(
            case("slider_crank"),
            **{"minimise": "peak:effort:O", "over": {"l": (0.2, 0.3)}, **words},
        )


def test_no_design_has_a_result():
    with pytest.raises(NoDesignError, match="no design within the bounds has a result"):
        optimise(case("slider_crank"), minimise="peak:effort:O", over={"l": (0.01, 0.05)})
    with pytest.raises(DeclarationError, match="expected a Scene or a Case"):
        optimise(None, minimise="peak:effort:O", over={"l": (0.1, 0.2)})


def test_a_casadi_without_ipopt_is_told(monkeypatch):
    monkeypatch.setattr(ca, "has_nlpsol", lambda name: False)
    with pytest.raises(DeclarationError, match="no IPOPT"):
        optimise(case("slider_crank"), minimise="peak:effort:O", over={"l": (0.2, 0.3)})


@pytest.mark.long
def test_motions_by_samples():
    """At a bound the multiplier is the slope of the peak, which is found in another way."""
    times = np.linspace(0.0, 1.0, 9)
    m = Mechanism("arm")
    l = m.parameter("l", 0.4, "m")
    upper, fore = m.link("upper", length=l, mass=2.0), m.link("fore", length=0.3, mass=1.0)
    m.revolute("O", m.ground, upper)
    m.revolute("A", upper.tip, fore)
    swing = np.sin(math.pi * times) ** 2
    laws = {
        "O": samples(times, (0.7 * swing).tolist()),
        "A": samples(times, (0.5 * swing).tolist()),
    }
    scene = Scene(m, laws, t=(0.0, 1.0, 51))
    found = optimise(scene, minimise="peak:effort:O", over={"l": (0.3, 0.5)}, starts=1)
    assert found.converged
    assert found.values["l"] == pytest.approx(0.3, rel=1e-6)
    slope = prepare(scene, wanted=["effort"]).gradient(found.values)["effort:O"]["l"]
    assert -found.bounds["l"] == pytest.approx(abs(slope), rel=1e-5)
