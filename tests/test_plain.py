"""Scalar C of CasADi's functions: what is in it that compilers would warn of, and what it gives."""

import ctypes
import itertools
import math
import re

import casadi as ca
import pytest

from lagrange_casadi.codegen.compiler import find_compiler
from lagrange_casadi.codegen.plain import plain
from lagrange_casadi.codegen.programs import run

pytestmark = pytest.mark.quick


def test_truths_are_comparisons_and_have_casadis_values(tmp_path):
    a, b = (ca.SX.sym(name) for name in "ab")
    function = ca.Function(
        "truths", [a, b], [ca.vertcat(ca.logic_not(a), ca.logic_and(a, b), ca.logic_or(a, b), ca.if_else(a, b, 2.0))]
    )
    text = plain({"truths": function}, "double")
    assert re.search(r"!a\d|a\d+(&&|\|\|)a\d", text) is None
    compiler = find_compiler()
    if compiler is None:
        pytest.skip("needs a C compiler")
    head, tail = "#define casadi_real double\n", "void f(const double** arg, double** res) { truths(arg, res); }\n"
    (tmp_path / "f.c").write_text(head + text + tail)
    flags = ["-std=c99", "-Wall", "-Werror", "-Wconversion", "-fPIC", "-shared"]
    built = run([*compiler.command, *flags, "-o", "f.so", "f.c"], 60.0, tmp_path)
    assert built.returncode == 0, built.stderr
    row = ctypes.c_double * 4
    for values in itertools.product((0.0, -0.0, 0.5, -3.0, math.nan), repeat=2):
        one, other, out = ctypes.c_double(values[0]), ctypes.c_double(values[1]), row(*[math.nan] * 4)
        pointers = [ctypes.cast(ctypes.byref(cell), ctypes.c_void_p).value for cell in (one, other, out)]
        ctypes.CDLL(str(tmp_path / "f.so")).f((ctypes.c_void_p * 2)(*pointers[:2]), (ctypes.c_void_p * 1)(pointers[2]))
        assert [*out] == pytest.approx(function(*values).full().ravel().tolist(), rel=0, abs=0, nan_ok=True)
