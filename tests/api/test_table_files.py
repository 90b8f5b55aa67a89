"""Tables: the dialects that every reader takes, and what is refused by its line; and what commands
write, as CSV and as workbooks.
"""

import csv
import importlib.util
import os
import re
from pathlib import Path

import numpy as np
import pytest
from commands import command
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st
from sweeps import ASKED, BENDING

from lagrange_casadi import Sweep, read_designs
from lagrange_casadi.actuators import read_motors
from lagrange_casadi.beams import read_profiles
from lagrange_casadi.cli import main
from lagrange_casadi.errors import (
    DeclarationError,
    PathError,
    UnknownNameError,
)

pytestmark = pytest.mark.quick

HEADS = {
    "designs": ["r", "l", "phi"],
    "motors": [
        "name",
        "stall_torque",
        "rated_torque",
        "rated_speed",
        "peak_torque",
        "max_speed",
        "inertia",
    ],
    "profiles": ["name", "height [mm]", "width", "web [cm]"],
}


def designs(path):
    found = read_designs(path)
    return found.rows, found.lines


READERS = {
    "designs": designs,
    "motors": read_motors,
    "profiles": read_profiles,
}

DIALECTS = [(",", "."), (";", ","), (";", "."), ("\t", ","), ("\t", ".")]

sizes = st.floats(0.125, 2.0).map(lambda number: f"{number:.6f}")


@st.composite
def tables(draw):
    """What a table is of, and its rows as cells, with points."""
    kind = draw(st.sampled_from(sorted(HEADS)))
    rows = []
    for k in range(draw(st.integers(5, 8))):
        if kind == "motors":
            rows.append([f"m{k}", draw(sizes), "0.0625", "3000.5", "2.5", "5000", draw(sizes)])
        else:
            first = {"samples": f"{0.1 * k:.3f}", "profiles": f"p{k}"}.get(kind) or draw(sizes)
            rows.append([first, *(draw(sizes) for _ in HEADS[kind][1:])])
    return kind, rows


def write(folder, kind, rows, delimiter=",", mark="."):
    path = folder / f"{kind}.csv"
    lines = [
        delimiter.join(HEADS[kind]),
        *(delimiter.join(cell.replace(".", mark) for cell in row) for row in rows),
    ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("tables")


def flat(found):
    """Something that can be compared."""
    return [value.tolist() if isinstance(value, np.ndarray) else value for value in found]


@given(tables(), st.sampled_from(DIALECTS))
def test_a_table_is_the_same_in_every_dialect(folder, table, dialect):
    kind, rows = table
    expected = flat(READERS[kind](write(folder, kind, rows)))
    assert flat(READERS[kind](write(folder, kind, rows, *dialect))) == expected


@given(tables(), st.data())
def test_a_row_of_another_length_is_refused_by_its_line(folder, table, data):
    kind, rows = table
    delimiter, mark = data.draw(st.sampled_from(DIALECTS))
    k = data.draw(st.integers(0, len(rows) - 1))
    damage = data.draw(st.sampled_from(["longer", "shorter"]))
    row = [*rows[k], "5"] if damage == "longer" else rows[k][:-1]
    path = write(folder, kind, [*rows[:k], row, *rows[k + 1 :]], delimiter, mark)
    with pytest.raises(DeclarationError) as caught:
        READERS[kind](path)
    assert str(caught.value).startswith(
        f"{path}, line {k + 2}: {len(row)} cells, expected {len(HEADS[kind])}"
    )


@given(tables(), st.data())
def test_decimal_commas_among_commas_are_named(folder, table, data):
    """``2,1,5`` was 1.0: the rest was dropped."""
    kind, rows = table
    k = data.draw(st.integers(0, len(rows) - 1))
    path = write(
        folder, kind, [*rows[:k], [cell.replace(".", ",") for cell in rows[k]], *rows[k + 1 :]]
    )
    with pytest.raises(
        DeclarationError,
        match=rf"line {k + 2}: .* decimal commas\? expected points, or ';' between cells$",
    ):
        READERS[kind](path)


@given(tables(), st.data())
def test_a_mark_that_parts_thousands_is_refused(folder, table, data):
    """``1.234`` among ``2,5`` is 1234, and 1.234 to whoever does not look at the others."""
    kind, rows = table
    k, mark = data.draw(st.integers(0, len(rows) - 1)), data.draw(st.sampled_from(",."))
    column = data.draw(
        st.sampled_from(
            [j for j, cell in enumerate(rows[k]) if "." in cell and (kind != "samples" or j < 2)]
        )
    )
    other = {",": ".", ".": ","}[mark]
    changed = [[cell.replace(".", mark) for cell in row] for row in rows]
    changed[k][column] = rows[k][column].replace(".", other)
    with pytest.raises(
        DeclarationError,
        match=r"among numbers with decimal (points|commas), as in .*; expected one kind$",
    ):
        READERS[kind](write(folder, kind, changed, ";", "."))


@given(tables(), st.data())
@settings(suppress_health_check=[HealthCheck.filter_too_much])
@example(("designs", [["0.2", "0.5", "1"]] * 5), None)
def test_digits_of_other_scripts_are_no_numbers(folder, table, data):
    kind, rows = table
    zero = 0x660 if data is None else data.draw(st.sampled_from([0x660, 0x966, 0xFF10, 0x1D7CE]))
    k = 0 if data is None else data.draw(st.integers(0, len(rows) - 1))
    columns = [
        j for j, cell in enumerate(rows[k]) if cell[0].isdigit() and (kind != "samples" or j < 2)
    ]
    column = columns[0] if data is None else data.draw(st.sampled_from(columns))
    cell = "".join(chr(zero + int(sign)) if sign.isdigit() else sign for sign in rows[k][column])
    assume(cell != rows[k][column])
    path = write(
        folder, kind, [*rows[:k], [*rows[k][:column], cell, *rows[k][column + 1 :]], *rows[k + 1 :]]
    )
    with pytest.raises(
        DeclarationError,
        match=rf"line {k + 2}.* must be a positive number|expected a (finite|positive) number",
    ):
        READERS[kind](path)


@pytest.mark.parametrize("kind", sorted(READERS))
def test_what_is_no_regular_file_is_refused_at_once(here, kind):
    os.mkfifo("pipe.csv")
    (here / "link.csv").symlink_to("pipe.csv")
    (here / "folder.csv").mkdir()
    for name, what in (
        ("pipe", "a device or a pipe"),
        ("link", "a device or a pipe"),
        ("folder", "a folder"),
    ):
        with pytest.raises(PathError, match=rf"^{name}\.csv: is {what}, not a file$"):
            READERS[kind](f"{name}.csv")
    with pytest.raises(PathError, match=r"^/dev/zero: is a device or a pipe, not a file$"):
        READERS[kind]("/dev/zero")


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_lines_keep_their_numbers(here, end, delimiter):
    """Comments, blank lines and those without any cell are passed over."""
    text = ["# said by hand", "", f"l{delimiter} r ", "  # left out", f'"0.2"{delimiter}1e-1']
    text += [delimiter, "   ", f"0.3{delimiter}.05"]
    Path("d.csv").write_bytes(end.join(text).encode("utf-8-sig"))
    found = read_designs("d.csv")
    assert (found.names, found.lines.tolist()) == (("l", "r"), [5, 8])
    assert found.rows.tolist() == [[0.2, 0.1], [0.3, 0.05]]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "it has no rows; expected a first line of parameters' names"),
        ("l,r\n", "no designs below its head l, r"),
        ("l,r\n0.2\n", "line 2: 1 cells, expected 2, as in the first row"),
        ("l,r\n0.2,0.1\n0.2,0.1,0.3\n", "line 3: 3 cells, expected 2"),
        ("l,r\n0.2,0.1\n0.2,abc\n", "line 3, column 'r': expected a finite number, got 'abc'"),
        ("l,r\n0.2,\n", "line 2, column 'r': expected a finite number, got ''"),
        ("l,r\nnan,0.1\n", "line 2, column 'l': expected a finite number, got 'nan'"),
        ("l,,r\n1,2,3\n", "line 1, column 2: expected a parameter's name, got an empty cell"),
        (
            "0.2,0.1\n0.3,0.1\n",
            (
                "line 1, column 1: expected a parameter's name, got '0.2': put a line of names"
                " above the numbers"
            ),
        ),
        (
            "l,r\n0,2,0,1\n",
            "line 2: 4 cells, expected 2: decimal commas? expected points, or ';' between cells",
        ),
        (
            "l,peak:effort:O\n0.2,nan\n",
            (
                "line 1, column 2: 'peak:effort:O' is a result of a sweep, not a parameter: take"
                " the results out"
            ),
        ),
        ("l,peak:effort:O\n0.2,nan\n", "`lagrange-casadi table` writes the chosen columns"),
        ("l,r\n1_0,0.1\n", "line 2, column 'l': expected a finite number, got '1_0'"),
        (
            'l,r\n0.2,0.1\n0.2,"0.1\n0.3,0.1\n',
            "line 3: no cells with ',' between them: a quote is opened and never closed",
        ),
        ('l,r\n0.2,"0.1"3\n', "line 2: no cells with ',' between them: ',' expected after"),
        ("l,r,l\n1,2,3\n", "line 1, column 3: 'l' is already column 1"),
    ],
)
def test_what_is_wrong_in_a_list_is_named(tmp_path, text, says):
    path = tmp_path / "d.csv"
    path.write_text(text)
    with pytest.raises(DeclarationError, match=re.escape(says)) as caught:
        read_designs(path)
    assert str(caught.value).startswith(str(path))


def test_the_head_is_checked_before_the_numbers(tmp_path):
    path = tmp_path / "d.csv"
    path.write_text("l,note,r\n0.2,hello,0.1\n")
    with pytest.raises(UnknownNameError) as caught:
        read_designs(path, ["l", "r"])
    assert str(caught.value) == f"{path}, line 1, column 2: unknown parameter 'note'; valid: l, r"
    path.write_text("design,l\n0,0.2\n")
    with pytest.raises(
        DeclarationError, match="line 1, column 1: 'design' is a result of a sweep, not a parameter"
    ):
        read_designs(path, ["l", "r"])
    assert read_designs(path, ["l", "design"]).names == ("design", "l")
    assert read_designs(path, {"l": None, "design": None}).names == ("design", "l")


PROFILES = [
    ("", r"bars\.csv: it has no rows; expected a head and a line for every profile"),
    ("name,d\n", r"bars\.csv, line 1: expected a line for every profile below this head"),
    ("d,e\n1,2\n", "expected a column 'name' and one for each dimension, got d, e"),
    ("name,d [ft]\nx,1\n", r"column 'd \[ft\]': expected a name, and m, cm or mm as its unit"),
    ("name,d\nx,1\nx,2\n", "line 3: profile 'x' is listed twice"),
    ("name,d\n ,1\n", "line 2: it has no name"),
    ("name,d\nx,-1\n", "line 2: d: expected a positive number, got '-1'"),
]


@pytest.mark.parametrize(("text", "says"), PROFILES)
def test_a_bad_line_of_profiles_is_named(here, text, says):
    Path("bars.csv").write_text(text)
    with pytest.raises(DeclarationError, match=says):
        read_profiles("bars.csv")


@pytest.fixture
def swept(here, capfd):
    assert command(f"{ASKED} --grid l=0.2,0.3 --out s.h5") == 0
    capfd.readouterr()
    return Sweep.open("s.h5")


COMMANDS = {
    "run": ["run", "slider_crank", "--no-figures", "--want", "effort", "--t", "0:0.08:4"],
    "table": ["table", "s.h5", "--column", BENDING],
    "best": ["best", "s.h5", "--minimise", BENDING],
    "tolerances": "tolerances slider_crank --want effort --samples 9 --tolerance l=1%".split(),  # noqa: SIM905
}


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_writes_the_same_table_in_every_form(swept, capfd, command):
    """The numbers of a file with commas, and of a workbook, are those of the one with points."""
    for more in (["--csv", "p.csv"], ["--csv", "c.csv", "--decimal-comma"]):
        assert main([*COMMANDS[command], *more]) == 0
    with open("p.csv", newline="") as points, open("c.csv", newline="") as commas:
        plain, marked = list(csv.reader(points)), list(csv.reader(commas, delimiter=";"))
    assert plain[0] == marked[0]
    assert any(head.endswith("]") for head in plain[0]) or "unit" in plain[0]
    assert [[cell.replace(",", ".") for cell in row] for row in marked[1:]] == plain[1:]
    openpyxl = pytest.importorskip("openpyxl")
    assert main([*COMMANDS[command], "--csv", "b.xlsx"]) == 0
    rows = list(openpyxl.load_workbook("b.xlsx").active.iter_rows(values_only=True))
    assert list(rows[0]) == plain[0]
    for row, texts in zip(rows[1:], plain[1:], strict=True):
        for value, text in zip(row, texts, strict=True):
            if isinstance(value, str):
                assert value == text
            else:
                assert value == pytest.approx(float(text), rel=1e-15)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_mistake_is_one_line_before_anything_is_done(swept, capfd, monkeypatch, command):
    before = sorted(Path().iterdir())
    said = {
        ("--decimal-comma",): "--decimal-comma goes with --csv FILE.csv",
        ("--csv", "x.xlsx", "--decimal-comma"): "x.xlsx: decimal commas are for CSV; a workbook"
        " has numbers, and the spreadsheet program decides how to display them",
        ("--csv", "x.ods"): "x.ods: no table is written as .ods; use .csv or .xlsx",
        ("--csv", "x.XLS"): "x.XLS: no table is written as .XLS; use .csv or .xlsx",
        ("--csv", "no/x.xlsx"): "cannot write no/x.xlsx: folder no does not exist",
        ("--csv", "no/x.csv", "--decimal-comma"): "cannot write no/x.csv: folder no does not exist",
    }
    for more, words in said.items():
        if "no/x.xlsx" not in more or importlib.util.find_spec("openpyxl"):
            assert main([*COMMANDS[command], *more]) == 2
            assert capfd.readouterr() == ("", f"error: {words}\n")
    monkeypatch.setattr("importlib.util.find_spec", lambda name, *_: None)
    assert main([*COMMANDS[command], "--csv", "x.xlsx"]) == 2
    assert capfd.readouterr().err == (
        "error: a workbook needs openpyxl; install it with: pip install 'lagrange_casadi[xlsx]'\n"
    )
    assert sorted(Path().iterdir()) == before


@pytest.fixture
def file(here, capfd):
    """A small sweep's file."""
    designs = "--grid l=0.06:0.36:4 --grid r=0.05,0.1 --set m3=0.2 --xi 0:1:3"
    assert command(f"{ASKED} {designs} --out s.h5") == 0
    capfd.readouterr()
    return Path("s.h5")


def test_best(file, capfd):
    least = f"best s.h5 --minimise {BENDING}"
    assert command(f"{least} --where l>0.2 --count 2 --column rms:effort:O") == 0
    head, *rows = capfd.readouterr().out.splitlines()
    assert " ".join(head.split()) == f"design l [m] r [m] {BENDING} [N m] rms:effort:O [N m]"
    found = Sweep.open("s.h5")
    sizes = np.abs(found[BENDING])[found["l"] > 0.2]
    shown = [float(row.split()[3]) for row in rows]
    np.testing.assert_allclose(np.abs(shown), np.sort(sizes.ravel())[:2], rtol=1e-5)
    assert command(f"{least} --minimise peak:effort:O --csv front.csv") == 0
    assert capfd.readouterr().out.endswith("wrote front.csv: 4 designs\n")
    assert (
        Path("front.csv")
        .read_text()
        .startswith(f"design,l [m],r [m],{BENDING} [N m],peak:effort:O [N m]\n")
    )
    assert command(f"{least} --where l>1") == 1
    said = (
        "error: s.h5: no design has a result and meets the conditions: of 8 designs, {}, {} of"
        " these with a result\n"
    )
    assert capfd.readouterr().err == said.format("0 meet them", 0)
    assert command(f"{least} --where l<0.1 --where r>0.07") == 1
    assert capfd.readouterr().err == said.format("1 meet them", 0)
    assert command(f"{least} --where l==0.1") == 1
    assert (
        capfd.readouterr().err
        == said.format("0 meet them", 0).rstrip() + "; no design has l = 0.1; nearest: 0.06, 0.16\n"
    )


def test_table(file, capfd):
    assert command("table s.h5 --rows 3") == 0
    out = capfd.readouterr().out.splitlines()
    assert out[0].split()[:6] == ["design", "l", "[m]", "r", "[m]", "status"]
    assert out[1].split()[3] == "ok"
    assert out[2].split()[3] == "out_of_reach"
    assert (
        out[4] == "... of 8 designs, 7 with a result; --rows N shows more, --csv OUT.csv writes all"
    )
    assert command("table s.h5 --column rms:effort:O --where status!=0") == 0
    assert capfd.readouterr().out.splitlines()[1].split() == ["1", "0.06", "0.1", "nan"]
    assert command("table s.h5 --where l<0.2 --rows 1") == 0
    assert (
        capfd.readouterr()
        .out.splitlines()[2]
        .startswith("... of 4 designs that meet the conditions, 3 with a result; ")
    )
    assert command("table s.h5 --rows 8") == 0
    out, err = capfd.readouterr()
    assert len(out.splitlines()) == 9
    assert (
        "note: --column NAME shows other columns over xi, a row for every xi:"
        " peak_at:section:rod:axial, peak" in err
    )
    assert command("table s.h5 --column q") == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err == "error: unknown column 'q'; `lagrange-casadi info s.h5` lists the 19 there are\n"


AT = [f"peak_at:section:rod:{force}" for force in ("axial", "shear", "bending")]


def columns(*names):
    return " ".join(f"--column {name}" for name in names)


def test_columns_over_ratios_are_a_row_for_each(file, capfd):
    """The paper's batch as a table: one line for every design and ratio."""
    assert command(f"table s.h5 {columns('peak:effort:O', *AT)} --csv long.csv") == 0
    assert capfd.readouterr() == ("wrote long.csv: 24 rows\n", "")
    with open("long.csv", newline="") as text:
        head, *rows = csv.reader(text)
    units = ["N", "N", "N m"]
    forces = [f"{name} [{unit}]" for name, unit in zip(AT, units, strict=True)]
    assert head == ["l [m]", "r [m]", "xi", "peak:effort:O [N m]", *forces]
    found = Sweep.open("s.h5")
    values = np.array(rows, float).T.reshape(7, 4, 2, 3)
    for k, name in enumerate(AT):
        np.testing.assert_array_equal(values[4 + k], found[name])
    np.testing.assert_array_equal(values[0], np.broadcast_to(found["l"][:, None, None], (4, 2, 3)))
    np.testing.assert_array_equal(values[1], np.broadcast_to(found["r"][:, None], (4, 2, 3)))
    np.testing.assert_array_equal(values[2], np.broadcast_to([0.0, 0.5, 1.0], (4, 2, 3)))
    np.testing.assert_array_equal(
        values[3], np.broadcast_to(found["peak:effort:O"][..., None], (4, 2, 3))
    )


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (
            f"--column {AT[2]} --where xi==0.505",
            "no row meets the conditions; no design has xi = 0.505; nearest: 0.5, 1",
        ),
        (
            "--where l=0.3",
            "no design meets the conditions; no design has l = 0.3; nearest: 0.26, 0.36",
        ),
        ("--where l>1", "no design meets the conditions"),
    ],
)
def test_a_table_of_nothing_is_refused(file, capfd, options, says):
    for more in ("", "--csv x.csv"):
        assert command(f"table s.h5 {options} {more}") == 1
        assert capfd.readouterr() == ("", f"error: s.h5: {says}\n")
    assert not Path("x.csv").exists()


def test_csv_has_every_digit_and_is_a_list_of_designs_again(file, capfd):
    assert command("table s.h5 --csv all.csv") == 0
    assert capfd.readouterr().out == "wrote all.csv: 8 designs\n"
    with open("all.csv", newline="") as text:
        rows = list(csv.DictReader(text))
    found = Sweep.open("s.h5")
    for name in ("status", BENDING, "peak_xi:section:rod:shear", "mean:effort:O"):
        unit = found.unit(name)
        key = name if unit == "1" else f"{name} [{unit}]"
        np.testing.assert_array_equal([float(row[key]) for row in rows], found[name].ravel())
    assert command("table s.h5 --csv list.csv --column l --where status==0") == 0
    assert Path("list.csv").read_text().startswith("l [m],r [m]\n0.06,0.05\n")
    assert command(f"{ASKED} --designs list.csv --set m3=0.2 --out again.h5") == 0
    there = found["status"] == 0
    np.testing.assert_array_equal(Sweep.open("again.h5")[BENDING], found[BENDING][there])


def test_info_check_and_plot_know_sweeps(file, capfd):
    assert command("info s.h5") == 0
    out = capfd.readouterr().out
    assert "swept l: 0.06:0.36:4" in out
    assert [line for line in out.splitlines() if re.match(r"\d+ design", line)] == [
        "7 designs: there is a result",
        "1 design: a loop cannot be closed: its links do not reach",
    ]
    assert re.search(
        r"peak:section:rod:bending +N m +largest magnitude over time: bending moment", out
    )
    assert command("check s.h5") == 0
    assert capfd.readouterr().out == "s.h5: whole and consistent\n"
    assert command("plot s.h5 --out figures --over l --at r=0.05") == 0
    assert {path.stem for path in Path("figures").iterdir()} >= {
        "peak_effort",
        "peak_section_rod",
        "along_rod",
    }
    assert command("run CASE --t 0:0.08:5 --no-figures --out run.h5") == 0
    capfd.readouterr()
    assert command("plot run.h5 --out figures --over l") == 2
    assert "--over, --at and --against go with a sweep's file" in capfd.readouterr().err
    for asked in ("best run.h5 --minimise l", "table run.h5"):
        assert command(asked) == 1
        assert "run.h5: not the file of a sweep, but that of a run" in capfd.readouterr().err
