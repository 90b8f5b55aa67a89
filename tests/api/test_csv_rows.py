"""Rows of CSV files: their lines, delimiters, decimal points, and what is no row."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import Row, read_rows

from lagrange_casadi.errors import DeclarationError, PathError

pytestmark = pytest.mark.quick


def rows(here, text, encoding="utf-8"):
    (here / "table.csv").write_bytes(text.encode(encoding))
    return list(read_rows("table.csv", "some rows"))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(("delimiter", "comma"), [(",", False), (";", True), ("\t", True)])
def test_lines_keep_their_numbers(here, end, delimiter, comma):
    text = [
        "# said by hand",
        "",
        f"a{delimiter} b ",
        "  # left out",
        f'"x{delimiter}y"{delimiter}2',
        "   ",
    ]
    found = rows(here, end.join(text), "utf-8-sig")
    assert found == [
        Row("table.csv, line 3", 3, ("a", "b")),
        Row("table.csv, line 5", 5, (f"x{delimiter}y", "2")),
    ]
    assert all((row.marks is not None) == comma for row in found)


def test_characters_that_only_python_takes_for_ends_of_lines_are_none(here):
    assert [row.where for row in rows(here, "a,b\nx\x0cy,\u2028\n1,2\n")] == [
        f"table.csv, line {n}" for n in (1, 2, 3)
    ]


@pytest.mark.parametrize(
    ("cell", "comma", "per", "number"),
    [
        ("35", False, 1000, 0.035),
        ("32,5", True, 1000, 0.0325),
        ("-1e3", False, 1, -1000.0),
        ("0.1", True, 1, 0.1),
        ("32,5", False, 1, math.nan),
        ("1.000,5", True, 1, math.nan),
        ("1_0", False, 1, math.nan),
        ("\u0663", False, 1, math.nan),
        ("inf", False, 1, math.nan),
        ("nan", False, 1, math.nan),
        ("sNaN", False, 1, math.nan),
        ("1e999", False, 1, math.nan),
        ("", False, 1, math.nan),
        ("thick", False, 10, math.nan),
    ],
)
def test_numbers(cell, comma, per, number):
    assert Row("here", 1, (cell,), {} if comma else None).number(cell, per) == pytest.approx(
        number, rel=0, abs=0, nan_ok=True
    )


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_comes_back_as_it_was_written(number):
    assert Row("here", 1, ()).number(repr(number)) == number
    assert Row("here", 1, (), {}).number(repr(number).replace(".", ",")) == number


@pytest.mark.parametrize("text", ["", "\n\n", "# only this\n"])
def test_a_file_without_rows_is_told(here, text):
    with pytest.raises(DeclarationError, match=r"^table\.csv: it has no rows; expected some rows$"):
        rows(here, text)


def test_a_quote_ends_on_its_line(here):
    with pytest.raises(
        DeclarationError,
        match=(
            r"^table\.csv, line 2: no cells with ',' between them: a quote is opened and never cl"
        ),
    ):
        rows(here, 'a,b\n"x,1\ny",2\n')


def test_what_is_no_text_is_told(here):
    for encoding in ("utf-16", "latin-1"):
        with pytest.raises(PathError, match=r"table\.csv: cannot be read as text: "):
            rows(here, "größe\n", encoding)
    with pytest.raises(PathError, match=r"none\.csv: no such file$"):
        next(read_rows(here / "none.csv", "some rows"))
    with pytest.raises(PathError, match=r"is a folder, not a file$"):
        next(read_rows(here, "some rows"))
