"""Loads along links: exact in every section, by statics, by vector Newton-Euler,
and at free tips.
"""

import casadi as ca
import numpy as np
import pytest
from internals import DesignEngine, EvaluationMethod, Status

from lagrange_casadi import (
    Mechanism,
    Scene,
    curve,
    density,
    evaluate,
    motion,
)
from lagrange_casadi.errors import DeclarationError, ParameterError

pytestmark = pytest.mark.usefixtures("interpreted")


def beam(x=0.0, y=0.0, angle=0.0, turning=False, length=2.0, mass=3.0):
    """A cantilever at rest, without gravity."""
    m = Mechanism("beam")
    m.set_gravity(0.0, 0.0)
    arm = m.link("arm", length=length, mass=mass)
    m.revolute("wall", m.ground, arm)
    m.line_load("wind", arm, x=x, y=y, turning=turning)
    return Scene(m, {"wall": motion.polynomial(angle)}, t=(0, 1, 3), xi=(0, 1, 9))


def test_a_cantilever_of_the_textbooks():
    """Under an even load q: shear -q (l - xi) on the tip's side, bending -q (l - xi)^2/2, both
    nothing at the free tip.
    """
    solution = evaluate(beam(y=-7.0))
    free = 2.0 * (1.0 - solution.xi)
    section = solution.section("arm")
    np.testing.assert_allclose(section.shear[0], -7.0 * free, rtol=0, atol=1e-14 * 14)
    np.testing.assert_allclose(section.bending[0], -7.0 * free**2 / 2, rtol=0, atol=1e-14 * 14)
    np.testing.assert_array_equal(section.axial, 0.0)
    assert solution.effort("wall")[0] == pytest.approx(7.0 * 2.0**2 / 2, rel=1e-14)
    assert solution.reaction("wall").fy[0] == pytest.approx(14.0, rel=1e-14)
    assert solution.array("load:wind:fy")[0] == pytest.approx(-14.0, rel=1e-15)
    np.testing.assert_array_equal(solution.array("load:wind:mz"), 0.0)


def test_a_triangular_load_and_a_load_along_the_axis():
    """From nothing at the base to q at the tip: the moment at the wall is q l^2/3.

    Along the axis the sum beyond the section.
    """
    solution = evaluate(beam(y=(0.0, 6.0), x=(4.0, -2.0), angle=0.7, turning=True))
    u, l, section = solution.xi, 2.0, solution.section("arm")
    np.testing.assert_allclose(section.shear[0], 6.0 * l * (1 - u**2) / 2, rtol=0, atol=1e-13)
    np.testing.assert_allclose(
        section.bending[0], 6.0 * l * l * (1 / 3 - u / 2 + u**3 / 6), rtol=0, atol=1e-13
    )
    np.testing.assert_allclose(
        section.axial[0], l * (4.0 * (1 - u) - 6.0 * (1 - u**2) / 2), rtol=0, atol=1e-13
    )
    assert solution.section("arm").bending[0, 0] == pytest.approx(6.0 * l * l / 3, rel=1e-14)
    assert solution.array("load:wind:mz")[0] == pytest.approx(6.0 * l * l / 12, rel=1e-14)
    np.testing.assert_array_equal(
        [section.shear[:, -1], section.bending[:, -1], section.axial[:, -1]], 0.0
    )


def test_it_does_not_depend_on_how_the_mass_is_told_or_how_large_it_is():
    solutions = [evaluate(beam(y=(3.0, 5.0), mass=mass)) for mass in (3.0, 1e-6, 1e6)]
    m = Mechanism("told")
    m.set_gravity(0.0, 0.0)
    arm = m.link("arm", length=2.0, density=density.polynomial(1.5))
    m.revolute("wall", m.ground, arm)
    m.line_load("wind", arm, y=(3.0, 5.0))
    solutions.append(
        evaluate(Scene(m, {"wall": motion.polynomial(0.0)}, t=(0, 1, 3), xi=(0, 1, 9)))
    )
    for other in solutions[1:]:
        assert other.certified
        for force in ("shear", "bending"):
            expected_ = getattr(solutions[0].section("arm"), force)
            found = getattr(other.section("arm"), force)
            np.testing.assert_allclose(
                found, expected_, rtol=0, atol=1e-13 * np.abs(expected_).max()
            )


def test_what_bears_no_line_load_is_refused_by_name():
    m = Mechanism("refused")
    rod = m.link("rod", length=1.0, mass=1.0)
    ball = m.point_mass("ball", 1.0)
    low = m.parameter("low", 0.2, "m")
    for place in (ball, m.ground):
        with pytest.raises(
            DeclarationError,
            match=r"load 'wind': expected a link for a line load, got '\w+'; use a force",
        ):
            m.line_load("wind", place, y=1.0)
    expected_one = (
        r"load 'wind': expected one value, two values at its start and end, or a function of the"
        r" distance .*, got"
    )
    for value in ((1.0, 2.0, 3.0), ()):
        with pytest.raises(DeclarationError, match=expected_one):
            m.line_load("wind", rod, y=value)
    with pytest.raises(DeclarationError, match="load 'wind' must be a number or an expression"):
        m.line_load("wind", rod, y="strong")
    for foreign in (ca.SX.sym("foreign"), lambda xi: xi * ca.SX.sym("foreign")):
        with pytest.raises(DeclarationError, match="load 'wind' depends on 'foreign'"):
            m.line_load("wind", rod, y=foreign)
    no_polynomial = (
        "load 'wind' must be a polynomial of the distance from the base, of degree 7 at most; use"
        " one"
    )
    shape = curve([0.0, 0.3, 0.6, 1.0], [1.0, 2.0, 1.5, 0.0])
    wrong = (
        ca.sin,
        ca.fabs,
        shape,
        lambda xi: xi**8,
        lambda xi: 1 / (1 + xi),
        lambda xi: ca.if_else(xi < 0.5, 1.0, 2.0),
    )
    for function in (
        *wrong,
        lambda xi: xi**0.5,
        lambda xi: 2**xi,
        lambda xi: low**xi,
        lambda xi: ca.fmax(xi, low),
    ):
        with pytest.raises(DeclarationError, match=no_polynomial):
            m.line_load("wind", rod, y=function)
    with pytest.raises(DeclarationError, match=r"load 'wind' cannot be made .*: ZeroDivisionError"):
        m.line_load("wind", rod, y=lambda xi: xi * (1 / 0))
    with pytest.raises(
        DeclarationError,
        match=r"load 'wind' cannot be .* of the distance from the base .*: a symbol has no truth",
    ):
        m.line_load("wind", rod, y=lambda xi: xi if xi > 0 else 0)
    with pytest.raises(
        DeclarationError, match=r"load 'wind' must be a scalar, got one of shape \(2, 1\)"
    ):
        m.line_load("wind", rod, y=lambda xi: ca.vertcat(xi, xi))
    with pytest.raises(
        DeclarationError, match="load 'wind': between must be two distances from the base of 'rod'"
    ):
        m.line_load("wind", rod, y=1.0, between=0.3)
    with pytest.raises(
        DeclarationError, match="load 'wind': between depends on 't', not a parameter"
    ):
        m.line_load("wind", rod, y=1.0, between=(0.0, m.time))
    with pytest.raises(
        DeclarationError,
        match=r"load 'wind': between must be two increasing distances from the base, got 0\.5",
    ):
        m.line_load("wind", rod, y=1.0, between=(0.5, 0.5))
    m.line_load("wind", rod, y=1.0, between=(low, 0.6))
    with pytest.raises(DeclarationError, match="load 'wind' is declared twice"):
        m.line_load("wind", rod, y=1.0)
    m.revolute("J", m.ground, rod)
    m.weld("W", rod.tip, ball)
    scene = Scene(m, {"J": motion.polynomial(0.0)}, t=(0, 1, 3))
    told = r"load 'wind': it acts between {} and 0.6 m, but link 'rod' is from 0 to 1 m"
    with pytest.raises(ParameterError, match=told.format("-0.1")):
        evaluate(scene, parameters={"low": -0.1})
    with pytest.raises(
        ParameterError,
        match=r"load 'wind': it acts between 0\.7 and 0\.6 m; expected an end greater than the"
        r" start",
    ):
        evaluate(scene, parameters={"low": 0.7})
    engine = DesignEngine.of(scene, method=EvaluationMethod("vm"))
    assert engine.evaluate(np.array([[0.2], [-0.1], [0.6], [0.7]])).status.tolist() == [
        Status.OK,
        *[Status.IMPOSSIBLE] * 3,
    ]
