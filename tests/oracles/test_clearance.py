"""Bounds of what a function gives hold for all that is put into it; what they say is off every kink
has none.
"""

import casadi as ca
import numpy as np
import pytest
from drawn_curves import K, T, drawn
from internals import Smooth, boxed

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


def held(seeds):
    """Draw expressions, spans and parameters; count those of which bounds say something."""
    told = 0
    for seed in seeds:
        r = np.random.default_rng(seed)
        function = ca.Function("drawn", [T, K], [ca.densify(drawn(r))], {"cse": True})
        symbols, rows, width = boxed(function)
        bounds = ca.Function("bounds", symbols, [*rows[0], width])
        for _ in range(4):
            low, k = r.uniform(-2, 2), float(r.choice([0.0, 0.3, 1.0, r.normal()]))
            high = low + 10 ** r.uniform(-6, 0.5)
            least, most, wide = (float(one) for one in bounds(low, high, k))
            if not wide < np.inf:
                continue
            told += 1
            values = function(ca.DM([low, high, *r.uniform(low, high, 60)]).T, k).full()
            assert ((least <= values) & (values <= most)).all(), (
                f"seed {seed}: from {low} to {high} with k = {k}"
            )
    return told / (4 * len(seeds))


def test_bounds_hold():
    assert held(range(60)) > 0.6


@pytest.mark.long
@pytest.mark.parametrize("part", range(4))
def test_more_bounds_hold(part):
    assert held(range(1000 + 1000 * part, 2000 + 1000 * part)) > 0.6


def clear_is_smooth(seeds):
    """What is clear has no kink by halving; and count what is."""
    many = 0
    for seed in seeds:
        r = np.random.default_rng(seed)
        smooth = Smooth.of(drawn(r), T, K)
        if smooth is None:
            continue
        start = r.uniform(-1, 1)
        paths = np.linspace(start, start + 10 ** r.uniform(-2, 0), 1001)[None, None]
        p = np.array([[float(r.choice([0.0, 0.3, 1.0]))]])
        if not smooth.clearance.near(
            paths.min(axis=2), paths.max(axis=2), p, lambda _, paths=paths: paths
        )[0]:
            many += 1
            assert not smooth.broken(paths, p)[0], f"seed {seed}"
    return many / len(seeds)


def test_what_is_clear_has_no_kink():
    assert clear_is_smooth(range(80)) > 0.2


@pytest.mark.long
@pytest.mark.parametrize("part", range(4))
def test_more_that_is_clear_has_no_kink(part):
    assert clear_is_smooth(range(2000 + 500 * part, 2500 + 500 * part)) > 0.2
