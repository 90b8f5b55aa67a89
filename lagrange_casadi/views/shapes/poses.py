"""Poses of a mechanism's bodies at instants: all that a picture needs beside the description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...base.arrays import Array, Instants, during
from ...base.quantities import Output
from ...errors import DeclarationError, listed
from ...model.description import Description, Place, Triple
from ...results.solution import Solution
from ...results.views import Pose

COLOURS = (
    *("#1f4e79", "#b3541e", "#2e7d4f", "#7a3b8f", "#8a6d1a", "#3c6e71", "#9c2f4a", "#555555"),
    *("#6fa3d8", "#eba277", "#7cc79a", "#b98acb", "#d4b95c", "#86bcc0", "#dd8aa0", "#a9a9a9"),
)


@dataclass(frozen=True, eq=False)
class Poses:
    """The places of the bases (t, 3) [m] and the axes (t, 3, 3) of the ground and the bodies, by
    name, in ground axes.

    The rows of the axes are x, y and z of the body.
    """

    description: Description
    bases: Mapping[str, Array]
    axes: Mapping[str, Array]

    @cached_property
    def colours(self) -> dict[str, str]:
        """The colours of the bodies, by their order."""
        return {name: COLOURS[k % len(COLOURS)] for k, name in enumerate(self.description.bodies)}

    @classmethod
    def of(cls, solution: Solution) -> Poses:
        """The poses at the instants of a solution, which must have its motion."""
        poses = {body: solution.pose(body) for body in solution.description.bodies}
        bases = {"ground": np.zeros((solution.t.size, 3))} | {
            body: np.column_stack([pose.x, pose.y, 0.0 * pose.x if pose.z is None else pose.z])
            for body, pose in poses.items()
        }
        axes = {"ground": np.tile(np.eye(3), (solution.t.size, 1, 1))} | {
            body: _axes(pose) for body, pose in poses.items()
        }
        return cls(solution.description, bases, axes)

    def during(self, chosen: Instants) -> Poses:
        """The poses at some of the instants."""
        return replace(self, bases=during(self.bases, chosen), axes=during(self.axes, chosen))

    def place(self, spot: Place) -> Array:
        """A place on a body or on the ground, (t, 3) in ground axes [m]."""
        return np.asarray(self.along(spot.body, [spot.at])[:, 0])

    def along(self, body: str, places: Sequence[Triple]) -> Array:
        """Places on a body or on the ground, (t, n, 3) in ground axes [m]."""
        return np.asarray(self.bases[body][:, None] + np.array(places, float) @ self.axes[body])

    def direction(self, body: str, local: Triple) -> Array:
        """A direction that a body carries, (t, 3) in ground axes."""
        return np.asarray(np.array(local, float) @ self.axes[body])


def frame_along(direction: Array) -> Array:
    """Three axes at right angles (..., 3, 3), rows, the first of which has a direction (..., 3)."""
    x = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    # In the plane the second axis lies in the plane.
    y = np.cross(np.eye(3)[np.argmin(np.abs(x) - [0.0, 0.0, 1e-9], axis=-1)], x)
    y /= np.linalg.norm(y, axis=-1, keepdims=True)
    return np.stack([x, y, np.cross(x, y)], axis=-2)


def require_poses(solution: Solution, what: str = "a report") -> None:
    """Raise :class:`.DeclarationError` where a body has no pose among the outputs; ``what`` would
    show it.
    """
    lacking = [
        f"'{body}'"
        for body in solution.description.bodies
        if Output("pose", body, "x") not in solution.outputs
    ]
    if lacking:
        raise DeclarationError(
            f"{solution.case}: {what} shows the mechanism in motion, and there is no motion of"
            f" {listed(lacking)}; want motion too"
        )


def _axes(pose: Pose) -> Array:
    """The axes (t, 3, 3) of a pose; those that a body does not have complete the others."""
    if pose.axes is not None:
        return frame_along(pose.axes[:, 0]) if np.isnan(pose.axes).any() else pose.axes
    angle = np.zeros_like(pose.x) if pose.angle is None else pose.angle
    return frame_along(np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1))
