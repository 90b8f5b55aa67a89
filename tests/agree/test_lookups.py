"""Tables within graphs: what is found in them, by whom, and that
no derivative goes through them.
"""

import casadi as ca
import numpy as np
import pytest
from internals import (
    Pair,
    Pairs,
    cell,
    entries,
    followable,
    interpret,
    is_entry,
    lookup,
    numpy_arithmetic,
    steps,
)

from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

BREAKS = [-1.0, 0.0, 0.25, 2.0, 5.0]
ENTRIES = [3.0, -0.1, 1e-9, 7e5]


def looked_up():
    x = ca.SX.sym("x")
    return ca.Function(
        "f", [x], [cell(BREAKS, x, ends=True), entries(ENTRIES, cell(BREAKS, x, ends=True))]
    )


@pytest.mark.parametrize(
    ("x", "number"),
    [
        (-9.0, 0),
        (-1.0, 0),
        (-1e-300, 0),
        (0.0, 1),
        (0.25, 2),
        (1.999, 2),
        (2.0, 3),
        (5.0, 3),
        (70.0, 3),
    ],
)
def test_a_break_belongs_to_the_cell_after_it(x, number):
    function = looked_up()
    assert [float(found) for found in function(x)] == pytest.approx(
        [number, ENTRIES[number]], rel=1e-9
    )
    followed = interpret(function, [[np.array([x, x + 0j])]], numpy_arithmetic())
    assert [row[0].tolist() for row in followed] == [[float(found)] * 2 for found in function(x)]


def test_entries_are_exact_to_the_digits_of_the_largest():
    number = ca.SX.sym("number")
    function = ca.Function("f", [number], [entries(ENTRIES, number)])
    for k, entry in enumerate(ENTRIES):
        assert abs(float(function(k)) - entry) <= 7e5 * 2.0**-63
    tiny = ca.Function("f", [number], [entries([5e-324, 1e-310, 0.0], number)])
    assert [float(tiny(k)) for k in range(3)] == [5e-324, 1e-310, 0.0]
    assert float(ca.evalf(entries([4.0, 4.0], number))) == 4.0  # one number needs no table


def test_no_derivative_goes_through_a_table():
    x = ca.SX.sym("x")
    value = entries(ENTRIES, cell(BREAKS, x, ends=False)) * x**2
    for slope in (ca.jacobian(value, x), ca.gradient(value, x), ca.jtimes(value, x, 1)):
        function = ca.Function("slope", [x], [slope, ca.jacobian(slope, x)])
        assert (
            len(function.find_functions()) == 2
        )  # the table and the cell, and none of CasADi's derivatives of them
        assert [float(found) for found in function(3.0)] == pytest.approx([6.0 * 7e5, 2.0 * 7e5])


def test_a_function_tells_its_table_wherever_it_comes_from():
    function = ca.Function.deserialize(looked_up().serialize())
    assert followable(function)
    found = [step.looked_up for step in steps(function) if step.looked_up]
    assert [(table.kind, table.ends) for table in found] == [
        ("cell", True),
        ("cell", True),
        ("entry", False),
    ] or [(table.kind, table.ends) for table in found] == [("cell", True), ("entry", False)]
    assert found[0].numbers.tolist() == BREAKS
    x = ca.SX.sym("x")
    assert is_entry(entries(ENTRIES, x).dep(1).dep(0)) or is_entry(
        entries(ENTRIES, x).dep(0).dep(0)
    )
    assert not is_entry(x)
    assert lookup(ca.Function("other", [x], [x])) is None
    assert lookup(ca.Function("lagrange_casadi_entry_0123456789abcdef", [x], [x])) is None


def test_what_calls_another_function_is_not_followed():
    x = ca.SX.sym("x")
    other = ca.Function("other", [x], [x * x], {"never_inline": True})
    function = ca.Function("f", [x], [other(x) + cell(BREAKS, x, ends=True)])
    assert not followable(function)
    with pytest.raises(DeclarationError, match="it calls another one"):
        interpret(function, [[1.0]], numpy_arithmetic())


@pytest.mark.parametrize("precision", ["double", "single"])
def test_pairs_look_up_by_their_value(precision):
    high, low = ca.SX.sym("high"), ca.SX.sym("low")
    (number,), (entry,) = interpret(looked_up(), [[Pair(high, low)]], Pairs(precision).arithmetic)
    function = ca.Function("f", [high, low], [number.value, entry.value])
    assert [float(found) for found in function(0.25, -1e-30)] == pytest.approx(
        [2.0, 1e-9], rel=1e-6
    )
    assert [float(found) for found in function(2.0, 0.1)] == pytest.approx([3.0, 7e5], rel=1e-6)
