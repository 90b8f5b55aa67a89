"""Velocities that an energy may be written in, and those that may not: rates of places, and rates
of nothing.
"""

import re

import casadi as ca
import numpy as np
import pytest

from lagrange_casadi import LagrangeSystem
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

INERTIA = np.array([0.7, 1.1, 1.6])


def symbols(n):
    return (ca.SX.sym(name, n) for name in ("q", "qd", "qdd"))


def wrong(graphs, q, qd, qdd, **given):
    """Velocities that are refused as no rates of anything."""
    w = ca.SX.sym("w", graphs.numel())
    try:
        told = {"velocities": w, "velocity_graphs": graphs, **given}
        LagrangeSystem(ca.sumsqr(w), ca.SX(0), q, qd, qdd, **told)
    except DeclarationError as error:
        if refused := re.match(r"velocity_graphs: velocit\w+ ([0-9, ]+) \(counted", str(error)):
            return [int(number) for number in refused[1].split(",")]
        raise
    return []


def axes_of(q):
    """The axes of a body turned about z, then about its x, then about its z, as the columns of a
    matrix.
    """

    def about(axis, angle):
        c, s = ca.cos(angle), ca.sin(angle)
        rows = {"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[
            axis
        ]
        return ca.vertcat(*(ca.horzcat(*row) for row in rows))

    return about("z", q[0]) @ about("x", q[1]) @ about("z", q[2])


def turning(q, qd):
    """A body's rates of turning about its own axes, and the rates of its axes."""
    axes = axes_of(q)
    change = ca.reshape(ca.jtimes(ca.vec(axes), q, qd), 3, 3)
    skew = axes.T @ change
    return ca.vertcat(skew[2, 1], skew[0, 2], skew[1, 0]), change


@pytest.mark.parametrize("seed", range(12))
def test_rates_of_places_are_told_from_others_by_number(seed):
    """Of nothing are a product of a coordinate and another one's rate, a speed without a direction,
    and a place's rate that forgets what time itself moves: among places of micrometres and of
    kilometres.
    """
    r = np.random.default_rng(seed)
    q, qd, qdd = symbols(3)
    t, i = ca.SX.sym("when"), int(r.integers(3))
    j, k = (i + 1) % 3, (i + 2) % 3
    moved, drives = (ca.sin(3 * t), t) if seed % 2 else (0.0, None)
    graphs, nothing = [], []
    for size in 10.0 ** r.integers(-6, 7, 20):
        place = ca.sin(r.normal() * q[i] + moved) * q[j] + r.normal() * ca.cos(q[k] * q[j])
        rate = ca.jtimes(place, ca.vertcat(q, t), ca.vertcat(qd, 1))
        others = [q[i] * qd[j], qd[i] * qd[j], ca.sqrt(qd[i] ** 2 + q[i] ** 2 * qd[j] ** 2)]
        if seed % 2:
            others.append(ca.jtimes(place, q, qd))
        chosen = int(r.integers(8))
        # What is left of two products is one rounding: no rate of anything.
        rest = qd[j] * (ca.cos(q[i]) * ca.sin(q[i]) - ca.sin(q[i]) * ca.cos(q[i]))
        nothing.append(chosen < len(others))
        graphs.append(size * (others[chosen] if nothing[-1] else rate + rest))
    told = wrong(ca.vertcat(*graphs), q, qd, qdd, time=drives)
    assert told == np.flatnonzero(nothing).tolist()


def test_graphs_may_rely_on_a_cosine_and_a_sine_being_those_of_an_angle():
    """s / sqrt(1 - c^2) is a sign: so it is on the circle, and only there."""
    p, qd, qdd = ca.SX.sym("p", 3), ca.SX.sym("qd", 2), ca.SX.sym("qdd", 2)
    c, s, x = ca.vertsplit(p)
    tangent = ca.blockcat([[-s, 0], [c, 0], [0, 1]])
    rate = (s * qd[1] + x * c * qd[0]) * s / ca.sqrt(1 - c**2)  # of x |s|
    assert wrong(rate, p, qd, qdd, tangent=tangent) == []
    assert wrong(rate + 1e-3 * c * qd[1], p, qd, qdd, tangent=tangent) == [0]


def test_graphs_that_have_values_rarely_are_checked_there():
    """Roots of what is mostly negative."""
    q, qd, qdd = symbols(1)
    long, short = ca.SX.sym("l"), ca.SX.sym("r")
    rate = ca.jtimes(ca.sqrt(long**2 - 30.0 * short**2 - ca.sin(q) ** 2), q, qd)
    assert wrong(rate, q, qd, qdd) == []
    with pytest.raises(DeclarationError, match="not finite at any of 1000 random points"):
        wrong(ca.sqrt(-1 - q**2) * qd, q, qd, qdd)


def test_the_angular_velocity_of_a_body_in_space_is_refused():
    (q, qd, qdd), w = symbols(3), ca.SX.sym("w", 3)
    given = ca.dot(INERTIA, w**2) / 2, ca.SX(0), q, qd, qdd
    says = (
        r"velocity_graphs: velocities 0, 1, 2 \(counted from 0\) are not integrable.*"
        "use the velocities of points or axes"
    )
    with pytest.raises(DeclarationError, match=says):
        LagrangeSystem(*given, velocities=w, velocity_graphs=turning(q, qd)[0])


def test_the_rates_of_a_body_s_axes_give_euler_s_equations():
    """I w' + w x I w about the body's axes, and what of it works along each angle: no energy in it.

    E = sum J_k |e_k'|^2 / 2 with J_k = (sum I) / 2 - I_k: what lies along each axis.
    """
    (q, qd, qdd), w = symbols(3), ca.SX.sym("w", 9)
    about, change = turning(q, qd)
    energy = ca.dot(np.repeat(INERTIA.sum() / 2 - INERTIA, 3), w**2) / 2
    given = energy, ca.SX(0), q, qd, qdd
    along, _ = LagrangeSystem(*given, velocities=w, velocity_graphs=ca.vec(change)).terms()
    change = ca.jtimes(about, ca.vertcat(q, qd), ca.vertcat(qd, qdd))
    couple = INERTIA * change + ca.cross(about, INERTIA * about)
    f = ca.Function("f", [q, qd, qdd], [along, ca.jacobian(about, qd).T @ couple])
    for seed in range(5):
        found, expected = (x.full() for x in f(*np.random.default_rng(seed).normal(size=(3, 3))))
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)


def test_rates_of_turning_in_space_are_no_rates_of_coordinates():
    """Angles by their kinematic equations, q' for the body's rates: Lagrange's equations do not
    hold for these.
    """
    q, w, wd = symbols(3)
    about, _ = turning(q, w)
    tangent = ca.inv(ca.jacobian(about, w))
    with pytest.raises(
        DeclarationError,
        match=r"tangent: coordinates 0, 1, 2 \(counted from 0\) are not integrable",
    ):
        LagrangeSystem(ca.dot(INERTIA, w**2) / 2, ca.SX(0), q, w, wd, tangent=tangent)


def test_a_drift_that_belongs_to_no_motion_is_refused():
    p, qd, qdd, t = ca.SX.sym("p", 2), ca.SX.sym("qd"), ca.SX.sym("qdd"), ca.SX.sym("t")
    tangent = ca.vertcat(-p[1], p[0])
    LagrangeSystem(qd**2, p[0], p, qd, qdd, tangent=tangent, drift=ca.cos(t) * tangent, time=t)
    with pytest.raises(
        DeclarationError,
        match=r"tangent and drift: coordinate 1 \(counted from 0\) is not integrable",
    ):
        LagrangeSystem(qd**2, p[0], p, qd, qdd, tangent=tangent, drift=ca.vertcat(1, 0), time=t)


def test_the_rates_of_coordinates_may_be_a_graph_in_place_of_a_matrix():
    p, qd, qdd, t = ca.SX.sym("p", 2), ca.SX.sym("qd"), ca.SX.sym("qdd"), ca.SX.sym("t")
    tangent, drift = ca.vertcat(-p[1], p[0]), 3.0 * ca.vertcat(-p[1], p[0])
    given = qd**2 * p[0], p[1], p, qd, qdd
    by_matrix = LagrangeSystem(*given, tangent=tangent, drift=drift, time=t)
    by_graph = LagrangeSystem(*given, coordinate_rates=tangent * qd + drift, time=t)
    either = ca.vertcat(by_matrix.terms()[0], by_graph.terms()[0])
    first, second = ca.Function("f", [p, qd, qdd], [either])([0.6, 0.8], 2.0, -1.0).full().ravel()
    assert first == second
    with pytest.raises(DeclarationError, match="cannot be combined with tangent and drift"):
        LagrangeSystem(*given, tangent=tangent, coordinate_rates=tangent * qd)
    with pytest.raises(DeclarationError, match="coordinate_rates: coordinate 0 "):
        LagrangeSystem(*given, coordinate_rates=ca.vertcat(p[1] * qd, 1), time=t)
