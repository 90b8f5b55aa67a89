"""Drawing with a progress bar, for the commands that draw; and the ways in which a mechanism can be
assembled.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..base.files import writing
from ..errors import LagrangeCasadiError, PostureError
from ..model.scene import Scene
from ..results.solution import Solution
from ..results.store.specs import Spec
from ..studies.case import name_of
from ..views.figures.posture_figures import draw_postures, numbered
from ..views.shapes.index import write_index
from ..views.shapes.pixels import frames
from .echo import echo
from .progress import bar_of


def draw_with_progress(
    solution: Solution, specs: Sequence[Spec], folder: Path, si: bool = False, svg: bool = False
) -> None:
    """Draw into a folder, with a page that shows all; what the solution lacks is said, the bar
    shows on a terminal only.
    """
    from ..views.figures.solution_figures import default_figures, draw

    chosen = specs or default_figures(solution)
    done = list(bar_of("figures", draw(solution, chosen, folder, si, svg), len(chosen)))
    write_index(solution.case, [path for _, path in done if path], folder)
    if skipped := [spec.name for spec, path in done if path is None]:
        echo(
            f"note: not drawn, because their outputs were not evaluated: {', '.join(skipped)}",
            err=True,
        )


def drawn(error: LagrangeCasadiError, asked: Mapping[str, Any]) -> tuple[str, list[str]]:
    """Draw the placement of an error, or the ways in which an undecided loop can be assembled.

    The picture is named after the case's file, and lies beside what the command was ``asked`` to
    write, else in the current folder.

    Returns what goes behind the error, nothing where nothing can be drawn, and lines beneath it:
    the posture to paste for each picture, where the error itself does not have them.
    """
    with suppress(LagrangeCasadiError):
        if isinstance(error, PostureError):
            return _drawn_ways(error, _beside("postures.png", asked))
        if error.placement is not None:
            from ..views.drawing import draw_error

            path = _beside("open.svg", asked)
            draw_error(error, path)
            return f"; {path} draws it", []
    return "", []


def _drawn_ways(error: PostureError, path: Path) -> tuple[str, list[str]]:
    """Draw the ways in which an undecided loop can be assembled: see :func:`drawn`."""
    scene = error.scene
    if not isinstance(scene, Scene) or error.lacking:
        return "", []
    picture, postures, complete = draw_postures(scene)
    if picture is None:
        return "", []
    with writing(path) as file:
        next(frames(picture)).save(file, "PNG")
    many, others = ("the ", "") if complete else ("", ", and says how to get the others")
    words = (
        f"; {path} draws {many}{len(postures)} of these that close"
        f"{'' if len(postures) > 1 else 's'} all loops, each with its posture{others}"
    )
    return words, numbered(postures) if len(error.assembly_modes) > 1 else []


def _beside(ending: str, asked: Mapping[str, Any]) -> Path:
    """A file named after the case that a command was asked for, beside what it was to write."""
    cases = (*asked.get("targets", ()), asked.get("case"), asked.get("target"), "case.py")
    place = Path(next(filter(None, cases))).resolve()
    return Path(asked.get("out") or ".").parent / f"{name_of(place)}_{ending}"
