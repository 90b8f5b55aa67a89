"""Many designs at once: each against its own evaluation and refined peaks, on every rung, whatever
the neighbours.
"""

import math

import numpy as np
import pytest
from conftest import CASES, PLANAR
from design_rows import alone, around, assert_refined, peaks_of, scales, values
from internals import (
    DesignEngine,
    EvaluationMethod,
    Status,
    library,
    refine,
)
from mechanisms import four_bar, parallelogram, pendulum, slider_crank
from parametric import declared

from lagrange_casadi import Mechanism, Scene, evaluate, motion
from lagrange_casadi.errors import AssemblyError, DeclarationError

INSTANTS = 128
FIELDS = ("status", "value", "t", "xi", "mean", "rms")


@pytest.mark.sampled(14)
@pytest.mark.parametrize("name", PLANAR)
def test_designs_are_their_own_evaluations(name):
    """Every number of a case a parameter; a design whose loops do not close has no result in either
    way.
    """
    scene = declared(CASES / name)
    designs = DesignEngine.of(scene, t=(*scene.t[:2], INSTANTS), method=EvaluationMethod("c"))
    p = around(scene, 3)
    outcome = designs.evaluate(p)
    assert outcome.status[0] == Status.OK
    for row in range(3):
        if outcome.status[row] == Status.OUT_OF_REACH:
            with pytest.raises(AssemblyError, match="its links do not reach"):
                alone(scene, p[row], (*scene.t[:2], INSTANTS))
            continue
        assert outcome.status[row] == Status.OK
        assert_refined(scene, designs, outcome, row, p[row])
        solution = alone(scene, p[row], (*scene.t[:2], INSTANTS))
        for k, effort in enumerate(designs.efforts):
            series = solution.array(effort)
            weights = np.ones(series.size)
            weights[[0, -1]] = 0.5
            size = 1e-13 * np.abs(series).max()
            assert outcome.mean[row, k] == pytest.approx(
                np.average(series, weights=weights), abs=size
            )
            assert outcome.rms[row, k] == pytest.approx(
                math.sqrt(np.average(series**2, weights=weights)), rel=1e-13
            )


@pytest.mark.sampled(9)
@pytest.mark.parametrize("name", ["slider_crank", "quick_return", "sleigh", "rrr3"])
def test_all_rungs_agree(name):
    """Packs, scalar C and NumPy to rounding; single precision as far as it goes; steps of Newton's
    method where they are enough.
    """
    scene = declared(CASES / name)
    p, grid = around(scene, 9), (*scene.t[:2], INSTANTS)
    p[1, 0] = math.nan
    exact = DesignEngine.of(scene, t=grid, method=EvaluationMethod("c"))
    expected = exact.evaluate(p)
    methods = [(EvaluationMethod("lanes"), 1e-12), (EvaluationMethod("vm"), 1e-12)]
    methods += (
        [(EvaluationMethod("lanes", newton=4), 1e-12)] if exact.program.newton is not None else []
    )
    methods += [(EvaluationMethod(backend, "single"), 2e-5) for backend in ("lanes", "c")]
    for method, tolerance in methods:
        some = 2 if method.backend == "vm" else 9
        designs = DesignEngine.of(scene, t=grid, method=method)
        assert (designs.quantities, designs.provenance.backend) == (
            exact.quantities,
            method.backend,
        )
        outcome = designs.evaluate(p[:some])
        assert np.array_equal(outcome.status, expected.status[:some])
        assert outcome.status[1] == Status.INVALID
        for row in np.flatnonzero(outcome.status == Status.OK):
            scale = scales(exact, expected, row)
            for k, quantity in enumerate(exact.quantities):
                one, other = abs(outcome.value[row, k]), abs(expected.value[row, k])
                assert one == other or abs(one - other) <= tolerance * (other + scale[quantity]), (
                    method,
                    quantity,
                )
            np.testing.assert_allclose(outcome.rms[row], expected.rms[row], rtol=50 * tolerance)


@pytest.mark.sampled(11)
@pytest.mark.parametrize(
    "method",
    [EvaluationMethod("lanes"), EvaluationMethod("c"), EvaluationMethod("lanes", "single")],
    ids=lambda method: method.options,
)
@pytest.mark.parametrize("name", ["slider_crank", "quick_return", "rrr3"])
def test_a_row_has_the_same_bytes_whatever_stands_beside_it(name, method, monkeypatch):
    scene = declared(CASES / name)
    designs = DesignEngine.of(scene, t=(*scene.t[:2], 61), method=method)
    p = around(scene, 40, spread=0.7 if name == "slider_crank" else 0.3)
    whole = designs.evaluate(p, threads=1, histories=True)
    assert len(set(whole.status.tolist())) > 1
    for fresh in (designs, DesignEngine.of(scene, t=(*scene.t[:2], 61), method=method)):
        order = np.random.default_rng(1).permutation(40)
        other = fresh.evaluate(p[order], histories=True)
        assert all(
            getattr(other, f).tobytes() == getattr(whole, f)[order].tobytes()
            for f in (*FIELDS, "series")
        )
    monkeypatch.setattr(library, "_WORTH_A_THREAD", 0)
    monkeypatch.setattr(library, "_LONGEST", 3)
    cut = DesignEngine.of(scene, t=(*scene.t[:2], 61), method=method)
    assert cut.library.share(61) == 1
    for threads in (1, 2, 3, 7):
        other = cut.evaluate(p, threads=threads)
        assert all(getattr(other, f).tobytes() == getattr(whole, f).tobytes() for f in FIELDS)


@pytest.mark.parametrize("backend", ["lanes", "c"])
def test_histories_that_go_past_the_caches_have_the_same_bits(backend):
    """Many designs together fill lines of the cache that single ones write as they come."""
    scene = declared(CASES / "slider_crank")
    designs = DesignEngine.of(scene, t=(*scene.t[:2], 128), method=EvaluationMethod(backend))
    p = around(scene, 1 + (5 << 20) // (len(designs.columns) * 128 * 8), spread=0.1)
    whole = designs.evaluate(p, threads=1, histories=True).series
    for k in range(0, len(p), 29):
        assert designs.evaluate(p[k : k + 1], histories=True).series.tobytes() == whole[k].tobytes()


def bare(designs, p):
    """What the C leaves in arrays that held NaN."""
    n, q, e = len(p), len(designs.quantities), len(designs.efforts)
    shapes = {"value": q, "peak_t": q, "xi": q, "mean": e, "rms": e}
    results = {"status": np.full(n, -1, np.int8)} | {
        name: np.full((n, many), np.nan) for name, many in shapes.items()
    }
    history = np.full((n, len(designs.program.columns), designs.t.size), np.nan)
    designs.library.designs(
        designs.t[None], np.zeros((1, 0), bool), p, {**results, "history": history}
    )
    return results


@pytest.mark.quick
@pytest.mark.parametrize("backend", ["lanes", "c"])
def test_every_value_is_written_or_is_nan(backend):
    scene = slider_crank()
    designs = DesignEngine.of(scene, method=EvaluationMethod(backend))
    p = around(scene, 5)
    p[2, 1] = 0.05
    found = bare(designs, p)
    status, value, t, xi, mean, rms = found.values()
    good = status == Status.OK
    assert good.tolist() == [True, True, False, True, True]
    along = np.array([name.startswith("section:") for name in designs.quantities])
    for array in (value, t, mean, rms):
        assert np.isfinite(array[good]).all()
        assert np.isnan(array[~good]).all()
    assert np.array_equal(np.isfinite(xi), good[:, None] & along)
    # And what held numbers holds NaN after a design without a result.
    results = {name: np.zeros_like(array) for name, array in found.items()}
    designs.library.designs(
        designs.t[None], np.zeros((1, 0), bool), p, {**results, "history": None}
    )
    assert all(np.isnan(array[2]).all() for name, array in results.items() if name != "status")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", ["slider_crank", "four_bar", "rrr3", "quick_return"])
def test_histories_are_the_series_of_an_evaluation(name):
    scene = declared(CASES / name)
    designs = DesignEngine.of(scene, t=(*scene.t[:2], 41), method=EvaluationMethod("c"))
    p = around(scene, 2)
    outcome = designs.evaluate(p, histories=True)
    assert outcome.series.shape == (2, len(designs.columns), 41)
    for row in range(2):
        solution = evaluate(
            scene,
            parameters=values(scene, p[row]),
            t=(*scene.t[:2], 41),
            backend="c",
            certificate=False,
        )
        assert set(designs.columns) <= set(solution.series)
        for k, column in enumerate(designs.columns):
            assert outcome.series[row, k].tobytes() == solution.series[column].tobytes(), column
    p[:, list(designs.parameters).index("number0")] = math.nan
    assert np.isnan(designs.evaluate(p, histories=True).series).all()
    assert designs.evaluate(p).series is None


def test_a_speed_that_is_a_parameter_keeps_its_phase():
    """Where parameters set how far a drive turns, its turns are counted in pairs, whatever the
    defaults.
    """
    m = Mechanism("fast")
    speed = m.parameter("speed", 1.0, "rad/s")
    m.revolute("pin", m.ground, m.link("arm", length=0.5, mass=1.2))
    scene = Scene(m, {"pin": motion.expression(lambda t: speed * t)}, t=(1.0, 1.0 + 1e-7, 41))
    designs = DesignEngine.of(scene, method=EvaluationMethod("c"))
    p = np.array([[1.0], [1e8]])
    outcome = designs.evaluate(p, histories=True)
    k = designs.columns.index("effort:pin")
    for row in range(2):
        solution = evaluate(scene, parameters={"speed": p[row, 0]}, backend="c", certificate=False)
        np.testing.assert_allclose(
            outcome.series[row, k], solution.effort("pin"), rtol=0, atol=1e-14 * 3
        )


def test_what_is_not_determined_has_no_number():
    scene = parallelogram(pendulum=True)
    designs = DesignEngine.of(scene, method=EvaluationMethod("c"))
    outcome = designs.evaluate(np.zeros((1, 0)))
    told = {
        name
        for name, value in zip(designs.quantities, outcome.value[0], strict=True)
        if np.isfinite(value)
    }
    assert not [
        name for name in told if name.startswith(("reaction:A", "section:bar", "section:b:axial"))
    ]
    assert {
        "effort:hang",
        "reaction:hang:resultant",
        "section:bob:bending",
        "section:b:bending",
    } <= told
    solution = evaluate(scene, backend="c", certificate=False)
    names = ["effort:O", "effort:hang", "reaction:hang:fx", "section:bob:bending"]
    found = peaks_of(designs, outcome, 0)
    for peak in refine(scene, solution, names):
        assert found[peak.name][0] == pytest.approx(peak.value, rel=1e-11)


def test_names_and_units_go_together():
    designs = DesignEngine.of(slider_crank(), ["reaction:guide", "effort", "section:rod"])
    assert designs.quantities == (
        *("effort:O", "reaction:guide:resultant", "reaction:guide:fx", "reaction:guide:fy"),
        *("section:rod:axial", "section:rod:shear", "section:rod:bending"),
    )
    assert designs.units == ("N m", "N", "N", "N", "N", "N", "N m")
    assert (designs.efforts, designs.parameters) == (("effort:O",), ("r", "l", "m1", "m2", "m3"))


def test_misuse_is_named():
    scene = four_bar()
    with pytest.raises(DeclarationError, match="not read from a table"):
        DesignEngine.of(scene, method=EvaluationMethod(table=64))
    with pytest.raises(DeclarationError, match=r"expected an array of shape \(n, 0\), got \(3,\)"):
        DesignEngine.of(scene).evaluate(np.zeros(3))
    with pytest.raises(DeclarationError, match="samples of the motion"):
        DesignEngine.of(
            pendulum(motion.samples([0, 1, 2, 3], [0, 1, 0, 2]), t=(0, 1, 3)), t=(0, 4, 3)
        )
    empty = DesignEngine.of(scene).evaluate(np.zeros((0, 0)))
    assert empty.value.shape == (0, len(DesignEngine.of(scene).quantities))
    with pytest.raises(AssemblyError):
        evaluate(slider_crank(), parameters={"l": 0.05})
