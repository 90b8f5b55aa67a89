"""Spherical joints that loops set: their body's directions are unknowns themselves, so that no
posture of it is special.

Three turns about axes lose one where the second is at a right angle (gimbal lock). A joint whose
turns nothing drives, reports or loads needs none of them. Its body has three axes, and the
components of its angular velocity on these for rates:

    x' = w_z y - w_y z,    y' = w_x z - w_z x,    z' = w_y x - w_x y.

Newton's method finds the axes by a quaternion, which it turns by a small rotation a step and keeps
at length one (E. Hairer, C. Lubich and G. Wanner, *Geometric Numerical Integration*, 2006, on Lie
groups). Gaps hold its direction alone, not its length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.rotation import Rotation, direction
from ..model.joints import Joint


@dataclass(frozen=True, eq=False)
class SphericalCoordinates:
    """The body that hangs on a joint with three turns, and is on no other: its ``axes`` in ground
    axes, nine symbols.

    It hangs on the body ``near``, in ``reverse`` where the tree runs from the joint's child to its
    parent. ``side`` stands for the sign of the cosine of the second of the three turns that are
    reported of it.
    """

    joint: Joint
    near: str
    reverse: bool
    axes: Any
    side: Any

    @classmethod
    def of(cls, joint: Joint, near: str, *, reverse: bool) -> SphericalCoordinates:
        """Make it for a joint."""
        axes = ca.vertcat(*(ca.SX.sym(f"{joint.name}_{axis}{k}") for axis in "xyz" for k in "xyz"))
        return cls(joint, near, reverse, axes, ca.SX.sym(f"{joint.name}_side"))

    @property
    def rotation(self) -> Rotation:
        """Rotation of the body."""
        a, b, c, d, e, f, g, h, i = ca.vertsplit(self.axes)
        return Rotation((a, b, c), (d, e, f), None, (g, h, i))

    def changes(self, rates: Sequence[Expression]) -> tuple[Expression, Expression, Expression]:
        """The rates of the axes, by those about them."""
        (x, y, z), (p, q, r) = (self.axes[3 * k : 3 * k + 3] for k in range(3)), rates
        return r * y - q * z, p * z - r * x, q * x - p * y

    def turned_by(self, turns: Sequence[float], base: Rotation) -> Expression:
        """The axes of the body for its joint's three turns [rad] and for what it hangs on, one
        column.
        """
        turned = Rotation()
        for axis, turn in zip(self.joint.triad, turns, strict=True):
            turned = turned.then(Rotation.about(axis, *direction(turn), turn))
        zero = self.joint.turned
        found = (
            base.then(zero.inverse).then(turned.inverse)
            if self.reverse
            else base.then(turned).then(zero)
        )
        return ca.vertcat(*found.x, *found.y, *found.z)


def axes_of(quaternion: ca.SX) -> ca.SX:
    """The three axes that a quaternion (w, x, y, z) of any length turns to, nine expressions."""
    w, x, y, z = ca.vertsplit(quaternion)
    twice = 2 / ca.sumsqr(quaternion)
    wx, wy, wz = (twice * w * part for part in (x, y, z))
    xx, xy, xz = (twice * x * part for part in (x, y, z))
    yy, yz, zz = twice * y * y, twice * y * z, twice * z * z
    return ca.vertcat(
        1 - (yy + zz),
        xy + wz,
        xz - wy,
        xy - wz,
        1 - (xx + zz),
        yz + wx,
        xz + wy,
        yz - wx,
        1 - (xx + yy),
    )


def turn(quaternion: Expression, rotation: Expression) -> Expression:
    """A quaternion turned by a rotation about its axes [rad], of length one."""
    (w, x, y, z), (a, b, c) = ca.vertsplit(quaternion), ca.vertsplit(rotation / 2)
    moved = ca.vertcat(
        w - x * a - y * b - z * c,
        x + w * a - z * b + y * c,
        y + z * a + w * b - x * c,
        z - y * a + x * b + w * c,
    )
    return moved / ca.sqrt(ca.sumsqr(moved))


def quaternion_of(axes: Array) -> list[float]:
    """The quaternion of three axes, the rows of a matrix, from the products of its parts with the
    largest one, so that nothing cancels (Shepperd 1978).
    """
    trace, twist = np.trace(axes), axes - axes.T
    across = np.array([[twist[1, 2], twist[2, 0], twist[0, 1]]])
    along = axes + axes.T + (1.0 - trace) * np.eye(3)
    products = np.block([[np.array([[1.0 + trace]]), across], [across.T, along]])
    found = products[np.argmax(np.diag(products))]
    return [float(part) for part in found / np.linalg.norm(found)]
