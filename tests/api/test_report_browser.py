"""Reports in a real browser, from files and without a network: pages open, move, and show the
numbers of their solutions to the digits shown; live pages find what the package finds.
"""

import base64
import csv
import io
import re
import struct
import urllib.parse
import xml.etree.ElementTree as ET
from dataclasses import replace

import alive
import browser
import numpy as np
import pytest
from commands import command
from drawn_scenes import every_kind
from reports import HOSTILE, held, hostile, press, solved
from reports import page as page_of

from lagrange_casadi import Mechanism, Scene, evaluate, load_case
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = alive.NEEDS_BROWSER


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A browser, and how to open a solution's report in it."""
    folder = tmp_path_factory.mktemp("reports")
    with browser.Browser() as one:
        one.prefer(prefers_reduced_motion="reduce", prefers_color_scheme="light")

        def opened(solution):
            path = folder / "report.html"
            solution.report(path)
            one.size(1400, 900)
            one.open(path)
            one.run(
                "navigator.clipboard.writeText = (text) => { window.copied = text; return"
                " Promise.resolve(); }"
            )
            assert one.complaints == []
            return one

        yield opened


def quiet(one):
    """Nothing was complained of, and nothing asked for but the file itself and pictures that it
    holds.
    """
    assert one.complaints == []
    first, *others = one.asked
    assert first.startswith("file://")
    assert all(address.startswith("data:") for address in others)


TABLE = (
    "[...document.querySelectorAll('.table')].find((one) => one.querySelector('h2').textContent ==="
    " '{}')"
)


def copied(one, caption):
    """A table of the page as it is copied: its rows."""
    one.run(f"{TABLE.format(caption)}.querySelector('.copy').click()")
    return list(csv.DictReader(io.StringIO(one.run("window.copied"))))


def shown(one, caption):
    """The texts of a table: its heads, and its rows."""
    cells = (
        "[...row.cells].map((cell) => (cell.querySelector('.go') ? cell.lastChild :"
        " cell).textContent)"
    )
    heads, *rows = one.run(
        f"[...{TABLE.format(caption)}.querySelectorAll('tr')].map((row) => {cells})"
    )
    return heads, [[text.translate({0x2212: "-", 0xA0: " "}) for text in row] for row in rows]


def number(text):
    """What a shown value is, its unit left out."""
    mantissa, exponent = re.fullmatch(r"(-?[\d.]+)(?:·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?(?: .*)?", text).groups()
    return float(
        mantissa
        + (
            f"e{exponent.translate(str.maketrans('⁻⁰¹²³⁴⁵⁶⁷⁸⁹', '-0123456789'))}"
            if exponent
            else ""
        )
    )


def to_digits(value, digits):
    return float(f"{value:.{digits}g}")


@pytest.mark.parametrize("name", ["slider_crank", "rssr"])
def test_tables_show_the_files_numbers_to_the_digits_shown(page, name):
    solution = solved(name)
    one = page(solution)
    one.run(
        "document.querySelector('.switch').click(); document.querySelector('.tools"
        " input[type=checkbox]')?.click()"
    )
    heads, rows = shown(one, "Peaks")
    assert heads == ["part", "quantity", "largest in size", "may be off by", "t", "ξ/l"]
    told = [
        o
        for o in solution.quantities()
        if o.group in ("effort", "reaction", "section", "output") and solution.determined(o)
    ]
    sizes = {}
    for o in told:
        size = abs(solution.peak(o).value)
        sizes[solution.unit(o)] = max(sizes.get(solution.unit(o), 0.0), size)

    def seen(o):
        """What is rounding beside the largest of its unit is 0."""
        value = solution.peak(o).value
        return 0.0 if abs(value) <= 1e-12 * sizes[solution.unit(o)] else to_digits(value, 6)

    expected = {
        (
            o.part,
            solution.unit(o),
            seen(o),
            to_digits(solution.peak(o).t, 5),
        )
        for o in told
    }
    assert len(expected) > 10
    assert expected <= {
        (row[0], row[2].partition(" ")[2].replace("·", " "), number(row[2]), number(row[4]))
        for row in rows
    }
    _, rows = shown(one, "Over the cycle")
    over_time = [o for o in told if o.group != "section"]
    means = {
        (o.part, to_digits(found.mean, 6))
        for o in over_time
        if seen(o) and abs((found := solution.statistics(o)).mean) > 1e-9 * abs(found.peak.value)
    }
    assert len(means) > 5
    assert means <= {(row[0], number(row[6])) for row in rows if row[6]}
    quiet(one)


def test_a_table_is_copied_with_all_digits_and_sorted_by_a_press(page):
    solution = solved("rssr")
    one = page(solution)
    rows = copied(one, "Peaks")
    assert len(rows) > 10
    for row in rows:
        peak = solution.peak(row["name"])
        assert (float(row["largest in size"]), float(row["t [s]"]), row["unit"]) == (
            peak.value,
            peak.t,
            peak.unit,
        )
        assert row["xi/l"] == "" if peak.xi is None else float(row["xi/l"]) == peak.xi
    one.run(f"{TABLE.format('Peaks')}.querySelectorAll('thead button')[2].click()")
    sizes = [abs(float(row["largest in size"])) for row in copied(one, "Peaks")]
    assert (
        sizes == sorted(sizes, reverse=True) != [abs(float(row["largest in size"])) for row in rows]
    )
    for row in copied(one, "Over the cycle"):
        assert float(row["smallest"]) == solution.statistics(row["name"]).smallest.value


def test_it_plays_pauses_steps_and_scrubs(page):
    one = page(press(t=(0, 0.628, 101)))
    instant = "Number(document.querySelector('.transport input').value)"
    assert one.run(instant) == 0
    one.run("document.querySelector('.play').click()")
    assert one.run(
        f"new Promise((done) => {{ const look = () => {instant} > 3 ? done(true) : setTimeout(look,"
        " 20); look(); })"
    )
    one.run("document.querySelector('.play').click()")
    at = one.run(instant)
    one.press("ArrowRight")
    assert one.run(instant) == at + 1
    one.press(" ", " ")
    one.press(" ", " ")
    one.run(
        "{ const bar = document.querySelector('.transport input'); bar.value = 50;"
        " bar.dispatchEvent(new Event('input')); }"
    )
    assert (
        one.run("document.querySelector('.readout').textContent.replaceAll('\\u00a0', ' ')")
        == "t = 314 ms"
    )
    quiet(one)


def told(one):
    """What stands beside the pointer: its head, and its lines as names with value and unit."""
    plain = {0x2212: "-", 0xA0: " "}
    head = one.run("document.querySelector('.tip .head').textContent").translate(plain)
    texts = [
        text.translate(plain)
        for text in one.run(
            "[...document.querySelectorAll('.tip dl > *')].map((one) => one.textContent)"
        )
    ]
    return head, {
        name: (number(value), value.partition(" ")[2])
        for name, value in zip(texts[::2], texts[1::2], strict=True)
    }


def hovered(one, kind, across, down):
    """The same, with the pointer over a plot."""
    plot = f"document.querySelector('.{kind}')"
    one.run(f"{plot}.scrollIntoView({{ block: 'center' }})")
    left, top, width, height = (
        one.run(f"{plot}.getBoundingClientRect().{side}")
        for side in ("left", "top", "width", "height")
    )
    one.point(left + across * width, top + down * height)
    return told(one)


def instant_of(solution, head):
    t, milli = re.search(r"t = (-?[\d.]+) (m?)s", head).groups()
    return int(np.argmin(np.abs(solution.t - float(t) * (1e-3 if milli else 1.0))))


FACTORS = {"": 1.0, "k": 1e3, "M": 1e6, "m": 1e-3, "µ": 1e-6}


@pytest.mark.parametrize("name", ["quick_return", "rssr"])
def test_a_section_map_tells_the_solutions_forces(page, name):
    """One in the plane whose load slides along its link, over the crank's angle; one in space."""
    solution = solved(name)
    one = page(solution)
    link = one.run("document.querySelector('.map').closest('.card').querySelector('select').value")
    series = held(page_of(solution))[0]["series"]
    own = [told for told in series if told["name"].startswith(f"section:{link}:")]
    words = {told["name"].rpartition(":")[2]: told["what"] for told in own}
    for across, down in ((0.3, 0.4), (0.6, 0.25), (0.75, 0.7)):
        head, lines = hovered(one, "map", across, down)
        i, xi = instant_of(solution, head), float(re.search(r"ξ/l = ([\d.]+)", head)[1])
        law = solution.section(link).law
        for force, long_name in words.items():
            value, unit = lines[long_name]
            expected = law.during(slice(i, i + 1)).on_grid(force, np.array([xi]))[0, 0]
            least = 1e-12 * law.bound(force, np.array([xi]))
            prefix = unit[0] if unit[0] in FACTORS else ""
            assert value * FACTORS[prefix] == pytest.approx(expected, rel=1e-4, abs=least)
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


def changed(change, left_open=()):
    """The press with other arrays."""
    whole = press()
    outputs = {output: change(output, values) for output, values in whole.outputs.items()}
    return replace(
        whole,
        outputs=outputs,
        errors={},
        indeterminate=tuple(o for o in outputs if o.group in left_open),
    )


FORCES = ("effort", "reaction", "law", "station", "output")


ODD = {
    "no forces": lambda: changed(lambda o, v: np.zeros_like(v) if o.group in FORCES else v),
    "forces that are open": lambda: changed(
        lambda o, v: np.full_like(v, np.nan) if o.group in ("reaction", "law") else v,
        ("reaction", "law"),
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


def test_a_certificate_says_no_more_than_was_checked(page):
    """Where motion alone was wanted, nothing is said of forces; where a residual fails, that comes
    first.
    """
    told = (
        "[document.querySelector('.badge').textContent,"
        " document.querySelector('.verdict').textContent]"
    )
    assert page(press()).run(told) == ["✓ certified", "Checked independently, and right"]
    badge, verdict = page(press(wanted=("motion", "effort"))).run(told)
    assert badge == "✓ motion certified"
    assert verdict.endswith("the forces are not checked, because outputs are missing")
    wrong = replace(press(), certificate={**press().certificate, "balance": np.full(9, 0.5)})
    badge, verdict = page(wrong).run(told)
    assert badge == "✗ the certificate fails"
    assert verdict == "The check fails: do not trust these numbers"
    assert page(replace(press(), certificate={})).run(told)[1] == "Not checked"


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


def saved(one):
    """The files that a page's cards are saved as, by name."""
    found = {}
    for name, address in one.run(SAVED):
        head, _, body = address.partition(",")
        plain = base64.b64decode(body) if head.endswith("base64") else None
        found[name] = plain or urllib.parse.unquote(body).encode()
    return found


def test_charts_are_saved_as_pictures_and_numbers(page):
    """SVG with its styles in itself, PNG of twice the size, and CSV with the file's digits."""
    solution = solved("slider_crank")
    files = saved(page(solution))
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
def crank(chromium, tmp_path_factory):
    """The page that the command line writes, as it is."""
    path = tmp_path_factory.mktemp("live") / "crank.html"
    assert command("report CASE --live --t 0:0.08:41 --out", path) == 0

    def opened():
        chromium.open(path)
        chromium.run(
            "navigator.clipboard.writeText = (text) => { window.copied = text; return"
            " Promise.resolve(); }"
        )
        alive.wait(chromium, "document.querySelectorAll('.sliders label').length === 5")
        return chromium

    return opened


def test_sliders_change_all_that_is_read_and_back_again(crank):
    one = crank()
    file = peaks(one)
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
    line = r"lagrange-casadi run (\S+/)?slider_crank --set l=0\.3125"
    assert re.fullmatch(line, one.run("window.copied"))
    one.run("document.querySelector('.alive .sign').click()")
    alive.wait(one, f"{badge} === '✓ certified'")
    assert peaks(one) == file
    assert one.complaints == []
    assert all(address.startswith(("file://", "data:")) for address in one.asked)


def test_a_design_that_cannot_be_assembled_says_so_in_place_of_numbers(crank):
    one = crank()
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
    words = one.run("document.querySelector('.alive .alarm').textContent").replace("\u00a0", " ")
    assert words == (
        "There is no such design: l = \u22121 m is out of range; it must be at least 0 m."
    )
    put(one, "l", 0.2)
    assert one.run("document.querySelector('.alive .alarm').hidden")
    assert one.complaints == []


def test_the_command_says_from_the_start_what_is_under_way(tmp_path, capsys):
    out = tmp_path / "crank.html"
    arguments = ["--want", "effort", "--t", "0:0.08:5", "--out", str(out)]
    assert main(["report", "slider_crank", "--live", *arguments]) == 0
    steps = capsys.readouterr().err.splitlines()
    assert [step.partition(":")[0] for step in steps] == [f"step {k} of 4" for k in (1, 2, 3, 4)]
    assert steps[0].endswith(": loading the program")
    assert "for this machine and for the browser" in steps[2]


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


chromium = alive.chromium


def live(chromium, scene, folder, wanted=None):
    """Open the live report of a scene, its inner parts in reach."""
    scene.report(folder / "own.html", wanted=wanted, live=True)
    alive.opened(chromium, folder / "live.html", (folder / "own.html").read_text())


PICTURE = 1000 / 30
"""What a picture may take at 30 a second [ms]."""


DRAG = """(async () => {
  const field = document.querySelector('.sliders [type=range]');
  const [low, high] = [Number(field.min), Number(field.max)];
  for (let k = 0; k < %d; k += 1) {
    field.value = low + (0.5 + 0.02 * Math.sin(k / 7)) * (high - low);
    field.dispatchEvent(new Event('input'));
    await new Promise((done) => requestAnimationFrame(done));
  }
})()"""


def work(one, script, pictures=60):
    """What the thread of a page works for a picture of the screen [ms], by its own clock of
    processor time.
    """
    one.call("Performance.enable", timeDomain="threadTicks")
    one.run(script % 20)

    def task():
        return next(
            m["value"]
            for m in one.call("Performance.getMetrics")["metrics"]
            if m["name"] == "TaskDuration"
        )

    before = task()
    one.run(script % pictures)
    return 1e3 * (task() - before) / pictures


@alive.NEEDS_ENGINE
@pytest.mark.long
@pytest.mark.parametrize("name", ["slider_crank", "delta"])
def test_a_slider_is_followed_at_thirty_pictures_a_second(chromium, tmp_path, name):
    scene = load_case(name).scene
    live(chromium, scene, tmp_path)
    assert work(chromium, DRAG) < PICTURE
    assert chromium.complaints == []
