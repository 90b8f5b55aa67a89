"""Peaks that are those of the instants, and the bound of what they miss."""

import numpy as np
import pytest
from internals import DesignEngine, EvaluationMethod, Status, check_sweep
from mechanisms import pendulum
from random_mechanisms import draw

from lagrange_casadi import best, load_case, motion, prepare, sweep
from lagrange_casadi.errors import DeclarationError, LagrangeCasadiError, UnknownNameError


def both(scene, t, backend="c"):
    """Exact and sampled peaks of the defaults, as (values, errors); None where there are none."""
    p = np.array([[*scene.mechanism.values().values()]])
    exact, sampled = (
        DesignEngine.of(scene, t=t, method=EvaluationMethod(backend), peaks=peaks).evaluate(p)
        for peaks in ("exact", "sampled")
    )
    assert exact.error is None
    if exact.status[0] != Status.OK:
        return None
    assert sampled.status[0] == Status.OK
    return np.abs(exact.value[0]), np.abs(sampled.value[0]), sampled.error[0]


def assert_covered(found):
    exact, sampled, error = found
    told = ~np.isnan(exact)
    assert (np.isnan(error) == ~told).all()
    assert (sampled[told] <= exact[told]).all()
    assert (exact[told] <= sampled[told] + error[told]).all()


CASES = ["slider_crank", "four_bar", "beam_pump", "quick_return", "arm6", "rssr", "scara", "engine"]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("count", [5, 19, 64])
@pytest.mark.parametrize("name", CASES)
def test_the_error_covers_what_the_instants_miss(name, count):
    """The exact search is at most so much above the largest value at few instants."""
    scene = load_case(name).scene
    span = scene.timing(None)
    found = both(scene, (span.start, span.stop, count))
    if found:
        assert_covered(found)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("seed", range(12))
def test_the_error_covers_random_mechanisms(seed):
    """So it is for mechanisms with any joints, loads and laws of motion."""
    drawn = draw(seed)
    start, stop, _ = drawn.grid
    for count in (9, 33):
        try:
            found = both(drawn.scene(), (start, stop, count))
        except LagrangeCasadiError:
            continue
        if found:
            assert_covered(found)


@pytest.mark.quick
@pytest.mark.parametrize("backend", ["lanes", "c", "vm"])
@pytest.mark.parametrize("count", [16, 17, 41])
def test_the_error_of_a_wave_is_what_bends_it(backend, count):
    """An effort proportional to cos(w t): between values y it may rise by half their second
    difference; the largest value, and what that says, are those of the closed form.
    """
    scene = pendulum(motion.polynomial(0.3, 4.0), t=(0, 1.1, count))
    designs = DesignEngine.of(scene, method=EvaluationMethod(backend), peaks="sampled")
    found = designs.evaluate(np.zeros((1, 0)))
    k = designs.quantities.index("effort:pin")
    y = 1.2 * 9.81 * 0.25 * np.cos(0.3 + 4.0 * np.linspace(0, 1.1, count))
    largest = np.abs(y).max()
    ends = [2 * b - c + np.copysign(2 * abs(2 * c - b - d), -b) for b, c, d in (y[:3], y[:-4:-1])]
    longer = np.concatenate([ends[:1], y, ends[1:]])
    reach = np.abs(y - np.diff(longer, 2) / 2).max()
    assert abs(found.value[0, k]) == pytest.approx(largest, rel=1e-13)
    assert found.t[0, k] == pytest.approx(np.linspace(0, 1.1, count)[np.abs(y).argmax()])
    assert found.error[0, k] == pytest.approx(reach - largest, rel=1e-9, abs=1e-11)


@pytest.mark.parametrize("backend", ["lanes", "vm"])
def test_nothing_bounds_few_instants_and_one_instant_misses_nothing(backend):
    method = EvaluationMethod(backend)
    for count, error in ((1, 0.0), (2, np.inf), (6, np.inf)):
        scene = pendulum(motion.polynomial(0.3, 4.0), t=(0.1, 0.1 if count == 1 else 1, count))
        designs = DesignEngine.of(scene, method=method, peaks="sampled")
        found = designs.evaluate(np.zeros((1, 0)))
        np.testing.assert_allclose(found.error[0], error, atol=1e-10)


def test_a_sweep_keeps_errors(tmp_path):
    """They are columns beside the peaks, at all instants the largest value; a file says so, and
    readers show them.
    """
    scene, grid = load_case("slider_crank").scene, {"l": (0.2, 0.4, 5)}
    asked = {"wanted": ["effort", "section:rod"], "t": (0, 0.08, 33)}
    exact = sweep(scene, grid, out=tmp_path / "exact.h5", **asked)
    found = sweep(scene, grid, out=tmp_path / "sampled.h5", peaks="sampled", **asked)
    assert not any(name.startswith("peak_error:") for name in exact.columns)
    assert found.identity["rung"].endswith("sampled peaks")
    assert check_sweep(found.path) == []
    for name in ("effort:O", "section:rod:bending"):
        missed = np.abs(exact[f"peak:{name}"]) - np.abs(found[f"peak:{name}"])
        assert (missed >= 0).all()
        assert missed.max() > 0
        assert (missed <= found[f"peak_error:{name}"]).all()
        assert found.unit(f"peak_error:{name}") == found.unit(f"peak:{name}")
    chosen = best(found, minimise="peak:effort:O")[0].values
    assert list(chosen) == ["l", "peak:effort:O", "peak_error:effort:O"]
    same = sweep(scene, grid, peaks="sampled", workers=2, **asked)
    np.testing.assert_array_equal(same["peak_error:effort:O"], found["peak_error:effort:O"])


def test_sampled_peaks_have_no_derivatives():
    scene = load_case("slider_crank").scene
    ready = prepare(scene, peaks="sampled")
    assert (ready.peaks(l=0.3).error >= 0).all()
    assert prepare(scene).peaks().error is None
    for ask in (ready.gradient, ready.curvature):
        with pytest.raises(DeclarationError, match="peaks: 'sampled' ones have no derivatives"):
            ask()
    with pytest.raises(DeclarationError, match="need exact ones"):
        sweep(scene, {"l": (0.2, 0.4, 2)}, peaks="sampled", wanted=["sensitivity", "effort"])
    with pytest.raises(UnknownNameError, match="valid: exact, sampled"):
        prepare(scene, peaks="nearly")
