"""Forces on the mechanism: arrows of reactions, efforts and loads to one scale, and section forces
as ribbons along links.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...errors import DeclarationError, UnknownNameError
from ...model.description import Place
from ...results.solution import Solution
from ..shapes.readable import scale_for
from ..shapes.symbols import LOW, Arrow, Line, Primitive
from .film_frames import Frames

ACTION_COLOURS = {"reaction": "#c2304a", "effort": "#6d3fc0", "load": "#1e7f55"}
_POSITIVE, _NEGATIVE = "#d9622b", "#2267b0"

LONGEST, _WIDEST = 0.3, 0.2
"""The longest arrow and the widest ribbon, over the mechanism's size."""

_RATIOS = 41
_FULL = 1.5 * np.pi
"""Angle of the arc of the largest moment."""

_ARC, _HEAD = 0.06, 0.03
"""The radius of an arc, and the length of an arrow's head, over the mechanism's size."""


@dataclass(frozen=True, eq=False)
class Action:
    """Force [N] or moment [N m] at a place (frames, 3), in ground axes.

    ``kind`` is "reaction", "effort" or "load", ``of`` the joint, the coordinate or the load; a load
    pushes at its place.
    """

    kind: str
    of: str
    place: Array
    vector: Array
    moment: bool = False

    @property
    def colour(self) -> str:
        """The colour of its arrow."""
        return ACTION_COLOURS[self.kind]

    @property
    def tail(self) -> bool:
        """True if the arrow begins at its place, and does not end there."""
        return self.kind != "load"


def drawn_forces(
    frames: Frames, size: float, *, arrows: bool, section: str
) -> tuple[tuple[Primitive, ...], str]:
    """The forces of a mechanism of a ``size`` [m], and the largest ones in words: arrows of
    reactions, efforts and loads, and ribbons of one section force if one is named.

    Raises :class:`.DeclarationError` where the solution does not have them.
    """
    found: list[Primitive] = []
    words: list[str] = []
    if arrows:
        pushes, moments = actions_of(frames)
        for actions, unit, what in ((pushes, "N", "arrows"), (moments, "N m", "drive torques")):
            largest = largest_of(actions)
            found += [_arrow(one, frames, size, largest or 1.0) for one in actions]
            words += (
                [f"{what}: up to {scale_for(unit, largest).said(largest, 3)}"] if actions else []
            )
    if section:
        frames = _moving(frames)
        laws = _laws(frames.solution, section)
        peaks = [frames.solution.peak(Output("section", link, section)) for link in laws]
        largest = max(abs(peak.value) for peak in peaks)
        scale = _WIDEST * size / (largest or 1.0)
        found += [one for link in laws for one in _ribbon(frames, link, section, scale)]
        what = section.replace("_", " ")
        words.append(f"{what}: up to {scale_for(peaks[0].unit, largest).said(largest, 3)}")
    return tuple(found), " · ".join(words)


def _arrow(action: Action, frames: Frames, size: float, largest: float) -> Arrow:
    """The arrow of a force or a moment; of a moment in the plane the arc, counter-clockwise if the
    moment is positive.
    """
    if action.moment and not frames.solution.description.space:
        angles = np.pi / 4 + _FULL / largest * action.vector[:, 2:] * np.linspace(0.0, 1.0, 25)
        around = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=-1)
        points = action.place[:, None] + _ARC * size * around
    else:
        length = action.vector * (LONGEST * size / largest)
        start = action.place if action.tail else action.place - length
        points = np.stack([start, start + length], axis=1)
    return Arrow(points, action.colour, _HEAD * size)


def actions_of(frames: Frames) -> tuple[list[Action], list[Action]]:
    """Reactions, efforts and loads: forces, and the moments of drives.

    Raises :class:`.DeclarationError` where the solution has none of them.
    """
    frames = _moving(frames)
    pushes, moments = list(_pushes(frames)), list(_turns(frames))
    if not pushes and not moments:
        raise DeclarationError(
            f"{frames.solution.case}: there is no reaction, effort or load to be shown; want"
            " reaction too"
        )
    return pushes, moments


def largest_of(actions: Sequence[Action]) -> float:
    """The largest size of any, over all frames; 0 of none."""
    return max((float(np.max(np.linalg.norm(one.vector, axis=1))) for one in actions), default=0.0)


def _moving(frames: Frames) -> Frames:
    """The frames with nothing for forces where a joint that rubs is at rest, and they are open."""
    solution = frames.solution
    if not solution.resting.any():
        return frames
    shown = {
        o: values if o in solution.indeterminate else np.nan_to_num(values)
        for o, values in solution.outputs.items()
    }
    return replace(frames, solution=replace(solution, outputs=shown))


def _pushes(frames: Frames) -> Iterator[Action]:
    """Forces: reactions, efforts along axes, and loads."""
    solution = frames.solution
    for joint in solution.description.joints.values():
        if (direction := _vector(frames, "reaction", joint.name)) is not None:
            yield Action("reaction", joint.name, frames.poses.place(joint.child), direction)
        for axis in joint.axes:
            name = axis.coordinate
            if axis.kind == "slide" and (effort := _effort(frames, name)) is not None:
                along_axis = frames.poses.direction(joint.parent.body, axis.direction)
                yield Action("effort", name, frames.poses.place(joint.child), effort * along_axis)
    for name, load in solution.description.loads.items():
        if (direction := _vector(frames, "load", name)) is not None:
            yield Action("load", name, frames.poses.place(load.points[0]), direction)


def _turns(frames: Frames) -> Iterator[Action]:
    """Efforts about axes."""
    for joint in frames.solution.description.joints.values():
        for axis in joint.axes:
            name = axis.coordinate
            if axis.kind != "slide" and (effort := _effort(frames, name)) is not None:
                direction = (
                    np.array([axis.direction])
                    if not frames.solution.description.space
                    else frames.poses.direction(joint.parent.body, axis.direction)
                )
                yield Action(
                    "effort", name, frames.poses.place(joint.child), effort * direction, moment=True
                )


def _vector(frames: Frames, group: str, name: str) -> Array | None:
    """A force in ground axes (frames, 3) [N], or None where it is not known."""
    outputs = [Output(group, name, member) for member in ("fx", "fy", "fz")]
    columns = [frames.solution.outputs.get(output) for output in outputs]
    if all(column is None for column in columns):
        return None
    found = frames.at(
        np.column_stack(
            [np.zeros_like(frames.solution.t) if column is None else column for column in columns]
        )
    )
    return found if np.isfinite(found).all() else None


def _effort(frames: Frames, name: str) -> Array | None:
    values = frames.solution.outputs.get(Output("effort", name))
    if values is None or not np.isfinite(values).all():
        return None
    return frames.at(values)[:, None]


def _laws(solution: Solution, force: str) -> list[str]:
    """The links whose section force is known."""
    if force not in solution.table.sections:
        raise UnknownNameError("section force", force, solution.table.sections)
    links = [
        link
        for link in solution.links_with_sections
        if solution.determined(Output("section", link, force))
    ]
    if not links:
        none = (
            "a body declared by its mass and centre has none, and indeterminate ones are not shown"
        )
        raise DeclarationError(
            f"{solution.case}: there is no section force to be shown; want section too; {none}"
        )
    return links


def _ribbon(frames: Frames, link: str, force: str, scale: float) -> Iterator[Line]:
    """A section force along a link: the ordinates of each sign beside the axis."""
    law, xi = frames.solution.section(link).law, np.linspace(0.0, 1.0, _RATIOS)
    poses = frames.poses
    base, tip = (poses.place(Place(link, (at, 0.0, 0.0)))[:, None] for at in (0.0, law.length))
    axis = base + xi[:, None] * (tip - base)
    local = (0.0, 0.0, 1.0) if force in ("shear_z", "bending_y") else (0.0, 1.0, 0.0)
    side = poses.direction(link, local)[:, None]
    values = scale * frames.at(law.on_grid(force, xi))[..., None]
    for edge, colour, opacity in (
        (np.maximum(values, 0.0), _POSITIVE, 0.4),
        (np.minimum(values, 0.0), _NEGATIVE, 0.3),
    ):
        points = np.concatenate([axis, (axis + edge * side)[:, ::-1]], axis=1)
        yield Line(points, colour, 1.2, closed=True, opacity=opacity, level=LOW)
