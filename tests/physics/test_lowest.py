"""The lowest value of a polynomial on an interval, against values on a fine grid and known turning
points.
"""

import functools

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import lowest


@functools.cache
def function(size, start, stop):
    """Of so many coefficients, which is how parameters go in."""
    c = ca.SX.sym("c", size)
    return ca.Function("f", [c], list(lowest([c[j] for j in range(size)], start, stop)))


def found(cell, start, stop):
    return (float(x) for x in function(len(cell), start, stop)(list(cell)))


def at(cell, u):
    return np.polynomial.polynomial.polyval(u, cell)


coefficient = st.floats(-10, 10) | st.integers(-3, 3).map(float)


@settings(max_examples=30, deadline=None)
@given(
    cell=st.lists(coefficient, min_size=1, max_size=6),
    ends=st.sampled_from([(0.0, 1.0), (0.25, 0.3), (0.0, 0.5)]),
)
def test_nothing_on_the_interval_is_lower(cell, ends):
    place, value = found(cell, *ends)
    size = 1e-14 * (1 + np.abs(cell).sum())
    assert ends[0] <= place <= ends[1]
    assert value == pytest.approx(at(cell, place), abs=size)
    assert value <= at(cell, np.linspace(*ends, 2001)).min() + size


@settings(max_examples=25, deadline=None)
@given(roots=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=4), factor=st.floats(0.01, 10))
def test_squares_touch_zero(roots, factor):
    """A product of squares is nowhere negative, and zero at its roots, also where these fall
    together.
    """
    cell = [factor]
    for root in roots:
        cell = np.polynomial.polynomial.polymul(cell, [root * root, -2 * root, 1.0])
    place, value = found(cell, 0.0, 1.0)
    assert abs(value) <= 1e-13 * np.abs(cell).sum()
    assert min(abs(place - root) for root in roots) < 0.1
