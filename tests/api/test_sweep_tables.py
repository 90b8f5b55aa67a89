"""The commands that read a sweep: best, table, info, check and plot."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest
from commands import command
from internals import Sweep
from sweeps import ASKED, BENDING

pytestmark = pytest.mark.quick


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


def test_best_as_csv_names_the_design(file, capfd):
    assert command(f"best s.h5 --minimise {BENDING} --column status --csv best.csv") == 0
    out = capfd.readouterr().out.splitlines()
    assert out[1].split()[-1] == "ok"
    assert out[2] == "wrote best.csv: 1 design"
    with open("best.csv", newline="") as text:
        (row,) = csv.DictReader(text)
    found = Sweep.open("s.h5")
    sizes = np.abs(found[BENDING]).ravel()
    assert int(row["design"]) == np.nanargmin(sizes)
    assert float(row[f"{BENDING} [N m]"]) == found[BENDING].ravel()[np.nanargmin(sizes)]
    assert row["status"] == "0"


@pytest.mark.parametrize("asked", [f"best s.h5 --minimise {BENDING}", "table s.h5"])
def test_an_impossible_csv_is_told_first(file, capfd, asked):
    assert command(f"{asked} --csv nowhere/x.csv") == 2
    assert capfd.readouterr() == (
        "",
        "error: cannot write nowhere/x.csv: folder nowhere does not exist\n",
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


def test_columns_over_ratios_on_the_terminal(file, capfd):
    assert command(f"table s.h5 {columns('status', AT[2])} --where xi==0.5 --rows 2") == 0
    out, err = capfd.readouterr()
    head, *rows, more = out.splitlines()
    assert head.split() == ["design", "l", "[m]", "r", "[m]", "xi", "status", AT[2], "[N", "m]"]
    assert [row.split()[:5] for row in rows] == [
        ["0", "0.06", "0.05", "0.5", "ok"],
        ["1", "0.06", "0.1", "0.5", "out_of_reach"],
    ]
    assert (
        more
        == "... of 8 rows that meet the conditions, 7 with a result; --rows N shows more, --csv"
        " OUT.csv writes all"
    )
    assert err == ""
    limit = float(np.nanmax(np.abs(Sweep.open("s.h5")[AT[2]]))) * 0.999
    assert command(f"table s.h5 --where {AT[2]}>{limit!r}") == 0
    assert len(capfd.readouterr().out.splitlines()) == 2


def test_a_condition_on_an_axis_needs_a_column_over_it(file, capfd):
    for asked in ("table s.h5", f"best s.h5 --minimise {BENDING}"):
        assert command(f"{asked} --where xi==0.5") == 2
        said = f"error: 'xi' is no column but an axis: it needs a column over xi, as {AT[0]} is\n"
        assert capfd.readouterr() == ("", said)


def test_unknown_columns_are_told_at_once(file, capfd):
    assert command(f"table s.h5 {columns('zz', 'l', 'yy')} --where xx<1") == 2
    assert "error: unknown columns 'zz', 'yy', 'xx'; " in capfd.readouterr().err


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


def test_where_a_figure_stays_is_a_number(file, capfd):
    for value in ("nan", "inf"):
        assert command(f"plot s.h5 --at l={value} --out figures") == 2
        assert capfd.readouterr() == (
            "",
            f"error: Invalid value for '--at': l: expected a finite number, got {value}\n",
        )


def test_columns_of_different_axes_need_a_table_each(here, capfd):
    asked = f"{ASKED} --grid l=0.2,0.3 --xi 0:1:3 --keep histories --out h.h5"
    assert command(asked) == 0
    capfd.readouterr()
    assert command(f"table h.h5 {columns(AT[0], 'history:effort:O')} --csv x.csv") == 2
    said = (
        f"column '{AT[0]}' has a value for every xi, 'history:effort:O' for every t: write a"
        " table for each"
    )
    assert capfd.readouterr() == ("", f"error: {said}\n")
    assert command("table h.h5 --column history:section:rod:bending --csv x.csv") == 0
    assert capfd.readouterr().out == "wrote x.csv: 126 rows\n"
    with open("x.csv", newline="") as text:
        assert next(text) == "l [m],t [s],xi,history:section:rod:bending [N m]\n"
        values = np.loadtxt(text, delimiter=",")
    np.testing.assert_array_equal(
        values[:, 3], Sweep.open("h.h5")["history:section:rod:bending"].ravel()
    )
    assert command("table h.h5 --csv x.csv") == 0
    notes = capfd.readouterr().err.splitlines()
    assert [note.partition(":section")[0].partition(": history")[0] for note in notes] == [
        "note: --column NAME shows other columns over xi, a row for every xi: peak_at",
        "note: --column NAME shows other columns over t, a row for every t",
        "note: --column NAME shows other columns over t and xi, a row for every t and xi",
    ]


def test_a_table_of_what_is_kept_of_the_motion(here, capfd):
    asked = "sweep CASE --t 0:0.08:21 --want motion --grid l=0.2,0.3"
    assert command(f"{asked} --out x.h5") == 0
    capfd.readouterr()
    assert command("table x.h5") == 0
    out, err = capfd.readouterr()
    assert out.splitlines()[0].split()[3:5] == ["status", "peak:motion:A_acceleration"]
    assert re.match(
        r"note: --column NAME shows other columns: peak:motion:.* and 19 more \(`lagrange-casadi"
        r" info x.h5` lists",
        err,
    )
    assert command(f"{asked} --keep histories --out y.h5") == 0
    capfd.readouterr()
    assert command("table y.h5") == 0
    assert (
        "note: --column NAME shows other columns over t, a row for every t: history:"
        in capfd.readouterr().err
    )


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
