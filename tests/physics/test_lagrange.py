"""Lagrange terms of systems that are no linkages, against their textbook equations, also where time
itself moves them.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from lagrange_casadi import LagrangeSystem
from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

NUMBERS = np.array([0.7, -0.4, 1.3, 0.9, -1.1, 0.6])


def numbers(system, *results, symbols=None):
    inputs = ca.vertcat(system.coordinates, system.rates, system.accelerations)
    f = ca.Function("f", [inputs], [ca.densify(ca.vertcat(*results))])
    return f(NUMBERS[: inputs.numel()] if symbols is None else symbols).full().ravel()


def crane(pushed=0.0):
    """A trolley of mass M drives along a rail, where it is ``pushed``; a rope of length L carries a
    load m, which is pushed along the rope.

    The rope's tension is wanted.
    """
    M, m, L, g = 20.0, 3.0, 2.0, 9.81
    x, a = ca.SX.sym("x"), ca.SX.sym("a")
    xd, ad = ca.SX.sym("xd"), ca.SX.sym("ad")
    xdd, add = ca.SX.sym("xdd"), ca.SX.sym("add")
    e, ed = ca.SX.sym("e"), ca.SX.sym("ed")
    place = ca.vertcat(x + (L + e) * ca.sin(a), -(L + e) * ca.cos(a))
    speed = ca.jtimes(place, ca.vertcat(x, a, e), ca.vertcat(xd, ad, ed))
    w = ca.SX.sym("w", 2) if pushed else speed
    by = {"velocities": w, "velocity_graphs": speed, "forces": ca.vertcat(pushed, 0)}
    by = {**by, "mobility_forces": pushed} if pushed else {}
    return LagrangeSystem(
        kinetic=M * xd**2 / 2 + m * ca.sumsqr(w) / 2,
        force_function=-m * g * place[1],
        coordinates=ca.vertcat(x, a),
        rates=ca.vertcat(xd, ad),
        accelerations=ca.vertcat(xdd, add),
        mobilities=e,
        mobility_rates=ed,
        **by,
    ), (M, m, L, g)


@pytest.mark.parametrize("pushed", [0.0, 7.0])
def test_rope_tension_of_a_crane(pushed):
    """An extension of the rope releases its tension: -T = m (L'' - ...) by Newton's second law
    along the rope.
    """
    system, (M, m, L, g) = crane(pushed)
    along, across = system.terms()
    _, a, _, ad, xdd, add = NUMBERS
    drive, swing, released = numbers(system, along, across)
    assert drive == pytest.approx(
        (M + m) * xdd + m * L * (add * np.cos(a) - ad**2 * np.sin(a)) - pushed, rel=1e-14
    )
    assert swing == pytest.approx(m * L * (L * add + xdd * np.cos(a) + g * np.sin(a)), rel=1e-14)
    tension = m * (g * np.cos(a) + L * ad**2 - xdd * np.sin(a))
    assert released == pytest.approx(-tension - pushed, rel=1e-14)


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


G, L = 9.81, 0.8


def shaken(f, q, t):
    """Where a pendulum is whose pivot is shaken to the side and lifted."""
    return f.vertcat(0.3 * f.sin(5 * t) + L * f.sin(q), 0, 0.1 * t**3 - L * f.cos(q))


def turned(f, q, t):
    """Where a bead is on a hoop that turns about its upright diameter, ever faster."""
    way = 2 * t + t**2
    return L * f.vertcat(f.sin(q) * f.cos(way), f.sin(q) * f.sin(way), -f.cos(q))


MOVED = {
    shaken: lambda q, qdd, t: L * qdd - 7.5 * np.sin(5 * t) * np.cos(q) + (G + 0.6 * t) * np.sin(q),
    turned: lambda q, qdd, t: (
        L * qdd - L * (2 + 2 * t) ** 2 * np.sin(q) * np.cos(q) + G * np.sin(q)
    ),
}
"""Accelerations along the way of the coordinate, less gravity's: equations of textbooks."""


@pytest.mark.parametrize("place", MOVED)
@pytest.mark.parametrize("way", ["energy", "velocities", "both"])
def test_systems_that_time_moves(place, way):
    """The energy by rates and time, by velocities of their own, or by both."""
    q, qd, qdd, t = (ca.SX.sym(name) for name in ("q", "qd", "qdd", "t"))
    at, w = place(ca, q, t), ca.SX.sym("w", 3)
    speeds = ca.jtimes(at, ca.vertcat(q, t), ca.vertcat(qd, 1))
    told = {"velocities": w, "velocity_graphs": speeds} if way != "energy" else {}
    squared = {"energy": speeds, "velocities": w, "both": ca.vertcat(w[0], speeds[1], w[2])}[way]
    kinetic = 1.3 * ca.sumsqr(squared) / 2
    system = LagrangeSystem(kinetic, -1.3 * G * at[2], q, qd, qdd, time=t, **told)
    equation = ca.Function("equation", [q, qd, qdd, t], [system.terms()[0]])
    for state in np.random.default_rng(1).normal(size=(9, 4)):
        told = 1.3 * L * MOVED[place](state[0], state[2], state[3])
        assert float(equation(*state)) == pytest.approx(told, rel=1e-12, abs=1e-12)


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
