"""The three angles of a joint, computed from the axes of its bodies: reported, not prescribed.

With the first axis u of the parent, the third one W of the child and the second one V at right
angles to both, the relative angular velocity is a' u + b' V + c' W. If the second angle is a right
angle, u and W coincide (gimbal lock), and only the sum or difference of the other two angles is
determined. Near gimbal lock the angles are as accurate as the digits allow; in it they are not
reported.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from ..base.frames import Frame
from ..base.vectors import Expression, Vector, cross, dot, minus, times
from ..model.joints import Joint

LOCKED = 1e-12
"""Square of the cosine of the second angle below which the others are indeterminate."""


@dataclass(frozen=True, eq=False)
class ThreeRotations:
    """The turns of a joint with three, between its parent and its child; ``side`` is the sign of
    the cosine of the second.
    """

    joint: Joint
    parent: Frame
    child: Frame
    side: Any

    @cached_property
    def _axes(self) -> tuple[tuple[Vector, ...], tuple[Vector, ...]]:
        """The joint's directions as the parent carries them, and as the child
        does, in ground axes.
        """
        zero = self.joint.turned
        carried = tuple(self.parent.rotation.apply(direction) for direction in self.joint.triad)
        return carried, tuple(
            self.child.rotation.apply(zero.resolve(direction)) for direction in self.joint.triad
        )

    @cached_property
    def _second(self) -> tuple[Expression, Expression, Expression]:
        """Sine of the second turn; the square of its cosine, from what is small with it; and its
        cosine.
        """
        (u, _, _), (x, y, w) = self._axes
        across = dot(u, x), dot(u, y)
        squared = across[0] * across[0] + across[1] * across[1]
        return dot(u, w), squared, self.side * ca.sqrt(squared)

    @property
    def locked(self) -> Expression:
        """Above zero if the angles are indeterminate, otherwise zero."""
        return 1 - ca.fmin(1, self._second[1] / LOCKED)

    @property
    def angles(self) -> tuple[Expression, Expression, Expression]:
        """The turns [rad], the first and the third from -pi to pi, the second at most a right angle
        from 0, or from pi.
        """
        (u, v, w), (x, y, third) = self._axes
        sine, _, cosine = self._second
        side = self.side
        return (
            ca.atan2(-side * dot(v, third), side * dot(w, third)),
            ca.atan2(sine, cosine),
            ca.atan2(-side * dot(u, y), side * dot(u, x)),
        )

    @cached_property
    def rates(self) -> tuple[Expression, Expression, Expression]:
        """Rates of the angles."""
        return self._along(minus(self.child.rate, self.parent.rate))

    @property
    def accelerations(self) -> tuple[Expression, Expression, Expression]:
        """Accelerations of the angles: from the relative angular acceleration, less the
        contribution of the axes' own motion.
        """
        (u, *_), (*_, third) = self._axes
        first, second, last = self.rates
        change = minus(self.child.angular, self.parent.angular)
        carried, middle = self.parent.rate, self._middle
        under = tuple(rate + first * along for rate, along in zip(carried, u, strict=True))
        change = minus(change, times(first, cross(carried, u)))
        change = minus(change, times(second, cross((under[0], under[1], under[2]), middle)))
        return self._along(minus(change, times(last, cross(self.child.rate, third))))

    @cached_property
    def _inverse(self) -> Expression:
        """One over the square of the cosine; of what is locked a number."""
        squared = self._second[1]
        share = ca.fmin(1, squared / LOCKED)
        return share / ca.fmax(squared, LOCKED)

    @cached_property
    def _middle(self) -> Vector:
        """The second axis."""
        (u, *_), (*_, third) = self._axes
        return times(self._second[2] * self._inverse, cross(third, u))

    def _along(self, turning: Vector) -> tuple[Expression, Expression, Expression]:
        """The components of a vector along the three axes."""
        (u, *_), (*_, third) = self._axes
        sine = self._second[0]
        about, along = dot(turning, u), dot(turning, third)
        return (
            (about - sine * along) * self._inverse,
            dot(turning, self._middle),
            (along - sine * about) * self._inverse,
        )
