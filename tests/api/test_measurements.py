"""Records of machines are read as loggers write them, and what is wrong in them is said."""

import numpy as np
import pytest
from measured_machines import ARM, PLATE, platform, record, rubbing, two_links

from lagrange_casadi import Measurements, excite, identify, read_measurements
from lagrange_casadi.errors import AssemblyError, DeclarationError


def test_columns_of_a_file_have_units_counts_and_gaps(tmp_path):
    path = tmp_path / "run.csv"
    t = np.arange(200) * 5.0 + np.random.default_rng(0).uniform(0, 2, 200)  # ms
    angle = 30.0 * np.sin(2 * np.pi * t / 1000.0)  # deg
    counts = np.round(angle / 360.0 * 4096)
    lines = ["t [ms],A [deg],B [counts],torque [mN m]"]
    for k, (at, a, n) in enumerate(zip(t, angle, counts, strict=True)):
        lines.append(f"{at:.6f},{a:.9f},{n:.0f},{'' if k == 7 else 1000 + k}")
    path.write_text("\n".join(lines) + "\n")
    given = read_measurements(
        path, names={"effort:A": "torque"}, noise={"A": 0.01}, counts_per_turn=4096
    )
    assert np.isnan(given.columns["effort:A"][7])
    assert given.columns["effort:A"][8] == pytest.approx(1.008)
    assert given.noise == pytest.approx({"A": np.radians(0.01), "B": 2 * np.pi / 4096 / 12**0.5})
    motion = given.motion(["A", "B"], trim=0.05)
    inner = np.isfinite(motion.acceleration[:, 0])
    true = -np.radians(30.0) * (2 * np.pi) ** 2 * np.sin(2 * np.pi * given.t)
    off = np.abs(motion.acceleration[inner] - true[inner, None]).max(axis=0) / true.max()
    assert off[0] < 0.1
    assert off[1] < 0.3
    assert 5.0 < given.cutoff("A") < 100.0
    assert given.quantities(["A", "B"]) == ("effort:A",)
    path.write_text("\n".join([lines[0], "0,1,x,3"]))
    with pytest.raises(
        DeclarationError, match=r"line 2, column .*: expected a finite number, got 'x'"
    ):
        read_measurements(path, counts_per_turn=4096)


def test_each_encoder_has_its_counts(tmp_path):
    path, turn = tmp_path / "run.csv", np.arange(9) / 10
    rows = [f"{k},{4096 * x:.0f},{1000 * x:.0f}" for k, x in enumerate(turn)]
    path.write_text("\n".join(["t [s],A [counts],slow [counts]", *rows]))
    given = read_measurements(path, names={"B": "slow"}, counts_per_turn={"A": 4096, "B": 1000})
    for name, counts in (("A", 4096), ("B", 1000)):
        np.testing.assert_allclose(given.columns[name], 2 * np.pi * turn, atol=np.pi / counts)
        assert given.noise[name] == pytest.approx(2 * np.pi / counts / 12**0.5)
    for wrong, words in (
        ({"A": 4096}, r"run\.csv: column slow is in counts; expected counts_per_turn="),
        ({"A": 4096, "B": 0}, "column slow is in counts; .* a number above 0, got 0"),
        ({"A": 4096, "slow": 9}, "unknown column of counts_per_turn= 'slow'; valid: A, B"),
        (None, "column A is in counts; expected counts_per_turn="),
        (0, "counts_per_turn: expected a positive number or values by name"),
    ):
        with pytest.raises(DeclarationError, match=words):
            read_measurements(path, names={"B": "slow"}, counts_per_turn=wrong)


def test_an_angle_that_begins_again_after_each_turn_goes_on(tmp_path):
    path, turn = tmp_path / "run.csv", np.arange(41) / 16
    rows = [f"{k},{360.0 * (x % 1.0):g},{x % 0.7:g}" for k, x in enumerate(turn)]
    path.write_text("\n".join(["t [s],A [deg],B [m]", *rows]))
    given = read_measurements(path)
    np.testing.assert_allclose(given.columns["A"], 2 * np.pi * turn, atol=1e-12)
    np.testing.assert_allclose(given.columns["B"], turn % 0.7, atol=1e-6)


def test_smoothing_halves_the_power_at_its_cutoff():
    """By the spectra of a noisy record and of what is left of the noise."""
    draw, t = np.random.default_rng(2), np.arange(20_000) / 1000
    noise = draw.normal(scale=1e-3, size=t.size)
    given = Measurements(t, {"A": np.sin(2 * np.pi * t) + noise}, noise={"A": 1e-3})
    left = given.motion(["A"], trim=0.0).d[:, 0] - np.sin(2 * np.pi * t)
    frequencies, cutoff = np.fft.rfftfreq(t.size, 1e-3), given.cutoff("A")
    near = np.abs(frequencies / cutoff - 1.0) < 0.2
    share = np.fft.rfft(left)[near] / np.fft.rfft(noise)[near]
    assert np.median(share.real) == pytest.approx(0.5**0.5, rel=0.05)


def test_a_drive_at_rest_and_a_wrong_sign_are_said():
    scene = two_links()
    given = record(scene, ARM, "effort:A")
    columns = {name: given.columns[name] for name in ("A", "effort:A")}
    columns |= {"B": np.full(given.t.size, 0.8), "index": given.t}
    rest = identify(scene, Measurements(given.t, columns, {"B": 1e-3}))
    assert "B is a straight line within its noise" in rest.notes
    assert "columns that are not used: index" in rest.notes
    assert rest.unexcited
    assert not any("J2" in note for note in rest.notes if note.startswith("nothing"))
    turned = Measurements(given.t, dict(given.columns) | {"effort:A": -given.columns["effort:A"]})
    assert identify(scene, turned).opposite["effort:A"] < -0.9
    assert not rest.opposite


HEADS = "t [s],A [rad],B [rad],effort:A [N m]"


def written(given, heads, path):
    """A record as a file under some heads."""
    columns = [given.t, *(given.columns[name] for name in ("A", "B", "effort:A"))]
    rows = [",".join(f"{x:.9g}" for x in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([heads, *rows]))
    return rows


@pytest.mark.parametrize(
    ("column", "head", "says"),
    [
        (1, "A [mm]", "'A' is in mm, a length; expected an angle"),
        (3, "effort:A [mm]", "'effort:A' is in mm, a length; expected a moment"),
        (0, "t [deg]", "is in deg, an angle; expected a time"),
    ],
)
def test_a_unit_of_another_quantity_is_refused(arm_record, tmp_path, column, head, says):
    scene, given = arm_record
    heads = [head if k == column else one for k, one in enumerate(HEADS.split(","))]
    written(given, ",".join(heads), tmp_path / "run.csv")
    with pytest.raises(DeclarationError, match=says):
        identify(scene, read_measurements(tmp_path / "run.csv"), ["J2"])


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda rows: rows[:1], "run.csv: expected at least 8 rows of measurements, got 1"),
        (lambda rows: [], "run.csv: expected at least 8 rows of measurements, got 0"),
        (
            lambda rows: [*rows[:3], rows[4], rows[3], *rows[5:]],
            r"run.csv, line 6: times must increase, but 0\.03 follows 0\.04",
        ),
        (lambda rows: [*rows[:3], "nan,nan,nan,nan", *rows[4:]], "line 5, column 't.* got 'nan'"),
        (
            lambda rows: [*rows[:3], "0.03,inf,1,1", *rows[4:]],
            r"line 5, column 'A \[rad.* got 'inf'",
        ),
        (
            lambda rows: ["0,,,", *rows[1:]],
            "column 'A' has no value in the first row; expected one",
        ),
        (lambda rows: [*rows, "9,,,"], "column 'A' has no value in the last row; expected one in"),
        (lambda rows: [f"{row}," for row in rows], "line 2: 5 cells, expected 4"),
    ],
    ids=["one", "none", "back", "nan", "inf", "no first", "no last", "a cell too many"],
)
def test_rows_that_are_wrong_are_refused(tmp_path, change, says):
    scene, path = two_links(), tmp_path / "run.csv"
    rows = written(record(scene, ARM, "effort:A"), HEADS, path)

    def found(rows, heads=HEADS):
        path.write_text("\n".join([heads, *rows]))
        return identify(scene, read_measurements(path), ["J2"], parameters=ARM)

    with pytest.raises(DeclarationError, match=says):
        found(change(rows))
    gap = found([*rows[:3], f"{rows[3].split(',')[0]},,,", *rows[4:]])
    assert gap.values["J2"] == pytest.approx(0.16, rel=1e-2)
    nameless = found([f"{row}," for row in rows], "t,A,B,effort:A,")
    assert nameless.values["J2"] == pytest.approx(0.16, rel=1e-2)


LIMITS = {"A": (-1.0, 1.0, 2.0, 9.0), "B": (0.0, 1.5, 3.0, 20.0)}


def more(given, **columns):
    """A record with other columns beside its own."""
    return Measurements(given.t, {**given.columns, **columns})


def few(given):
    columns = {name: given.columns[name][:8] for name in ("A", "B", "effort:A")}
    columns["effort:A"] = np.where(np.arange(8) < 4, columns["effort:A"], np.nan)
    return Measurements(given.t[:8], columns)


def far():
    columns = dict(record(platform(), PLATE, "effort:d0").columns)
    columns["d0"] = columns["d0"] + np.linspace(0.0, 3.0, columns["d0"].size)
    return Measurements(np.linspace(0, 2, 201), columns)


def strained(given, name):
    return identify(rubbing(), Measurements(given.t, {"O": given.t, name: given.t}))


NOTHING, NONE = "nothing that is measured depends on the unknown", "expected at least one unknown"


IMPOSSIBLE = {
    "parameter": (lambda s, g: identify(s, g, ["mass"]), "unknown parameter 'mass'"),
    "quantity": (
        lambda s, g: identify(s, more(g, **{"effort:C": g.t})),
        "unknown measured quantity 'effort:C'",
    ),
    "nearly": (
        lambda s, g: identify(s, more(g, **{"efort:A": g.t})),
        "'efort:A' .did you mean 'effort:A'",
    ),
    "not measured": (lambda s, g: identify(s, g, ["m1"]), NOTHING),
    "not excited": (lambda s, g: excite(s, LIMITS, ["m1"]), NOTHING),
    "nothing sought": (lambda s, g: identify(s, g, []), NONE),
    "nothing excited": (lambda s, g: excite(s, LIMITS, []), NONE),
    "prior": (lambda s, g: identify(s, g, prior={"m2": 0.0}), "prior of 'm2': .* above 0"),
    "unknown prior": (
        lambda s, g: identify(s, g, prior={"mm": 0.1}), "unknown parameter of prior= 'mm'"
    ),
    "unknown limit": (
        lambda s, g: excite(s, LIMITS | {"C": LIMITS["A"]}),
        "unknown drive of limits= 'C'; valid: A",
    ),
    "no limit": (
        lambda s, g: excite(s, {"A": LIMITS["A"]}), "limits=: expected those of drive 'B' too"
    ),
    "limit of words": (
        lambda s, g: excite(s, LIMITS | {"A": ("x", 1, 1, 1)}), "limits of 'A': expected a finite"
    ),
    "limit": (lambda s, g: excite(s, LIMITS | {"A": 3}), "limits of 'A': .* least .* got 3"),
    "link without a beam": (
        lambda s, g: strained(g, "strain:crank:side +y@0.5"),
        "unknown measured quantity .* valid: strain:coupler",
    ),
    "beam": (
        lambda s, g: strained(g, "strain:rocker:side +y@0.5"),
        "strain:.*@0.5: unknown link with a beam 'rocker'",
    ),
    "force": (
        lambda s, g: strained(g, "section:rocker:bend@0.5"),
        "unknown section force 'bend' .did you mean 'bending'",
    ),
    **{
        f"place {place}": (
            lambda s, g, place=place: identify(s, more(g, **{f"section:l1:bending@{place}": g.t})),
            "place xi/l from 0 to 1|measured quantity",
        )
        for place in ("1.5", "e", "-0.1")
    },
    "no column": (
        lambda s, g: identify(s, Measurements(g.t, {"A": g.columns["A"], "effort:A": g.t})),
        "column of a drive 'B'",
    ),
    "times": (
        lambda s, g: Measurements(g.t[::-1], {}),
        "times that increase, got 3 s and then 2.99 s in rows 1 and 2",
    ),
    "no rows": (lambda s, g: Measurements(g.t[:0], {}), "at least 8 rows of measurements, got 0"),
    "rows": (
        lambda s, g: Measurements(g.t, {"A": g.t[:3]}), "'A': expected 301 values, .* got 3"
    ),
    "noise": (
        lambda s, g: Measurements(g.t, {"A": g.t}, noise={"A": -1.0}),
        "noise of 'A': expected a number that is not negative, got -1",
    ),
    "no noise": (
        lambda s, g: identify(s, Measurements(g.t, g.columns, noise={"effort:A": 0.0})),
        "noise of 'effort:A': expected a number above 0",
    ),
    "no force": (
        lambda s, g: identify(s, Measurements(g.t, {name: g.columns[name] for name in "AB"})),
        "expected a column of a force, as effort:A; got A, B",
    ),
    "gaps": (
        lambda s, g: identify(s, more(g, A=np.where(g.t % 3.0 == 0.0, g.columns["A"], np.nan))),
        "column 'A': expected at least . values, got 2",
    ),
    "no motion": (
        lambda s, g: excite(platform(), dict.fromkeys(("d0", "d1", "d2"), (9.0, 99.0, 1e3, 1e5))),
        "cannot follow any of .* random motions within the limits",
    ),
    "no effort": (lambda s, g: excite(s, LIMITS, ["m1"], quantities=["effort:A"]), NOTHING),
    "no values": (
        lambda s, g: Measurements(g.t, {"A": np.full(301, np.nan)}), "column 'A' has no values"
    ),
    "too few": (
        lambda s, g: identify(s, few(g)), "4 measured values do not determine 5 unknown"
    ),
    "trim": (
        lambda s, g: identify(s, g, trim=5.0), "trim=5: expected less than half of the 3 s"
    ),
    "out of reach": (lambda s, g: identify(platform(), far()), "cannot be closed at row"),
}  # fmt: skip


@pytest.mark.parametrize("what", IMPOSSIBLE)
def test_what_cannot_be_is_refused_by_name(arm_record, what):
    asked, says = IMPOSSIBLE[what]
    with pytest.raises((AssemblyError, DeclarationError), match=says):
        asked(*arm_record)


@pytest.fixture(scope="module")
def arm_record():
    scene = two_links()
    return scene, record(scene, ARM, "effort:A", "effort:B")


def test_a_measured_rate_does_not_keep_a_coordinate_from_being_smoothed(arm_record):
    given = arm_record[1]
    rough = given.columns["A"] + 1e-3 * np.random.default_rng(0).standard_normal(given.t.size)
    motion = Measurements(given.t, {**given.columns, "A": rough}, {"A": 1e-3}).motion(["A", "B"])
    assert np.sqrt(np.mean((motion.d[:, 0] - given.columns["A"]) ** 2)) < 7e-4
    np.testing.assert_array_equal(motion.rate[:, 0], given.columns["A_rate"])
