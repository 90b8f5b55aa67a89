"""``lagrange-casadi optimise``: the design for which a peak or a mean is least, within limits."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
from tqdm import tqdm

from ..arguments import typed
from ..base.numerals import real
from ..base.publish import check_writable, writing
from ..base.vocabulary import BACKENDS, POINTS, Backend
from ..case import load_case
from ..declare.even_points import EvenPoints
from ..errors import DeclarationError
from ..figures.front import draw_front
from ..figures.optimum import draw_optimum
from ..shapes.pictures import PICTURES
from ..studies.optimise import Front, Optimum
from ..studies.optimise import optimise as search
from .echo import echo
from .optimum_lines import front_lines, optimum_lines
from .options import PATH, instants, parameters, settings_by

_BOUNDS = "NAME=LEAST:LARGEST"


def _bounds(text: str) -> tuple[str, tuple[float | str, float | str]]:
    """NAME=LEAST:LARGEST; numbers may have a unit, as 30deg."""
    name, _, words = (word.strip() for word in text.partition("="))
    try:
        low, high = (word if typed(word)[1] else real(word) for word in words.split(":"))
    except ValueError:
        raise click.BadParameter(f"expected {_BOUNDS}, as in l=0.15:0.4, got '{text}'") from None
    return name, (low, high)


@click.command()
@click.argument("case", type=PATH)
@click.option(
    "--minimise",
    required=True,
    multiple=True,
    metavar="TERM",
    help="peak:QUANTITY, max:, mean: or rms:, or a parameter; repeated, for their front.",
)
@click.option(
    "--over", "bounds", type=_bounds, multiple=True, required=True, metavar=_BOUNDS, help="A parameter to choose; repeatable."
)
@click.option(
    "--subject-to", "limits", multiple=True, metavar="'TERM<=NUMBER'", help="A limit, as 'peak:effort:O<=12'; repeatable."
)
@click.option("--starts", type=int, default=4, show_default=True, metavar="NUMBER", help="How many designs to start from.")
@click.option(
    "--screen", type=int, default=256, show_default=True, metavar="NUMBER", help="Among how many designs starts are chosen."
)
@click.option("--points", type=int, default=POINTS, show_default=True, metavar="NUMBER", help="Points of a front, at most.")
@click.option(
    "--transmission", type=float, default=0.05, show_default=True, metavar="SINE", help="Least sine of transmission angles."
)
@settings_by("Give another parameter a value; repeatable.")
@instants()
@click.option("--backend", type=click.Choice(BACKENDS), default="auto", show_default=True, help="What evaluates designs.")
@click.option("--dask", metavar="ADDRESS", help="Search on a cluster: its Dask scheduler, as tcp://HOST:8786.")
@click.option("--resume", is_flag=True, help="Go on with a search that was stopped; start where there is nothing.")
@click.option("--force", is_flag=True, help="Start anew, whatever is there.")
@click.option("--out", type=PATH, help="History and result, as HDF5; default: <case>_optimum.h5 here.")
@click.option("--figure", type=PATH, help="The picture; default: <case>_optimum.png here.")
def optimise(
    case: Path,
    minimise: Sequence[str],
    bounds: Sequence[tuple[str, tuple[float, float]]],
    limits: Sequence[str],
    starts: int,
    screen: int,
    points: int,
    transmission: float,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    backend: Backend,
    dask: str | None,
    resume: bool,
    force: bool,
    out: Path | None,
    figure: Path | None,
) -> int:
    """Find the design of CASE for which a peak or a mean is least, within limits that hold over the whole motion.

    Of several terms it finds their front: designs of which none is better in all of them. A search that was stopped leaves the best
    so far, and goes on with --resume.
    """
    over = dict(bounds)
    if len(over) < len(bounds):
        raise DeclarationError("over: a parameter has bounds twice")
    loaded = load_case(case)
    out, figure = out or Path(f"{loaded.name}_optimum.h5"), figure or Path(f"{loaded.name}_optimum.png")
    if out.suffix not in (".h5", ".hdf5"):
        raise click.UsageError(f"--out {out}: expected a name that ends in .h5 or .hdf5")
    check_writable(out, hdf5=True)
    if figure.suffix not in PICTURES:
        raise click.UsageError(f"--figure {figure}: expected a name that ends in {' or '.join(PICTURES)}")
    check_writable(figure)
    with tqdm(desc="programs", leave=False, disable=None) as bar:

        def progress(start: int, objective: float, excess: float) -> None:
            bar.set_postfix_str(f"start {start + 1}: {objective:.5g}{'' if excess <= 0.0 else f', beyond a limit by {excess:.1g}'}")
            bar.update()

        options: dict[str, Any] = {
            "subject_to": limits,
            "starts": starts,
            "screen": screen,
            "points": points,
            "transmission": transmission,
            "t": t,
            "parameters": parameters(settings),
            "backend": backend,
            "dask": dask,
            "out": out,
            "resume": resume,
            "force": force,
            "progress": progress,
        }
        found: Optimum | Front
        if len(minimise) == 1:
            found = search(loaded, minimise=minimise[0], over=over, **options)
        else:
            found = search(loaded, minimise=list(minimise), over=over, **options)
    if found.stopped and hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, 0.0)  # the interrupt has arrived, and is repeated no more
    with writing(figure) as (picture,):
        if isinstance(found, Optimum):
            draw_optimum(loaded.scene, found, picture, figure.suffix)
        else:
            draw_front(loaded.scene, found, picture, figure.suffix)
    for line in optimum_lines(found) if isinstance(found, Optimum) else front_lines(found):
        echo(line)
    echo(f"wrote {out} and {figure}")
    return 0 if found.feasible and found.converged and not found.stopped else 1
