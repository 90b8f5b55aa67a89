"""Tables for spreadsheets: one writer for all commands, as CSV and as workbooks."""

import csv
import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest
from commands import command
from internals import Sweep, TableFile
from sweeps import ASKED, BENDING

from lagrange_casadi import read_designs
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

HEADS = ["part", "l [m]", "count"]
ROWS = [["=1+1", 0.1, 3], ["rod;1,2", math.nan, -1e-7], ["ö\x07", math.inf, 1e300]]


def test_decimal_commas_stand_between_semicolons(here):
    assert TableFile(Path("x.csv"), True).write(HEADS, ROWS) == 3
    lines = Path("x.csv").read_text().splitlines()
    assert lines[:3] == ["part;l [m];count", "=1+1;0,1;3", '"rod;1,2";nan;-1e-07']
    assert TableFile(Path("x.csv")).write(HEADS, ROWS) == 3
    assert Path("x.csv").read_text().splitlines()[:2] == ["part,l [m],count", "=1+1,0.1,3"]


def test_a_workbook_holds_numbers_and_texts_and_no_time(here):
    openpyxl = pytest.importorskip("openpyxl")
    for name in ("x.xlsx", "y.XLSX"):
        assert TableFile(Path(name)).write(HEADS, iter(ROWS)) == 3
    assert Path("x.xlsx").read_bytes() == Path("y.XLSX").read_bytes()
    sheet = openpyxl.load_workbook("x.xlsx").active
    found = [[cell.value for cell in row] for row in sheet.iter_rows()]
    assert found[0] == HEADS
    assert found[1] == ["=1+1", 0.1, 3]
    assert sheet["A2"].data_type == "s"
    assert [word or None for word in found[2]] == ["rod;1,2", None, -1e-7]
    assert found[3] == ["ö", "inf", 1e300]
    assert sheet.freeze_panes == "A2"


def test_a_workbook_that_is_too_large_is_told_and_leaves_nothing(here, monkeypatch):
    pytest.importorskip("openpyxl")
    monkeypatch.setattr("lagrange_casadi.base.table_file._ROWS", 3)
    with pytest.raises(DeclarationError, match=r"^x\.xlsx: a workbook has 3 rows at most; write"):
        TableFile(Path("x.xlsx")).write(HEADS, ROWS)
    with pytest.raises(DeclarationError, match=r"20000 columns, but a workbook has 16384 at most"):
        TableFile(Path("x.xlsx")).write(["x"] * 20_000, [])
    assert not list(here.iterdir())


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


@pytest.mark.parametrize("head", ["l [mm],phi [deg]", "l[mm],phi[deg]", "l [m],phi"])
def test_heads_of_designs_may_have_units(here, head):
    cells = "200,30" if "mm" in head else "0.2,30 deg"
    Path("d.csv").write_text(f"{head}\n{cells}\n")
    found = read_designs("d.csv")
    assert found.names == ("l", "phi")
    np.testing.assert_array_equal(found.rows, [[0.2, math.radians(30)]])
    assert found.units == {"l": "m", "phi": "rad"}


def test_a_table_with_commas_is_a_list_of_designs_again(swept, capfd):
    listed = ["table", "s.h5", "--column", "l", "--csv", "d.csv", "--decimal-comma"]
    assert main(listed) == 0
    assert command(f"{ASKED} --designs d.csv --out again.h5") == 0
    np.testing.assert_array_equal(Sweep.open("again.h5")[BENDING], swept[BENDING])
    Path("d.csv").write_text("l [kg]\n1\n")
    assert command(f"{ASKED} --designs d.csv --out x.h5") == 2
    assert "column 'l': expected numbers [m], not numbers [kg]" in capfd.readouterr().err
