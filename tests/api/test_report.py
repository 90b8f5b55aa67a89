"""A report's page: it holds the solution's numbers to the last bit, no name of a user is markup,
and it is whole or not there.
"""

import functools
import json
import re
from dataclasses import replace
from importlib import resources

import h5py
import numpy as np
import pytest
from commands import command
from drawn_scenes import every_kind
from internals import (
    COMPARISON_SCRIPTS,
    LIVE_SCRIPTS,
    SCRIPTS,
    SWEEP_SCRIPTS,
    instants,
    joint_shapes,
    shapes,
    write_report,
)
from internals import report_page as page
from reports import HOSTILE, held, hostile, press, snowed, solved, wound

from lagrange_casadi import evaluate, load, save
from lagrange_casadi.case import load_case
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, PathError

ASSETS = {
    path.name: path.read_text()
    for path in resources.files("lagrange_casadi.report").joinpath("assets").iterdir()
}


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


def test_sensitivities_are_charted_in_their_units():
    scene = load_case("slider_crank").scene
    solution = evaluate(
        scene, wanted=["motion", "effort", "sensitivity:l"], t=(0, 0.08, 5), backend="vm"
    )
    found, array = held(page(solution))
    series = {one["name"]: one for one in found["series"] if one["group"] == "sensitivity"}
    assert series["sensitivity:l:effort:O"]["unit"] == "N m/m"
    exact = solution.sensitivities.array("effort:O", "l")
    np.testing.assert_array_equal(array(series["sensitivity:l:effort:O"]["values"]), exact)


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


def test_a_page_of_801_instants_is_under_three_megabytes():
    text = page(evaluate(load_case("slider_crank").scene, backend="vm"))
    assert held(text)[0]["instants"]["shown"] == 801
    assert len(text.encode()) < 3_000_000


def test_more_instants_than_fit_are_thinned_for_pictures_and_never_for_numbers(
    monkeypatch, tmp_path, capsys
):
    solution = solved("four_bar", 401)
    monkeypatch.setattr(instants, "MOST", 2000)
    monkeypatch.setattr(instants, "LEAST", 30)
    found, array = held(page(solution))
    told = found["instants"]
    assert told["total"] == 401
    assert 30 <= told["shown"] < 401
    shown = set(array(told["t"]))
    for row in found["rows"]:
        assert row["peak"]["value"] == solution.peak(row["name"]).value + 0.0
        assert row["peak"]["t"] in shown
        assert row["smallest"]["t"] in shown
    save(solution, tmp_path / "bar.h5")
    assert main(["report", str(tmp_path / "bar.h5"), "--out", str(tmp_path / "bar.html")]) == 0
    note = (
        f"note: pictures and charts show {told['shown']} of 401 instants, which is as many as fit;"
        " tables are of all\n"
    )
    assert capsys.readouterr().err == note


def test_a_page_is_the_same_from_a_file_and_each_time(tmp_path):
    solution = press()
    save(solution, tmp_path / "press.h5")
    write_report(load(tmp_path / "press.h5"), tmp_path / "press.html")
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


def test_the_viewer_makes_no_markup_of_texts_and_asks_for_nothing():
    scripts = (*LIVE_SCRIPTS, *SCRIPTS, *SWEEP_SCRIPTS, *COMPARISON_SCRIPTS)
    assert {f"{name}.js" for name in scripts} == {name for name in ASSETS if name.endswith(".js")}
    for name, text in ASSETS.items():
        assert not re.search(
            r"(inner|outer)HTML|insertAdjacentHTML|document\.write|\beval\(|new Function", text
        ), name
        assert not re.search(r"\bfetch\(|\bimport\b|XMLHttp|WebSocket|sendBeacon", text), name
        addresses = set(re.findall(r"https?://[^\"'\s]+", text))
        assert addresses <= {"http://www.w3.org/2000/svg"}, name


@pytest.mark.parametrize(("name", "corners"), [("excavator", 4), ("delta", 6), ("engine", 0)])
def test_bodies_of_three_joints_are_plates_and_of_two_bars(name, corners):
    (first,) = [shape for shape in shapes(solved(name).description) if shape.kind == "rigid"]
    assert [len(plate) for plate in first.plates] == ([corners] if corners else [])
    assert len(first.arms) == (0 if corners else 1)


def test_every_kind_of_joint_and_a_spring_are_in_a_page():
    solution = every_kind()
    found, array = held(page(solution))
    kinds = {joint["kind"] for joint in found["joints"]}
    assert {
        "revolute",
        "prismatic",
        "cylindrical",
        "screw",
        "planar",
        "slot",
        "universal",
        "spherical",
        "free",
        "weld",
    } == kinds
    assert [load["kind"] for load in found["loads"]] == ["spring"]
    assert [path["name"] for path in found["paths"]] == ["end"]
    (universal,) = [
        joint for joint in joint_shapes(solution.description) if joint.kind == "universal"
    ]
    assert abs(np.linalg.norm(universal.second) - 1.0) < 1e-12
    for body in found["bodies"]:
        pose = np.array([array(k) for k in body["pose"]])
        axes = pose[3:].T.reshape(-1, 3, 3)
        np.testing.assert_allclose(
            axes @ axes.transpose(0, 2, 1), np.broadcast_to(np.eye(3), axes.shape), atol=1e-12
        )


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


def test_a_damaged_file_is_refused(tmp_path, capsys):
    save(press(), tmp_path / "press.h5")
    with h5py.File(tmp_path / "press.h5", "r+") as file:
        file.attrs["schema_version"] = 99
    assert main(["report", str(tmp_path / "press.h5"), "--out", str(tmp_path / "a.html")]) == 1
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not (tmp_path / "a.html").exists()


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
