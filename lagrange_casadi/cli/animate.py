"""``lagrange-casadi animate``: the mechanism in motion, as a GIF, an MP4, an animated SVG or glTF."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from ..animation import Film, check_ending, write_animation
from ..base.publish import check_writable
from ..case import load_case
from ..declare.even_points import EvenPoints
from ..declare.scene import Scene
from ..declare.times import Over
from ..errors import CertificateError
from ..judge.certificate import failure
from ..store.runs import load
from ..store.untrusted import told_as
from ..studies.evaluate import evaluate
from .echo import echo
from .options import PATH, instants, parameters, settings_by
from .options import over as by_drive

_FILES = (".h5", ".hdf5")
_PLAIN = Film()


@click.command()
@click.argument("target", metavar="FILE.h5|CASE", type=PATH)
@click.option(
    "--out",
    type=PATH,
    metavar="FILE.gif|FILE.mp4|FILE.svg|FILE.glb",
    help="The animation; default: <name>.gif here.",
)
@click.option("--forces", is_flag=True, help="Show reactions, efforts and loads as arrows.")
@click.option("--section", default="", metavar="FORCE", help="Show a section force, as bending, as ribbons along links.")
@click.option("--no-names", is_flag=True, help="Leave out the joints' names.")
@click.option("--width", type=int, default=_PLAIN.width, show_default=True, metavar="PIXELS", help="Width of the picture.")
@click.option("--rate", type=float, default=_PLAIN.rate, show_default=True, metavar="NUMBER", help="Frames a second.")
@click.option("--seconds", type=float, default=_PLAIN.seconds, show_default=True, metavar="NUMBER", help="What a cycle takes.")
@settings_by("Of a case: give a parameter another value.")
@instants("Of a case: instants [s]; default: its own.")
@by_drive
def animate(
    target: Path,
    out: Path | None,
    forces: bool,
    section: str,
    no_names: bool,
    width: int,
    rate: float,
    seconds: float,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    over: Over | None,
) -> None:
    """Show FILE.h5, or CASE evaluated, in motion: one cycle, which repeats, from one file that needs nothing else.

    A GIF goes everywhere, an SVG is sharp at every size, an MP4 is small and needs ffmpeg. A GLB (glTF) has the solid bodies, for
    presentations and Blender.
    """
    file = target.suffix in _FILES
    if file and (settings or t or over):
        raise click.UsageError("--set, --t and --over go with a case, not with a file")
    film = Film(width, rate, seconds, forces, section, not no_names)
    if file:
        out = out or Path(f"{target.stem}.gif")
        check_ending(out)
        check_writable(out)
        solution = load(target)
        with told_as("cannot be shown", target):
            write_animation(solution, out, film)
    else:
        if out:
            check_ending(out)
        case = load_case(target)
        out = out or Path(f"{case.name}.gif")
        check_writable(out)
        wanted = _wanted(case.scene, film)
        solution = evaluate(case.scene, parameters=parameters(settings), t=t, over=over, wanted=wanted)
        write_animation(solution, out, film)
    echo(f"wrote {out}")
    if solution.failed:
        raise CertificateError(f"{failure(solution)}; {out} shows what fails it")


def _wanted(scene: Scene, film: Film) -> list[str]:
    """Motion, and the forces that are to be shown."""
    wanted = ["motion"]
    if film.forces:
        wanted += ["effort", "reaction", *(["load"] if scene.mechanism.loads else [])]
    return [*wanted, "section"] if film.section else wanted
