"""Peaks of designs, between the instants and along links, of any shape."""

import math

import casadi as ca
import numpy as np
import pytest
from design_rows import DENSITIES, alone, assert_refined, loaded, peaks_of, values
from internals import (
    ContinuousSolution,
    Curves,
    DesignEngine,
    EvaluationMethod,
    Samples,
    Status,
    forces,
)
from mechanisms import crank_and_rod, pendulum

from lagrange_casadi import Mechanism, Scene, codegen, evaluate, motion
from lagrange_casadi.motion import polynomial

both = pytest.mark.parametrize("backend", ["lanes", "vm"])


@pytest.mark.sampled(9)
@pytest.mark.parametrize("matter", DENSITIES)
def test_any_density_and_any_station(matter):
    """Along the link exact: nothing on a fine grid is larger, and the peaks are those of the
    section law; packs find the same.
    """
    scene = crank_and_rod(DENSITIES[matter](), loads=loaded)
    grid, wanted = (0.3, 2.3, 61), ["section:b", "reaction:A"]
    p = np.array([[0.2], [0.1], [0.35], [0.0], [0.31], [0.36]])
    designs, packs = (
        DesignEngine.of(scene, wanted, t=grid, method=EvaluationMethod(backend))
        for backend in ("c", "lanes")
    )
    outcome, other = designs.evaluate(p), packs.evaluate(p)
    assert outcome.status.tolist() == other.status.tolist() == [Status.OK] * 5 + [Status.IMPOSSIBLE]
    np.testing.assert_allclose(other.value, outcome.value, rtol=1e-11, atol=1e-11)
    for row in range(5):
        assert_refined(scene, designs, outcome, row, p[row])
        found = peaks_of(designs, outcome, row)
        for name in ("section:b:axial", "section:b:shear", "section:b:bending"):
            value, t, xi = found[name]
            there = alone(scene, p[row], (t, t, 1), xi=(0, 1, 4001))
            assert abs(value) >= np.abs(there.array(name)).max() * (1 - 1e-13)
            law = there.section("b").law
            sides = [
                float(law.at(name.split(":")[2], np.array([[xi]]), side)[0, 0])
                for side in ("tip", "base")
            ]
            assert min(abs(value - side) for side in sides) <= 1e-11 * abs(value)


@both
def test_of_peaks_as_large_the_first_is_told(backend):
    """Else rounding would choose between tops and troughs of many turns, and the sign with them."""
    designs = DesignEngine.of(
        pendulum(polynomial(0.1, 3.0), t=(0, 6.0, 91), wanted=["effort"]),
        method=EvaluationMethod(backend),
    )
    value, t, _ = peaks_of(designs, designs.evaluate(np.zeros((1, 0))), 0)["effort:pin"]
    assert value == pytest.approx(-1.2 * 9.81 * 0.25, rel=1e-12)
    assert t == pytest.approx((math.pi - 0.1) / 3.0, abs=1e-6)


@pytest.mark.sampled(9)
@pytest.mark.parametrize("backend", ["lanes", "c"])
@pytest.mark.parametrize("seed", [1, 2])
def test_random_curves_have_the_peaks_of_the_reference(seed, backend):
    """The search in C against the one in ``peak_search/search.py``, which designs without a
    compiler take.
    """
    generator, many = np.random.default_rng(seed), 16
    m = Mechanism("wave")
    names = ["a", "v", "start", "b", "w", "then", "height", "place", "width"]
    a, v, start, b, w, then, height, place, width = (m.parameter(name, 1.0) for name in names)
    m.revolute("pin", m.ground, m.link("arm", length=0.5, mass=1.2))

    def law(t):
        return (
            a * ca.sin(v * t + start)
            + b * ca.sin(w * t + then)
            + height * ca.exp(-(((t - place) / width) ** 2))
        )

    scene = Scene(
        m, {"pin": motion.expression(law)}, ["motion", "effort", "section:arm"], t=(0.0, 2.0, 41)
    )
    low = [-1, 0.5, 0, -0.5, 4, 0, -1, 0.0, 0.05]
    high = [1, 4.0, 6, 0.5, 12, 6, 1, 2.0, 0.5]
    p = generator.uniform(low, high, (many, len(names)))
    designs, reference = (
        DesignEngine.of(scene, method=EvaluationMethod(name)) for name in (backend, "vm")
    )
    found, expected = designs.evaluate(p), reference.evaluate(p)
    assert designs.quantities == reference.quantities
    assert found.status.tolist() == expected.status.tolist()
    told = expected.status == Status.OK
    assert told.sum() > many / 2
    sizes = np.abs(expected.value[told])
    np.testing.assert_array_less(
        np.abs(found.value[told] - expected.value[told]), 1e-9 * sizes + 1e-12
    )
    # A summit of size one is flat within 1e-9 of it for some 1e-5 of its width.
    np.testing.assert_allclose(found.t[told], expected.t[told], atol=1e-4)
    instants = (0.0, 2.0, 4001)
    fine = [
        evaluate(scene, parameters=values(scene, row), t=instants, certificate=False)
        for row in p[told][:4]
    ]
    largest = np.array([[np.abs(solution.array("motion:pin")).max()] for solution in fine])
    np.testing.assert_allclose(found.xi[told], expected.xi[told], atol=1e-4)
    k = designs.quantities.index("motion:pin")
    assert (np.abs(found.value[told][:4, k : k + 1]) >= largest * (1 - 1e-12)).all()


def lift(law, count):
    """A cage that is held, goes up and is held again, and rubs on its mast."""
    m = Mechanism("lift")
    cage = m.link("cage", length=0.2, mass=5.0, centre=(0.0, 0.0), inertia=0.01)
    m.friction("rub", m.prismatic("mast", m.ground, cage, axis=(0, 1)), mu=0.2, length=0.1)
    m.force("wind", cage, x=30.0)
    way = motion.moves([motion.dwell(0.1), motion.move(0.5, time=0.3, law=law), motion.dwell(0.2)])
    return Scene(m, {"mast": way}, t=(0.0, 0.6, count), wanted=["effort"])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("law", ["trapezoid", "cycloidal"])
def test_refined_peaks_are_those_of_the_reference(law):
    """By the compiled search as by NumPy, also beside rest, and what the evaluation raises comes
    through it.
    """
    scene = lift(law, 8)
    solution = evaluate(scene, backend="c", certificate=False)
    sampled = [solution.peak(name) for name in forces(solution)]
    found, expected = (
        ContinuousSolution.of(scene, solution, backend).peaks(sampled) for backend in ("c", "vm")
    )
    for one, other in zip(found, expected, strict=True):
        assert one.value == pytest.approx(other.value, rel=1e-12)
        assert one.t == pytest.approx(other.t, abs=1e-7) or abs(one.value) == pytest.approx(
            abs(other.value), rel=1e-13
        )


def test_what_an_evaluation_raises_ends_the_search():
    """An interrupt too: it passes through C as a number."""

    class Broken:
        def at(self, t):
            raise KeyboardInterrupt

    t = np.linspace(0.0, 1.0, 21)
    samples = Samples(np.sin(9 * t)[None], np.full((1, 21), np.nan), np.zeros((0, 21)))
    compiler = codegen.find_compiler("c")
    with pytest.raises(KeyboardInterrupt):
        codegen.load_search(compiler).peaks(
            Broken(), Curves((0,), (0,)), t, samples, np.ones(20, bool)
        )
