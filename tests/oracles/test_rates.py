"""Time derivatives of a graph's outputs against differences in 50 digits."""

import numpy as np
import pytest
from balance import settle
from conftest import CASES, NAMES
from internals import EvaluationMethod, Slopes, arithmetic, interpret
from mpmath import mp
from truth import DIGITS

from lagrange_casadi import derive, load_case

STEP = 15
"""Differences are over ten to the minus so much of the span."""


def closed(program, z, time, driven, p):
    """The iterated coordinates to all digits."""
    size = mp.mpf(program.newton is not None)
    while size > mp.mpf(10) ** (4 - DIGITS):
        correction, (size,) = interpret(
            program.newton.step, [z, [time], driven[0], p], arithmetic()
        )
        z = [a + b for a, b in zip(z, correction, strict=True)]
    return z


def digits(program, t, p, z):
    """Columns in all digits, with iterated loops closed there from near by."""
    driven = interpret(program.motion, [[t], p], arithmetic())
    z = closed(program, z, t, driven, p)
    return np.array(interpret(program.instant, [[t], *driven, z, p], arithmetic())[0])


def differences(program, t, p, z, step):
    """Time derivatives of the columns, whose errors go with the square of the step."""
    with mp.workdps(DIGITS):
        p, z = ([mp.mpf(x) for x in numbers] for numbers in (p, z))
        after, before = (digits(program, mp.mpf(t) + e, p, z) for e in (step, -step))
        return ((after - before) / (2 * step)).astype(float)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", NAMES)
def test_rates_are_those_of_differences(name):
    """To rounding, of what changes and of what stands still."""
    scene = load_case(CASES / name).scene
    program, p = derive(scene), list(scene.mechanism.values().values())
    start, span = scene.span[0], scene.span[1] - scene.span[0]
    outputs, found = program.outputs, []
    slopes, many = Slopes.of(program, [*outputs], None, EvaluationMethod("vm")), len(outputs)
    for t in start + np.array([0.1234, 0.5678, 0.8765]) * span:
        z = settle(program, t, p, start).full().ravel()
        there = np.full(many, t), np.tile(z, (many, 1)), np.array(p), np.arange(many)
        at = slopes.at(*there, np.full(many, np.nan))
        out, rate = at.value, at.rate
        difference = differences(program, t, p, z.tolist(), mp.mpf(10) ** -STEP * span)
        difference = difference[[*outputs.values()]]
        allowed = 1e-10 * (np.abs(rate) + (np.abs(out) + 1e-3 * np.abs(out).max()) / span)
        wrong = ~(np.abs(difference - rate) <= allowed)
        assert not wrong.any(), [str([*outputs][k]) for k in np.flatnonzero(wrong)]
        found.append((out, np.abs(rate) > 100 * allowed))
    values, moves = map(np.array, zip(*found, strict=True))
    changes = np.ptp(values, axis=0) > 1e-6 * np.abs(values).max()
    assert np.mean(moves.any(axis=0)[changes]) > 0.9
