"""Places of a picture's parts, over the instants of a solution, which must have its motion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...errors import DeclarationError
from ...model.description import Description, Place
from ...results.solution import Solution
from .shapes import shapes


def drawn_spots(description: Description) -> Iterator[Place]:
    """All between which something is drawn."""
    for shape in shapes(description):
        places_here = [
            *shape.axis,
            *(at for arm in shape.arms for at in arm),
            *(at for plate in shape.plates for at in plate),
        ]
        yield from (
            Place(shape.name, at) for at in places_here or [shape.centre or (0.0, 0.0, 0.0)]
        )
    for joint in description.joints.values():
        yield from joint.ends
    for ends in description.springs.values():
        yield from ends
    yield from description.paths.values()


def spokes(description: Description) -> Iterator[Place]:
    """The ends of the spokes of discs, by which one sees them turn."""
    yield from (Place(shape.name, shape.spoke) for shape in shapes(description) if shape.spoke)


def placed(solution: Solution, spot: Place) -> Array:
    """A place over the instants (t, 3) in ground axes [m]."""
    local = np.array(spot.at)
    if spot.body == "ground":
        return np.tile(local, (solution.t.size, 1))
    pose = solution.pose(spot.body)
    z = np.zeros_like(pose.x) if pose.z is None else pose.z
    place: Array = np.column_stack([pose.x, pose.y, z])
    if pose.axes is not None:
        for k in np.flatnonzero(local):  # what a body has no axes for is not asked of it
            place = place + local[k] * pose.axes[:, k]
    elif pose.angle is not None:
        turned = (local[0] + 1j * local[1]) * np.exp(1j * pose.angle)
        place = place + np.column_stack([turned.real, turned.imag, z])
    return place


def require_poses(solution: Solution, what: str = "a report") -> None:
    """Raise :class:`.DeclarationError` where a body has no pose among the outputs; ``what`` would
    show it.
    """
    lacking = [
        body
        for body in solution.description.bodies
        if Output("pose", body, "x") not in solution.outputs
    ]
    if lacking:
        bodies = ", ".join(f"'{body}'" for body in lacking[:3]) + (
            f" and {len(lacking) - 3} more" if len(lacking) > 3 else ""
        )
        raise DeclarationError(
            f"{solution.case}: {what} shows the mechanism in motion, and there is no motion of"
            f" {bodies}; want motion too"
        )
