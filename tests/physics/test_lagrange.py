"""Lagrange terms of systems that are no linkages, against their textbook equations and, where time
itself moves them, against the vector equations: forces times virtual displacements, by
differences in 60 digits.
"""

from __future__ import annotations

import casadi as ca
import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lagrange_casadi import LagrangeSystem
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

NUMBERS = np.array([0.7, -0.4, 1.3, 0.9, -1.1, 0.6])


def numbers(system, *results, symbols=None):
    inputs = ca.vertcat(system.coordinates, system.rates, system.accelerations)
    f = ca.Function("f", [inputs], [ca.densify(ca.vertcat(*results))])
    return f(NUMBERS[: inputs.numel()] if symbols is None else symbols).full().ravel()


def crane():
    """A trolley of mass M drives along a rail; a rope of length L carries a load m.

    The rope's tension is wanted.
    """
    M, m, L, g = 20.0, 3.0, 2.0, 9.81
    x, a = ca.SX.sym("x"), ca.SX.sym("a")
    xd, ad = ca.SX.sym("xd"), ca.SX.sym("ad")
    xdd, add = ca.SX.sym("xdd"), ca.SX.sym("add")
    e, ed = ca.SX.sym("e"), ca.SX.sym("ed")
    place = ca.vertcat(x + (L + e) * ca.sin(a), -(L + e) * ca.cos(a))
    speed = ca.jtimes(place, ca.vertcat(x, a, e), ca.vertcat(xd, ad, ed))
    return LagrangeSystem(
        kinetic=M * xd**2 / 2 + m * ca.sumsqr(speed) / 2,
        force_function=-m * g * place[1],
        coordinates=ca.vertcat(x, a),
        rates=ca.vertcat(xd, ad),
        accelerations=ca.vertcat(xdd, add),
        mobilities=e,
        mobility_rates=ed,
    ), (M, m, L, g)


def test_rope_tension_of_a_crane():
    """An extension of the rope releases its tension: -T = m (L'' - ...) by Newton's second law
    along the rope.
    """
    system, (M, m, L, g) = crane()
    along, across = system.terms()
    _, a, _, ad, xdd, add = NUMBERS
    drive, swing, released = numbers(system, along, across)
    assert drive == pytest.approx(
        (M + m) * xdd + m * L * (add * np.cos(a) - ad**2 * np.sin(a)), rel=1e-14
    )
    assert swing == pytest.approx(m * L * (L * add + xdd * np.cos(a) + g * np.sin(a)), rel=1e-14)
    tension = m * (g * np.cos(a) + L * ad**2 - xdd * np.sin(a))
    assert released == pytest.approx(-tension, rel=1e-14)


@pytest.mark.parametrize(
    ("says", "change"),
    {
        "accelerations": {"kinetic": lambda s: s.kinetic * s.accelerations[0]},
        "force_function must not depend on rates": {"force_function": lambda s: s.rates[0]},
        "accelerations must have 2 entries, got 1": {"accelerations": lambda s: s.accelerations[0]},
        "mobility_rates must have 1 entries, got 0": {"mobility_rates": lambda s: ca.SX(0, 1)},
        "set 'tangent'": {"coordinates": lambda s: s.coordinates[0]},
        "tangent must have shape": {"tangent": lambda s: ca.SX.eye(3)},
        "coordinate_rates must have 2 entries, got 1": {"coordinate_rates": lambda s: s.rates[0]},
        "coordinate_rates must be linear in the rates": {"coordinate_rates": lambda s: s.rates**2},
        "rates must be symbols": {"rates": lambda s: 2 * s.rates},
        "forces must have 2 entries": {"forces": lambda s: ca.SX.zeros(3)},
        "multipliers must have 2 entries": {"constraints": lambda s: s.coordinates},
        "velocity_graphs must have 1 entries, got 0": {"velocities": lambda s: ca.SX.sym("w")},
        "velocity_forces must have 0 entries, got 2": {"velocity_forces": lambda s: s.rates},
    }.items(),
)
def test_misuse_is_named(change, says):
    system, _ = crane()
    ((name, make),) = change.items()
    with pytest.raises(DeclarationError, match=says):
        LagrangeSystem(**(system.__dict__ | {name: make(system)}))


G = 9.81


WAYS = ("energy", "velocities", "both")


class Functions:
    """The functions that places are written in, of CasADi or of mpmath."""

    def __init__(self, of):
        self.sin, self.cos, self.exp, self.sqrt = of.sin, of.cos, of.exp, of.sqrt


def lagrange(places, masses, n, way):
    """R(q, q', q'', t) of point masses at ``places(f, q, t)``, each of three components, the last
    one upward.
    """
    q, qd, qdd, t = ca.SX.sym("q", n), ca.SX.sym("qd", n), ca.SX.sym("qdd", n), ca.SX.sym("t")
    at = ca.vertcat(*(ca.vertcat(*place) for place in places(Functions(ca), ca.vertsplit(q), t)))
    speeds = ca.jtimes(at, ca.vertcat(q, t), ca.vertcat(qd, 1))
    weights = ca.vertcat(*(m for m in masses for _ in range(3)))
    fields = {"coordinates": q, "rates": qd, "accelerations": qdd, "time": t}
    fields["force_function"] = -G * sum(m * at[3 * k + 2] for k, m in enumerate(masses))
    w = ca.SX.sym("w", speeds.numel())
    over = {"energy": speeds, "velocities": w, "both": ca.vertcat(w[::2], speeds[1::2])}[way]
    order = {"both": [*range(0, speeds.numel(), 2), *range(1, speeds.numel(), 2)]}.get(
        way, list(range(speeds.numel()))
    )
    fields["kinetic"] = ca.dot(weights[order], over**2) / 2
    if way != "energy":
        fields |= {"velocities": w, "velocity_graphs": speeds}
    return ca.Function("R", [q, qd, qdd, t], [LagrangeSystem(**fields).terms()[0]])


def newton(places, masses, state, t):
    """The same by m (x'' - g) . dx/dq."""
    q, qd, qdd = ([mpmath.mpf(float(x)) for x in row] for row in state)
    t = mpmath.mpf(float(t))
    functions = Functions(mpmath)

    def path(s):
        return [a + b * (s - t) + c * (s - t) ** 2 / 2 for a, b, c in zip(q, qd, qdd, strict=True)]

    found = []
    for j in range(len(q)):
        total = mpmath.mpf(0)
        for k, m in enumerate(masses):
            for axis in range(3):

                def moved(s, k=k, axis=axis):
                    return places(functions, path(s), s)[k][axis]

                def displaced(x, j=j, k=k, axis=axis):
                    return places(functions, [*q[:j], x, *q[j + 1 :]], t)[k][axis]

                total += (
                    m
                    * (mpmath.diff(moved, t, 2) + (G if axis == 2 else 0))
                    * mpmath.diff(displaced, q[j])
                )
        found.append(float(total))
    return found


def assert_newton(places, masses, n, state, t):
    with mpmath.workdps(60):
        expected = newton(places, masses, state, t)
    for way in WAYS:
        found = lagrange(places, masses, n, way)(*state, t).full().ravel()
        np.testing.assert_allclose(
            found, expected, rtol=1e-12, atol=1e-12 * (1 + np.abs(expected).max())
        )


def pendulum(f, q, t):
    """On a pivot that is shaken to the side and lifted."""
    return [
        (0.3 * f.sin(5 * t) + 0.8 * f.sin(q[0]), 0, 0.1 * t**2 * f.cos(2 * t) - 0.8 * f.cos(q[0]))
    ]


def hoop(f, q, t):
    """A bead on a hoop that turns about its upright diameter, ever faster."""
    turned = 2 * t + t**2
    return [
        (0.5 * f.sin(q[0]) * f.cos(turned), 0.5 * f.sin(q[0]) * f.sin(turned), -0.5 * f.cos(q[0]))
    ]


def frame(f, q, t):
    """A mass by its coordinates in axes that turn, and whose origin is carried along."""
    c, s = f.cos(3 * t + f.sin(t)), f.sin(3 * t + f.sin(t))
    return [(f.sin(4 * t) + c * q[0] - s * q[1], s * q[0] + c * q[1], q[2] + t * q[0])]


def growing(f, q, t):
    """Two pendulums, one on the other, of ropes that are paid out."""
    l = 0.5 + 0.2 * t
    first = (l * f.sin(q[0]), 0, -l * f.cos(q[0]))
    return [first, (first[0] + f.exp(-t) * f.sin(q[1]), 0, first[2] - f.exp(-t) * f.cos(q[1]))]


SYSTEMS = [(pendulum, [1.3], 1), (hoop, [0.4], 1), (frame, [2.0], 3), (growing, [1.5, 0.7], 2)]


@pytest.mark.parametrize(
    ("places", "masses", "n"), SYSTEMS, ids=lambda x: getattr(x, "__name__", None)
)
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_systems_that_time_moves(places, masses, n, seed):
    generator = np.random.default_rng(seed)
    assert_newton(places, masses, n, generator.normal(size=(3, n)), generator.uniform(-2.0, 2.0))


def test_a_rheonomic_constraint_bears_what_newton_says():
    """A bead on a straight wire that is turned in a level plane: the wire pushes it by m (2 W r' +
    W' r).
    """
    q = ca.SX.sym("q", 2)
    qd = ca.SX.sym("qd", 2)
    qdd = ca.SX.sym("qdd", 2)
    lam = ca.SX.sym("lam")
    t = ca.SX.sym("t")
    m, angle = 0.8, 1.5 * t + t**2
    phi = ca.cos(angle) * q[1] - ca.sin(angle) * q[0]  # across the wire
    system = LagrangeSystem(
        m * ca.sumsqr(qd) / 2, ca.SX(0), q, qd, qdd, constraints=phi, multipliers=lam, time=t
    )
    (along, _) = system.terms()
    now, r, slide, out = 0.6, 0.9, -0.7, 2.0
    a, w, change = 1.5 * now + now**2, 1.5 + 2 * now, 2.0
    e, n = np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])
    place, speed = r * e, slide * e + r * w * n
    push = m * (2 * w * slide + change * r)
    acceleration = (out - r * w**2) * e + push / m * n
    f = ca.Function("f", [q, qd, qdd, lam, t], [along])
    left = f(place, speed, acceleration, push, now).full().ravel()
    np.testing.assert_allclose(
        left, m * (out - r * w**2) * e, rtol=1e-13
    )  # what pulls it along the wire, and nothing across


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"time": lambda s: 2 * s.coordinates[0]}, "time must be one symbol"),
        ({"time": lambda s: s.coordinates}, "time must be one symbol"),
        ({"time": lambda s: 0.0}, r"time must be one symbol, got 0"),
        (
            {"time": lambda s: s.coordinates[0]},
            "symbol 'q_0' stands both in coordinates and in time",
        ),
        (
            {"accelerations": lambda s: s.rates},
            "symbol 'qd_0' stands both in rates and in accelerations",
        ),
        ({"drift": lambda s: ca.SX.zeros(3)}, "drift must have 2 entries, got 3"),
        ({"tangent": lambda s: s.rates[0] * ca.SX.eye(2)}, "tangent must not depend on rates"),
        ({"drift": lambda s: s.rates}, "drift must not depend on rates"),
        (
            {"force_function": lambda s: s.velocities[0]},
            "force_function must not depend on velocities; move such terms into 'forces'",
        ),
        (
            {"force_function": lambda s: s.accelerations[0]},
            "force_function must not depend on accelerations",
        ),
        (
            {"velocity_graphs": lambda s: s.rates + s.velocities},
            "velocity_graphs must not depend on velocities",
        ),
        (
            {"velocity_graphs": lambda s: s.rates + s.accelerations},
            "velocity_graphs must not depend on accelerations",
        ),
        (
            {"velocity_graphs": lambda s: s.rates + ca.SX.sym("time")},
            "velocity_graphs depends on 'time': set time=time if",
        ),
        (
            {"constraints": lambda s: s.rates[0], "multipliers": lambda s: ca.SX.sym("l")},
            "constraints must not depend on rates",
        ),
    ],
)
def test_misuse_of_time_is_named(change, says):
    q, qd, qdd, w = (ca.SX.sym(name, 2) for name in ("q", "qd", "qdd", "w"))
    fields = {
        "kinetic": ca.sumsqr(w),
        "force_function": q[0],
        "coordinates": q,
        "rates": qd,
        "accelerations": qdd,
        "velocities": w,
        "velocity_graphs": qd,
    }
    system = LagrangeSystem(**fields)
    with pytest.raises(DeclarationError, match=says):
        LagrangeSystem(**(fields | {name: make(system) for name, make in change.items()}))
