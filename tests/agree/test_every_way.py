"""Every way to evaluate agrees within its errors: what features do is tested beside them; here are
machines and random mechanisms that have all of them, by every backend and precision, in files,
prepared, as designs, from sweeps and cycle tables, and as exported C.
"""

import functools
from dataclasses import replace

import numpy as np
import pytest
from design_rows import around, assert_refined
from every_way import DECLARED, SCENES, TABLED
from exported import by_c99, compare, expected, exported, instants, solve

from lagrange_casadi import animation, check, derive, evaluate, load, prepare, save, sweep


def everything(solution):
    """All series, and section forces at all ratios."""
    return {name: solution.array(name) for name in solution.names()} | dict(solution.series)


def evaluated(**method):
    """A way that is an option of an evaluation."""

    def found(scene, solution, folder):
        other = evaluate(scene, **method)
        assert other.certified or "table" in method
        return everything(other), other.errors

    return found


def from_a_file(scene, solution, folder):
    save(solution, folder / "one.h5")
    assert check(folder / "one.h5") == []
    again = load(folder / "one.h5")
    assert again.description == solution.description
    for link in solution.links_with_sections:
        np.testing.assert_array_equal(again.section(link).axial, solution.section(link).axial)
    return everything(again), {}


def prepared(scene, solution, folder):
    return prepare(scene)(), solution.errors


def among_designs(backend):
    """A way of which each of some equal designs has the same bits."""

    def found(scene, solution, folder):
        f = prepare(scene, backend=backend)
        row = list(scene.mechanism.values().values())
        outcome = f.designs([row] * 11, histories=True)
        assert outcome.status.tolist() == [0] * 11
        assert len({one.tobytes() for one in outcome.series}) == 1
        return dict(zip(f.outputs, outcome.series[-1], strict=True)), solution.errors

    return found


def swept(scene, solution, folder):
    """Of one parameter, in a file."""
    name, value = next(item for item in scene.mechanism.values().items() if item[1])
    axes, told = {name: [value, 1.0001 * value]}, {"workers": 1, "keep": "histories"}
    found = sweep(scene, axes, out=folder / "swept.h5", **told)
    columns = [c for c in found if c.startswith("history:") and c != "history:t"]
    return {c.removeprefix("history:"): found[c][0] for c in columns}, solution.errors


WAYS = {
    "c": evaluated(backend="c"),
    "lanes": evaluated(backend="lanes"),
    "threads": evaluated(threads=3),
    "single": evaluated(precision="single"),
    "single in scalars": evaluated(precision="single", backend="c"),
    "newton": evaluated(newton=4),
    "table": evaluated(table=256),
    "file": from_a_file,
    "prepared": prepared,
    "designs in c": among_designs("c"),
    "designs in lanes": among_designs("lanes"),
    "sweep": swept,
}
"""How a scene comes to its series: a function of it, its solution and a folder gives them, and
their errors.
"""

SOUGHT = {
    "every_joint_and_load": ["effort", "section:rod", "reaction:S"],
    "plane": ["effort", "output", "section:rod", "section:rocker"],
    "space": ["effort", "output", "section:rod"],
}
"""Peaks of what is sought, where all would take long."""


BITS = ["slider_crank", "four_bar", "space", "geared", "sampled_cam"]
"""Scenes of which scalar C has the bits of CasADi's virtual machine."""


@functools.lru_cache(maxsize=4)
def interpreted(name):
    """A scene, its solution by CasADi's virtual machine, and the largest of each unit."""
    scene = SCENES[name]()
    solution = evaluate(scene, backend="vm")
    assert solution.certified
    size = {}
    for quantity, values in everything(solution).items():
        unit = solution.unit(quantity)
        size[unit] = max(size.get(unit, 0.0), np.nanmax(np.abs(values), initial=0.0))
    return scene, solution, size


PAIRS = [(name, way) for name in SCENES for way in WAYS if way != "table" or name in TABLED]


@pytest.mark.sampled(23)
@pytest.mark.parametrize(("name", "way"), PAIRS)
def test_every_way_gives_the_same_within_its_errors(name, way, tmp_path):
    """An estimate is within a factor of ten, and angles and places may be of next to nothing."""
    scene, solution, size = interpreted(name)
    if way == "newton" and derive(scene).newton is None:
        pytest.skip("no loop is iterated")
    if way == "sweep" and not any(scene.mechanism.values().values()):
        pytest.skip("there is no parameter")
    found, errors = WAYS[way](scene, solution, tmp_path)
    exactly = everything(solution)
    assert set(exactly) >= set(found)
    assert way == "sweep" or set(found) >= set(solution.series)  # histories are of forces alone
    for quantity, values in found.items():
        exact = exactly[quantity]
        if way == "c" and name in BITS:
            np.testing.assert_array_equal(values, exact, quantity)
        np.testing.assert_array_equal(np.isnan(values), np.isnan(exact), quantity)
        gap = np.nanmax(np.abs(values - exact), initial=0.0)
        claimed = 10.0 * np.nanmax(errors.get(quantity, 0.0), initial=0.0)
        assert gap <= claimed + 1e-13 * size[solution.unit(quantity)], quantity


@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", DECLARED)
def test_designs_have_the_peaks_of_the_api(name):
    scene = SCENES[name]()
    scene = replace(scene, wanted=SOUGHT.get(name, ["all"]))
    p = around(scene, 2)
    for row, backend in enumerate(("c", "lanes")):
        designs = prepare(scene, t=(*scene.span, 97), backend=backend)
        outcome = designs.designs(p)
        assert outcome.status.tolist() == [0] * 2
        assert_refined(scene, designs, outcome, row, p[row])


@pytest.mark.sampled(19)
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
        animation.write_animation(solution, tmp_path / f"one.{end}", animation.Film())
        assert (tmp_path / f"one.{end}").stat().st_size > 1000


@pytest.mark.parametrize("name", ["plane", "space"])
def test_outputs_are_what_they_are_made_of(name):
    """Inside a link under loads along it, and of slices that have rotary inertia."""
    _, solution, size = interpreted(name)

    def at(link, force, ratio):
        return solution.section(link).law.at(force, np.full((solution.t.size, 1), ratio))[:, 0]

    inside = (
        at("rod", "bending", 0.4)
        if name == "plane"
        else at("rod", "bending_y", 0.4) + at("crank", "torsion", 0.3)
    )
    made = {"inside": inside}
    if name == "plane":
        pin, main, time = solution.reaction("A"), solution.motion("O"), solution.t
        made |= {"power": solution.effort("O") * main.rate, "pin_load": np.hypot(pin.fx, pin.fy)}
        made |= {"lean": solution.pose("rod").angle + time}
    for output, values in made.items():
        gap = np.abs(solution.output(output) - values).max()
        assert gap <= 1e-13 * size[solution.unit(f"output:{output}")], output
