"""``lagrange-casadi animate``: the mechanism in motion, as a GIF, an MP4, an
animated SVG or glTF.
"""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Any

from ..base.files import check_writable
from ..base.vocabulary import RATE, SECONDS, WIDTH
from ..model.scene import Scene, kinds
from ..results.pictures import Film
from ..results.store.runs import load
from ..results.store.untrusted import reported_as
from ..results.verification.certificate import refuse_failed
from ..studies.case import load_case
from ..studies.evaluate import evaluate
from ..views.animation.film import check_ending, write_animation
from .echo import echo
from .options import HDF5, refuse


def animate(
    target: Path,
    *,
    out: Path | None = None,
    forces: bool = False,
    section: str = "",
    no_names: bool = False,
    width: int = WIDTH,
    rate: float = RATE,
    seconds: float = SECONDS,
    **given: Any,
) -> None:
    """Write an animation of FILE.h5 or CASE.

    It shows one cycle, again and again. A GIF works everywhere, an SVG is sharp at every size, an
    MP4 is small and needs ffmpeg. A GLB (glTF) has the solid bodies, for presentations and Blender.

    Parameters
    ----------
    target : FILE.h5|CASE
    out : FILE.gif|FILE.mp4|FILE.svg|FILE.glb
        Write the animation to this file; default: <name>.gif here.
    forces
        Draw reactions, efforts and loads as arrows.
    section : FORCE
        Draw a section force, as bending, as ribbons along the links.
    no_names
        Do not write the names of joints.
    width : PIXELS
        Set the width of the picture [pixels].
    rate : NUMBER
        Set the number of frames per second.
    seconds : NUMBER
        Set the playing time of one cycle [s].
    parameters
        As of :func:`.studies.evaluate.evaluate`: For a case: set a parameter, as l=0.25 or
        phi=30deg.
    t
        As of :func:`.studies.evaluate.evaluate`: For a case: set the instants [s], both ends
        included; default: those of the case.
    over
        As of :func:`.studies.evaluate.evaluate`.
    """
    file = target.suffix in HDF5
    refuse((file and any(given.values()), "--set, --t and --over go with a case, not with a file"))
    film = Film(width, rate, seconds, forces, section, not no_names)
    case = None if file else load_case(target)
    out = out or Path(f"{case.name if case else target.stem}.gif")
    check_ending(out)
    check_writable(out)
    solution = (
        evaluate(case.scene, wanted=_wanted(case.scene, film), **given) if case else load(target)
    )
    with reported_as("cannot be shown", target) if file else nullcontext():
        write_animation(solution, out, film)
    echo(f"wrote {out}")
    refuse_failed(solution, f"{out} shows what fails it")


def _wanted(scene: Scene, film: Film) -> list[str]:
    """Motion, and the forces that are to be shown."""
    loads = ["load"] if "load" in kinds(scene.outputs) else []
    forces = ["effort", "reaction", *loads] if film.forces else []
    return ["motion", *forces, *(["section"] if film.section else [])]
