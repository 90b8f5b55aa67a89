"""Derivatives of outputs by parameters: beside differences of solutions, in files and tables, and
what has none.
"""

import functools
import math
from dataclasses import replace

import casadi as ca
import h5py
import numpy as np
import pytest
from conftest import CASES
from derivatives import steps
from forging import edit
from mechanisms import pendulum, slider_crank
from reports import wound
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, check, evaluate, load, load_case, save, sensitivities
from lagrange_casadi.cli import main
from lagrange_casadi.density import polynomial as density
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import harmonic, polynomial


def loaded():
    """A beam that swings: its length, its taper, its motion, a load that stands along it and one at
    a station are parameters.
    """
    m = Mechanism("loaded")
    l = m.parameter("l", 1.2, "m")
    taper = m.parameter("taper", -2.0, "kg/m")
    swing = m.parameter("swing", 0.6, "rad")
    push, place = m.parameter("push", 40.0, "N/m"), m.parameter("place", 0.7, "m")
    beam = m.link("beam", length=l, density=density(5.0, taper))
    m.revolute("O", m.ground, beam)
    m.line_load("snow", beam, y=(push, 2 * push), between=(0.2, place))
    m.force("hook", beam.at(place / 2), y=-30.0)
    return Scene(m, {"O": harmonic(0.1, swing, 0.5)}, t=(0, 2, 25), xi=(0, 1, 8))


SCENES = {
    name: functools.partial(lambda name: load_case(CASES / name).scene, name)
    for name in (
        *("arm", "beam_pump", "engine", "four_bar", "quick_return", "roller_cam", "rrr3"),
        *("cardan_shaft", "rssr", "spatial_slider_crank"),
    )
}
SCENES |= {"iterated": iterated, "loaded": loaded, "wound": wound}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", SCENES)
def test_series_change_as_solutions_beside_say(name):
    """Forward and backward, and to second order: beside differences of whole solutions."""
    scene = SCENES[name]()
    start, stop = scene.span
    asked = {"t": (start, start + 0.37 * (stop - start), 7), "xi": (0.1234, 0.9034, 2)}
    asked |= {"backend": "vm", "certificate": False}
    solution = evaluate(scene, wanted=["all", "sensitivity"], **asked)
    # What is rounding alone has no slope to compare.
    names = [
        name
        for name in solution.names()
        if solution.determined(name) and np.abs(solution.array(name)).max() > 1e-9
    ]
    values = {name: x for name, x in scene.mechanism.values().items() if x}

    def told(of, *by):
        return np.concatenate([np.ravel(of(name, *by)) for name in names])

    def made(parameters):
        return evaluate(scene, parameters=parameters, wanted=["all"], **asked)

    def slopes(parameters, by):
        return told(sensitivities(scene, made(parameters), backend="vm").array, by)

    def same(found, exact, scale, accuracy):
        size = told(lambda name: np.full_like(solution.array(name), largest[solution.unit(name)]))
        gaps = np.abs(found - exact) * abs(scale) / (size + np.abs(exact * scale))
        assert gaps.max() <= accuracy, (parameter, gaps.argmax())

    largest = dict.fromkeys(map(solution.unit, names), 1e-9)
    for name in names:
        unit = solution.unit(name)
        largest[unit] = max(largest[unit], np.abs(solution.array(name)).max())
    changes, other = sensitivities(scene, solution, backend="vm"), [*values][-1]
    for parameter, x in values.items():
        exact = steps(lambda moved, by=parameter: told(made({by: moved}).array), x)
        for found in (changes, solution.sensitivities):
            same(told(found.array, parameter), exact, x, 1e-8)
        exact = steps(lambda moved, by=parameter: slopes({by: moved}, other), x)
        same(told(changes.curvature, other, parameter), exact, x * values[other], 1e-7)


FOUR_BAR = CASES / "four_bar"
MISTAKES = {
    "unknown parameter 'r'": lambda scene, changes: changes.array("effort:O", "r"),
    "unknown quantity .*effort:X": lambda scene, changes: changes.array("effort:X", "l"),
    "a section force has a mean at every ratio": (
        lambda scene, changes: changes.mean("section:beam:bending")
    ),
    "scene: expected a Scene, got": lambda scene, changes: sensitivities(changes.solution, scene),
    "is not one of this scene": (
        lambda scene, changes: sensitivities(load_case(FOUR_BAR).scene, changes.solution)
    ),
    "of 'loaded' is not one of this scene": (
        lambda scene, changes: sensitivities(
            replace(scene, motion={"O": harmonic(0.1, 0.3, 0.5)}), changes.solution
        )
    ),
    "unknown output 'sensitivity:x'": (
        lambda scene, changes: slider_crank(wanted=["effort", "sensitivity:x"])
    ),
    "'sensitivity': not an output of mechanism 'pendulum'": (
        lambda scene, changes: pendulum(polynomial(0.0), wanted=["effort", "sensitivity"])
    ),
    "equilibrium does not determine it": lambda scene, changes: undetermined(),
}


def undetermined():
    """The slope of what equilibrium leaves open."""
    scene = load_case(CASES / "bricard").scene
    solution = evaluate(scene, t=(*scene.t[:2], 9), certificate=False, backend="vm")
    sensitivities(scene, solution, backend="vm").array(solution.undetermined[0], "x")


@pytest.mark.parametrize("says", MISTAKES)
def test_mistakes(says):
    scene = loaded()
    changes = sensitivities(scene, evaluate(scene, certificate=False, backend="vm"), backend="vm")
    with pytest.raises(DeclarationError, match=says):
        MISTAKES[says](scene, changes)


SHORT = (0.001, 0.08, 7)


@pytest.fixture(scope="module")
def solution():
    return evaluate(
        slider_crank(), wanted=["effort", "section:rod", "sensitivity"], t=SHORT, xi=(0, 1, 5)
    )


def test_files_and_tables_have_them(tmp_path, capsys, solution):
    assert solution.certified
    file = tmp_path / "with.h5"
    save(solution, file)
    assert check(file) == []
    again = load(file).sensitivities
    assert again.parameters == ("r", "l", "m1", "m2", "m3")
    assert again.quantities == tuple(name for name in solution.names() if ":law:" not in name)
    frame = solution.to_pandas()
    for name, column in (
        ("effort:O", "sensitivity:m3:effort:O [N m/kg]"),
        ("section:rod:shear", "sensitivity:m3:section:rod:shear xi/l=0.25 [N/kg]"),
    ):
        told = solution.sensitivities.array(name, "m3")
        np.testing.assert_array_equal(again.array(name, "m3"), told)
        np.testing.assert_array_equal(frame[column], told if told.ndim == 1 else told[:, 1])
    with h5py.File(file) as h:
        dataset = h["sensitivity/l/section/rod/bending"]
        assert dataset.shape == (7, 5)
        assert dataset.attrs["units"] == "N m/m"
        assert dataset.attrs["long_name"] == "bending moment: derivative by l"
    assert main(["info", str(file)]) == 0
    assert "sensitivities: of 4 quantities by r, l, m1, m2, m3\n" in capsys.readouterr().out
    data = solution.to_xarray()["sensitivity:r:section:rod:axial"]
    assert (data.dims, data.attrs["units"]) == (("t", "xi"), "N/m")

    def change(h):
        h["sensitivity/l/effort/O"][3] = math.nan
        h["sensitivity/r/effort/O"].attrs["units"] = "N"

    edit(file, change)
    assert check(file) == [
        "sensitivity/r/effort/O: units 'N', expected 'N m/m'",
        "sensitivity/l/effort/O: values that are not finite",
    ]


def test_a_derivative_that_is_none_is_told(tmp_path):
    """The root of an angle that begins at nothing grows without bound there, and so does its
    derivative by the swing.
    """
    m = Mechanism("root")
    arm = m.link("arm", length=1.0, mass=1.0)
    swing = m.parameter("swing", 0.5, "rad")
    m.revolute("O", m.ground, arm)
    m.torque("spring", arm, -ca.sqrt(ca.fabs(m.direction(arm))))
    scene = Scene(m, {"O": harmonic(0.0, swing, 0.5)}, t=(0, 0.5, 6))
    solution = evaluate(scene, wanted=["effort", "sensitivity"], backend="vm", certificate=False)
    assert np.isfinite(solution.effort("O")).all()
    slopes = solution.sensitivities.array("effort:O", "swing")
    assert not np.isfinite(slopes[0])
    assert np.isfinite(slopes[1:]).all()
    assert solution.notes == (
        "the derivative of effort:O by swing is not finite at 1 of 6 instants",
    )
    save(solution, tmp_path / "a.h5")
    assert check(tmp_path / "a.h5") == ["sensitivity/swing/effort/O: values that are not finite"]
