"""Remarks on a solution that is valid."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.quantities import Output
from .description import Description, JointNumbers
from .limits import MISSES, ROUNDED

_EDGE = 1e-9
"""Relative tolerance, of a link's length, for points outside it by rounding."""

_BRACKET = {
    False: "joint's force acts on that end, as through a rigid bracket",
    True: "line along which the joint slides is taken to go on",
}
"""Words for what is beyond the end of a link, by whether the link is rigid."""


def notes(
    t: Array,
    outputs: Mapping[Output, Array],
    description: Description,
    resting: npt.NDArray[np.bool_],
) -> Iterator[str]:
    """More drives than motions; slender links that slide across their axes, as nobody said; where a
    joint that rubs is ``resting``; joints in gimbal lock, whose turns are not known; each joint
    whose point slides beyond the end of a link, and how far it goes; and followers that lift off.

    As far as efforts, the motion of the joint, or the sections of the link, are among the outputs:
    those that are determined.
    """
    drives = description.drives
    moved = len(description.driven) - len(description.rows)
    if len(drives) > moved and Output("effort", drives[0]) in outputs:
        text = (
            f"{len(drives)} drives ({', '.join(drives)}) for {moved}"
            f" degree{'s' if moved > 1 else ''} of freedom"
        )
        yield f"{text}; their efforts are those with the least weighted sum of squares"
    yield from _across(description)
    if resting.any():
        yield rest_note(t, outputs, resting)
    yield from drawing_notes(description)
    for name, joint in description.joints.items():
        if (second := _locked(joint, outputs)) is not None:
            near = t[int(np.argmin(np.abs(np.cos(second))))]
            yield (
                f"joint '{name}' is in gimbal lock at t = {near:.6g} s: two of its rotations and"
                " all their rates are not evaluated; choose other instants, or another axis and"
                " second"
            )
        body = description.bodies.get(joint.parent.body)
        directions = _along(joint)
        if not directions or body is None or body.length is None:
            continue
        ratio = outputs.get(Output("station", joint.parent.body, "station", name))
        if ratio is None and directions.keys() <= outputs.keys():
            along = (direction * outputs[motion] for motion, direction in directions.items())
            ratio = sum(along, np.full(t.shape, joint.parent.at[0])) / body.length
        if ratio is None:
            continue
        # A rigid body may lie on both sides of its base, as a wheel does.
        rigid = body.density is None
        away = np.flatnonzero((ratio < -_EDGE - rigid) | (ratio > 1.0 + _EDGE))
        if away.size:
            low, high = (round(float(end), 9) + 0.0 for end in (ratio.min(), ratio.max()))
            yield (
                f"joint '{name}' leaves link '{joint.parent.body}' at t = {t[away[0]]:.6g} s"
                f" (xi/l from {low:.4g} to {high:.4g}); beyond the end of the link the"
                f" {_BRACKET[rigid]}"
            )
    for name, what in description.one_way.items():
        force = outputs.get(Output("output", name), np.zeros(0))
        pulled = np.flatnonzero(force < -_EDGE * np.max(np.abs(force), initial=0.0))
        if pulled.size:
            yield (
                f"{what} at t = {t[pulled[0]]:.6g} s: the force that keeps them together is"
                f" negative there, {force.min():.6g} N at least; preload them, or move slower"
            )


def drawing_notes(description: Description) -> Iterator[str]:
    """Corrections of rounded drawings, and their size: at ends of links and right angles; and by
    how much loops miss.
    """
    snapped = description.snapped
    for k, what, exact, unit in (
        (0, "axes", "at right angles", "rad"),
        (1, "places", "ends of links", "m"),
    ):
        if moved := {part: by[k] for part, by in snapped.items() if by[k]}:
            yield (
                f"{what} of {', '.join(moved)} are taken as {exact}, moved by up to"
                f" {max(moved.values()):.2g} {unit}"
            )
    by = ", ".join(
        f"that of '{name}' misses by {gap:.2g}" for name, gap in description.missed.items()
    )
    if description.rounding and not description.missed:
        by = f"they may miss by up to {MISSES * description.rounding:.2g}"
    if by:
        yield (
            f"loops close only within the rounding of the numbers given: {by} of the links' length,"
            " or rad"
        )


def _across(description: Description) -> Iterator[str]:
    """Each slender link that slides in a direction that is not its axis, where nothing was said of
    how it lies.
    """
    for name in description.unturned:
        joint = description.joints[name]
        along, axis = joint.triad[0], joint.turned[0]
        off = math.atan2(np.linalg.norm(np.cross(along, axis)), abs(np.dot(along, axis)))
        if off <= ROUNDED or _is_carrier(description, joint.child.body):
            continue
        if description.space:
            directions = "turned= says how it lies"
        else:
            directions = (
                f'angle="{math.degrees(math.atan2(along[1], along[0])):.6g} deg" lays it along,'
                " angle=0 says that it is meant"
            )
        yield (
            f"link '{joint.child.body}' slides along joint '{name}' at"
            f" {math.degrees(off):.3g} deg to its axis, because the joint's axis does not turn it:"
            f" {directions}"
        )


def _is_carrier(description: Description, link: str) -> bool:
    """Return whether a link has no mass, and all joins and loads at one place: then its direction
    has no effect.
    """
    every = (*description.acted_at, *description.paths.values())
    places = [place for place in every if place.body == link]
    return description.bodies[link].mass == 0.0 and all(place == places[0] for place in places)


def rest_note(t: Array, outputs: Mapping[Output, Array], resting: npt.NDArray[np.bool_]) -> str:
    """Note on a joint with friction that is at rest at some instants, and on the frictions
    there.
    """
    indeterminate = [
        o.part
        for o, values in outputs.items()
        if (o.group, o.member) == ("friction", "along") and np.isnan(values).any()
    ]
    frictions = f" ({', '.join(indeterminate)})" if indeterminate else ""
    first, last = t[np.flatnonzero(resting)[[0, -1]]]
    when = (
        f"at {int(np.count_nonzero(resting))} of {t.size} instants, first at t = {first:.6g} s,"
        f" last at t = {last:.6g} s"
    )
    consequence = "indeterminate there and NaN; peaks, means and strength leave these instants out"
    return (
        f"a joint with friction is at rest {when}: what depends on its friction{frictions} is"
        f" {consequence}"
    )


def _along(joint: JointNumbers) -> dict[Output, float]:
    """Distance of a joint's point along its parent's axis, from the motions that move it; empty if
    it does not slide.
    """
    found = {
        Output("motion", axis.coordinate): axis.direction[0]
        * (1.0 if axis.kind == "slide" else joint.pitch)
        for axis in joint.axes
    }
    return {motion: direction for motion, direction in found.items() if direction}


def _locked(joint: JointNumbers, outputs: Mapping[Output, Array]) -> Array | None:
    """The second of a joint's three turns, if the first is indeterminate because of gimbal lock."""
    rotations = [axis.coordinate for axis in joint.axes if axis.kind == "angle"]
    first, second = (
        (outputs.get(Output("motion", name)) for name in rotations[:2])
        if len(rotations) == 3
        else (None, None)
    )
    return second if first is None else None
