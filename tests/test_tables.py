"""Tables that graphs look up, as C: found in CasADi's text, and written again."""

import ctypes
import math
import re

import casadi as ca
import numpy as np
import pytest
from compiled import cc

from lagrange_casadi import codegen
from lagrange_casadi.arithmetic.lookups import cell, entries
from lagrange_casadi.codegen.plain import plain
from lagrange_casadi.codegen.tables import with_tables

pytestmark = pytest.mark.quick


def function(points):
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    breaks, numbers = np.linspace(-1.0, 2.0, points), np.sin(np.arange(points - 1) * 1.7)
    found = [entries(numbers, cell(breaks, argument, ends=True)) for argument in (x, ca.sin(x) + y)]
    return ca.Function("f", [x, y], [found[0] * found[1] + y, ca.ceil(y)], {"cse": True})


def written(made):
    generator = ca.CodeGenerator("name", {"with_header": False})
    generator.add(made)
    return str(generator.dump())


def test_text_without_tables_stays_as_it_is():
    x = ca.SX.sym("x")
    made = ca.Function("f", [x], [ca.sin(x)])
    assert with_tables(written(made), [made], packs=True) == written(made)


def test_nothing_of_casadis_tables_is_left():
    made = function(40)
    for packs in (False, True):
        text = with_tables(written(made), [made], packs=packs)
        for word in ("casadi_low(", "casadi_copy(", "casadi_c0["):
            assert word not in text
        assert not re.search(r"if \(casadi_f\d+\(arg", text)
        # What rounds to whole numbers of itself is left, what is whole already is not rounded.
        assert text.count("ceil(") == 1
        assert len(re.findall(r"a\d+=casadi_f\d+\(", text)) == 4


@pytest.mark.parametrize("points", [4, 5, 17, 361])
def test_compiled_tables_have_the_numbers_of_the_virtual_machine(points, tmp_path):
    made = function(points)
    head = "#include <math.h>\n#define casadi_real double\n#define casadi_int long long\n"
    entry = """
void at(double x, double y, double* found) {
  const double* arg[2];
  double* res[2];
  arg[0] = &x;
  arg[1] = &y;
  res[0] = found;
  res[1] = found + 1;
  f(arg, res);
}
"""
    (tmp_path / "f.c").write_text(head + plain({"f": made}, "double") + entry)
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", "-fPIC", "-shared"]
    result = cc([*codegen.find_compiler("c").command, *strict], tmp_path, "f.c", output="f.so")
    assert result.returncode == 0, result.stderr
    at, found = ctypes.CDLL(str(tmp_path / "f.so")).at, (ctypes.c_double * 2)(math.nan, math.nan)
    at.argtypes = [ctypes.c_double, ctypes.c_double, ctypes.POINTER(ctypes.c_double)]
    for x in np.linspace(-1.5, 2.5, 97):
        for y in (-0.3, 0.0, 0.7):
            at(x, y, found)
            assert list(found) == [float(number) for number in made(x, y)]
