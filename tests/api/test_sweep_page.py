"""The page of a sweep in a browser: its table is the file's, its front and conditions are those of
the command line.
"""

import csv
import io
import re
import shutil
import time

import alive
import numpy as np
import pytest
from reports import CASES, held

from lagrange_casadi import Sweep, best
from lagrange_casadi.cli import main

pytestmark = alive.NEEDS_BROWSER


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """Designs of the slider-crank, some of which cannot be assembled."""
    path = tmp_path_factory.mktemp("swept") / "swept.h5"
    grid = ["--grid", "l=0.06:0.4:9", "--grid", "r=0.05:0.1:4", "--grid", "m3=0.1,0.3"]
    assert (
        main(["sweep", str(CASES / "slider_crank"), *grid, "--t", "0:0.08:41", "--out", str(path)])
        == 0
    )
    return path


chromium = alive.chromium


@pytest.fixture(scope="module")
def written(file):
    """Its page, with the mechanism in motion where ziglang is there."""
    path = file.with_suffix(".html")
    case = ["--case", str(CASES / "slider_crank")] if alive.THERE else []
    assert main(["report", str(file), *case, "--out", str(path)]) == 0
    return path


@pytest.fixture
def page(chromium, written):
    """A browser that shows the page."""
    chromium.open(written)
    return chromium


def rows(one):
    """The table of designs as it is copied."""
    one.run("document.querySelector('.table .copy').click()")
    return list(csv.DictReader(io.StringIO(one.run("window.copied"))))


def only(one, conditions):
    """Type conditions; returns what is said of them."""
    one.run(
        "{ const field = document.querySelector('.conditions input'); field.value ="
        f" {conditions!r}; field.dispatchEvent(new Event('input')); }}"
    )
    return one.run(
        "[...document.querySelectorAll('.conditions output')].map((one) => one.textContent)"
    )


def test_the_table_is_the_files_to_the_last_digit(page, file):
    one, sweep = page, Sweep.open(file)
    found = rows(one)
    names = [
        *sweep.parameters,
        "peak:effort:O",
        "peak:section:rod:bending",
        "mean:effort:O",
        "status",
    ]
    for numbers, values in sweep.blocks(names):
        for k, number in enumerate(numbers):
            row = found[int(number)]
            assert int(row["design"]) == number
            for name in names:
                head = name if name == "status" else f"{name} [{sweep.unit(name)}]"
                np.testing.assert_equal(float(row[head]), float(values[name][k]))
    assert len(found) == sweep.size == 72
    assert one.complaints == []
    assert all(address.startswith(("file://", "data:", "about:")) for address in one.asked)


def test_conditions_are_those_of_the_command_line(page, file):
    one, sweep = page, Sweep.open(file)
    assert only(one, "status=0")[1] == "unknown column status"
    assert only(one, "l=30deg")[1] == "deg is an angle; expected a length [m] after l"
    for where in ("l>0.15", "l>=20 cm, r<=7e1mm", "peak:effort:O<3000 N·mm, m3=100 g", "m3!=0.1"):
        count, wrong = only(one, where)
        asked = {"minimise": "l", "where": [*where.split(", "), "status>=0"], "count": 99}
        expected = [int(row["design"]) for row in rows(one)]
        met = {one.number for one in best(sweep, **asked)}
        assert met == {n for n in expected if np.isfinite(sweep["mean:effort:O"].ravel()[n])}
        assert wrong == ""
        assert count == f"{len(expected)} of 72 designs"
        assert [int(row["design"]) for row in rows(one)] == expected
        front = best(
            sweep, minimise=("peak:effort:O", "peak:section:rod:bending"), where=where.split(", ")
        )
        assert one.run("document.querySelectorAll('.best').length") == len(front)


@alive.NEEDS_ENGINE
def test_a_design_that_is_pressed_moves(page, file):
    one, sweep = page, Sweep.open(file)
    front = best(sweep, minimise=("peak:effort:O", "peak:section:rod:bending"))
    head = "document.querySelector('h3').textContent"
    assert one.run(head).startswith(f"design {front[0].number}: ")
    only(one, "l>0.3")
    one.run("document.querySelectorAll('.table tbody tr')[5].click()")
    number = int(rows(one)[5]["design"])
    assert one.run(head).startswith(f"design {number}: ")
    one.run("document.querySelector('.looked-at .copy').click()")
    values = " --set ".join(f"{name}={x!r}" for name, x in sweep.design(number).items())
    # The case by its name where it is the one of the package, else by its path.
    line = rf"lagrange-casadi run (\S+/)?slider_crank --set {re.escape(values)}"
    assert re.fullmatch(line, one.run("window.copied"))
    length = "document.querySelectorAll('.sliders label')[1].children[2].value"
    until = time.monotonic() + 20.0
    while float(one.run_within(length) or 0.0) != sweep.design(number)["l"]:
        assert time.monotonic() < until
        time.sleep(0.05)
    assert one.complaints == []


def test_without_a_case_the_page_says_what_it_lacks(file, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    other = tmp_path / "slider_crank"
    shutil.copytree(CASES / "four_bar", other)
    assert main(["report", str(file), "--case", str(other)]) == 2
    assert (
        "the sweep was made with another scene; give the case that was swept"
        in capsys.readouterr().err
    )
    assert not (tmp_path / "swept.html").exists()
    monkeypatch.setattr("importlib.util.find_spec", lambda name, *_: None)
    assert main(["report", str(file)]) == 0
    out, err = capsys.readouterr()
    assert err.startswith("note: the page has no mechanism in motion: ")
    assert out == "wrote swept.html: open it in a browser\n"
    found, array = held((tmp_path / "swept.html").read_text())
    assert found["frame"] is None
    assert array(found["columns"][0]["values"]).size == 72
