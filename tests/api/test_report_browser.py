"""Reports in a real browser, from files and without a network: pages open, move, and show the
numbers of their solutions to the digits shown; live pages find what the package finds.
"""

import csv
import io
import json
import re
import struct
import urllib.request
import xml.etree.ElementTree as ET
from dataclasses import replace
from importlib import resources

import alive
import numpy as np
import pytest
from commands import command
from drawn_scenes import every_kind
from internals import placement, scale_for
from mechanisms import pins_of
from reports import HOSTILE, held, hostile, press, snowed, solved, wound
from reports import page as page_of

from lagrange_casadi import Mechanism, Scene, evaluate, load_case
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = alive.NEEDS_BROWSER


chromium = alive.chromium


@pytest.fixture
def page(chromium, tmp_path):
    """A function that opens a solution's report in a browser."""

    def opened(solution):
        solution.report(tmp_path / "report.html")
        chromium.open(tmp_path / "report.html")
        assert chromium.complaints == []
        return chromium

    return opened


def quiet(one):
    """Nothing was complained of, and nothing asked for but the file itself and pictures that it
    holds.
    """
    assert one.complaints == []
    assert all(address.startswith(("file://", "data:")) for address in one.asked)


TABLE = (
    "[...document.querySelectorAll('.table')].find((one) => one.querySelector('h2').textContent ==="
    " '{}')"
)


@pytest.mark.parametrize(
    ("case", "parts"),
    [("planetary_gear", ["carried"]), ("scissor_lift", ["lines", "prismatic", "stand"])],
)
def test_a_page_draws_what_all_pictures_draw(chromium, tmp_path, case, parts):
    """Without pitch circles, gas springs or symbols of joints the picture is another."""
    path, seen = tmp_path / "page.html", set()
    evaluate(load_case(case).scene, wanted=["motion"], certificate=False).report(path)
    text = path.read_text()
    for part in ("", *parts):
        path.write_text(text.replace(f'"{part}":[', f'"{part}":[],"lost":['))
        chromium.open(path)
        seen.add(chromium.run("document.querySelector('.picture').toDataURL()"))
    assert len(seen) == 1 + len(parts)


def copied(one, caption):
    """A table of the page as it is copied: its rows."""
    one.run(f"{TABLE.format(caption)}.querySelector('.copy').click()")
    return list(csv.DictReader(io.StringIO(one.run("window.copied"))))


NUMBER = re.compile(r"(-?[\d.]+)(?:·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?(?: ([kMµ]|m(?=[NWsm]))?.*)?")
PLAIN = {0x2212: "-", 0xA0: " "} | str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def number(text):
    """What a shown value is in SI, where its unit has a prefix."""
    mantissa, exponent, prefix = NUMBER.fullmatch(text).groups()
    factor = {"k": 1e3, "M": 1e6, "m": 1e-3, "µ": 1e-6}.get(prefix, 1.0)
    return factor * float(f"{mantissa}e{(exponent or '0').translate(PLAIN)}")


def test_pages_write_numbers_as_figures_do(chromium):
    """With a prefix by the size, to as many digits; but for a point between the parts of a unit."""
    values = [0.0] + [v * 10.0**k for v in (1, -2.5, 3.14159, -9.9996) for k in range(-3, 3)]
    source = (resources.files("lagrange_casadi") / "views/report/assets/units.js").read_text()
    for unit in ("N", "N m", "Pa", "m", "kg"):
        written = f"{json.dumps(values)}.map((value) => shown(value, '{unit}', 4))"
        assert chromium.run(f"(() => {{ {source}; return {written}; }})()") == [
            scale_for(unit, abs(value)).said(value).replace("N m", "N·m").replace(" ", "\u00a0")
            for value in values
        ]


@pytest.mark.parametrize("name", ["slider_crank", "rssr"])
def test_tables_show_the_files_numbers_to_the_digits_shown(page, name):
    """What is rounding beside the largest of its unit is 0."""
    solution = solved(name)
    one = page(solution)
    rows = copied(one, "Peaks")
    lines = f"[...{TABLE.format('Peaks')}.querySelectorAll('tbody tr')]"
    texts = one.run(f"{lines}.map((row) => [...row.cells].map((cell) => cell.textContent))")
    assert len(texts) == len(rows) > 10
    sizes = {}
    for row in rows:
        size = abs(float(row["largest in size"]))
        sizes[row["unit"]] = max(sizes.get(row["unit"], 0.0), size)
    for row, shown in zip(rows, texts, strict=True):
        value, t = float(row["largest in size"]), float(row["t [s]"])
        least = 1e-12 * sizes[row["unit"]]
        told = [number(shown[k].translate({0x2212: "-", 0xA0: " "})) for k in (2, 4)]
        assert told == [pytest.approx(value, rel=6e-6, abs=least), pytest.approx(t, rel=6e-5)]
    quiet(one)


def test_it_plays_pauses_steps_and_scrubs(page):
    one = page(press(t=(0, 0.628, 101)))
    instant = "Number(document.querySelector('.transport input').value)"
    assert one.run(instant) == 0
    one.run("document.querySelector('.play').click()")
    alive.wait(one, f"{instant} > 3")
    one.run("document.querySelector('.play').click()")
    at = one.run(instant)
    one.press("ArrowRight")
    assert one.run(instant) == at + 1
    scrub = "bar.value = 50; bar.dispatchEvent(new Event('input'));"
    one.run(f"{{ const bar = document.querySelector('.transport input'); {scrub} }}")
    assert one.run("document.querySelector('.readout').textContent") == "t = 314\u00a0ms"
    quiet(one)


LAWS = {
    "over the crank's angle, of a load that slides": lambda: solved("quick_return"),
    "in space": lambda: solved("rssr"),
    "of couples of slices": lambda: evaluate(wound(), backend="vm"),
    "of loads along a link": snowed,
    "of loads along a link in space": lambda: snowed(space=True),
}


@pytest.mark.parametrize("what", LAWS)
def test_a_section_map_tells_the_solutions_forces(page, what):
    solution = LAWS[what]()
    one = page(solution)
    plot = "document.querySelector('.map')"
    link = one.run(f"{plot}.closest('.card').querySelector('select').value")
    told = [each for each in held(page_of(solution))[0]["series"] if f":{link}:" in each["name"]]
    words = {each["what"]: each["name"].rpartition(":")[2] for each in told if each["places"]}
    law = solution.section(link).law
    one.run(f"{plot}.scrollIntoView({{ block: 'center' }})")
    box = "[box.left, box.top, box.width, box.height]"
    left, top, width, height = one.run(f"((box) => {box})({plot}.getBoundingClientRect())")
    tip = "[...document.querySelectorAll('.tip .head, .tip dl > *')]"
    for across, down in ((0.3, 0.4), (0.6, 0.25), (0.75, 0.7)):
        one.point(left + across * width, top + down * height)
        head, *lines = (
            text.translate({0x2212: "-", 0xA0: " "})
            for text in one.run(f"{tip}.map((one) => one.textContent)")
        )
        t, xi = (
            number(re.search(r"t = (-?[\d.]+ m?s)", head)[1]),
            float(re.search(r"l = ([\d.]+)", head)[1]),
        )
        i = int(np.argmin(np.abs(solution.t - t)))
        shown = {
            words[what]: value
            for what, value in zip(lines[::2], lines[1::2], strict=True)
            if what in words
        }
        assert len(shown) >= 3
        for force, value in shown.items():
            expected = law.during(slice(i, i + 1)).on_grid(force, np.array([xi]))[0, 0]
            least = 1e-12 * law.bound(force, np.array([xi]))
            assert number(value) == pytest.approx(expected, rel=1e-4, abs=least)
    quiet(one)


def test_names_are_texts_and_never_markup(page):
    one = page(hostile())
    assert one.run("window.told === undefined && document.images.length === 0")
    assert (
        one.run("document.title")
        == one.run("document.querySelector('h1').textContent")
        == HOSTILE[0]
    )
    for name in HOSTILE:
        assert one.run(
            "[...document.querySelectorAll('tbody th')].some((cell) => cell.lastChild.textContent"
            f" === {name!r})"
        )
    quiet(one)


PRESSES = """(async () => {
  const pause = () => new Promise((done) => setTimeout(done, 0));
  const each = async (what, act) => {
    for (const one of [...document.querySelectorAll(what)]) if (one.isConnected) { act(one); await pause(); }
  };
  const change = (one, value) => {
    one.value = value;
    for (const kind of ['input', 'change']) one.dispatchEvent(new Event(kind));
  };
  await each('.adding button, .switch:not(:last-child), .show input, .tile', (one) => one.click());
  await each('.views button, thead button, .transport .sign', (one) => one.click());
  await each('select', (one) => change(one, one.options[one.options.length - 1].value));
  await each('select', (one) => change(one, one.options[Math.min(1, one.options.length - 1)].value));
  await each('input[type=range]', (one) => { change(one, one.min); change(one, one.max); });
  return document.querySelectorAll('.card').length;
})()"""  # noqa: E501
"""Every button and list of a page, once or twice."""


def changed(change, **more):
    """The press with other arrays."""
    outputs = {output: change(output, values) for output, values in press().outputs.items()}
    return replace(press(), outputs=outputs, errors={}, **more)


FORCES, OPEN = ("effort", "reaction", "law", "station", "output"), ("reaction", "law")
ODD = {
    "no forces": lambda: changed(lambda o, v: np.zeros_like(v) if o.group in FORCES else v),
    "forces that are open": lambda: changed(
        lambda o, v: np.full_like(v, np.nan) if o.group in OPEN else v,
        indeterminate=tuple(o for o in press().outputs if o.group in OPEN),
    ),
    "one instant": lambda: press(t=(0.1, 0.1, 1)),
    "motion alone": lambda: press(wanted=("motion",)),
    "every kind of joint": every_kind,
}
"""Solutions of which little is to be seen, or something that is hard to draw."""


@pytest.mark.sampled(7)
@pytest.mark.parametrize("what", ODD)
def test_nothing_that_a_reader_presses_fails(page, what):
    one = page(ODD[what]())
    assert one.run(PRESSES) >= 1
    quiet(one)


WRONG = {"balance": np.full(9, 0.5)}
VERDICTS = [
    (press, "✓ certified", "Checked independently, and right"),
    (
        lambda: press(wanted=("motion", "effort")),
        "✓ motion certified",
        "the forces are not checked, because outputs are missing",
    ),
    (
        lambda: replace(press(), certificate=press().certificate | WRONG),
        "✗ the certificate fails",
        "The check fails: do not trust these numbers",
    ),
    (lambda: replace(press(), certificate={}), "", "Not checked"),
]


def test_a_certificate_says_no_more_than_was_checked(page):
    """Where motion alone was wanted, nothing is said of forces; where a residual fails, that comes
    first.
    """
    for solution, badge, verdict in VERDICTS:
        one = page(solution())
        assert one.run("document.querySelector('.badge').textContent").startswith(badge)
        assert one.run("document.querySelector('.verdict').textContent").endswith(verdict)


SAVED = """
(async () => {
  const got = {};
  HTMLAnchorElement.prototype.click = function () { got[this.download] = this.href; };
  for (const list of document.querySelectorAll('.card .save')) {
    for (const kind of ['svg', 'png', 'csv']) {
      const before = Object.keys(got).length;
      list.value = kind;
      list.dispatchEvent(new Event('change'));
      while (Object.keys(got).length === before) await new Promise((next) => setTimeout(next, 10));
    }
  }
  return got;
})()
"""


def test_charts_are_saved_as_pictures_and_numbers(page):
    """SVG with its styles in itself, PNG of twice the size, and CSV with the file's digits."""
    solution = solved("slider_crank")
    files = page(solution).run(SAVED)

    def content(name):
        with urllib.request.urlopen(files[f"slider_crank_{name}"]) as file:
            return file.read()

    drawing = ET.fromstring(content("Efforts.svg"))
    assert "class" not in {name for one in drawing.iter() for name in one.attrib}
    curves = [one for one in drawing.iter() if one.tag.endswith("path")]
    assert all(one.attrib["stroke"].startswith("rgb") for one in curves)
    size = tuple(int(2 * float(drawing.attrib[side])) for side in ("width", "height"))
    assert struct.unpack(">II", content("Efforts.png")[16:24]) == size
    head, *rows = csv.reader(content("Efforts.csv").decode().splitlines())
    assert head == ["t [s]", "effort:O [N m]"]
    expected = np.column_stack([solution.t, solution.effort("O")])
    np.testing.assert_array_equal(np.array(rows, float), expected)
    maps = np.genfromtxt(io.BytesIO(content("Section_map.csv")), delimiter=",", skip_header=1)
    exact = solution.section("crank").law.on_grid("bending", np.linspace(0, 1, 101))
    np.testing.assert_allclose(maps[:, 1:], exact, atol=1e-12 * np.abs(exact).max())


def peaks(one):
    """The largest values of a page by their names, as text."""
    return {row["name"]: row["largest in size"] for row in copied(one, "Peaks")}


def put(one, name, value):
    """Type a value into a parameter's field, and wait for the next picture of the screen."""
    labels = "[...document.querySelectorAll('.sliders label')]"
    own = f"{labels}.find((one) => one.textContent.startsWith('{name}'))"
    one.run(
        f"(async () => {{ const field = {own}.querySelector('[type=number]'); field.value ="
        f" {value!r}; for (const kind of ['input', 'change']) field.dispatchEvent(new Event(kind));"
        " await new Promise((done) => setTimeout(done, 250)); })()"
    )


@pytest.fixture(scope="module")
def live(tmp_path_factory):
    """A live page as the command line writes it."""
    path = tmp_path_factory.mktemp("live") / "crank.html"
    assert command("report CASE --live --t 0:0.08:41 --out", path) == 0
    return path


@pytest.fixture
def crank(chromium, live):
    """A browser that shows the page as it is."""
    chromium.open(live)
    alive.wait(chromium, "document.querySelectorAll('.sliders label').length === 5")
    return chromium


def test_sliders_change_all_that_is_read_and_back_again(crank):
    one, file = crank, peaks(crank)
    badge = "document.querySelector('.badge').textContent"
    assert one.run(badge) == "✓ certified"
    put(one, "l", 0.3125)
    true = evaluate(
        load_case("slider_crank").scene,
        parameters={"l": 0.3125},
        t=(0, 0.08, 41),
        backend="vm",
    )
    changed = peaks(one)
    assert {name: float(value) for name, value in changed.items()} == pytest.approx(
        {name: true.peak(name).value for name in changed}, rel=1e-12, abs=1e-12
    )
    assert changed != file
    assert "not certified" in one.run(badge)
    one.run("document.querySelector('.alive .copy').click()")
    # The case by its name where it is the one of the package, else by its path.
    assert re.fullmatch(
        r"lagrange-casadi run (\S+/)?slider_crank --set l=0\.3125", one.run("window.copied")
    )
    one.run("document.querySelector('.alive .sign').click()")
    alive.wait(one, f"{badge} === '✓ certified'")
    assert peaks(one) == file
    quiet(one)


def test_a_design_that_cannot_be_assembled_says_so_in_place_of_numbers(crank):
    one = crank
    put(one, "l", 0.05)
    told = one.run("document.querySelector('.alive .alarm').textContent")
    assert told.startswith(
        "There is no such design: a loop cannot be closed: its links do not reach, at t = "
    )
    assert one.run(
        "[...document.querySelectorAll('.tile b')].every((tile) => tile.textContent === '\\u2013')"
    )
    assert set(peaks(one).values()) <= {"NaN", "0"}
    put(one, "l", -1.0)
    assert one.run("document.querySelector('.alive .alarm').textContent") == (
        "There is no such design: l = \u22121\u00a0m is out of range; it must be at least 0\u00a0m."
    )
    put(one, "l", 0.2)
    assert one.run("document.querySelector('.alive .alarm').hidden")
    assert one.complaints == []


ON_SCREEN = """(([x, y]) => {{
  const box = page.deck.stage.paper.canvas.getBoundingClientRect();
  return [box.left + x, box.top + y];
}})(page.deck.stage.paper.on([{}, {}, 0]))"""
"""Where a place of the plane is in the browser's window."""


def shift(one, start, by):
    """Drag what is at a place of the window, with the button held at the end; returns that end."""
    one.point(*start)
    one.point(*start, "mousePressed", button="left", buttons=1, clickCount=1)
    for part in np.linspace(0.1, 1.0, 10):
        end = start + part * np.asarray(by)
        one.point(*end, button="left", buttons=1)
        one.run("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)))")
    return end


def loose(one, end):
    one.point(*end, "mouseReleased", button="left", clickCount=1)
    one.run("new Promise((done) => setTimeout(done, 300))")


def pin_pulled(one, way, by):
    """Drag the pin of a crank of 0.1 m along it [m]; return the sheet's scale, and the pointer."""
    start = np.array(one.run(ON_SCREEN.format(*(0.1 * way))))
    scale = one.run("page.deck.stage.paper.camera.scale")
    return scale, shift(one, start, by * scale * way * [1, -1])


VALUE = "page.contents.parameters.find((one) => one.name === '{}').value"


@pytest.fixture
def held_crank(chromium, live):
    """A browser that shows a live page of which inner parts can be read."""
    alive.opened(chromium, live.with_name("opened.html"), live.read_text())
    return chromium


def test_a_joint_is_dragged_and_the_parameters_of_its_place_follow(held_crank):
    """The crank's pin along the crank: r, forces, and what is copied; Escape goes back."""
    one, angle = held_crank, 25 * np.pi * 0.008 + np.pi / 200
    one.run("page.player.seek(4)")
    way = np.array([np.cos(angle), np.sin(angle)])
    scale, end = pin_pulled(one, way, 0.03)
    r = one.run(VALUE.format("r"))
    assert r == pytest.approx(0.13, abs=1 / scale)
    assert one.run(ON_SCREEN.format(*(r * way))) == pytest.approx(end, abs=1.0)
    assert [one.run(VALUE.format(name)) for name in ("l", "m1")] == [0.2, 0.1]
    loose(one, end)
    true = evaluate(
        load_case("slider_crank").scene, parameters={"r": r}, t=(0, 0.08, 41), backend="vm"
    )
    assert float(peaks(one)["effort:O"]) == pytest.approx(true.peak("effort:O").value, rel=1e-12)
    for words, copy in zip(
        (f"--set r={r}", f'm.parameter("r", {r}, "m", low=0)'), (0, 1), strict=True
    ):
        one.run(f"document.querySelectorAll('.alive .copy')[{copy}].click()")
        assert one.run("window.copied").endswith(words)
    one.press("Escape")
    alive.wait(one, f"{VALUE.format('r')} === 0.1")
    quiet(one)


def test_a_drag_keeps_to_bounds_and_draws_the_gap_of_what_does_not_close(held_crank):
    """The crank outgrows its rod: the gap is that of a drawing; what is ticked follows too."""
    one, angle = held_crank, 25 * np.pi * 0.06 + np.pi / 200
    one.run("page.player.seek(30)")
    for _ in range(5):
        one.run("document.querySelector('.views [title^=Farther]').click()")
    way = np.array([np.cos(angle), np.sin(angle)])
    scale, end = pin_pulled(one, way, 0.15)
    r = one.run(VALUE.format("r"))
    assert r == pytest.approx(0.25, abs=1 / scale)
    found = one.run("page.live.engine.stand(30)[0]")
    (gap,) = placement.place_scene(load_case("slider_crank").scene, t=0.06, values={"r": r}).gaps
    assert np.array(found["ends"]) == pytest.approx(gap.ends, abs=1e-7)
    told = one.run("document.querySelector('.alive .alarm').textContent")
    assert told.startswith("There is no such design: a loop cannot be closed")
    assert f"ground and slider are {found['size']} apart at joint 'guide'" in told
    loose(one, end)
    end = shift(one, end, -0.4 * scale * way * [1, -1])
    assert 0.0 <= one.run(VALUE.format("r")) < 0.01
    one.press("Escape")
    loose(one, end)
    one.run("document.querySelector('.alive header .sign').click()")
    loose(one, end)
    one.run("document.querySelector('.sliders [type=checkbox]').click()")
    tip = way[0] * 0.1 + np.sqrt(0.2**2 - (0.1 * way[1]) ** 2)
    start = np.array(one.run(ON_SCREEN.format(tip, 0.0)))
    loose(one, shift(one, start, [20, 0]))
    assert all(one.run(VALUE.format(name)) != value for name, value in (("r", 0.1), ("l", 0.2)))
    quiet(one)


def test_a_joint_on_ground_goes_where_it_is_dragged(chromium, tmp_path):
    """By two parameters, in two directions, to the bound of one of them."""
    m = Mechanism("four_bar")
    x, y = m.parameter("x", 0.3, "m", low=0.2, high=0.35), m.parameter("y", 0.05, "m")
    crank, coupler, rocker = (
        m.link(name, length=length, mass=1.0)
        for name, length in (("crank", 0.1), ("coupler", 0.35), ("rocker", 0.25))
    )
    ends = {"O": (m.ground, crank), "A": (crank.tip, coupler), "B": (coupler.tip, rocker.tip)}
    pins_of(m, **ends, C=(m.ground.at(x, y), rocker))
    motion = {"O": polynomial(0, 20 * np.pi)}
    Scene(m, motion=motion, t=(0, 0.1, 41), posture={"rocker": 1.5}).report(
        tmp_path / "held.html", live=True
    )
    alive.opened(chromium, tmp_path / "opened.html", (tmp_path / "held.html").read_text())
    scale = chromium.run("page.deck.stage.paper.camera.scale")
    place = [f"page.contents.parameters[{k}].value" for k in (0, 1)]
    start = np.array(chromium.run(ON_SCREEN.format(0.3, 0.05)))
    chromium.point(*start)
    assert chromium.run("page.deck.stage.paper.canvas.style.cursor") == "move"
    end = shift(chromium, start, scale * np.array([0.03, -0.02]))
    assert chromium.run(ON_SCREEN.format(*place)) == pytest.approx(end, abs=1.0)
    loose(chromium, end)
    scale = chromium.run("page.deck.stage.paper.camera.scale")
    start = np.array(chromium.run(ON_SCREEN.format(*place)))
    end = shift(chromium, start, scale * np.array([0.1, 0.02]))
    assert chromium.run(place[0]) == 0.35
    assert chromium.run(ON_SCREEN.format(*place))[1] == pytest.approx(end[1], abs=1.0)
    loose(chromium, end)
    quiet(chromium)


def test_a_screw_keeps_count_of_its_turns(chromium, tmp_path):
    """A nut is dragged, though its spindle turns by almost half a turn from instant to instant."""
    assert command("report screw_lift --live --out", tmp_path / "lift.html") == 0
    alive.opened(chromium, tmp_path / "opened.html", (tmp_path / "lift.html").read_text())
    chromium.run("page.player.seek(60)")
    assert chromium.run("page.live.drag.take(page.contents.joints[1])")


def test_what_cannot_come_alive_is_told_in_one_line(tmp_path, capsys, monkeypatch):
    m = Mechanism("fixed")
    m.revolute("O", m.ground, m.link("bar", length=1.0, mass=1.0))
    scene = Scene(m, {"O": polynomial(0, 1)})
    with pytest.raises(DeclarationError, match="'fixed' has no parameter to change"):
        scene.report(tmp_path / "fixed.html", live=True)
    monkeypatch.setattr("importlib.util.find_spec", lambda name, *_: None)
    assert main(["report", "slider_crank", "--live", "--out", str(tmp_path / "crank.html")]) == 2
    assert (
        capsys.readouterr().err
        == "error: a live report needs ziglang; install it with: pip install"
        " 'lagrange_casadi[live]'\n"
    )
    assert not list(tmp_path.iterdir())
