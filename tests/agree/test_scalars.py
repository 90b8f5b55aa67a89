"""Sums, differences and products are those that CasADi's operators write, and of numbers they are
numbers.
"""

import operator
from itertools import product as pairs

import casadi as ca
import numpy as np
import pytest
from internals import scalars

pytestmark = pytest.mark.quick

X, Y = ca.SX.sym("x"), ca.SX.sym("y")
NUMBERS = [0, 1, -1, 0.0, -0.0, 1.0, 2.0, 0.1, float("inf"), np.float64(3.0)]
GRAPHS = [X, Y, -X, X * Y, 2.0 * X, X / 2.0, ca.sin(X), ca.SX(0), ca.SX(0.1), ca.SX(1, 1)]
TWO = {scalars.added: operator.add, scalars.less: operator.sub, scalars.product: operator.mul}


@pytest.mark.parametrize("made", TWO, ids=lambda made: made.__name__)
def test_an_operation_is_written_as_by_the_operator(made):
    for a, b in pairs([*NUMBERS, *GRAPHS], repeat=2):
        found, expected = made(a, b), TWO[made](a, b)
        assert type(found) is type(expected)
        assert str(found) == str(expected)
        if isinstance(expected, ca.SX):
            assert found.sparsity() == expected.sparsity()
            assert ca.is_equal(found, expected, 9)


@pytest.mark.parametrize("shape", [(3, 1), (1, 3), (2, 2)])
def test_a_scalar_works_on_each_entry(shape):
    whole = ca.SX.sym("w", *shape)
    for made, expected in TWO.items():
        assert ca.is_equal(made(2.0, whole), expected(2.0, whole), 9)
        assert ca.is_equal(made(whole, X), expected(whole, X), 9)


def test_two_products_are_joined_in_this_order():
    for numbers in pairs([0.0, 1.0, 0.3, X, Y], repeat=4):
        a, b, c, d = numbers
        assert str(scalars.products_added(*numbers)) == str(a * b + c * d)
        assert str(scalars.products_less(*numbers)) == str(a * b - c * d)


def test_what_is_an_expression_stays_it():
    assert scalars.as_expression(X) is X
    assert scalars.as_expression(0.1).is_constant()
    assert float(scalars.as_expression(0.1)) == 0.1
