"""The page of a sweep in a browser: its table is the file's, its front and conditions are those of
the command line.
"""

import csv
import io
import re
import shutil
import time
from pathlib import Path

import alive
import browser
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


@pytest.fixture(scope="module")
def page(file):
    """Its page, with the mechanism in motion where ziglang is there."""
    path = file.with_suffix(".html")
    case = ["--case", str(CASES / "slider_crank")] if alive.THERE else []
    assert main(["report", str(file), *case, "--out", str(path)]) == 0
    with browser.Browser(1500, 1000) as one:
        one.prefer(prefers_reduced_motion="reduce", prefers_color_scheme="light")

        def opened():
            one.open(path)
            one.run(
                "navigator.clipboard.writeText = (text) => { window.copied = text; return"
                " Promise.resolve(); }"
            )
            return one

        yield opened


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
    one, sweep = page(), Sweep.open(file)
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
    one, sweep = page(), Sweep.open(file)
    assert only(one, "status=0")[1] == "unknown column status"
    assert only(one, "l=30deg")[1] == "l is in m, got an angle"
    for where in ("l>0.15", "l>=0.2, r<=0.07", "peak:effort:O<3, m3=0.1", "m3!=0.1"):
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
    one, sweep = page(), Sweep.open(file)
    front = best(sweep, minimise=("peak:effort:O", "peak:section:rod:bending"))
    assert one.run("document.querySelector('h3').textContent").startswith(
        f"design {front[0].number}: "
    )
    only(one, "l>0.3")
    one.run("document.querySelectorAll('.table tbody tr')[5].click()")
    number = int(rows(one)[5]["design"])
    told = one.run("document.querySelector('h3').textContent")
    assert told.startswith(f"design {number}: ")
    one.run("document.querySelector('.looked-at .copy').click()")
    asked = sweep.design(number)
    # The case by its name where it is the one of the package, else by its path.
    assert re.match(r"lagrange-casadi run (\S+/)?slider_crank --set l=", one.run("window.copied"))
    assert [
        float(word.partition("=")[2]) for word in one.run("window.copied").split(" --set ")[1:]
    ] == list(asked.values())
    labels = "[...document.querySelectorAll('.sliders label')]"
    fields = (
        f"{labels}.map((one) => [one.querySelector('.name').textContent, one.children[2].value])"
    )
    for _ in range(100):
        values = {name: float(value) for name, value in one.run_within(fields)}
        if values.get("l") == asked["l"]:
            break
        time.sleep(0.05)
    assert values["l"] == asked["l"]
    assert values["r"] == asked["r"]
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
    assert main(["report", "slider_crank", "--case", "four_bar"]) == 2
    assert "--case goes with a sweep's file" in capsys.readouterr().err
    assert main(["report", str(file), "--live"]) == 2


def test_the_page_opens_on_what_varies_most_and_tells_the_rest_in_a_line(page, file):
    """A column that is the same for all designs is no map, no column of the table, no reading."""
    one, sweep = page(), Sweep.open(file)
    ok = sweep["status"] == 0
    sizes = {name: np.abs(sweep[name][ok]) for name in sweep.columns if name.startswith("peak:")}
    largest = {}
    for name, values in sizes.items():
        largest[sweep.unit(name)] = max(largest.get(sweep.unit(name), 0.0), values.max())
    spread = {
        name: np.ptp(values) / values.max()
        for name, values in sizes.items()
        if values.max() > 1e-12 * largest[sweep.unit(name)]
    }
    choices = "[...document.querySelectorAll('.card select')].map((one) => one.value)"
    assert one.run(choices)[0] == max(spread, key=spread.get)
    same = one.run("document.querySelector('.designs .fine').textContent")
    assert same.startswith("The same in all designs: ")
    assert "peak:reaction:guide:fx 0\u00a0N;" in same
    options = one.run("[...document.querySelectorAll('.card option')].map((one) => one.value)")
    heads = one.run("[...document.querySelectorAll('.designs th')].map((one) => one.textContent)")
    names = one.run("[...document.querySelectorAll('.readings dt')].map((one) => one.textContent)")
    for words in (options, heads, names):
        assert "peak:reaction:guide:fx" not in [word.replace("\u200b", "") for word in words]


@alive.NEEDS_ENGINE
def test_the_page_takes_the_case_that_was_swept(tmp_path, capsys, monkeypatch):
    """Whatever the mechanism is called, and wherever the command runs."""
    (tmp_path / "made").mkdir()
    text = (CASES / "four_bar" / "case.py").read_text()
    (tmp_path / "mine.py").write_text(text.replace('"four_bar"', '"linkage"'))
    grid = ["--grid", "b=0.35,0.36", "--t", "0:0.1:5", "--want", "effort"]
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", "mine.py", *grid, "--out", "made/s.h5"]) == 0
    sweep = Sweep.open("made/s.h5")
    assert sweep.case_file == Path("made/../mine.py")
    for folder, place in ((tmp_path, "mine.py"), (tmp_path / "made", "../mine.py")):
        monkeypatch.chdir(folder)
        out = tmp_path / "page.html"
        assert main(["report", str(tmp_path / "made" / "s.h5"), "--out", str(out)]) == 0
        assert capsys.readouterr().err == ""
        found, _ = held(out.read_text())
        assert found["command"] == f"lagrange-casadi run {place}"
        assert found["frame"] is not None
    (tmp_path / "mine.py").write_text((CASES / "quick_return" / "case.py").read_text())
    assert main(["report", str(tmp_path / "made" / "s.h5"), "--out", str(out)]) == 0
    assert "the case '../mine.py' has changed since the sweep" in capsys.readouterr().err
