"""Instants that are asked for by expressions of parameters, and by a drive's coordinate."""

import math
import pickle

import casadi as ca
import h5py
import numpy as np
import pytest
import xarray
from forging import edit
from internals import MechanismDrawing, SectionMaps, SpanPlot, TimePlot, Timing, shortfall
from mechanisms import driven_slider, press, slider_crank, uneven

from lagrange_casadi import Mechanism, Scene, check, evaluate, load, motion, refine, save
from lagrange_casadi.errors import DeclarationError, SizeError, UnknownNameError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

TURN = math.tau
PEAKS = ["effort:O", "reaction:O:fx", "section:rod:bending"]


def test_bounds_of_time_are_expressions_of_parameters():
    """A whole turn at any speed, as if its bounds were given in numbers."""
    scene = press(t=lambda rpm: (0, 60 / rpm, 37))
    for rpm in (600.0, 45.0):
        found = evaluate(scene, parameters={"rpm": rpm})
        expected = evaluate(press(t=(0, 0.1, 37)), parameters={"rpm": rpm}, t=(0, 60 / rpm, 37))
        for name in expected.series:
            np.testing.assert_array_equal(found.series[name], expected.series[name], err_msg=name)
        assert found.motion("O").value[-1] == pytest.approx(TURN, rel=1e-15)


def test_other_bounds_than_the_scenes_are_expressions_too():
    scene = press()
    rpm = scene.mechanism.parameters["rpm"].symbol
    assert (
        evaluate(scene, t=(0.0, 120 / rpm, 5), parameters={"rpm": 40.0}, wanted=["effort"]).t[-1]
        == 3.0
    )
    found = evaluate(
        scene, over=("O", rpm / 600, rpm / 100, 5), wanted=["motion"], parameters={"rpm": 300.0}
    )
    np.testing.assert_allclose(found.motion("O").value, np.linspace(0.5, 3.0, 5), rtol=1e-15)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("law", [motion.polynomial, uneven])
@pytest.mark.parametrize("rpm", [600.0, 77.0])
def test_instants_over_a_drive_are_equal_steps_of_it(law, rpm):
    """What is found at them is what is found at the same times, and the mechanism is at the same
    angles at any speed.
    """
    scene = press(law, over=("O", 0.5, 0.5 + 2 * TURN, 145))
    found = evaluate(scene, parameters={"rpm": rpm})
    np.testing.assert_allclose(found.over.values, 0.5 + 2 * TURN * np.arange(145) / 144, rtol=1e-15)
    np.testing.assert_allclose(found.motion("O").value, found.over.values, rtol=0, atol=4e-15)
    assert (found.over.joint, found.over.unit) == ("O", "rad")
    assert (np.diff(found.t) > 0.0).all()
    assert found.certified
    slow = evaluate(scene, parameters={"rpm": 30.0})
    np.testing.assert_allclose(found.pose("ram").y, slow.pose("ram").y, rtol=1e-14)


@pytest.mark.parametrize("rpm", [30.0, 900.0])
def test_efforts_over_a_drive_are_those_of_a_textbook(rpm):
    """A rod of 0.5 kg and 0.4 m about its end: I a + m g l/2 cos(angle), at the angles and times
    that were asked for.
    """
    m = Mechanism("fan")
    speed = m.parameter("rpm", 600.0, "1/min")
    m.revolute("O", m.ground, m.link("blade", length=0.4, mass=0.5))
    scene = Scene(m, {"O": uneven(0, speed * TURN / 60)}, over=("O", "-90 deg", "630 deg", 145))
    found, w = evaluate(scene, parameters={"rpm": rpm}), rpm * TURN / 60
    angle = np.radians(np.linspace(-90, 630, 145))
    inertia, weight = 0.5 * 0.4**2 / 3, 0.5 * 9.81 * 0.2
    expected = -0.2 * w**2 * np.sin(w * found.t) * inertia + weight * np.cos(angle)
    np.testing.assert_allclose(
        found.effort("O"), expected, rtol=0, atol=1e-12 * np.abs(expected).max()
    )
    np.testing.assert_allclose(
        w * found.t + 0.2 * np.sin(w * found.t), angle, rtol=0, atol=1e-14 * 11
    )


@pytest.mark.parametrize("law", [motion.polynomial, uneven])
def test_refined_peaks_do_not_depend_on_how_instants_were_asked_for(law):
    """Between unequal instants as between equal ones, with the drive's coordinate at the peak."""
    scene = press(law)
    over, even = evaluate(scene, over=("O", 0, TURN, 91)), evaluate(scene, t=(0, 0.1, 91))
    assert over.t[-1] == pytest.approx(0.1, rel=1e-15)
    for one, other in zip(refine(scene, over, PEAKS), refine(scene, even, PEAKS), strict=True):
        assert one.value == pytest.approx(other.value, rel=1e-13)
        assert one.t == pytest.approx(other.t, abs=1e-9)
        w = 20 * math.pi
        assert one.over == pytest.approx(
            w * one.t + (0.2 * math.sin(w * one.t) if law is uneven else 0.0), abs=1e-13
        )
        assert other.over is None


def test_few_instants_over_a_drive_miss_no_peak():
    """Even where its motion makes them far apart in time."""
    scene = press(uneven)
    few, many = (evaluate(scene, over=("O", 0, TURN, count)) for count in (31, 721))
    for one, other in zip(refine(scene, few, PEAKS), refine(scene, many, PEAKS), strict=True):
        assert one.value == pytest.approx(other.value, rel=1e-9)


def test_a_drive_that_turns_backwards_goes_from_the_higher_angle_to_the_lower():
    m = press(lambda zero, w: motion.polynomial(zero, -w))
    found = evaluate(m, over=("O", "360 deg", 0, 73), wanted=["motion", "effort"])
    assert found.t[0] == pytest.approx(-0.1, rel=1e-15)
    assert found.t[-1] == 0.0
    np.testing.assert_allclose(found.motion("O").value, found.over.values, atol=2e-15)


def test_a_slide_is_a_drive_too():
    scene = driven_slider()
    joint, law = next(iter(scene.motion.items()))
    first, last = (float(law.graph(ca.DM(t))) for t in (scene.t[0], scene.t[0] + 0.02))
    found = evaluate(scene, over=(joint, first, last, 9))
    assert (found.over.unit, found.over.label) == ("m", f"{joint} [m]")
    with pytest.raises(
        DeclarationError,
        match=r"STOP: expected a number \[m\], or a text such as '100 mm', got '3 deg'",
    ):
        evaluate(scene, over=(joint, 0.0, "3 deg", 9))


def test_a_swing_is_followed_from_the_start_of_t():
    """Back and forth are two stretches of one motion; the start of t tells which is meant."""
    law = motion.harmonic(1.0, 0.4, 2.0)
    forth = press(lambda *_: law, over=("O", 0.7, 1.3, 9))
    back = press(lambda *_: law, over=("O", 1.3, 0.7, 9), t=(0.25, 1, 2))
    np.testing.assert_allclose(evaluate(forth).t + evaluate(back).t[::-1], 0.25, atol=1e-15)
    with pytest.raises(DeclarationError, match=r"runs opposite to the range from 1\.3 rad"):
        press(lambda *_: law, over=("O", 1.3, 0.7, 9))


def test_what_is_asked_for_can_be_sent_and_compared():
    scene = press(t=lambda rpm: (0, 60 / rpm, 9), over=lambda rpm: ("O", 0, rpm / 50, 9))
    timing = scene.timing()
    assert pickle.loads(pickle.dumps(timing)) == timing
    assert timing != scene.timing(over=("O", 0, 12.0, 9))
    assert scene.timing(t=(0, 1, 9)) == Timing(0.0, 1.0, 9)
    assert scene.timing(t=(0, 1, 9)).words(scene.mechanism.symbols) == [0.0, 1.0, 9]
    start, stop, *rest = timing.words(scene.mechanism.symbols)
    assert (start, rest) == (0.0, [9, "O", 0.0])
    assert stop.startswith("(rpm/50) #")


@pytest.mark.parametrize(
    ("over", "says"),
    [
        (("O", 0, 1), "over: expected (joint, start, stop, count), got ('O', 0, 1)"),
        ("O=0:1:5", "over: expected (joint, start, stop, count), got 'O=0:1:5'"),
        (("O", 0, 1, 1), "over: COUNT must be 2 or more"),
        (("O", 0, 1, 0), "over: COUNT must be a whole number from 1 to 2^63 - 1, got 0"),
        (("O", 1, 1, 5), "over: STOP must be after START, got 1 and 1"),
        (("O", 0, math.inf, 5), "over: START and STOP must be finite"),
        (
            ("O", "-1e308 rad", "1e308 rad", 5),
            "over: START and STOP are too far apart, got -1e+308 and 1e+308",
        ),
        (
            ("O", 0, "1 lap", 5),
            "over: STOP: expected a number [rad], or a text such as '350 deg'",
        ),
        (
            ("O", 1, 0, 5),
            (
                "over: the motion of joint 'O' runs opposite to the range from 1 rad"
                " (57.2958 deg) to 0 rad (0 deg)"
            ),
        ),
        (("O", 0, ca.SX.sym("q"), 5), "over: STOP depends on 'q', not a parameter"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(over, says):
    scene = press()
    for ask in (lambda: evaluate(scene, over=over), lambda: press(over=over)):
        with pytest.raises(DeclarationError) as caught:
            ask()
        assert str(caught.value).startswith(says)


def test_a_joint_that_is_not_driven_is_refused_by_name():
    with pytest.raises(UnknownNameError, match="unknown driven joint in over 'guide'; valid: O"):
        evaluate(press(), over=("guide", 0, 1, 5))


@pytest.mark.parametrize(
    ("law", "says"),
    [
        (
            motion.polynomial(0.3),
            "is at rest and does not go from 0 rad (0 deg) to 6.28319 rad (360 deg)",
        ),
        (
            motion.harmonic(0, 1, 1),
            ("does not go from 0 rad (0 deg) to 6.28319 rad (360 deg): it reverses at t = 0.25 s"),
        ),
        (
            motion.samples([0, 1, 2, 3], [0, 1, 2, 3]),
            "its samples end at t = 3 s, at 3 rad (171.887 deg)",
        ),
    ],
)
def test_a_motion_that_does_not_get_there_is_refused_by_what_it_does(law, says):
    with pytest.raises(DeclarationError) as caught:
        evaluate(press(lambda *_: law), over=("O", 0, TURN, 5))
    assert says in str(caught.value)
    assert "the motion of joint 'O'" in str(caught.value)


@pytest.mark.parametrize("law", [motion.polynomial, uneven])
def test_more_instants_than_memory_holds_are_refused(law):
    with pytest.raises(SizeError, match="the outputs over time"):
        evaluate(press(law), over=("O", 0, TURN, 10**12))


def test_t_and_over_exclude_each_other():
    with pytest.raises(DeclarationError, match="t and over exclude each other"):
        evaluate(press(), t=(0, 1, 5), over=("O", 0, 1, 5))


def test_bounds_that_parameters_make_impossible_are_told_with_them():
    scene = press(t=lambda rpm: (0, 60 / rpm, 9))
    with pytest.raises(
        DeclarationError,
        match=r"t: STOP must be after START, got 0 and -1; with the parameters rpm = -60, l = ",
    ):
        evaluate(scene, parameters={"rpm": -60.0})
    with pytest.raises(
        DeclarationError,
        match="t: START and STOP must be finite, got 0 and inf; with the parameters rpm = 0",
    ):
        evaluate(scene, parameters={"rpm": 0.0})
    with pytest.raises(
        DeclarationError,
        match=r"the motion of joint 'O' is at rest.*; with the parameters rpm = 0, l = ",
    ):
        evaluate(scene, over=("O", 0, 1, 5), parameters={"rpm": 0.0})


def test_a_scene_is_assembled_where_its_drive_starts():
    """The posture is that of the first instant, which the drive's coordinate decides."""
    late = press(over=("O", math.pi, 3 * math.pi, 9))
    assert late.span == pytest.approx((0.05, 0.15))
    np.testing.assert_allclose(
        evaluate(late).pose("ram").y, evaluate(press(), t=(0.05, 0.15, 9)).pose("ram").y, rtol=1e-14
    )


def test_how_far_peaks_fall_short_is_told_over_a_drive():
    rows = shortfall(
        press(wanted=["effort"]), [25, 50], over=("O", 0, TURN, 25), parameters={"rpm": 100.0}
    )
    expected = shortfall(
        press(wanted=["effort"]), [25, 50], t=(0, 0.6, 25), parameters={"rpm": 100.0}
    )
    assert rows == expected


@pytest.fixture
def kept(tmp_path):
    solution = evaluate(slider_crank(), over=("O", 0, TURN, 31))
    save(solution, tmp_path / "x.h5")
    return solution, tmp_path / "x.h5"


def test_a_file_keeps_the_drives_coordinate(kept):
    solution, path = kept
    back = load(path)
    np.testing.assert_array_equal(back.over.values, solution.over.values)
    assert (back.over.joint, back.over.unit) == ("O", "rad")
    assert back.peak("effort:O") == solution.peak("effort:O")
    assert check(path) == []
    with h5py.File(path) as file:
        assert dict(file["over"].attrs)["long_name"] == "coordinate of joint 'O'"
    for engine in ("h5netcdf", "netcdf4"):
        with xarray.open_dataset(path, engine=engine) as read:
            assert read.coords["over"].dims == ("t",)
            np.testing.assert_array_equal(read.coords["over"], solution.over.values)


def test_xarray_has_the_drives_coordinate_beside_time(kept):
    solution, _ = kept
    data = solution.to_xarray().swap_dims(t="over")
    assert data["over"].attrs == {"units": "rad", "long_name": "coordinate of joint 'O'"}
    assert float(data["effort:O"].sel(over=math.pi, method="nearest")) == solution.effort("O")[15]


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (
            lambda file: file["over"].write_direct(np.asarray(file["over"]) ** 2),
            "over: not in equal steps",
        ),
        (
            lambda file: file["over"].write_direct(np.asarray(file["over"]) + 1e-9),
            "over: not the coordinate of joint 'O'",
        ),
    ],
)
def test_check_holds_the_drives_coordinate_to_the_motion(kept, spoil, says):
    _, path = kept
    edit(path, spoil)
    assert says in check(path)


def test_check_allows_for_the_digits_of_times_far_from_zero(tmp_path):
    """After a million seconds a double of time is 1e-10 s, in which this
    crank turns by 6e-9 rad.
    """
    scene = press(lambda _, w: motion.expression(lambda t: w * (t - 1e6)), over=("O", 0, TURN, 9))
    save(evaluate(scene), tmp_path / "x.h5")
    assert check(tmp_path / "x.h5") == []


def test_figures_are_over_the_drives_angle_in_degrees(kept):
    solution, _ = kept
    axes = TimePlot("effort", ("effort:O",)).draw(solution).axes[0]
    assert axes.get_xlabel() == "O [deg]"
    np.testing.assert_allclose(axes.get_lines()[0].get_xdata(), np.linspace(0, 360, 31), rtol=1e-15)
    maps = SectionMaps("maps", "rod").draw(solution)
    assert "at O = " in maps.axes[0].get_title()
    peak = solution.peak("section:rod:axial")
    np.testing.assert_array_equal(
        maps.axes[0].get_lines()[0].get_xdata(), [math.degrees(peak.over)]
    )
    assert (
        SpanPlot("span", "section:rod:axial", peak.t)
        .draw(solution)
        .axes[0]
        .get_title()
        .endswith(" deg")
    )
    drawing = MechanismDrawing(count=2).draw(solution)
    assert drawing.axes[1].get_title().endswith("\nO = 180 deg")


def test_a_scene_over_a_drive_says_so():
    assert repr(press(over=("O", 0, 1, 5))).endswith("wants all, 5 instants over O from 0 to 1>")
    assert isinstance(press(t=lambda rpm: (0, 60 / rpm, 9)), Scene)
