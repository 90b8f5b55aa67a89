"""Every reader of tables: the dialects that it takes, and what is refused by its line, whatever the
table is of.
"""

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st
from internals import ListingListed as Listed
from internals import RecordedTable, read_designs, read_profile

from lagrange_casadi.actuators import read_motors
from lagrange_casadi.beams import read_profiles
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, PathError
from lagrange_casadi.motion import read_samples

pytestmark = pytest.mark.quick

HEADS = {
    "samples": ["t", "q", "p"],
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
    "cam": ["x [mm]", "y"],
}


def samples(path):
    return RecordedTable.read(Path(path), "times and values").columns(0, [1])


def designs(path):
    found = read_designs(path)
    return found.rows, found.lines


READERS = {
    "samples": samples,
    "designs": designs,
    "motors": read_motors,
    "profiles": read_profiles,
    "cam": lambda path: (read_profile(path),),
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


@pytest.mark.parametrize(
    "arguments",
    [
        ["drive", "slider_crank", "--motors", "pipe.csv"],
        ["size", "slider_crank", "--profiles", "pipe.csv"],
        ["sweep", "slider_crank", "--designs", "pipe.csv", "--out", "x.h5"],
    ],
)
def test_no_command_waits_for_a_pipe(here, capfd, arguments):
    os.mkfifo("pipe.csv")
    assert main(arguments) == 2
    assert capfd.readouterr() == ("", "error: pipe.csv: is a device or a pipe, not a file\n")


def test_angles_have_decimal_commas_too(here):
    (here / "d.csv").write_text("phi;l\n22,5 deg;0,2\n-,5rad;0,3\n")
    found = read_designs("d.csv")
    assert isinstance(found, Listed)
    assert found.rows.tolist() == [[22.5 / 180 * np.pi, 0.2], [-0.5, 0.3]]
    assert found.units == {"phi": "rad"}


def test_lines_without_any_cell_are_passed_over(here):
    """Spreadsheets leave them."""
    (here / "d.csv").write_text(";;\nl;r;m1\n;;\n0,2;0,1;3\n;;;;\n0,3;0,1;3\n; ;\n")
    assert read_designs("d.csv").lines.tolist() == [4, 6]


def test_a_motion_without_a_head_is_held_to_its_first_row(here):
    (here / "axis.csv").write_text("0,0\n" + "".join(f"{k},{k},5\n" for k in range(1, 9)))
    with pytest.raises(
        DeclarationError,
        match=r"axis\.csv, line 2: 3 cells, expected 2: decimal commas\? expected points, or",
    ):
        read_samples("axis.csv")
