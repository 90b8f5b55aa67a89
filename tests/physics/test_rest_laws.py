"""Laws from rest to rest: the coefficients that books print, and the laws again, integrated from
how books draw accelerations.
"""

import itertools
import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import LAWS, Limits, rest_law, s_curve, s_curve_within, trapezoid, trapezoid_within

from lagrange_casadi.errors import DeclarationError, UnknownNameError

pytestmark = pytest.mark.quick

PRINTED = {
    # Norton, Cam Design and Manufacturing Handbook, 2nd edition, table 3-5, and VDI 2143, part 1:
    # to the digits that are printed.
    "cycloidal": (2.000, 6.283, 39.5),
    "modified_sine": (1.760, 5.528, 69.5),
    "modified_trapezoid": (2.000, 4.888, 61.4),
    "polynomial_345": (1.875, 5.774, 60.0),
    "polynomial_4567": (2.188, 7.513, 52.5),
    "simple_harmonic": (1.571, 4.935, math.inf),
    "trapezoid": (1.5, 4.5, math.inf),
}


def derivatives(law, u):
    """The law with its first three derivatives at places u."""
    x = ca.SX.sym("u")
    rows = [law.shape(x)]
    for _ in range(3):
        rows.append(ca.jacobian(rows[-1], x))
    return [
        row.full().ravel()
        for row in ca.Function("law", [x], [ca.densify(row) for row in rows])(np.asarray(u)[None])
    ]


@pytest.mark.parametrize("name", PRINTED)
def test_coefficients_are_those_that_books_print(name):
    law = rest_law("move", name)
    for mine, printed in zip((law.speed, law.acceleration, law.jerk), PRINTED[name], strict=True):
        assert mine == pytest.approx(printed, abs=0.06 if printed > 20 else 6e-4)


@pytest.mark.parametrize("name", LAWS)
def test_coefficients_are_the_largest_values(name):
    law, u = rest_law("move", name), np.linspace(0.0, 1.0, 40001)
    found = derivatives(law, u)
    assert found[0][[0, -1]] == pytest.approx([0.0, 1.0], abs=1e-14)
    assert found[1][[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-13)
    assert (np.diff(found[0]) >= -1e-15).all()
    for mine, row in zip((law.speed, law.acceleration, law.jerk), found[1:], strict=True):
        if math.isfinite(mine):
            assert np.abs(row).max() == pytest.approx(mine, rel=1e-7)
    assert found[2][0] == pytest.approx(law.begins[0], abs=1e-12)
    if math.isfinite(law.begins[1]):
        assert found[3][0] == pytest.approx(law.begins[1], abs=1e-9)
    middle = np.linspace(0.0123, 0.4987, 97)
    assert derivatives(law, middle)[0] + derivatives(law, 1 - middle)[0] == pytest.approx(
        1.0, abs=1e-14
    )


def accelerations(name):
    """The places between which an acceleration is smooth, and the acceleration but for its scale,
    as books draw it.
    """
    wave = lambda u: np.sin(4 * np.pi * u)  # noqa: E731
    return {
        "cycloidal": ((0, 1), lambda u: np.sin(2 * np.pi * u)),
        "modified_sine": (
            (0, 1 / 8, 7 / 8, 1),
            lambda u: np.where(
                (u < 1 / 8) | (u > 7 / 8), wave(u), np.sin(4 * np.pi * u / 3 + np.pi / 3)
            ),
        ),
        "modified_trapezoid": (
            (0, 1 / 8, 3 / 8, 5 / 8, 7 / 8, 1),
            lambda u: np.select(
                [u < 1 / 8, u < 3 / 8, u < 5 / 8, u < 7 / 8],
                [wave(u), 1.0, np.cos(4 * np.pi * (u - 3 / 8)), -1.0],
                wave(u),
            ),
        ),
        "polynomial_345": ((0, 1), lambda u: u * (1 - u) * (1 - 2 * u)),
        "polynomial_4567": ((0, 1), lambda u: (u * (1 - u)) ** 2 * (1 - 2 * u)),
        "simple_harmonic": ((0, 1), lambda u: np.cos(np.pi * u)),
        "trapezoid": (
            (0, 1 / 3, 2 / 3, 1),
            lambda u: np.select([u < 1 / 3, u < 2 / 3], [1.0, 0.0], -1.0),
        ),
        "s_curve": (
            (0, 1 / 12, 3 / 12, 4 / 12, 8 / 12, 9 / 12, 11 / 12, 1),
            lambda u: np.interp(
                u, np.array([0, 1, 3, 4, 8, 9, 11, 12]) / 12, [0, 1, 1, 0, 0, -1, -1, 0]
            ),
        ),
    }[name]


@pytest.mark.parametrize("name", LAWS)
def test_laws_are_their_accelerations_integrated_twice(name):
    breaks, bend = accelerations(name)
    nodes, weights = np.polynomial.legendre.leggauss(30)

    def integral(f, stop):
        total = 0.0
        for a, b in itertools.pairwise(breaks):
            a, b = min(a, stop), min(b, stop)
            total += (b - a) / 2 * (weights @ f((a + b) / 2 + (b - a) / 2 * nodes))
        return total

    # s(u) is the integral of (u - x) a(x) over x up to u.
    whole = integral(lambda x: (1 - x) * bend(x), 1.0)
    places = np.array([0.02, 0.11, 0.2, 0.37, 0.49, 0.58, 0.71, 0.86, 0.97])
    found = derivatives(rest_law("move", name), places)
    for k, u in enumerate(places):
        expected = [
            integral(lambda x, u=u: (u - x) * bend(x), u),
            integral(bend, u),
            float(bend(np.array(u))),
        ]
        assert [row[k] for row in found[:3]] == pytest.approx(
            [x / whole for x in expected], rel=0, abs=2e-13
        )


def slowest_top(way, v, a, j):
    """The top speed and the time of the fastest move within limits, by halving the speed at which
    no time is left to cruise.
    """

    def ramp(top):
        return top / a + a / j if top >= a * a / j else 2 * math.sqrt(top / j)

    low, high = 0.0, v
    if v * ramp(v) > way:
        for _ in range(200):
            low, high = (
                ((low + high) / 2, high)
                if (low + high) / 2 * ramp((low + high) / 2) < way
                else (low, (low + high) / 2)
            )
    return high, way / high + ramp(high)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.floats(-3.0, 3.0), min_size=4, max_size=4))
def test_s_curves_within_limits_are_the_fastest(powers):
    way, v, a, j = (10.0**power for power in powers)
    limits = Limits(v, a, j)
    law = s_curve_within(way, limits)
    top, time = slowest_top(way, v, a, j)
    least = float(law.least_time(way, limits))
    assert least == pytest.approx(time, rel=1e-9)
    assert law.speed * way / least == pytest.approx(top, rel=1e-9)
    assert law.acceleration * way / least**2 <= a * (1 + 1e-9)
    assert law.jerk * way / least**3 == pytest.approx(j, rel=1e-9)
    found = derivatives(law, np.linspace(0.0, 1.0, 2001))
    assert np.abs(found[1]).max() * way / least == pytest.approx(top, rel=1e-5)
    assert found[0][-1] == pytest.approx(1.0, abs=1e-13)
    for number, (place, (_, sharp)) in enumerate(law.inner):
        before, after = derivatives(law, np.clip([place - 1e-9, place + 1e-9], 0, 1))[3]
        if all(abs(place - other) > 1e-6 for k, (other, _) in enumerate(law.inner) if k != number):
            assert after - before == pytest.approx(sharp, rel=1e-9)


@pytest.mark.parametrize(
    ("way", "time"), [(2.0, 2.0 / 0.5 + 0.5 / 2.0), (0.1, 2 * math.sqrt(0.1 / 2.0))]
)
def test_trapezoids_within_limits(way, time):
    """With a stretch of top speed, and as a triangle without one."""
    limits = Limits(0.5, 2.0)
    law = trapezoid_within(way, limits)
    assert float(law.least_time(-way, limits)) == pytest.approx(time, rel=1e-14)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: trapezoid(0.6), r"trapezoid: share must be above 0 and at most 0\.5, got 0\.6"),
        (lambda: trapezoid(0.0), "trapezoid: share must be above 0"),
        (lambda: s_curve(0.3, 1.5), "s_curve: rounding must be above 0 and at most 1, got 1.5"),
        (
            lambda: s_curve("a"),
            "s_curve: share: expected a number, or an expression in parameters, got 'a'",
        ),
        (lambda: rest_law("move 'up'", 3), "move 'up': law: expected a name, trapezoid"),
    ],
)
def test_misuse_is_named(make, says):
    with pytest.raises(DeclarationError, match=says):
        make()


def test_unknown_laws_are_told_with_the_nearest():
    with pytest.raises(
        UnknownNameError,
        match=r"move 'up': unknown law 'polynomial_34' \(did you mean 'polynomial_345'\?\)",
    ):
        rest_law("move 'up'", "polynomial_34")
