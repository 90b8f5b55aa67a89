"""Motions from files of controllers, and samples that parameters scale: columns, units, smoothing,
cycles, and what is refused of them.
"""

import math
import re
from datetime import datetime, timedelta, timezone

import casadi as ca
import numpy as np
import pytest
from derivatives import derivatives

from lagrange_casadi import Mechanism, Scene, curve, evaluate, prepare, refine
from lagrange_casadi.errors import DeclarationError, PathError, SizeError, UnknownNameError
from lagrange_casadi.motion import (
    dwell,
    expression,
    harmonic,
    move,
    moves,
    polynomial,
    read_motion,
    read_samples,
    samples,
)

pytestmark = pytest.mark.usefixtures("interpreted")


def write(path, heads, rows, delimiter=",", comma=False):
    lines = [delimiter.join(f"{number:.13f}" for number in row) for row in rows]
    text = "\n".join([*([delimiter.join(heads)] if heads else []), *lines])
    path.write_text(text.replace(".", ",") if comma else text)
    return path


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


NANO = 1_700_000_000_123_456_789
"""A stamp [ns] that is no double; every tick of a log is a double of nanoseconds later."""

TICKS = [NANO + 20_000_000 * k for k in range(61)]


def split(tick, size):
    return f"{tick // size}.{tick % size:0{len(str(size)) - 1}}"


def iso(tick, ahead=0):
    day = datetime.fromtimestamp(tick // 10**9, timezone(timedelta(hours=ahead)))
    return f"{day:%Y-%m-%dT%H:%M:%S}.{tick % 10**9:09}{f'{ahead:+03}:00' if ahead else 'Z'}"


LOGS = {
    "seconds": ("t,q", "q", lambda n: split(n, 10**9), {}),
    "milliseconds": ("t [ms],q [°]", "q", lambda n: split(n, 10**6), {"unit": "rad"}),
    "nanoseconds": ("stamp,q", "q", str, {}),
    "commas": ("t [us];q", "q", lambda n: split(n, 1000), {}),
    "iso": ("t,q", "q", iso, {}),
    "zone": ("t,q", "q", lambda n: iso(n, 2), {}),
    "two": ("stamp.secs,stamp.nsecs,frame,q", "q", lambda n: f"{n // 10**9},{n % 10**9},up", {}),
    "named": ("ns,s,q", "q", lambda n: f"{n % 10**9},{n // 10**9}", {"time": ["s", "ns"]}),
    "no heads": ("", 5, lambda n: f"{n // 10**9},{n % 10**9},up,J1", {"time": [1, 2]}),
    "rostopic": ("%time,field.name0,field.name1,field.position0,field.position1", "J1",
                 lambda n: f"{n},J2,J1,7", {}),
    "plotjuggler": ("__time,/joint_states/J1/position", "J1", lambda n: split(n, 10**9), {}),
}  # fmt: skip


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("log", LOGS)
def test_a_log_with_stamps_begins_at_its_first_row(here, log, encoding):
    """No nanosecond since 1970 is lost; texts are passed over, and joints are found as ROS names
    them.
    """
    heads, column, stamped, options = LOGS[log]
    mark = ";" if ";" in heads else ","
    rows = [f"{stamped(tick)}{mark}{KNEE[k]:.13f}" for k, tick in enumerate(TICKS)]
    text = "\n".join([heads, *rows] if heads else rows)
    file = here / "log.csv"
    file.write_text(text.replace(".", ",") if mark == ";" else text, encoding=encoding)
    law = read_motion(file, {"knee": column}, **options)["knee"]
    same(law, curve(np.arange(61) * 0.02, np.round(KNEE, 13)), AT)
    assert " since " in law.description
    assert law.note.startswith("times of log.csv are stamps in ")
    if log == "two":
        assert list(read_motion(file)) == ["q"]


RAMP_ROWS = "\n".join(f"{0.1 * k:g},{1.0 * k * k}" for k in range(8))


REFUSED = {
    "column": ("t,q", RAMP_ROWS, {"value": "w"}, r"unknown column 'w'; valid: t, q"),
    "number": ("t,q", RAMP_ROWS, {"value": 3}, "column 3 is not one of its 2 columns, numbered"),
    "times": (
        "secs,nsecs,q", RAMP_ROWS.replace(",", ",0,"), {},
        "column 2 has times; expected one of values, of columns secs, nsecs, q",
    ),
    "two columns": (
        "t,q,q", RAMP_ROWS.replace("\n", ",0\n") + ",0", {"value": "q"},
        "expected one column 'q', got 2",
    ),
    "unit": ("t,q", RAMP_ROWS, {"unit": "grad"}, "unknown unit 'grad'.*; valid: rad, m, counts"),
    "unit of the file": ("t,q [yd]", RAMP_ROWS, {}, "unknown unit 'yd'; valid: .*counts"),
    "kind of unit": (
        "t,q [kN]", RAMP_ROWS, {},
        r"column 2 is in kN, a force; expected an angle \[rad\] or a length \[m\]$",
    ),
    "time unit": ("t,q", RAMP_ROWS, {"time_unit": "mm"}, "column 't' is in mm, a length"),
    "time of the file": ("t [N],q", RAMP_ROWS, {}, "is in N, a force; expected a time"),
    "end": (
        "t,q", RAMP_ROWS, {"periodic": True},
        "the last value of a periodic motion must be the first, but it is off by 49",
    ),
    "period": (
        "t,q", RAMP_ROWS, {"period": 0.5},
        r"its rows last 0\.7 s, but the period is 0\.5 s; expected rows of exactly one period",
    ),
    "advance": ("t,q", RAMP_ROWS, {"advance": 1.0}, "advance= needs periodic=True"),
    "noise": (
        "t,q", RAMP_ROWS, {"smoothing": -1.0}, "smoothing: expected a number of at least 0, got -1"
    ),
    "auto": ("t,q", RAMP_ROWS, {"smoothing": "auto"}, "or 'estimated': expected a finite number"),
    "straight": ("t,q", RAMP_ROWS, {"smoothing": 1e3}, "a smoothing of 1000 leaves only a"),
    "points": ("t,q", RAMP_ROWS, {"points": 3}, "points: expected a whole number of at least 5"),
    "many": ("t,q", RAMP_ROWS, {"points": 10**20}, "not enough memory for .*points"),
    "rows": ("t,q", RAMP_ROWS[: RAMP_ROWS.index("0.4")], {}, "expected at least 5 rows"),
    "back": ("t,q", RAMP_ROWS + "\n0.7,1", {}, "line 10: times must increase, but 0.7 follows 0.7"),
    "stamp": ("t,q", "\n".join(f"{NANO + max(k, 1)},0" for k in range(8)), {},
              f"line 3: times must increase, but {NANO + 1} follows {NANO + 1}"),
    "no stamp": ("t,q", "2025-01-31T12:00:00Z,1\nnoon,2", {}, "line 3, column 't': expected"),
    "nan": ("t,q", RAMP_ROWS + "\n0.9,nan", {}, "line 10, column 'q': expected"),
    **{
        f"head {cell}": (f"0,{cell}", RAMP_ROWS, {}, "line 1: expected a finite number, got")
        for cell in ("nan", "-inf", "1_0", "\u0663", "1.2.3")
    },
    "empty": ("# nothing", "", {}, "it has no rows"),
    "short": ("t;q", "0;1\n1;2\n# why\n2;", {}, "line 5, column 'q': expected"),
}  # fmt: skip


def geared(law, **keywords):
    """An arm behind a gear, whose motor moves by samples: ``law(ratio, lead, duration)``."""
    m = Mechanism("geared")
    told = (
        m.parameter("ratio", 2.0),
        m.parameter("lead", 0.0),
        m.parameter("duration", 1.0, low=0.1),
    )
    m.revolute("J", m.ground, m.link("arm", length=0.5, mass=1.0))
    return Scene(m, {"J": law(*told)}, **{"t": (0, 1, 57)} | keywords)


POINTS = np.linspace(0.0, 1.0, 14)


ANGLES = 0.4 * np.sin(5 * POINTS) + POINTS**2


SCALED = {
    "vector": lambda r, a, T: samples(POINTS, r * ANGLES),
    "divided": lambda r, a, T: samples(list(POINTS), [angle / r + a for angle in ANGLES]),
    "later": lambda r, a, T: samples([T * t for t in POINTS], [-q * r - a for q in ANGLES]),
    "times": lambda r, a, T: samples(T * POINTS, ANGLES),
    "polynomial": lambda r, a, T: polynomial(a, r / T, r * a),
    "harmonic": lambda r, a, T: harmonic(a, r, 1 / T, r * a),
    "expression": lambda r, a, T: expression(lambda t: r * ca.sin(t / T) + a),
}


@pytest.mark.parametrize("name", SCALED)
def test_laws_scaled_by_parameters_are_those_of_scaled_numbers(name):
    """Designs too, whose peaks need the third derivative."""
    scene, rows = geared(SCALED[name]), [[2.0, 0.0, 1.0], [-0.7, 0.3, 1.5], [3.1, -1.0, 2.0]]
    prepared = prepare(scene, wanted=["effort"])
    designs = prepared.designs(rows)
    for row, value in zip(rows, designs.value[:, 0], strict=True):
        values = dict(zip(("ratio", "lead", "duration"), row, strict=True))
        found = evaluate(scene, parameters=values)
        numbers = evaluate(geared(lambda *_, row=row: SCALED[name](*row)))
        assert found.certified
        for quantity in numbers.names():
            size = np.abs(numbers.array(quantity)).max() or 1.0
            np.testing.assert_allclose(
                found.array(quantity), numbers.array(quantity), rtol=0, atol=1e-10 * size
            )
        (peak,) = refine(scene, found, ["effort:J"])
        assert abs(value - peak.value) <= 1e-9 * abs(peak.value)


TWO = {
    "two.csv: unknown column 'b'; valid: t, a": ("t,a [deg]", {"columns": ["b"]}),
    "unknown coordinate of unit= 'b'; valid: a": ("t,a", {"unit": {"b": "deg"}}),
    "column a is in counts; expected counts_per_turn=": ("t,a [counts]", {}),
    "column a is in deg; expected counts, of which": (
        "t,a [counts]",
        {"unit": {"a": "deg"}, "counts_per_turn": {"a": 9}},
    ),
    "two.csv: columns= expected at least one coordinate": ("t,a", {"columns": []}),
    "the file has no column heads; name the columns with columns=": ("0,0", {}),
    "column a: smoothing: expected a number": ("t,a", {"smoothing": {"a": -1.0}}),
}


@pytest.mark.parametrize("what", [*REFUSED, *TWO])
def test_misuse_is_named(here, what):
    name, read = ("axis", read_samples) if what in REFUSED else ("two", read_motion)
    (head, options), rows, says = TWO.get(what, ("", {})), RAMP_ROWS, what
    if what in REFUSED:
        head, rows, options, says = REFUSED[what]
    (here / f"{name}.csv").write_text(f"{head}\n{rows}\n")
    with pytest.raises((DeclarationError, SizeError, UnknownNameError), match=says):
        read(f"{name}.csv", **options)


def test_headers_of_opensim_are_needed(here):
    write(here / "walk.sto", ["time", "knee"], np.column_stack([TIMES, KNEE]))
    with pytest.raises(DeclarationError, match="expected a header that ends in the line 'endhead"):
        read_motion("walk.sto")
    with pytest.raises(PathError, match=r"none\.mot"):
        read_motion("none.mot")


@pytest.mark.parametrize("smoothing", [0.001, "estimated"])
@pytest.mark.parametrize("points", [None, 150])
def test_smoothing_takes_the_noise_out_of_accelerations(here, smoothing, points):
    """0.001 deg of noise at a millisecond; what is left is a hundredth, in the root mean square, of
    what it makes.
    """
    rise = move("60 deg", time=0.4, law="modified_sine")
    fall = move(0.0, time=0.5, law="s_curve")
    t = np.arange(1201) / 1000.0
    clean = derivatives(moves([rise, dwell(0.2), fall, dwell(0.1)], cyclic=True), t)
    noisy = np.degrees(clean[0]) + 0.001 * np.random.default_rng(3).normal(size=t.size)
    noisy[-1] = noisy[0]
    path = write(here / "axis.csv", ["t", "q"], np.column_stack([t, noisy]))
    asked = ({}, {"smoothing": smoothing, "points": points})
    rough, smooth = (read_samples(path, unit="deg", periodic=True, **more) for more in asked)
    off = [np.sqrt(np.mean((derivatives(law, t)[2] - clean[2]) ** 2)) for law in (rough, smooth)]
    assert off[0] > 2.0 * np.abs(clean[2]).max()
    assert off[1] < min(0.01 * off[0], 0.02 * np.abs(clean[2]).max())
    assert "smoothed by 0.00" in smooth.description
    at_most = re.search(r"at most (\S+) deg from them", smooth.description)[1]
    apart = np.abs(np.degrees(derivatives(smooth, t)[0]) - noisy).max()
    assert float(at_most) == pytest.approx(apart, rel=1e-2)


def test_units_of_a_file_are_those_of_a_motion_too(here):
    """In the head, whose column is called with it or without it; counts of encoders are turns."""
    file = write(here / "axis.csv", ["t [ms]", "q [deg]"], np.column_stack([1e3 * TIMES, KNEE]))
    expected = curve(TIMES, np.radians(np.round(KNEE, 13)))
    for value in (2, "q", "q [deg]"):
        same(read_samples(file, value=value), expected, AT)
    counts, options = np.round(1000 / 360 * HIP), {"ratio": 0.1, "offset": 0.2, "stretch": 1.5}
    write(file, ["t", "a [counts]"], np.column_stack([TIMES, counts]))
    exact = curve(1.5 * TIMES, 0.2 + 0.1 * math.tau / 1000 * counts)
    same(read_motion(file, counts_per_turn={"a": 1000}, **options)["a"], exact, 1.5 * AT)
    same(read_samples(file, value="a", counts_per_turn=1000, **options), exact, 1.5 * AT)


def test_scaled_samples_end_and_are_scaled_together():
    p, q = ca.SX.sym("p"), ca.SX.sym("q")
    for law, says in (
        (lambda: samples([0, 1, 2, 3], [0, p, q, p * p]), "values: parameters may only scale"),
        (lambda: samples([0, p, 0.5 * p, 2 * p], [0, 1, 2, 3]), "places must increase"),
        (lambda: evaluate(geared(lambda *_: samples(POINTS, p * ANGLES))), "depends on 'p', not"),
        (
            lambda: evaluate(geared(SCALED["times"]), parameters={"duration": 0.5}),
            r"motion of joint 'J': .* outside the curve's range at t = 0\.5",
        ),
    ):
        with pytest.raises(DeclarationError, match=says):
            law()
