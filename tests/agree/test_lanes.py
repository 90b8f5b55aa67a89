"""Packs of instants: the numbers of scalar C to a few units in the last place, whatever the
vectors, the tail and the threads.
"""

import platform
import subprocess

import numpy as np
import pytest
from compiled import HEADER

pytestmark = pytest.mark.usefixtures("released")


PROGRAM = r"""
#include <cstdio>
#include <initializer_list>
static void say(const char* name, double x, double y, double found, double expected) {
  printf("%s %.17g %.17g %.17g %.17g\n", name, x, y, found, expected);
}
#define ONE(name) \
  for (double x : xs) { lanes_pack r = name(lanes_pack(x)); for (int i = 0; i < LANES; ++i) say(#name, x, 0, r.v[i], name(x)); }
#define TWO(name) \
  for (double x : xs) for (double y : xs) { \
    lanes_pack r = name(lanes_pack(x), lanes_pack(y)); \
    for (int i = 0; i < LANES; ++i) say(#name, x, y, r.v[i], name(x, y)); }
static double less(double a, double b) { return a < b; }
static double most(double a, double b) { return a <= b; }
static double same(double a, double b) { return a == b; }
static double other(double a, double b) { return a != b; }
static double both(double a, double b) { return a && b; }
static double either(double a, double b) { return a || b; }
static double no(double a) { return !a; }
static double minus(double a) { return -a; }
static double inverse(double a) { return 1. / a; }
static double lanes_choose(double a, double b) { return a != 0 ? b : 0; }
static double lanes_sign(double x) { return x < 0 ? -1 : x > 0 ? 1 : x; }
static lanes_pack less(lanes_pack a, lanes_pack b) { return a < b; }
static lanes_pack most(lanes_pack a, lanes_pack b) { return a <= b; }
static lanes_pack same(lanes_pack a, lanes_pack b) { return a == b; }
static lanes_pack other(lanes_pack a, lanes_pack b) { return a != b; }
static lanes_pack both(lanes_pack a, lanes_pack b) { return a && b; }
static lanes_pack either(lanes_pack a, lanes_pack b) { return a || b; }
static lanes_pack no(lanes_pack a) { return !a; }
static lanes_pack minus(lanes_pack a) { return -a; }
static lanes_pack inverse(lanes_pack a) { return 1. / a; }
int main() {
  const std::initializer_list<double> xs = {
      0.0, -0.0, 1.0, -1.0, 0.3, -0.7, 2.5, -3.5, 1e-9, 7e5, -1e5, 1e-310, 1e300, INFINITY, -INFINITY, NAN};
  ONE(sin) ONE(cos) ONE(exp) ONE(log) ONE(tan) ONE(asin) ONE(acos) ONE(atan) ONE(sinh) ONE(cosh) ONE(tanh) ONE(asinh) ONE(acosh)
  ONE(atanh) ONE(log1p) ONE(expm1) ONE(erf) ONE(sqrt) ONE(floor) ONE(ceil) ONE(fabs) ONE(lanes_sign) ONE(no) ONE(minus) ONE(inverse)
  TWO(atan2) TWO(hypot) TWO(pow) TWO(fmod) TWO(remainder) TWO(fmin) TWO(fmax) TWO(copysign) TWO(lanes_choose)
  TWO(less) TWO(most) TWO(same) TWO(other) TWO(both) TWO(either)
}
"""  # noqa: E501
EXACT = [
    "sqrt",
    "floor",
    "ceil",
    "fabs",
    "lanes_sign",
    "no",
    "minus",
    "inverse",
    "fmod",
    "remainder",
    "fmin",
    "fmax",
    "copysign",
]
EXACT += ["lanes_choose", "less", "most", "same", "other", "both", "either"]
X86 = platform.machine() in ("x86_64", "AMD64")


@pytest.mark.sampled(7)
@pytest.mark.parametrize("libmvec", ["where it is", "none"])
@pytest.mark.parametrize("march", ["native", *(["x86-64", "x86-64-v3"] if X86 else [])])
def test_every_function_of_a_pack(march, libmvec, tmp_path):
    """Against the scalar functions: exact where C99 is, else within 4 units; the same infinities,
    the same NaN.
    """
    source, program = tmp_path / "functions.cpp", tmp_path / "functions"
    source.write_text(HEADER.read_text() + PROGRAM)
    flags = [f"-march={march}", *(["-DLANES_LIBMVEC=0"] if libmvec == "none" else [])]
    command = [
        "c++",
        "-std=c++11",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-Wno-psabi",
        "-Wno-unused-function",
        "-O2",
    ]
    subprocess.run([*command, "-fno-math-errno", *flags, source, "-o", program, "-lm"], check=True)
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    if done.returncode < 0:
        pytest.skip(f"this machine has not the instructions of {march}")
    rows = [line.split() for line in done.stdout.splitlines()]
    assert {row[0] for row in rows} >= {"sin", "pow", *EXACT}
    unsigned = ("fmin", "fmax")  # which zero is the larger one C99 leaves open
    wrong = []
    for name, x, y, found, expected in rows:
        a, b = float(found), float(expected)
        exact = (a == b and (name in unsigned or np.signbit(a) == np.signbit(b))) or (
            np.isnan(a) and np.isnan(b)
        )
        if not exact and (
            name in EXACT or not np.isfinite(b) or abs(a - b) > 4 * np.spacing(abs(b))
        ):
            wrong.append((name, x, y, found, expected))
    assert not wrong
