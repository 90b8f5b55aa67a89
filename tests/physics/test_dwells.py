"""A packaging machine: it dwells, its guide rubs and its rod has a beam; all that is told is of the
instants that move.
"""

import numpy as np
import pytest
from click.testing import CliRunner
from internals import EvaluationMethod, Film, check, check_sweep, load, resting_note, trade
from packer import CASE, scene

from lagrange_casadi import Scene, evaluate, optimise, prepare, sweep, tolerances
from lagrange_casadi.cli import program

pytestmark = pytest.mark.usefixtures("interpreted")


def test_a_run_draws_and_tells_what_moves(tmp_path):
    (tmp_path / "packer.py").write_text(CASE)
    out = str(tmp_path / "packer.h5")
    found = CliRunner().invoke(
        program,
        ["run", str(tmp_path / "packer.py"), "--out", out, "--figures", str(tmp_path / "drawn")],
    )
    assert found.exit_code == 0, found.output
    assert "nan" not in found.output.replace("NaN", "")
    assert found.output.count("at rest at ") == 1
    assert check(out) == []
    assert load(out).safety("rod") == evaluate(scene()).safety("rod")


@pytest.mark.parametrize(
    "seed", [*range(1), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 3))]
)
def test_any_dwell_is_as_if_the_instants_at_rest_were_not_there(seed):
    draw = np.random.default_rng(seed)
    drawn = scene(draw.uniform(0.05, 0.3), draw.uniform(0.3, 2.0), int(draw.integers(41, 81)))
    solution = evaluate(drawn)
    assert 0 < np.count_nonzero(solution.resting) < solution.t.size
    moving = solution.during(~solution.resting)
    assert solution.safety("rod") == moving.safety("rod")
    assert solution.life("rod").damage == moving.life("rod").damage
    assert solution.stress("rod").peak("tresca") == moving.stress("rod").peak("tresca")
    largest = solution.stress("rod").largest("von_mises").value
    assert np.isnan(largest).tolist() == solution.resting.tolist()
    assert np.nanmax(largest) == pytest.approx(
        solution.stress("rod").peak("von_mises").value, rel=1e-9
    )
    for name in ("effort:O", "reaction:bore:fy", "section:rod:axial"):
        assert solution.peak(name) == moving.peak(name)
        assert solution.statistics(name).smallest == moving.statistics(name).smallest


def test_sweeps_and_searches_see_the_same(tmp_path):
    found = sweep(scene(), {"r": [0.06, 0.08]}, out=tmp_path / "s.h5")
    assert check_sweep(tmp_path / "s.h5") == []
    assert found["status"].tolist() == [0, 0]
    solution = evaluate(scene())
    assert found["mean:effort:O"][1] == pytest.approx(
        solution.statistics("effort:O").mean, rel=1e-9
    )
    assert found["life:rod"][1] == solution.life("rod").cycles
    assert found["least:fatigue:rod"][1] == pytest.approx(
        solution.safety("rod").against("fatigue"), rel=1e-2
    )
    best = optimise(scene(), minimise="peak:effort:O", over={"r": (0.06, 0.1)}, screen=4, starts=1)
    assert best.parameters["r"] == pytest.approx(0.06, abs=1e-6)
    assert prepare(scene()).gradient()["effort:O"]["r"] != 0.0


def test_tolerances_and_deflections_see_the_same():
    solution = evaluate(scene(), wanted=["effort", "motion", "deflection:rod", "section:rod"])
    moving = solution.during(~solution.resting)
    assert solution.deflection("rod").peak() == moving.deflection("rod").peak()
    found = tolerances(scene(), {"r": 0.001}, wanted=["effort"], samples=32)
    assert found.failed == 0
    assert np.isfinite([found.peaks["effort:O"].nominal, found.peaks["effort:O"].sigma]).all()


def test_pages_and_films_are_drawn(tmp_path):
    """With arrows of forces that are no numbers at rest, and ribbons along the rod."""
    solution = evaluate(scene())
    solution.report(tmp_path / "page.html")
    for name, force in (("film.gif", "bending"), ("film.svg", "bending"), ("film.glb", "")):
        solution.animate(
            tmp_path / name, Film(width=120, rate=4.0, seconds=1.0, forces=True, section=force)
        )
    assert all(
        (tmp_path / name).stat().st_size
        for name in ("page.html", "film.gif", "film.svg", "film.glb")
    )


def test_ways_of_evaluation_are_traded():
    found = trade(
        scene(),
        wanted=["effort", "motion", "friction"],
        methods=(EvaluationMethod(), EvaluationMethod("vm"), EvaluationMethod("c")),
    )
    assert not found.refused
    assert all(0.0 <= one.largest < 1e-9 for one in found.measurements)


def test_a_sweep_tells_of_designs_that_rest_though_the_first_does_not(tmp_path):
    """The instants of the first end before it rests."""
    drawn = scene()
    m = drawn.mechanism
    lasts = Scene(
        m,
        drawn.laws,
        drawn.wanted,
        t=(0.05, 10.0 * m.parameters["r"].symbol - 0.5, 21),
        posture={"rod": 0.0},
    )
    found = sweep(lasts, {"r": [0.06, 0.08, 0.1]}, wanted=["effort"], out=tmp_path / "s.h5")
    told = resting_note(lasts, found, {}, wanted=["effort"])
    assert told.startswith("in design 1 a joint with friction is at rest at ")
    assert told.endswith("; so it is in 2 of 3 designs that were evaluated")
