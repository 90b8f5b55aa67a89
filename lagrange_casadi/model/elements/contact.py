"""Constraints whose multiplier acts where parts touch, and the power that friction takes there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca

from ..constraints import Constraint
from ..declared_parts import Expression
from ..mechanism import Mechanism
from ..meshes import Loss


def touching(mechanism: Mechanism, name: str, phi: Expression, **more: Any) -> Constraint:
    """Declare a constraint phi = 0 with more of what a :class:`.Constraint` has.

    Raises :class:`.DeclarationError` for a name that is taken.
    """
    mechanism.constraints[name] = made = replace(mechanism.constraint(name, phi), **more)
    return made


def output_loss(
    mechanism: Mechanism, constraint: Constraint, loss: Loss, factor: Expression
) -> None:
    """Declare the output NAME_loss: the power that friction takes [W], by a ``factor`` of the
    rate.
    """
    rate = sum((sign * mechanism.rate(joint) for sign, joint in loss.rotations), ca.SX(0))
    power = mechanism.results.multiplier(constraint) * rate
    taken = factor * (loss.arm * ca.fabs(power) + loss.lean * power)
    mechanism.output(f"{constraint.name}_loss", taken, unit="W")
