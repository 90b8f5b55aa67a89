"""Fronts of several objectives, beside closed forms; instants that go with what is chosen."""

import math

import casadi as ca
import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import Front, Mechanism, Scene, load_case, optimise
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import expression, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

ONE, TWO = {"starts": 1, "screen": 8}, {"starts": 2, "screen": 8}
INERTIA = 1.0 * 0.3**2 / 3


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


def dominated(values):
    return [
        k
        for k, row in enumerate(values)
        if any((other <= row).all() and (other < row).any() for other in values)
    ]


def test_two_objectives_give_the_curve_of_a_closed_form():
    """Torque against time: every time has its own least torque, and a second more gains what the
    derivative says.
    """
    front = optimise(
        turning(), minimise=["peak:effort:O", "T"], over={"T": (0.5, 2.0)}, points=7, **TWO
    )
    assert isinstance(front, Front)
    assert front.converged
    assert front.feasible
    assert len(front.points) == 7
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
    torque, duration, less = front.objectives.T
    assert torque == pytest.approx(6 * INERTIA * (math.pi - less) / duration**2, rel=1e-7)
    assert len(front.points) >= 9
    assert dominated(front.objectives) == []
    assert front.converged


def test_objectives_that_agree_have_no_front():
    front = optimise(
        turning(), minimise=["peak:effort:O", "rms:effort:O"], over={"T": (0.5, 2.0)}, **TWO
    )
    (point,) = front.points
    assert point.optimum.values["T"] == pytest.approx(2.0, rel=1e-6)
    assert "one design is the best in all objectives" in front.notes[0]


def test_of_many_designs_with_the_least_of_one_the_best_of_the_other_is_the_end():
    """The least turn, c at its largest, may take any time: the front ends where the torque is
    least.
    """
    front = optimise(
        turning(),
        minimise=["peak:effort:O", "c"],
        over={"T": (0.5, 2.0), "c": (0.0, 1.0)},
        points=3,
        **TWO,
    )
    assert front.objectives[:, 0] == pytest.approx(
        6 * INERTIA * (math.pi - front.objectives[:, 1]) / 4, rel=1e-6
    )
    assert all(point.optimum.values["T"] == pytest.approx(2.0, rel=1e-6) for point in front.points)


def test_a_limit_that_holds_nowhere_is_told():
    words = {"minimise": ["peak:effort:O", "c"], "over": {"T": (0.5, 2.0), "c": (0.0, 1.0)}}
    front = optimise(turning(), **words, subject_to=["T >= 3"], **ONE)
    assert not front.feasible
    assert front.points[0].optimum.limits[0].value == pytest.approx(2.0, rel=1e-5)


def test_a_stop_leaves_the_front_so_far():
    seen = []

    def stop(start, objective, excess):
        seen.append(start)
        if start == 6:
            raise KeyboardInterrupt

    front = optimise(
        turning(),
        minimise=["peak:effort:O", "T"],
        over={"T": (0.5, 2.0)},
        points=9,
        **ONE,
        progress=stop,
    )
    assert front.stopped
    assert 2 <= len(front.points) < 9
    assert dominated(front.objectives) == []


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


def test_instants_that_a_steady_drive_gives_go_with_its_speed():
    """One turn of a shaft whose gravity torque is the same at every speed, and a damper's that
    grows with it.
    """
    m = Mechanism("mill")
    rate = m.parameter("rate", 2.0, "rad/s", low=0.1)
    arm = m.link("arm", length=0.3, mass=1.0)
    joint = m.revolute("O", m.ground, arm)
    m.torque("drag", arm, -0.5 * m.rate(joint))
    scene = Scene(
        m, {"O": polynomial(0.3, rate)}, over=("O", 0.3, 0.3 + 2 * math.pi, 73), wanted=["effort"]
    )
    found = optimise(
        scene,
        minimise="rate",
        over={"rate": (0.5, 9.0)},
        subject_to=["peak:effort:O <= 3", "rate >= 1"],
        **ONE,
    )
    assert found.values["rate"] == pytest.approx(1.0, rel=1e-6)
    most = optimise(
        scene, minimise="mean:effort:O", over={"rate": (0.5, 9.0)}, subject_to=["rate >= 2"], **ONE
    )
    assert most.objective == pytest.approx(0.5 * 2.0, rel=1e-9)


def test_a_motion_that_cannot_be_inverted_is_told():
    m = Mechanism("arm")
    bend = m.parameter("bend", 1.0, "rad/s^2")
    m.revolute("O", m.ground, m.link("arm", length=0.3, mass=1.0))
    scene = Scene(m, {"O": polynomial(0.0, 1.0, bend)}, over=("O", 0.0, 1.0, 21), wanted=["effort"])
    with pytest.raises(
        DeclarationError, match="the motion of joint 'O', which defines the instants"
    ):
        optimise(scene, minimise="peak:effort:O", over={"bend": (0.5, 2.0)})


@pytest.mark.long
def test_a_front_of_a_mechanism_with_loops():
    """No design of a grid is better in both than a point of the front."""
    scene = load_case(CASES / "slider_crank").scene
    words = {"over": {"l": (0.12, 0.8), "r": (0.05, 0.1)}, "subject_to": ["r >= 0.07"]}
    front = optimise(
        scene, minimise=["peak:effort:O", "peak:section:rod:bending"], **words, backend="auto"
    )
    assert front.converged
    for point in front.points:
        limit = f"peak:section:rod:bending <= {point.objectives[1] * (1 + 1e-6)!r}"
        again = optimise(
            scene, minimise="peak:effort:O", **words | {"subject_to": ["r >= 0.07", limit]}
        )
        assert point.objectives[0] <= again.objective * (1 + 1e-5)
