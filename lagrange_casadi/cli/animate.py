"""``lagrange-casadi animate``: the mechanism in motion, as a GIF, an MP4, an
animated SVG or glTF.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ..base.files import check_writable
from ..model.scene import Scene, kinds
from ..results.pictures import Film
from ..results.store.runs import load
from ..results.store.untrusted import reported_as
from ..results.verification.certificate import refuse_failed
from ..studies.case import load_case
from ..studies.evaluate import evaluate
from ..views.animation.film import check_ending, write_animation
from .echo import echo
from .options import HDF5


def animate(
    target: Path,
    out: Path | None,
    forces: bool,
    section: str,
    no_names: bool,
    width: int,
    rate: float,
    seconds: float,
    **given: Any,
) -> None:
    """See :func:`.commands.animate`."""
    file = target.suffix in HDF5
    if file and any(given.values()):
        raise click.UsageError("--set, --t and --over go with a case, not with a file")
    film = Film(width, rate, seconds, forces, section, not no_names)
    if file:
        out = out or Path(f"{target.stem}.gif")
        check_ending(out)
        check_writable(out)
        solution = load(target)
        with reported_as("cannot be shown", target):
            write_animation(solution, out, film)
    else:
        if out:
            check_ending(out)
        case = load_case(target)
        out = out or Path(f"{case.name}.gif")
        check_writable(out)
        scene = case.scene
        solution = evaluate(scene, wanted=_wanted(scene, film), **given)
        write_animation(solution, out, film)
    echo(f"wrote {out}")
    refuse_failed(solution, f"{out} shows what fails it")


def _wanted(scene: Scene, film: Film) -> list[str]:
    """Motion, and the forces that are to be shown."""
    wanted = ["motion"]
    if film.forces:
        wanted += ["effort", "reaction", *(kind for kind in kinds(scene.outputs) if kind == "load")]
    return [*wanted, "section"] if film.section else wanted
