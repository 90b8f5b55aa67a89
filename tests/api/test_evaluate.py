"""Evaluation: by which method, prepared for many calls, at instants by expressions of parameters or
by a coordinate of a drive.
"""

import math
from concurrent.futures import ThreadPoolExecutor

import casadi as ca
import h5py
import numpy as np
import pytest
import xarray
from commands import command
from forging import edit
from mechanisms import press, slider_crank, uneven
from stepped import two_rods

from lagrange_casadi import (
    Mechanism,
    Scene,
    check,
    evaluate,
    export,
    load,
    load_case,
    motion,
    prepare,
    save,
    sweep,
)
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


@pytest.mark.parametrize("scene", [slider_crank, lambda: load_case("arm").scene])
def test_steps_for_loops_that_are_not_iterated_are_refused(scene, tmp_path):
    """Whatever evaluates them: closed forms need none."""
    scene = scene()
    says = (
        f"newton: no loop of '{scene.mechanism.name}' is iterated; leave newton out: closed forms"
        " are exact and faster"
    )
    calls = (
        lambda: evaluate(scene, newton=2),
        lambda: prepare(scene, newton=2),
        lambda: sweep(
            scene,
            {next(iter(scene.mechanism.parameters)): (0.2, 0.3, 3)},
            newton=2,
            out=tmp_path / "x.h5",
        ),
        lambda: export(scene, tmp_path / "x", newton=2),
    )
    for call in calls:
        with pytest.raises(DeclarationError) as raised:
            call()
        assert str(raised.value) == says
    assert not list(tmp_path.iterdir())


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


def test_a_rung_is_told_in_the_provenance():
    solution = evaluate(
        slider_crank(["effort"]), backend="c", precision="single", flags="-O1", certificate=False
    )
    assert (solution.provenance.precision, solution.provenance.backend) == ("single", "c")
    assert solution.provenance.method == "--backend c --precision single --flags -O1"
    assert solution.provenance.flags.endswith(" -O1")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("backend", ["auto", "c", "vm"])
def test_calls_are_the_rows_of_designs_to_the_last_byte(backend):
    """Whatever was asked for before, and by name or in a mapping; parameters that are not told have
    their defaults.
    """
    scene = slider_crank()
    f = prepare(
        scene, t=(*scene.span, 33), wanted=["effort", "section:rod", "motion"], backend=backend
    )
    rows = np.tile(list(scene.mechanism.values().values()), (3, 1))
    rows[1, f.parameters.index("l")], rows[2, f.parameters.index("r")] = 0.25, 0.06
    assert tuple(f()) == f.outputs
    np.testing.assert_array_equal(f.t, evaluate(scene, t=(*scene.span, 33)).t)
    found = f.designs(rows, histories=True)
    for k, values in enumerate([{}, {"l": 0.25}, {"r": 0.06}]):
        told = {name: np.array(row) for name, row in (f(values) if k % 2 else f(**values)).items()}
        for output, row in zip(f.outputs, found.series[k], strict=True):
            np.testing.assert_array_equal(told[output], row)
        peaks = f.peaks(**values)
        for name in ("value", "t", "xi", "mean", "rms"):
            np.testing.assert_array_equal(getattr(peaks, name), getattr(found, name)[k])


def test_peaks_are_those_of_the_solution():
    scene = load_case("slider_crank").scene
    f = prepare(scene, wanted=["effort", "section:rod"])
    peaks, solution = f.peaks(l=0.25), evaluate(scene, parameters={"l": 0.25})
    for name, value, t, xi in zip(f.quantities, peaks.value, peaks.t, peaks.xi, strict=True):
        expected = solution.peak(name)
        assert abs(value - expected.value) <= 1e-3 * abs(expected.value)
        assert abs(t - expected.t) <= scene.span[1] / 100
        assert math.isnan(xi) == (expected.xi is None)
    assert f.efforts == ("effort:O",)
    assert peaks.rms[0] >= abs(peaks.mean[0])


def test_a_result_is_kept_by_copying_it():
    """The arrays are the object's own: the next call writes into them.

    Another thread takes a copy of the object.
    """
    f = prepare(slider_crank(), wanted=["effort"])
    first = f(l=0.25)["effort:O"]
    kept = first.copy()
    second = f(l=0.3)["effort:O"]
    assert second is first or np.shares_memory(first, second)
    assert np.abs(first - kept).max() > 0
    g = f.copy()
    np.testing.assert_array_equal(g(l=0.25)["effort:O"], kept)
    np.testing.assert_array_equal(f(l=0.3)["effort:O"], second)


def test_mistakes():
    scene = load_case("slider_crank").scene
    f = prepare(scene, wanted=["effort"])
    with pytest.raises(UnknownNameError, match="parameter"):
        f(length=0.2)
    with pytest.raises(ParameterError, match="parameter 'l' must be a number"):
        f(l="long")
    with pytest.raises(ParameterError, match="finite"):
        f(l=math.nan)
    with pytest.raises(ParameterError, match="out of its range"):
        f.peaks({"l": -1.0})
    with pytest.raises(DeclarationError, match="prepare: scene: expected a Scene, got"):
        prepare(scene.mechanism)
    # An evaluation after a mistake is as one before it.
    np.testing.assert_array_equal(
        f(l=0.25)["effort:O"], prepare(scene, wanted=["effort"])(l=0.25)["effort:O"]
    )


def test_values_that_have_no_result_are_refused_as_evaluate_does():
    m = Mechanism("reach")
    r = m.parameter("r", 0.1, "m")
    crank, rod = m.link("crank", length=r, mass=1.0), m.link("rod", length=0.3, mass=1.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.prismatic("P", m.ground, m.point_mass("slider", 1.0), axis=(1, 0))
    m.revolute("B", rod.tip, m.bodies["slider"])
    scene = Scene(m, {"O": polynomial(0.0, 6.0)}, t=(0.0, 1.0, 41), posture={"rod": 0.0, "P": 0.4})
    f = prepare(scene)
    with pytest.raises(AssemblyError) as ours:
        f(r=0.5)
    with pytest.raises(AssemblyError) as theirs:
        evaluate(scene, parameters={"r": 0.5})
    assert str(ours.value) == str(theirs.value)
    assert "at t = " in str(ours.value)
    assert np.isfinite(f(r=0.1)["effort:O"]).all()


TURN = math.tau


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


def test_a_swing_is_followed_from_the_start_of_t():
    """Back and forth are two stretches of one motion; the start of t tells which is meant."""
    law = motion.harmonic(1.0, 0.4, 2.0)
    forth = press(lambda *_: law, over=("O", 0.7, 1.3, 9))
    back = press(lambda *_: law, over=("O", 1.3, 0.7, 9), t=(0.25, 1, 2))
    np.testing.assert_allclose(evaluate(forth).t + evaluate(back).t[::-1], 0.25, atol=1e-15)
    with pytest.raises(DeclarationError, match=r"runs opposite to the range from 1\.3 rad"):
        press(lambda *_: law, over=("O", 1.3, 0.7, 9))


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


@pytest.mark.parametrize(("words", "error", "says"), WRONG)
def test_what_does_not_go_together(words, error, says):
    with pytest.raises(error) as raised:
        evaluate(slider_crank(), **words)
    assert says in str(raised.value)


MISTAKEN = {
    "--newton 0": "newton: expected a number of steps, from 1 to 1000 (after some ten nothing",
    "--newton two": "Invalid value for '--newton': 'two' is not a valid integer",
    "--table 3": "table: expected a number of nodes, at least 8, or an accuracy between 0 and 1",
    "--table few": "expected a number of nodes or an accuracy, as in 128 or 1e-6, got 'few'",
    "--precision half": "Invalid value for '--precision': 'half' is not one of 'double', 'single'",
    "--backend vm --precision single": "backend 'vm' computes in doubles only; precision 'single'",
    "--backend vm --flags -O1": "backend 'vm' compiles nothing; flags '-O1' need lanes or c",
    "--newton 1": "newton: no loop of 'slider_crank' is iterated; leave newton out: closed forms",
    "--newton 1 --table 64": "newton and table exclude each other: a table is read, no loop is",
}


@pytest.mark.parametrize("options", MISTAKEN)
def test_mistakes_on_the_command_line_are_one_line(options, here, capfd):
    assert command(f"run CASE --no-figures {options}") == 2
    out, err = capfd.readouterr()
    assert err.startswith("error: ")
    assert MISTAKEN[options] in err
    assert (err.count("\n"), out, list(here.iterdir())) == (1, "", [])


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


def test_values_by_name_and_in_mappings_and_of_threads():
    """Each thread has a copy of its own."""
    f = prepare(slider_crank(), wanted=["effort"])
    named = f(r=0.11, l=0.25)["effort:O"].copy()
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


def test_what_equilibrium_leaves_open_is_no_number():
    scene = load_case("bricard").scene
    f, asked = prepare(scene, t=(*scene.span, 5)), {"t": (*scene.span, 5), "certificate": False}
    solution = evaluate(scene, **asked)
    assert solution.undetermined
    for name, row in f().items():
        assert np.isfinite(row).all() == solution.determined(name), name


def test_instants_over_a_drive_are_asked_for_once_and_fit():
    scene = press()
    with pytest.raises(UnknownNameError, match="unknown driven joint in over 'guide'; valid: O"):
        evaluate(scene, over=("guide", 0, 1, 5))
    with pytest.raises(DeclarationError, match="t and over exclude each other"):
        evaluate(scene, t=(0, 1, 5), over=("O", 0, 1, 5))
    for law in (motion.polynomial, uneven):
        with pytest.raises(SizeError, match="the outputs over time"):
            evaluate(press(law), over=("O", 0, TURN, 10**12))
    assert repr(press(over=("O", 0, 1, 5))).endswith("all, 5 instants over O from 0 to 1>")


def test_a_figure_and_xarray_are_over_the_drives_coordinate(kept):
    solution, _ = kept
    axes = TimePlot("effort", ("effort:O",)).draw(solution).axes[0]
    assert axes.get_xlabel() == "O [deg]"
    np.testing.assert_allclose(axes.get_lines()[0].get_xdata(), np.linspace(0, 360, 31), rtol=1e-15)
    data = solution.to_xarray().swap_dims(t="over")
    assert data["over"].attrs == {"units": "rad", "long_name": "coordinate of joint 'O'"}
    assert float(data["effort:O"].sel(over=math.pi, method="nearest")) == solution.effort("O")[15]
