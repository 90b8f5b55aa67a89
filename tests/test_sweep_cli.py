"""Sweeps from the command line: what they write and say, and the one line and status of every mistake."""

import csv
import os
import re
import signal
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import sweeps

from lagrange_casadi.cli import main, progress
from lagrange_casadi.errors import StoreError
from lagrange_casadi.sweep import Sweep, cluster
from lagrange_casadi.sweep import columns as kept
from lagrange_casadi.sweep.parts import Folder

CASE = Path(__file__).parent.parent / "cases" / "slider_crank"
ASKED = ["sweep", str(CASE), "--t", "0:0.08:21", "--want", "effort", "--want", "section:rod"]
BENDING = "peak:section:rod:bending"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def file(here, capfd):
    """A small sweep's file."""
    assert (
        main([*ASKED, "--grid", "l=0.06:0.36:4", "--grid", "r=0.05,0.1", "--set", "m3=0.2", "--xi", "0:1:3", "--out", "s.h5"]) == 0
    )
    capfd.readouterr()
    return Path("s.h5")


def test_sweep_writes_one_file_and_says_what_is_in_it(here, capfd):
    assert main([*ASKED, "--grid", "l=0.06:0.36:4", "--grid", "r=0.05,0.1"]) == 0
    out, err = capfd.readouterr()
    assert out.startswith("slider_crank: 4 x 2 = 8 designs over l, r\n  1 without a result: ")
    assert out.endswith("wrote slider_crank_sweep.h5\n")
    assert err == ""
    assert os.listdir(here) == ["slider_crank_sweep.h5"]


def test_sweep_takes_options(here, capfd):
    options = ["--grid", "m3=0.1:10:3:log", "--set", "l=0.3", "--xi", "0:1:3", "--keep", "histories", "--backend", "vm"]
    assert main([*ASKED, *options, "--workers", "1", "--quiet", "--out", "x.h5"]) == 0
    found = Sweep.open("x.h5")
    np.testing.assert_allclose(found["m3"], [0.1, 1.0, 10.0], rtol=1e-15)
    assert found["history:section:rod:bending"].shape == (3, 21, 3)
    assert found.identity["backend"] == "vm"
    assert found.identity["mechanism"]["parameters"]["l"]["value"] == 0.3
    capfd.readouterr()
    assert main([*ASKED, *options, "--workers", "1", "--resume", "--out", "x.h5"]) == 0
    assert capfd.readouterr().out.splitlines()[1:] == ["x.h5 was complete already: nothing was done"]


def test_sweep_of_a_list(here):
    Path("d.csv").write_text("r,l\n0.05,0.2\n0.1,0.3\n0.1,0.05\n")
    assert main([*ASKED, "--designs", "d.csv", "--out", "x.h5"]) == 0
    found = Sweep.open("x.h5")
    np.testing.assert_array_equal(found["l"], [0.2, 0.3, 0.05])
    assert (found["status"] != 0).tolist() == [False, False, True]


MISTAKES = [
    (["--grid", "q=0.1:0.2:3"], 2, "unknown parameter 'q'; valid: r, l, m1, m2, m3"),
    (["--grid", "l=0.4:0.1:3"], 2, "l: STOP must be after START, got 0.4:0.1:3: the range is reversed"),
    (["--grid", "l=0.1:0.4:0"], 2, "l: COUNT must be at least 1, got 0.1:0.4:0: the range is empty"),
    (["--grid", "l=nan:0.4:3"], 2, "l: START and STOP must be finite, got nan:0.4:3"),
    (["--grid", "l=0.1,nan"], 2, "l: values must be finite, got nan"),
    (["--grid", "l=0:0.4:3:log"], 2, "l: a log range must begin above 0, got 0.0:0.4:3:log"),
    (["--grid", "l=0.1:0.4:3:lin"], 2, "l: expected log or nothing after COUNT, got 'lin' in 0.1:0.4:3:lin"),
    (["--grid", "l=0.1:0.4:2.5"], 2, "l: expected a whole number for COUNT, got '2.5' in 0.1:0.4:2.5"),
    (["--grid", "l=0.1:x:5"], 2, "l: expected a number for STOP, got 'x' in 0.1:x:5"),
    (["--grid", "l=0.1,abc"], 2, "l: expected a number for each value, got 'abc' in 0.1,abc"),
    (["--grid", "l=0.1,,0.2"], 2, "l: expected a number for each value, got nothing in 0.1,,0.2"),
    (["--grid", "l=1_0"], 2, "l: expected a number for each value, got '1_0' in 1_0"),
    (["--grid", "l=0.1:0.4:1_0"], 2, "l: expected a whole number for COUNT, got '1_0'"),
    (["--grid", "l=0.1", "--set", "r=1_0"], 2, "expected NAME=VALUE with a number, as in l=0.25, got 'r=1_0'"),
    (["--grid", "l=0.1", "--t", "0:1_0:5"], 2, "expected START:STOP:COUNT, as in 0:0.08:801, got '0:1_0:5'"),
    (["--grid", "l=0.1:0.4"], 2, "expected NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,..."),
    (
        ["--grid", "ll=0.1:0.4:5", "--grid", "R=1:2:3"],
        2,
        "unknown parameters 'll' (did you mean 'l'?), 'R'; valid: r, l, m1, m2, m3",
    ),
    (["--set", "x=3", "--grid", "q=1,2"], 2, "unknown parameters 'q', 'x'; valid: r, l, m1, m2, m3"),
    (
        ["--grid", "l=-1:0.4:5", "--set", "r=-2", "--set", "m1=nan"],
        2,
        "-1 to 0.4, out of its range [0, inf]; parameter 'r' = -2 m is out of its range [0, inf]; parameter 'm1' must be a finite",
    ),
    (["--grid", "l=0.1,0.2", "--set", "r=-2", "--set", "m3=-1"], 2, "is out of its range [0, inf]; parameter 'm3' = -1 kg is out"),
    (["--grid", "0.1:0.4:3"], 2, "as in l=0.1:0.4:31, got '0.1:0.4:3'"),
    (["--grid", "l="], 2, "got 'l='"),
    (["--grid", "l=0.1", "--grid", "l=0.2"], 2, "--grid: parameter 'l' is swept twice"),
    (["--grid", "l=0.1", "--set", "l=0.2"], 2, "parameter 'l' is swept and set to 0.2 as well"),
    (
        ["--grid", "l=0.1:0.4:40000", "--grid", "r=0.1:0.4:40000"],
        2,
        "the grid has 1 600 000 000 designs, more than 10^9; if that is meant, say --yes",
    ),
    (["--grid", "l=-0.1:0.4:6", "--grid", "m1=-1,1,-2"], 2, "l = -0.1 to 0.4, out of its range [0, inf]; m1 = -1, -2, out of its"),
    ([], 2, "expected either --grid, as in --grid l=0.1:0.4:31, or --designs FILE.csv"),
    (["--grid", "l=0.1", "--designs", "bad.csv"], 2, "expected either --grid"),
    (["--designs", "none.csv"], 2, "none.csv: no such file"),
    (["--designs", "bad.csv"], 2, "bad.csv, line 3, column 'r': expected a finite number, got 'x'"),
    (["--designs", "short.csv"], 2, "short.csv, line 2: 1 cells, expected 2, column 'r' is missing"),
    (["--designs", "note.csv"], 2, "note.csv, line 1, columns 2, 4: unknown parameters 'note', 'q'; valid: r, l, m1, m2, m3"),
    (["--designs", "numbered.csv"], 2, "numbered.csv, line 1, column 1: 'design' is a result of a sweep, not a parameter: take"),
    (["--designs", "low.csv"], 2, "error: low.csv: l = -0.2 in line 2, -0.3 in line 4, out of its range [0, inf]"),
    (["--grid", "l=0.2", "--xi", "0:2:3"], 2, "ratios xi/l must lie in [0, 1]"),
    (["--grid", "l=0.2", "--t", "1:0:3"], 2, "t: STOP must be after START"),
    (["--grid", "l=0.2", "--t", "0:0.08:1"], 2, "t: COUNT must be 2 or more to reach from 0 to 0.08, got 1"),
    (["--grid", "l=0.2", "--want", "torque"], 2, "unknown output 'torque'"),
    (["--grid", "l=0.2", "--keep", "all"], 2, "'all' is not one of 'peaks', 'laws', 'histories'"),
    (["--grid", "l=0.2", "--table", "128"], 2, "No such option"),
    (["--grid", "l=0.2", "--workers", "0"], 2, "0 is not in the range x>=1"),
    (["--grid", "l=0.2", "--out", "x.txt"], 2, "expected a name that ends in .h5"),
    (["--grid", "l=0.2", "--out", "nowhere/x.h5"], 2, "folder nowhere does not exist"),
    (["--grid", "l=0.2", "--out", "mine.h5"], 2, "mine.h5 exists: --force replaces it, --resume goes on"),
    (["--grid", "l=0.2", "--out", "mine.h5", "--resume"], 1, "mine.h5: not a whole HDF5 file"),
    (["--grid", "l=0.2", "--resume", "--force"], 2, "resume and force exclude each other"),
    (["--grid", "l=0.2", "--dask", "tcp://127.0.0.1:1", "--workers", "2"], 2, "workers and dask exclude each other"),
]


@pytest.mark.parametrize(("arguments", "status", "says"), MISTAKES)
def test_a_mistake_is_one_line_and_leaves_nothing(here, capfd, monkeypatch, arguments, status, says):
    monkeypatch.setattr(cluster, "_PATIENCE", 0.5)
    files = {
        "bad.csv": "l,r\n0.2,0.1\n0.3,x\n",
        "short.csv": "l,r\n0.2\n",
        "note.csv": "l,note,r,q\n0.2,hello,0.1,1\n",
        "numbered.csv": "design,l\n0,0.2\n",
        "low.csv": "l\n-0.2\n0.1\n-0.3\n",
        "mine.h5": "mine",
    }
    for name, text in files.items():
        (here / name).write_text(text)
    assert main([*ASKED, *arguments]) == status
    out, err = capfd.readouterr()
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert says in err
    assert out == ""
    assert {path.name: path.read_text() for path in here.iterdir()} == files


def test_best(file, capfd):
    assert main(["best", "s.h5", "--minimise", BENDING, "--where", "l>0.2", "--count", "2", "--column", "rms:effort:O"]) == 0
    head, *rows = capfd.readouterr().out.splitlines()
    assert head.split() == ["design", "l", "[m]", "r", "[m]", BENDING, "[N", "m]", "rms:effort:O", "[N", "m]"]
    found = Sweep.open("s.h5")
    sizes = np.abs(found[BENDING])[found["l"] > 0.2]
    shown = [float(row.split()[3]) for row in rows]
    np.testing.assert_allclose(np.abs(shown), np.sort(sizes.ravel())[:2], rtol=1e-5)
    assert main(["best", "s.h5", "--minimise", BENDING, "--minimise", "peak:effort:O", "--csv", "front.csv"]) == 0
    assert capfd.readouterr().out.endswith("wrote front.csv: 4 designs\n")
    assert Path("front.csv").read_text().startswith(f"design,l,r,{BENDING},peak:effort:O\n")
    assert main(["best", "s.h5", "--minimise", BENDING, "--where", "l>1"]) == 1
    said = "error: s.h5: no design has a result and meets the conditions: of 8 designs, {}, {} of these with a result\n"
    assert capfd.readouterr().err == said.format("0 meet them", 0)
    assert main(["best", "s.h5", "--minimise", BENDING, "--where", "l<0.1", "--where", "r>0.07"]) == 1
    assert capfd.readouterr().err == said.format("1 meet them", 0)
    assert main(["best", "s.h5", "--minimise", BENDING, "--where", "l==0.1"]) == 1
    assert capfd.readouterr().err == said.format("0 meet them", 0).rstrip() + "; no design has l = 0.1; nearest: 0.06, 0.16\n"


def test_best_as_csv_names_the_design(file, capfd):
    assert main(["best", "s.h5", "--minimise", BENDING, "--column", "status", "--csv", "best.csv"]) == 0
    out = capfd.readouterr().out.splitlines()
    assert out[1].split()[-1] == "ok"
    assert out[2] == "wrote best.csv: 1 design"
    with open("best.csv", newline="") as text:
        (row,) = csv.DictReader(text)
    found = Sweep.open("s.h5")
    sizes = np.abs(found[BENDING]).ravel()
    assert int(row["design"]) == np.nanargmin(sizes)
    assert float(row[BENDING]) == found[BENDING].ravel()[np.nanargmin(sizes)]
    assert row["status"] == "0"


@pytest.mark.parametrize("command", [["best", "--minimise", BENDING], ["table"]])
def test_an_impossible_csv_is_told_first(file, capfd, command):
    assert main([command[0], "s.h5", *command[1:], "--csv", "nowhere/x.csv"]) == 2
    assert capfd.readouterr() == ("", "error: cannot write nowhere/x.csv: folder nowhere does not exist\n")


def test_table(file, capfd):
    assert main(["table", "s.h5", "--rows", "3"]) == 0
    out = capfd.readouterr().out.splitlines()
    assert out[0].split()[:6] == ["design", "l", "[m]", "r", "[m]", "status"]
    assert out[1].split()[3] == "ok"
    assert out[2].split()[3] == "out_of_reach"
    assert out[4] == "... of 8 designs, 7 with a result; --rows N shows more, --csv OUT.csv writes all"
    assert main(["table", "s.h5", "--column", "rms:effort:O", "--where", "status!=0"]) == 0
    assert capfd.readouterr().out.splitlines()[1].split() == ["1", "0.06", "0.1", "nan"]
    assert main(["table", "s.h5", "--where", "l<0.2", "--rows", "1"]) == 0
    assert capfd.readouterr().out.splitlines()[2].startswith("... of 4 designs that meet the conditions, 3 with a result; ")
    assert main(["table", "s.h5", "--rows", "8"]) == 0
    out, err = capfd.readouterr()
    assert len(out.splitlines()) == 9
    assert "note: --column NAME shows other columns over xi, a row for every xi: peak_at:section:rod:axial, peak" in err
    assert main(["table", "s.h5", "--column", "q"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err == "error: unknown column 'q'; `lagrange-casadi info s.h5` lists the 19 there are\n"


AT = [f"peak_at:section:rod:{force}" for force in ("axial", "shear", "bending")]


def columns(*names):
    return [word for name in names for word in ("--column", name)]


def test_columns_over_ratios_are_a_row_for_each(file, capfd):
    """The paper's batch as a table: one line for every design and ratio."""
    assert main(["table", "s.h5", *columns("peak:effort:O", *AT), "--csv", "long.csv"]) == 0
    assert capfd.readouterr() == ("wrote long.csv: 24 rows\n", "")
    with open("long.csv", newline="") as text:
        head, *rows = csv.reader(text)
    assert head == ["l", "r", "xi", "peak:effort:O", *AT]
    found = Sweep.open("s.h5")
    values = np.array(rows, float).T.reshape(7, 4, 2, 3)
    for k, name in enumerate(AT):
        np.testing.assert_array_equal(values[4 + k], found[name])
    np.testing.assert_array_equal(values[0], np.broadcast_to(found["l"][:, None, None], (4, 2, 3)))
    np.testing.assert_array_equal(values[1], np.broadcast_to(found["r"][:, None], (4, 2, 3)))
    np.testing.assert_array_equal(values[2], np.broadcast_to([0.0, 0.5, 1.0], (4, 2, 3)))
    np.testing.assert_array_equal(values[3], np.broadcast_to(found["peak:effort:O"][..., None], (4, 2, 3)))


def test_columns_over_ratios_on_the_terminal(file, capfd):
    assert main(["table", "s.h5", *columns("status", AT[2]), "--where", "xi==0.5", "--rows", "2"]) == 0
    out, err = capfd.readouterr()
    head, *rows, more = out.splitlines()
    assert head.split() == ["design", "l", "[m]", "r", "[m]", "xi", "status", AT[2], "[N", "m]"]
    assert [row.split()[:5] for row in rows] == [["0", "0.06", "0.05", "0.5", "ok"], ["1", "0.06", "0.1", "0.5", "out_of_reach"]]
    assert more == "... of 8 rows that meet the conditions, 7 with a result; --rows N shows more, --csv OUT.csv writes all"
    assert err == ""
    limit = float(np.nanmax(np.abs(Sweep.open("s.h5")[AT[2]]))) * 0.999
    assert main(["table", "s.h5", "--where", f"{AT[2]}>{limit!r}"]) == 0
    assert len(capfd.readouterr().out.splitlines()) == 2


def test_a_condition_on_an_axis_needs_a_column_over_it(file, capfd):
    for command in (["table"], ["best", "--minimise", BENDING]):
        assert main([command[0], "s.h5", *command[1:], "--where", "xi==0.5"]) == 2
        said = f"error: 'xi' is no column but an axis: it needs a column over xi, as {AT[0]} is\n"
        assert capfd.readouterr() == ("", said)


def test_unknown_columns_are_told_at_once(file, capfd):
    assert main(["table", "s.h5", *columns("zz", "l", "yy"), "--where", "xx<1"]) == 2
    assert "error: unknown columns 'zz', 'yy', 'xx'; " in capfd.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([*columns(AT[2]), "--where", "xi==0.505"], "no row meets the conditions; no design has xi = 0.505; nearest: 0.5, 1"),
        (["--where", "l=0.3"], "no design meets the conditions; no design has l = 0.3; nearest: 0.26, 0.36"),
        (["--where", "l>1"], "no design meets the conditions"),
    ],
)
def test_a_table_of_nothing_is_refused(file, capfd, arguments, says):
    for more in ([], ["--csv", "x.csv"]):
        assert main(["table", "s.h5", *arguments, *more]) == 1
        assert capfd.readouterr() == ("", f"error: s.h5: {says}\n")
    assert not Path("x.csv").exists()


def test_a_damaged_column_is_named(file, capfd):
    with h5py.File("s.h5") as h:
        place = h["peak/section/rod/bending"].id.get_chunk_info(0).byte_offset + 20
    data = bytearray(file.read_bytes())
    data[place] ^= 1
    file.write_bytes(data)
    for command in (["best", "--minimise", BENDING], ["table", "--csv", "x.csv"], ["plot", "--over", "l", "--out", "figures"]):
        assert main([command[0], "s.h5", *command[1:]]) == 1
        assert capfd.readouterr().err.startswith(f"error: s.h5: {BENDING}: damaged: ")


def test_where_a_figure_stays_is_a_number(file, capfd):
    for value in ("nan", "inf"):
        assert main(["plot", "s.h5", "--at", f"l={value}", "--out", "figures"]) == 2
        assert capfd.readouterr() == ("", f"error: Invalid value for '--at': l: expected a finite number, got {value}\n")


def test_columns_of_different_axes_need_a_table_each(here, capfd):
    assert main([*ASKED, "--grid", "l=0.2,0.3", "--xi", "0:1:3", "--keep", "histories", "--out", "h.h5"]) == 0
    capfd.readouterr()
    assert main(["table", "h.h5", *columns(AT[0], "history:effort:O"), "--csv", "x.csv"]) == 2
    said = f"column '{AT[0]}' has a value for every xi, 'history:effort:O' for every t: each needs a table of its own"
    assert capfd.readouterr() == ("", f"error: {said}\n")
    assert main(["table", "h.h5", *columns("history:section:rod:bending"), "--csv", "x.csv"]) == 0
    assert capfd.readouterr().out == "wrote x.csv: 126 rows\n"
    with open("x.csv", newline="") as text:
        assert next(text) == "l,t,xi,history:section:rod:bending\n"
        values = np.loadtxt(text, delimiter=",")
    np.testing.assert_array_equal(values[:, 3], Sweep.open("h.h5")["history:section:rod:bending"].ravel())
    assert main(["table", "h.h5", "--csv", "x.csv"]) == 0
    notes = capfd.readouterr().err.splitlines()
    assert [note.partition(":section")[0].partition(": history")[0] for note in notes] == [
        "note: --column NAME shows other columns over xi, a row for every xi: peak_at",
        "note: --column NAME shows other columns over t, a row for every t",
        "note: --column NAME shows other columns over t and xi, a row for every t and xi",
    ]


def test_a_table_of_what_is_kept_of_the_motion(here, capfd):
    asked = ["sweep", str(CASE), "--t", "0:0.08:21", "--want", "motion", "--grid", "l=0.2,0.3"]
    assert main([*asked, "--out", "x.h5"]) == 0
    capfd.readouterr()
    assert main(["table", "x.h5"]) == 0
    out, err = capfd.readouterr()
    assert out.splitlines()[0].split()[3:5] == ["status", "peak:motion:A_acceleration"]
    assert re.match(r"note: --column NAME shows other columns: peak:motion:.* and 19 more \(`lagrange-casadi info x.h5` lists", err)
    assert main([*asked, "--keep", "histories", "--out", "y.h5"]) == 0
    capfd.readouterr()
    assert main(["table", "y.h5"]) == 0
    assert "note: --column NAME shows other columns over t, a row for every t: history:" in capfd.readouterr().err


def test_csv_has_every_digit_and_is_a_list_of_designs_again(file, capfd):
    assert main(["table", "s.h5", "--csv", "all.csv"]) == 0
    assert capfd.readouterr().out == "wrote all.csv: 8 designs\n"
    with open("all.csv", newline="") as text:
        rows = list(csv.DictReader(text))
    found = Sweep.open("s.h5")
    for name in ("status", BENDING, "peak_xi:section:rod:shear", "mean:effort:O"):
        np.testing.assert_array_equal([float(row[name]) for row in rows], found[name].ravel())
    assert main(["table", "s.h5", "--csv", "list.csv", "--column", "l", "--where", "status==0"]) == 0
    assert Path("list.csv").read_text().startswith("l,r\n0.06,0.05\n")
    assert main([*ASKED, "--designs", "list.csv", "--set", "m3=0.2", "--out", "again.h5"]) == 0
    there = found["status"] == 0
    np.testing.assert_array_equal(Sweep.open("again.h5")[BENDING], found[BENDING][there])


def test_info_check_and_plot_know_sweeps(file, capfd):
    assert main(["info", "s.h5"]) == 0
    out = capfd.readouterr().out
    assert "swept l: 0.06:0.36:4" in out
    assert [line for line in out.splitlines() if re.match(r"\d+ design", line)] == [
        "7 designs: there is a result",
        "1 design: a loop cannot be closed: its links do not reach",
    ]
    assert re.search(r"peak:section:rod:bending +N m +largest in size over time: bending moment", out)
    assert main(["check", "s.h5"]) == 0
    assert capfd.readouterr().out == "s.h5: whole and consistent\n"
    assert main(["plot", "s.h5", "--out", "figures", "--over", "l", "--at", "r=0.05"]) == 0
    assert {path.stem for path in Path("figures").iterdir()} >= {"peak_effort", "peak_section_rod", "along_rod"}
    assert main(["run", str(CASE), "--t", "0:0.08:5", "--no-figures", "--out", "run.h5"]) == 0
    capfd.readouterr()
    assert main(["plot", "run.h5", "--out", "figures", "--over", "l"]) == 2
    assert "--over, --at and --against go with a sweep's file" in capfd.readouterr().err
    for command in ("best", "table"):
        assert main([command, "run.h5", *(["--minimise", "l"] if command == "best" else [])]) == 1
        assert "run.h5: not the file of a sweep, but that of a run" in capfd.readouterr().err


def test_info_and_check_tell_how_far_an_unfinished_sweep_is(here, capfd, monkeypatch):
    def fail(*_):
        raise StoreError("no more")

    with monkeypatch.context() as patch:
        patch.setattr(Folder, "publish", fail)
        patch.setattr(kept, "_MOST", 20)
        assert main([*ASKED, "--grid", "l=0.2:0.4:70", "--workers", "1", "--quiet", "--out", "x.h5"]) == 1
    folder = here / "x.h5.parts"
    first, *_ = sorted(folder.glob("*.part"))
    for path in sorted(folder.glob("*.part"))[1:]:
        path.unlink()
    done = int(first.stem.partition("-")[2])
    (folder / "x.part.draft").write_text("being written")
    (folder / "000000000900-000000000901.part").write_text("damaged")
    (folder / "000000000000-000000000001.part").write_bytes(first.read_bytes())
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    capfd.readouterr()
    told = f"unfinished: {done} of 70 designs done; the same sweep goes on when it is resumed"
    with Folder(here / "x.h5").locked():
        for target in ("x.h5.parts", "x.h5"):
            assert main(["info", target]) == 0
            out = capfd.readouterr().out
            assert "swept l: 0.2:0.4:70" in out
            assert out.splitlines()[-1] == told
            assert main(["check", target]) == 1
            out, err = capfd.readouterr()
            flaw = "damaged in its head or length, or an earlier one holds the same designs: it will be done again"
            flawed = [f"{target}: {name}: {flaw}" for name in (first.name, "000000000900-000000000901.part")]
            assert (out, err.splitlines()) == ("", [f"{target}: {told}", *flawed])
        assert main(["table", "x.h5"]) == 2
        told = "x.h5: its sweep is not finished: `lagrange-casadi info` tells how far it is"
        assert capfd.readouterr() == ("", f"error: {told}\n")
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    (folder / "plan.json").write_text('{"grid": 3}')
    assert main(["check", "x.h5.parts"]) == 1
    assert "x.h5.parts: damaged: " in capfd.readouterr().err


def program(*arguments):
    return sweeps.process(sys.executable, "-m", "lagrange_casadi", *arguments)


LONG = ["--grid", "l=0.11:0.4:4000", "--grid", "r=0.05:0.1:25"]
SHORT = ["--grid", "l=0.11:0.4:25", "--grid", "r=0.05:0.1:6"]


def test_killed_and_resumed_from_the_command_line(here):
    """The real engine, in processes of its own."""
    with program(*ASKED, *SHORT, "--out", "whole.h5") as whole:
        assert whole.communicate(timeout=120)[1] == ""
    with program(*ASKED, *SHORT, "--out", "x.h5") as killed:
        sweeps.wait_for(lambda: killed.poll() is not None or list(here.glob("x.h5.parts/*.part")))
        killed.send_signal(signal.SIGKILL)
        killed.wait()
    with program(*ASKED, *SHORT, "--out", "x.h5", "--resume") as resumed:
        out, err = resumed.communicate(timeout=120)
        assert resumed.returncode == 0
    assert out.endswith("wrote x.h5\n")
    assert err == "" or err.startswith("going on after ")
    assert Path("x.h5").read_bytes() == Path("whole.h5").read_bytes()
    assert sorted(os.listdir(here)) == ["whole.h5", "x.h5"]


def test_ctrl_c_is_one_line_that_says_how_to_go_on(here):
    with program(*ASKED, *LONG, "--out", "x.h5") as stopped:
        sweeps.wait_for(lambda: list(here.glob("x.h5.parts/*.part")))
        stopped.send_signal(signal.SIGINT)
        out, err = stopped.communicate(timeout=60)
        assert stopped.returncode == 130
    assert out == ""
    told = r"error: stopped; [\d ]+ of 100 000 designs are kept in x\.h5\.parts: go on with --resume\n"
    assert re.fullmatch(told, err)
    assert os.listdir(here) == ["x.h5.parts"]


def test_ctrl_c_before_anything_is_done_leaves_nothing(here):
    case = here / "slow.py"
    case.write_text(f"from lagrange_casadi import load_case\nprint('ready', flush=True)\nscene = load_case({str(CASE)!r}).scene\n")
    case.write_text(case.read_text().replace("scene = ", "import time; time.sleep(30)\nscene = "))
    with program("sweep", str(case), "--grid", "l=0.2", "--out", "x.h5") as stopped:
        assert stopped.stdout.readline() == "ready\n"
        stopped.send_signal(signal.SIGINT)
        assert stopped.communicate(timeout=60)[1] == "error: interrupted; nothing was left half-written\n"
        assert stopped.returncode == 130
    assert [name for name in os.listdir(here) if name != "__pycache__"] == ["slow.py"]


def test_lines_tell_of_progress_now_and_then(capsys, monkeypatch):
    clock = iter([100.0, 101.0, 115.0, 116.0, 130.0])
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    lines = progress.Lines()
    for done in (1000, 1100, 2500, 2600, 4000):
        lines("designs", done, 10_000)
    lines.close()
    assert capsys.readouterr().err.splitlines() == [
        "going on after 1 000 of 10 000 designs",
        "2 500 of 10 000 designs, 25 %, 100 a second, 01:15 left",
        "4 000 of 10 000 designs, 40 %, 100 a second, 01:00 left",
    ]


def test_a_bar_is_shown_on_a_terminal_only(capsys, monkeypatch):
    assert type(progress.shown(quiet=True)) is progress.Silent
    assert isinstance(progress.shown(quiet=False), progress.Lines)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    bar = progress.shown(quiet=False)
    for what, done, total in (("designs", 100, 1000), ("designs", 1000, 1000), ("file", 0.5, 1.0)):
        bar(what, done, total)
    bar.close()
    err = capsys.readouterr().err
    assert "designs:" in err
    assert "/1.00k" in err


def test_one_design_is_no_more_than_one(here, capfd):
    assert main([*ASKED, "--grid", "l=0.2", "--out", "x.h5"]) == 0
    assert capfd.readouterr().out == "slider_crank: 1 design over l\nwrote x.h5\n"


def test_the_examples_of_the_help_run(here, capfd):
    Path("cases").symlink_to(CASE.parent)
    assert main(["sweep", "--help"]) == 0
    examples = re.findall(r"^ *lagrange-casadi (.*)$", capfd.readouterr().out, re.MULTILINE)
    assert [example.split()[0] for example in examples] == ["sweep", "best"]
    for example in examples:
        assert main(example.split()) == 0


def test_of_all_the_motion_is_left_out_and_alone_it_is_kept(here, capfd):
    """As the help says."""
    for wanted in ("all", "motion"):
        assert main(["sweep", str(CASE), "--t", "0:0.08:9", "--grid", "l=0.2", "--want", wanted, "--out", f"{wanted}.h5"]) == 0
        moving = {name.split(":")[1] for name in Sweep.open(f"{wanted}.h5").columns if name != "status"} & {"motion", "pose"}
        assert moving == (set() if wanted == "all" else {"motion", "pose"})
