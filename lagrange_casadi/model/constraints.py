"""Constraints of a mechanism, frozen: holonomic ones, and non-holonomic rows."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..base.brief import Brief
from .meshes import Transmission


@dataclass(frozen=True, eq=False, repr=False)
class Constraint(Brief):
    """Phi(q, t) = 0 in joint coordinates (paper eq. 5).

    The multiplier of a ``transmission`` acts where its parts touch.

    Phi is differentiated twice, so its slopes must not jump; of a cam those of its ``lift`` alone,
    at the cam's angle: off the contact those of phi may jump as the normal turns, on it that counts
    for nothing.
    """

    name: str
    phi: ca.SX
    transmission: Transmission | None = None
    lift: ca.SX | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Row(Brief):
    """A non-holonomic row A(q) q' + b = 0 in joint coordinates and rates (paper eq. 3),
    in place of one drive's effort.
    """

    name: str
    expression: ca.SX
    replaces: str
