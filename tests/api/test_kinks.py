"""Kinks of what is differentiated twice: found by numbers, and refused with the way out."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import Smooth

from lagrange_casadi import Mechanism, Scene, derive, evaluate, table
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import expression, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

X, Y, T = (ca.SX.sym(name) for name in "xyt")
TURN = np.linspace(0.0, math.tau, 37)


def found(program, span=(-20.0, 20.0)):
    """The worst kink along a line by each symbol, while the others stand still."""
    smooth = Smooth.of(program, ca.vertcat(X, Y, T), ca.SX(0, 1))
    if smooth is None:
        return None
    along, count = np.linspace(*span, 4001), len(smooth.symbols)
    kinks = []
    for k in range(count):
        path = np.tile(np.array([0.13, -0.27, 0.41])[:count, None], along.size)
        path[k] = along
        kinks.append(smooth.kink(path, ()))
    return max(filter(None, kinks), key=lambda one: one.jump, default=None)


def rise(u):
    """From 0 to 1 over u from 0 to 1, with no slope and no bend at either end."""
    return ca.if_else(u < 0, 0, ca.if_else(u < 1, u**3 * (10 - 15 * u + 6 * u**2), 1))


SMOOTH = {
    "nothing that could": ca.sin(X) * Y + X**3 - ca.sqrt(1 + Y**2),
    "pieces that go on": Y - rise(X) + 0.3 * rise(2 * X - 3),
    "an acceleration that jumps": Y - ca.if_else(X < 0.3, X**2, 0.09 + 0.6 * (X - 0.3)),
    "a square of a size": ca.fabs(X) * X + Y,
    "a square of what is left": Y - ca.fmax(X - 0.3, 0) ** 2,
    "a sine of a remainder": Y - ca.sin(ca.remainder(X, math.tau)) * ca.cos(ca.fmod(Y, math.tau)),
    "a curve that comes round": Y - rise(ca.fmod(X, 3.0)) + rise(ca.fmod(X, 3.0) - 1.5),
    "a table of a straight line": Y - table(X, [0.0, 1.0, 2.0], [1.0, 3.0, 5.0]),
    "whole parts of a parameter alone": Y * ca.floor(2.5),
    "a quotient of what is small": Y - (1 - ca.cos(X - 0.3)) / (X - 0.3) ** 2,
    "the same where it is kept from noise": (
        Y - ca.if_else(ca.fabs(X) < 1e-3, 0.5 - X**2 / 24, (1 - ca.cos(X)) / X**2)
    ),
    "a quotient of cubes": Y - (X - ca.sin(X)) / X**3,
    "a bump": Y - ca.if_else(X > 0.5, ca.exp(-1 / (X - 0.5)), 0),
    "a power of a size": Y - ca.fabs(X - 0.5) ** 1.3,
    "a size of what only touches zero": Y - ca.fabs(ca.sin(7 * X + 0.0652521) + 1),
    "a corner that is rounded": Y - ca.sqrt((X - 0.3) ** 2 + 1e-9),
}
BROKEN = {
    "a table": (Y - table(X, TURN, np.sin(TURN)), "slope"),
    "a table of micrometres": (
        Y - table(X, 0.3 + 1e-5 * np.arange(5), 1e-5 * np.arange(5) ** 2),
        "slope",
    ),
    "a table of time": (Y - table(T, [0.0, 3.0, 5.0], [0.0, 1.0, 0.0]), "slope"),
    "a table within": (Y - ca.sin(table(ca.cos(X) + Y, [0.0, 0.5, 1.0], [0.0, 0.1, 0.4])), "slope"),
    "CasADi's own": (Y - ca.pw_lin(X, ca.DM([0, 1, 2]), ca.DM([0, 1, 4])), "slope"),
    "a size": (Y - ca.fabs(X), "slope"),
    "the larger one": (Y - ca.fmax(X, Y * T), "slope"),
    "the smaller one": (Y - ca.fmin(X, 0.3), "slope"),
    "a piece too steep": (Y - ca.if_else(X < 1, X, 1 + 1.0001 * (X - 1)), "slope"),
    "a piece too high": (Y - ca.if_else(X < 1, X, X + 1e-3), "value"),
    "whole parts": (Y - ca.floor(X), "value"),
    "a sign": (Y - ca.sign(X - Y), "value"),
    "a remainder": (Y - ca.remainder(X, 1.0), "value"),
    "the angle of a sine": (Y - ca.asin(ca.sin(X)), "slope"),
    "the artanh of a sine": (Y - ca.atanh(ca.sin(X)), "value"),
    "the angle of a cosine": (Y - ca.acos(ca.cos(X)), "slope"),
    "the area cosine of a cosine": (Y - ca.acosh(ca.cosh(X / 9)), "slope"),
    "a cube root": (Y - ca.sign(X - 0.3) * ca.fabs(X - 0.3) ** (1 / 3), "slope"),
    "a size by its logarithm": (Y - (X - 0.3) * ca.log(ca.fabs(X - 0.3)), "slope"),
    "an exponential of an inverse": (Y - ca.exp(-1 / (X - 15.0013)), "value"),
    "waves without end": (Y - (X - 0.3) ** 2 * ca.sin(1 / (X - 0.3)), "slope"),
    "a cut just off the instants": (Y - ca.atan2(ca.sin(X - 1.2e-9), ca.cos(X - 1.2e-9)), "value"),
    "a size by its sign": (Y - ca.copysign(ca.sin(X), 2 + ca.cos(X)), "slope"),
    "a sine's size": (Y - ca.fabs(ca.sin(X)), "slope"),
}


@pytest.mark.parametrize("name", SMOOTH)
def test_smooth(name):
    for span in ((-20.0, 20.0), (-0.2, 0.8)):
        assert found(SMOOTH[name], span) is None


@pytest.mark.parametrize("name", BROKEN)
def test_broken(name):
    program, what = BROKEN[name]
    kinked = found(program)
    assert kinked.what == what
    assert kinked.jump > 0.0


def test_it_says_by_how_much_and_where():
    kinked = found(ca.if_else(X < 0.7, 3 * X, 2.1 + 2 * (X - 0.7)))
    assert str(kinked) == "its slope jumps by 33.3 % where x = 0.7"


@settings(max_examples=30, deadline=None)
@given(
    places=st.lists(st.integers(-600, 600), min_size=3, max_size=12, unique=True),
    values=st.lists(st.integers(-300, 300), min_size=12, max_size=12),
    scale=st.sampled_from([1e-4, 1e-2, 1.0]),
)
def test_tables_are_refused_unless_they_are_straight_lines(places, values, scale):
    """By the slopes that the table itself tells."""
    at, to = scale * np.sort(places), np.array(values[: len(places)], float)
    slopes = np.diff(to) / np.diff(at)
    bent = np.abs(np.diff(slopes)).max() > 1e-6 * np.abs(slopes).max()
    assert (found(table(X, at, to), (at[0] - scale, at[-1] + scale)) is not None) is bool(bent)


@pytest.mark.parametrize(("power", "broken"), [(0.5, True), (1.5, False), (2.5, False)])
def test_at_the_end_of_a_path_one_side_has_a_limit_or_not(power, broken):
    assert (found(T**power, (0.0, 1.0)) is not None) is broken
    assert found(ca.exp(-1 / T), (0.0, 1.0)) is None


def test_only_what_is_within_a_span_is_looked_at():
    law = ca.fmax(ca.fmin(2 * T, 1.0), 0.0)
    for span, broken in (
        ((0.1, 0.4), False),
        ((0.6, 3.0), False),
        ((0.1, 0.6), True),
        ((-1.0, 0.2), True),
    ):
        assert (found(law, span) is not None) is broken


def cam(lift, law=None):
    """A follower on a cam: a crank turns, and a slide's place is a function of its angle."""
    m = Mechanism("cam")
    wheel, follower = m.link("wheel", length=0.1, mass=1.0), m.point_mass("follower", 2.0)
    turn = m.revolute("turn", m.ground, wheel.at(0.05))
    way = m.prismatic("way", m.ground.at(0.0, 0.2), follower, axis=(0, 1))
    m.constraint("profile", m.coordinate(way) - lift(m.coordinate(turn)))
    return Scene(m, {"turn": law or polynomial(0.1, 30.0)}, t=(0.0, 0.2, 101))


def test_a_table_in_a_constraint_is_refused_with_the_way_out():
    """A cam of 36 points: without the curvature between them most of its torque is missing."""
    says = (
        r"constraint 'profile': its slope jumps by \d+\.?\d* % where .*turn = .*expected a curve"
        r" with a continuous slope"
    )
    with pytest.raises(DeclarationError, match=says) as told:
        evaluate(cam(lambda q: table(q, np.tile(TURN, 1), 0.02 * np.sin(TURN))))
    assert "as curve(x, y) in place of a table, a polynomial or a Fourier sum" in str(told.value)


def test_the_way_out_gives_what_newton_says():
    """m (y'' + g) y' = torque w for y = 0.02 sin q; the table's y'' would be zero."""
    solution = evaluate(cam(lambda q: 0.02 * ca.sin(q)))
    q, w = solution.motion("turn").value, 30.0
    torque = 2.0 * (-0.02 * w**2 * np.sin(q) + 9.81) * 0.02 * np.cos(q)
    np.testing.assert_allclose(solution.effort("turn"), torque, rtol=1e-12, atol=1e-12)
    without = 2.0 * 9.81 * 0.02 * np.cos(q)
    assert np.abs(torque - without).max() > 0.4 * np.abs(torque).max()


def test_pieces_that_go_on_smoothly_are_a_cam():
    """Rise, dwell, return by if_else: both the curve and its derivative go on."""
    up = 0.02
    scene = cam(lambda q: up * (rise(q / 2) - rise((q - 3) / 2)), polynomial(0.0, 30.0))
    solution = evaluate(scene)
    u = solution.motion("turn").value / 2
    bend = np.where(u < 1, 60 * u - 180 * u**2 + 120 * u**3, 0) / 4
    slope = np.where(u < 1, 30 * u**2 - 60 * u**3 + 30 * u**4, 0) / 2
    early = solution.motion("turn").value < 3.0
    torque = 2.0 * (up * bend * 900 + 9.81) * up * slope
    np.testing.assert_allclose(
        solution.effort("turn")[early], torque[early], rtol=1e-11, atol=1e-12
    )


@pytest.mark.parametrize(
    ("law", "says"),
    [
        (
            lambda t: table(t, [0.0, 0.1, 0.2], [0.0, 1.0, 3.0]),
            r"slope jumps by 50 % where t = 0\.1",
        ),
        (lambda t: ca.fabs(t - 0.15), r"slope jumps by 200 % where t = 0\.15"),
        (lambda t: ca.floor(10 * t), r"value jumps by 100 % where t = 0\.1"),
    ],
)
def test_motions_with_corners_are_refused_where_they_are_asked_for(law, says):
    scene = cam(lambda q: 0.02 * ca.sin(q), expression(law))
    with pytest.raises(DeclarationError, match=f"the motion of joint 'turn': its {says}"):
        evaluate(scene)
    # Within a piece there is nothing to say.
    assert evaluate(scene, t=(0.01, 0.09, 5)).t.size == 5


def test_tables_stay_in_loads_and_rows():
    """Nothing of a load is differentiated, and a row is linear in the
    rates: its slopes are values.
    """
    m = Mechanism("m")
    a = m.link("a", length=1.0, mass=1.0)
    turn = m.revolute("J", m.ground, a)
    b = m.link("b", length=1.0, mass=1.0)
    second = m.revolute("K", a.tip, b)
    q = m.coordinate(turn)
    m.torque("T", a, table(q, [0.0, 1.0, 2.0], [0.0, 1.0, 4.0]))
    m.nonholonomic(
        "row",
        m.rate(second) - table(q, [0.0, 1.0, 2.0], [1.0, 1.0, 1.0]) * m.rate(turn),
        replaces=second,
    )
    program = derive(Scene(m, {"J": polynomial(0, 1), "K": polynomial(0, 1)}))
    assert {"load:T:mz", "_row:row"} <= set(program.names)


def test_a_table_has_the_slope_of_the_side_beyond_at_its_points():
    """Never zero: peaks between instants go by it."""
    y = table(X, [0.0, 1.0, 2.0, 4.0], [0.0, 1.0, 4.0, 5.0])
    f = ca.Function("f", [X], [y])
    forward, reverse, jacobian = f.forward(1), f.reverse(1), f.jacobian()
    for x, slope in (
        (-1.0, 1.0),
        (0.0, 1.0),
        (1.0, 3.0),
        (1.5, 3.0),
        (2.0, 0.5),
        (4.0, 0.5),
        (5.0, 0.5),
    ):
        assert (
            float(forward(x, f(x), 1.0))
            == float(reverse(x, f(x), 1.0))
            == float(jacobian(x, f(x)))
            == slope
        )
