"""The side of a dead centre on which an over-constrained loop is.

Its equations are more than its unknowns, so their Jacobian has a volume, but no sign. The screws
have one, of all joints that follow: velocities of the bodies at a joint that closes a loop, beside
each other, about the origin, and the freedoms of that joint. Where such screws span the same space
in every posture, as those of parallel axes do and those of axes that meet, their determinant in a
fixed basis of that space changes its sign with the dead centre, and there alone.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from ..base.arrays import Expression
from ..base.scalars import column
from ..base.vectors import AXES, ZERO, Vector, cross, minus, times
from ..model.joints import Joint
from .blocks import Block
from .joint_closure import slides_of, turning_axes
from .linear import LinearSystem
from .multibody import Multibody
from .sampling import Sampling
from .sizes import reach
from .substitution import Numbers

_NOTHING = 1e-14


def signed_volume(multibody: Multibody, block: Block, numbers: Numbers) -> ca.SX | None:
    """The volume of a block's screws, whose sign is that of a determinant; None where they do not
    span the same space in every posture.

    ``numbers`` hold the start of the motion.
    """
    joints = [loop.joint for loop in block.loop_equations if loop.joint is not None]
    if len(joints) < len(block.loop_equations):
        return None
    parts = [_screws(multibody, block, joint) for joint in joints]
    screws = ca.horzcat(
        ca.vertcat(*(following for following, _ in parts)), ca.diagcat(*(own for _, own in parts))
    )
    found = np.reshape(numbers.of(ca.vec(screws)), screws.shape, order="F")
    basis = np.linalg.qr(found)[0]
    basis[np.abs(basis) < _NOTHING] = 0.0
    within = ca.DM(basis).T @ screws
    if not Sampling.of(multibody).vanish(screws - ca.DM(basis) @ within, screws):
        return None
    return ca.SX(LinearSystem.of(within).volume)


def _screws(multibody: Multibody, block: Block, joint: Joint) -> tuple[ca.SX, ca.SX]:
    """The screws, in ground axes, of a block's unknowns at a joint that closes a loop; and its own
    freedoms; speeds are over the length of all links.
    """
    length = reach(multibody.mechanism)
    parent, child = (multibody.frames[body.name] for body in joint.bodies)
    ends = (parent, joint.parent), (child, joint.child)

    def screw(turning: Vector, speed: Vector, at: Vector) -> Expression:
        return ca.vertcat(*turning, *times(1 / length, minus(speed, cross(turning, at))))

    near, far = (
        screw(frame.rate, frame.motion_of(point.place)[0], frame.place_of(point.place))
        for frame, point in ends
    )
    turns = AXES if joint.turns > 2 else turning_axes(joint, parent, child)
    own = [
        *(
            screw(axis, ZERO, frame.place_of(point.place))
            for axis, (frame, point) in zip(turns, (*ends, ends[0]), strict=False)
        ),
        *(screw(ZERO, parent.rotation.apply(axis), ZERO) for axis in slides_of(joint)),
    ]
    rates = column(c.rate for c in block.unknown)
    return ca.jacobian(ca.SX(far - near), rates), ca.densify(ca.SX(ca.horzcat(*own)))
