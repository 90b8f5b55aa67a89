"""Peaks between instants, on signals of every kind, of one solution and of designs,
by both backends and in both precisions: none is short of many more instants, and those that cannot
be told are not told.
"""

import math

import casadi as ca
import numpy as np
import pytest
from internals import Status
from mechanisms import pendulum

from lagrange_casadi import evaluate, prepare, refine
from lagrange_casadi.motion import polynomial

STEP = 0.04
GRID = (0.0, 2.0, 51)
NAME = "load:push:fx"
RUNGS = [({"backend": backend}, 1e-11) for backend in ("lanes", "c")]
RUNGS += [({"backend": backend, "precision": "single"}, 4e-6) for backend in ("lanes", "c")]


def signal(law, grid=GRID):
    """A scene of which one quantity is a function of time."""
    return pendulum(polynomial(0.0, 1.0), load=law, t=grid, wanted=["load:push"])


def true(law, grid=GRID, places=()):
    """The largest size, by 200 001 times and by some places of which it
    is known that they matter.
    """
    x = ca.SX.sym("x")
    times = np.append(np.linspace(*grid[:2], 200_001), places)
    values = np.abs(ca.Function("law", [x], [law(x)])(times[None]).full())
    return np.nanmax(values[np.isfinite(values)])


def searched(scene, rungs=RUNGS[:1]):
    """What each way says of the one quantity: its tolerance, and its value, NaN where it is not
    told.
    """
    solution = evaluate(scene, backend="vm", certificate=False)
    (peak,) = refine(scene, solution, [NAME])
    assert not abs(peak.value) < abs(solution.peak(NAME).value)
    yield 1e-11, peak.value
    for rung, tolerance in rungs:
        designs = prepare(scene, **rung)
        outcome = designs.designs([[]])
        value = outcome.value[0, designs.quantities.index(NAME)]
        assert (outcome.status[0] == Status.PEAK_NOT_TOLD) == math.isnan(value)
        yield tolerance, value


def bell(x, place, width):
    return ca.exp(-(((x - place) / width) ** 2))


def tent(x, place, width):
    return ca.fmax(0.0, 1 - ca.fabs(x - place) / width)


SIGNALS = {
    "in the first interval": (lambda x: bell(x, 0.3 * STEP, 0.6 * STEP) + 0.5 * ca.cos(x), []),
    "in the last interval": (lambda x: bell(x, 2 - 0.3 * STEP, 0.6 * STEP) + 0.5 * ca.cos(x), []),
    "at an end": (lambda x: ca.sqrt(x), []),
    "a spike of a tenth of a step": (
        lambda x: 3 * bell(x, 1.013, 0.1 * STEP) + 0.5 * ca.cos(x),
        [1.013],
    ),
    "one downwards, of a hundredth": (
        lambda x: -3 * bell(x, 1.013, 0.01 * STEP) + 0.5 * ca.cos(x),
        [1.013],
    ),
    "beside ordinary data": (
        lambda x: 1 / (1 + ((x - 0.513) / (0.05 * STEP)) ** 2) + ca.sin(7 * x),
        [0.513],
    ),
    "forty equal summits": (lambda x: ca.sin(64 * x), []),
    "as fast as the instants": (
        lambda x: ca.sin(50 * math.pi * x + 0.3) * (1 + 1e-3 * ca.sin(3.3 * x)),
        [],
    ),
    "ever faster": (lambda x: x * ca.sin(30 * x * x), []),
    "a plateau": (lambda x: ca.fmin(1.0, 3 * ca.sin(x)), []),
    "a kink": (lambda x: 1 - ca.fabs(x - 1.013), [1.013]),
    "a narrow kink": (lambda x: tent(x, 1.013, 0.1 * STEP) + 0.2 * ca.cos(x), [1.013]),
    "two kinks between two instants": (
        lambda x: tent(x, 1.013, 4e-3) + 1.1 * tent(x, 1.023, 4e-3) + 0.2 * x,
        [1.013, 1.023],
    ),
    "two bells, the lower one at an instant": (
        lambda x: bell(x, 0.6, 0.2) + (1 + 1e-5) * bell(x, 1.62, 0.2),
        [],
    ),
    "two bells between two instants": (
        lambda x: 0.97 * bell(x, 1.013, 0.3 * STEP) + 1.04 * bell(x, 1.035, 0.3 * STEP),
        [],
    ),
    "a jump": (lambda x: x * (x < 1.0137), [np.nextafter(1.0137, 0)]),
    "two jumps between two instants": (lambda x: (x > 1.013) * (x < 1.0133) + 0.1 * ca.cos(x), []),
    "the sign of a rate": (lambda x: (1 + 0.3 * x) * ca.sign(ca.sin(5 * x - 1.3)), []),
    "steps": (lambda x: ca.floor(30 * x) * (1 - 0.03 * x) - ca.floor(20 * x), []),
    "nearly a pole": (lambda x: 1 / ((x - 1.0137) ** 2 + 1e-6), [1.0137]),
    "nearly one, on both sides": (
        lambda x: (x - 1.0137) / ((x - 1.0137) ** 2 + 1e-5) + 0.2 * ca.cos(x),
        [],
    ),
    "a steep change and back": (
        lambda x: ca.tanh((x - 1.013) / 1e-3) - ca.tanh((x - 1.0135) / 1e-3) + 0.2 * ca.cos(x),
        [],
    ),
    "a high power": (lambda x: ca.cos(x - 1.0137) ** 1000 + 0.2 * ca.cos(x), [1.0137]),
    "a jump at the last instant": (
        lambda x: ca.fmod(x, 2.0) + 0.3 * ca.sin(x),
        [np.nextafter(2.0, 0)],
    ),
    "a jump at the first instant": (lambda x: (2.5 - x) * (x > 0), [np.nextafter(0.0, 1)]),
    "a remainder, in the middle of a step": (
        lambda x: ca.fmod(x, 0.7137) * (1 - 0.2 * x),
        [np.nextafter(0.7137, 0)],
    ),
    "kinks of a remainder": (
        lambda x: ca.fabs(ca.fmod(x + 0.3, 0.9137) - 0.4) + 0.01 * ca.sin(9 * x),
        [0.6137 - 1e-15, 1.5274 - 1e-15],
    ),
    "a kink beside an instant": (
        lambda x: 1 - ca.fabs(x - 1.0 - 1e-13) + 0.1 * x * x,
        [1.0, 1 + 1e-13],
    ),
    "a kink of a curved argument": (
        lambda x: 1 - ca.fabs(ca.exp(x) - 2.7713) / 5,
        [math.log(2.7713)],
    ),
    "constant": (lambda x: 3.0 + 0 * x, []),
    "nothing": (lambda x: 0 * x, []),
}


@pytest.mark.sampled(21)
@pytest.mark.parametrize("name", SIGNALS)
def test_the_largest_is_found(name):
    """Singles come in other packs: a jump between the lanes of one must be seen too."""
    law, places = SIGNALS[name]
    largest = true(law, places=places)
    for tolerance, value in searched(signal(law), RUNGS):
        assert abs(value) >= largest * (1 - tolerance)
        assert abs(value) <= largest * (1 + max(1e-6, tolerance))


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "law",
    [
        lambda x: (x < 1.0137) / (1.0137 - x),
        lambda x: 1 / (x - 1.0137),
        lambda x: ca.tan(x),
        lambda x: 1 / ca.sqrt(ca.fabs(x - 1.0137)),
    ],
)
def test_poles_are_infinite(law):
    assert all(math.isinf(value) for _, value in searched(signal(law)))


def test_what_grows_without_an_end_too_slowly_is_not_told():
    """A logarithm has no bound, and no number of times shows that."""
    law = lambda x: ca.log(ca.fabs(x - 1.0137))  # noqa: E731
    assert all(math.isnan(value) for _, value in searched(signal(law)))
