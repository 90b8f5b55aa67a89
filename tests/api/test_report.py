"""Reports: a page holds the numbers of its solutions to the last bit, no name of a user is markup,
and the page is whole or not there.
"""

import functools
import html
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from commands import command
from reports import HOSTILE, held, hostile, page, press, snowed, solved, wound
from strong import slider

from lagrange_casadi import (
    Mechanism,
    Scene,
    evaluate,
    load,
    load_case,
    save,
)
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, PathError
from lagrange_casadi.motion import polynomial


@pytest.mark.parametrize("name", ["four_bar", "excavator", "rssr"])
def test_charts_hold_the_solution_to_the_last_bit(name):
    solution = solved(name)
    found, array = held(page(solution))
    np.testing.assert_array_equal(array(found["instants"]["t"]), solution.t)
    charted = {series["name"]: series for series in found["series"]}
    for output in solution.quantities():
        if solution.determined(output):
            series = charted[str(output)]
            values, places = solution.extremes(output)
            np.testing.assert_array_equal(array(series["values"]), values)
            assert series["unit"] == solution.unit(output)
            assert (places is None) == (series["places"] is None)


LAWS = {
    name: functools.partial(solved, name)
    for name in ("quick_return", "excavator", "engine", "rssr", "delta")
}


LAWS["couples of slices"] = lambda: evaluate(wound(), backend="vm")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("what", [*LAWS, "loads along a link", "loads along a link in space"])
def test_the_section_law_of_a_page_is_that_of_the_solution(what):
    """Summed up as the viewer does: terms, and what acts beyond a section at stations, which may
    slide.
    """
    solution = LAWS[what]() if what in LAWS else snowed(what.endswith("space"))
    found, array = held(page(solution))
    assert [entry["link"] for entry in found["sections"]] == list(solution.links_with_sections)
    for entry in found["sections"]:
        law, xi, forces = solution.section(entry["link"]).law, array(entry["xi"]), {}
        for force in entry["forces"]:
            values = sum(sign * np.outer(array(k), array(row)) for k, row, sign in force["terms"])
            for acting in entry["loads"] if force["terms"] else ():
                station = array(acting["station"])[:, None]
                push = array(acting[force["acting"]])[:, None] + 0.0 * xi
                if force["arm"]:
                    push = push + force["arm"] * entry["length"] * array(acting[force["across"]])[
                        :, None
                    ] * (station - xi)
                values = values + np.where(
                    (xi < station) | ((xi >= 1.0) & (station >= 1.0)), push, 0.0
                )
            forces[force["name"]] = (
                np.hypot(*(forces[part] for part in force["parts"])) if force["parts"] else values
            )
            expected = law.on_grid(force["name"], xi)
            scale = max(law.bound(force["name"], xi), 1e-300)
            np.testing.assert_allclose(forces[force["name"]], expected, rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize("name", ["four_bar", "rssr"])
def test_rows_are_the_solutions_peaks_means_and_errors(name):
    solution = solved(name)
    found, _ = held(page(solution))
    rows = {row["name"]: row for row in found["rows"]}
    assert {
        str(output)
        for output in solution.quantities()
        if output.group in ("effort", "reaction", "section")
    } <= rows.keys()
    for name, row in rows.items():
        peak, own = solution.peak(name), solution.statistics(name)
        assert [row["peak"][key] for key in ("value", "t", "xi", "over")] == [
            peak.value + 0.0,
            peak.t,
            peak.xi,
            peak.over,
        ]
        assert (row["mean"], row["rms"], row["smallest"]["value"]) == (
            own.mean,
            own.rms,
            own.smallest.value + 0.0,
        )
        assert (
            row["error"] == pytest.approx(solution.errors[name])
            if name in solution.errors
            else True
        )


def test_what_is_open_is_said_and_has_no_number():
    solution = solved("bricard", 9)
    assert solution.undetermined
    found, _ = held(page(solution))
    assert found["undetermined"] == list(solution.undetermined)
    told = {row["name"] for row in found["rows"] if row["open"]}
    assert (
        told
        == {row["name"] for row in found["rows"] if not solution.determined(row["name"])}
        != set()
    )
    assert not told & {series["name"] for series in found["series"]}


def test_more_instants_than_fit_are_thinned_for_pictures_and_never_for_numbers(tmp_path, capsys):
    scene = load_case("four_bar").scene
    solution = evaluate(scene, t=(*scene.span, 20_001), wanted=["all"], certificate=False)
    found, array = held(page(solution))
    told = found["instants"]
    assert told["total"] == 20_001
    assert 30 <= told["shown"] < 20_001
    shown = set(array(told["t"]))
    for row in found["rows"]:
        assert row["peak"]["value"] == solution.peak(row["name"]).value + 0.0
        assert row["peak"]["t"] in shown
        assert row["smallest"]["t"] in shown
    save(solution, tmp_path / "bar.h5")
    assert main(["report", str(tmp_path / "bar.h5"), "--out", str(tmp_path / "bar.html")]) == 0
    note = f"note: pictures and charts show {told['shown']} of 20001 instants, which"
    assert note in capsys.readouterr().err


def test_a_page_is_the_same_from_a_file_and_each_time(tmp_path):
    solution = press()
    save(solution, tmp_path / "press.h5")
    load(tmp_path / "press.h5").report(tmp_path / "press.html")
    solution.report(tmp_path / "again.html")
    assert (tmp_path / "press.html").read_bytes() == (tmp_path / "again.html").read_bytes()


def test_no_name_is_markup():
    text = page(hostile())
    found, _ = held(text)
    assert {part["name"] for part in (*found["joints"], *found["bodies"])} >= set(HOSTILE)
    assert found["case"] == found["parameters"][0]["unit"] == HOSTILE[0]
    assert text.count("<script") == text.count("</script") == 2
    assert "<!--" not in text
    assert "<img" not in text


def test_without_motion_it_says_what_to_want(tmp_path, capsys):
    solution = press(wanted=("effort",))
    with pytest.raises(
        DeclarationError, match="there is no motion of 'crank', 'rod', 'ram'; want motion too"
    ):
        page(solution)
    save(solution, tmp_path / "press.h5")
    assert main(["report", str(tmp_path / "press.h5"), "--out", str(tmp_path / "press.html")]) == 2
    assert "want motion too" in capsys.readouterr().err
    assert not (tmp_path / "press.html").exists()


def test_a_file_that_is_there_is_replaced_whole_or_not_at_all(tmp_path, monkeypatch):
    target = tmp_path / "press.html"
    target.write_text("before")
    solution = press()
    with monkeypatch.context() as patch:
        patch.setattr(
            "os.replace", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device"))
        )
        with pytest.raises(Exception, match="No space left"):
            solution.report(target)
    assert target.read_text() == "before"
    solution.report(target)
    assert target.read_text().startswith("<!doctype html>")
    assert [path.name for path in tmp_path.iterdir()] == ["press.html"]
    with pytest.raises(PathError, match="does not exist"):
        solution.report(tmp_path / "nowhere" / "press.html")
    with pytest.raises(DeclarationError, match=r"expected a name that ends in \.html or \.htm"):
        solution.report(tmp_path / "press.pdf")


def test_the_command_takes_a_file_or_a_case(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    solution = press()
    save(solution, "press.h5")
    assert main(["report", "press.h5"]) == 0
    assert capsys.readouterr().out == "wrote press.html: open it in a browser\n"
    assert command("report four_bar --t 0:1:5 --out bar.html --want effort --set a=0.11") == 0
    found, _ = held((tmp_path / "bar.html").read_text())
    assert found["instants"]["total"] == 5
    assert {series["group"] for series in found["series"]} >= {"effort", "motion"}
    assert next(one for one in found["parameters"] if one["name"] == "a")["value"] == 0.11
    capsys.readouterr()
    for arguments, told in (
        (["press.h5", "--t", "0:1:5"], "go with a case, not with a file"),
        (["press.h5", "--out", "press.png"], "expected a name that ends in .html or .htm"),
        (["other.h5"], "no such file"),
    ):
        assert main(["report", *arguments]) == 2
        assert told in capsys.readouterr().err


def test_a_certificate_that_fails_is_in_the_page_and_in_the_status(tmp_path, capsys):
    solution = press()
    wrong = replace(
        solution, certificate={**solution.certificate, "balance": np.full(solution.t.size, 0.5)}
    )
    save(wrong, tmp_path / "press.h5")
    assert main(["report", str(tmp_path / "press.h5"), "--out", str(tmp_path / "press.html")]) == 1
    assert "the certificate fails: balance 0.5" in capsys.readouterr().err
    found, _ = held((tmp_path / "press.html").read_text())
    assert found["certificate"]["state"] == "failed"
    assert "balance 0.5" in found["certificate"]["words"]


def test_one_instant_and_values_that_are_no_numbers_are_json():
    solution = press(t=(0.1, 0.1, 1))
    text = page(replace(solution, certificate={"balance": np.array([np.inf])}))
    found = held(text)[0]
    assert found["instants"]["total"] == 1
    (residual,) = found["certificate"]["residuals"]
    assert residual["largest"] is None
    json.dumps(found, allow_nan=False)


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
    first.report(again, beside=second)
    assert again.read_bytes() == (tmp_path / "both.html").read_bytes()


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


def test_a_map_is_the_solutions_grid_and_peak():
    asked = {"wanted": ["all", "stress:rod"], "backend": "vm", "certificate": False}
    solution = evaluate(slider(), **asked)
    text = page(solution)
    found, array = held(text)
    kinds = [f"{kind}:{link}" for kind in ("stress", "deflection") for link in ("crank", "rod")]
    assert [one["name"] for one in found["maps"]] == kinds
    stress, bent = (one for one in found["maps"] if one["link"] == "rod")
    exact = solution.stress("rod").peak("von_mises")
    assert (stress["peak"]["value"], stress["peak"]["t"], stress["peak"]["xi"]) == (
        exact.value,
        exact.t,
        exact.xi,
    )
    assert stress["where"] == exact.fibre
    largest = solution.deflection("rod").peak()
    assert bent["peak"]["t"] == largest.t
    assert [bent["peak"]["value"], bent["peak"]["xi"]] == pytest.approx(
        [largest.value, largest.xi], rel=1e-9
    )
    xi = np.linspace(0, 1, len(array(stress["xi"])))
    grids = [
        solution.stress("rod").grid("von_mises", xi),
        solution.deflection("rod").grid("across", xi),
    ]
    for one, grid in zip((stress, bent), grids, strict=True):
        np.testing.assert_array_equal(array(one["t"]), solution.t)
        np.testing.assert_array_equal(array(one["xi"]), xi)
        values = array(one["values"]).reshape(grid.shape)
        np.testing.assert_allclose(values, grid, rtol=0, atol=1e-12 * np.abs(grid).max())


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
    for height in (0, -1, 2.5, True, "tall"):
        with pytest.raises(DeclarationError, match=r"expected a (whole number|height in points)"):
            solution.view(height)
    with pytest.raises(DeclarationError, match="want motion too"):
        press(wanted=("effort",)).view()


def test_a_scene_that_cannot_be_assembled_is_told_without_a_drawing():
    m = Mechanism("open")
    crank, rod = m.link("crank", length=0.1, mass=1.0), m.link("rod", length=0.5, mass=1.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.slot("guide", m.ground.at(0, 2), rod.tip, axis=(1, 0))
    text = Scene(m, motion={"O": polynomial(0, 1)}, posture={"rod": 0.0})._repr_html_()
    assert "<svg" not in text
    assert "guide (slot)" in text
