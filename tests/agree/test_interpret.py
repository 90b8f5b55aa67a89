"""Functions followed instruction by instruction: the virtual machine's bits, and what cannot be
followed.
"""

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from balance import settle
from conftest import CASES, NAMES
from hypothesis import given
from hypothesis import strategies as st
from internals import ROUNDINGS, Step, followable, interpret, numpy_arithmetic, steps
from operations import EACH, X, Y

from lagrange_casadi import Mechanism, Scene, derive, evaluate, load_case
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick

# NumPy's own sines differ from those of the C library, which the virtual machine takes.
OF_C = {getattr(ca, f"OP_{name.upper()}"): getattr(math, name) for name in ("sin", "cos", "atan2")}
MACHINE = replace(numpy_arithmetic(), operations=numpy_arithmetic().operations | OF_C)


def same_bits(found, expected):
    return np.array(found, float).tobytes() == np.array(expected, float).tobytes()


@pytest.mark.sampled(13)
@pytest.mark.parametrize("name", NAMES)
def test_doubles_are_the_virtual_machines(name):
    scene = load_case(CASES / name).scene
    program, p = derive(scene, ["all"]), list(scene.mechanism.values().values())
    for t in np.linspace(*scene.span, 7):
        driven = interpret(program.motion, [[t], p], MACHINE)
        expected = program.motion(t, p)
        assert all(same_bits(row, expected[k].full().ravel()) for k, row in enumerate(driven))
        z = settle(program, t, p, scene.span[0]).full().ravel()
        (out,) = interpret(program.instant, [[t], *driven, z, p], MACHINE)
        assert same_bits(out, program.instant(t, *expected, z, p).full().ravel())


ALL = ca.Function("all", [X, Y], [ca.vertcat(*EACH.values())])
numbers = st.floats(-20.0, 20.0) | st.sampled_from([0.0, -0.0, 1.0, -1.0, 0.5, 1e-9])


@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=5))
def test_every_operation_on_arrays(points):
    """Within some units in the last place: functions are NumPy's here, the C library's there."""
    x, y = np.array(points).T
    with np.errstate(all="ignore"):
        (found,) = interpret(ALL, [[x], [y]], numpy_arithmetic())
    for name, mine, row in zip(EACH, found, ALL(x[None], y[None]).full(), strict=True):
        np.testing.assert_allclose(mine, row, rtol=2e-15, atol=0.0, err_msg=name)


def test_what_rounds_is_told():
    assert ROUNDINGS[ca.OP_MUL] == 1.0
    assert ROUNDINGS[ca.OP_SIN] == 2.0
    assert not {ca.OP_FLOOR, ca.OP_NEG, ca.OP_TWICE, ca.OP_LT} & set(ROUNDINGS)
    assert set(ROUNDINGS) < set(numpy_arithmetic().operations)


def test_the_instructions_of_a_function():
    function = ca.Function("f", [X, ca.vertcat(Y, ca.SX.sym("z"))], [X, 3.5 + Y])
    found = steps(function)
    assert Step(ca.OP_INPUT, (1, 0), found[-3].results) in found
    assert [step.constant for step in found if step.operation == ca.OP_CONST] == [3.5]
    assert found[-1].results == (1, 0)
    assert interpret(function, [[2.0], [1.5, 7.0]], numpy_arithmetic()) == [[2.0], [5.0]]


def test_outputs_that_are_not_written_are_zero():
    function = ca.Function("f", [X], [ca.densify(ca.vertcat(X, 0)), ca.SX(2, 2)])
    assert interpret(function, [[4.0]], numpy_arithmetic()) == [[4.0, 0.0], []]


def test_what_cannot_be_followed():
    called = ca.Function("called", [X], [ca.sin(X)], {"never_inline": True})
    function = ca.Function("outer", [X], [called(X)])
    assert not followable(function)
    with pytest.raises(
        DeclarationError, match="function 'outer' cannot be followed: it calls another one"
    ):
        interpret(function, [[1.0]], numpy_arithmetic())
    m = ca.MX.sym("m")
    function = ca.Function("matrices", [m], [m + 1])
    assert not followable(function)
    with pytest.raises(
        DeclarationError,
        match=r"function 'matrices' cannot be followed: it is not written in scalars",
    ):
        interpret(function, [[1.0]], numpy_arithmetic())
    function = ca.Function("rare", [X], [ca.erfinv(X)])
    assert not followable(function)
    with pytest.raises(
        DeclarationError,
        match="function 'rare' cannot be followed: it takes OP_ERFINV, unknown here",
    ):
        interpret(function, [[0.5]], numpy_arithmetic())


def test_a_load_that_cannot_be_followed_is_evaluated_all_the_same():
    m = Mechanism("arm")
    arm = m.link("a", length=1, mass=1)
    joint = m.revolute("J", m.ground, arm)
    m.torque("t", arm, ca.erfinv(ca.sin(m.coordinate(joint)) / 2))
    solution = evaluate(Scene(m, {"J": polynomial(0.3, 1)}, t=(0, 1, 9)), backend="vm")
    inverse = np.vectorize(math.erf)(solution.series["load:t:mz"])
    np.testing.assert_allclose(inverse, np.sin(solution.motion("J").value) / 2, rtol=1e-10)
    assert solution.errors == {}
