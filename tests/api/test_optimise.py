"""Designs found by gradients: beside closed forms, published designs, and searches without
slopes; fronts of several objectives; what is said of an optimum, written, and refused.
"""

import math

import casadi as ca
import numpy as np
import pytest
from conftest import CASES
from scipy.optimize import minimize_scalar

from lagrange_casadi import Front, Mechanism, Scene, load_case, optimise, prepare
from lagrange_casadi.errors import DeclarationError, NoDesignError, ParameterError, UnknownNameError
from lagrange_casadi.motion import expression, harmonic, polynomial

ONE, TWO = {"starts": 1, "screen": 8}, {"starts": 2, "screen": 8}
INERTIA = 1.0 * 0.3**2 / 3


def case(name):
    return load_case(CASES / name).scene


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("name", "parameter", "bounds", "quantity"),
    [
        ("beam_pump", "counterweight", (0.0, 6000.0), "effort:shaft"),
        ("four_bar", "c", (0.2, 0.32), "section:coupler:bending"),
        ("spatial_slider_crank", "l", (0.28, 0.4), "effort:A"),
    ],
)
def test_the_least_peak_is_that_of_a_search_without_slopes(name, parameter, bounds, quantity):
    """Of a motion with jumps, of a section, and of loops that are iterated."""
    scene = case(name)
    group, part = quantity.split(":")[:2]
    f = prepare(scene, wanted=[group if group == "effort" else f"{group}:{part}"])
    k = f.quantities.index(quantity)
    least = minimize_scalar(
        lambda x: abs(float(f.peaks(**{parameter: x}).value[k])), bounds=bounds, method="bounded"
    )
    found = optimise(scene, minimise=f"peak:{quantity}", over={parameter: bounds}, starts=2)
    assert found.feasible
    assert found.converged
    assert found.objective <= least.fun * (1 + 1e-7)
    assert found.values[parameter] == pytest.approx(least.x, abs=2e-4 * (bounds[1] - bounds[0]))


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


def test_the_search_stays_away_from_dead_centres():
    """The shortest rod: the sine of its transmission angle at its worst is the root of
    1 - (r/l)^2.
    """
    over = {"l": (0.05, 0.5)}
    found = optimise(case("slider_crank"), minimise="l", over=over, transmission=0.6, starts=3)
    assert found.values["l"] == pytest.approx(0.1 / 0.8, rel=1e-6)


def test_a_largest_and_a_smallest_value_are_held():
    """A path within limits: the slider goes from l - r to l + r."""
    scene = case("slider_crank")
    found = optimise(
        scene,
        minimise="l",
        over={"l": (0.15, 0.5), "r": (0.02, 0.1)},
        subject_to=["min:pose:slider:x >= 0.2", "max:pose:slider:x <= 0.4", "r >= 0.06"],
        t=(0, 0.08, 41),
        **TWO,
    )
    assert found.feasible
    assert found.values["l"] == pytest.approx(0.26, rel=1e-6)
    lowest, highest, _ = found.limits
    assert (lowest.active, highest.active) == (True, False)
    assert highest.value == pytest.approx(0.32, rel=1e-6)


def swinging(amplitude):
    """A rod that swings: its largest torque goes with the amplitude, an expression of c."""
    m = Mechanism("swing")
    m.set_gravity(0.0, 0.0)
    c = m.parameter("c", 0.3)
    m.revolute("O", m.ground, m.link("rod", length=0.3, mass=1.0))
    return Scene(m, {"O": harmonic(0.0, amplitude(c), 1.0)}, t=(0.0, 1.0, 41), wanted=["effort"])


def torque(amplitude):
    return 1.0 * 0.3**2 / 3 * amplitude * (2 * math.pi) ** 2


def test_all_local_optima_are_named():
    """An amplitude with two valleys, the left one deeper."""

    def amplitude(c):
        return (c**2 - 1) ** 2 + 0.05 * c + 0.5

    found = optimise(
        swinging(amplitude),
        minimise="peak:effort:O",
        over={"c": (-2.0, 2.0)},
        starts=[{"c": c} for c in (-1.7, -0.4, 0.9, 1.8)],
    )
    assert found.converged
    left, right = found.optima
    roots = sorted(np.roots([4, 0, -4, 0.05]).real)
    assert [left.values["c"], right.values["c"]] == pytest.approx([roots[0], roots[2]], rel=1e-6)
    assert [left.starts, right.starts] == [2, 2]
    assert left.objective == pytest.approx(torque(amplitude(roots[0])), rel=1e-6)
    assert found.values == left.values
    for kind in ("peak", "rms"):  # a hilltop is no optimum
        asked = {"minimise": f"{kind}:effort:O", "over": {"c": (-1.0, 1.0)}, "starts": [{"c": 0.0}]}
        hill = optimise(swinging(lambda c: 2.0 - c**2), **asked)
        assert abs(hill.values["c"]) == pytest.approx(1.0, rel=1e-7)
    # The second derivative by the share of the bounds, which are 4 apart, over the objective at the
    # first start.
    start = torque(amplitude(-1.7))
    assert found.curvature == pytest.approx(16 * torque(12 * roots[0] ** 2 - 4) / start, rel=1e-3)


@pytest.mark.parametrize("start", [0.35, 0.5, 0.8])
def test_a_jump_that_goes_with_what_is_chosen_is_followed(start):
    """The brake sets in at a time of its own, and pulls least where that is 0.6 s."""
    m = Mechanism("brake")
    m.set_gravity(0.0, 0.0)
    at = m.parameter("at", 0.5, "s", low=0.0)
    arm = m.link("arm", length=0.3, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.torque(
        "brake",
        arm,
        -ca.if_else(m.time > at, (1 + 10 * (at - 0.6) ** 2) * ca.exp(at - m.time), 0.0),
    )
    scene = Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0.0, 1.0, 42), wanted=["effort"])
    found = optimise(
        scene, minimise="peak:effort:O", over={"at": (0.3, 0.9)}, starts=[{"at": start}]
    )
    assert found.converged
    assert found.values["at"] == pytest.approx(0.6, rel=1e-6)
    assert found.objective == pytest.approx(1.0, rel=1e-9)


def turning(*, over=None, shift=0.0, law=None, gravity=0.0):
    """A rod that turns by pi less c in T seconds, from rest to rest: the largest torque is 6 I (pi
    - c)/T^2, at both ends.
    """
    m = Mechanism("turning")
    m.set_gravity(0.0, gravity)
    duration, less = m.parameter("T", 1.0, "s", low=0.01), m.parameter("c", 0.0, "rad", low=0.0)
    m.revolute("O", m.ground, m.link("rod", length=0.3, mass=1.0))
    law = law or expression(
        lambda t: (
            (ca.pi - less) * (3 * ((t - shift) / duration) ** 2 - 2 * ((t - shift) / duration) ** 3)
        )
    )
    return Scene(m, {"O": law}, t=(shift, shift + duration, 41), wanted=["effort"])


def test_two_objectives_give_the_curve_of_a_closed_form():
    """Torque against time: every time has its own least torque, and a second more gains what the
    derivative says.
    """
    front = optimise(
        turning(), minimise=["peak:effort:O", "T"], over={"T": (0.5, 2.0)}, points=7, **TWO
    )
    assert isinstance(front, Front)
    assert (front.converged, front.feasible, len(front.points)) == (True, True, 7)
    torque, duration = front.objectives.T
    assert torque == pytest.approx(6 * INERTIA * math.pi / duration**2, rel=1e-8)
    assert [duration[-1], duration[0]] == pytest.approx([0.5, 2.0], rel=1e-3)
    assert (np.diff(torque) > 0).all()
    trades = np.array([point.trades[0] for point in front.points])
    assert trades[1:] == pytest.approx(12 * INERTIA * math.pi / duration[1:] ** 3, rel=1e-5)
    size = np.ptp(front.objectives, axis=0)
    steps = np.hypot(*(np.diff(front.objectives, axis=0) / size).T)
    assert steps.max() <= 4 * steps.min()


def test_three_objectives():
    front = optimise(
        turning(),
        minimise=["peak:effort:O", "T", "c"],
        over={"T": (0.5, 2.0), "c": (0.0, 1.0)},
        points=9,
        **TWO,
    )
    rows = front.objectives
    torque, duration, less = rows.T
    assert torque == pytest.approx(6 * INERTIA * (math.pi - less) / duration**2, rel=1e-7)
    assert (len(rows) >= 9, front.converged) == (True, True)
    beaten = [(other <= row).all() and (other < row).any() for row in rows for other in rows]
    assert not any(beaten)
    front = optimise(turning(), minimise=["peak:effort:O", "rms:effort:O"], over={"T": (0.5, 2.0)})
    assert [point.optimum.values["T"] for point in front.points] == [pytest.approx(2.0, rel=1e-6)]
    assert "one design is the best in all objectives" in front.notes[0]


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("shift", "term"), [(0.0, "peak"), (0.7, "peak"), (0.0, "rms")])
def test_instants_go_with_what_is_chosen(shift, term):
    """The least time for a torque, where the last instant, and here the first one, is a peak."""
    found = optimise(
        turning(shift=shift),
        minimise="T",
        over={"T": (0.1, 5.0)},
        subject_to=[f"{term}:effort:O <= 2"],
        **TWO,
    )
    assert found.converged
    factor = (
        6.0
        if term == "peak"
        else math.sqrt(np.trapezoid((6 - 12 * np.linspace(0, 1, 41)) ** 2, dx=1 / 40))
    )
    assert found.values["T"] == pytest.approx(math.sqrt(factor * INERTIA * math.pi / 2), rel=1e-8)
    (limit,) = found.limits
    assert limit.multiplier == pytest.approx(found.values["T"] / 4, rel=1e-5)
    assert found.curvature == math.inf


@pytest.mark.parametrize("last", [0, 6])
def test_a_stop_leaves_the_best_so_far_and_what_was_done_is_not_done_again(here, last):
    seen, words = [], {"minimise": ["peak:effort:O", "T"], "over": {"T": (0.5, 2.0)}, "points": 9}

    def stop(start, *_):
        seen.append(start)
        if start == last:
            raise KeyboardInterrupt

    front = optimise(turning(), **words, **ONE, out="x.h5", progress=stop)
    assert (front.stopped, len(front.points) < 9) == (True, True)
    seen.clear()
    again = lambda start, *_: seen.append(start)  # noqa: E731
    front = optimise(turning(), **words, **ONE, out="x.h5", resume=True, progress=again)
    assert (front.stopped, min(seen)) == (False, last)
    whole = optimise(turning(), **words, **ONE)
    np.testing.assert_array_equal(front.objectives, whole.objectives)


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
        ({"subject_to": ["peak:effort:O <= inf"]}, DeclarationError, "a constraint such as"),
        ({"minimise": "peak:a:b:c:d"}, DeclarationError, "'peak:a:b:c:d' is neither"),
        ({"minimise": "peak:torque"}, UnknownNameError, "unknown output 'torque'"),
        ({"minimise": ["r", "r"]}, DeclarationError, "a term is listed twice: r, r"),
        ({"subject_to": "r <= 1"}, DeclarationError, "subject_to: expected a list of texts"),
        ({"resume": True}, DeclarationError, "resume: expected out"),
        ({"resume": True, "force": True}, DeclarationError, "exclude each other"),
        ({"transmission": 2.0}, DeclarationError, "transmission: expected a sine"),
        (
            {"over": {"l": (0.01, 0.05)}},
            NoDesignError,
            "no design within the bounds has a result",
        ),
    ],
)
def test_mistakes(words, error, said):
    with pytest.raises(error, match=said):
        optimise(
            case("slider_crank"),
            **{"minimise": "peak:effort:O", "over": {"l": (0.2, 0.3)}, **words},
        )
