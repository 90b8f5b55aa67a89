"""Live pages in a browser: what their engine finds for other parameters is what the package finds;
what has no result says so.
"""

import csv
import io
import json
import math
import re

import alive
import numpy as np
import pytest
from commands import command
from internals import Live
from internals import report_page as page
from reports import CASES, held

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.case import load_case
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = [alive.NEEDS_BROWSER, alive.NEEDS_ENGINE]

chromium = alive.chromium


def case(name, count=31):
    scene = load_case(CASES / name).scene
    asked = {"over": (*scene.over[:3], count)} if scene.over else {"t": (*scene.t[:2], count)}
    return scene, asked


SCENES = {
    "a machine over its drive": lambda: (alive.sheller(), {}),
    "a machine over time": lambda: (alive.sheller(over=False), {}),
    "one in space": lambda: case("rssr"),
    "one whose loops are iterated": lambda: case("bricard"),
    "a cam, which repeats": lambda: case("roller_cam"),
    "wheels": lambda: case("planetary_gear"),
}

INNER = """(() => {
  const { contents, array, live } = window.page;
  live.engine.show(%s);
  const all = (number) => [...array(number)];
  return live.engine.why ?? {
    t: all(contents.instants.t),
    over: contents.instants.over && all(contents.instants.over.values),
    series: contents.series.map((one) => [one.name, all(one.values), one.places === null ? null : all(one.places)]),
    poses: contents.bodies.map((body) => body.pose.map(all)),
    picture: [contents.bodies, contents.joints, contents.loads, contents.paths],
    rows: contents.rows,
    forces: window.page.sections.map((section) => [
      section.link,
      [...section.forces.values()].filter((force) => !force.open).map((force) => [
        force.name,
        [0, 21, 50, 100].map((ratio) =>
          Array.from({ length: contents.instants.shown }, (_, i) => window.page.sectionForce(section, force.name, i, ratio))),
      ]),
    ]),
  };
})()"""  # noqa: E501
"""What a page shows of a design, all digits of it."""


def near(found, expected, scale, what):
    found, expected = (
        np.array([np.nan if x is None else x for x in values], float)
        for values in (found, expected)
    )
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * scale, err_msg=str(what))


@pytest.mark.sampled(9)
@pytest.mark.parametrize("what", SCENES)
def test_another_design_is_what_the_package_makes_of_it(chromium, tmp_path, what):
    """Every array, every row and every part of the picture, to 1e-12 of the largest value."""
    scene, asked = SCENES[what]()
    wanted = ["all"]
    rng = np.random.default_rng(len(what))
    given = scene.mechanism.parameters.values()
    values = {one.name: one.default * (1 + 0.05 * rng.uniform(-1, 1)) for one in given}
    moving = {name: value * (1 + 0.01 * rng.uniform(-1, 1)) for name, value in values.items()}
    text = page(
        evaluate(scene, wanted=wanted, backend="vm", **asked),
        Live.of(scene, scene.timing(**asked), wanted, "run"),
    )
    alive.opened(chromium, tmp_path / "live.html", text)
    found = chromium.run(INNER % json.dumps(list(values.values())))
    assert isinstance(found, dict), found
    true = evaluate(scene, parameters=values, wanted=wanted, backend="vm", **asked)
    expected, array = held(page(true))
    near(found["t"], true.t, 1.0, "t")
    if true.over:
        near(found["over"], true.over.values, 1.0, "over")
    largest = {}
    for one in expected["series"]:
        largest[one["unit"]] = max(
            largest.get(one["unit"], 0.0), np.nanmax(np.abs(array(one["values"])))
        )
    for one, (name, values, places) in zip(expected["series"], found["series"], strict=True):
        assert name == one["name"]
        if one["group"] == "certificate":
            assert set(values) == {None}
            continue
        exact = array(one["values"])
        near(values, exact, max(np.abs(exact).max(), 1e-3 * largest[one["unit"]]), name)
        if places is not None:
            law = true.section(one["part"]).law
            force = name.rpartition(":")[2]
            # At a station that is off by rounding, either side may be meant.
            about = [
                np.clip(np.array(places)[:, None] + off, 0.0, 1.0) for off in (-1e-10, 0.0, 1e-10)
            ]
            there = np.stack([law.at(force, u)[:, 0] for u in about])
            assert np.abs(there - exact).min(axis=0).max() <= 1e-8 * max(
                np.abs(exact).max(), 1e-3 * largest[one["unit"]]
            )
    for body, columns in zip(expected["bodies"], found["poses"], strict=True):
        for number, column in zip(body["pose"], columns, strict=True):
            near(column, array(number), 1.0, body["name"])
    rows = {row["name"]: row for row in found["rows"]}
    for row in expected["rows"]:
        for end in () if row["open"] else ("peak", "smallest", "largest"):
            scale = max(abs(row["peak"]["value"]), 1e-3 * largest[row["unit"]])
            near([rows[row["name"]][end]["value"]], [row[end]["value"]], scale, (row["name"], end))
        for mean in ("mean", "rms"):
            if row[mean] is not None:
                near([rows[row["name"]][mean]], [row[mean]], scale, (row["name"], mean))
    for link, forces in found["forces"]:
        for force, columns in forces:
            law = true.section(link).law
            for ratio, column in zip((0.0, 0.21, 0.5, 1.0), columns, strict=True):
                exact = law.on_grid(force, np.array([ratio]))[:, 0]
                near(
                    column,
                    exact,
                    max(law.bound(force, np.linspace(0, 1, 5)), 1e-3 * largest["N"]),
                    (link, force),
                )
    parts = [expected[name] for name in ("bodies", "joints", "loads", "paths")]
    for mine, others in zip(found["picture"], parts, strict=True):
        for one, other in zip(mine, others, strict=True):
            for key in other.keys() - {"pose", "plates"}:
                alike(one[key], other[key], (other["name"], key))
            for plate, exact in zip(one.get("plates", ()), other.get("plates", ()), strict=True):
                alike(*(sorted(p, key=_rounded) for p in (plate, exact)), other["name"])
    # While a slider moves, not all is looked for: every end of the cycle is the same, to the last
    # bit.
    rows_of = (
        "(() => {{ window.page.live.engine.show({}, {}); return window.page.contents.rows; }})()"
    )
    quick, whole = (
        chromium.run(rows_of.format(json.dumps(list(moving.values())), asked))
        for asked in ("false", "true")
    )
    assert quick == whole
    assert quick != found["rows"]
    assert chromium.complaints == []


def _rounded(corner):
    return np.round(corner, 9).tolist()


def alike(one, other, what):
    """Two texts of JSON with the same numbers, but for rounding."""
    number = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")
    texts = [json.dumps(json.loads(json.dumps(value)), sort_keys=True) for value in (one, other)]
    assert len({number.sub("#", text) for text in texts}) == 1, (what, texts)
    np.testing.assert_allclose(
        *([float(x) for x in number.findall(text)] for text in texts),
        rtol=0,
        atol=1e-12,
        err_msg=str(what),
    )


TABLE = (
    "[...document.querySelectorAll('.table')].find((one) => one.querySelector('h2').textContent ==="
    " 'Peaks')"
)


def peaks(one):
    one.run(f"{TABLE}.querySelector('.copy').click()")
    return {
        row["name"]: row["largest in size"]
        for row in csv.DictReader(io.StringIO(one.run("window.copied")))
    }


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
        load_case(CASES / "slider_crank").scene,
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


DRAG = """(async () => {
  const add = document.querySelector('.card .curves');
  add.value = 'section:rod:bending';
  add.dispatchEvent(new Event('change'));
  const field = document.querySelector('.sliders [type=range]');
  const pictures = () => [...document.querySelectorAll('canvas')].map((one) => one.toDataURL());
  const shown = () => [document.querySelector('.cards').innerHTML, ...pictures()];
  const seen = [];
  const inSight = (one) => one.getBoundingClientRect().top < window.innerHeight;
  const lines = (card) => [...card.querySelectorAll('.curve[d]')].map((one) => one.getAttribute('d'));
  const curves = () => [...document.querySelectorAll('.card')].filter(inSight).flatMap(lines);
  const before = curves();
  for (let k = 0; k < 12; k += 1) {
    field.value = 0.08;
    field.dispatchEvent(new Event('input'));
    await new Promise((done) => requestAnimationFrame(done));
  }
  const moved = curves().map((d, k) => d !== before[k]);
  for (const way of [[0.06, 0.075, 0.09, 0.08, 0.085], [0.085]]) {
    for (const value of way) {
      field.value = value;
      field.dispatchEvent(new Event('input'));
      await new Promise((done) => requestAnimationFrame(done));
    }
    await new Promise((done) => setTimeout(done, 400));
    field.dispatchEvent(new Event('change'));
    await new Promise((done) => setTimeout(done, 100));
    seen.push(shown());
    field.value = 0.1;
    field.dispatchEvent(new Event('input'));
    await new Promise((done) => setTimeout(done, 400));
  }
  return [...seen, shown(), moved];
})()"""  # noqa: E501


def test_a_slider_that_rests_leaves_all_of_its_design(crank):
    """Charts, maps and the picture follow in turn while it moves; at rest none is left behind,
    whatever the way was.
    """
    slow, at_once, other, moved = crank().run(DRAG)
    assert moved
    assert all(moved)
    assert slow == at_once
    assert len(slow) == len(other) > 2
    assert [one != changed for one, changed in zip(slow, other, strict=True)] == [True] * len(slow)


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


def test_functions_that_a_browser_lacks_are_those_of_c(chromium, tmp_path):
    """To the last bit, signs of zero too: none of them rounds."""
    scene, asked = case("slider_crank", 3)
    live = Live.of(scene, scene.timing(**asked), ["motion"], "run")
    alive.opened(
        chromium, tmp_path / "live.html", page(evaluate(scene, wanted=["motion"], **asked), live)
    )
    rng = np.random.default_rng(5)
    ends = [1.0, -1.0, 2.5, 0.5, 1e300, -5e-324]
    pairs = [(x, y) for x in (0.0, -0.0, *ends) for y in ends]
    pairs += (10 ** rng.uniform(-9, 9, (300, 2))).tolist()
    pairs += [(k * y / 2, y) for k in range(-9, 10) for y in (0.1, -math.tau)]
    told = "(value) => (Object.is(value, -0) ? '-0' : String(value))"
    for name, exact in (("fmod", math.fmod), ("remainder", math.remainder)):
        of = f"{json.dumps(pairs)}.map(([x, y]) => window.page.C.{name}(x, y)).map({told})"
        found = [float(word).hex() for word in chromium.run(of)]
        assert found == [exact(x, y).hex() for x, y in pairs]
    for name, exact in (("fmin", [1, 1, 1, 1]), ("fmax", [2, 2, 1, 1])):
        of = f"[[1, 2], [2, 1], [NaN, 1], [1, NaN]].map(([x, y]) => window.page.C.{name}(x, y))"
        assert chromium.run(of) == exact


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
