"""Residuals of loops' equations after their solution, and the length relative to which a residual
is large.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.scalars import column
from ..base.symbolic import symbolic
from ..model.mechanism import Mechanism
from .joints import held_directions, off
from .multibody import LoopEquations, Multibody

if TYPE_CHECKING:
    from .blocks import Block, Equation


def loop_residual(multibody: Multibody, block: Block, length: ca.SX) -> ca.SX:
    """Residual of a block's equations in one number [m]: distances as they are, others over their
    slopes, times a ``length``.
    """
    total = ca.SX(0)
    for equation in block.equations:
        if equation.loop.declared:
            total += length * equation.residual / _slope(multibody, equation, length)
        elif equation.aligns:
            total += length * (ca.fabs(equation.residual) + _turned(multibody, equation))
        else:
            total += equation.residual
    return total


def lengths(multibody: Multibody, block: Block, length: ca.SX, *, sizes: bool = True) -> ca.SX:
    """Factors that make lengths [m] of a block's equations, a column: directions are multiplied by
    a ``length``, constraints by that over their slopes, with or without ``sizes`` of coordinates.
    """
    found = []
    for equation in block.equations:
        held = held_directions(equation.loop.joint) if equation.loop.joint is not None else 0
        if equation.loop.declared:
            found.append(length / _slope(multibody, equation, length, sizes=sizes))
        else:
            directs = equation.row >= equation.loop.residual.numel() - held
            found.append(length if directs else ca.SX(1))
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


def reach(mechanism: Mechanism) -> ca.SX:
    """All links end to end [m], or one metre where there is none,
    as an expression in parameters.
    """
    return (
        sum((ca.SX(link.length) for link in mechanism.links.values()), ca.SX(0))
        if mechanism.links
        else ca.SX(1)
    )


@symbolic
def extent(mechanism: Mechanism) -> ca.SX:
    """The links end to end, and how far from the origin they are joined to the ground [m]: a gap is
    small or large beside it.
    """
    points = (point for joint in mechanism.joints.values() for point in (joint.parent, joint.child))
    places = [
        ca.fabs(ca.SX(place))
        for point in points
        if point.body is mechanism.ground
        for place in point.place
    ]
    return reach(mechanism) + (ca.mmax(ca.vertcat(*places)) if places else 0)


def units(loop: LoopEquations, size: float) -> Array:
    """Units of a loop's residuals: the mechanism's size [m], or 1 for directions."""
    held = held_directions(loop.joint) if loop.joint is not None else 0
    return np.array([size] * (loop.residual.numel() - held) + [1.0] * held)


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
