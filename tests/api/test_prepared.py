"""A prepared scene: what evaluate and sweeps say, call after call, and the same refusals."""

import math
from concurrent.futures import ThreadPoolExecutor

import casadi as ca
import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import Mechanism, Scene, evaluate, load_case, prepare
from lagrange_casadi.errors import AssemblyError, DeclarationError, ParameterError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick


def case(name):
    return load_case(CASES / name).scene


def few(scene, count=33):
    return (*scene.span, count)


@pytest.mark.parametrize("backend", ["c", "vm"])
def test_series_are_told_where_a_peak_cannot_be(backend):
    m = Mechanism("buzz")
    m.revolute("O", m.ground, m.link("arm", length=m.parameter("l", 0.3, "m"), mass=1.0))
    m.output("fast", ca.sin(1e6 * m.time))
    f = prepare(
        Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0, 1, 9), wanted=["output:fast"]), backend=backend
    )
    np.testing.assert_allclose(f(l=0.4)["output:fast"], np.sin(1e6 * f.t), atol=1e-9)
    if backend == "c":  # which is quick to find out
        with pytest.raises(AssemblyError, match="a peak cannot be located"):
            f.peaks(l=0.4)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("backend", ["auto", "c", "vm"])
def test_calls_are_the_rows_of_designs_to_the_last_byte(backend):
    """Whatever was asked for before, and by name or in a mapping; parameters that are not told have
    their defaults.
    """
    scene = case("slider_crank")
    f = prepare(scene, t=few(scene), wanted=["effort", "section:rod", "motion"], backend=backend)
    rows = np.tile(list(scene.mechanism.values().values()), (3, 1))
    rows[1, f.parameters.index("l")], rows[2, f.parameters.index("r")] = 0.25, 0.06
    assert tuple(f()) == f.outputs
    np.testing.assert_array_equal(f.t, evaluate(scene, t=few(scene)).t)
    found = f.designs(rows, histories=True)
    for k, values in enumerate([{}, {"l": 0.25}, {"r": 0.06}]):
        told = {name: np.array(row) for name, row in (f(values) if k % 2 else f(**values)).items()}
        for output, row in zip(f.outputs, found.series[k], strict=True):
            np.testing.assert_array_equal(told[output], row)
        peaks = f.peaks(**values)
        for name in ("value", "t", "xi", "mean", "rms"):
            np.testing.assert_array_equal(getattr(peaks, name), getattr(found, name)[k])


def test_peaks_are_those_of_the_solution():
    scene = case("slider_crank")
    f = prepare(scene, wanted=["effort", "section:rod"])
    peaks, solution = f.peaks(l=0.25), evaluate(scene, parameters={"l": 0.25})
    for name, value, t, xi in zip(f.quantities, peaks.value, peaks.t, peaks.xi, strict=True):
        expected = solution.peak(name)
        assert abs(value - expected.value) <= 1e-3 * abs(expected.value)
        assert abs(t - expected.t) <= scene.span[1] / 100
        assert math.isnan(xi) == (expected.xi is None)
    assert f.efforts == ("effort:O",)
    assert peaks.rms[0] >= abs(peaks.mean[0])


def test_a_result_is_kept_by_copying_it():
    """The arrays are the object's own: the next call writes into them.

    Another thread takes a copy of the object.
    """
    f = prepare(case("slider_crank"), wanted=["effort"])
    first = f(l=0.25)["effort:O"]
    kept = first.copy()
    second = f(l=0.3)["effort:O"]
    assert second is first or np.shares_memory(first, second)
    assert np.abs(first - kept).max() > 0
    g = f.copy()
    np.testing.assert_array_equal(g(l=0.25)["effort:O"], kept)
    np.testing.assert_array_equal(f(l=0.3)["effort:O"], second)


def test_threads_with_copies_of_their_own_do_not_disturb_each_other():
    f = prepare(case("slider_crank"), wanted=["effort"])
    lengths = np.linspace(0.2, 0.4, 8)
    alone = [f(l=x)["effort:O"].copy() for x in lengths]

    def often(k):
        g = f.copy()
        return [g(l=lengths[k])["effort:O"].copy() for _ in range(50)]

    with ThreadPoolExecutor(8) as pool:
        for k, rows in enumerate(pool.map(often, range(8))):
            for row in rows:
                np.testing.assert_array_equal(row, alone[k])


@pytest.mark.parametrize(
    "asked",
    [{"over": ("O", 0.0, 2 * math.pi, 25)}, {"t": (0.0, "1 / rpm", 25)}],
    ids=["over", "times"],
)
def test_instants_that_go_with_the_parameters(asked):
    """A motion whose speed is a parameter: the same turn at every speed, in other times."""
    m = Mechanism("wheel")
    rpm = m.parameter("rpm", 60.0, "1/min")
    arm = m.link("arm", length=0.3, mass=1.0)
    m.revolute("O", m.ground, arm)
    if "t" in asked:
        asked = {"t": (0.0, 60 / rpm, 25)}
    f = prepare(Scene(m, {"O": polynomial(0.1, 2 * math.pi / 60 * rpm)}, t=(0.0, 1.0, 11)), **asked)
    slow = {name: row.copy() for name, row in f().items()} | {"t": f.t.copy()}
    fast = f(rpm=120.0)
    np.testing.assert_allclose(f.t - f.t[0], (slow["t"] - slow["t"][0]) / 2, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(fast["motion:O"], slow["motion:O"], atol=1e-12)
    np.testing.assert_allclose(fast["effort:O"], slow["effort:O"], atol=1e-11)


def test_what_equilibrium_leaves_open_is_no_number():
    """What two hinges share is open, as an evaluation says; the rest is right."""
    scene = case("bricard")
    f = prepare(scene, t=few(scene, 5))
    solution = evaluate(scene, t=few(scene, 5), certificate=False)
    assert solution.undetermined
    for name, row in f().items():
        assert np.isfinite(row).all() == solution.determined(name), name


def test_values_by_name_and_in_mappings():
    f = prepare(case("slider_crank"), wanted=["effort"])
    named = f(r=0.11, l=0.25)["effort:O"].copy()
    for given in (({"r": 0.11}, None, {"l": 0.25}), ({"r": 0.5, "l": 0.25}, {"r": 0.11})):
        np.testing.assert_array_equal(f(*given)["effort:O"], named)


def test_mistakes():
    scene = case("slider_crank")
    f = prepare(scene, wanted=["effort"])
    with pytest.raises(UnknownNameError, match="parameter"):
        f(length=0.2)
    with pytest.raises(ParameterError, match="parameter 'l' must be a number"):
        f(l="long")
    with pytest.raises(ParameterError, match="finite"):
        f(l=math.nan)
    with pytest.raises(ParameterError, match="out of its range"):
        f.peaks({"l": -1.0})
    with pytest.raises(DeclarationError, match="prepare: scene: expected a Scene, got"):
        prepare(scene.mechanism)
    # An evaluation after a mistake is as one before it.
    np.testing.assert_array_equal(
        f(l=0.25)["effort:O"], prepare(scene, wanted=["effort"])(l=0.25)["effort:O"]
    )


def test_values_that_have_no_result_are_refused_as_evaluate_does():
    m = Mechanism("reach")
    r = m.parameter("r", 0.1, "m")
    crank, rod = m.link("crank", length=r, mass=1.0), m.link("rod", length=0.3, mass=1.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.prismatic("P", m.ground, m.point_mass("slider", 1.0), axis=(1, 0))
    m.revolute("B", rod.tip, m.bodies["slider"])
    scene = Scene(m, {"O": polynomial(0.0, 6.0)}, t=(0.0, 1.0, 41), posture={"rod": 0.0, "P": 0.4})
    f = prepare(scene)
    with pytest.raises(AssemblyError) as ours:
        f(r=0.5)
    with pytest.raises(AssemblyError) as theirs:
        evaluate(scene, parameters={"r": 0.5})
    assert str(ours.value) == str(theirs.value)
    assert "at t = " in str(ours.value)
    assert np.isfinite(f(r=0.1)["effort:O"]).all()
