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
from internals import interpret, numpy_arithmetic
from operations import EACH, X, Y

from lagrange_casadi import derive, load_case

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
