"""Places and axes: where a body, or a side of a joint, is on some other frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from ...base.arrays import Array


@dataclass(frozen=True, eq=False)
class Frame:
    """A place [m] and three axes, the columns of a rotation, on some other frame."""

    place: Array = field(default_factory=lambda: np.zeros(3))
    axes: Array = field(default_factory=lambda: np.eye(3))

    @classmethod
    def about(cls, axis: Array, place: Sequence[float] | Array = (0.0, 0.0, 0.0)) -> Frame:
        """Return a frame whose z is along a direction."""
        z = axis / np.linalg.norm(axis)
        other = np.eye(3)[int(np.argmin(np.round(np.abs(z), 9)))]
        x = other - (other @ z) * z
        x /= np.linalg.norm(x)
        return cls(np.array(place), np.column_stack([x, np.cross(z, x), z]) + 0.0)

    @classmethod
    def posed(cls, place: Array, angles: Array) -> Frame:
        """Return a frame turned by roll, pitch and yaw about fixed x, y and z [rad]."""
        return cls(place, right_angled(Rotation.from_euler("xyz", angles).as_matrix()))

    def then(self, inner: Frame) -> Frame:
        """Return a frame given relative to this one, relative to the reference of this one."""
        return Frame(self.place + self.axes @ inner.place, self.axes @ inner.axes)

    def inverse(self) -> Frame:
        """Return the reference of this one, relative to this one."""
        return self.relative(Frame())

    def relative(self, other: Frame) -> Frame:
        """Return a frame given relative to the reference of this one, relative to this one."""
        return Frame(self.axes.T @ (other.place - self.place), self.axes.T @ other.axes)

    def at(self, place: Array) -> Array:
        """Return the place of a point of this frame."""
        return np.asarray(self.place + self.axes @ place)

    def tensor(self, own: Array) -> Array:
        """Return an inertia given on these axes, on the axes of the reference."""
        return np.asarray(self.axes @ own @ self.axes.T)


def turned(vector: Sequence[float] | Array) -> Array:
    """Return the rotation about a vector by its length [rad]."""
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


def right_angled(axes: Array) -> Array:
    """Return the axes at right angles that are nearest to others; components that are nothing or
    one but for rounding are so.
    """
    left, _, right = np.linalg.svd(np.where(np.abs(axes) < 1e-9, 0.0, axes))
    exact = left @ right
    exact = np.where(np.abs(exact) < 1e-9, 0.0, exact)
    return np.asarray(np.where(np.abs(np.abs(exact) - 1.0) < 1e-15, np.sign(exact), exact))
