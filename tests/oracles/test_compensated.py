"""Pairs of numbers against 60 digits: doubles by the virtual machine, singles instruction by
instruction in NumPy's.
"""

import functools
import math
from dataclasses import replace

import casadi as ca
import mpmath
import numpy as np
import pytest
from arithmetic import DTYPES, ROUNDING
from hypothesis import given
from hypothesis import strategies as st
from internals import Pair, Pairs, interpret, numpy_arithmetic

MP = mpmath.MPContext()
MP.dps = 60
FARTHEST = {"double": 1e10, "single": 1e7}
both = pytest.mark.parametrize("precision", DTYPES)


# What is done to the pairs; the same in many digits; and the error allowed, in squared roundings of
# what it is relative to.
OPERATIONS = {
    "add": (Pairs.add, lambda x, y: x + y, lambda x, y: 4 * abs(x + y)),
    "subtract": (Pairs.subtract, lambda x, y: x - y, lambda x, y: 4 * abs(x - y)),
    "multiply": (Pairs.multiply, lambda x, y: x * y, lambda x, y: 8 * abs(x * y)),
    "divide": (Pairs.divide, lambda x, y: x / y, lambda x, y: 16 * abs(x / y)),
    "square": (
        lambda pairs, x, _: pairs.operations[ca.OP_SQ](x),
        lambda x, _: x * x,
        lambda x, _: 8 * x * x,
    ),
    "twice": (
        lambda pairs, x, _: pairs.operations[ca.OP_TWICE](x),
        lambda x, _: 2 * x,
        lambda x, _: 0,
    ),
    "inverse": (
        lambda pairs, _, y: pairs.operations[ca.OP_INV](y),
        lambda _, y: 1 / y,
        lambda _, y: 16 / abs(y),
    ),
    "root": (
        lambda pairs, x, _: pairs.root(pairs.operations[ca.OP_FABS](x)),
        lambda x, _: MP.sqrt(abs(x)),
        lambda x, _: 8 * MP.sqrt(abs(x)),
    ),
    "negate": (lambda pairs, x, _: pairs.negate(x), lambda x, _: -x, lambda x, _: 0),
    "size": (
        lambda pairs, x, _: pairs.operations[ca.OP_FABS](x),
        lambda x, _: abs(x),
        lambda x, _: 0,
    ),
    "floor": (
        lambda pairs, x, _: pairs.operations[ca.OP_FLOOR](x),
        lambda x, _: MP.floor(x),
        lambda x, _: 0,
    ),
    "ceil": (
        lambda pairs, x, _: pairs.operations[ca.OP_CEIL](x),
        lambda x, _: MP.ceil(x),
        lambda x, _: 0,
    ),
    "signed": (
        lambda pairs, x, y: pairs.operations[ca.OP_COPYSIGN](x, y),
        lambda x, y: abs(x) if y > 0 else -abs(x),
        lambda x, y: 0,
    ),
    "least": (lambda pairs, x, y: pairs.operations[ca.OP_FMIN](x, y), min, lambda x, y: 0),
    "largest": (lambda pairs, x, y: pairs.operations[ca.OP_FMAX](x, y), max, lambda x, y: 0),
}

PERIODIC = {
    "reduced": (
        lambda pairs, x, _: pairs.reduced(x),
        lambda x, _: x - 2 * MP.pi * MP.nint(x / (2 * MP.pi)),
    ),
    "fmod": (
        lambda pairs, x, y: pairs.remainder(x, y),
        lambda x, y: x - y * (MP.floor if x >= 0 else MP.ceil)(x / y),
    ),
    "remainder": (
        lambda pairs, x, y: pairs.nearest_remainder(x, y),
        lambda x, y: x - y * MP.nint(x / y),
    ),
}
WAVES = {
    "sine": (lambda pairs, x, _: pairs.sine(x), MP.sin),
    "cosine": (lambda pairs, x, _: pairs.cosine(x), MP.cos),
}
EVERY = OPERATIONS | PERIODIC | WAVES


@functools.cache
def of_pairs(name, precision):
    """(x high, x low, y high, y low) -> (high, low) of an operation."""
    x, y = (Pair(*(ca.SX.sym(f"{name}_{part}") for part in ("high", "low"))) for name in "xy")
    found = EVERY[name][0](Pairs(precision), x, y)
    low = ca.SX(0) if found.low is None else found.low
    return ca.Function(
        "pairs", [x.high, x.low, y.high, y.low], [ca.densify(found.high), ca.densify(low)]
    )


def run(name, precision, *numbers):
    """The outputs of an operation, in the precision's own arithmetic, exactly."""
    function = of_pairs(name, precision)
    if precision == "double":
        return [MP.mpf(float(x)) for x in function(*numbers)]
    single = replace(numpy_arithmetic(), constant=np.float32)
    found = interpret(function, [[np.float32(number)] for number in numbers], single)
    assert all(np.asarray(x).dtype == np.float32 for (x,) in found)
    return [MP.mpf(float(x)) for (x,) in found]


rests = st.just(0.0) | st.floats(1e-6, 1.0) | st.floats(-1.0, -1e-6)
parts = st.tuples(st.floats(0.5, 1.0), st.integers(-20, 20), rests, st.booleans())


def pair(precision, high, rest):
    """A pair of numbers of a precision, the low one within half a unit in the last place of the
    high one; and its value.
    """
    kind = DTYPES[precision].type
    high = kind(high)
    low = kind(rest * 0.49 * float(np.spacing(np.abs(high))))
    return (float(high), float(low)), MP.mpf(float(high)) + MP.mpf(float(low))


def pair_of(precision, drawn):
    size, exponent, rest, negative = drawn
    return pair(precision, math.ldexp(-size if negative else size, exponent), rest)


@pytest.mark.sampled(9)
@both
@pytest.mark.parametrize("name", OPERATIONS)
@given(parts, parts, st.booleans(), st.integers(-3, 3))
def test_an_operation_keeps_twice_the_digits(name, precision, one, two, near, units):
    """Also where all but the last digits cancel: relative to what is left."""
    (x, exact_x), (y, exact_y) = (pair_of(precision, drawn) for drawn in (one, two))
    if near:
        y, exact_y = pair(
            precision, x[0] + units * float(np.spacing(DTYPES[precision].type(abs(x[0])))), two[2]
        )
    high, low = run(name, precision, *x, *y)
    _, truth, allowed = OPERATIONS[name]
    assert (
        abs(high + low - truth(exact_x, exact_y))
        <= allowed(exact_x, exact_y) * ROUNDING[precision] ** 2
    )
    assert abs(low) <= ROUNDING[precision] * abs(high)


@both
@pytest.mark.parametrize("name", PERIODIC | WAVES)
@given(st.floats(0.0, 1.0), st.floats(0.3, 30.0), st.booleans(), rests)
def test_phases_after_many_turns(name, precision, part, period, negative, rest):
    """Up to whole periods where rounding decides between two: the error is that of x's own last
    digits, of a sine two roundings.
    """
    high = (-1 if negative else 1) * 1e-3 * (1e3 * FARTHEST[precision]) ** part
    (x, exact), y = pair(precision, high, rest), float(DTYPES[precision].type(period))
    found = sum(run(name, precision, *x, y, 0.0))
    if name in WAVES:
        assert abs(found - WAVES[name][1](exact)) <= 2 * ROUNDING[precision]
        return
    y = 2 * MP.pi if name == "reduced" else MP.mpf(y)
    gap = found - PERIODIC[name][1](exact, y)
    reduced = name == "reduced"
    allowed = 32 * ROUNDING[precision] ** 2 * (1 + abs(found if reduced else exact))
    beyond = 4 * ROUNDING[precision] * y * abs(exact) if reduced else allowed
    assert abs(gap - y * MP.nint(gap / y)) <= allowed
    assert abs(found) <= y * (1 if name == "fmod" else 0.5) + beyond


@pytest.mark.sampled(15)
@both
@pytest.mark.parametrize("name", [*OPERATIONS, "reduced"])
@given(parts, parts)
def test_constants_are_what_numbers_are_at_run_time(name, precision, one, two):
    """CasADi folds them in doubles: in single precision they lost their rests, and were other
    numbers than those of a motion.
    """
    (x, _), (y, _) = pair_of(precision, one), pair_of(precision, two)
    folded = EVERY[name][0](
        Pairs(precision), *(Pair(ca.SX(high), ca.SX(low)) for high, low in (x, y))
    )
    found = [float(folded.high), 0.0 if folded.low is None else float(folded.low)]
    assert found == run(name, precision, *x, *y)
