"""Time derivatives of a graph's outputs against differences of outputs."""

import numpy as np
import pytest
from balance import columns_at, settle
from conftest import CASES, NAMES
from internals import EvaluationMethod, Slopes

from lagrange_casadi import derive, load_case

STEP, NEAR = 3e-6, 1e-6
"""Of the span, and of what is compared."""


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", NAMES)
def test_rates_are_those_of_differences(name):
    scene = load_case(CASES / name).scene
    program, values = derive(scene), scene.mechanism.values()
    start, span, found = scene.span[0], scene.span[1] - scene.span[0], []
    p, outputs, many = [*values.values()], program.outputs, len(program.outputs)
    slopes = Slopes.of(program, [*outputs], None, EvaluationMethod("vm"))
    for t in start + np.array([0.1234, 0.5678, 0.8765]) * span:
        z = settle(program, t, p, start).full().ravel()
        there = np.full(many, t), np.tile(z, (many, 1)), np.array(p), np.arange(many)
        at = slopes.at(*there, np.full(many, np.nan))
        before, after = (
            np.array([*columns_at(program, t + by, values)[0].values()])[[*outputs.values()]]
            for by in (-STEP * span, STEP * span)
        )
        wrong = np.abs((after - before) / (2 * STEP * span) - at.rate)
        sizes = np.abs(at.value) + 1e-3 * np.abs(at.value).max()
        allowed = NEAR * (np.abs(at.rate) + sizes / span)
        found.append((at.value, np.abs(at.rate) > 100 * allowed))
        assert not [str([*outputs][k]) for k in np.flatnonzero(~(wrong <= allowed))]
    values, moves = map(np.array, zip(*found, strict=True))
    changes = np.ptp(values, axis=0) > 1e-6 * np.abs(values).max()
    assert np.mean(moves.any(axis=0)[changes]) >= 0.5
