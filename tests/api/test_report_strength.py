"""What a page tells of strength: how far every part is used, and the series that were wanted."""

import importlib
import math

import pytest
from internals import contents, not_evaluated_lines
from mechanisms import slider_crank
from strong import STEEL, press, robot, slider

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, beams, bearings, evaluate, save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import harmonic

pytestmark = pytest.mark.usefixtures("interpreted")

PIN = bearings.Pin(0.01, 0.02, 0.01, STEEL, pressure=1e8)


@pytest.fixture(scope="module")
def solution():
    scene = slider(200e6)
    return evaluate(scene, wanted=["stress:rod", "safety", "motion", "effort"], certificate=False)


def test_every_way_to_fail_has_a_row(solution):
    rows = contents(solution)["strength"]
    assert [(row["part"], row["against"]) for row in rows] == [
        (part, way) for part in ("crank", "rod") for way in ("yield", "buckling", "fatigue")
    ]
    for row in rows:
        factor = solution.safety(row["part"]).against(row["against"])
        assert row["used"] == 1.0 / factor
        assert row["factor"] == (None if math.isinf(factor) else factor)
    assert [row["against"] for row in rows if row["governs"]] == [
        solution.safety(link).governs.against for link in ("crank", "rod")
    ]


def test_series_of_strength_are_charted(solution):
    told = {series["name"]: series["unit"] for series in contents(solution)["series"]}
    assert told["stress:rod:von_mises"] == "Pa"
    assert told["utilisation:crank:yield"] == "1"


def test_a_page_of_what_has_no_beam_has_no_rows():
    assert contents(evaluate(slider_crank(), certificate=False))["strength"] == []


def unaimed_bar():
    """A flat bar that spins freely about its line, between a crank and a rocker."""
    m = SpatialMechanism("bar")
    rod = m.link(
        "rod", between=((0, 0, 0), (1, 0, 0)), beam=beams.Beam(beams.rectangle(0.03, 0.01), STEEL)
    )
    crank = m.link("crank", between=((0, -0.2, 0), (0, 0, 0)), mass=0.4)
    rocker = m.link(
        "rocker", between=((1, -0.2, 0), (1, 0, 0)), beam=beams.Beam(beams.round_bar(0.02), STEEL)
    )
    m.revolute("O", m.ground, crank, at=(0, -0.2, 0), axis=(0, 0, 1))
    bearings.fit(m, m.revolute("Q", m.ground, rocker, at=(1, -0.2, 0), axis=(0, 0, 1)), PIN)
    m.spherical("A", crank, rod, at=(0, 0, 0))
    m.spherical("B", rod, rocker, at=(1, 0, 0))
    return Scene(m, {"O": harmonic(0.0, 0.3, 2.0)}, t=(0, 0.5, 5))


def lacking(*numbers):
    """A slider-crank of a material that lacks some numbers."""
    return press(
        beams.rectangle(0.02, 0.012), material=STEEL.but(**dict.fromkeys(numbers)), t=(0, 0.2, 5)
    )


def twisted():
    """An arm whose cross-section bears torsion for which there is no formula."""
    return robot(beams.polygon([(0.02, -0.01), (0.02, 0.01), (-0.02, 0.01), (-0.02, -0.01)]))


def held_twice():
    """A beam on three pins: equilibrium leaves its bending open, and what its pins bear."""
    m = Mechanism("beam")
    girder = m.link("girder", length=1.0, beam=beams.Beam(beams.rectangle(0.03, 0.01), STEEL))
    swing = m.link("swing", length=0.3, beam=beams.Beam(beams.rectangle(0.03, 0.01), STEEL))
    m.weld("left", m.ground, girder)
    bearings.fit(m, m.revolute("right", m.ground.at(1.0, 0.0), girder.tip), PIN)
    m.revolute("O", m.ground, swing)
    return Scene(m, {"O": harmonic(0.0, 0.3, 2.0)}, t=(0, 0.5, 5))


OPEN = {
    unaimed_bar: {"rod"},
    twisted: {"upper"},
    held_twice: {"girder", "right"},
    lambda: lacking("yield_strength"): {"rod"},
    lambda: lacking("elasticity"): {"rod"},
    lambda: slider(200e6): set(),
}


@pytest.mark.parametrize("scene", OPEN)
def test_what_is_open_is_told_by_its_name(scene):
    given = scene()
    solution = evaluate(given)
    rows = contents(solution)["strength"]
    parts = {name for name, body in solution.description["bodies"].items() if "beam" in body}
    parts |= {name for name, joint in solution.description["joints"].items() if "fitted" in joint}
    assert {row["part"] for row in rows} == parts
    assert {row["part"] for row in rows if row["open"] and row["part"] in OPEN[scene]} == OPEN[
        scene
    ]
    for row in rows:
        assert row["open"] == (row["factor"] is row["used"] is None and row["against"] == "")
    for part in OPEN[scene]:
        with pytest.raises(DeclarationError) as refused:
            solution.safety(part)
        assert [row["where"] for row in rows if row["part"] == part] == [str(refused.value)]
    assert {note.split("'")[1] for note in not_evaluated_lines(solution)} == OPEN[scene]


@pytest.fixture
def undrawn(monkeypatch):
    """Figures take long to draw, and none is looked at."""
    for command in ("plot", "run"):
        monkeypatch.setattr(
            importlib.import_module(f"lagrange_casadi.cli.{command}"),
            "draw_with_progress",
            lambda *_, **__: None,
        )


@pytest.mark.usefixtures("undrawn")
def test_commands_tell_of_it(tmp_path, capsys):
    file = str(tmp_path / "x.h5")
    save(evaluate(unaimed_bar()), file)
    for command in (
        ["info", file],
        ["plot", file, "--out", str(tmp_path / "figures")],
        ["report", file, "--out", f"{file}.html"],
    ):
        assert main(command) == 0
        out, err = capsys.readouterr()
        assert (out + err).count(
            "note: no factor of safety of 'rod': link 'rod' can spin freely"
        ) == 1


def test_a_way_to_fail_that_is_open_has_a_row_too():
    rows = contents(evaluate(slider()))["strength"]
    assert [row["where"].partition(":")[0] for row in rows if row["open"]] == ["fatigue", "fatigue"]


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("command", [["--want", "section", "--want", "motion"], ["--no-figures"]])
def test_a_run_tells_of_it(command, tmp_path, capsys, monkeypatch):
    """Once where figures are drawn and strength was not asked for; else it is said where strength
    is told.
    """
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "machine"
    folder.mkdir()
    (folder / "case.py").write_text("from test_report_strength import unaimed_bar as scene\n")
    assert main(["run", str(folder), *command]) == 0
    out = capsys.readouterr().out
    assert out.count("note: no factor of safety of 'rod'") == ("section" in command)
    assert "link 'rod' can spin freely" in out
