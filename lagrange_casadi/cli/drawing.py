"""Drawing with a progress bar, for the commands that draw; and the ways in which a mechanism can be
assembled.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

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
    skipped: list[str] = []
    drawn: list[Path] = []
    for spec, path in bar_of("figures", draw(solution, chosen, folder, si, svg), len(chosen)):
        if path:
            drawn.append(path)
        else:
            skipped.append(spec.name)
    write_index(solution.case, drawn, folder)
    if skipped:
        echo(
            f"note: not drawn, because their outputs were not evaluated: {', '.join(skipped)}",
            err=True,
        )


def drawn_ways(error: PostureError, asked: Mapping[str, object]) -> tuple[str, list[str]]:
    """Draw the ways in which an undecided loop can be assembled.

    The picture is named after the case's file, and lies beside what the command was ``asked`` to
    write, else in the current folder.

    Returns what goes behind the error, nothing where nothing can be drawn, and lines beneath it:
    the posture to paste for each picture, where the error itself does not have them.
    """
    scene = error.scene
    if not isinstance(scene, Scene) or error.lacking:
        return "", []
    path = _beside("postures.png", asked)
    with suppress(LagrangeCasadiError):
        picture, postures, complete = draw_postures(scene)
        if picture is not None:
            with writing(path) as file:
                next(frames(picture)).save(file, "PNG")
            many = f"the {len(postures)}" if complete else str(len(postures))
            words = (
                f"; {path} draws {many} of these that close{'' if len(postures) > 1 else 's'} all"
                " loops, each with its posture"
            )
            if not complete:
                words += ", and says how to get the others"
            return words, numbered(postures) if len(error.assembly_modes) > 1 else []
    return "", []


def drawn(error: LagrangeCasadiError, asked: Mapping[str, object]) -> str:
    """Draw the placement of an error, beside what the command was ``asked`` to write.

    Returns what goes behind the error, nothing where nothing can be drawn.
    """
    if error.placement is None:
        return ""
    from ..views.drawing import draw_error

    path = _beside("open.svg", asked)
    with suppress(LagrangeCasadiError):
        draw_error(error, path)
        return f"; {path} draws it"
    return ""


def _beside(ending: str, asked: Mapping[str, object]) -> Path:
    """A file named after the case that a command was asked for, beside what it was to write."""
    targets = asked.get("targets")
    first = targets[0] if isinstance(targets, tuple) and targets else None
    place = Path(str(first or asked.get("case") or asked.get("target") or "case.py")).resolve()
    return Path(str(asked.get("out") or ".")).parent / f"{name_of(place)}_{ending}"
