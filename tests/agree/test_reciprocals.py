"""Fewer divisions, the same values."""

import casadi as ca
import numpy as np
import pytest
from internals import differentiable, share_reciprocals
from mechanisms import slider_crank

from lagrange_casadi import derive

pytestmark = pytest.mark.quick


def divisions(function):
    kinds = [function.instruction_id(k) for k in range(function.n_instructions())]
    return sum(kind in (ca.OP_DIV, ca.OP_INV) for kind in kinds)


def example():
    x, p = ca.SX.sym("x", 3), ca.SX.sym("p", 2)
    length = ca.sqrt(x[0] + p[0])
    out = ca.vertcat(
        x[1] / length,
        x[2] / length,
        1 / length,
        x[0] / (p[0] * p[1]),
        x[1] / ca.sin(x[2]),
        ca.atan2(x[0], x[1]),
        2,
    )
    return ca.Function("f", [x, p], [out], ["x", "p"], ["out"])


def test_what_is_divided_by_twice_or_is_a_parameter_is_inverted_once():
    before, after = example(), share_reciprocals(example(), "p")
    assert (divisions(before), divisions(after)) == (5, 3)
    x, p = [0.3, -0.7, 1.1], [2.0, 3.0]
    np.testing.assert_allclose(after(x, p).full(), before(x, p).full(), rtol=4e-16, atol=0)
    assert [after.name_in(i) for i in range(2)] == ["x", "p"]


def test_infinities_keep_their_sign():
    before, after = example(), share_reciprocals(example(), "p")
    for p in ([-0.3, 0.0], [-0.3, -0.0]):
        for sign in (1, -1):
            x = [0.3, sign * 0.7, 1.1]
            assert np.array_equal(after(x, p).full(), before(x, p).full(), equal_nan=True)


def test_the_slider_crank_divides_by_what_moves_once():
    program = derive(slider_crank())
    inputs = program.instant.sx_in()
    rest = ca.extract_parametric(program.instant(*inputs), inputs[-1], {"extract_trivial": True})
    assert divisions(ca.Function("rest", [*inputs[:-1], ca.vertcat(*rest[1])], [rest[0]])) == 1


def test_a_function_that_calls_others_stays_as_it_is():
    x, p = ca.SX.sym("x"), ca.SX.sym("p")
    inner = ca.Function("inner", [x], [ca.sin(x) * x], {"never_inline": True})
    outer = ca.Function("outer", [x, p], [inner(x) + 1 / p + x / p], ["x", "p"], ["out"])
    assert share_reciprocals(outer, "p")(0.3, 2.0) == outer(0.3, 2.0)


def test_plain_divisions_come_back_and_are_differentiated_rightly():
    """With divisors below zero, where copysign would not be, and with a copysign of its own, which
    stays.
    """
    x, p = ca.SX.sym("x", 3), ca.SX.sym("p", 2)
    out = ca.vertcat(x[1] / x[0], x[2] / x[0], x[0] / p[0], ca.copysign(1 / p[1], x[1]))
    plain = ca.Function("f", [x, p], [out], ["x", "p"], ["out"])
    shared = share_reciprocals(plain, "p")
    again = differentiable(shared)
    signs = [
        sum(f.instruction_id(k) == ca.OP_COPYSIGN for k in range(f.n_instructions()))
        for f in (plain, shared, again)
    ]
    assert signs == [1, 4, 1]
    values = [-0.3, 0.7, -1.1], [-2.0, 3.0]
    np.testing.assert_allclose(again(*values).full(), plain(*values).full(), rtol=4e-16)
    slopes = [
        ca.Function("slopes", [x, p], [ca.jacobian(f(x, p), x)])(*values).full()
        for f in (again, plain)
    ]
    np.testing.assert_allclose(*slopes, rtol=1e-15)


def test_a_function_that_calls_others_is_differentiable_as_it_is():
    x, p = ca.SX.sym("x"), ca.SX.sym("p")
    inner = ca.Function("inner", [x], [ca.sin(x) * x], {"never_inline": True})
    outer = ca.Function("outer", [x, p], [inner(x) + 1 / p], ["x", "p"], ["out"])
    assert differentiable(outer) is outer
