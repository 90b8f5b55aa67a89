"""What operations round, against exact fractions."""

from fractions import Fraction

import casadi as ca
import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import rounding_error

pytestmark = pytest.mark.quick

numbers = st.floats(-1e6, 1e6).filter(lambda x: abs(x) > 1e-6) | st.sampled_from(
    [1.0, -0.5, 3.0, 0.1, 1.0 + 2.0**-52]
)
kinds = st.sampled_from([np.float64, np.float32])


def of(code, kind, result, *operands):
    """What is left, of one operation."""
    return float(rounding_error(code, *(np.array([x], kind) for x in (result, *operands)))[0])


@given(numbers, numbers, kinds)
def test_sums_and_products(x, y, kind):
    """To the last bit; where that is more than the rest can hold, to rounding."""
    a, b = kind(x), kind(y)
    exact = {
        ca.OP_ADD: Fraction(float(a)) + Fraction(float(b)),
        ca.OP_SUB: Fraction(float(a)) - Fraction(float(b)),
    }
    exact |= {ca.OP_MUL: Fraction(float(a)) * Fraction(float(b))}
    rounded = {ca.OP_ADD: a + b, ca.OP_SUB: a - b, ca.OP_MUL: a * b}
    for code, meant in exact.items():
        assert of(code, kind, rounded[code], a, b) == float(meant - Fraction(float(rounded[code])))
    assert of(ca.OP_SQ, kind, a * a, a) == float(Fraction(float(a)) ** 2 - Fraction(float(a * a)))


@given(numbers, numbers, kinds)
def test_quotients_and_roots(x, y, kind):
    """To first order: a rounding of a rounding is left."""
    a, b = kind(x), kind(y)
    with mpmath.mp.workdps(60):
        pairs = {
            (ca.OP_DIV, a / b, a, b): mpmath.mpf(float(a)) / mpmath.mpf(float(b)),
            (ca.OP_INV, kind(1) / b, b): 1 / mpmath.mpf(float(b)),
            (ca.OP_SQRT, np.sqrt(abs(a)), abs(a)): mpmath.sqrt(abs(float(a))),
        }
        for (code, result, *operands), meant in pairs.items():
            gap = float(meant - mpmath.mpf(float(result)))
            assert of(code, kind, result, *operands) == pytest.approx(gap, rel=1e-5, abs=0.0)


def test_what_is_exact_leaves_nothing():
    for code, result, *operands in (
        (ca.OP_SUB, 0.25, 1.0, 0.75),
        (ca.OP_ADD, 0.1, 0.1, 0.0),
        (ca.OP_MUL, 0.2, 0.1, 2.0),
        (ca.OP_MUL, 0.0, 0.1, 0.0),
        (ca.OP_SQRT, 1.5, 2.25),
        (ca.OP_SQRT, 0.0, 0.0),
        (ca.OP_DIV, 3.0, 6.0, 2.0),
        (ca.OP_SIN, 0.0, 0.0),
        (ca.OP_COS, 1.0, 0.0),
        (ca.OP_ATAN2, 0.0, 0.0, 0.0),
    ):
        assert of(code, np.float64, result, *operands) == 0.0
        assert of(code, np.float32, *np.float32([result, *operands])) == 0.0
