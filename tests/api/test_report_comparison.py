"""Two runs or two designs side by side on one page, and the charts of pages as files."""

import base64
import csv
import io
import struct
import time
import urllib.parse
import xml.etree.ElementTree as ET

import alive
import browser
import numpy as np
import pytest
from internals import governing, marks, write_comparison
from reports import held, press, snowed, solved

from lagrange_casadi import evaluate, load_case, save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError


def designs():
    scene = load_case("slider_crank").scene
    asked = {"wanted": ["all"], "t": (0, 0.08, 41), "backend": "vm"}
    return [evaluate(scene, parameters={"l": length}, **asked) for length in (0.2, 0.3)]


def test_a_page_of_two_designs_holds_both(tmp_path):
    """Their numbers are those of the solutions; they are named by the parameter that differs."""
    first, second = designs()
    first.report(tmp_path / "both.html", beside=second)
    found, array = held((tmp_path / "both.html").read_text())
    assert [run["name"] for run in found["runs"]] == ["l = 0.2", "l = 0.3"]
    for solution, run in zip((first, second), found["runs"], strict=True):
        effort = next(one for one in run["series"] if one["name"] == "effort:O")
        np.testing.assert_array_equal(array(effort["values"]), solution.effort("O"))
    rows = {row["name"]: row for row in found["rows"]}
    for name in ("effort:O", "reaction:A:resultant", "section:rod:bending"):
        values = [solution.peak(name).value for solution in (first, second)]
        assert rows[name]["values"] == values
    again = tmp_path / "again.html"
    write_comparison([first, second], again)
    assert again.read_bytes() == (tmp_path / "both.html").read_bytes()


def test_what_cannot_be_compared_is_refused(tmp_path):
    first, path = designs()[0], tmp_path / "x.html"
    with pytest.raises(DeclarationError, match="report: expected two solutions"):
        write_comparison([first], path)
    light = press(wanted=("motion",))
    with pytest.raises(DeclarationError, match="no quantity in common"):
        write_comparison([first, light], path)
    assert not path.exists()


def test_two_runs_that_are_the_same_are_said_to_be(here, capfd):
    """On the console and on the page; files of one name in two folders are named by their paths."""
    first, second = designs()
    save(first, "one.h5")
    assert main(["report", "one.h5", "one.h5"]) == 0
    assert "note: both runs are the same" in capfd.readouterr().err
    assert held((here / "one_and_one.html").read_text())[0]["same"] is True
    (here / "other").mkdir()
    save(second, "other/one.h5")
    assert main(["report", "one.h5", "other/one.h5"]) == 0
    assert "the same" not in capfd.readouterr().err
    found, _ = held((here / "one_and_one.html").read_text())
    assert found["same"] is False
    assert [run["name"] for run in found["runs"]] == ["one.h5", "other/one.h5"]


def test_the_command_line_shows_two(here, capfd):
    first, second = designs()
    save(first, "short.h5")
    save(second, "long.h5")
    assert main(["report", "short.h5", "long.h5"]) == 0
    found, _ = held((here / "short_and_long.html").read_text())
    assert [run["name"] for run in found["runs"]] == ["short", "long"]
    asked = ["--t", "0:0.08:5", "--set", "r=0.08"]
    assert main(["report", "slider_crank", *asked, "--beside", "l=0.25"]) == 0
    found, _ = held((here / "slider_crank_beside.html").read_text())
    values = [{name: one[0] for name, one in run["parameters"].items()} for run in found["runs"]]
    assert [(one["l"], one["r"]) for one in values] == [(0.2, 0.08), (0.25, 0.08)]
    capfd.readouterr()
    for words, says in (
        (["short.h5", "--beside", "l=0.3"], "--beside goes with one case"),
        (["short.h5"] * 3, "expected one or two of FILE.h5 and CASE"),
        (["slider_crank", "--live", "--beside", "l=0.3"], "--live goes with one case"),
        (["short.h5", "long.h5", "--set", "l=0.2"], "--set, --t, --over, --want and --live go"),
    ):
        assert main(["report", *words]) == 2
        assert says in capfd.readouterr().err


@pytest.fixture(scope="module")
def page():
    with browser.Browser() as one:
        one.prefer(prefers_reduced_motion="reduce", prefers_color_scheme="light")
        yield one


@alive.NEEDS_BROWSER
def test_two_designs_are_side_by_side_on_a_screen_a_telephone_and_paper(page, tmp_path):
    """Nothing is cut: on a narrow screen they are below each other. Both move together."""
    path = tmp_path / "both.html"
    first, second = designs()
    first.report(path, beside=second)
    places = "[...document.querySelectorAll('iframe')].map((one) => one.getBoundingClientRect().{})"
    for width in (1400, 400):
        page.size(width, 900)
        page.open(path)
        assert page.complaints == []
        assert page.run("document.documentElement.scrollWidth") <= width
        left, top = (page.run(places.format(side)) for side in ("left", "top"))
        assert (left[0] < left[1], top[0] < top[1]) == (width > 700, width < 700)
        wide = "[...document.querySelectorAll('.compared .scroll')].map((one) => {})"
        inner = page.run(wide.format("one.scrollWidth - one.clientWidth"))
        assert inner == [0, 0]
    cells = page.run(
        "[...document.querySelectorAll('.compared tbody tr')].map((row) =>"
        " [...row.cells].map((cell) => cell.textContent))"
    )
    effort = next(row for row in cells if row[:2] == ["O", "effort"])
    values = [solution.peak("effort:O").value for solution in (first, second)]
    shown = [float(text.replace("\u2212", "-").split("\xa0")[0]) for text in effort[2:]]
    change = 100 * (abs(values[1] / values[0]) - 1)
    assert shown == pytest.approx([*values, change], rel=5e-3)
    on = "document.querySelector('[aria-label^=\"One instant on\"]').click()"
    readout = "document.querySelector('.readout').textContent"
    for moved, other in (("run 1", "run 2"), ("run 2", "run 1")):
        page.run_within(f"{on}; {on}; {on}", moved)
        told, end = page.run_within(readout, moved), time.monotonic() + 10
        while page.run_within(readout, other) != told and time.monotonic() < end:
            time.sleep(0.05)
        assert page.run_within(readout, other) == told
    paper = page.printed(tmp_path / "both.pdf")
    assert paper.startswith(b"%PDF")
    assert page.complaints == []


BARS = """
(() => {
  const bars = {};
  const write = CanvasRenderingContext2D.prototype.fillText;
  CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
    if (/ (mm|N · forces|N·m · .*)$/.test(text.replace("\u00a0", " "))) bars[text] = x;
    write.call(this, text, x, y);
  };
  document.querySelector('[aria-label^="One instant on"]').click();
  CanvasRenderingContext2D.prototype.fillText = write;
  return bars;
})()
"""


@alive.NEEDS_BROWSER
def test_two_pictures_have_one_scale_and_one_clock(page, tmp_path):
    """The bars beside both pictures are equally long for the same value, also after one of them is
    changed; at a time after the end of the shorter run that one is at its end.
    """
    longer = designs()[1]
    shorter = evaluate(
        load_case("slider_crank").scene, wanted=["all"], t=(0, 0.04, 41), backend="vm"
    )
    longer.report(tmp_path / "both.html", beside=shorter)
    page.size(1400, 900)
    page.open(tmp_path / "both.html")

    def until_equal(read):
        end = time.monotonic() + 10
        while (found := [read("run 1"), read("run 2")])[0] != found[1] and time.monotonic() < end:
            time.sleep(0.05)
        assert found[0] == found[1]
        return found[0]

    before = until_equal(lambda run: page.run_within(BARS, run))
    assert len(before) == 3
    near = "document.querySelector('[aria-label^=\"Nearer\"]').click()"
    size = "(() => { const one = document.querySelector('.size'); one.value = 1;"
    page.run_within(f"{near}; {size} one.dispatchEvent(new Event('input')); }})()", "run 2")
    after = until_equal(lambda run: page.run_within(BARS, run))
    assert after != before
    at = "document.querySelector('.readout').textContent.replace('\\u00a0', ' ')"
    end = "document.dispatchEvent(new KeyboardEvent('keydown', { key: 'End' }))"
    for moved, times in (
        ("run 2", ["t = 40 ms", "t = 40 ms"]),
        ("run 1", ["t = 80 ms", "t = 40 ms"]),
    ):
        page.run_within(end, moved)
        until = time.monotonic() + 10
        while (
            found := [page.run_within(at, run) for run in ("run 1", "run 2")]
        ) != times and time.monotonic() < until:
            time.sleep(0.05)
        assert found == times
    assert page.complaints == []


PRINTED = """
(() => {
  let bars = {};
  const { fillText, clearRect } = CanvasRenderingContext2D.prototype;
  Object.assign(CanvasRenderingContext2D.prototype, {
    clearRect(...box) {
      bars = {};
      clearRect.apply(this, box);
    },
    fillText(text, x, y) {
      if (/(mm| · .*)$/.test(text)) bars[text] = x;
      fillText.call(this, text, x, y);
    },
  });
  window.addEventListener("beforeprint", () => {
    window.printed = [document.querySelector(".readout").textContent, bars];
  });
})()
"""


@alive.NEEDS_BROWSER
@pytest.mark.parametrize("rests", [False, True])
def test_two_pictures_on_paper_have_one_scale_and_one_time(page, tmp_path, rests):
    """Printed from a window so narrow that only the upper one is seen: while they move, and at an
    instant that was chosen.
    """
    first, second = designs()
    first.report(tmp_path / "both.html", beside=second)
    page.size(400, 600)
    page.open(tmp_path / "both.html")
    at = "document.querySelector('.readout').textContent"
    until = time.monotonic() + 10
    while page.run_within(at, "run 2").startswith("t = 0") and time.monotonic() < until:
        time.sleep(0.05)
    if rests:
        pause = "document.querySelector('.play[aria-label=Pause]').click();"
        chosen = page.run_within(f"{pause} {at}", "run 1")
        while page.run_within(at, "run 2") != chosen and time.monotonic() < until:
            time.sleep(0.05)
    for run in ("run 1", "run 2"):
        page.run_within(PRINTED, run)
    page.printed(tmp_path / "both.pdf")
    (time_, bars), other = (page.run_within("window.printed", run) for run in ("run 1", "run 2"))
    assert other == [time_, bars]
    assert len(bars) == 3
    assert time_ == (chosen if rests else "t = 0\u00a0ms")
    assert page.complaints == []


SAVED = """
(async () => {
  const got = [];
  HTMLAnchorElement.prototype.click = function () { got.push([this.download, this.href]); };
  for (const list of document.querySelectorAll('.card .save')) {
    for (const kind of ['svg', 'png', 'csv']) {
      const before = got.length;
      list.value = kind;
      list.dispatchEvent(new Event('change'));
      while (got.length === before) await new Promise((next) => setTimeout(next, 10));
    }
  }
  return got;
})()
"""


def saved(page, solution, path):
    """The files that a page's cards are saved as, by name."""
    solution.report(path)
    page.size(1400, 900)
    page.open(path)
    found = {}
    for name, address in page.run(SAVED):
        head, _, body = address.partition(",")
        plain = base64.b64decode(body) if head.endswith("base64") else None
        found[name] = plain or urllib.parse.unquote(body).encode()
    assert page.complaints == []
    return found


@alive.NEEDS_BROWSER
def test_charts_are_saved_as_pictures_and_numbers(page, tmp_path):
    """SVG with its styles in itself, PNG of twice the size, and CSV with the file's digits."""
    solution = solved("slider_crank")
    files = saved(page, solution, tmp_path / "report.html")
    kinds = {name.rpartition(".")[2] for name in files}
    assert kinds == {"svg", "png", "csv"}
    drawing = ET.fromstring(files["slider_crank_Efforts.svg"])
    assert "class" not in {name for one in drawing.iter() for name in one.attrib}
    curves = [one for one in drawing.iter() if one.tag.endswith("path")]
    assert all(one.attrib["stroke"].startswith("rgb") for one in curves)
    size = [float(drawing.attrib[side]) for side in ("width", "height")]
    png = files["slider_crank_Efforts.png"]
    assert png.startswith(b"\x89PNG")
    assert struct.unpack(">II", png[16:24]) == tuple(int(2 * side) for side in size)
    rows = list(csv.reader(io.StringIO(files["slider_crank_Efforts.csv"].decode())))
    assert rows[0] == ["t [s]", "effort:O [N m]"]
    values = np.array(rows[1:], float)
    np.testing.assert_array_equal(values[:, 0], solution.t)
    np.testing.assert_array_equal(values[:, 1], solution.effort("O"))
    maps = np.array(
        [
            row[1:]
            for row in csv.reader(io.StringIO(files["slider_crank_Section_map.csv"].decode()))
        ][1:],
        float,
    )
    exact = solution.section("crank").law.on_grid("bending", np.linspace(0, 1, 101))
    np.testing.assert_allclose(maps, exact, atol=1e-12 * np.abs(exact).max())


@alive.NEEDS_BROWSER
@pytest.mark.parametrize(("case", "link"), [("slider_crank", "crank"), ("excavator", "boom")])
def test_the_diagrams_of_a_page_have_the_values_of_the_law(page, tmp_path, case, link):
    """At ends, on both sides of jumps, and at peaks, at the instant that governs."""
    solution = solved(case)
    files = saved(page, solution, tmp_path / "report.html")
    rows = list(csv.reader(io.StringIO(files[f"{case}_Diagrams.csv"].decode())))
    forces = [head.split(":")[2].split(" ")[0] for head in rows[0][1:]]
    assert rows[0][1].startswith(f"section:{link}:")
    values = np.array(rows[1:], float)
    i = int(np.flatnonzero(solution.t == governing(solution, link).t)[0])
    law = solution.section(link).law.during(slice(i, i + 1))
    texts = page.run(
        "[...document.querySelectorAll('.diagram .value')].map((one) => one.textContent)"
    )
    for column, force in enumerate(forces, 1):
        found = marks(law, force)
        most = max(abs(mark.value) for mark in found)
        for mark in (found[0], found[-1], max(found, key=lambda mark: abs(mark.value))):
            near = values[np.abs(values[:, 0] - mark.xi) < 0.006, column]
            assert np.abs(near - mark.value).min() < 1e-4 * most
        largest = max(found, key=lambda mark: abs(mark.value)).value
        digits = {text.replace("\u2212", "-") for text in texts}
        scaled = {f"{largest * factor:.4g}" for factor in (1.0, 1e-3)}
        assert scaled & digits


@alive.NEEDS_BROWSER
def test_a_diagram_of_a_page_writes_a_number_once_where_its_force_does_not_jump(page, tmp_path):
    """A load along a part of a link is a place with two points in each curve."""
    snowed().report(tmp_path / "report.html")
    page.size(1400, 900)
    page.open(tmp_path / "report.html")
    found = page.run(
        "[...document.querySelectorAll('.diagram')].map((one) =>"
        " [...one.querySelectorAll('.value')].map((text) =>"
        " [text.textContent, ...['x', 'y'].map((one) => Number(text.getAttribute(one)))]))"
    )
    texts = [text for diagram in found for text in diagram]
    assert texts
    for k, (words, x, y) in enumerate(texts):
        assert not any(
            words == other and abs(x - at) < 20 and abs(y - level) < 20
            for other, at, level in texts[:k]
        )
