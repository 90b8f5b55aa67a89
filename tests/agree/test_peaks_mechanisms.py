"""Peaks of mechanisms whose instants say little of them, against 100 001 instants: `refine`, and
designs with and without C.
"""

import math

import numpy as np
import pytest
from internals import DesignEngine, EvaluationMethod, Status, forces

from lagrange_casadi import Mechanism, Scene, evaluate, refine
from lagrange_casadi.motion import polynomial


def crank_rocker(lengths, ground, start, count):
    """One turn of a crank, from an angle on."""
    m = Mechanism("crank_rocker")
    a, b, c = (
        m.link(name, length=l, mass=mass)
        for name, l, mass in zip("abc", lengths, (0.5, 0.7, 0.6), strict=True)
    )
    m.revolute("O", m.ground, a)
    m.revolute("P", m.ground.at(ground, 0), c)
    m.revolute("Q", a.tip, b)
    m.revolute("R", b.tip, c.tip)
    return Scene(
        m,
        {"O": polynomial(start, 8.0)},
        posture={"a": start, "b": 0.3, "c": 2.5},
        t=(0, math.tau / 8, count),
    )


def slider_crank(ratio, count):
    """One turn of a crank, so long beside its rod, from beside a dead centre's quarter on."""
    m = Mechanism("slider_crank")
    crank = m.link("crank", length=ratio * 0.3, mass=0.5)
    rod = m.link("rod", length=0.3, mass=0.7)
    slide = m.point_mass("slide", 1.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, slide)
    m.prismatic("guide", m.ground, slide, axis=(1, 0))
    return Scene(
        m,
        {"O": polynomial(0.3, 10.0)},
        posture={"crank": 0.3, "rod": -0.1},
        t=(0, math.tau / 10, count),
    )


def folding(shortage, start):
    """A crank-rocker that all but folds: its ground is shorter by so much than that at which it
    would.
    """
    return lambda count: crank_rocker(
        (0.1, 0.3, 0.25), (0.3 + 0.25 - 0.1) * (1 - shortage), start, count
    )


SCENES = {
    "begins near folding": folding(1e-2, math.pi),
    "begins beside folding": folding(1e-3, math.pi - 0.03),
    "all but folds": folding(1e-4, 0.0),
    "a rod all but as long as the crank": lambda count: slider_crank(0.9999, count),
    "one yet shorter": lambda count: slider_crank(0.99997, count),
}


def assert_none_is_short(make, *counts):
    dense = evaluate(make(100_001), certificate=False)
    for count in counts:
        _assert_none_is_short(make(count), dense)


def _assert_none_is_short(scene, dense):
    solution = evaluate(scene, certificate=False)
    names = forces(solution)
    true = {name: abs(dense.peak(name).value) for name in names}
    units = {dense.unit(name) for name in names}
    scale = {unit: max(true[name] for name in names if dense.unit(name) == unit) for unit in units}
    least = {name: true[name] * (1 - 1e-11) - 1e-11 * scale[dense.unit(name)] for name in names}
    found = {peak.name: abs(peak.value) for peak in refine(scene, solution, names)}
    assert not [name for name in names if not found[name] >= least[name]]
    for backend in ("lanes", "vm"):
        designs = DesignEngine.of(scene, method=EvaluationMethod(backend))
        outcome = designs.evaluate(np.array([list(scene.mechanism.values().values())]))
        assert outcome.status.tolist() == [Status.OK]
        peaks = dict(zip(designs.quantities, np.abs(outcome.value[0]), strict=True))
        # Of conditions near a dead centre: refine's iteration and C sum in other orders.
        assert not [name for name in names if not peaks[name] >= least[name]], backend
        assert not [
            name
            for name in names
            if not abs(peaks[name] - found[name]) <= 1e-9 * scale[dense.unit(name)]
        ], backend


@pytest.mark.sampled(97)
@pytest.mark.parametrize("name", SCENES)
def test_no_peak_is_short(name):
    assert_none_is_short(SCENES[name], 51, 101)


@pytest.mark.sampled(9)
@pytest.mark.parametrize("seed", range(4))
def test_random_crank_rockers(seed):
    random = np.random.default_rng(seed)
    others = np.sort(random.uniform(0.3, 0.5, 3))
    short = min(
        random.uniform(0.1, 0.3),
        (others[0] + others[1] - others[2]) * (1 - 10 ** random.uniform(-4, -1)),
    )
    random.shuffle(others)
    start, count = random.uniform(0, math.tau), int(random.integers(30, 120))
    assert_none_is_short(
        lambda count: crank_rocker((short, *others[:2]), others[2], start, count), count
    )
