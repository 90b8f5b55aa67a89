"""How a solution changes with the parameters: series and sections beside differences, means and
peaks, and what is refused.
"""

from dataclasses import replace

import numpy as np
import pytest
from conftest import CASES
from internals import SPACE, PeakKind
from reports import wound

from lagrange_casadi import Mechanism, Scene, evaluate, load_case, prepare, sensitivities
from lagrange_casadi.density import polynomial as density
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import dwell, harmonic, move, moves

pytestmark = pytest.mark.quick


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


def differences(make, name, parameter, at):
    """Those of a quantity of whole solutions, by four values."""
    step = 1e-4 * abs(at)
    four = {k: make(at + k * step).array(name) for k in (-2, -1, 1, 2)}
    return (8 * (four[1] - four[-1]) - (four[2] - four[-2])) / (12 * step)


@pytest.mark.parametrize("parameter", ["l", "taper", "swing", "push", "place"])
def test_series_and_sections_are_those_of_differences(parameter):
    scene = loaded()
    solution = evaluate(scene, certificate=False, backend="vm")
    changes = sensitivities(scene, solution, backend="vm")

    def make(value):
        return evaluate(scene, parameters={parameter: value}, certificate=False, backend="vm")

    at = scene.mechanism.values()[parameter]
    for name in (
        "effort:O",
        "reaction:O:fx",
        "motion:O_rate",
        "section:beam:axial",
        "section:beam:shear",
        "section:beam:bending",
    ):
        found, exact = changes.array(name, parameter), differences(make, name, parameter, at)
        assert found.shape == solution.array(name).shape
        size = np.abs(exact).max() + np.abs(solution.array(name)).max() / abs(at)
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-9 * size, err_msg=name)


def test_sections_of_links_whose_slices_have_rotary_inertia():
    scene = wound()
    solution = evaluate(scene, certificate=False, backend="vm")
    changes = sensitivities(scene, solution, backend="vm")
    for force in SPACE.forces[:6]:
        name = f"section:bar:{force}"
        exact = differences(
            lambda l: evaluate(scene, parameters={"l": l}, certificate=False, backend="vm"),
            name,
            "l",
            0.8,
        )
        np.testing.assert_allclose(
            changes.array(name, "l"), exact, rtol=0, atol=1e-9 * np.abs(exact).max(), err_msg=name
        )


def test_where_friction_rests_there_are_no_numbers():
    m = Mechanism("resting")
    l = m.parameter("l", 0.4, "m")
    bar = m.link("bar", length=l, mass=2.0)
    m.friction("rub", m.revolute("O", m.ground, bar), mu=0.1, radius=0.02)
    law = moves([move(1.0, time=0.4), dwell(0.1), move(by=-1.0, time=0.5)])
    scene = Scene(m, {"O": law}, t=(0, 1, 41), wanted=["effort"])
    solution = evaluate(scene, backend="vm")
    assert 0 < np.count_nonzero(solution.resting) < 41
    found = sensitivities(scene, solution, backend="vm").array("effort:O", "l")
    assert np.isnan(found).tolist() == solution.resting.tolist()
    exact = differences(
        lambda x: evaluate(scene, parameters={"l": x}, backend="vm"), "effort:O", "l", 0.4
    )
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-8 * np.nanmax(np.abs(exact)))


@pytest.mark.sampled(2)
def test_means_and_peaks():
    scene = load_case(CASES / "four_bar").scene
    solution = evaluate(scene, t=(*scene.t[:2], 101), certificate=False)
    changes = sensitivities(scene, solution)
    for parameter in ("a", "c"):
        x = scene.mechanism.values()[parameter]
        step = 1e-5 * x
        two = [
            evaluate(
                scene,
                t=solution_span(scene),
                parameters={parameter: x + k * step},
                certificate=False,
            ).statistics("effort:O")
            for k in (1, -1)
        ]
        for word in ("mean", "rms"):
            found = getattr(changes, word)("effort:O")
            size = solution.statistics("effort:O").rms  # a mean may be nothing
            assert found.value == pytest.approx(
                getattr(solution.statistics("effort:O"), word), rel=1e-12, abs=1e-12 * size
            )
            exact = (getattr(two[0], word) - getattr(two[1], word)) / (2 * step)
            assert found.slopes[parameter] == pytest.approx(exact, rel=1e-6, abs=1e-6 * size / x)
    gradient = prepare(scene, t=solution_span(scene)).gradient()
    for name in ("effort:O", "section:coupler:bending", "reaction:O:fx"):
        peak = changes.peak(name)
        assert peak.kind is PeakKind.SMOOTH
        assert peak.value == pytest.approx(
            gradient.value[gradient.quantities.index(name)], rel=1e-11
        )
        for parameter, slope in gradient[name].items():
            assert peak.slopes[parameter] == pytest.approx(
                slope, rel=1e-6, abs=1e-6 * abs(peak.value)
            )


def solution_span(scene):
    return (*scene.t[:2], 101)


def test_mistakes():
    scene = loaded()
    solution = evaluate(scene, certificate=False, backend="vm")
    changes = sensitivities(scene, solution, backend="vm")
    with pytest.raises(UnknownNameError, match="parameter"):
        changes.array("effort:O", "r")
    with pytest.raises(UnknownNameError, match="quantity"):
        changes.array("effort:X", "l")
    with pytest.raises(DeclarationError, match="a section force has a mean at every ratio"):
        changes.mean("section:beam:bending")
    with pytest.raises(DeclarationError, match="scene: expected a Scene, got"):
        sensitivities(solution, scene)
    for other in (
        load_case(CASES / "four_bar").scene,
        replace(loaded(), motion={"O": harmonic(0.1, 0.3, 0.5)}),
    ):
        with pytest.raises(DeclarationError, match="is not one of this scene"):
            sensitivities(other, solution, backend="vm")


def test_what_equilibrium_leaves_open_has_no_slope():
    scene = load_case(CASES / "bricard").scene
    solution = evaluate(scene, t=(*scene.t[:2], 9), certificate=False, backend="vm")
    changes = sensitivities(scene, solution, backend="vm")
    with pytest.raises(DeclarationError, match="equilibrium does not determine it"):
        changes.array(
            solution.undetermined[0], changes.parameters[0] if changes.parameters else "x"
        )
