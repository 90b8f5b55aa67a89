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
from hypothesis import example, given
from hypothesis import strategies as st
from internals import DTYPES, PRECISIONS, ROUNDING, Pair, Pairs, interpret, numpy_arithmetic
from internals import compensated_closed as closed

MP = mpmath.MPContext()
MP.dps = 60
FARTHEST = {"double": 1e10, "single": 1e7}
both = pytest.mark.parametrize("precision", PRECISIONS)


def nearest_below(quotient):
    """Towards zero."""
    return MP.floor(quotient) if quotient >= 0 else MP.ceil(quotient)


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


def pair_symbols(name):
    return Pair(*(ca.SX.sym(f"{name}_{part}") for part in ("high", "low")))


@functools.cache
def function(name, precision):
    """(x high, x low, y high, y low) -> (high, low) of an operation."""
    return of_pairs(lambda pairs, x, y: OPERATIONS[name][0](pairs, x, y), precision)


def of_pairs(operation, precision):
    x, y = pair_symbols("x"), pair_symbols("y")
    found = operation(Pairs(precision), x, y)
    low = ca.SX(0) if found.low is None else found.low
    return ca.Function(
        "pairs", [x.high, x.low, y.high, y.low], [ca.densify(found.high), ca.densify(low)]
    )


def run(function, precision, *numbers):
    """A function's outputs, in the precision's own arithmetic, exactly."""
    if precision == "double":
        return [MP.mpf(float(x)) for x in function(*numbers)]
    single = replace(numpy_arithmetic(), constant=np.float32)
    found = interpret(function, [[np.float32(number)] for number in numbers], single)
    assert all(np.asarray(x).dtype == np.float32 for (x,) in found)
    return [MP.mpf(float(x)) for (x,) in found]


rests = st.just(0.0) | st.floats(1e-6, 1.0) | st.floats(-1.0, -1e-6)
parts = st.tuples(st.floats(0.5, 1.0), st.integers(-20, 20), rests, st.booleans())


def pair(precision, drawn):
    """A pair of numbers of a precision, the low one within half a unit in the last place of the
    high one; and its value.
    """
    size, exponent, rest, negative = drawn
    kind = DTYPES[precision].type
    high = kind(math.ldexp(-size if negative else size, exponent))
    low = kind(rest * 0.49 * float(np.spacing(np.abs(high))))
    return (float(high), float(low)), MP.mpf(float(high)) + MP.mpf(float(low))


@pytest.mark.sampled(9)
@both
@pytest.mark.parametrize("name", OPERATIONS)
@given(parts, parts)
def test_an_operation_keeps_twice_the_digits(name, precision, one, two):
    (*x, exact_x), (*y, exact_y) = (
        (*numbers, value) for numbers, value in (pair(precision, one), pair(precision, two))
    )
    high, low = run(function(name, precision), precision, *x, *y)
    _, truth, allowed = OPERATIONS[name]
    assert (
        abs(high + low - truth(exact_x, exact_y))
        <= allowed(exact_x, exact_y) * ROUNDING[precision] ** 2
    )
    assert abs(low) <= ROUNDING[precision] * abs(high)


@both
@given(parts, st.integers(-3, 3), rests)
def test_what_cancels_leaves_every_digit(precision, one, units, rest):
    """x less a number within some units in the last place of it: relative to the difference, not to
    x.
    """
    x, exact_x = pair(precision, one)
    unit = float(np.spacing(DTYPES[precision].type(abs(x[0]))))
    y = (x[0] + units * unit, float(DTYPES[precision].type(rest * 0.49 * unit)))
    high, low = run(function("subtract", precision), precision, *x, *y)
    truth = exact_x - MP.mpf(y[0]) - MP.mpf(y[1])
    assert abs(high + low - truth) <= 4 * abs(truth) * ROUNDING[precision] ** 2


@both
@pytest.mark.parametrize("name", ["floor", "ceil"])
@pytest.mark.parametrize("low", [-1e-9, 0.0, 1e-9])
@pytest.mark.parametrize("high", [-3.0, 0.0, 7.0])
def test_whole_numbers_a_hair_off(precision, name, low, high):
    found = run(function(name, precision), precision, high, low, 1.0, 0.0)
    assert sum(found) == getattr(MP, name)(MP.mpf(high) + MP.mpf(low))


def remainders(precision):
    """C's fmod and remainder of a pair by another, and the quotient's size."""
    return (
        ("fmod", of_pairs(lambda pairs, x, y: pairs.remainder(x, y), precision), nearest_below),
        (
            "remainder",
            of_pairs(lambda pairs, x, y: pairs.nearest_remainder(x, y), precision),
            MP.nint,
        ),
    )


REMAINDERS = {precision: remainders(precision) for precision in PRECISIONS}


@both
@given(st.floats(0.0, 1.0), st.floats(0.3, 30.0), st.booleans(), rests)
def test_remainders_of_what_has_counted_many_turns(precision, part, period, negative, rest):
    """Up to whole periods where rounding decides between two: the error is that of x's own last
    digits.
    """
    kind = DTYPES[precision].type
    high = kind((-1 if negative else 1) * FARTHEST[precision] ** part)
    x = (float(high), float(kind(rest * 0.49 * float(np.spacing(np.abs(high))))))
    y = (float(kind(period)), 0.0)
    exact_x, exact_y = MP.mpf(x[0]) + MP.mpf(x[1]), MP.mpf(y[0])
    allowed = 32 * ROUNDING[precision] ** 2 * abs(exact_x)
    for name, remainder, whole in REMAINDERS[precision]:
        found = sum(run(remainder, precision, *x, *y))
        gap = found - (exact_x - exact_y * whole(exact_x / exact_y))
        assert abs(gap - exact_y * MP.nint(gap / exact_y)) <= allowed, name
        assert abs(found) <= exact_y * (0.5 if name == "remainder" else 1) + allowed, name


PHASES = {
    "sine": (lambda pairs, x, _: pairs.sine(x), MP.sin),
    "cosine": (lambda pairs, x, _: pairs.cosine(x), MP.cos),
    "reduced": (
        lambda pairs, x, _: pairs.reduced(x),
        lambda x: x - 2 * MP.pi * MP.nint(x / (2 * MP.pi)),
    ),
}
OF_PHASE = {
    (name, precision): of_pairs(PHASES[name][0], precision)
    for name in PHASES
    for precision in PRECISIONS
}


@both
@pytest.mark.parametrize("name", PHASES)
@example(part=1.0, rest=1.0, negative=True)
@example(part=0.0, rest=0.3, negative=False)
@given(part=st.floats(0.0, 1.0), rest=rests, negative=st.booleans())
def test_phases_after_many_turns(name, precision, part, rest, negative):
    """Angles between 1e-3 rad and the farthest: two roundings of a sine, and the reduced angle with
    all that its pair knows.
    """
    kind = DTYPES[precision].type
    high = kind((-1 if negative else 1) * 1e-3 * (1e3 * FARTHEST[precision]) ** part)
    low = kind(rest * 0.49 * float(np.spacing(np.abs(high))))
    exact = MP.mpf(float(high)) + MP.mpf(float(low))
    found = sum(run(OF_PHASE[name, precision], precision, float(high), float(low), 1.0, 0.0))
    gap = found - PHASES[name][1](exact)
    if name == "reduced":
        gap -= 2 * MP.pi * MP.nint(gap / (2 * MP.pi))
        assert abs(gap) <= 8 * ROUNDING[precision] ** 2 * (abs(found) + 1)
        assert abs(found) <= MP.pi * (1 + 4 * abs(exact) * ROUNDING[precision])
    else:
        assert abs(gap) <= 2 * ROUNDING[precision]


def test_a_tangent_is_that_of_the_phase():
    tangent = of_pairs(lambda pairs, x, _: pairs.operations[ca.OP_TAN](x), "double")
    for angle in (0.7, 1e4, -3e9):
        assert (
            abs(sum(run(tangent, "double", angle, 0.0, 1.0, 0.0)) / MP.tan(MP.mpf(angle)) - 1)
            < 1e-15
        )


@both
@given(st.floats(1e-30, 1e30))
def test_a_constant_is_as_near_as_a_pair_comes(precision, value):
    found = Pairs(precision).constant(value)
    high, low = float(found.high), 0.0 if found.low is None else float(found.low)
    assert found.number == value
    assert all(float(DTYPES[precision].type(part)) == part for part in (high, low))
    assert abs(high + low - value) <= (
        0.0 if precision == "double" else ROUNDING["single"] ** 2 * value
    )
    assert (found.low is None) == (float(DTYPES[precision].type(value)) == value)


@pytest.mark.sampled(9)
@both
@pytest.mark.parametrize("number", [0.1, math.pi, 1e5 / 7, -1.0 / 3.0, 0.5, 4.0, -8.0, 0.0])
@given(one=parts)
def test_products_with_constants(precision, number, one):
    """A constant is split when the product is written; by a power of two nothing rounds."""
    by = of_pairs(lambda pairs, x, _: pairs.multiply(pairs.constant(number), x), precision)
    x, exact = pair(precision, one)
    found, factor = sum(run(by, precision, *x, 1.0, 0.0)), Pairs(precision).constant(number)
    truth = exact * (
        MP.mpf(float(factor.high)) + (0 if factor.low is None else MP.mpf(float(factor.low)))
    )
    scales = number and math.frexp(abs(number))[0] == 0.5
    assert abs(found - truth) <= (
        0 if scales or not number else 8 * ROUNDING[precision] ** 2 * abs(truth)
    )


@pytest.mark.sampled(15)
@both
@pytest.mark.parametrize("name", [*OPERATIONS, "reduced"])
@given(parts, parts)
def test_constants_are_what_numbers_are_at_run_time(name, precision, one, two):
    """CasADi folds them in doubles: in single precision they lost their rests, and were other
    numbers than those of a motion.
    """
    operation = {**OPERATIONS, **PHASES}[name][0]
    (x, _), (y, _) = pair(precision, one), pair(precision, two)
    folded = operation(Pairs(precision), *(Pair(ca.SX(high), ca.SX(low)) for high, low in (x, y)))
    found = [float(folded.high), 0.0 if folded.low is None else float(folded.low)]
    at_run_time = of_pairs(operation, precision) if name in PHASES else function(name, precision)
    assert found == run(at_run_time, precision, *x, *y)


@both
def test_a_number_alone_is_taken_as_exact(precision):
    """Sums and products of single numbers, whose pairs they then are, without a rounding."""
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    pairs = Pairs(precision)
    total, product = pairs.add(Pair(x), Pair(y)), pairs.multiply(Pair(x), Pair(y))
    both = ca.Function("both", [x, y], [total.high, total.low, product.high, product.low])
    kind = DTYPES[precision].type
    for a, b in ((0.1, 1e7), (-1.7, 1.3), (1e-5, 3.0)):
        a, b = float(kind(a)), float(kind(b))
        found = run(both, precision, a, b)
        assert found[0] + found[1] == MP.mpf(a) + MP.mpf(b)
        assert found[2] + found[3] == MP.mpf(a) * MP.mpf(b)


def test_what_is_rounded_is_rounded_once():
    """Functions of the nearest number, and the choice that CasADi makes of an if."""
    x, exact = (0.7, 1e-17), MP.mpf(0.7) + MP.mpf(1e-17)
    for code, function in ((ca.OP_EXP, MP.exp), (ca.OP_ATAN, MP.atan), (ca.OP_ERF, MP.erf)):
        found = run(
            of_pairs(lambda pairs, x, _, code=code: pairs.operations[code](x), "double"),
            "double",
            *x,
            1.0,
            0.0,
        )
        assert found[0] + found[1] == pytest.approx(float(function(exact)), rel=4e-16)
    chosen = of_pairs(lambda pairs, x, y: pairs.operations[ca.OP_IF_ELSE_ZERO](x, y), "double")
    assert run(chosen, "double", 1.0, 0.0, *x) == [MP.mpf(part) for part in x]
    assert run(chosen, "double", 0.0, 0.0, *x) == [0, 0]


@both
@given(x=parts, y=parts)
def test_no_simplification_comes_in_later(precision, x, y):
    """An expression is made anew where it is called, or its common parts are shared: errors of sums
    and products outlast both.
    """
    (one, _), (other, _) = pair(precision, x), pair(precision, y)
    for operation in ("add", "multiply", "divide"):
        once = function(operation, precision)
        symbols = once.sx_in()
        again = ca.Function("again", symbols, once.call(symbols), {"cse": True})
        assert again.n_instructions() <= once.n_instructions()
        assert run(again, precision, *one, *other) == run(once, precision, *one, *other)


def test_what_is_closed_is_the_value_itself():
    x = ca.SX.sym("x")
    kept = ca.Function("kept", [x], [closed(x)])
    for value in (0.0, -0.0, 1.5, -1e-310, math.inf, -math.inf):
        found = float(kept(value))
        assert found == value
        assert math.copysign(1.0, found) == math.copysign(1.0, value)
    assert math.isnan(float(kept(math.nan)))


def test_casadi_would_simplify_what_is_not_closed():
    """Else nothing need be; and a version that looks through is found out."""
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    assert ca.is_equal((x + y) - x, y)
    assert ca.is_equal((x / y) * y, x)
    assert not ca.is_equal(closed(x + y) - x, y, 4)
    assert not ca.is_equal(closed(x / y) * y, x, 4)
    assert closed(ca.SX(0.1)).is_constant()
