"""Why a design has no result: as its own evaluation is refused, by every backend."""

import contextlib
import math
from dataclasses import replace

import numpy as np
import pytest
from design_rows import around, values
from internals import Status
from mechanisms import (
    crank_slider,
    double_crank,
    flat_parallelogram,
    slider_crank,
    standing_rod,
    truss_platform,
)
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, evaluate, load_case, prepare
from lagrange_casadi.errors import AssemblyError, ParameterError
from lagrange_casadi.motion import polynomial

SAYS = {
    Status.OUT_OF_REACH: "cannot be closed",
    Status.DEAD_CENTRE: "is at a dead centre",
    Status.PASSES_DEAD_CENTRE: "passes a dead centre",
    Status.NOT_CONVERGED: "did not converge",
    Status.JUMPED: "jumped",
    Status.MISFIT: "do not fit",
    Status.LOST_CONTACT: "contact 'foot' (pulls|slides)",
}


@pytest.fixture(autouse=True)
def _bare(monkeypatch):
    """Tell of a refusal its reason alone, for to draw how far parts are apart takes longest."""
    monkeypatch.setattr("lagrange_casadi.engine.placement._explain", lambda *_: None)


def quarter():
    """A slider-crank whose crank goes from along its guide to right across."""
    law = {"O": polynomial(0.0, math.pi / 2)}
    return Scene(crank_slider(), law, t=(0, 1, 3), posture={"rod": 0.0})


def bridge():
    m = Mechanism("bridge")
    a, b = m.link("a", length=1, mass=1), m.link("b", length=1, mass=1)
    m.weld("W1", m.ground, a)
    m.weld("W2", m.ground.at(1, 0), b)
    m.weld("W3", a.tip, b, angle=m.parameter("angle", 0.0, "rad"))
    return Scene(m, {}, ("motion",), t=(0, 1, 3))


def lengths(ratios):
    return [[0.1, 0.1 * ratio, 0.1, 0.1, 0.1] for ratio in ratios]


PASSES, REACH, LOST = Status.PASSES_DEAD_CENTRE, Status.OUT_OF_REACH, Status.LOST_CONTACT
ROWS = {
    "on an instant": (quarter, lengths([1.0, 1.1, 0.9]), [Status.DEAD_CENTRE, 0, REACH]),
    "between instants": (flat_parallelogram, [[]], [PASSES]),
    "about a dead centre": (
        lambda: slider_crank(["effort"]),
        lengths([1.0, 1.0001, 1.01, 0.9999, -1.0, 0.0, math.nan]),
        [PASSES, 0, 0, REACH, Status.IMPOSSIBLE, Status.IMPOSSIBLE, Status.INVALID],
    ),
    "iterated": (truss_platform, [[0.05], [5.0], [0.04]], [0, Status.NOT_CONVERGED, 0]),
    "small steps": (lambda: double_crank(1.0), [[]], [0]),
    "large steps": (lambda: double_crank(2.3), [[]], [Status.JUMPED]),
    "contact": (standing_rod, [[0.5, 0.0], [0.05, 0.0], [0.5, 30.0]], [0, LOST, LOST]),
    "welds": (bridge, [[0.0], [math.pi], [0.1]], [0, Status.MISFIT, Status.MISFIT]),
}


def assert_is_own(scene, row, status):
    """A design's own evaluation is refused in the words of its status, or has a result."""
    words, expected = SAYS.get(status, ""), contextlib.nullcontext()
    if status in (Status.IMPOSSIBLE, Status.INVALID):
        expected = pytest.raises(ParameterError)
    elif status not in (Status.OK, Status.PEAK_NOT_TOLD):
        expected = pytest.raises(AssemblyError, match=words)
    with expected:
        evaluate(scene, parameters=values(scene, row), certificate=False)


@pytest.mark.parametrize("backend", ["lanes", "c"])
@pytest.mark.parametrize("name", ROWS)
def test_a_design_has_the_status_of_its_own_evaluation(name, backend):
    """One that has no result has no number."""
    make, rows, statuses = ROWS[name]
    scene, p = make(), np.array(rows)
    found = prepare(scene, backend=backend).designs(p, histories=True)
    assert found.status.tolist() == statuses
    for numbers in (found.value, found.t, found.xi, found.mean, found.rms, found.series):
        assert not np.isfinite(numbers[found.status != Status.OK]).any()
    for row, status in zip(p, statuses, strict=True):
        assert_is_own(scene, row, status)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("backend", ["lanes", "c"])
@pytest.mark.parametrize("seed", range(4))
def test_drawn_designs_fail_as_their_own_evaluations(seed, backend):
    """Crank-rockers, double rockers, change points and what cannot be closed; and cranks that are
    all but as long as their rods.
    """
    generator = np.random.default_rng(seed)
    near = 1 + generator.choice([-1, 1], 8) * 10.0 ** generator.uniform(-8, -2, 8)
    for scene, p in (
        (load_case("four_bar").scene, around(load_case("four_bar").scene, 12, 0.6, seed)),
        (slider_crank(["effort"]), np.array(lengths(near))),
        (iterated(["effort"]), around(iterated(["effort"]), 6, 0.6, seed)),
    ):
        scene = replace(scene, t=(*scene.span, 61))
        found = prepare(scene, backend=backend).designs(p).status
        for row, status in zip(p, found, strict=True):
            assert_is_own(scene, row, status)
        assert (found == 0).any()
