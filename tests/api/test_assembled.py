"""Scenes whose defaults cannot be assembled, and whose other parameters can."""

import re

import numpy as np
import pytest
from internals import refine

from lagrange_casadi import Mechanism, Scene, compile_scene, derive, evaluate, export, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.errors import AssemblyError, DeclarationError, ParameterError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

SHORT, LONG = (0.1, 0.05, 0.05), (0.1, 0.35, 0.25)
VALUES = dict(zip("pqr", LONG, strict=True))


def four_bar(lengths, rocker=1.5, **more):
    m = Mechanism("four_bar")
    sides = [
        m.parameter(name, length, "m", low=0.0) for name, length in zip("pqr", lengths, strict=True)
    ]
    a, b, c = (
        m.link(name, length=l, mass=w)
        for name, l, w in zip("abc", sides, (0.3, 0.5, 0.4), strict=True)
    )
    m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, c.tip)
    m.revolute("C", m.ground.at(0.3, 0.05), c)
    return Scene(m, {"O": polynomial(0.2, 6.0)}, posture={"c": rocker}, t=(0.0, 1.0, 101), **more)


def assert_same(one, other):
    assert set(one.series) == set(other.series)
    for name, values in one.series.items():
        np.testing.assert_array_equal(values, other.series[name], err_msg=name)


@pytest.mark.sampled(9)
@pytest.mark.parametrize("rocker", [1.5, -1.5])
@pytest.mark.parametrize(
    "options", [{}, {"backend": "vm"}, {"precision": "single"}, {"table": 64}], ids=str
)
def test_what_can_be_assembled_is_evaluated(options, rocker):
    """To the last bit what it is where these values are the defaults, in the branch that the
    posture tells.
    """
    found = evaluate(four_bar(SHORT, rocker), parameters=VALUES, **options)
    assert_same(found, evaluate(four_bar(LONG, rocker), **options))
    assert np.sign(np.sin(found.pose("c").angle[0])) == np.sign(rocker)


def test_one_after_another_each_is_assembled_with_its_own_values():
    scene = four_bar(SHORT)
    for q in (0.35, 0.3, 0.4, 0.35):
        assert_same(
            evaluate(scene, parameters=VALUES | {"q": q}), evaluate(four_bar((0.1, q, 0.25)))
        )


def test_where_defaults_serve_they_choose():
    """Nothing is derived anew for other parameters: it is the same graph."""
    scene = four_bar(LONG)
    program = derive(scene)
    evaluate(scene, parameters={"q": 0.4})
    assert derive(scene) is program


def test_a_scene_is_compiled_with_values_where_its_own_do_not_serve():
    """With those where they are needed, and only there; one that has been compiled so needs the
    scene no more.
    """
    with pytest.raises(AssemblyError):
        compile_scene(four_bar(SHORT), ["effort"])
    program = compile_scene(four_bar(SHORT), ["effort"], parameters=VALUES)
    own = compile_scene(four_bar(LONG), ["effort"])
    p = list(VALUES.values())
    t, motion = 0.1, program.motion(0.1, p)
    np.testing.assert_array_equal(
        program.instant(t, *motion, [], p).full(), own.instant(t, *motion, [], p).full()
    )
    scene = four_bar(LONG)
    assert compile_scene(scene, ["effort"], parameters={"q": 0.4}) is compile_scene(
        scene, ["effort"]
    )
    with pytest.raises(UnknownNameError):
        compile_scene(scene, ["effort"], parameters={"z": 1.0})


def test_it_is_said_with_what_it_was_tried():
    scene = four_bar(SHORT)
    with pytest.raises(
        AssemblyError,
        match=(
            r"at the start of the motion, .*; with the default parameters p = 0\.1, q = 0\.05, r ="
            r" 0\.05"
        ),
    ):
        evaluate(scene)
    with pytest.raises(
        AssemblyError,
        match=r"at the start of the motion, .*; with the parameters p = 1, q = 0\.05, r = 0\.05",
    ):
        evaluate(scene, parameters={"p": 1.0})


def test_a_scene_may_say_itself_with_what_it_is_assembled():
    scene = four_bar(SHORT, assembly=VALUES)
    derive(scene)
    assert_same(evaluate(scene, parameters=VALUES), evaluate(four_bar(LONG)))
    with pytest.raises(AssemblyError, match="cannot be closed at t = 0 s"):
        evaluate(scene)


@pytest.mark.parametrize(
    ("assembly", "error"),
    [
        ({"z": 1.0}, UnknownNameError),
        ({"p": -1.0}, ParameterError),
        ({"p": "x"}, ParameterError),
        (3, DeclarationError),
    ],
)
def test_misuse_is_named(assembly, error):
    with pytest.raises(error):
        four_bar(LONG, assembly=assembly)


def test_sweeps_begin_with_the_first_design_that_can_be_assembled():
    """And give what they give where the defaults can."""
    axes = {"q": (0.05, 0.35, 4), "r": [0.25, 0.3]}
    one, other = (sweep(four_bar(lengths), axes, wanted=["effort"]) for lengths in (SHORT, LONG))
    np.testing.assert_array_equal(one["peak:effort:O"], other["peak:effort:O"])
    np.testing.assert_array_equal(one["status"], other["status"])
    assert one["status"].min() == 0 < one["status"].max()
    with pytest.raises(AssemblyError, match="with the default parameters"):
        sweep(four_bar(SHORT), {"q": (0.01, 0.05, 4)}, wanted=["effort"])


def test_peaks_between_instants():
    scene = four_bar(SHORT)
    peaks = [
        refine(s, evaluate(s, parameters=VALUES), ["effort:O", "section:b:bending"])
        for s in (scene, four_bar(LONG))
    ]
    assert peaks[0] == peaks[1]


def test_exported_c(tmp_path):
    """Its defaults are the parameters that are asked for, and its scene is assembled with them."""
    export(four_bar(SHORT), tmp_path / "one", parameters=VALUES)
    export(four_bar(LONG), tmp_path / "other")
    for file in ("four_bar.h", "four_bar.c", "selftest.c"):
        # But for the scene's own hash.
        one, other = (
            re.sub(r"[0-9a-f]{32}|0x[0-9a-f]{8}u", "", (tmp_path / name / file).read_text())
            for name in ("one", "other")
        )
        assert one == other
    with pytest.raises(AssemblyError, match="with the default parameters"):
        export(four_bar(SHORT), tmp_path / "none")


CASE = """\
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import polynomial


def scene():
    m = Mechanism("crank")
    r, l = m.parameter("r", 0.3, "m"), m.parameter("l", 0.2, "m")
    crank, rod, slider = m.link("crank", length=r, mass=1.0), m.link("rod", length=l, mass=1.0), m.point_mass("slider", 1.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, slider)
    m.prismatic("guide", m.ground, slider, axis=(1, 0))
    return Scene(m, {"O": polynomial(1.5, 9.0)}, posture={"rod": 0.0}, t=(0.0, 0.5, 51))
"""  # noqa: E501


def test_the_command_line(here, capsys):
    (here / "case.py").write_text(CASE)
    assert main(["run", "case.py", "--no-figures"]) == 1
    assert "with the default parameters r = 0.3, l = 0.2" in capsys.readouterr().err
    assert main(["run", "case.py", "--no-figures", "--set", "l=0.5"]) == 0
    assert main(["sweep", "case.py", "--grid", "l=0.2:0.5:4", "--out", "sweep.h5"]) == 0
