"""A planetary gear by wheels that roll."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
from mechanisms import pins_of

from lagrange_casadi import Mechanism, Scene, motion

ROLLING = {
    "sun": 0.03,
    "planet": 0.02,
    "turned": 40.0,
    "slow": 40.0 * 0.03 / (0.03 + 0.07),
    "torque": 90.0,
}
"""Radii [m], rates of sun and carrier [rad/s], and what the carrier drives [N m]."""


def rolling():
    """A sun drives a planet, which rolls in a ring that stands still, each mesh a row in velocities
    of what touches.
    """
    s, p, turned, slow = (ROLLING[name] for name in ("sun", "planet", "turned", "slow"))
    m = Mechanism("planetary")
    m.set_gravity(0, 0)
    torque = m.parameter("torque", ROLLING["torque"], "N m")
    sun = m.link("sun", length=s, mass=0.5, centre=(0, 0), inertia=2e-4)
    carrier = m.link("carrier", length=s + p, mass=0.4, centre=(0, 0), inertia=5e-4)
    planet = m.link("planet", length=p, mass=0.3, centre=(0, 0), inertia=6e-5)
    main, output, pin = pins_of(
        m, main=(m.ground, sun), output=(m.ground, carrier), pin=(carrier.tip, planet)
    )
    angle, (vx, vy) = m.direction(carrier), m.velocity(planet)
    along, spin = ca.cos(angle) * vy - ca.sin(angle) * vx, m.rate(output) + m.rate(pin)
    m.nonholonomic("inside", along - p * spin - s * m.rate(main), replaces=output)
    m.nonholonomic("outside", along + p * spin, replaces=pin)
    m.torque("load", carrier, -torque)
    steady = {"main": turned, "output": slow, "pin": -slow * (s + p) / p - slow}
    return Scene(
        m, {joint: motion.polynomial(0.0, rate) for joint, rate in steady.items()}, t=(0, 0.5, 51)
    )


def elsewhere():
    """The same, driven at its sun and at its planet's pin."""
    return replace(rolling(), drives={"main": 1.0, "pin": 2.0})


def called_as_rates():
    """An arm whose second drive is called as the rate of the first."""
    m = Mechanism("arm")
    upper, lower = (m.link(name, length=0.4, mass=1.0) for name in ("upper", "lower"))
    pins_of(m, pin=(m.ground, upper), pin_rate=(upper.tip, lower))
    moved = {"pin": motion.polynomial(0.1, 2.0), "pin_rate": motion.polynomial(0.2, 3.0)}
    return Scene(m, moved, t=(0.0, 1.0, 11))


SCENES = {"rolling_gear": rolling, "rolling_gear_elsewhere": elsewhere}
