"""The ways in which a mechanism can be assembled: numbered pictures, and beside them the posture
that chooses each.
"""

from __future__ import annotations

import itertools
import math
import re
import textwrap
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...errors import AssemblyError, PostureError
from ...model.scene import Scene
from ...model.scene_arguments import posture_entry
from ...results.solution import Solution
from ...studies.evaluate import evaluate
from ..shapes.marks import body_names
from ..shapes.picture_sheet import Picture, picture, sheet, view_of
from ..shapes.poses import Poses
from ..shapes.primitives import cloud, drawing
from ..shapes.shapes import named_spots

_ALL, _SOME, _LARGE = 16, 8, 40
"""Largest numbers of ways that are all drawn, of those drawn of more, and of bodies of a mechanism:
each way is derived.
"""

_WIDE, _SIDES = 50, (440, 320)
"""Letters in a line of the table; the width of pictures, and that of small ones [pixels]."""

_ROUNDING = 1e-9
"""Coordinates above the negative of this are not negative [m]."""

_NAMED = 8
"""Largest number of places that are all named in each picture."""

_ENTRY = re.compile("'([^']+)':")


def draw_postures(scene: Scene) -> tuple[Picture | None, list[str], bool]:
    """Draw the ways in which a scene that leaves them open can be assembled at its start.

    Parameters
    ----------
    scene
        The scene, whose posture leaves some loops open.

    Returns
    -------
    picture : Picture or None
        None where there is no way, or where some loop lacks rough values to be iterated from.
    postures : list of str
        The posture to paste for each way, in the order of their numbers. Ways that look the same
        share a picture. Of more than sixteen combinations at most eight are drawn, which
        differ in the first loops; the picture says how to get the others.
    complete : bool
        True if no other way is left.
    """
    found, possible = assemblies(scene)
    if not found:
        return None, [], True
    postures = [f"posture={{{entries}}}" for entries, _ in found]
    groups = _apart([solution for _, solution in found])
    words, notes = f"{len(found)} ways to assemble it", []
    if len(groups) < len(found):
        notes.append("Postures with one picture differ by rotations that it does not show.")
    if possible > _ALL:
        words = f"{len(found)} of at most {possible} ways to assemble it"
        notes.append(
            "To see the others, put the first entry of a row into the scene's posture, and run"
            " again: the picture then has the postures with this entry."
        )
    fold = textwrap.TextWrapper(_WIDE + 10, subsequent_indent=6 * " ", break_on_hyphens=False)
    # Lines end behind an entry: no other space can be broken.
    whole = [posture.replace(": ", ":\xa0").replace(" deg", "\xa0deg") for posture in postures]
    rows = [line for k, one in enumerate(whole, 1) for line in (*fold.wrap(f"{k}   {one}"), "")]
    rows += [line for sentence in notes for line in textwrap.wrap(sentence, _WIDE + 4)]
    entries = {entry.partition(":")[0] for posture in postures for entry in _ENTRY.findall(posture)}
    columns = min(math.ceil(math.sqrt(len(groups))), 4)
    pictures = [
        _picture(found[numbers[0]][1], numbers, entries, _SIDES[columns > 2]) for numbers in groups
    ]
    title = f"{found[0][1].case} at t = {scene.t[0]:g} s: {words}"
    return sheet(title, pictures, columns, rows), postures, possible <= _ALL


def numbered(postures: Iterable[str]) -> list[str]:
    """Lines of postures with the numbers of their pictures."""
    return [f"  {number:>2}  {line}" for number, line in enumerate(postures, 1)]


def _picture(
    solution: Solution, numbers: Sequence[int], entries: Collection[str], side: int
) -> Picture:
    """One way to assemble a mechanism, with the numbers of its postures. In a small picture names
    hide each other: of many those that choose are written.
    """
    description, poses = solution.description, Poses.of(solution)
    spots, bodies = named_spots(description), [*body_names(poses)]
    chosen = {name: spot for name, spot in spots.items() if len(spots) <= _NAMED or name in entries}
    names = [one for one in bodies if len(bodies) <= _NAMED or one.text in entries]
    words = ", ".join(str(number + 1) for number in numbers)
    things = (*drawing(poses, named=chosen), *names)
    return picture("", things, view_of(description), side, tallest=0.8, words=words)


def assemblies(scene: Scene) -> tuple[list[tuple[str, Solution]], int]:
    """Find the ways to assemble a scene at its start.

    Returns
    -------
    found
        For each way the entries of its posture in words, and its motion at that instant.
    possible
        The largest number of ways that there may be, by the loops of the first of them.
    """
    first, possible, levels = _closed(scene, scene.posture), 1, math.inf
    if isinstance(first, PostureError):
        counts = [len(modes) for modes in first.assembly_modes]
        possible = math.prod(counts)
        if possible > _ALL:
            levels = sum(math.prod(counts[: k + 1]) <= _SOME for k in range(len(counts)))
    ways = _ways(scene, scene.posture, first, levels)
    found = list(itertools.islice(ways, 1))
    if found and len(found[0][1].description.bodies) > _LARGE:
        return [], 0
    # What a builder can build comes first.
    return sorted([*found, *ways], key=lambda one: _negative(one[1])), possible


def _negative(solution: Solution) -> int:
    """Count the slides at negative coordinates: no cylinder has a negative length."""
    kinds = solution.description.coordinates
    slides = (name for name, kind in kinds.items() if kind == "slide")
    return sum(float(solution.array(f"motion:{name}")[0]) < -_ROUNDING for name in slides)


def _apart(found: Sequence[Solution]) -> list[list[int]]:
    """Numbers of the ways, those together that look the same."""
    clouds = [cloud(drawing(Poses.of(solution))) for solution in found]
    near = 1e-6 * float(np.ptp(clouds[0], axis=0).max())
    first = [
        next(k for k, other in enumerate(clouds) if np.abs(points - other).max() <= near)
        for points in clouds
    ]
    return [
        [k for k, alike in enumerate(first) if alike == number] for number in dict.fromkeys(first)
    ]


def _closed(scene: Scene, posture: Mapping[str, float]) -> Solution | PostureError | None:
    """A scene at its start with a posture, or what the posture leaves open; None where it closes no
    loop.
    """
    one = replace(scene, posture=posture, t=(scene.t[0], scene.t[0], 1), wanted=("motion",))
    try:
        return evaluate(one, backend="vm", certificate=False)
    except PostureError as error:
        return error
    except AssemblyError:
        return None


def _ways(
    scene: Scene,
    posture: Mapping[str, float],
    closed: Solution | PostureError | None,
    levels: float,
) -> Iterator[tuple[str, Solution]]:
    """The ways that agree with a posture, which is ``closed``: those of the next loops, so many,
    and one of the others with each.
    """
    if isinstance(closed, Solution):
        kinds = closed.description.coordinates
        entries = (
            posture_entry(name, kinds.get(name) == "slide", value)
            for name, value in posture.items()
        )
        yield ", ".join(entries), closed
    if not isinstance(closed, PostureError) or closed.lacking or not closed.assembly_modes:
        return
    modes = closed.assembly_modes[0]
    # An entry that is given and does not choose never will.
    if any(name in posture and name not in scene.posture for mode in modes for name in mode):
        return
    if levels <= 0:
        modes = ({name: x for first, *_ in closed.assembly_modes for name, x in first.items()},)
    for mode in modes:
        chosen = dict(posture) | dict(mode)
        yield from _ways(scene, chosen, _closed(scene, chosen), levels - 1)
