"""What is kept of a design is what a plain evaluation of it gives."""

import numpy as np
import pytest
import sweeps
from internals import FORCES, EvaluationMethod, Task, Timing, columns, forces, refine, sweep

from lagrange_casadi import derive, evaluate
from lagrange_casadi.errors import DeclarationError, SizeError, UnknownNameError

pytestmark = pytest.mark.quick

SPAN = (0, 0.08, 129)
LENGTHS, CRANKS = (0.13, 0.25), (0.06, 0.1)


@pytest.fixture(scope="module")
def swept(slider_crank):
    grid = {"l": LENGTHS, "r": CRANKS}
    return sweep(slider_crank, grid, t=SPAN, xi=(0, 1, 5), keep="histories", parameters={"m3": 0.3})


@pytest.fixture(scope="module")
def plain(slider_crank):
    """Every design evaluated by itself."""
    return {
        (i, j): evaluate(
            slider_crank.scene, parameters={"l": l, "r": r, "m3": 0.3}, t=SPAN, xi=(0, 1, 5)
        )
        for i, l in enumerate(LENGTHS)
        for j, r in enumerate(CRANKS)
    }


def test_peaks_are_those_between_the_instants(slider_crank, swept, plain):
    compared = 0
    for place, solution in plain.items():
        for peak in refine(slider_crank.scene, solution, forces(solution)):
            if solution.unit(peak.name) and abs(peak.value) > 1e-9:
                np.testing.assert_allclose(
                    swept[f"peak:{peak.name}"][place], peak.value, rtol=1e-8, err_msg=peak.name
                )
                compared += 1
            if peak.xi is not None:
                assert 0.0 <= swept[f"peak_xi:{peak.name}"][place] <= 1.0
    assert compared == 4 * 14


def test_the_instant_and_the_ratio_of_a_peak_give_its_value(slider_crank, swept):
    for i, l in enumerate(LENGTHS):
        at, xi = (
            float(swept[f"{kind}:section:rod:bending"][i, 0]) for kind in ("peak_t", "peak_xi")
        )
        there = evaluate(
            slider_crank.scene, parameters={"l": l, "r": CRANKS[0], "m3": 0.3}, t=(at, at, 1)
        )
        value = there.section("rod").law.at("bending", np.array([[xi]]))[0, 0]
        np.testing.assert_allclose(value, swept["peak:section:rod:bending"][i, 0], rtol=1e-9)


def test_resultants_are_no_less_than_their_members(swept, plain):
    for place, solution in plain.items():
        resultant = np.hypot(solution.reaction("A").fx, solution.reaction("A").fy).max()
        assert swept["peak:reaction:A:resultant"][place] >= resultant * (1 - 1e-12)
        np.testing.assert_allclose(swept["peak:reaction:A:resultant"][place], resultant, rtol=1e-2)


def test_means_are_over_time(swept, plain):
    for place, solution in plain.items():
        effort = solution.effort("O")
        np.testing.assert_allclose(
            swept["rms:effort:O"][place], np.sqrt(np.mean(effort**2)), rtol=0.05
        )
        assert abs(swept["mean:effort:O"][place]) < swept["rms:effort:O"][place]


def test_histories_are_those_of_a_plain_evaluation(swept, plain):
    for name in ("effort:O", "reaction:guide:fy", "section:rod:law:f1"):
        assert swept[f"history:{name}"].shape == (2, 2, 129)
        for place, solution in plain.items():
            size = np.abs(solution.series[name]).max()
            np.testing.assert_allclose(
                swept[f"history:{name}"][place],
                solution.series[name],
                atol=1e-11 * size,
                err_msg=name,
            )


def test_section_forces_along_the_link(swept, plain):
    for force in FORCES:
        grid, largest = (swept[f"{kind}:section:rod:{force}"] for kind in ("history", "peak_at"))
        assert grid.shape == (2, 2, 129, 5)
        for place, solution in plain.items():
            expected = getattr(solution.section("rod"), force)
            np.testing.assert_allclose(grid[place], expected, atol=1e-11 * np.abs(expected).max())
            np.testing.assert_allclose(
                np.abs(largest[place]),
                np.abs(expected).max(axis=0),
                atol=1e-11 * np.abs(expected).max(),
            )


def test_a_tapered_link_and_what_acts_along_it(tmp_path):
    """A density in parameters, and a station."""
    from conftest import CASES

    from lagrange_casadi import load_case

    case = load_case(CASES / "quick_return")
    name, parameter = next(iter(case.scene.mechanism.parameters.items()))
    values = [parameter.default, parameter.default * 1.02]
    found = sweep(
        case,
        {name: values},
        t=(0, 0.1, 5),
        xi=(0, 1, 7),
        keep="histories",
        wanted=["section:rocker"],
    )
    for i, value in enumerate(values):
        solution = evaluate(
            case.scene,
            parameters={name: value},
            t=(0, 0.1, 5),
            xi=(0, 1, 7),
            wanted=["section:rocker"],
        )
        expected = solution.section("rocker").bending
        np.testing.assert_allclose(
            found["history:section:rocker:bending"][i],
            expected,
            atol=1e-11 * np.abs(expected).max(),
        )


def test_a_design_without_a_result_is_a_row_without_numbers(slider_crank):
    found = sweep(
        slider_crank, {"l": [0.05, 0.2], "r": [0.1]}, t=SPAN, xi=(0, 1, 3), keep="histories"
    )
    word, sentence = found.statuses[int(found["status"][0, 0])]
    assert word != "ok"
    assert sentence
    assert found["status"][1, 0] == 0
    for name in found.columns:
        if name != "status":
            assert np.isnan(found[name][0]).all(), name
            if "peak_xi" not in name:
                assert np.isfinite(found[name][1]).all(), name


def test_a_part_that_is_impossible_is_a_row_too(slider_crank):
    found = sweep(slider_crank, {"l": [0.0, 0.2]}, t=SPAN, wanted=["effort"])
    assert found["status"][0] != 0
    assert found["status"][1] == 0


def test_what_is_kept(slider_crank):
    def kinds(**keywords):
        found = sweep(slider_crank, {"l": [0.2, 0.3]}, t=(0, 0.08, 9), **keywords)
        return {name.partition(":")[0] for name in found.columns}, found

    peaks = {"status", "peak", "peak_t", "peak_xi", "mean", "rms"}
    assert kinds()[0] == peaks
    assert kinds(xi=(0, 1, 3))[0] == peaks | {"peak_at"}
    assert kinds(wanted=["effort"])[0] == peaks - {"peak_xi"}
    found, laws = kinds(keep="laws")
    assert found == peaks | {"history"}
    assert all(":law:" in name for name in laws.columns if name.startswith("history:"))
    assert not any("motion" in name or "pose" in name for name in laws.columns)


def test_units(swept):
    units = {name: kept.unit for name, kept in swept.columns.items()}
    assert (
        units["peak:effort:O"]
        == units["rms:effort:O"]
        == units["peak:section:rod:bending"]
        == "N m"
    )
    assert units["peak:reaction:A:resultant"] == units["peak_at:section:rod:axial"] == "N"
    assert units["peak_t:effort:O"] == "s"
    assert units["peak_xi:section:rod:bending"] == units["status"] == "1"


def test_what_cannot_be_kept_is_named(slider_crank):
    grid = {"l": [0.2, 0.3]}
    with pytest.raises(
        UnknownNameError,
        match="unknown choice of what to keep 'all'; valid: peaks, laws, histories",
    ):
        sweep(slider_crank, grid, keep="all")
    with pytest.raises(
        DeclarationError, match="xi: ratios apply to section forces, and none is in wanted="
    ):
        sweep(slider_crank, grid, wanted=["effort"], xi=(0, 1, 3))
    with pytest.raises(DeclarationError, match="keep laws: laws describe section forces"):
        sweep(slider_crank, grid, wanted=["effort"], keep="laws")
    with pytest.raises(DeclarationError, match=r"ratios xi/l must lie in \[0, 1\]"):
        sweep(slider_crank, grid, xi=(0, 2, 3))


def test_what_no_file_keeps_in_one_piece_is_refused(slider_crank, tmp_path):
    with pytest.raises(
        SizeError,
        match=r"history:section:crank:axial of one design takes 4\.48 GiB, a chunk 2 GiB at most",
    ):
        sweep(
            slider_crank,
            {"l": [0.2, 0.3]},
            t=(0, 0.08, 1_000_000),
            xi=(0, 1, 601),
            keep="histories",
            out=tmp_path / "x.h5",
        )
    assert list(tmp_path.iterdir()) == []


def test_a_design_that_memory_cannot_hold_is_refused(slider_crank, tmp_path, monkeypatch):
    monkeypatch.setattr("lagrange_casadi.base.space.memory", lambda: 2.05e7)
    with pytest.raises(
        SizeError,
        match=(
            r"not enough memory for a design and what it is made from: 4 x .* GB, and this machine"
            r" has 0\.0205 GB"
        ),
    ):
        sweep(
            slider_crank,
            {"l": [0.2, 0.3]},
            t=(0, 0.08, 1001),
            xi=(0, 1, 201),
            keep="histories",
            out=tmp_path / "x.h5",
        )
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def harvest(monkeypatch):
    """What is kept of formulas: histories of 7 instants, at 3 ratios."""
    sweeps.use(monkeypatch, count=7)
    return Task(Timing(0, 1, 7), (0, 1, 3), "histories", EvaluationMethod()).harvest(
        derive(sweeps.scene())
    )


def test_a_block_is_what_takes_a_second_and_fits_into_memory(harvest, monkeypatch):
    width = sum(array[:1].nbytes for array in harvest.evaluate(np.full((5, 5), 0.1)))
    assert harvest.block == 14
    monkeypatch.setattr(harvest.engine, "cost", 1e-9)
    monkeypatch.setattr(columns, "_BYTES", 100 * width + 1)
    assert harvest.block == 100
    monkeypatch.setattr(columns, "_BYTES", 1)
    assert harvest.block == 1
    monkeypatch.setattr(columns, "_BYTES", 1 << 40)
    assert harvest.block == columns._MOST
    monkeypatch.setattr(harvest.engine, "cost", 1e9)
    assert harvest.block == 1


@pytest.mark.parametrize("room", [1, 5_000, 1 << 20])
def test_chunks_do_not_know_how_many_designs_were_evaluated_at_once(harvest, monkeypatch, room):
    p = np.random.default_rng(2).uniform(0.1, 0.3, (23, 5))
    whole = harvest.chunks(p, 30)
    harvest.engine.calls.clear()
    monkeypatch.setattr(columns, "_BYTES", room)
    assert harvest.chunks(p, 30) == whole
    assert len(harvest.engine.calls) == {1: 23, 5_000: 8, 1 << 20: 1}[room]
    assert sum(count for count, _ in harvest.engine.calls) == 23
