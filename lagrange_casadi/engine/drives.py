"""Efforts of drives where they are others than the joints whose motion is given.

Efforts tau along the drives' coordinates must leave nothing to be done along the coordinates whose
motion is given: R(tau) = R(0) + A tau = 0, a small linear system. Of more drives than motions, the
efforts are those with the least sum of w tau^2 (weighted least norm): tau = W^-1/2 x, with x of the
least length that satisfies (A W^-1/2) x = -R(0).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import casadi as ca

from ..base.arrays import Expression
from ..base.scalars import column
from .linear import LinearSystem

_ROUNDING = 1e-24
"""A ``hold`` below it is the square of a rounding."""


def pushed(moved: Sequence[str], drives: Mapping[str, Expression] | None) -> tuple[str, ...]:
    """The drives whose efforts are unknowns: all where they are too many, else those that are not
    at a joint that is ``moved``.
    """
    if drives is None:
        return ()
    return tuple(name for name in drives if len(drives) > len(moved) or name not in moved)


def solve_efforts(
    efforts: Mapping[str, Expression],
    needs: Mapping[str, Expression],
    weights: Mapping[str, Expression],
    units: Mapping[str, Expression],
) -> tuple[Expression, Expression]:
    """The values of efforts, by joint their symbols, that leave nothing of ``needs``, which are
    linear in them; and a number that is zero where the drives cannot make the motion, else
    positive: the square of how much of a motion moves the drives, and of how far they are from
    depending on each other.

    ``units`` are by joint what its coordinate is measured in, to decide whether a drive moves much
    of a motion or little.
    """
    symbols, residual = column(efforts.values()), column(needs.values())
    rest = ca.substitute(residual, symbols, ca.SX.zeros(symbols.numel()))
    lighter = column(1 / ca.sqrt(ca.SX(weights[name])) for name in efforts)
    effect = ca.densify(ca.jacobian(residual, symbols)).T
    system = LinearSystem.of(ca.diag(lighter) @ effect)
    values = lighter * system.solve_transposed(-rest, ca.SX.zeros(system.free))
    moved = (
        ca.diag(column(1 / ca.SX(units[name]) for name in efforts))
        @ effect
        @ ca.diag(column(units[name] for name in needs))
    )
    authority = system.volume * system.volume
    for j in range(len(needs)):
        authority *= ca.sumsqr(moved[:, j])
    return values, authority


def closure(authority: Expression, usual: float) -> Expression:
    """A ``hold`` as loops measure their distance from a dead centre, from 0 to 1: beside what it is
    where the motion starts.
    """
    beside = usual if _ROUNDING < usual < math.inf else 1.0
    return authority / (authority + beside)
