"""Angles as people type them: wherever one may be typed, and refused where it is none."""

import math

import numpy as np
import pytest
from commands import words
from hypothesis import given
from hypothesis import strategies as st
from internals import Range, Sweep, Values, angle, best, chosen, sweep
from mechanisms import four_bar

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.mark.parametrize(
    ("typed", "value"),
    [
        (1.2, 1.2),
        (-2, -2.0),
        ("1.2 rad", 1.2),
        ("1.2rad", 1.2),
        ("180 deg", math.pi),
        ("350deg", 350 / 180 * math.pi),
        (" -90  deg ", -math.pi / 2),
        ("1e2deg", 100 / 180 * math.pi),
        (np.float64(0.5), 0.5),
    ],
)
def test_what_is_an_angle(typed, value):
    assert angle(typed) == value


@given(st.floats(-1e6, 1e6))
def test_degrees_are_degrees(value):
    assert angle(f"{value!r} deg") == value / 180 * math.pi
    assert angle(value) == angle(f"{value!r}rad") == value


@pytest.mark.parametrize(
    "typed",
    [
        "",
        "deg",
        "1.2",
        "90 grad",
        "90 degrees",
        "1_0 deg",
        "nan",
        "inf deg",
        math.inf,
        math.nan,
        None,
        True,
        (1,),
        "1 2 deg",
        2j,
    ],
)
def test_what_is_no_angle(typed):
    with pytest.raises(
        ValueError,
        match=r"^expected a finite number \[rad\], or a text such as '350 deg' or '1\.2 rad', got ",
    ):
        angle(typed)
    with pytest.raises(DeclarationError):
        angle(typed)


def pendulum(**keywords):
    m = Mechanism("pendulum")
    tilt = m.parameter("tilt", 0.5, "rad", low=0.0, high=1.0)
    l = m.parameter("l", 0.3, "m", low=0.0)
    arm, hand = m.link("arm", length=l, mass=1.0), m.link("hand", length=0.1, mass=0.5)
    m.revolute("O", m.ground, arm)
    m.weld("fist", arm.tip, hand, **keywords or {"angle": tilt})
    return Scene(m, {"O": polynomial(0, 1.0)}, t=(0, 1, 5))


def test_a_posture_may_be_told_in_degrees():
    """The same branch, to the bit: what is kept of it are radians."""
    plain = four_bar()
    scene = Scene(plain.mechanism, plain.motion, t=plain.t, posture={"c": "85 deg"})
    assert dict(scene.posture) == {"c": 85 / 180 * math.pi}
    np.testing.assert_array_equal(
        evaluate(scene).motion("C").value, evaluate(plain).motion("C").value
    )


@pytest.mark.parametrize(
    ("posture", "says"),
    [
        (
            {"c": 85},
            r"posture of 'c': 85 rad is 4870.14 deg, more than two turns; '85 deg' is 85 degrees$",
        ),
        (
            {"c": -12.6},
            r"posture of 'c': -12.6 rad is -721.927 deg, more than two turns; '-12.6 deg' is",
        ),
        ({"c": "800 deg"}, r"posture of 'c': 13.9626 rad is 800 deg, more than two turns$"),
        (
            {"c": "north"},
            (
                r"posture of 'c': expected a finite number \[rad\], or a text such as '350 deg' or"
                r" '1.2 rad', got 'north'"
            ),
        ),
        ({"c": math.nan}, r"posture of 'c': expected a finite number"),
    ],
)
def test_a_posture_in_degrees_without_the_word_is_refused(posture, says):
    plain = four_bar()
    with pytest.raises(DeclarationError, match=says):
        Scene(plain.mechanism, plain.motion, t=plain.t, posture=posture)


def test_two_turns_are_a_posture():
    plain = four_bar()
    assert Scene(plain.mechanism, plain.motion, t=plain.t, posture={"c": -4 * math.pi}).posture == {
        "c": -4 * math.pi
    }


def test_a_slide_is_at_no_angle():
    m = Mechanism("slide")
    m.prismatic("guide", m.ground, m.point_mass("block", 1.0), axis=(1, 0))
    with pytest.raises(
        DeclarationError,
        match=(
            r"posture of 'guide': expected a finite number \[m\], or a text such as '100 mm', got"
            r" '2 deg'"
        ),
    ):
        Scene(m, {"guide": polynomial(0, 1)}, posture={"guide": "2 deg"})


def test_parameters_that_are_angles_may_be_told_in_degrees():
    scene = pendulum()
    told, plain = (
        evaluate(scene, parameters={"tilt": value}).effort("O")
        for value in ("30 deg", 30 / 180 * math.pi)
    )
    np.testing.assert_array_equal(told, plain)
    first = Scene(scene.mechanism, scene.motion, t=scene.t, assembly={"tilt": "30 deg"})
    assert first.assembly == {"tilt": 30 / 180 * math.pi}
    with pytest.raises(
        ParameterError,
        match=r"parameter 'l' must be a number \[m\], or a text such as '100 mm', got '30 deg'",
    ):
        evaluate(scene, parameters={"l": "30 deg"})
    with pytest.raises(
        ParameterError,
        match=(
            r"parameter 'tilt' must be a number \[rad\], or a text such as '350 deg' or '1.2 rad',"
            r" got 'steep'"
        ),
    ):
        evaluate(scene, parameters={"tilt": "steep"})
    with pytest.raises(
        ParameterError, match=r"parameter 'tilt' = 1\.57\d* rad is out of its range \[0, 1\]"
    ):
        evaluate(scene, parameters={"tilt": "90 deg"})


def test_parameters_are_declared_in_degrees():
    m = Mechanism("m")
    m.parameter("tilt", "30 deg", "rad", low="-10 deg", high="90 deg")
    tilt = m.parameters["tilt"]
    assert (tilt.default, tilt.low, tilt.high) == (
        30 / 180 * math.pi,
        math.radians(-10),
        math.radians(90),
    )
    with pytest.raises(DeclarationError, match=r"parameter 'lean': expected a number \[rad\]"):
        m.parameter("lean", "much", "rad")
    assert list(m.parameters) == ["tilt"]


def test_welds_and_slides_take_degrees():
    told, plain = (
        evaluate(pendulum(angle=value)).effort("O") for value in ("60 deg", math.radians(60))
    )
    np.testing.assert_array_equal(told, plain)
    with pytest.raises(
        DeclarationError, match=r"joint 'fist': angle: expected a finite number \[rad\], or a text"
    ):
        pendulum(angle="sixty")


def geared(offset, slides=False):
    m = Mechanism("geared")
    arm, hand = m.link("arm", length=0.3, mass=1.0), m.link("hand", length=0.1, mass=0.5)
    first = m.revolute("O", m.ground, arm)
    second = (
        m.prismatic("P", m.ground, hand, axis=(1, 0)) if slides else m.revolute("P", arm.tip, hand)
    )
    m.gear("mesh", first, second, ratio=2.0, offset=offset)
    return Scene(m, {"O": polynomial(0, 1.0)}, t=(0, 1, 5))


def test_offsets_of_gears_take_degrees():
    told, plain = (
        evaluate(geared(value)).motion("P").value for value in ("60 deg", 60 / 180 * math.pi)
    )
    np.testing.assert_array_equal(told, plain)
    assert told[0] == pytest.approx(math.pi / 3)
    with pytest.raises(
        DeclarationError,
        match=r"gear 'mesh': offset: expected a finite number \[rad\], or a text such as '350 deg'",
    ):
        geared("sixty")
    with pytest.raises(
        DeclarationError,
        match=(
            r"gear 'mesh': offset: expected a finite number \[m\], or a text such as '100 mm', got"
            r" '60 deg'"
        ),
    ):
        geared("60 deg", slides=True)


def test_grids_and_conditions_take_degrees(tmp_path):
    """A sweep is the same, to the byte, however its angles were told; lengths in degrees are
    refused.
    """
    scene, steps = pendulum(), 30 / 180 * math.pi
    for name, axis in (
        ("a", ("0 deg", "30 deg", 4)),
        ("b", (0.0, steps, 4)),
        ("c", Range("0deg", "30deg", 4)),
    ):
        sweep(scene, {"tilt": axis}, out=tmp_path / f"{name}.h5", wanted=["effort"])
    assert (
        (tmp_path / "a.h5").read_bytes()
        == (tmp_path / "b.h5").read_bytes()
        == (tmp_path / "c.h5").read_bytes()
    )
    assert Values(("10 deg", 0.5)).values == (10 / 180 * math.pi, 0.5)
    found = Sweep.open(tmp_path / "a.h5")
    for text, numbers in (("tilt<15deg", [0, 1]), ("tilt>=20 deg", [2, 3]), ("tilt==10deg", [1])):
        rows = np.concatenate([rows for rows, _ in chosen(found, ["tilt"], text)])
        assert rows.tolist() == numbers
    with pytest.raises(
        DeclarationError, match=r"condition on peak:effort:O: it is in N m, got an angle"
    ):
        best(found, minimise="peak:effort:O", where="peak:effort:O<3deg")
    for axis in (("0 deg", "30 deg", 4), ["10 deg"]):
        with pytest.raises(
            DeclarationError, match=r"grid of l: expected numbers \[m\], not angles"
        ):
            sweep(scene, {"l": axis}, out=tmp_path / "d.h5")
    for axis in (("a", "b", 3), ["steep"]):
        with pytest.raises(DeclarationError, match=r"grid of tilt: expected .*numbers"):
            sweep(scene, {"tilt": axis}, out=tmp_path / "d.h5")
    with pytest.raises(ParameterError, match=r"tilt = 0 to 1\.57.*, out of its range"):
        sweep(scene, {"tilt": ("0 deg", "90 deg", 4)}, out=tmp_path / "d.h5")


def test_the_command_line_takes_degrees(here, capfd):
    (here / "case.py").write_text(
        "from lagrange_casadi import Mechanism, Scene\nfrom lagrange_casadi.motion import"
        " polynomial\ndef scene():\n    m = Mechanism('pendulum')\n    arm, hand = m.link('arm',"
        " length=m.parameter('l', 0.3, 'm'), mass=1.0), m.link('hand', length=0.1, mass=0.5)\n   "
        " m.revolute('O', m.ground, arm)\n    m.weld('fist', arm.tip, hand,"
        " angle=m.parameter('tilt', 0.5, 'rad'))\n    return Scene(m, {'O': polynomial(0, 1.0)},"
        " t=(0, 1, 5))\n"
    )
    for name, value in (("a", "30 deg"), ("b", repr(30 / 180 * math.pi))):
        assert (
            main(
                ["run", "case.py", "--no-figures", "--set", f"tilt={value}", "--out", f"{name}.h5"]
            )
            == 0
        )
    assert (here / "a.h5").read_bytes() == (here / "b.h5").read_bytes()
    assert main(["run", "case.py", "--set", "l=30deg"]) == 2
    assert (
        "error: parameter 'l' must be a number [m], or a text such as '100 mm', got '30deg'"
        in capfd.readouterr().err
    )
    assert main(["run", "case.py", "--set", "tilt=30grad"]) == 2
    assert (
        "expected NAME=VALUE with a number in SI units, as in l=0.25 or phi=30deg, got"
        in capfd.readouterr().err
    )
    sweep = words(
        "sweep case.py --grid tilt=0:1:3 --grid l=0.2:0.4:3 --quiet --want effort --out s.h5"
    )
    assert main(sweep) == 0
    assert main([*sweep[:4], *sweep[6:-1], "t.h5", "--set", "l=2deg"]) == 2
    degrees = words("sweep case.py --grid tilt=0deg:90deg:3 --grid l=0.2,0.4 --quiet --out d.h5")
    assert main(degrees) == 0
    assert main([*degrees[:3], "tilt=0,45 deg,90deg", *degrees[4:-1], "e.h5"]) == 0
    assert (here / "d.h5").read_bytes() == (here / "e.h5").read_bytes()
    capfd.readouterr()
    assert main(["best", "d.h5", "--minimise", "peak:effort:O", "--where", "tilt>60deg"]) == 0
    assert "1.5708" in capfd.readouterr().out
    assert main(["table", "d.h5", "--where", "tilt==50deg"]) == 1
    assert main([*degrees[:3], "l=0deg:2deg:3", *degrees[6:-1], "t.h5"]) == 2
    assert "error: grid of l: expected numbers [m], not angles" in capfd.readouterr().err
    assert main([*degrees[:3], "tilt=0:90grad:3", *degrees[6:-1], "t.h5"]) == 2
    assert "tilt: expected a number for STOP, got '90grad' in 0:90grad:3" in capfd.readouterr().err
    assert main(["plot", "s.h5", "--out", "one", "--over", "l", "--at", f"tilt={0.5}"]) == 0
    assert (
        main(["plot", "s.h5", "--out", "two", "--over", "l", "--at", "tilt=28.64788975654116deg"])
        == 0
    )
    assert [p.read_bytes() for p in sorted((here / "one").iterdir())] == [
        p.read_bytes() for p in sorted((here / "two").iterdir())
    ]
    capfd.readouterr()
    assert main(["plot", "s.h5", "--out", "three", "--over", "tilt", "--at", "l=2deg"]) == 2
    assert "--at: parameter 'l' is in m, got 2deg" in capfd.readouterr().err
