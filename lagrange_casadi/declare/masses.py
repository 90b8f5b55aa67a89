"""Masses of parts as expressions of the parameters."""

from __future__ import annotations

from typing import Any

import casadi as ca

from ..errors import UnknownNameError
from .density import Density
from .mechanism import Mechanism
from .parts import Link, PointMass, RigidMass

ALL = "all"
"""What the mass of everything that moves is called."""


def mass_of(mechanism: Mechanism, part: str) -> Any:
    """The mass of a link or a point mass, or of ``all`` of them [kg]. Raises :class:`.UnknownNameError` for anything else."""
    bodies = {body.name: body for body in mechanism.moving}
    if part in bodies:
        return _mass(bodies[part])
    if part == ALL:
        return ca.SX(sum(map(_mass, mechanism.moving)))
    raise UnknownNameError("part with a mass", part, [*bodies, ALL])


def _mass(body: Any) -> Any:
    if isinstance(body, PointMass):
        return ca.SX(body.mass)
    assert isinstance(body, Link)
    if isinstance(body.mass, Density):
        return ca.SX(body.mass.tails(0.0, body.length)[0])
    assert isinstance(body.mass, RigidMass)
    return ca.SX(body.mass.mass)
