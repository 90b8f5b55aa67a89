"""Lists of designs from CSV: what is wrong is named by line and column."""

import math
import re

import numpy as np
import pytest
import sweeps
from internals import check_designs, read_designs

from lagrange_casadi import Mechanism
from lagrange_casadi.errors import DeclarationError, ParameterError, PathError, UnknownNameError

pytestmark = pytest.mark.quick


def test_a_list_is_read(tmp_path):
    path = tmp_path / "d.csv"
    path.write_text("\ufeffl, r\n0.2,0.1\n\n 3e-1 , 0.05\n", encoding="utf-8")
    listed = read_designs(path)
    assert listed.names == ("l", "r")
    np.testing.assert_array_equal(listed.rows, [[0.2, 0.1], [0.3, 0.05]])
    assert listed.outside("l", 0.25, 1.0) == "0.2 in line 2"
    assert listed.outside("r", 0.1, 1.0) == "0.05 in line 4"


def test_angles_may_have_a_unit(tmp_path):
    path = tmp_path / "d.csv"
    path.write_text("phi,l\n30 deg,0.2\n0.5,0.3\n 90deg ,0.4\n1 rad,0.1\n")
    m = Mechanism("angles")
    m.parameter("phi", 0.0, "rad", low=0.0, high=2.0)
    m.parameter("l", 0.2, "m")
    listed = read_designs(path)
    np.testing.assert_array_equal(
        listed.rows, [[math.pi / 6, 0.2], [0.5, 0.3], [math.pi / 2, 0.4], [1.0, 0.1]]
    )
    check_designs(listed, m.parameters, {})
    path.write_text("phi,l\n30 deg,0.2\n200 deg,0.3\n0.5,20 deg\n")
    with pytest.raises(
        DeclarationError, match=r"d\.csv, column 'l': expected numbers \[m\], not angles"
    ):
        check_designs(read_designs(path), m.parameters, {})
    path.write_text("phi,l\n30 deg,0.2\n200 deg,0.3\n")
    with pytest.raises(
        ParameterError, match=r"phi = 3\.490658504 in line 3, out of its range \[0, 2\]"
    ):
        check_designs(read_designs(path), m.parameters, {})
    path.write_text("phi,l\nmuch deg,0.2\n")
    with pytest.raises(
        DeclarationError, match="line 2, column 'phi': expected a finite number, got 'much deg'"
    ):
        read_designs(path)


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
def test_what_is_wrong_is_named(tmp_path, text, says):
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


def test_a_sweep_names_the_place_in_the_file(tmp_path):
    """Where the reader is told of no parameters."""
    path, mechanism = tmp_path / "d.csv", sweeps.scene().mechanism
    for text, says in (
        ("l,q\n1,2\n", "head, column 2: unknown parameter 'q'; valid: r, l, m1, m2, m3"),
        ("q,l,x\n1,2,3\n", "head, columns 1, 3: unknown parameters 'q', 'x'; valid: r, l"),
        ("l,status\n1,0\n", "head, column 2: 'status' is a result of a sweep, not a parameter"),
    ):
        path.write_text(text)
        with pytest.raises(DeclarationError) as caught:
            check_designs(read_designs(path), mechanism.parameters, {})
        assert str(caught.value).startswith(f"{path}, {says}")


def test_what_is_no_text_is_named(tmp_path):
    (tmp_path / "d.csv").write_bytes(b"l,r\n\xff\xfe\n")
    with pytest.raises(PathError, match="cannot be read as text"):
        read_designs(tmp_path / "d.csv")
    (tmp_path / "d.csv").write_text("l,r\n0.2,0.1\n", encoding="utf-16")
    with pytest.raises(PathError, match="cannot be read as text"):
        read_designs(tmp_path / "d.csv")
    with pytest.raises(PathError, match="no such file"):
        read_designs(tmp_path / "e.csv")
    with pytest.raises(PathError, match="is a folder"):
        read_designs(tmp_path)
