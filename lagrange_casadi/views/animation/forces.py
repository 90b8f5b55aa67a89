"""Forces on the mechanism: arrows of reactions, efforts and loads to one scale, and section forces
as ribbons along links.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...errors import DeclarationError, check_known
from ...results.solution import Solution
from ..shapes.poses import Poses
from ..shapes.readable import scale_for
from ..shapes.symbols import LOW, Arrow, Line, Primitive

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

    ``kind`` is "reaction", "effort" or "load", ``of`` the joint, the coordinate or the load. The
    arrow of a load ends at its place, any other begins there.
    """

    kind: str
    of: str
    place: Array
    vector: Array
    moment: bool = False


def drawn_forces(
    shown: Solution, poses: Poses, whole: Solution, size: float, *, arrows: bool, section: str
) -> tuple[tuple[Primitive, ...], str]:
    """The forces of a mechanism of a ``size`` [m] at the instants that are ``shown``, and the
    largest ones in words: arrows of reactions, efforts and loads, and ribbons of one section force
    if one is named, whose peaks are those of the ``whole`` solution.

    Raises :class:`.DeclarationError` where the solution does not have them.
    """
    found: list[Primitive] = []
    words: list[str] = []
    if arrows:
        for unit, actions, largest in actions_of(shown, poses):
            found += [_arrow(one, shown.description.space, size, largest or 1.0) for one in actions]
            what = "drive torques" if unit == "N m" else "arrows"
            words.append(f"{what}: up to {scale_for(unit, largest).said(largest, 3)}")
    if section:
        laws = _laws(whole, section)
        peaks = [whole.peak(Output("section", link, section)) for link in laws]
        largest = max(abs(peak.value) for peak in peaks)
        scale = _WIDEST * size / (largest or 1.0)
        for link in laws:
            found += _ribbon(shown, poses, link, section, scale)
        what = section.replace("_", " ")
        words.append(f"{what}: up to {scale_for(peaks[0].unit, largest).said(largest, 3)}")
    return tuple(found), " · ".join(words)


def _arrow(action: Action, space: bool, size: float, largest: float) -> Arrow:
    """The arrow of a force or a moment; of a moment in the plane the arc, counter-clockwise if the
    moment is positive.
    """
    if action.moment and not space:
        angles = np.pi / 4 + _FULL / largest * action.vector[:, 2:] * np.linspace(0.0, 1.0, 25)
        around = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=-1)
        points = action.place[:, None] + _ARC * size * around
    else:
        length = action.vector * (LONGEST * size / largest)
        start = action.place - length if action.kind == "load" else action.place
        points = np.stack([start, start + length], axis=1)
    return Arrow(points, ACTION_COLOURS[action.kind], _HEAD * size)


def actions_of(solution: Solution, poses: Poses) -> list[tuple[str, list[Action], float]]:
    """Reactions, efforts and loads: the unit, actions, and the largest size of any over all frames,
    of forces and of the moments of drives, as far as there are some.

    Raises :class:`.DeclarationError` where the solution has none of them.
    """
    found = [*_actions(solution, poses)]
    if not found:
        raise DeclarationError(
            f"{solution.case}: there is no reaction, effort or load to be shown; want reaction too"
        )
    groups = {
        "N": [one for one in found if not one.moment],
        "N m": [one for one in found if one.moment],
    }
    return [
        (unit, some, float(np.linalg.norm([one.vector for one in some], axis=2).max()))
        for unit, some in groups.items()
        if some
    ]


def moving(solution: Solution) -> Solution:
    """The solution with nothing for forces that are open where a joint that rubs is at rest."""
    if not solution.resting.any():
        return solution
    shown = {
        o: values if o in solution.indeterminate else np.nan_to_num(values)
        for o, values in solution.outputs.items()
    }
    return replace(solution, outputs=shown)


def _actions(solution: Solution, poses: Poses) -> Iterator[Action]:
    """Reactions and loads, and efforts along and about axes, as far as they are known."""
    for joint in solution.description.joints.values():
        place = poses.place(joint.child)
        if (direction := _vector(solution, "reaction", joint.name)) is not None:
            yield Action("reaction", joint.name, place, direction)
        for axis in joint.axes:
            name, turns = axis.coordinate, axis.kind != "slide"
            effort = solution.outputs.get(Output("effort", name))
            if effort is not None and np.isfinite(effort).all():
                way = poses.direction(joint.parent.body, axis.direction)
                yield Action("effort", name, place, effort[:, None] * way, moment=turns)
    for name, load in solution.description.loads.items():
        if (direction := _vector(solution, "load", name)) is not None:
            yield Action("load", name, poses.place(load.points[0]), direction)


def _vector(solution: Solution, group: str, name: str) -> Array | None:
    """A force in ground axes (frames, 3) [N], or None where it is not known."""
    columns = [solution.outputs.get(Output(group, name, member)) for member in ("fx", "fy", "fz")]
    found = np.column_stack([0.0 * solution.t if one is None else one for one in columns])
    known = any(one is not None for one in columns) and np.isfinite(found).all()
    return found if known else None


def _laws(solution: Solution, force: str) -> list[str]:
    """The links whose section force is known."""
    check_known("section force", [force], solution.table.sections)
    links = [
        link
        for link in solution.links_with_sections
        if solution.determined(Output("section", link, force))
    ]
    if not links:
        raise DeclarationError(
            f"{solution.case}: there is no section force to be shown; want section too; a body"
            " declared by its mass and centre has none, and indeterminate ones are not shown"
        )
    return links


def _ribbon(
    solution: Solution, poses: Poses, link: str, force: str, scale: float
) -> Iterator[Line]:
    """A section force along a link: the ordinates of each sign beside the axis."""
    law, xi = solution.section(link).law, np.linspace(0.0, 1.0, _RATIOS)
    axis = poses.along(link, [(x, 0.0, 0.0) for x in (law.length * xi).tolist()])
    local = (0.0, 0.0, 1.0) if force in ("shear_z", "bending_y") else (0.0, 1.0, 0.0)
    side = poses.direction(link, local)[:, None]
    values = scale * law.on_grid(force, xi)[..., None]
    for edge, colour, opacity in (
        (np.maximum(values, 0.0), _POSITIVE, 0.4),
        (np.minimum(values, 0.0), _NEGATIVE, 0.3),
    ):
        points = np.concatenate([axis, (axis + edge * side)[:, ::-1]], axis=1)
        yield Line(points, colour, 1.2, closed=True, opacity=opacity, level=LOW)
