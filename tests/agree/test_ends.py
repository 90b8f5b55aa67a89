"""How far arguments are beyond the ends of curves, found in any expression."""

import casadi as ca
import numpy as np
import pytest
from internals import beyond_ends, share_beyond

from lagrange_casadi import curve, table

pytestmark = pytest.mark.quick

ENDED = curve([1.0, 2.0, 3.0, 5.0], [0.0, 1.0, 0.5, 2.0])
ROUND = curve([0, 1, 2, 3], [0, 1, 2, 0], periodic=True)


def test_every_argument_of_a_curve_with_ends_is_found_once():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    found = beyond_ends(ca.vertcat(ENDED(x * y) * ENDED(x * y), ROUND(y), ENDED(ENDED(y) + 2.0)))
    assert len(found) == 3
    assert {words for words, _ in found} == {"curve, from 1 to 5,"}
    function = ca.Function("far", [x, y], [ca.vertcat(*(far for _, far in found))])
    told = sorted(share_beyond(float(far)) for far in ca.vertsplit(function(2.0, 3.0)))
    # Of 6, 3 and ENDED(3) + 2 between 1 and 5.
    assert told == pytest.approx(sorted([0.25, -0.5, -0.125 - 0.25]), abs=1e-12)
    assert beyond_ends(x + ROUND(y)) == []
    assert beyond_ends(ca.SX(3.0)) == []


def test_ends_are_found_beside_functions_that_cannot_be_followed():
    x = ca.SX.sym("x")
    called = ca.Function("called", [x], [ca.sin(x)], {"never_inline": True})
    ((_, far),) = beyond_ends(called(x) + ENDED(3.0 + called(x)))
    function = ca.Function("far", [x], [far])
    assert float(function(0.0)) == pytest.approx(-1.0)
    assert share_beyond(
        float(ca.Function("far", [x], [beyond_ends(ENDED(x))[0][1]])(5.4))
    ) == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("beyond", "values", "there"),
    [
        (None, [2.0, 3.0, -1.0], None),
        ("hold", [2.0, 3.0, -1.0], [2.0, -1.0]),
        ("line", [2.0, 3.0, -1.0], [1.0, -9.0]),
        (None, [2.0, 2.0, 2.0], [2.0, 2.0]),
    ],
)
def test_a_table_has_ends_but_where_it_is_told_how_it_goes_on(beyond, values, there):
    x = ca.SX.sym("x")
    at = [1.0, 2.0, 3.0]
    found = table(x, at, values, beyond=beyond)
    value = ca.Function("value", [x], [found])
    within = np.linspace(1.0, 3.0, 41)
    np.testing.assert_allclose(
        value(within[None]).full()[0], np.interp(within, at, values), rtol=0, atol=1e-15
    )
    if there is None:
        ((words, far),) = beyond_ends(found)
        assert words == "table, from 1 to 3,"
        assert share_beyond(float(ca.Function("far", [x], [far])(3.2))) == pytest.approx(0.1)
        assert ca.Function("slope", [x], [ca.gradient(found, x)])(2.5) == -4.0
    else:
        assert beyond_ends(found) == []
        assert [float(value(place)) for place in (0.0, 5.0)] == pytest.approx(there, abs=1e-14)
