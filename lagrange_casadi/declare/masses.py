"""Masses of parts as expressions of the parameters."""

from __future__ import annotations

import casadi as ca

from .density import Density
from .mechanism import Mechanism
from .parts import Link, PointMass, RigidMass

ALL = "all"
"""Name of the mass of everything that moves."""


def masses_of(mechanism: Mechanism) -> ca.SX:
    """The masses of its links and point masses, in their order, and last that of all of them [kg],
    in a column.
    """
    masses = [_mass(body) for body in mechanism.moving]
    return ca.densify(ca.vertcat(*masses, sum(masses)))


def _mass(body: Link | PointMass) -> ca.SX:
    if isinstance(body, PointMass):
        return ca.SX(body.mass)
    assert isinstance(body, Link)
    if isinstance(body.mass, Density):
        return ca.SX(body.mass.tails(0.0, body.length)[0])
    assert isinstance(body.mass, RigidMass)
    return ca.SX(body.mass.mass)
