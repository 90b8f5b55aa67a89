"""Motions from files of controllers: columns, units, smoothing, cycles, and what is refused of
them.
"""

import math

import casadi as ca
import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, curve, evaluate
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, PathError, UnknownNameError
from lagrange_casadi.motion import dwell, move, moves, read_motion, read_samples, samples

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

CYCLE = [
    move("60 deg", time=0.4, law="modified_sine"),
    dwell(0.2),
    move(0.0, time=0.5, law="s_curve"),
    dwell(0.1),
]


def derivatives(law, t):
    """Value, rate and acceleration at times."""
    x = ca.SX.sym("t")
    rows = [law(x)]
    rows += [ca.jacobian(rows[-1], x)]
    rows += [ca.jacobian(rows[-1], x)]
    return [
        row.full().ravel()
        for row in ca.Function("law", [x], [ca.densify(row) for row in rows])(np.asarray(t)[None])
    ]


def write(path, heads, rows, delimiter=",", comma=False):
    lines = [delimiter.join(f"{number:.13f}" for number in row) for row in rows]
    text = "\n".join([*([delimiter.join(heads)] if heads else []), *lines])
    path.write_text(text.replace(".", ",") if comma else text)
    return path


@pytest.mark.parametrize(
    ("heads", "delimiter", "comma", "options"),
    [
        (["t", "q", "p"], ",", False, {"value": "p", "time": "t"}),
        (["t", "q", "p"], ";", True, {"value": 3}),
        (["t", "q", "p"], "\t", False, {"value": "p", "time": 1}),
        ([], ";", False, {"value": 3}),
    ],
)
def test_columns_are_read_in_their_units(here, heads, delimiter, comma, options):
    t, angle = np.linspace(0.0, 900.0, 91), 90.0 * np.sin(np.linspace(0.0, 5.0, 91))
    path = write(
        here / "axis.csv", heads, np.column_stack([t, 7.0 + 0 * t, angle]), delimiter, comma
    )
    law = read_samples(path, unit="deg", time_unit="ms", **options)
    expected = samples(t / 1000.0, np.radians(np.round(angle, 13)))
    at = np.linspace(0.0, 0.9, 37)
    theirs = ca.SX.sym("t")
    value = ca.Function("samples", [theirs], [expected.graph(theirs)])(at[None]).full().ravel()
    assert derivatives(law, at)[0] == pytest.approx(value, abs=1e-12)


def test_parameters_scale_shift_and_stretch(here):
    t = np.linspace(0.0, 1.0, 60)
    path = write(here / "axis.csv", ["t", "x"], np.column_stack([t, 50.0 * t**3]))
    m = Mechanism("slide")
    ratio, offset, stretch = (
        m.parameter("ratio", 1.0),
        m.parameter("offset", 0.0, "m"),
        m.parameter("stretch", 1.0),
    )
    m.prismatic("X", m.ground, m.point_mass("p", 2.0), axis=(1, 0))
    law = read_samples(path, unit="mm", ratio=ratio, offset=offset, stretch=stretch)
    scene = Scene(m, {"X": law}, t=(0, 1, 11))
    found = evaluate(scene, parameters={"ratio": 3.0, "offset": 0.2, "stretch": 2.0}, t=(0, 2, 21))
    assert found.motion("X").value == pytest.approx(0.2 + 0.15 * (found.t / 2) ** 3, abs=1e-11)
    assert found.effort("X") == pytest.approx(2.0 * 0.15 * 6 * found.t / 8, abs=1e-8)
    with pytest.raises(
        DeclarationError, match="the argument of its curve is outside the curve's range"
    ):
        evaluate(scene, t=(0, 2, 21))


@pytest.mark.parametrize("smoothing", [0.001, "estimated"])
@pytest.mark.parametrize("points", [None, 150])
def test_smoothing_takes_the_noise_out_of_accelerations(here, smoothing, points):
    """0.001 deg of noise at a millisecond; what is left is a hundredth, in the root mean square, of
    what it makes.
    """
    true = moves(CYCLE, cyclic=True)
    t = np.arange(1201) / 1000.0
    clean = derivatives(true, t)
    noisy = np.degrees(clean[0]) + 0.001 * np.random.default_rng(3).normal(size=t.size)
    noisy[-1] = noisy[0]
    path = write(here / "axis.csv", ["t", "q"], np.column_stack([t, noisy]))
    options = {"unit": "deg", "periodic": True}
    rough, smooth = (
        read_samples(path, **options),
        read_samples(path, smoothing=smoothing, points=points, **options),
    )
    errors = [np.sqrt(np.mean((derivatives(law, t)[2] - clean[2]) ** 2)) for law in (rough, smooth)]
    assert errors[0] > 2.0 * np.abs(clean[2]).max()
    assert errors[1] < 0.01 * errors[0]
    assert errors[1] < 0.02 * np.abs(clean[2]).max()
    assert "smoothed by 0.00" in smooth.description
    distance = np.degrees(derivatives(smooth, t)[0]) - np.round(noisy, 13)
    if points is None:
        assert np.sqrt(np.mean(distance[:-1] ** 2)) == pytest.approx(0.001, rel=0.1)


def test_a_cycle_goes_on_smoothly_over_its_seam(here):
    """With the row that closes it, and without it but with the period; an axis that advances by a
    turn a cycle.
    """
    t = np.linspace(0.0, 0.8, 81)
    wave, turning = 10.0 * np.sin(2 * np.pi * t / 0.8), t / 0.8 + 0.05 * np.sin(2 * np.pi * t / 0.8)
    whole = write(here / "whole.csv", ["t", "q"], np.column_stack([t, wave]))
    part = write(here / "part.csv", ["t", "q"], np.column_stack([t, wave])[:-1])
    turns = write(here / "turns.csv", ["t", "q"], np.column_stack([t, turning]))
    at = np.linspace(-1.0, 3.0, 401)
    exact = [
        10e-3 * np.sin(2 * np.pi * at / 0.8),
        -10e-3 * (2 * np.pi / 0.8) ** 2 * np.sin(2 * np.pi * at / 0.8),
    ]
    for law in (
        read_samples(whole, unit="mm", periodic=True),
        read_samples(part, unit="mm", period=0.8),
    ):
        value, _, bend = derivatives(law, at)
        assert value == pytest.approx(exact[0], abs=1e-8)
        assert bend == pytest.approx(exact[1], abs=1e-3)
    value, rate, _ = derivatives(read_samples(turns, unit="turn", periodic=True, advance=1.0), at)
    assert value == pytest.approx(
        2 * np.pi * (at / 0.8 + 0.05 * np.sin(2 * np.pi * at / 0.8)), abs=1e-6
    )
    assert rate.mean() == pytest.approx(2 * np.pi / 0.8, rel=1e-4)


RAMP = [[0.1 * k, 1.0 * k * k] for k in range(8)]


@pytest.mark.parametrize(
    ("rows", "options", "error", "says"),
    [
        (RAMP, {"value": "w"}, UnknownNameError, r"axis\.csv: unknown column 'w'; valid: t, q"),
        (
            RAMP,
            {"value": 3},
            DeclarationError,
            r"axis\.csv: column 3 is not one of its 2 columns, numbered from 1",
        ),
        (
            RAMP,
            {"unit": "grad"},
            UnknownNameError,
            r"axis\.csv: unknown unit 'grad'.*; valid: rad, deg",
        ),
        (
            RAMP,
            {"time_unit": "min"},
            UnknownNameError,
            r"axis\.csv: unknown time unit 'min'; valid: s, ms, us",
        ),
        (
            RAMP,
            {"periodic": True},
            DeclarationError,
            r"the last value of a periodic motion must be the first, but it is off by 49",
        ),
        (
            RAMP,
            {"period": 0.5},
            DeclarationError,
            r"its rows last 0\.7 s, but the period is 0\.5 s; expected rows of exactly one period",
        ),
        (
            RAMP,
            {"advance": 1.0},
            DeclarationError,
            "advance= needs periodic=True",
        ),
        (
            RAMP,
            {"smoothing": -1.0},
            DeclarationError,
            r"expected the noise \[rad\], a number of at least 0",
        ),
        (RAMP, {"smoothing": "auto"}, DeclarationError, "or 'estimated', got 'auto'"),
        (
            RAMP,
            {"smoothing": 1e3},
            DeclarationError,
            r"axis\.csv: curve: a smoothing of 1000 leaves only a straight line",
        ),
        (
            RAMP,
            {"points": 3},
            DeclarationError,
            "points: expected a whole number of at least 5, got 3",
        ),
        (RAMP[:4], {}, DeclarationError, "expected at least 5 rows of numbers, got 4"),
        (
            [*RAMP, [0.7, 1.0]],
            {},
            DeclarationError,
            r"axis\.csv, line 10: times must increase, but 0\.7000000000000 follows 0\.7",
        ),
        (
            [*RAMP, [0.9, math.nan]],
            {},
            DeclarationError,
            r"axis\.csv, line 10: expected a finite number, got 'nan'",
        ),
    ],
)
def test_misuse_is_named(here, rows, options, error, says):
    with pytest.raises(error, match=says):
        read_samples(write(here / "axis.csv", ["t", "q"], rows), **options)


@pytest.mark.parametrize("cell", ["nan", "-inf", "1_0", "\u0663", "1.2.3"])
def test_a_first_row_that_is_no_head_is_not_passed_over(here, cell):
    with pytest.raises(DeclarationError, match=r"axis\.csv, line 1: expected a finite number, got"):
        read_samples(write(here / "axis.csv", ["0", cell], RAMP))
    assert read_samples(write(here / "axis.csv", ["", "0"], RAMP), value=2).description.startswith(
        f"{len(RAMP)} samples of "
    )


def test_files_that_cannot_be_read(here):
    with pytest.raises(PathError, match=r"none\.csv: no such file"):
        read_samples(here / "none.csv")
    (here / "empty.csv").write_text("# nothing\n\n")
    with pytest.raises(DeclarationError, match=r"empty\.csv: it has no rows"):
        read_samples(here / "empty.csv")
    (here / "short.csv").write_text("t;q\n0;1\n1;2\n# why\n2;\n")
    with pytest.raises(
        DeclarationError, match=r"short\.csv, line 5: expected a finite number, got ''"
    ):
        read_samples(here / "short.csv")


def same(one, other, at):
    """Two laws have the same values, rates and accelerations."""
    for mine, theirs in zip(derivatives(one, at), derivatives(other, at), strict=True):
        assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-9)


TIMES = np.linspace(0.0, 1.2, 61)
KNEE, SLIDE, HIP = 40.0 * np.sin(5.0 * TIMES), 0.2 * np.cos(3.0 * TIMES), 20.0 * TIMES**2
AT = np.linspace(0.0, 1.2, 29)


@pytest.mark.parametrize("layout", ["brackets", "row below", "opensim", "opensim in spaces"])
def test_several_joints_are_read_with_the_units_of_the_file(here, layout):
    """The units stand in the heads, in a row below them, or in OpenSim's header."""
    rows = np.column_stack([TIMES, KNEE, SLIDE, HIP])
    file = here / ("walk.mot" if "opensim" in layout else "walk.csv")
    if layout == "brackets":
        write(file, ["time [ms]", "knee (deg)", "pelvis_tx [mm]", "hip"], rows * [1e3, 1, 1e3, 1])
    else:
        write(file, ["time", "knee", "pelvis_tx", "hip"], rows, "\t")
        head, *lines = file.read_text().splitlines()
        if layout == "row below":
            lines.insert(0, "s\tdeg\tm\t")
        else:
            told = "Coordinates\nversion=1\nnRows=61\nnColumns=4\ninDegrees=yes\n\nendheader"
            head = f"{told}\n{head}"
        text = "\n".join([head, *lines, ""])
        file.write_text(text.replace("\t", "   ") if "spaces" in layout else text)
    found = read_motion(file)
    assert list(found) == ["knee", "pelvis_tx", "hip"]
    hip = np.radians(HIP) if "opensim" in layout else HIP
    for law, values in zip(found.values(), (np.radians(KNEE), SLIDE, hip), strict=True):
        same(law, curve(TIMES, np.round(values, 15)), AT)
    chosen = read_motion(file, {"left": "knee", "right": 4}, unit={"right": "turn"}, ratio=2.0)
    same(chosen["left"], curve(TIMES, 2.0 * np.radians(KNEE)), AT)
    same(chosen["right"], curve(TIMES, 2.0 * math.tau * HIP), AT)


def test_each_column_is_what_read_samples_makes_of_it(here):
    rows = np.column_stack([TIMES, KNEE + 0.01 * np.sin(900.0 * TIMES), SLIDE])
    file = write(here / "two.csv", ["t", "a", "b"], rows)
    options = {"points": 31, "stretch": 1.5}
    found = read_motion(
        file, ["b", "a"], unit={"a": "deg", "b": "m"}, smoothing={"a": 0.01}, **options
    )
    assert list(found) == ["b", "a"]
    one = read_samples(file, value="a", unit="deg", smoothing=0.01, **options)
    other = read_samples(file, value="b", unit="m", **options)
    same(found["a"], one, 1.5 * AT)
    same(found["b"], other, 1.5 * AT)


def test_counts_of_an_encoder_are_turns(here):
    counts = np.round(4096 / 360.0 * KNEE)
    file = write(here / "encoder.csv", ["t", "motor [counts]"], np.column_stack([TIMES, counts]))
    (law,) = read_motion(file, counts_per_turn=4096, ratio=0.1).values()
    same(law, curve(TIMES, 0.1 * math.tau / 4096 * counts), AT)


def test_encoders_may_have_other_counts(here):
    rows = np.column_stack([TIMES, np.round(4096 / 360 * KNEE), np.round(1000 / 360 * HIP)])
    file = write(here / "encoders.csv", ["t", "a [counts]", "b [counts]"], rows)
    turns = {"a": 4096, "b": 1000}
    found = read_motion(file, counts_per_turn=turns)
    one = read_samples(file, value="b", counts_per_turn=1000)
    for law, place in ((found["a"], 1), (found["b"], 2), (one, 2)):
        same(law, curve(TIMES, math.tau / (4096, 1000)[place - 1] * rows[:, place]), AT)
    with pytest.raises(DeclarationError, match="column b is in counts; expected counts_per_turn="):
        read_motion(file, counts_per_turn={"a": 4096})
    with pytest.raises(DeclarationError, match="column a is in deg; expected counts, of which"):
        read_motion(file, unit={"a": "deg"}, counts_per_turn=turns)


def test_units_of_a_file_are_those_of_a_motion_too(here):
    """In the head, whose column is called with it or without it, or in a row below."""
    file = write(here / "axis.csv", ["t [ms]", "q [deg]"], np.column_stack([1e3 * TIMES, KNEE]))
    expected = curve(TIMES, np.radians(np.round(KNEE, 13)))
    for value in (2, "q", "q [deg]"):
        same(read_samples(file, value=value), expected, AT)
    file.write_text(file.read_text().replace("t [ms],q [deg]", "t,q\nms,deg"))
    same(read_samples(file), expected, AT)
    with pytest.raises(DeclarationError, match=r"axis\.csv: expected one column 'q', got 2"):
        read_samples(write(file, ["t", "q", "q"], np.column_stack([TIMES, KNEE, KNEE])), value="q")


def test_a_scene_takes_motions_of_several_joints(here):
    file = write(here / "arm.csv", ["t", "A [deg]", "B"], np.column_stack([TIMES, KNEE, SLIDE]))
    m = Mechanism("arm")
    upper, lower = m.link("upper", length=0.4, mass=1.0), m.link("lower", length=0.3, mass=1.0)
    m.revolute("A", m.ground, upper)
    m.revolute("B", upper.tip, lower)
    found = evaluate(Scene(m, read_motion(file), t=(0, 1.2, 61)))
    assert found.motion("A").value == pytest.approx(np.radians(KNEE), abs=1e-12)
    assert found.motion("B").value == pytest.approx(SLIDE, abs=1e-12)


def test_a_length_does_not_turn_a_joint(here):
    file = write(here / "arm.csv", ["t", "A [mm]"], np.column_stack([TIMES, SLIDE]))
    m = Mechanism("arm")
    m.revolute("A", m.ground, m.link("upper", length=0.4, mass=1.0))
    with pytest.raises(
        DeclarationError, match="motion of 'A': the law is in m, but the coordinate is"
    ):
        evaluate(Scene(m, read_motion(file), t=(0, 1.2, 61)))


@pytest.mark.parametrize(
    ("heads", "options", "says"),
    [
        (["t", "a [deg]"], {"columns": ["b"]}, "two.csv: unknown column 'b'; valid: t, a"),
        (["t", "a [yd]"], {}, "two.csv: unknown unit 'yd'; valid: .*counts"),
        (["t [h]", "a"], {}, "two.csv: unknown time unit 'h'; valid: s, ms, us"),
        (["t", "a [counts]"], {}, r"two.csv: column a is in counts; expected counts_per_turn="),
        (["t", "a"], {"unit": {"b": "deg"}}, "two.csv: unknown coordinate of unit= 'b'; valid: a"),
        (["t", "a"], {"columns": []}, "two.csv: columns= expected at least one coordinate"),
        ([], {}, "two.csv: the file has no column heads; name the columns with columns="),
        (["t", "a"], {"smoothing": {"a": -1.0}}, "two.csv, column a: smoothing expected the noise"),
    ],
)
def test_misuse_of_several_columns_is_named(here, heads, options, says):
    with pytest.raises((DeclarationError, UnknownNameError), match=says):
        read_motion(write(here / "two.csv", heads, np.column_stack([TIMES, KNEE])), **options)


def test_a_motion_of_opensim_without_its_header_is_refused(here):
    file = write(here / "walk.sto", ["time", "knee"], np.column_stack([TIMES, KNEE]))
    with pytest.raises(DeclarationError, match="expected a header that ends in the line 'endhead"):
        read_motion(file)
    with pytest.raises(PathError, match=r"none\.mot"):
        read_motion(here / "none.mot")


CASE = """
from pathlib import Path
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import read_samples

def scene():
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=0.6, mass=2.0))
    return Scene(m, {"J": read_samples(Path(__file__).parent / "axis.csv", unit="deg")}, t=(0, 0.7, 11))
"""  # noqa: E501


def test_info_tells_what_a_motion_is_from(here, capsys):
    write(here / "axis.csv", ["t", "q"], RAMP)
    (here / "arm.py").write_text(CASE)
    assert main(["info", "arm.py"]) == 0
    assert (
        "  drive J: 8 samples of axis.csv from 0 to 0.7 s, at most 0 deg from them; from 0 rad"
        in capsys.readouterr().out
    )
