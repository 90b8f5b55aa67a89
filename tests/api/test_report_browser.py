"""Reports in a real browser, from files and without a network: they open, move, and show the file's
numbers to the digits shown.
"""

import csv
import io
import re
from dataclasses import replace

import alive
import browser
import numpy as np
import pytest
import strong
from drawn_scenes import every_kind
from internals import Output
from reports import HOSTILE, hostile, press, solved

from lagrange_casadi import evaluate

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


def test_readable_units_are_the_same_numbers(page):
    solution = solved("excavator")
    one = page(solution)
    efforts = {
        part: value.split(" ")
        for part, quantity, value, *_ in shown(one, "Peaks")[1]
        if quantity == "effort"
    }
    assert len(efforts) == 3
    for part, (value, unit) in efforts.items():
        assert unit == "kN"
        assert number(value) == to_digits(1e-3 * solution.peak(f"effort:{part}").value, 6)


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
    for across, down in ((0.3, 0.4), (0.6, 0.25), (0.75, 0.7)):
        head, lines = hovered(one, "map", across, down)
        i, xi = instant_of(solution, head), float(re.search(r"ξ/l = ([\d.]+)", head)[1])
        law = solution.section(link).law
        for force in solution.table.forces:
            value, unit = lines[Output("section", link, force).meant(solution.table).long_name]
            expected = law.during(slice(i, i + 1)).on_grid(force, np.array([xi]))[0, 0]
            least = 1e-12 * law.bound(force, np.array([xi]))
            prefix = unit[0] if unit[0] in FACTORS else ""
            assert value * FACTORS[prefix] == pytest.approx(expected, rel=1e-4, abs=least)
    quiet(one)


def test_a_map_of_stress_tells_the_solutions_stress_and_where_it_is_largest(page):
    solution = evaluate(
        strong.slider(), wanted=["all", "stress:rod"], backend="vm", certificate=False
    )
    one = page(solution)
    card = (
        "[...document.querySelectorAll('.card')].find((one) =>"
        " one.querySelectorAll('select')[1]?.value === 'stress')"
    )
    one.run(
        f"{{ const list = {card}.querySelector('select'); list.value = 'rod';"
        " list.dispatchEvent(new Event('change')); }"
    )
    stress = solution.stress("rod")
    peak = stress.peak("von_mises")
    words = one.run(f"{card}.querySelector('.peak-button').textContent").translate({0xA0: " "})
    place = f"ξ/l = {peak.xi:.3g}, t = {to_digits(1e3 * peak.t, 5):g} ms, {peak.fibre}"
    assert words == f"largest: {to_digits(peak.value / 1e6, 5):g} MPa at {place}"
    one.run(
        f"document.querySelectorAll('.map').forEach((map) => map.closest('.card') === {card} ||"
        " map.closest('.card').remove())"
    )
    head, lines = hovered(one, "map", 0.5, 0.4)
    i, xi = instant_of(solution, head), float(re.search(r"ξ/l = ([\d.]+)", head)[1])
    value, unit = lines["von Mises' stress"]
    expected = stress.grid("von_mises", np.array([xi]))[i, 0]
    assert value * FACTORS[unit[0]] == pytest.approx(expected, rel=1e-4)
    quiet(one)


def test_a_polar_plot_tells_a_bearings_load_in_ground_axes_and_on_a_body(page):
    solution = solved("slider_crank")
    one = page(solution)
    joint = one.run(
        "document.querySelector('.polar').closest('.card').querySelector('select').value"
    )
    reaction = solution.reaction(joint)
    head, lines = hovered(one, "polar", 0.45, 0.5)
    i = instant_of(solution, head)
    assert {name: lines[name][0] for name in ("fx", "fy")} == pytest.approx(
        {"fx": reaction.fx[i], "fy": reaction.fy[i]}, rel=1e-4
    )
    one.run(
        "{ const ways ="
        " document.querySelector('.polar').closest('.card').querySelectorAll('select')[1];"
        " ways.value = '1'; ways.dispatchEvent(new Event('change')); }"
    )
    body = (
        one.run("document.querySelector('.polar').getAttribute('aria-label')")
        .split(" on ")[1]
        .split(",")[0]
    )
    head, lines = hovered(one, "polar", 0.45, 0.5)
    i = instant_of(solution, head)
    turned = (reaction.fx[i] + 1j * reaction.fy[i]) * np.exp(-1j * solution.pose(body).angle[i])
    assert [lines[name][0] for name in ("along", "across")] == pytest.approx(
        [turned.real, turned.imag], rel=1e-4, abs=1e-4 * abs(turned)
    )
    quiet(one)


def test_a_mechanism_in_space_is_turned_and_seen_from_the_front(page):
    one = page(solved("rssr"))
    picture = "document.querySelector('.picture').toDataURL()"
    seen = [one.run(picture)]
    left, top = (
        one.run(f"document.querySelector('.picture').getBoundingClientRect().{side}")
        for side in ("left", "top")
    )
    one.point(left + 200, top + 100, "mousePressed", button="left", clickCount=1)
    one.point(left + 260, top + 120, button="left", buttons=1)
    one.point(left + 260, top + 120, "mouseReleased", button="left", clickCount=1)
    seen.append(one.run(picture))
    for key in "234":
        one.press(key, key)
        seen.append(one.run(picture))
    one.press("1", "1")
    assert len(set(seen)) == 5
    assert one.run(picture) == seen[0]
    quiet(one)


def test_two_fingers_move_and_zoom(page):
    one = page(press())
    picture = "document.querySelector('.picture').toDataURL()"
    left, top = (
        one.run(f"document.querySelector('.picture').getBoundingClientRect().{side}")
        for side in ("left", "top")
    )
    before = one.run(picture)
    for kind, *spots in (("Start", 100, 200), ("Move", 80, 240), ("Move", 60, 280), ("End",)):
        one.call(
            "Input.dispatchTouchEvent",
            type=f"touch{kind}",
            touchPoints=[{"x": left + x, "y": top + 120} for x in spots],
        )
    assert one.run(picture) != before
    one.run(
        "[...document.querySelectorAll('.views button')].find((one) => one.textContent ==="
        " 'Fit').click()"
    )
    assert one.run(picture) == before
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


@pytest.mark.sampled(3)
@pytest.mark.parametrize("width", [390, 1000, 1920])
def test_nothing_is_wider_than_the_window_and_it_prints(page, tmp_path, width):
    one = page(press())
    one.size(width, 800)
    assert (
        one.run(
            "new Promise((done) => requestAnimationFrame(() =>"
            " done(document.documentElement.scrollWidth)))"
        )
        <= width
    )
    if width == 1000:
        for paper in ((8.27, 11.69), (8.5, 11.0)):
            assert one.printed(tmp_path / "report.pdf", *paper).startswith(b"%PDF")
    quiet(one)


def test_a_largest_moment_is_found_at_a_glance_and_its_section_shown(page):
    solution = solved("slider_crank")
    one = page(solution)
    one.run(
        "[...document.querySelectorAll('.tile')].find((tile) =>"
        " tile.textContent.includes('bending')).click()"
    )
    peak = max(
        (solution.peak(f"section:{link}:bending") for link in ("crank", "rod")),
        key=lambda peak: abs(peak.value),
    )
    readout = one.run("document.querySelector('.readout').textContent.replaceAll('\\u00a0', ' ')")
    assert readout == f"t = {to_digits(1e3 * peak.t, 5):g} ms"
    assert f"ξ/l = {peak.xi:.3g}" in one.run("document.querySelector('.ratio').textContent")
    quiet(one)


@pytest.mark.parametrize(("width", "height", "scheme"), [(1400, 900, "light"), (1000, 700, "dark")])
def test_the_largest_moment_in_the_rod_is_found_by_keyboard_alone(page, width, height, scheme):
    """By its words, and by the list of links of the map: value, instant and section are told, and
    shown.
    """
    solution = solved("slider_crank")
    peak = solution.peak("section:rod:bending")
    one = page(solution)
    one.size(width, height)
    one.prefer(prefers_reduced_motion="reduce", prefers_color_scheme=scheme)
    one.press("/", "/")
    for letter in "rod bending":
        one.press(letter, letter)
    _, rows = shown(one, "Peaks")
    assert [row[:2] for row in rows] == [["rod", "bending moment"]]
    assert (number(rows[0][2]), rows[0][4]) == (
        to_digits(peak.value, 6),
        f"{to_digits(1e3 * peak.t, 5):g} ms",
    )
    one.press("Enter", "\r")
    when = f"t = {to_digits(1e3 * peak.t, 5):g} ms"
    assert (
        one.run("document.querySelector('.readout').textContent.replaceAll('\\u00a0', ' ')") == when
    )
    # The nearest of the ratios that the link is evaluated at.
    near = solution.xi[np.abs(solution.xi - peak.xi).argmin()]
    assert f"ξ/l = {near:.3g}" in one.run("document.querySelector('.ratio').textContent")
    one.run(
        "{ const list = document.querySelector('.map').closest('.card').querySelector('select');"
        " list.value = 'rod'; list.dispatchEvent(new Event('change')); }"
    )
    told = one.run("document.querySelector('.peak-button').textContent").translate(
        {0x2212: "-", 0xA0: " "}
    )
    assert told == f"largest: {to_digits(peak.value, 5)} N·m at ξ/l = {peak.xi:.3g}, {when}"
    one.prefer(prefers_reduced_motion="reduce", prefers_color_scheme="light")
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


def test_what_is_the_same_but_for_rounding_is_a_level_line(page):
    """No steps of an axis are so small that doubles cannot count them."""

    def jittered(output, values):
        return (
            np.where(np.arange(values.size) % 2, np.nextafter(values, np.inf), values)
            if output.member == "rate"
            else values
        )

    one = page(changed(jittered))
    lists = "document.querySelector('.cards .card').querySelectorAll('select')"
    for k in (0, 1):
        one.run(
            f"{{ const list = {lists}[{k}]; list.value = 'motion:O_rate'; list.dispatchEvent(new"
            " Event('change')); }"
        )
    ticks = one.run(
        "[...document.querySelectorAll('.card:first-child .axes text')].map((text) =>"
        " text.textContent)"
    )
    assert "10" in ticks or "100" in ticks
    assert len(ticks) < 40
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


def test_no_row_of_what_is_largest_hides_behind_a_scroll_bar(page):
    """On a screen, on a telephone, and on paper."""
    one = page(solved("excavator"))
    hidden = (
        "(() => { const box = document.querySelector('.links .scroll'); return [box.scrollHeight -"
        " box.clientHeight, document.querySelectorAll('.links tbody tr').length]; })()"
    )
    for width, media in ((1400, ""), (400, ""), (700, "print")):
        one.size(width, 900)
        one.call("Emulation.setEmulatedMedia", media=media)
        over, rows = one.run(hidden)
        assert over <= 0
        assert rows > 4
    one.call("Emulation.setEmulatedMedia", media="")
    one.size(1400, 900)
    quiet(one)
