"""Every way to evaluate agrees within its errors: what features do is tested beside them; here are
machines and random mechanisms that have all of them, by every backend and precision, in files,
prepared, as designs, and as exported C.
"""

import functools
from dataclasses import replace

import numpy as np
import pytest
from design_rows import around, assert_refined
from every_way import DECLARED, SCENES
from exported import by_c99, compare, expected, exported, instants, solve
from internals import DesignEngine, EvaluationMethod, Film, Status, check, write_animation

from lagrange_casadi import derive, evaluate, load, prepare, save, sensitivities

WAYS = {
    "c": {"backend": "c"},
    "lanes": {"backend": "lanes"},
    "single": {"precision": "single"},
    "newton": {"newton": 4},
}


SOUGHT = {
    "cam": ["effort", "output:contact_force"],
    "every_joint_and_load": ["effort", "section:rod", "reaction:S"],
    "plane": ["effort", "output", "section:rod"],
    "space": ["effort", "output", "section:rod"],
}
"""Peaks of what is sought, where all would take long."""


@functools.lru_cache(maxsize=4)
def interpreted(name):
    """A scene, its solution by CasADi's virtual machine, and the largest of each unit."""
    scene = SCENES[name]()
    solution = evaluate(scene, backend="vm")
    assert solution.certified
    size = {}
    for quantity in solution.series:
        unit = solution.unit(quantity)
        largest = np.nanmax(np.abs(solution.array(quantity)), initial=0.0)
        size[unit] = max(size.get(unit, 0.0), largest)
    return scene, solution, size


def agree(found, solution, size, errors=None):
    """All quantities; an estimate is within a factor of ten, and angles and places may be of next
    to nothing.
    """
    assert set(found) == set(solution.series)
    for quantity, values in solution.series.items():
        np.testing.assert_array_equal(np.isnan(found[quantity]), np.isnan(values), quantity)
        gap = np.nanmax(np.abs(found[quantity] - values), initial=0.0)
        claimed = 10.0 * np.nanmax((errors or {}).get(quantity, 0.0), initial=0.0)
        assert gap <= claimed + 1e-13 * size[solution.unit(quantity)], quantity


@pytest.mark.sampled(7)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", SCENES)
def test_every_way_gives_the_same_within_its_errors(name, way):
    scene, solution, size = interpreted(name)
    if way == "newton" and derive(scene).newton is None:
        pytest.skip("no loop is iterated")
    found = evaluate(scene, **WAYS[way])
    assert found.certified
    agree(found.series, solution, size, found.errors)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("name", SCENES)
def test_files_and_prepared_scenes_have_the_same(name, tmp_path):
    scene, solution, size = interpreted(name)
    save(solution, tmp_path / "one.h5")
    assert check(tmp_path / "one.h5") == []
    again = load(tmp_path / "one.h5")
    agree(again.series, solution, size)
    assert again.description == solution.description
    for link in {output.part for output in solution.outputs if output.group == "section"}:
        np.testing.assert_array_equal(again.section(link).axial, solution.section(link).axial)
    agree(prepare(scene)(), solution, size, solution.errors)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("name", DECLARED)
def test_designs_have_the_peaks_of_the_api(name):
    scene = SCENES[name]()
    scene = replace(scene, wanted=SOUGHT.get(name, ["all"]))
    for backend in ("c", "lanes"):
        designs = DesignEngine.of(scene, t=(*scene.span, 97), method=EvaluationMethod(backend))
        p = around(scene, 2)
        outcome = designs.evaluate(p)
        assert outcome.status.tolist() == [Status.OK] * 2
        for row in range(2):
            assert_refined(scene, designs, outcome, row, p[row])


@pytest.mark.sampled(7)
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("name", SCENES)
def test_exported_c_has_the_numbers_of_the_api(name, precision, tmp_path):
    scene = SCENES[name]()
    made, told = exported(scene, tmp_path, precision=precision)
    solution = solve(scene, precision)
    found = by_c99(tmp_path, told, instants(solution.t, precision))
    compare(
        found, expected(scene, told, solution), told, made, solution, exact=precision == "double"
    )


@pytest.mark.parametrize("name", ["plane", "space"])
def test_it_is_shown(name, tmp_path):
    _, solution, _ = interpreted(name)
    solution.report(tmp_path / "one.html")
    assert "friction:main:loss" in (tmp_path / "one.html").read_text()
    for end in ("svg", "glb"):
        write_animation(solution, tmp_path / f"one.{end}", Film())
        assert (tmp_path / f"one.{end}").stat().st_size > 1000


@pytest.mark.parametrize("name", ["plane", "space"])
def test_outputs_inside_are_those_of_the_law(name):
    """Under loads along the link, and of slices that have rotary inertia."""
    _, solution, size = interpreted(name)

    def at(link, force, ratio):
        return solution.section(link).law.at(force, np.full((solution.t.size, 1), ratio))[:, 0]

    inside = (
        at("rod", "bending", 0.4)
        if name == "plane"
        else at("rod", "bending_y", 0.4) + at("crank", "torsion", 0.3)
    )
    gap = np.abs(solution.output("inside") - inside).max()
    assert gap <= 1e-13 * size["N m"]


@pytest.mark.long
@pytest.mark.parametrize("name", ["plane", "space"])
def test_series_and_sections_change_as_they_say(name):
    scene, solution, largest = interpreted(name)
    changes = sensitivities(scene, solution, backend="vm")
    for parameter, value in {"l": 0.4, "mu": 0.1, "d": 0.02}.items():
        step = 1e-4 * value
        moved = {
            k: evaluate(
                scene, parameters={parameter: value + k * step}, backend="vm", certificate=False
            )
            for k in (-2, -1, 1, 2)
        }
        for name in solution.names():
            if ":law:" in name or name.startswith("certificate"):
                continue
            four = {k: one.array(name) for k, one in moved.items()}
            exact = (8 * (four[1] - four[-1]) - (four[2] - four[-2])) / (12 * step)
            size = np.abs(exact).max() + largest[solution.unit(name)] / value
            assert np.abs(changes.array(name, parameter) - exact).max() <= 1e-8 * size, (
                name,
                parameter,
            )
