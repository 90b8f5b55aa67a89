"""Lagrange terms of systems that are no linkages, against their textbook equations."""

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


def test_coordinates_may_be_a_cosine_and_a_sine():
    """A pendulum by its angle, and by (cos, sin) with their tangent, is the same pendulum."""
    q, qd, qdd, c, s = (ca.SX.sym(n) for n in ("q", "qd", "qdd", "c", "s"))
    kinetic = 2.0 * qd**2 * (1.0 + 0.3 * ca.cos(q)) / 2
    by_angle = LagrangeSystem(kinetic, -3.0 * ca.sin(q), q, qd, qdd)
    direction = ca.vertcat(c, s)
    by_pair = LagrangeSystem(
        2.0 * qd**2 * (1.0 + 0.3 * c) / 2, -3.0 * s, direction, qd, qdd, tangent=ca.vertcat(-s, c)
    )
    angle, rate, acceleration = 0.8, -1.2, 0.5
    one = numbers(by_angle, by_angle.terms()[0], symbols=[angle, rate, acceleration])
    two = numbers(
        by_pair, by_pair.terms()[0], symbols=[np.cos(angle), np.sin(angle), rate, acceleration]
    )
    np.testing.assert_allclose(one, two, rtol=1e-15)


def double_pendulum(velocities):
    """Two rods by their absolute angles, the lower one's bearing released by a mobility; E over
    coordinates, or over velocities.
    """
    q, qd, qdd, e, ed, w = (ca.SX.sym(n, 2) for n in ("q", "qd", "qdd", "e", "ed", "w"))
    l1, l2, m1, m2, inertia, g = 0.7, 0.4, 1.3, 0.8, 0.05, 9.81
    upper = l1 * ca.vertcat(ca.sin(q[0]), -ca.cos(q[0]))
    lower = upper + e + l2 * ca.vertcat(ca.sin(q[1]), -ca.cos(q[1]))
    speeds = [ca.jtimes(place, ca.vertcat(q, e), ca.vertcat(qd, ed)) for place in (upper, lower)]
    # Partly over velocities, partly over rates and coordinates: only the lower mass is written in
    # w.
    own = m1 * ca.sumsqr(speeds[0]) / 2 + inertia * qd[1] ** 2 * (1 + 0.1 * ca.cos(q[0])) / 2
    fields = {
        "coordinates": q,
        "rates": qd,
        "accelerations": qdd,
        "mobilities": e,
        "mobility_rates": ed,
    }
    fields["force_function"] = -g * (m1 * upper[1] + m2 * lower[1])
    if velocities:
        fields |= {"velocities": w, "velocity_graphs": speeds[1]}
    return LagrangeSystem(
        kinetic=own + m2 * ca.sumsqr(w if velocities else speeds[1]) / 2, **fields
    )


def test_energy_over_velocities_gives_the_same_terms():
    one, two = (numbers(s, *s.terms()) for s in (double_pendulum(False), double_pendulum(True)))
    np.testing.assert_allclose(two, one, rtol=1e-14)


def test_energy_over_velocities_and_the_coordinates_too():
    """A mass that depends on where it is, moving at w = q': R = m q'' + m' q'^2 / 2, however the
    energy is split.
    """
    q, qd, qdd, w = (ca.SX.sym(n) for n in ("q", "qd", "qdd", "w"))
    mass = 1 + ca.sin(q) ** 2
    over_rates = LagrangeSystem(mass * qd**2 / 2, ca.SX(0), q, qd, qdd)
    mixed = LagrangeSystem(
        mass * w * qd / 2, ca.SX(0), q, qd, qdd, velocities=w, velocity_graphs=qd
    )
    one, two = (numbers(s, s.terms()[0], symbols=[0.7, -0.4, 1.3]) for s in (over_rates, mixed))
    np.testing.assert_allclose(two, one, rtol=1e-14)


def test_fields_and_forces_work_along_velocities():
    """Gravity as the acceleration of a field, and a force on a velocity, are what U and Q* are."""
    q, qd, qdd, w = (ca.SX.sym(n) for n in ("q", "qd", "qdd", "w"))
    height_rate = ca.cos(q) * qd
    height_acceleration = ca.cos(q) * qdd - ca.sin(q) * qd**2
    system = LagrangeSystem(
        3.0 * w**2 / 2,
        ca.SX(0),
        q,
        qd,
        qdd,
        velocities=w,
        velocity_graphs=height_rate,
        velocity_rates=height_acceleration + 9.81,
        velocity_forces=2.0,
    )
    (found,) = numbers(system, system.terms()[0], symbols=[0.7, -0.4, 1.3])
    rise = np.cos(0.7) * 1.3 - np.sin(0.7) * 0.16
    assert found == pytest.approx(np.cos(0.7) * (3.0 * (rise + 9.81) - 2.0), rel=1e-14)


def test_multipliers_work_on_constraints():
    """A bead held on the line y = x by a constraint: the multiplier enters with the gradient of Phi
    (paper eq. 8).
    """
    q, qd, qdd, lam = ca.SX.sym("q", 2), ca.SX.sym("qd", 2), ca.SX.sym("qdd", 2), ca.SX.sym("lam")
    system = LagrangeSystem(
        ca.sumsqr(qd) / 2, -9.81 * q[1], q, qd, qdd, constraints=q[1] - q[0], multipliers=lam
    )
    along, _ = system.terms()
    f = ca.Function("f", [qdd, lam], [along])
    np.testing.assert_allclose(f([1.0, 2.0], 5.0).full().ravel(), [1.0 + 5.0, 2.0 + 9.81 - 5.0])


def test_other_forces_are_taken_off():
    q, qd, qdd, e, ed = (ca.SX.sym(n) for n in ("q", "qd", "qdd", "e", "ed"))
    system = LagrangeSystem(
        (qd + ed) ** 2 / 2,
        ca.SX(0),
        q,
        qd,
        qdd,
        mobilities=e,
        mobility_rates=ed,
        forces=-0.5 * qd,
        mobility_forces=7.0 * q,
    )
    along, across = system.terms()
    f = ca.Function("f", [q, qd, qdd], [along, across])
    assert [float(x) for x in f(2.0, 3.0, 4.0)] == [4.0 + 1.5, 4.0 - 14.0]


def test_one_reverse_sweep_serves_any_number_of_mobilities():
    """Instructions for k mobilities grow by little more than k times what one of them needs by
    itself.
    """

    def count(k):
        q, qd, qdd = (ca.SX.sym(n, 4) for n in ("q", "qd", "qdd"))
        e, ed = ca.SX.sym("e", k), ca.SX.sym("ed", k)
        place = ca.cumsum(ca.sin(ca.cumsum(q))) + ca.repmat(ca.sum1(e), 4, 1)
        speed = ca.jtimes(place, ca.vertcat(q, e), ca.vertcat(qd, ed))
        system = LagrangeSystem(
            ca.sumsqr(speed), ca.sum1(place), q, qd, qdd, mobilities=e, mobility_rates=ed
        )
        return ca.Function("f", [q, qd, qdd], list(system.terms()), {"cse": True}).n_instructions()

    assert count(16) - count(1) < count(1)


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
