"""Peaks between instants, on signals and mechanisms of every kind, of one solution and of designs,
by both backends and in both precisions: none is short of many more instants, and those that cannot
be told are not told.
"""

import math

import casadi as ca
import numpy as np
import pytest
from design_rows import peaks_of
from internals import Status
from mechanisms import crank_slider, four_bar, pendulum

from lagrange_casadi import Scene, evaluate, prepare, refine
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


def turned(scene, start, count):
    """A scene over one turn of its drive, from an angle on."""
    law = {"O": polynomial(start, 8.0)}
    posture = {"b": 0.3, **scene.posture}
    return Scene(scene.mechanism, law, posture=posture, t=(0, math.tau / 8, count))


def stretched(ratio):
    """A slider-crank whose crank is so long beside its rod, from beside a dead centre on."""
    m = crank_slider(lengths=(0.3 * ratio, 0.3))
    law, span = {"O": polynomial(0.3, 10.0)}, math.tau / 10
    return lambda count: Scene(m, law, posture={"rod": -0.1}, t=(0, span, count))


def folding(shortage, start):
    """A crank-rocker that all but folds: its ground is shorter by so much than that at which it
    would.
    """
    frame = ((0.3 + 0.25 - 0.1) * (1 - shortage), 0.0)
    return lambda count: turned(four_bar((0.1, 0.3, 0.25), frame=frame, rocker=2.5), start, count)


MACHINES = {
    "begins near folding": folding(1e-2, math.pi),
    "begins beside folding": folding(1e-3, math.pi - 0.03),
    "all but folds": folding(1e-4, 0.0),
    "a rod all but as long as the crank": stretched(0.9999),
    "one yet shorter": stretched(0.99997),
}


def drawn(seed):
    """A crank-rocker that may all but fold."""
    random = np.random.default_rng(seed)
    others = np.sort(random.uniform(0.3, 0.5, 3))
    reach = (others[0] + others[1] - others[2]) * (1 - 10 ** random.uniform(-4, -1))
    lengths = (min(random.uniform(0.1, 0.3), reach), *random.permutation(others))
    start, frame = random.uniform(0, math.tau), (lengths[3], 0.0)
    return lambda count: turned(four_bar(lengths[:3], frame=frame, rocker=2.5), start, count)


MACHINES |= {f"drawn {seed}": drawn(seed) for seed in range(4)}


@pytest.mark.sampled(9)
@pytest.mark.parametrize("name", MACHINES)
def test_no_peak_is_short_where_instants_say_little(name):
    """Against 100 001 instants; of conditions near a dead centre `refine` and C sum in other
    orders.
    """
    dense = evaluate(MACHINES[name](100_001), certificate=False)
    for count in (51, 101):
        scene = MACHINES[name](count)
        wanted = ["effort", "reaction", "section"]
        solution = evaluate(scene, wanted=wanted, certificate=False)
        names = [each for each in solution.names() if each.startswith(tuple(wanted))]
        scale = {}
        for each in names:
            size, unit = abs(dense.peak(each).value), dense.unit(each)
            scale[unit] = max(scale.get(unit, 0.0), size)
        found = {peak.name: abs(peak.value) for peak in refine(scene, solution, names)}
        designs = prepare(scene, wanted=wanted)
        outcome = designs.designs([[]])
        assert outcome.status.tolist() == [0]
        by_designs = peaks_of(designs, outcome, 0)
        for each in names:
            least, size = abs(dense.peak(each).value), scale[dense.unit(each)]
            least -= 1e-11 * (least + size)
            value = abs(by_designs[each][0])
            assert found[each] >= least, each
            assert value >= least, each
            assert abs(value - found[each]) <= 1e-9 * size, each
