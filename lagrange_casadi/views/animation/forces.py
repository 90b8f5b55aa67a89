"""Forces on the mechanism: arrows of reactions, efforts and loads to one scale, and section forces
as ribbons along links.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...errors import DeclarationError, UnknownNameError
from ...model.description import Place
from ...results.solution import Solution
from .drawn import Line, Thing, Words, across, along
from .motion import Motion
from .stage import Stage

ACTION_COLOURS = {"reaction": "#c2304a", "effort": "#6d3fc0", "load": "#1e7f55"}
_POSITIVE, _NEGATIVE = "#d9622b", "#2267b0"

LONGEST, _WIDEST = 0.3, 0.2
"""The longest arrow and the widest ribbon, over the mechanism's size."""

_RATIOS = 41
_FULL = 1.5 * np.pi
"""Angle of the arc of the largest moment."""


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


@dataclass(frozen=True, eq=False)
class Arrow:
    """A force, or in space a moment: from ``tail`` to ``tip``, each (frames,
    3) in ground axes [m].
    """

    tail: Array
    tip: Array
    colour: str


@dataclass(frozen=True, eq=False)
class Arc:
    """A moment in the plane, about a place (frames, 3), over the largest one (frames,):
    counter-clockwise where positive.
    """

    place: Array
    share: Array
    colour: str


@dataclass(frozen=True, eq=False)
class Ribbon:
    """A section force along a link: its axis (frames, ratios, 3), and the ordinates' ends in ground
    axes [m], of a sign each.
    """

    axis: Array
    positive: Array
    negative: Array


@dataclass(frozen=True, eq=False)
class Forces:
    """All forces that are shown, and what the largest ones are, in words."""

    arrows: tuple[Arrow, ...] = ()
    arcs: tuple[Arc, ...] = ()
    ribbons: tuple[Ribbon, ...] = ()
    scale: str = ""

    def cloud(self) -> Iterator[Array]:
        """Places (n, 3) that must have room."""
        for arrow in self.arrows:
            yield from (arrow.tail, arrow.tip)
        for ribbon in self.ribbons:
            yield from (ribbon.positive.reshape(-1, 3), ribbon.negative.reshape(-1, 3))


def forces_of(motion: Motion, size: float, *, arrows: bool, section: str) -> Forces:
    """The forces of a mechanism of a ``size`` [m]: reactions, efforts and loads, and one section
    force where one is named.

    Raises :class:`.DeclarationError` where the solution does not have them.
    """
    found: list[Arrow] = []
    arcs: list[Arc] = []
    words: list[str] = []
    if arrows:
        pushes, moments = actions_of(motion)
        largest = largest_of(pushes)
        for one in pushes:
            length = one.vector * (LONGEST * size / (largest or 1.0))
            tail, tip = (
                (one.place, one.place + length) if one.tail else (one.place - length, one.place)
            )
            found.append(Arrow(tail, tip, one.colour))
        words += [f"arrows: up to {_said(largest, 'N')}"] if pushes else []
        largest = largest_of(moments)
        for one in moments:
            if motion.solution.description.space:
                found.append(
                    Arrow(
                        one.place,
                        one.place + one.vector * (LONGEST * size / (largest or 1.0)),
                        one.colour,
                    )
                )
            else:
                arcs.append(Arc(one.place, one.vector[:, 2] / (largest or 1.0), one.colour))
        words += [f"drive torques: up to {_said(largest, 'N m')}"] if moments else []
    ribbons: list[Ribbon] = []
    if section:
        motion = _moving(motion)
        laws = _laws(motion.solution, section)
        peaks = [motion.solution.peak(Output("section", link, section)) for link in laws]
        largest = max(abs(peak.value) for peak in peaks)
        scale = _WIDEST * size / (largest or 1.0)
        ribbons = [_ribbon(motion, link, section, scale) for link in laws]
        words.append(f"{section.replace('_', ' ')}: up to {_said(largest, peaks[0].unit)}")
    return Forces(tuple(found), tuple(arcs), tuple(ribbons), " · ".join(words))


def actions_of(motion: Motion) -> tuple[list[Action], list[Action]]:
    """Reactions, efforts and loads: forces, and the moments of drives.

    Raises :class:`.DeclarationError` where the solution has none of them.
    """
    motion = _moving(motion)
    pushes, moments = list(_pushes(motion)), list(_turns(motion))
    if not pushes and not moments:
        raise DeclarationError(
            f"{motion.solution.case}: there is no reaction, effort or load to be shown; want"
            " reaction too"
        )
    return pushes, moments


def largest_of(actions: Sequence[Action]) -> float:
    """The largest size of any, over all frames; 0 of none."""
    return max((float(np.max(np.linalg.norm(one.vector, axis=1))) for one in actions), default=0.0)


def _moving(motion: Motion) -> Motion:
    """The motion with nothing for forces where a joint that rubs is at rest, and they are open."""
    solution = motion.solution
    if not solution.resting.any():
        return motion
    shown = {
        o: values if o in solution.indeterminate else np.nan_to_num(values)
        for o, values in solution.outputs.items()
    }
    return replace(motion, solution=replace(solution, outputs=shown))


def ribbon_things(forces: Forces, stage: Stage) -> Iterator[Thing]:
    """The ribbons on the sheet."""
    for ribbon in forces.ribbons:
        for edge, colour, opacity in (
            (ribbon.positive, _POSITIVE, 0.4),
            (ribbon.negative, _NEGATIVE, 0.3),
        ):
            points = np.concatenate([ribbon.axis, edge[:, ::-1]], axis=1)
            yield Line(
                stage.on_sheet(points),
                colour,
                1.2 * stage.unit,
                closed=True,
                fill=colour,
                opacity=opacity,
            )


def arrow_things(forces: Forces, stage: Stage) -> Iterator[Thing]:
    """The arrows on the sheet, and at its foot what the longest of them are."""
    for arrow in forces.arrows:
        tail, tip = stage.on_sheet(arrow.tail), stage.on_sheet(arrow.tip)
        yield from _headed(
            np.stack([tail, tip], axis=1),
            np.hypot(*(tip - tail).T),
            tip - tail,
            arrow.colour,
            stage.unit,
        )
    for arc in forces.arcs:
        radius = 26.0 * stage.unit
        angles = np.pi / 4 + _FULL * arc.share[:, None] * np.linspace(0.0, 1.0, 25)
        spokes = np.stack([np.cos(angles), -np.sin(angles)], axis=-1)
        points = stage.on_sheet(arc.place)[:, None] + radius * spokes
        ahead = across(spokes[:, -1]) * np.sign(arc.share)[:, None]
        yield from _headed(
            points, radius * _FULL * np.abs(arc.share), ahead, arc.colour, stage.unit
        )
    if forces.scale:
        at = np.array([[12.0 * stage.unit, stage.height - 12.0 * stage.unit]])
        yield Words(at, forces.scale)


def _headed(points: Array, length: Array, ahead: Array, colour: str, unit: float) -> Iterator[Line]:
    """A line (frames, n, 2) and the arrow's head at its end, which is smaller where the line of a
    ``length`` (frames,) is short.
    """
    head = np.minimum(13.0 * unit, length)[:, None]
    direction, tip = along(ahead), points[:, -1]
    back, side = tip - head * direction, 0.36 * head * across(direction)
    shaft = points.copy()
    if points.shape[1] == 2:
        shaft[:, -1] = tip - 0.8 * head * direction
    yield Line(shaft, colour, 2.6 * unit)
    yield Line(
        np.stack([tip, back + side, back - side], axis=1),
        colour,
        0.8 * unit,
        closed=True,
        fill=colour,
    )


def _pushes(motion: Motion) -> Iterator[Action]:
    """Forces: reactions, efforts along axes, and loads."""
    solution = motion.solution
    for joint in solution.description.joints.values():
        if (direction := _vector(motion, "reaction", joint.name)) is not None:
            yield Action("reaction", joint.name, motion.place(joint.child), direction)
        for axis in joint.axes:
            name = axis.coordinate
            if axis.kind == "slide" and (effort := _effort(motion, name)) is not None:
                along_axis = motion.direction(joint.parent.body, axis.direction, joint.parent.at)
                yield Action("effort", name, motion.place(joint.child), effort * along_axis)
    for name, load in solution.description.loads.items():
        if (direction := _vector(motion, "load", name)) is not None:
            yield Action("load", name, motion.place(load.points[0]), direction)


def _turns(motion: Motion) -> Iterator[Action]:
    """Efforts about axes."""
    for joint in motion.solution.description.joints.values():
        for axis in joint.axes:
            name = axis.coordinate
            if axis.kind != "slide" and (effort := _effort(motion, name)) is not None:
                direction = (
                    np.array([axis.direction])
                    if not motion.solution.description.space
                    else motion.direction(joint.parent.body, axis.direction)
                )
                yield Action(
                    "effort", name, motion.place(joint.child), effort * direction, moment=True
                )


def _vector(motion: Motion, group: str, name: str) -> Array | None:
    """A force in ground axes (frames, 3) [N], or None where it is not known."""
    outputs = [Output(group, name, member) for member in ("fx", "fy", "fz")]
    columns = [motion.solution.outputs.get(output) for output in outputs]
    if all(column is None for column in columns):
        return None
    found = motion.at(
        np.column_stack(
            [np.zeros_like(motion.solution.t) if column is None else column for column in columns]
        )
    )
    return found if np.isfinite(found).all() else None


def _effort(motion: Motion, name: str) -> Array | None:
    values = motion.solution.outputs.get(Output("effort", name))
    if values is None or not np.isfinite(values).all():
        return None
    return motion.at(values)[:, None]


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


def _ribbon(motion: Motion, link: str, force: str, scale: float) -> Ribbon:
    law, xi = motion.solution.section(link).law, np.linspace(0.0, 1.0, _RATIOS)
    base, tip = (motion.place(Place(link, (at, 0.0, 0.0)))[:, None] for at in (0.0, law.length))
    axis = base + xi[:, None] * (tip - base)
    side = motion.direction(
        link, (0.0, 0.0, 1.0) if force in ("shear_z", "bending_y") else (0.0, 1.0, 0.0)
    )[:, None]
    values = scale * motion.at(law.on_grid(force, xi))[..., None]
    return Ribbon(
        axis, axis + np.maximum(values, 0.0) * side, axis + np.minimum(values, 0.0) * side
    )


def _said(value: float, unit: str) -> str:
    """A size as people read it."""
    power = min(3, max(-1, math.floor(math.log10(value) / 3))) if value > 0.0 else 0
    return f"{value / 1000.0**power:.3g} {('m', '', 'k', 'M', 'G')[power + 1]}{unit}"
