"""How peaks change with parameters, to first and second order: beside closed forms, and beside
differences of the peaks themselves and of their slopes; and peaks that tie.
"""

import numpy as np
import pytest
from conftest import CASES
from derivatives import steps
from strong import slider

from lagrange_casadi import (
    Mechanism,
    Scene,
    evaluate,
    load_case,
    prepare,
    sensitivities,
    tolerances,
)
from lagrange_casadi.density import polynomial as density
from lagrange_casadi.errors import UnknownNameError
from lagrange_casadi.motion import dwell, harmonic, move, moves, polynomial, samples

_, END, _, UNKNOWN, _ = range(5)
"""Kinds of a peak's place."""


FORCES, STRENGTH = ["effort", "reaction", "section"], ["stress", "safety", "deflection"]
CASE_NAMES = (
    *("slider_crank", "quick_return", "beam_pump", "excavator", "cardan_shaft", "arm6", "four_bar"),
    *("connecting_rod", "servo_press", "roller_cam", "scara"),
)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", [*CASE_NAMES, "strength"])
def test_slopes_of_peaks_are_those_of_their_differences(name):
    """Smooth ones, at ends, along links, and at kinks and jumps, whose times change with the
    parameters; second ones beside differences of first ones.
    """
    strong = name == "strength"
    scene = slider() if strong else load_case(CASES / name).scene
    f = prepare(scene, wanted=STRENGTH if strong else FORCES)
    gradient, values = f.gradient(), scene.mechanism.values()
    assert not (gradient.kinds == UNKNOWN).any()
    bends, p = None if strong else f.curvature().bends, np.array([*values.values()])
    sizes = np.nanmax(np.abs(gradient.slopes * p), axis=1) + np.abs(gradient.value)
    groups = [quantity.split(":")[0] for quantity in f.quantities]
    sizes += 1e-3 * np.array([sizes[np.array(groups) == group].max() for group in groups])
    for j, (parameter, x) in enumerate(values.items()):
        exact = steps(lambda x, by=parameter: f.peaks(**{by: x}).value, x, 2e-5)
        gaps = np.abs(gradient.slopes[:, j] - exact) * abs(x) / sizes
        assert np.nanmax(gaps) <= (1e-5 if strong else 1e-6), (parameter, np.nanargmax(gaps))
        if not strong:
            exact = steps(lambda x, by=parameter: f.gradient(**{by: x}).slopes, x, 1e-4)
            gaps = (np.abs(bends[:, :, j] - exact) * np.abs(p * x)).max(axis=1)
            most = sizes + np.nanmax(np.abs(bends) * np.abs(p[:, None] * p), axis=(1, 2))
            assert np.nanmax(gaps / most) <= 1e-6, (parameter, np.nanargmax(gaps / most))


def rotor(**motion):
    """A link that turns; no gravity.

    Its axial force at the base is the density's first moment times the square of the rate.
    """
    m = Mechanism("rotor")
    m.set_gravity(0, 0)
    speed, l = m.parameter("speed", 20.0, "rad/s"), m.parameter("l", 0.4, "m")
    heavy, taper = m.parameter("heavy", 3.0, "kg/m"), m.parameter("taper", -1.0, "kg/m")
    arm = m.link("arm", length=l, density=density(heavy, taper))
    m.revolute("O", m.ground, arm)
    return m, speed, l


MOMENT = 3.0 / 2 - 1.0 / 3
"""The first moment of its density, for a length of one."""


@pytest.mark.parametrize("asked", ["times", "over", "samples"])
def test_a_peak_at_an_end_goes_with_the_end(asked):
    """The link speeds up as 10 t^2: at the last instant T its place and rate, 20 T, are largest,
    and T goes with the speed, or with its root.
    """
    m, speed, _ = rotor()
    law = polynomial(0.0, 0.0, 10.0)
    if asked == "samples":
        times = np.linspace(0.0, 1.5, 16)
        law = samples(times, (10 * times**2).tolist())
    at = {"t": (0.0, speed / 20, 21)} if asked == "times" else {"over": ("O", 0.1, speed / 2, 21)}
    f = prepare(Scene(m, {"O": law}, t=(0.0, 1.0, 21)), wanted=["section", "motion"], **at)
    gradient, bends = f.gradient(), f.curvature()["section:arm:axial"]
    for of in (f.gradient(), f.curvature()):
        with pytest.raises(UnknownNameError, match="unknown quantity with a peak"):
            of["effort:A", "section:arm:axial"]
    k = f.quantities.index("section:arm:axial")
    assert gradient.kinds[k] == END
    size = 0.4**2 * MOMENT
    assert gradient.value[k] == pytest.approx(size * 400.0, rel=1e-12)
    # The square of the rate is that of the speed, or 20 times the speed.
    by_speed, by_both, twice = (40.0, 80.0, 2.0) if asked == "times" else (20.0, 40.0, 0.0)
    slopes = gradient["section:arm:axial"]
    assert slopes["speed"] == pytest.approx(size * by_speed, rel=1e-12)
    assert slopes["l"] == pytest.approx(2 * gradient.value[k] / 0.4, rel=1e-12)
    assert bends["speed"]["speed"] == pytest.approx(size * twice, rel=1e-11, abs=1e-9)
    assert bends["speed"]["l"] == pytest.approx(size * by_both / 0.4, rel=1e-11)


@pytest.mark.parametrize("asked", ["times", "over"])
def test_means_go_with_instants_that_move(asked):
    """A torque of size * t over the time T: its mean is size T/2, its rms size T/sqrt(3) but for
    trapezia.
    """
    m, speed, _ = rotor()
    size = m.parameter("size", 7.0, "N m/s")
    m.torque("brake", m.bodies["arm"], -size * m.time)
    at = {"t": (0.0, 2.0 / speed, 41)} if asked == "times" else {"over": ("O", 0.0, 2.0, 41)}
    f = prepare(Scene(m, {"O": polynomial(0.0, speed)}, t=(0.0, 0.1, 41)), wanted=["effort"], **at)
    gradient, end = f.gradient(), 2.0 / 20.0
    assert f.efforts == gradient.efforts == ("effort:O",)
    peaks = f.peaks()
    assert peaks.mean[0] == pytest.approx(7.0 * end / 2, rel=1e-12)
    assert gradient.mean["effort:O"]["size"] == pytest.approx(end / 2, rel=1e-12)
    assert gradient.mean["effort:O"]["speed"] == pytest.approx(-7.0 * end / 2 / 20, rel=1e-12)
    assert gradient.rms["effort:O"]["size"] == pytest.approx(peaks.rms[0] / 7.0, rel=1e-12)
    assert gradient.rms["effort:O"]["speed"] == pytest.approx(-peaks.rms[0] / 20, rel=1e-12)
    assert abs(gradient.mean["effort:O"]["l"]) <= 1e-14
    scene = Scene(m, {"O": polynomial(0.0, speed)}, t=(0.0, 0.1, 41))
    changes = sensitivities(scene, evaluate(scene, certificate=False))
    for word, told in (("mean", peaks.mean[0]), ("rms", peaks.rms[0])):
        change = getattr(changes, word)("effort:O")
        assert [change.value, change.slopes["size"]] == pytest.approx([told, told / 7.0])


def pendulum():
    """It swings as far to either side.

    With a bias the effort on one side grows as that on the other shrinks; with the rest not.
    """
    m = Mechanism("pendulum")
    m.set_gravity(0, 0)
    l = m.parameter("l", 0.8, "m")
    swing = m.parameter("swing", 0.6, "rad")
    bias = m.parameter("bias", 0.0, "N m")
    arm = m.link("arm", length=l, mass=2.0)
    m.revolute("O", m.ground, arm)
    m.torque("twist", arm, bias)
    return Scene(m, {"O": harmonic(0.0, swing, 1.0)}, t=(0.0, 1.0, 38))


@pytest.mark.parametrize("backend", ["auto", "c"])
def test_a_pendulum_ties_where_a_bias_tells_its_sides_apart(backend):
    scene = pendulum()
    f = prepare(scene, wanted=["effort"], backend=backend)
    gradient = f.gradient()
    assert gradient.tied.tolist() == [True]
    # The largest size grows with the bias whichever sign this has: it has a kink.
    sizes = [abs(f.peaks(bias=bias).value[0]) for bias in (-1e-3, 0.0, 1e-3)]
    assert [sizes[0], sizes[2]] == pytest.approx([sizes[1] + 1e-3] * 2, abs=1e-9)
    assert abs(gradient["effort:O"]["bias"]) == pytest.approx(1.0, abs=1e-12)
    # With a bias of its own one side is larger.
    assert f.gradient(bias=0.1).tied.tolist() == [False]
    assert f.gradient(bias=1e-7).tied.tolist() == [False]
    for bias, tied in ((0.0, True), (0.1, False)):
        solution = evaluate(scene, parameters={"bias": bias}, certificate=False)
        assert sensitivities(scene, solution).peak("effort:O").tied is tied


def test_what_ties_along_a_link():
    """A force at the tip, and one of twice its size against it in the middle: the shear is as large
    on both sides, and grows with either's distance from that.
    """
    m = Mechanism("bar")
    m.set_gravity(0, 0)
    tip, middle = m.parameter("tip", 10.0, "N"), m.parameter("middle", 20.0, "N")
    arm = m.link("arm", length=1.0, mass=1.0)
    m.revolute("O", m.ground, arm)
    m.force("pull", arm.tip, y=tip)
    m.force("push", arm.at(0.5), y=-middle)
    f = prepare(Scene(m, {"O": polynomial(0.0)}, wanted=["section", "effort"], t=(0.0, 1.0, 5)))
    k, gradient = f.quantities.index("section:arm:shear"), f.gradient()
    assert np.flatnonzero(gradient.tied).tolist() == [k]
    assert not f.gradient(middle=20.5).tied.any()
    assert abs(gradient["section:arm:shear"]["tip"]) == pytest.approx(1.0)
    for value in (9.9, 10.1):
        assert abs(f.peaks(tip=value).value[k]) == pytest.approx(10.1)


@pytest.mark.parametrize("backend", ["auto", "c"])
def test_slopes_of_what_friction_at_rest_has_nothing_to_do_with(backend):
    """There they are no numbers only of what depends on friction: of peaks at rest, and of means
    over all instants, of an arm beside a slide that rubs and rests.
    """
    m = Mechanism("beside")
    l, mu = m.parameter("l", 0.4, "m"), m.parameter("mu", 0.15)
    ram = m.link("ram", length=0.05, mass=2.0, centre=(0.0, 0.0), inertia=1e-3)
    m.friction("rub", m.prismatic("bore", m.ground, ram, axis=(1, 0)), mu=mu, length=0.06)
    m.revolute("O", m.ground.at(1.0, 0.0), m.link("arm", length=l, mass=3.0))
    laws = {
        joint: moves([dwell(0.2), move(by=by, time=0.3), dwell(0.2)])
        for joint, by in (("bore", 0.1), ("O", 1.0))
    }
    scene = Scene(m, laws, wanted=["effort", "reaction", "friction"], t=(0, 0.7, 36))
    f = prepare(scene, backend=backend)
    gradient, at = f.gradient(), f.efforts.index("effort:O")
    for name, bears in (("resultant", 19.62), ("fy", 19.62), ("fx", 0.0), ("mz", 0.0)):
        k = f.quantities.index(f"reaction:bore:{name}")
        assert abs(gradient.value[k]) == pytest.approx(bears)
        assert gradient.slopes[k].tolist() == [0.0, 0.0]
    for word in ("mean", "rms"):
        exact = steps(lambda l, word=word: getattr(f.peaks(l=l), word), 0.4, 1e-4)[at]
        assert getattr(gradient, word)["effort:O"]["l"] == pytest.approx(exact, rel=1e-6)
    # A friction of none at all has its peak at an instant that counts.
    along = f.quantities.index("friction:rub:along")
    assert f.peaks(mu=0.0).t[along] == pytest.approx(0.22)
    found = tolerances(scene, {"l": "1mm", "mu": 0.01}, samples=20, backend=backend)
    spread = found.peaks["reaction:bore:fx"]
    assert (spread.worst, spread.sigma) == (0.0, 0.0)
