"""Tables: the dialects that every reader takes, and what is refused by its line; and what commands
write, as CSV and as workbooks.
"""

import csv
import importlib.util
import os
import re
import tempfile
from pathlib import Path

import numpy as np
import pytest
from commands import command
from hypothesis import given
from hypothesis import strategies as st
from sweeps import ASKED, BENDING

from lagrange_casadi import Sweep, read_designs
from lagrange_casadi.actuators import read_motors
from lagrange_casadi.beams import read_profiles
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, PathError

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


READERS = {"designs": read_designs, "motors": read_motors, "profiles": read_profiles}

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
            first = f"p{k}" if kind == "profiles" else draw(sizes)
            rows.append([first, *(draw(sizes) for _ in HEADS[kind][1:])])
    return kind, rows


def read(kind, rows, delimiter=",", mark="."):
    """What a reader makes of a table that is written as a dialect has it."""
    lines = [HEADS[kind], *([cell.replace(".", mark) for cell in row] for row in rows)]
    with tempfile.NamedTemporaryFile("w", suffix=".csv", encoding="utf-8") as file:
        file.write("\n".join(map(delimiter.join, lines)) + "\n")
        file.flush()
        found = READERS[kind](file.name)
    return (found.rows.tolist(), found.lines.tolist()) if kind == "designs" else found


DAMAGES = {
    r"line {}: \d cells, expected \d": lambda row, k, _: [*row, "5"] if k % 2 else row[:-1],
    r"among numbers with decimal (points|commas), as in .*; expected one kind$": (
        lambda row, k, mark: [*row[:k], row[k].replace(mark, ",."[mark == ","]), *row[k + 1 :]]
    ),
    r"line {}.* expected a (finite|positive) number": (
        lambda row, k, _: [*row[:k], row[k].translate(ARABIC), *row[k + 1 :]]
    ),
}
ARABIC = {ord(str(digit)): 0x660 + digit for digit in range(10)}


@given(tables(), st.data())
def test_a_table_is_the_same_in_every_dialect_and_one_wrong_cell_is_named(table, data):
    """``1.234`` among ``2,5`` is 1234, and 1.234 to whoever does not look at the others."""
    kind, rows = table
    delimiter, mark = data.draw(st.sampled_from(DIALECTS))
    assert read(kind, rows, delimiter, mark) == read(kind, rows)
    k = data.draw(st.integers(0, len(rows) - 1))
    with pytest.raises(DeclarationError, match=rf"line {k + 2}: .* decimal commas\? expected po"):
        read(kind, [*rows[:k], [cell.replace(".", ",") for cell in rows[k]], *rows[k + 1 :]])
    says = data.draw(st.sampled_from([*DAMAGES]))
    # A column of decimals, of which no other row is damaged.
    marked = [[cell.replace(".", mark) for cell in row] for row in rows]
    marked[k] = DAMAGES[says](marked[k], data.draw(st.integers(1, 2)), mark)
    with pytest.raises(DeclarationError, match=says.format(k + 2)):
        read(kind, marked, ";" if delimiter == "," else delimiter)


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


LISTS = {
    "": "it has no rows; expected a first line of parameters' names",
    "l,r\n": "no designs below its head l, r",
    "l,r\n0.2\n": "line 2: 1 cells, expected 2, as in the first row",
    "l,r\n0.2,abc\n": "line 2, column 'r': expected a finite number, got 'abc'",
    "l,r\n0.2,\n": "line 2, column 'r': expected a finite number, got ''",
    "l,r\nnan,0.1\n": "line 2, column 'l': expected a finite number, got 'nan'",
    "l,r\n1_0,0.1\n": "line 2, column 'l': expected a finite number, got '1_0'",
    "l,,r\n1,2,3\n": "line 1, column 2: expected a parameter's name, got an empty cell",
    "0.2,0.1\n0.3,0.1\n": "got '0.2': put a line of names above the numbers",
    "l,peak:effort:O\n0.2,nan\n": "line 1, column 2: 'peak:effort:O' is a result of a sweep, not",
    "design,l\n0,0.2\n": "line 1, column 1: 'design' is a result of a sweep, not a parameter",
    'l,r\n0.2,"0.1\n0.3,0.1\n': "line 2: no cells with ',' between them: a quote is opened and",
    'l,r\n0.2,"0.1"3\n': "line 2: no cells with ',' between them: ',' expected after",
    "l,r,l\n1,2,3\n": "line 1, column 3: 'l' is already column 1",
    "l,note,r\n0.2,hello,0.1\n": "line 1, column 2: unknown parameter 'note'; valid: l, r",
}
PROFILES = {
    "": "it has no rows; expected a head and a line for every profile",
    "name,d\n": "line 1: expected a line for every profile below this head",
    "d,e\n1,2\n": "expected a column 'name' and one for each dimension, got d, e",
    "name,d [ft]\nx,1\n": "column 'd' is in 'ft'; expected a length [m]",
    "name,d\nx,1\nx,2\n": "line 3: profile 'x' is listed twice",
    "name,d\n ,1\n": "line 2: it has no name",
    "name,d\nx,-1\n": "line 2: d: expected a positive number, got '-1'",
}
WRONG = [(lambda path: read_designs(path, ["l", "r"]), *row) for row in LISTS.items()]
WRONG += [(read_profiles, *row) for row in PROFILES.items()]


@pytest.mark.parametrize(("read", "text", "says"), WRONG)
def test_what_is_wrong_in_a_table_is_named(here, read, text, says):
    Path("d.csv").write_text(text)
    with pytest.raises(DeclarationError, match=rf"^d\.csv.*{re.escape(says)}"):
        read("d.csv")


def test_a_parameter_may_be_called_as_a_result_is(here):
    Path("d.csv").write_text("design,l\n0,0.2\n")
    assert read_designs("d.csv", ["l", "design"]).names == ("design", "l")


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
    return Sweep.open("s.h5")


LEAST = f"best s.h5 --minimise {BENDING}"
NONE = "s.h5: no design has a result and meets the conditions: of 8 designs, {} meet them, 0 of"
SAID = [
    (f"{LEAST} --where l>1", 1, NONE.format(0)),
    (f"{LEAST} --where l<0.1 --where r>0.07", 1, NONE.format(1)),
    (f"{LEAST} --where l==0.1", 1, "no design has l = 0.1; nearest: 0.06, 0.16"),
    ("table s.h5 --column q", 2, "unknown column 'q'; `lagrange-casadi info s.h5` lists the 19 t"),
    *(
        (f"table s.h5 {words}{more}", 1, f"error: s.h5: {says}\n")
        for more in ("", " --csv x.csv")
        for words, says in (
            (
                "--column peak_at:section:rod:bending --where xi==0.505",
                "no row meets the conditions; no design has xi = 0.505; nearest: 0.5, 1",
            ),
            (
                "--where l=0.3",
                "no design meets the conditions; no design has l = 0.3; nearest: 0.26, 0.36",
            ),
            ("--where l>1", "no design meets the conditions"),
        )
    ),
]


def test_best_and_tables_of_a_sweep(file, capfd):
    found, (l, r) = file, np.meshgrid(file["l"], file["r"], indexing="ij")
    assert command(f"{LEAST} --where l>0.2 --count 2 --column rms:effort:O") == 0
    head, *rows = capfd.readouterr().out.splitlines()
    assert " ".join(head.split()) == f"design l [m] r [m] {BENDING} [N m] rms:effort:O [N m]"
    shown = [float(row.split()[3]) for row in rows]
    least = np.sort(np.abs(found[BENDING])[found["l"] > 0.2].ravel())[:2]
    np.testing.assert_allclose(np.abs(shown), least, rtol=1e-5)
    assert command(f"{LEAST} --minimise peak:effort:O --csv front.csv") == 0
    assert capfd.readouterr().out.endswith("wrote front.csv: 4 designs\n")
    assert command("table s.h5 --rows 3") == 0
    out = capfd.readouterr().out.splitlines()
    assert [line.split()[3] for line in out[1:3]] == ["ok", "out_of_reach"]
    assert out[4].startswith(
        "... of 8 designs, 7 with a result; --rows N shows more, --csv OUT.csv"
    )
    assert command("table s.h5 --column rms:effort:O --where status!=0") == 0
    assert capfd.readouterr().out.splitlines()[1].split() == ["1", "0.06", "0.1", "nan"]
    assert command("table s.h5 --rows 8") == 0
    assert "note: --column NAME shows other columns over xi, a row" in capfd.readouterr().err
    names = [f"peak_at:section:rod:{force}" for force in ("axial", "shear", "bending")]
    line = " ".join(f"--column {name}" for name in ("peak:effort:O", *names))
    assert command(f"table s.h5 {line} --csv long.csv") == 0
    with open("long.csv", newline="") as text:
        head, *rows = csv.reader(text)
    assert head[:4] == ["l [m]", "r [m]", "xi", "peak:effort:O [N m]"]
    assert head[4:] == [f"{name} [{found.unit(name)}]" for name in names]
    xi, effort = [0.0, 0.5, 1.0], found["peak:effort:O"]
    expected = [l[..., None], r[..., None], xi, effort[..., None], *(found[name] for name in names)]
    for column, values in zip(np.array(rows, float).T, expected, strict=True):
        np.testing.assert_array_equal(column.reshape(4, 2, 3), np.broadcast_to(values, (4, 2, 3)))
    for words, status, says in SAID:
        capfd.readouterr()
        assert command(words) == status
        out, err = capfd.readouterr()
        assert (out, says in err) == ("", True), err
    assert not Path("x.csv").exists()


def test_csv_is_a_list_of_designs_again(file, capfd):
    assert command("table s.h5 --csv list.csv --column l --where status==0") == 0
    assert command(f"{ASKED} --designs list.csv --set m3=0.2 --out again.h5") == 0
    there = file["status"] == 0
    np.testing.assert_array_equal(Sweep.open("again.h5")[BENDING], file[BENDING][there])
