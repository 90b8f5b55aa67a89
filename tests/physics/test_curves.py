"""Smooth curves and tables: through their points, joined as they should be, with exact
derivatives, and what is beyond their ends.
"""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from splines import by_hand

from lagrange_casadi import Mechanism, Scene, curve, density, evaluate, motion, prepare, table
from lagrange_casadi.errors import AssemblyError, DeclarationError, ParameterError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@st.composite
def points(draw, periodic):
    steps = draw(st.lists(st.floats(0.01, 3.0), min_size=3, max_size=30))
    x = draw(st.floats(-100.0, 100.0)) + np.concatenate([[0.0], np.cumsum(steps)])
    y = draw(st.lists(st.floats(-1e3, 1e3), min_size=x.size, max_size=x.size))
    return x, np.array([*y[:-1], y[0]] if periodic else y)


@pytest.mark.parametrize("periodic", [False, True])
@settings(deadline=None)
@given(data=st.data())
def test_pieces_pass_through_the_points_as_the_spline_does(periodic, data):
    x, y = data.draw(points(periodic))
    found, expected = curve(x, y, periodic=periodic), by_hand(x, y, periodic)
    # As exact as the largest terms of a piece let it be.
    terms = np.abs(np.array(found.cells) * np.diff(x)[:, None] ** np.arange(4)).max()
    within = 1e-14 * terms * np.abs(x).max() / np.diff(x).min()
    np.testing.assert_allclose(found(x), y, rtol=0, atol=within)
    for place in np.linspace(x[0], x[-1], 17):
        assert found(float(place)) == pytest.approx(
            expected(place)[0], rel=1e-8, abs=1e-8 * np.abs(found(x)).max() + 1e-300
        )


def test_an_expression_has_the_values_and_exact_derivatives_of_its_pieces():
    x = np.array([0.0, 0.4, 1.0, 1.3, 2.0, 2.6])
    y = np.array([0.0, 1.0, 0.5, -0.4, 0.2, 0.0])
    for periodic in (False, True):
        found, expected = curve(x, y, periodic=periodic), by_hand(x, y, periodic)
        s = ca.SX.sym("s")
        rate = ca.jacobian(found(s), s)
        ways = [
            found(s),
            rate,
            ca.jacobian(rate, s),
            ca.gradient(found(s), s),
            ca.jtimes(found(s), s, 1),
        ]
        function = ca.Function("f", [s], ways)
        for place in np.linspace(-4.0, 7.0, 223) if periodic else np.linspace(0.0, 2.6, 53):
            value, slope, bend, back, forth = (float(number) for number in function(place))
            np.testing.assert_allclose((value, slope, bend), expected(place), rtol=0, atol=1e-12)
            assert back == pytest.approx(slope, rel=1e-14)
            assert forth == pytest.approx(slope, rel=1e-14)
            assert found(float(place)) == pytest.approx(value, rel=0, abs=1e-14)

    def instructions(count):
        s = ca.SX.sym("s")
        return ca.Function(
            "f", [s], [curve(np.arange(count), np.sin(np.arange(count)))(s)]
        ).n_instructions()

    assert instructions(6) == instructions(600)


def test_a_curve_of_numbers_is_numbers():
    found = curve([0, 1, 2, 3], [0, 1, 8, 27])
    assert found(1.5) == pytest.approx(3.375)
    assert isinstance(found(1.5), float)
    np.testing.assert_allclose(found([0.5, 2.5]), [0.125, 15.625])
    assert repr(found) == "<Curve of 4 points, from 0 to 3>"
    with pytest.raises(DeclarationError, match=r"curve: 3\.5 is outside its range, 0 to 3"):
        found(3.5)
    with pytest.raises(
        DeclarationError, match=r"expected a scalar casadi\.SX expression or finite numbers"
    ):
        found(ca.SX.sym("v", 2))


@pytest.mark.parametrize(
    ("x", "y", "options", "message"),
    [
        (
            [0, 1, 2, 3],
            [0, 1, 2],
            {},
            "curve: expected two rows of one length, at least 4, got 4 and 3",
        ),
        ([0, 1, 2], [0, 1, 2], {}, "at least 4, got 3 and 3"),
        ([0, 1, 1, 3], [0, 1, 2, 3], {}, "places must increase, but entry 2 is at 1 after 1"),
        ([0, 1, 2, math.nan], [0, 1, 2, 3], {}, "all numbers must be finite"),
        ([0, 1, 2, 3], [0, 1, math.inf, 3], {}, "all numbers must be finite"),
        (
            [0, 1, 2, 3],
            [0, 1, 2, 0.1],
            {"periodic": True},
            "ends as it begins, but its values are 0 at 0 and 0.1 at 3",
        ),
        (
            [0, 1, 2, 3],
            [0, 1, 2, 0.1],
            {"smoothing": -1.0},
            "smoothing must be a finite number that is not negative, got -1.0",
        ),
        ([0, 1, 2, 3], [0, 1, 2, 0.1], {"smoothing": 5.0}, "a straight line, .* of 0.794198;"),
        (
            [0, 1, 2, 3],
            [0, 1, 2, 0],
            {"smoothing": 5.0, "periodic": True},
            "leaves only a constant",
        ),
        ("abcd", [0, 1, 2, 3], {}, "curve: x: expected a row of numbers, got 'abcd'"),
    ],
)
def test_what_is_no_curve(x, y, options, message):
    with pytest.raises(DeclarationError, match=message):
        curve(x, y, **options)


@pytest.mark.parametrize("periodic", [False, True])
def test_smoothing_leaves_as_much_as_it_is_told(periodic):
    x = 2 * math.pi * np.cumsum([0.0, *([1.0, 3.0, 2.0] * 60)]) / 360.0
    noise = np.random.default_rng(1).normal(size=x.size) * 1e-3
    y = (
        np.sin(x)
        + noise
        - (noise[-1] * (x == x[-1]) - noise[0] * (x == x[-1]) if periodic else 0.0)
    )
    y[-1] = y[0] if periodic else y[-1]
    found = curve(x, y, periodic=periodic, smoothing=1e-3)
    kept = slice(None, -1) if periodic else slice(None)
    assert np.sqrt(np.mean((found(x) - y)[kept] ** 2)) == pytest.approx(1e-3, rel=1e-6)
    assert np.sqrt(np.mean((found(x) - np.sin(x)) ** 2)) < 0.7e-3
    # What is smooth already hardly bends more than before.
    s = ca.SX.sym("s")
    bend = ca.Function("bend", [s], [ca.jacobian(ca.jacobian(found(s), s), s)])
    assert np.abs(bend(x[None, 5:-5]).full()).max() < 2.0 < np.abs(np.diff(y, 2) / x[1] ** 2).max()


STOP = [-0.6, -0.2, 0.2, 0.6], [9.0, 1.0, -1.0, -9.0]


def beyond(motion_law=None, law=None):
    """A load by a curve that ends at 0.6 rad of a swinging arm."""
    m = Mechanism("ended")
    arm = m.link("arm", length=m.parameter("l", 0.5, "m", low=0.0), mass=1.0)
    swing = m.parameter("swing", 0.5, "rad")
    joint = m.revolute("J", m.ground, arm)
    m.torque("stop", arm, (law or curve(*STOP))(m.coordinate(joint)))
    return Scene(m, {"J": motion_law or motion.harmonic(0.0, swing, 1.0)}, t=(0, 1, 101))


@pytest.mark.parametrize("kind", ["curve", "table"])
@pytest.mark.parametrize("backend", ["vm", "c", "lanes"])
def test_an_argument_beyond_the_ends_is_refused_by_name(kind, backend):
    """Just at the ends it is not, and what does not need the load does not ask for it."""
    scene = beyond(law=None if kind == "curve" else lambda x: table(x, *STOP))
    cure = "; expected points that reach further, or beyond='hold' or beyond='line'"
    says = (
        rf"load 'stop': the argument of its {kind}, from -0\.6 to 0\.6, is outside the {kind}'s"
        rf" range at t = 0\.15 s, where J = .*, by 0\.00564 of that range"
        rf"{cure if kind == 'table' else ''}$"
    )
    with pytest.raises(AssemblyError, match=says):
        evaluate(scene, parameters={"swing": 0.75}, backend=backend)
    found = prepare(scene).designs(np.array([[0.5, 0.5], [0.5, 0.75], [0.5, 0.6]]))
    assert (found.status == 0).tolist() == [True, False, True]
    assert evaluate(scene, wanted=["motion"], parameters={"swing": 0.75}).certified


@pytest.mark.parametrize(("way", "most"), [("hold", 9.0), ("line", 9.0 + 20.0 * 0.15)])
def test_a_table_goes_on_beyond_its_ends_as_it_is_told(way, most):
    scene = beyond(law=lambda x: table(x, *STOP, beyond=way))
    for backend in ("vm", "c", "lanes"):
        solution = evaluate(scene, parameters={"swing": 0.75}, backend=backend)
        assert solution.certified
        assert abs(solution.array("load:stop:mz")).max() == pytest.approx(most, rel=1e-12)


def test_a_part_beyond_the_ends_is_refused_by_name():
    """A length by a curve over a parameter, as of a series of parts."""
    m = Mechanism("series")
    length = curve([1, 2, 3, 4], [0.2, 0.3, 0.5, 0.9])(m.parameter("size", 2.0))
    m.revolute("J", m.ground, m.link("arm", length=length, mass=1.0))
    scene = Scene(m, {"J": motion.polynomial(0.0, 1.0)}, t=(0, 1, 11))
    found = evaluate(scene, parameters={"size": 4.0}).description.bodies["arm"]
    assert found.length == pytest.approx(0.9, rel=1e-14)
    says = r"link 'arm': .* curve, from 1 to 4, is outside the curve's range"
    with pytest.raises(ParameterError, match=says):
        evaluate(scene, parameters={"size": 4.1})
    status = prepare(scene).designs(np.array([[3.0], [0.9], [4.0]])).status
    assert (status == 0).tolist() == [True, False, True]


def test_a_density_along_a_curve():
    """A cubic is its own spline."""

    def bar(matter):
        m = Mechanism("bar")
        m.revolute("J", m.ground, m.link("bar", length=0.7, density=matter))
        return evaluate(Scene(m, {"J": motion.polynomial(0.2, 3.0, 4.0)}, t=(0, 1, 5)))

    u = np.array([0.0, 0.2, 0.5, 0.6, 0.9, 1.0])
    found = bar(density.along(curve(u, 4 - 3 * u + u**3)))
    expected = bar(density.polynomial(4.0, -3.0, 0.0, 1.0))
    for force in ("axial", "shear", "bending"):
        a, b = (getattr(solution.section("bar"), force) for solution in (found, expected))
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-13 * np.abs(b).max())
    with pytest.raises(DeclarationError, match="the curve must reach from 0 to 1"):
        density.along(curve([0, 1, 2, 3], [1, 1, 1, 1]))
    with pytest.raises(DeclarationError, match="along: curve: expected a Curve"):
        density.along([1, 2, 3])


LOOKED_UP = ca.interpolant("spring", "bspline", [[0.0, 1, 2, 3, 4]], [0.0, 1, 4, 9, 16])


@pytest.mark.parametrize(
    "declare",
    [
        lambda m, x, p: m.constraint("cam", x - LOOKED_UP(m.time)),
        lambda m, x, p: m.force("spring", p, x=LOOKED_UP(x)),
        lambda m, x, p: evaluate(Scene(m, {"X": motion.expression(LOOKED_UP)}, t=(0, 1, 3))),
    ],
)
def test_interpolants_of_casadis_are_refused_with_the_way_out(declare):
    m = Mechanism("looked_up")
    p = m.point_mass("p", 1.0)
    x = m.coordinate(m.prismatic("X", m.ground, p, axis=(1, 0)))
    with pytest.raises(DeclarationError, match=r"calls casadi\.interpolant"):
        declare(m, x, p)
