"""The ways in which a mechanism can be assembled, side by side, each with the posture that chooses
it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import BinaryIO

from ..declare.description import coordinates_of
from ..declare.scene import Scene
from ..errors import AssemblyError, PostureError
from ..instants.solution import Solution
from ..shapes.pictures import one_at_a_time, save
from ..studies.evaluate import evaluate
from .into import draw_into

_MOST, _LARGE = 8, 40
"""Largest number of ways that are drawn, and of bodies of a mechanism: each way is derived."""


@one_at_a_time()
def draw_postures(scene: Scene, file: BinaryIO) -> int:
    """Draw the ways in which a scene that leaves them open can be assembled at its start, up to
    eight, as PNG; how many there are.

    Nothing is written where there is none, or where some loop lacks rough values to be iterated
    from.
    """
    from matplotlib.figure import Figure

    found = list(assemblies(scene))
    if not found:
        return 0
    columns = min(len(found), 2)
    rows = -(-len(found) // columns)
    figure = Figure(figsize=(5.6 * columns, 4.4 * rows), layout="constrained")
    subplots = list(figure.subplots(rows, columns, squeeze=False).flat)
    for axes, (posture, solution) in zip(subplots, found, strict=False):
        draw_into(axes, solution)
        axes.set_title(f"posture={{{posture}}}", fontsize=9)
    for axes in subplots[len(found) :]:
        axes.set_axis_off()
    figure.suptitle(f"{found[0][1].case} at t = {scene.t[0]:g} s", fontsize=11)
    save(figure, file, dpi=110)
    return len(found)


def assemblies(scene: Scene) -> Iterator[tuple[str, Solution]]:
    """Each way to assemble a scene at its start, as the entries of its posture in words, and its
    motion at that instant.
    """
    waiting: list[Mapping[str, float]] = [scene.posture]
    many = 0
    while waiting and many < _MOST:
        posture = waiting.pop(0)
        try:
            one = replace(scene, posture=posture, t=(scene.t[0], scene.t[0], 1), wanted=("motion",))
            solution = evaluate(one, backend="vm", certificate=False)
        except PostureError as error:
            if error.assembly_modes and not any(
                name in posture and name not in scene.posture
                for way in error.assembly_modes[0]
                for name in way
            ):
                waiting = [dict(posture) | dict(way) for way in error.assembly_modes[0]] + waiting
            continue
        except AssemblyError:
            continue
        if len(solution.description["bodies"]) > _LARGE:
            return
        many += 1
        slides = {
            name for name, kind in coordinates_of(solution.description).items() if kind == "slide"
        }
        yield (
            ", ".join(
                _entry(name, value, slides=name in slides) for name, value in posture.items()
            ),
            solution,
        )


def _entry(name: str, value: float, *, slides: bool) -> str:
    return (
        f"'{name}': {value:.6g}"
        if slides
        else f"'{name}': '{round(math.degrees(value), 4) + 0.0:.6g} deg'"
    )
