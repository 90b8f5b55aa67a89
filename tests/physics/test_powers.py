"""Expressions as polynomials of one symbol: the coefficients of what is one, and nothing of what is
none.
"""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import powers

from lagrange_casadi import curve

pytestmark = pytest.mark.quick

X, A, B = ca.SX.sym("x"), ca.SX.sym("a"), ca.SX.sym("b")
SHAPE = curve([0.0, 0.3, 0.7, 1.0], [1.0, 2.0, 0.5, 1.0])


def coefficients(expression, replaced=(0.0, 1.0), values=(0.7, -1.3)):
    found = powers(expression, X, tuple(map(ca.SX, replaced)))
    return [float(ca.evalf(ca.substitute(c, ca.vertcat(A, B), ca.vertcat(*values)))) for c in found]


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (ca.SX(3.0), [3.0]),
        (A + B, [-0.6]),
        (X, [0.0, 1.0]),
        (A * X - X * B / 4, [0.0, 0.7 + 1.3 / 4]),
        ((X - A) ** 2 * X, [0.0, 0.49, -1.4, 1.0]),
        (X**3 - X * X * X, [0.0]),
        (2 * X + X + (-X) + ca.sin(A) * X**2, [0.0, 2.0, np.sin(0.7)]),
        (ca.fmax(A, B) * X + ca.if_else(A > B, 1.0, 2.0), [1.0, 0.7]),
        (SHAPE(A) * X, [0.0, float(ca.evalf(SHAPE(ca.SX(0.7))))]),
        ((X**2) ** 2 / 2, [0.0, 0.0, 0.0, 0.0, 0.5]),
    ],
)
def test_a_polynomial_has_its_coefficients(expression, expected):
    np.testing.assert_allclose(coefficients(expression), expected, rtol=1e-15, atol=1e-16)


@given(st.lists(st.floats(-3, 3), min_size=1, max_size=6), st.floats(-2, 2), st.floats(0.1, 2))
def test_a_polynomial_may_be_put_in(numbers, start, slope):
    """Of a line of another symbol: the value is the same at every place."""
    found = coefficients(sum((c * X**k for k, c in enumerate(numbers)), ca.SX(0)), (start, slope))
    for s in (-1.0, 0.0, 0.3, 2.0):
        value = sum(c * (start + slope * s) ** k for k, c in enumerate(numbers))
        size = sum(abs(c) * (abs(start) + slope * abs(s)) ** k for k, c in enumerate(numbers))
        assert sum(c * s**k for k, c in enumerate(found)) == pytest.approx(
            value, abs=1e-13 * (1 + size)
        )


@pytest.mark.parametrize(
    "expression",
    [
        ca.sin(X),
        ca.fabs(X),
        1 / X,
        X**-1,
        X**0.5,
        X**A,
        2**X,
        ca.sqrt(X) * X,
        SHAPE(X),
        ca.if_else(X < 0.5, 1.0, 2.0),
        ca.if_else(X < 2.0, X, X**2),
        ca.floor(X) * 0 + ca.sign(X),
        ca.fmin(X, A),
        ca.atan2(X, 1.0),
        X**1000,
    ],
)
def test_what_is_none_is_told(expression):
    assert powers(expression, X, (ca.SX(0), ca.SX(1))) is None
