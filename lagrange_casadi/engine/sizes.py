"""Sizes of a mechanism [m], beside which lengths, gaps and residuals are large or small."""

from __future__ import annotations

import casadi as ca
import numpy as np

from ..base.arrays import Flags
from ..base.symbolic import symbolic
from ..model.declaration import Declaration
from .joint_closure import held_directions
from .multibody import LoopEquations


def reach(declared: Declaration) -> ca.SX:
    """All links end to end [m], or one metre where there is none,
    as an expression in parameters.
    """
    return (
        sum((ca.SX(link.length) for link in declared.links.values()), ca.SX(0))
        if declared.links
        else ca.SX(1)
    )


@symbolic
def extent(declared: Declaration) -> ca.SX:
    """The links end to end, and how far from the origin they are joined to the ground [m]: a gap is
    small or large beside it.
    """
    points = (point for joint in declared.joints.values() for point in (joint.parent, joint.child))
    places = [
        ca.fabs(ca.SX(place))
        for point in points
        if point.body is declared.ground
        for place in point.place
    ]
    return reach(declared) + (ca.mmax(ca.vertcat(*places)) if places else 0)


def directs(loop: LoopEquations) -> Flags:
    """The equations of a loop that hold directions, marked: its last ones."""
    held = held_directions(loop.joint) if loop.joint is not None else ()
    return np.arange(loop.residual.numel())[::-1] < len(held)
