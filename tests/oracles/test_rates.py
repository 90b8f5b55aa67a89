"""Time derivatives of a graph's columns: against differences in 50 digits, and a closed form."""

import math

import casadi as ca
import numpy as np
import pytest
from balance import settle
from condition import DIGITS, closed
from conftest import CASES, NAMES
from internals import arithmetic, interpret, rates
from mechanisms import LENGTH, MASS, G, pendulum
from mpmath import mp

from lagrange_casadi import derive, load_case, motion

STEP = 15
"""Differences are over ten to the minus so much of the span."""


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
    found = []
    for t in start + np.array([0.1234, 0.5678, 0.8765]) * span:
        z = settle(program, t, p, start).full().ravel()
        out, rate = (x.full().ravel() for x in rates(program)(np.r_[t, z], p))
        difference = differences(program, t, p, z.tolist(), mp.mpf(10) ** -STEP * span)
        allowed = 1e-10 * (np.abs(rate) + (np.abs(out) + 1e-3 * np.abs(out).max()) / span)
        wrong = ~(np.abs(difference - rate) <= allowed)
        assert not wrong.any(), [program.names[k] for k in np.flatnonzero(wrong)]
        found.append((out, np.abs(rate) > 100 * allowed))
    values, moves = map(np.array, zip(*found, strict=True))
    changes = np.ptp(values, axis=0) > 1e-6 * np.abs(values).max()
    assert np.mean(moves.any(axis=0)[changes]) > 0.9


@pytest.mark.quick
def test_rates_are_those_of_a_closed_form():
    """A pendulum: I theta'' + m g l/2 cos theta, and what holds its centre on its circle."""
    scene = pendulum(motion.expression(lambda t: 0.4 * ca.sin(3 * t) + t))
    program, h, inertia = derive(scene), LENGTH / 2, MASS * LENGTH**2 / 3
    for t in (0.0, 0.37, 1.9):
        th, w = 0.4 * math.sin(3 * t) + t, 1.2 * math.cos(3 * t) + 1
        a, j = -3.6 * math.sin(3 * t), -10.8 * math.cos(3 * t)
        c, s = math.cos(th), math.sin(th)
        exact = {
            "motion:pin": w,
            "motion:pin_rate": a,
            "motion:pin_acceleration": j,
            "effort:pin": inertia * j - MASS * G * h * s * w,
            "reaction:pin:fx": -MASS * h * (j * s + a * c * w + 2 * w * a * c - w**3 * s),
            "reaction:pin:fy": MASS * h * (j * c - a * s * w - 2 * w * a * s - w**3 * c),
        }
        rate = rates(program)(t, [])[1].full().ravel()
        found = dict(zip(program.names, rate, strict=True))
        assert {name: found[name] for name in exact} == pytest.approx(exact, rel=1e-12, abs=1e-12)
