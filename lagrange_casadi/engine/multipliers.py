"""Multipliers of loops, constraints and non-holonomic rows, from the rows of Lagrange's equations
in which they are alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from ..base.scalars import column
from .blocks import Block
from .kinematics import Kinematics
from .mesh_forces import transmissions_of
from .multibody import LoopEquations, Multibody


def multipliers_of(
    multibody: Multibody, kinematics: Kinematics, along: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return lambda and mu: their symbols, their values, and the symbols of indeterminate forces.

    lambda comes from the undriven rows of R = Phi_q' lambda + A' mu (paper eq. 2, 8), the blocks of
    the loops last one first; mu from the driven rows that bear no effort.
    """
    rows = {c.name: along[i] for i, c in enumerate(multibody.coordinates)}
    symbols, values, free = ca.SX(0, 1), ca.SX(0, 1), ca.SX(0, 1)
    meshed = transmissions_of(multibody.mechanism)
    every = column(loop.multipliers for loop in multibody.loop_equations if loop.name not in meshed)
    for block, system in reversed(kinematics.systems):
        local = block.multipliers
        residual = column(rows[c.name] for c in block.unknown)
        residual = ca.substitute(residual, symbols, values)
        # What no equation of theirs moves, others may still be written in, with factors that
        # cancel.
        residual = ca.substitute(residual, every, 0)
        open_here = ca.SX.sym(f"free_{block.loop_equations[0].name}", system.free)
        free = ca.vertcat(free, open_here)
        found = system.solve_transposed(residual, open_here)
        if touching := [loop for loop in block.loop_equations if loop.name in meshed]:
            found, values = _where_they_touch(multibody, block, touching, found, values)
        symbols, values = ca.vertcat(local, symbols), ca.vertcat(found, values)
    if multibody.rows:
        mu = column(program.multipliers for program in multibody.rows)
        unaided = column(rows[program.row.replaces] for program in multibody.rows)
        unaided = ca.substitute(unaided, symbols, values)
        solved = ca.solve(ca.jacobian(unaided, mu), -ca.substitute(unaided, mu, 0))
        values = ca.substitute(values, mu, solved)
        symbols, values = ca.vertcat(symbols, mu), ca.vertcat(values, solved)
    return symbols, values, free


def _where_they_touch(
    multibody: Multibody,
    block: Block,
    touching: Sequence[LoopEquations],
    found: ca.SX,
    values: ca.SX,
) -> tuple[ca.SX, ca.SX]:
    """Multipliers of a block in which transmissions are, and of those before: with forces where
    their parts touch.

    ``found`` are multipliers of the equations, beside forces where they touch, which are symbols:
    those for which the equations' own are zero are looked for. They are the equations' own without
    them, where each acts in one mesh, for the two do the same work; and what presses apart does
    none.
    """
    rows = [k for k, equation in enumerate(block.equations) if equation.loop in touching]
    symbols = column(loop.multipliers for loop in touching)
    local = column(found[row] for row in rows)
    every = transmissions_of(multibody.mechanism)
    idle = column(transmission.symbol for transmission in every.values())
    local = ca.substitute(local, idle, 0)
    if all(len(transmission.meshes) == 1 for transmission in every.values()):
        others = column(loop.multipliers for loop in multibody.loop_equations if loop.name in every)
        solved = ca.substitute(local, others, 0)
    else:
        slopes = ca.jacobian(local, symbols)
        rest = ca.substitute(local, symbols, 0)
        solved = -ca.solve(slopes, rest)
    found, values = (ca.substitute(part, symbols, solved) for part in (found, values))
    for k, row in enumerate(rows):
        found[row] = solved[k]
    return found, values
