"""C that is printed of CasADi's functions: its bits are those of CasADi's virtual machine, and no
compiler warns of it. And NumPy's arithmetic: its numbers are those, too.
"""

import ctypes
import itertools
import math

import casadi as ca
import numpy as np
import pytest
from compiled import cc
from internals import interpret, numpy_arithmetic, print_functions
from operations import EACH, X, Y
from outside import doubled

from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

STRICT = [
    "-std=c99",
    "-pedantic",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-Wconversion",
    "-ffp-contract=off",
    "-fPIC",
    "-shared",
]
HEAD = "#include <math.h>\n#define casadi_real double\n"
CALL = (
    "void f(const double** arg, double** res);\nvoid f(const double** arg, double** res) {"
    " made(arg, res); }\n"
)
NUMBERS = (0.0, -0.0, 0.5, -3.0, 1e300, math.inf, math.nan)


def compiled(function, folder, head=HEAD):
    """The printed function, as a function of as many numbers as it has inputs."""
    (folder / "f.c").write_text(
        head + print_functions({"made": function}, "double", prefix="table") + CALL
    )
    result = cc(["cc", *STRICT], folder, "f.c", output="f.so")
    assert result.returncode == 0, result.stderr
    library = ctypes.CDLL(str(folder / "f.so"))

    def call(*values):
        cells = [ctypes.c_double(value) for value in values]
        out = (ctypes.c_double * function.nnz_out(0))(*[math.nan] * function.nnz_out(0))
        pointers = [ctypes.cast(ctypes.byref(one), ctypes.c_void_p).value for one in cells]
        library.f(
            (ctypes.c_void_p * len(cells))(*pointers), (ctypes.c_void_p * 1)(ctypes.addressof(out))
        )
        return np.array(out)

    return call


def has_c(function):
    """Whether a function has C."""
    try:
        return print_functions({"f": function}, "double", prefix="table")
    except DeclarationError:
        return False


def every_operation(a, b):
    """All operations that C has a name for, of two symbols."""
    codes = [getattr(ca, name) for name in dir(ca) if name.startswith("OP_")]
    found = [one for one in (ca.SX.binary(code, a, b) for code in codes) if one.n_dep()]
    found = [one for one in found if has_c(ca.Function("f", [a, b], [one]))]
    return ca.vertcat(*found, ca.SX.binary(ca.OP_COPYSIGN, a, a) * b, a * 0.1 - math.tau)


def test_all_operations_have_the_bits_of_the_virtual_machine(tmp_path):
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    function = ca.Function("f", [a, b], [every_operation(a, b)])
    assert function.nnz_out(0) > 40
    call = compiled(function, tmp_path)
    for values in itertools.product(NUMBERS, repeat=2):
        found, expected = call(*values), function(*values).full().ravel()
        assert np.array_equal(found, expected, equal_nan=True), values
        # Which of two zeros is the larger one, C leaves open.
        some = ~np.isnan(found) & (values[0] != values[1])
        assert np.array_equal(np.signbit(found[some]), np.signbit(expected[some])), values


@pytest.mark.parametrize(
    ("make", "says"),
    [(ca.erfinv, "it takes OP_ERFINV"), (lambda x: doubled(x), "it calls another one")],
    ids=["unknown", "foreign"],
)
def test_what_has_no_c_is_named(make, says):
    x = ca.SX.sym("x")
    with pytest.raises(
        DeclarationError, match=rf"function 'f' has no C: {says}; evaluate with backend 'vm'"
    ):
        print_functions({"f": ca.Function("f", [x], [make(x)])}, "double", prefix="table")


@pytest.mark.parametrize("name", EACH)
def test_numpy_has_the_numbers_of_the_virtual_machine(name):
    """Also of what is nothing, has no end, and is as far from two whole multiples."""
    draw = np.random.default_rng(5)
    y = np.concatenate([np.repeat(NUMBERS, len(NUMBERS)), draw.normal(size=600)])
    x = np.concatenate([np.tile(NUMBERS, len(NUMBERS)), draw.normal(size=600) * 9])
    x[-200:] = draw.integers(-9, 10, 200) * y[-200:] / 2
    function = ca.Function("f", [X, Y], [EACH[name]])
    with np.errstate(all="ignore"):
        found = interpret(function, [[x], [y]], numpy_arithmetic())[0][0]
    expected = function(x[None], y[None]).full()[0]
    np.testing.assert_allclose(np.broadcast_to(found, x.shape), expected, rtol=1e-15, atol=1e-300)
