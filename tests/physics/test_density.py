"""Densities along a link: their moments against exact fractions."""

from fractions import Fraction

import casadi as ca
import numpy as np
import pytest

from lagrange_casadi import curve
from lagrange_casadi.density import Density, along, polynomial, tabulated, uniform

pytestmark = pytest.mark.quick

U = (0.0, 0.25, 0.4999, 0.9985, 0.9995, 1.0 - 2.0**-40, 1.0)

DENSITIES = {
    "uniform": uniform(2.0),
    "polynomial": polynomial(1.0, -2.0, 3.0),
    "table": tabulated([0.0, 0.5, 1.0], [1.0, 3.0, 0.0]),
    # Its last cells are steep and narrow: in powers of the ratio they are differences of large
    # numbers.
    "steep": tabulated([0.0, 2.0**-20, 0.5, 1.0 - 2.0**-20, 1.0], [2.0, 1.0, 3.0, 0.5, 0.0]),
}


def integral(density, low, weight):
    """Of the density times a polynomial in the ratio, its coefficients given, from ``low`` to the
    tip.
    """
    total = Fraction(0)
    for (a, b), cell in zip(
        zip(density.breaks, density.breaks[1:], strict=False), density.cells, strict=True
    ):
        a, b = max(Fraction(a), low), Fraction(b)
        for i, coefficient in enumerate(cell if b > a else ()):
            for j, factor in enumerate(weight):
                total += (
                    Fraction(coefficient)
                    * factor
                    * (b ** (i + j + 1) - a ** (i + j + 1))
                    / (i + j + 1)
                )
    return total


@pytest.mark.parametrize("name", DENSITIES)
def test_tails(name):
    """T_k(u), the k-th moment about u of what lies beyond it, to the last digits of its largest
    value.
    """
    density = DENSITIES[name].at(float, 1.0)
    found = density.tails(np.array(U))
    for i, u in enumerate(map(Fraction, U)):
        for tail, weight in zip(found, ([1], [-u, 1], [u * u, -2 * u, 1]), strict=True):
            assert (
                abs(tail[i] - float(integral(density, u, weight)))
                <= 8 * np.finfo(float).eps * tail[0]
            )


@pytest.mark.parametrize("name", DENSITIES)
def test_ends(name):
    """Two masses and a moment of inertia that have the link's mass, first and second moment."""
    density, length = DENSITIES[name].at(float, 1.0), 0.7
    scale = length if DENSITIES[name].per_length else 1.0
    exact = [
        float(integral(density, Fraction(0), weight)) for weight in ([1, -1], [0, 1], [0, -1, 1])
    ]
    base, tip, inertia = DENSITIES[name].ends(length)
    np.testing.assert_allclose(
        [base / scale, tip / scale, inertia / scale / length**2],
        exact,
        rtol=0,
        atol=8e-16 * (exact[0] + exact[1]),
    )


def test_a_density_tells_where_it_jumps():
    ratios = [0.0, 0.2, 0.7, 1.0]
    smooth = curve(ratios, [1.0, 3.0, 2.0, 2.5])
    for one in (
        uniform(2.0),
        polynomial(1.0, -0.5),
        tabulated(ratios, [1, 3, 2, 5]),
        along(smooth),
    ):
        assert one.jumps == ()
        assert one.at(float, 0.7).jumps == ()
    stepped = Density((0.0, 0.3, 0.6, 1.0), ((1.0,), (2.0, -1.0), (1.4,)), per_length=True)
    assert stepped.jumps == stepped.at(float, 0.7).jumps == (0.3,)
    unknown = Density((0.0, 0.3, 1.0), ((ca.SX.sym("a"),), (2.0,)), per_length=True)
    assert unknown.jumps == (0.3,)
