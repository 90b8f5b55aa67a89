"""The ways in which a mechanism can be assembled: numbered pictures, and beside them the posture
that chooses each.
"""

from __future__ import annotations

import itertools
import math
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, BinaryIO

import numpy as np

from ...errors import AssemblyError, PostureError
from ...model.scene import Scene
from ...model.scene_arguments import posture_entry
from ...results.solution import Solution
from ...studies.evaluate import evaluate
from ..shapes.labels import NAMES_IN_ROW
from ..shapes.picture_files import one_at_a_time, save
from ..shapes.poses import Poses
from ..shapes.primitives import cloud, drawing
from ..shapes.shapes import named_spots
from .mechanism_figure import draw_into

_ALL, _SOME, _LARGE = 16, 8, 40
"""Largest numbers of ways that are all drawn, of those drawn of more, and of bodies of a mechanism:
each way is derived.
"""

_WIDE, _LINE, _ROW, _MARGIN = 46, 0.16, 0.06, 0.3
"""Letters in a line of the table; its height, the room between rows, and that at edges [inch]."""

_ROUNDING = 1e-9
"""Coordinates above the negative of this are not negative [m]."""

_NAMED = 8
"""Largest number of places that are all named in each picture."""

_ENTRY = re.compile("'([^']+)':")

_LETTER = 0.078
"""Width of a letter of the table [inch]."""


@one_at_a_time()
def draw_postures(scene: Scene, file: BinaryIO) -> tuple[list[str], bool]:
    """Draw the ways in which a scene that leaves them open can be assembled at its start, as PNG.

    Parameters
    ----------
    scene
        The scene, whose posture leaves some loops open.
    file
        Where the picture is written; nothing is where there is no way, or where some loop lacks
        rough values to be iterated from.

    Returns
    -------
    postures : list of str
        The posture to paste for each way, in the order of their numbers. Ways that look the same
        share a picture. Of more than sixteen combinations at most eight are drawn, which
        differ in the first loops; the picture says how to get the others.
    complete : bool
        True if no other way is left.
    """
    from matplotlib.figure import Figure

    found, possible = assemblies(scene)
    if not found:
        return [], True
    postures = [f"posture={{{entries}}}" for entries, _ in found]
    rows = [list(_lines(posture)) for posture in postures]
    pictures = _apart([solution for _, solution in found])
    words, notes = f"{len(found)} ways to assemble it", []
    if len(pictures) < len(found):
        notes.append("Postures with one picture differ by rotations that it does not show.")
    if possible > _ALL:
        words = f"{len(found)} of at most {possible} ways to assemble it"
        notes.append(
            "To see the others, put the first entry of a row into the scene's posture, and run"
            " again: the picture then has the postures with this entry."
        )
    note = [line for sentence in notes for line in textwrap.wrap(sentence, _WIDE + 4)]
    columns = min(math.ceil(math.sqrt(len(pictures))), 4)
    spots = named_spots(found[0][1].description)
    entries = {entry.partition(":")[0] for row in postures for entry in _ENTRY.findall(row)}
    # In small pictures names hide each other, and bodies have their colours: those that choose.
    named = spots if len(spots) <= _NAMED else entries
    side = 4.2 if columns <= 2 else 3.0
    level = 0.8 * side
    table = _LINE * (sum(map(len, rows)) + len(note) + 2) + _ROW * len(rows)
    legend = 0.24 * -(-len(found[0][1].description.bodies) // NAMES_IN_ROW)
    high = max(level * -(-len(pictures) // columns), table) + 2.5 * _MARGIN + legend
    left = columns * side + _MARGIN
    wide = left + max(len(line) for row in (*rows, note) for line in row) * _LETTER + 0.9
    figure = Figure(figsize=(wide, high))

    def write(x: float, y: float, words: str, **style: Any) -> None:
        """Write words below a place from the upper left corner [inch]."""
        figure.text(x / wide, 1.0 - y / high, words, va="top", **style)

    title = f"{found[0][1].case} at t = {scene.t[0]:g} s: {words}"
    write(_MARGIN, 0.7 * _MARGIN, title, fontsize=12)
    for k, numbers in enumerate(pictures):
        across, down = _MARGIN + k % columns * side, 2.0 * _MARGIN + (k // columns + 1) * level
        place = across / wide, 1.0 - down / high, 0.94 * side / wide, (level - 0.22) / high
        axes = figure.add_axes(place, anchor="NW")
        draw_into(axes, found[numbers[0]][1], named)
        axes.set(title="", xticks=[], yticks=[], xlabel="", ylabel="")
        title = ", ".join(str(number + 1) for number in numbers)
        axes.set_title(title, fontsize=11, fontweight="bold", loc="left", pad=3.0)
    y = 2.0 * _MARGIN
    for number, row in enumerate(rows, 1):
        write(left + 0.1, y, str(number), fontsize=9, fontweight="bold")
        write(left + 0.4, y, "\n".join(row), fontsize=9, family="monospace", linespacing=1.28)
        y += _LINE * len(row) + _ROW
    write(left + 0.1, y + _LINE, "\n".join(note), fontsize=9)
    save(figure, file, dpi=110)
    return postures, possible <= _ALL


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
    modes = _ways(scene, scene.posture, first, levels)
    found = list(itertools.islice(modes, 1))
    if found and len(found[0][1].description.bodies) > _LARGE:
        return [], 0
    # What a builder can build comes first.
    return sorted([*found, *modes], key=lambda one: _negative(one[1])), possible


def _negative(solution: Solution) -> int:
    """Count the slides at negative coordinates: no cylinder has a negative length."""
    kinds = solution.description.coordinates
    slides = (name for name, kind in kinds.items() if kind == "slide")
    return sum(float(solution.array(f"motion:{name}")[0]) < -_ROUNDING for name in slides)


def _apart(found: Sequence[Solution]) -> list[list[int]]:
    """Numbers of the ways, those together that look the same."""
    clouds = [cloud(drawing(Poses.of(solution))) for solution in found]
    near = 1e-6 * float(np.ptp(clouds[0], axis=0).max())
    pictures: list[list[int]] = []
    for number, points in enumerate(clouds):
        for picture in pictures:
            if np.abs(points - clouds[picture[0]]).max() <= near:
                picture.append(number)
                break
        else:
            pictures.append([number])
    return pictures


def _lines(posture: str) -> Iterator[str]:
    """A posture in lines of the table, each of which ends behind an entry."""
    line = ""
    for entry in posture.split(", "):
        if line and len(line) + len(entry) > _WIDE:
            yield f"{line},"
            line = " " * len("posture={") + entry
        else:
            line = f"{line}, {entry}" if line else entry
    yield line


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
