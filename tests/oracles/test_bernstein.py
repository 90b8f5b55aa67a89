"""Zeros of polynomials in Bernstein's form: of integrals no value on a fine grid is beyond those at
the zeros of the polynomial and at both ends, also where zeros meet or lie at an end.
"""

import numpy as np
import pytest
from internals import bernstein

COUNT = 1000


def drawn(draw, degree):
    """Any ordinates, and those of given zeros: two that are near each other or one, one at an
    end.
    """
    c = draw.normal(size=(degree + 1, COUNT))
    for k in range(COUNT // 2):
        places = draw.uniform(-0.2, 1.2, degree)
        places[-1] = [places[-1], places[0], places[0] + 10 ** draw.uniform(-9, -1), 0.0, 1.0][
            k % 5
        ]
        made = np.ones((1, 1))
        for place in places:
            made = bernstein.product(made, np.array([[-place], [1.0 - place]]))
        c[:, k] = made[:, 0] * 10 ** draw.uniform(-6, 6)
    return c


@pytest.mark.parametrize("degree", range(1, 10))
def test_extremes_are_at_zeros(degree):
    c = drawn(np.random.default_rng(degree), degree)
    size = np.abs(c).max(axis=0)
    found = bernstein.zeros(c)
    assert ((found.places >= 0.0) & (found.places <= 1.0)).all()
    left = np.array([bernstein.value(c, x) for x in found.places])
    assert (np.abs(left) * (found.turns != 0.0) <= 1e-13 * size).all()
    integral = np.cumsum(np.pad(c, [(1, 0), (0, 0)]), axis=0) / (degree + 1)
    near = np.concatenate([found.places, np.zeros((1, COUNT)), np.ones((1, COUNT))])
    at_zeros = np.array([bernstein.value(integral, x) for x in near])
    grid = np.array([bernstein.value(integral, np.full(COUNT, x)) for x in np.linspace(0, 1, 401)])
    assert (grid.max(axis=0) <= at_zeros.max(axis=0) + 1e-15 * size).all()
    assert (grid.min(axis=0) >= at_zeros.min(axis=0) - 1e-15 * size).all()
    falls, rises = (found.turns == 1.0).sum(axis=0), (found.turns == -1.0).sum(axis=0)
    signs = np.diff(np.sign([bernstein.value(c, np.full(COUNT, x)) for x in (0.0, 1.0)]), axis=0)[0]
    assert (2 * (rises - falls) == signs)[np.abs(c[0] * c[-1]) > 0.0].all()


@pytest.mark.parametrize("degree", range(1, 6))
def test_other_ordinates_have_the_same_values(degree):
    """Those of a higher degree, of a part from 0 to 1, and of values at nodes."""
    draw = np.random.default_rng(degree)
    c, x = draw.normal(size=(degree + 1, 20)), draw.uniform(size=20)
    values = bernstein.value(c, x)
    np.testing.assert_allclose(bernstein.value(bernstein.raised(c, degree + 2), x), values)
    start, stop = np.sort(draw.uniform(size=(2, 20)), axis=0)
    part = bernstein.within(c, start, stop)
    there = bernstein.value(c, start + (stop - start) * x)
    np.testing.assert_allclose(bernstein.value(part, x), there, atol=1e-14)
    values = bernstein.value(c, np.tile(bernstein.nodes(degree)[:, None], 20))
    np.testing.assert_allclose(bernstein.interpolated(values), c)
