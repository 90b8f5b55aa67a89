"""Reports: a page holds the numbers of its solutions to the last bit, no name of a user is markup,
and the page is whole or not there.
"""

import html
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from commands import command
from reports import HOSTILE, held, hostile, page, press, snowed, solved
from strong import slider

from lagrange_casadi import evaluate, load_case, save, sweep
from lagrange_casadi.errors import DeclarationError


def test_no_name_is_markup():
    text = page(hostile())
    found, _ = held(text)
    assert {part["name"] for part in (*found["joints"], *found["bodies"])} >= set(HOSTILE)
    assert found["case"] == found["parameters"][0]["unit"] == HOSTILE[0]
    assert text.count("<script") == text.count("</script") == 2
    assert "<!--" not in text
    assert "<img" not in text


def test_a_map_is_the_solutions_grid_and_peak():
    asked = {"wanted": ["all", "stress:rod"], "backend": "vm", "certificate": False}
    solution = evaluate(slider(), **asked)
    text = page(solution)
    found, array = held(text)
    kinds = [f"{kind}:{link}" for kind in ("stress", "deflection") for link in ("crank", "rod")]
    assert [one["name"] for one in found["maps"]] == kinds
    peaks = (solution.stress("rod").peak("von_mises"), solution.deflection("rod").peak())
    maps = [one for one in found["maps"] if one["link"] == "rod"]
    for one, exact in zip(maps, peaks, strict=True):
        told = [one["peak"][key] for key in ("value", "t", "xi")]
        assert told == pytest.approx([exact.value, exact.t, exact.xi], rel=1e-9)
    assert maps[0]["where"] == peaks[0].fibre
    xi = np.linspace(0, 1, len(array(maps[0]["xi"])))
    grids = (
        solution.stress("rod").grid("von_mises", xi),
        solution.deflection("rod").grid("across", xi),
    )
    for one, grid in zip(maps, grids, strict=True):
        values = array(one["values"]).reshape(grid.shape)
        np.testing.assert_allclose(values, grid, rtol=0, atol=1e-12 * np.abs(grid).max())


@pytest.mark.parametrize("space", [False, True])
def test_a_page_says_how_large_loads_are(space):
    solution = snowed(space)
    found, _ = held(page(solution))
    for load in ("load:push:resultant", "load:snow:resultant"):
        (row,) = (row for row in found["rows"] if row["name"] == load)
        assert row["peak"]["value"] == solution.peak(load).value > 0.0
        assert load in [series["name"] for series in found["series"]]


def test_a_view_is_the_report_in_a_frame_that_reaches_nothing_else():
    solution = press()
    found = solution.view(500)
    (srcdoc,) = re.findall(r'srcdoc="([^"]*)"', found._repr_html_())
    assert html.unescape(srcdoc) == page(solution)
    assert 'sandbox="allow-scripts allow-modals"' in found._repr_html_()
    assert 'height="500"' in found._repr_html_()
    assert (
        repr(found)
        == "<View of press: a notebook shows it; solution.report('press.html') writes it>"
    )
    peak = solution.peak("effort:O")
    for told in ("<svg", "<b>press</b>", f"{peak.value:.5g} N m", f"{peak.t:.5g} s"):
        assert told in solution._repr_html_()
    for height in (0, -1, 2.5, True, "tall"):
        with pytest.raises(DeclarationError, match=r"expected a (whole number|height in points)"):
            solution.view(height)
    with pytest.raises(DeclarationError, match="want motion too"):
        press(wanted=("effort",)).view()


@pytest.mark.parametrize("name", ["four_bar", "excavator", "rssr", "bricard"])
def test_a_page_holds_the_solution_to_the_last_bit(name):
    """Its series, and in rows its peaks, means and errors; what is open has no number."""
    solution = solved(name)
    found, array = held(page(solution))
    np.testing.assert_array_equal(array(found["instants"]["t"]), solution.t)
    charted = {series["name"]: series for series in found["series"]}
    rows = {row["name"]: row for row in found["rows"]}
    assert found["undetermined"] == list(solution.undetermined)
    assert {name for name, row in rows.items() if row["open"]} == {
        name for name in rows if not solution.determined(name)
    }
    assert bool(solution.undetermined) is (name == "bricard")
    for output in solution.quantities():
        row, known = rows.get(str(output)), solution.determined(output)
        assert (str(output) in charted) is known
        assert row or output.group not in ("effort", "reaction", "section")
        if known:
            series, (values, places) = charted[str(output)], solution.extremes(output)
            np.testing.assert_array_equal(array(series["values"]), values)
            assert (series["unit"], series["places"] is None) == (
                solution.unit(output),
                places is None,
            )
        if known and row:
            peak, own = solution.peak(output), solution.statistics(output)
            told = [row["peak"][key] for key in ("value", "t", "xi", "over")]
            assert told == [peak.value + 0.0, peak.t, peak.xi, peak.over]
            told = (row["mean"], row["rms"], row["smallest"]["value"])
            assert told == (own.mean, own.rms, own.smallest.value + 0.0)
            assert row["error"] == pytest.approx(solution.errors.get(str(output), row["error"]))


def test_more_instants_than_fit_are_thinned_for_pictures_and_never_for_numbers(here, capsys):
    scene = load_case("four_bar").scene
    solution = evaluate(scene, t=(*scene.span, 20_001), wanted=["all"], certificate=False)
    found, array = held(page(solution))
    told, shown = found["instants"], set(array(found["instants"]["t"]))
    assert (told["total"], 30 <= told["shown"] < 20_001) == (20_001, True)
    for row in found["rows"]:
        assert row["peak"]["value"] == solution.peak(row["name"]).value + 0.0
        assert {row["peak"]["t"], row["smallest"]["t"]} <= shown
    save(solution, "bar.h5")
    assert command("report bar.h5") == 0
    note = f"note: pictures and charts show {told['shown']} of 20001 instants, which"
    assert note in capsys.readouterr().err


REFUSED = {
    "effort.h5": "there is no motion of 'crank', 'rod', 'ram'; want motion too",
    "press.h5 --t 0:1:5": "go with a case, not with a file",
    "press.h5 --out press.png": "expected a name that ends in .html or .htm",
    "press.h5 --out nowhere/x.html": "folder nowhere does not exist",
    "other.h5": "no such file",
    "press.h5 --beside l=0.3": "--beside goes with one case",
    "press.h5 press.h5 press.h5": "expected one or two of FILE.h5 and CASE",
    "CASE --live --beside l=0.3": "--live goes with one case",
    "press.h5 effort.h5 --set l=0.2": "--set, --t, --over, --want and --live go",
    "CASE --case four_bar": "--case goes with a sweep's file",
}


def test_the_command_takes_a_file_or_a_case(here, capsys):
    """The page of a file is that of its solution; one whose certificate fails says so, and so does
    the status.
    """
    solution = press()
    save(solution, "press.h5")
    save(press(wanted=("effort",)), "effort.h5")
    assert command("report press.h5") == 0
    assert capsys.readouterr().out == "wrote press.html: open it in a browser\n"
    solution.report("again.html")
    assert Path("press.html").read_bytes() == Path("again.html").read_bytes()
    assert command("report four_bar --t 0:1:5 --out bar.html --want effort --set a=0.11") == 0
    found, _ = held(Path("bar.html").read_text())
    assert found["instants"]["total"] == 5
    assert {series["group"] for series in found["series"]} >= {"effort", "motion"}
    assert next(one for one in found["parameters"] if one["name"] == "a")["value"] == 0.11
    wrong = {**solution.certificate, "balance": np.full(solution.t.size, 0.5)}
    save(replace(solution, certificate=wrong), "wrong.h5")
    capsys.readouterr()
    assert command("report wrong.h5") == 1
    assert "the certificate fails: balance 0.5" in capsys.readouterr().err
    certificate = held(Path("wrong.html").read_text())[0]["certificate"]
    assert (certificate["state"], "balance 0.5" in certificate["words"]) == ("failed", True)
    before = sorted(here.iterdir())
    for words, told in REFUSED.items():
        assert command(f"report {words}") == 2
        assert told in capsys.readouterr().err
    assert sorted(here.iterdir()) == before


def test_one_instant_and_values_that_are_no_numbers_are_json():
    certificate = {"balance": np.array([np.inf])}
    found, _ = held(page(replace(press(t=(0.1, 0.1, 1)), certificate=certificate)))
    assert found["instants"]["total"] == 1
    assert [one["largest"] for one in found["certificate"]["residuals"]] == [None]
    json.dumps(found, allow_nan=False)


def test_a_page_of_two_designs_holds_both(here):
    """Their numbers are those of the solutions; they are named by the parameter that differs, or by
    their files.
    """
    asked, scene = {"wanted": ["all"], "t": (0, 0.08, 41)}, load_case("slider_crank").scene
    solutions = [evaluate(scene, parameters={"l": l}, **asked, backend="vm") for l in (0.2, 0.3)]
    solutions[0].report("both.html", beside=solutions[1])
    found, array = held(Path("both.html").read_text())
    assert [run["name"] for run in found["runs"]] == ["l = 0.2", "l = 0.3"]
    for name, solution, run in zip(("a", "b"), solutions, found["runs"], strict=True):
        effort = next(one for one in run["series"] if one["name"] == "effort:O")
        np.testing.assert_array_equal(array(effort["values"]), solution.effort("O"))
        save(solution, f"{name}.h5")
    rows = {row["name"]: row["values"] for row in found["rows"]}
    for name in ("effort:O", "reaction:A:resultant", "section:rod:bending"):
        assert rows[name] == [solution.peak(name).value for solution in solutions]
    assert command("report a.h5 b.h5") == 0
    found, _ = held(Path("a_and_b.html").read_text())
    assert [run["name"] for run in found["runs"]] == ["a", "b"]
    assert command("report slider_crank --t 0:0.08:5 --set r=0.08 --beside l=0.25") == 0
    found, _ = held(Path("slider_crank_beside.html").read_text())
    values = [[run["parameters"][name][0] for name in "lr"] for run in found["runs"]]
    assert values == [[0.2, 0.08], [0.25, 0.08]]


@pytest.mark.parametrize("kind", ["effort", "friction", "load", "motion", "reaction"])
def test_the_page_of_a_sweep_has_the_mechanism_with_what_was_wanted(kind, here):
    scene = load_case("screw_lift").scene
    found = sweep(scene, {"mu": (0.1, 0.12, 2)}, out="lift.h5", wanted=[kind], workers=1)
    found.report("lift.html", scene)
    assert rf"{{\"name\":\"{kind}:" in Path("lift.html").read_text()
