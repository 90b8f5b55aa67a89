"""Evaluation: by which method, prepared for many calls, at instants by expressions of parameters or
by a coordinate of a drive.
"""

import math
import re
from concurrent.futures import ThreadPoolExecutor

import casadi as ca
import numpy as np
import pytest
import xarray
from commands import command
from forging import edit
from mechanisms import press, slider_crank, uneven
from stepped import two_rods

from lagrange_casadi import check, evaluate, export, load, motion, prepare, save, sweep
from lagrange_casadi.errors import (
    AssemblyError,
    DeclarationError,
    ParameterError,
    SizeError,
    UnknownNameError,
)
from lagrange_casadi.figures import TimePlot
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

WRONG = [
    ({"backend": "gpu"}, UnknownNameError, "unknown backend 'gpu'; valid: auto, lanes, c, vm"),
    ({"precision": "half"}, UnknownNameError, "unknown precision 'half'; valid: double, single"),
    (
        {"newton": 0},
        DeclarationError,
        (
            "newton: expected a number of steps, from 1 to 1000 (after some ten nothing changes),"
            " got 0"
        ),
    ),
    (
        {"newton": 2.0},
        DeclarationError,
        (
            "newton: expected a number of steps, from 1 to 1000 (after some ten nothing changes),"
            " got 2.0"
        ),
    ),
    (
        {"newton": True},
        DeclarationError,
        (
            "newton: expected a number of steps, from 1 to 1000 (after some ten nothing changes),"
            " got True"
        ),
    ),
    (
        {"table": 3},
        DeclarationError,
        "table: expected a number of nodes, at least 8, or an accuracy between 0 and 1, got 3",
    ),
    ({"table": 1.0}, DeclarationError, "an accuracy between 0 and 1, got 1.0"),
    ({"table": 0.0}, DeclarationError, "an accuracy between 0 and 1, got 0.0"),
    ({"table": float("nan")}, DeclarationError, "an accuracy between 0 and 1, got nan"),
    ({"table": True}, DeclarationError, "an accuracy between 0 and 1, got True"),
    ({"table": "fine"}, DeclarationError, "an accuracy between 0 and 1, got 'fine'"),
    (
        {"flags": "-DNAME='open"},
        DeclarationError,
        'flags: expected options of a compiler, got "-DNAME=\'open": No closing quotation',
    ),
    ({"flags": 3}, DeclarationError, "flags: expected options of a compiler, got 3"),
    ({"newton": 1, "table": 64}, DeclarationError, "newton and table exclude each other"),
    (
        {"backend": "vm", "precision": "single"},
        DeclarationError,
        "backend 'vm' computes in doubles only",
    ),
    (
        {"backend": "vm", "flags": "-O1"},
        DeclarationError,
        "backend 'vm' compiles nothing; flags '-O1' need lanes or c",
    ),
]


def test_steps_are_of_iterated_loops_alone():
    """The other loop is closed, however few the steps."""
    scene = two_rods()
    exact, rough = evaluate(scene), evaluate(scene, newton=1)
    gap = {
        name: (
            np.abs(rough.motion(f"{name}_guide").value - exact.motion(f"{name}_guide").value).max()
        )
        for name in ("closed", "stepped")
    }
    assert gap["closed"] < 1e-15 < 1e-9 < gap["stepped"]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("law", [motion.polynomial, uneven])
@pytest.mark.parametrize("rpm", [600.0, 77.0])
def test_instants_over_a_drive_are_equal_steps_of_it(law, rpm):
    """What is found at them is what is found at the same times, and the mechanism is at the same
    angles at any speed.
    """
    scene = press(law, over=("O", 0.5, 0.5 + 2 * math.tau, 145))
    found = evaluate(scene, parameters={"rpm": rpm})
    np.testing.assert_allclose(
        found.over.values, 0.5 + 2 * math.tau * np.arange(145) / 144, rtol=1e-15
    )
    np.testing.assert_allclose(found.motion("O").value, found.over.values, rtol=0, atol=4e-15)
    assert (found.over.joint, found.certified) == ("O", True)
    assert (np.diff(found.t) > 0.0).all()
    slow = evaluate(scene, parameters={"rpm": 30.0})
    np.testing.assert_allclose(found.pose("ram").y, slow.pose("ram").y, rtol=1e-14)


def test_a_swing_is_followed_from_the_start_of_t():
    """Back and forth are two stretches of one motion; the start of t tells which is meant."""
    law = motion.harmonic(1.0, 0.4, 2.0)
    forth = press(lambda *_: law, over=("O", 0.7, 1.3, 9))
    back = press(lambda *_: law, over=("O", 1.3, 0.7, 9), t=(0.25, 1, 2))
    np.testing.assert_allclose(evaluate(forth).t + evaluate(back).t[::-1], 0.25, atol=1e-15)
    with pytest.raises(DeclarationError, match=r"runs opposite to the range from 1\.3 rad"):
        press(lambda *_: law, over=("O", 1.3, 0.7, 9))


@pytest.mark.parametrize(
    "options",
    [
        "--backend c --precision single --flags '-O1 -DNAME=3'",
        "--backend vm",
        "--backend lanes --table 64",
        "--table 1e-06",
        "",
    ],
)
def test_a_method_is_told_as_the_options_that_it_takes(options, here):
    line = f"run CASE --no-figures --no-certificate --t 0:0.08:9 --want effort {options}"
    assert command(line) == 0
    assert load("slider_crank.h5").provenance.method == (options or "(default)")


def test_steps_for_loops_that_are_not_iterated_are_refused(here):
    """Whatever evaluates them: closed forms need none."""
    scene, out = slider_crank(), here / "x"
    says = "newton: no loop of 'slider_crank' is iterated; leave newton out: closed forms are exact"
    for call, more in (
        (evaluate, {}),
        (prepare, {}),
        (sweep, {"grid": {"l": (0.2, 0.3, 3)}, "out": out.with_suffix(".h5")}),
        (export, {"out": out}),
    ):
        with pytest.raises(DeclarationError, match=says):
            call(scene, newton=2, **more)
    assert not list(here.iterdir())


def test_values_by_name_and_in_mappings_and_of_threads():
    """The arrays are the object's own: the next call writes into them, and a thread has a copy of
    the object.
    """
    f = prepare(slider_crank(), wanted=["effort"])
    kept = f()["effort:O"]
    named = f(r=0.11, l=0.25)["effort:O"].copy()
    assert np.shares_memory(kept, f(r=0.11)["effort:O"])
    for given in (({"r": 0.11}, None, {"l": 0.25}), ({"r": 0.5, "l": 0.25}, {"r": 0.11})):
        np.testing.assert_array_equal(f(*given)["effort:O"], named)
    lengths = np.linspace(0.2, 0.4, 8)
    alone = [f(l=x)["effort:O"].copy() for x in lengths]

    def often(k):
        g = f.copy()
        return [g(l=lengths[k])["effort:O"].copy() for _ in range(50)]

    with ThreadPoolExecutor(8) as pool:
        for k, rows in enumerate(pool.map(often, range(8))):
            assert all(np.array_equal(row, alone[k]) for row in rows)


VALUES = [
    ({"length": 0.2}, UnknownNameError, "unknown parameter 'length'"),
    ({"l": "long"}, ParameterError, "parameter 'l': expected a number"),
    ({"l": math.nan}, ParameterError, "finite"),
    ({"l": -1.0}, ParameterError, "length must be positive, got -1 m"),
    ({"r": 0.5}, AssemblyError, "cannot be closed at t = "),
]


@pytest.mark.parametrize(("values", "error", "says"), VALUES)
def test_values_that_have_no_result_are_refused_as_evaluate_does(values, error, says):
    """And an evaluation after a mistake is as one before it."""
    scene = slider_crank()
    f = prepare(scene, wanted=["effort"])
    before = f()["effort:O"].copy()
    refused = []
    for ask in (f, f.peaks, lambda values: evaluate(scene, parameters=values)):
        with pytest.raises(error, match=says) as caught:
            ask(values)
        refused.append(str(caught.value))
    assert refused[0] == refused[2]
    np.testing.assert_array_equal(f()["effort:O"], before)


AT_REST = {"rpm": 0.0}
REFUSED = [
    *(({"t": None, **words}, error, says) for words, error, says in WRONG),
    ({"over": ("O", 0, 1)}, DeclarationError, "over: expected (joint, start, stop, count), got"),
    ({"over": "O=0:1:5"}, DeclarationError, "over: expected (joint, start, stop, count), got"),
    ({"over": ("O", 0, 1, 1)}, DeclarationError, "over: COUNT must be 2 or more"),
    ({"over": ("O", 1, 1, 1)}, DeclarationError, "over: COUNT must be 2 or more, got 1"),
    ({"over": ("O", 0, 1, 0)}, DeclarationError, "COUNT must be a whole number from 1 to 2^63 - 1"),
    ({"over": ("O", 1, 1, 5)}, DeclarationError, "over: STOP must be after START, got 1 and 1"),
    ({"over": ("O", 0, math.inf, 5)}, DeclarationError, "over: START and STOP must be finite"),
    (
        {"over": ("O", "-1e308 rad", "1e308 rad", 5)},
        DeclarationError,
        "over: START and STOP are too far apart, got -1e+308 and 1e+308",
    ),
    (
        {"over": ("O", 0, "1 lap", 5)},
        DeclarationError,
        "over: STOP: expected a number [rad], or a text such as '350 deg'",
    ),
    (
        {"over": ("O", 1, 0, 5)},
        DeclarationError,
        "over: the motion of joint 'O' runs opposite to the range from 1 rad (57.2958 deg) to 0",
    ),
    (
        {"over": ("O", 0, ca.SX.sym("q"), 5)},
        DeclarationError,
        "over: STOP depends on 'q', not a parameter",
    ),
    (
        {"over": ("guide", 0, 1, 5)},
        UnknownNameError,
        "unknown driven joint in over 'guide'; valid: O",
    ),
    ({"over": ("O", 0, 1, 5), "t": (0, 1, 5)}, DeclarationError, "t and over exclude each other"),
    ({"over": ("O", 0, math.tau, 10**12)}, SizeError, "the outputs over time"),
    (
        {"t": (0, 0, 9), "parameters": {"rpm": -60.0}},
        DeclarationError,
        "t: STOP must be after START, got 0 and 0",
    ),
    (
        {"parameters": {"rpm": -60.0}},
        DeclarationError,
        "t: STOP must be after START, got 0 and -1; with the parameters rpm = -60, l = ",
    ),
    (
        {"parameters": AT_REST},
        DeclarationError,
        "t: START and STOP must be finite, got 0 and inf; with the parameters rpm = 0",
    ),
    (
        {"over": ("O", 0, math.tau, 5), "parameters": AT_REST},
        DeclarationError,
        "is at rest and does not go from 0 rad (0 deg) to 6.28319 rad (360 deg); with the",
    ),
    *(
        (
            {"law": law, "over": ("O", 0, math.tau, 5)},
            DeclarationError,
            f"motion of joint 'O' {says}",
        )
        for law, says in (
            (motion.harmonic(0, 1, 1), "does not go from 0 rad (0 deg) to 6.28319 rad (360 deg)"),
            (motion.samples([0, 1, 2, 3], [0, 1, 2, 3]), "does not go from 0 rad (0 deg)"),
        )
    ),
]


@pytest.mark.parametrize(("words", "error", "says"), REFUSED)
def test_what_cannot_be_is_refused_in_a_line(words, error, says):
    words = {"t": None} | words
    law = words.pop("law", None)
    scene = press((lambda *_: law) if law else polynomial, t=lambda rpm: (0, 60 / rpm, 9))
    with pytest.raises(error, match=re.escape(says)):
        evaluate(scene, **words)


def test_a_file_keeps_the_drives_coordinate(tmp_path):
    path, solution = tmp_path / "x.h5", evaluate(slider_crank(), over=("O", 0, math.tau, 31))
    save(solution, path)
    back = load(path)
    np.testing.assert_array_equal(back.over.values, solution.over.values)
    assert (back.over.joint, back.over.unit) == ("O", "rad")
    assert back.peak("effort:O") == solution.peak("effort:O")
    for engine in ("h5netcdf", "netcdf4"):
        with xarray.open_dataset(path, engine=engine) as read:
            assert read.coords["over"].dims == ("t",)
            np.testing.assert_array_equal(read.coords["over"], solution.over.values)
    axes = TimePlot("effort", ("effort:O",)).draw(back).axes[0]
    assert axes.get_xlabel() == "O [deg]"
    np.testing.assert_allclose(axes.get_lines()[0].get_xdata(), np.linspace(0, 360, 31), rtol=1e-15)
    data = solution.to_xarray().swap_dims(t="over")
    assert data["over"].attrs == {"units": "rad", "long_name": "coordinate of joint 'O'"}
    assert check(path) == []
    edit(path, lambda h: h["over"].write_direct(np.asarray(h["over"]) + 1e-9))
    assert "over: not the coordinate of joint 'O'" in check(path)
    edit(path, lambda h: h["over"].write_direct(np.asarray(h["over"]) ** 2))
    assert "over: not in equal steps" in check(path)
