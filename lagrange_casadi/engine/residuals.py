"""Residuals of loops' equations after their solution."""

from __future__ import annotations

import casadi as ca

from ..base.arrays import Expression
from ..base.scalars import column
from .blocks import Block, Equation
from .joint_closure import off
from .multibody import Multibody
from .sizes import directs, reach


def loop_residual(multibody: Multibody, block: Block, length: ca.SX) -> ca.SX:
    """Residual of a block's equations in one number [m]: by their :func:`lengths`; and a direction
    is missed by a half turn, which has no sine.
    """
    total = ca.SX(0)
    factors = ca.vertsplit(lengths(multibody, block, length))
    for equation, factor in zip(block.equations, factors, strict=True):
        if equation.aligns:
            total += factor * (ca.fabs(equation.residual) + _turned(multibody, equation))
        else:
            total += factor * equation.residual
    return total


def lengths(multibody: Multibody, block: Block, length: ca.SX, *, sizes: bool = True) -> ca.SX:
    """Factors that make lengths [m] of a block's equations, a column: directions are multiplied by
    a ``length``, constraints by that over their slopes, with or without ``sizes`` of coordinates.
    """
    found = []
    for equation in block.equations:
        if equation.loop.declared:
            found.append(length / _slope(multibody, equation, length, sizes=sizes))
        else:
            found.append(length if directs(equation.loop)[equation.row] else ca.SX(1))
    return column(found)


def redundancy_residual(multibody: Multibody, block: Block) -> Expression:
    """The largest gap of a block, over the length of all links; and a direction is missed by a half
    turn, which has no sine.

    Of rounded axes and places, that of the equations as declared, in all coordinates.
    """
    length, gaps = reach(multibody.mechanism), block.residual
    if multibody.mechanism.rounding:
        gaps = column(equation.loop.residual[equation.row] for equation in block.equations)
    found = ca.mmax(ca.fabs(lengths(multibody, block, length) * gaps)) / length
    for equation in block.equations:
        if equation.aligns:
            found = ca.fmax(found, _turned(multibody, equation))
    return found


def _turned(multibody: Multibody, equation: Equation) -> Expression:
    """One less the cosine of what a direction is off."""
    joint = equation.loop.joint
    assert joint is not None
    return off(joint, *(multibody.frames[body.name] for body in joint.bodies))


def _slope(multibody: Multibody, equation: Equation, length: ca.SX, *, sizes: bool = True) -> ca.SX:
    """Change of an equation with all coordinates: angles by a radian, slides by a length. With
    ``sizes`` either by its own size too, as a sum; else as the root of the sum of squares, which is
    smooth and repeats as the mechanism does.
    """
    changes = []
    for coordinate in multibody.coordinates:
        unit = length if coordinate.kind == "slide" else ca.SX(1)
        size = ca.fabs(coordinate.value) if sizes and coordinate.kind != "ball" else 0
        changes.append(ca.jacobian(equation.residual_rate, coordinate.rate) * (unit + size))
    return ca.norm_1(column(changes)) if sizes else ca.norm_2(column(changes))
