"""How far arguments are beyond the ends of curves, found in any expression."""

import casadi as ca
import pytest
from internals import beyond_ends, share_beyond

from lagrange_casadi import curve

pytestmark = pytest.mark.quick

ENDED = curve([1.0, 2.0, 3.0, 5.0], [0.0, 1.0, 0.5, 2.0])
ROUND = curve([0, 1, 2, 3], [0, 1, 2, 0], periodic=True)


def test_every_argument_of_a_curve_with_ends_is_found_once():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    found = beyond_ends(ca.vertcat(ENDED(x * y) * ENDED(x * y), ROUND(y), ENDED(ENDED(y) + 2.0)))
    assert len(found) == 3
    function = ca.Function("far", [x, y], [ca.vertcat(*found)])
    told = sorted(share_beyond(float(far)) for far in ca.vertsplit(function(2.0, 3.0)))
    # Of 6, 3 and ENDED(3) + 2 between 1 and 5.
    assert told == pytest.approx(sorted([0.25, -0.5, -0.125 - 0.25]), abs=1e-12)
    assert beyond_ends(x + ROUND(y)) == []
    assert beyond_ends(ca.SX(3.0)) == []


def test_ends_are_found_beside_functions_that_cannot_be_followed():
    x = ca.SX.sym("x")
    called = ca.Function("called", [x], [ca.sin(x)], {"never_inline": True})
    (far,) = beyond_ends(called(x) + ENDED(3.0 + called(x)))
    function = ca.Function("far", [x], [far])
    assert float(function(0.0)) == pytest.approx(-1.0)
    assert share_beyond(
        float(ca.Function("far", [x], beyond_ends(ENDED(x)))(5.4))
    ) == pytest.approx(0.1)
