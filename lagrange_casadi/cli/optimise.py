"""``lagrange-casadi optimise``: the design for which a peak or a mean is least, within limits."""

from __future__ import annotations

import signal
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from ..studies.case import load_case
from ..studies.optimise import Optimum
from ..studies.optimise import optimise as search
from ..views.figures.optimum_figure import draw_front, draw_optimum
from ..views.shapes.picture_files import PICTURES
from .echo import echo
from .executor import executor_at
from .optimum_lines import front_lines, optimum_lines
from .options import HDF5, target
from .progress import bar_of


def optimise(
    case: Path,
    *,
    minimise: Sequence[str],
    over: Mapping[str, tuple[float | str, float | str]],
    dask: str | None = None,
    out: Path | None = None,
    figure: Path | None = None,
    **given: Any,
) -> int:
    """Find the design of CASE with the least peak or mean.

    Limits hold over the whole motion. For several terms it finds their Pareto front: designs of
    which none is better in all terms. A search that was stopped keeps the best design so far, and
    continues with --resume.

    Parameters
    ----------
    case : CASE
    minimise : TERM
        As of :func:`.studies.optimise.search.optimise`.
    over : NAME=LEAST:LARGEST
        As of :func:`.studies.optimise.search.optimise`.
    subject_to : 'TERM<=NUMBER'
        As of :func:`.studies.optimise.search.optimise`.
    starts : NUMBER
        As of :func:`.studies.optimise.search.optimise`.
    screen : NUMBER
        As of :func:`.studies.optimise.search.optimise`.
    points : NUMBER
        As of :func:`.studies.optimise.search.optimise`.
    transmission : SINE
        As of :func:`.studies.optimise.search.optimise`.
    parameters, t, backend
        As of :func:`.studies.optimise.search.optimise`.
    dask : ADDRESS
        Search on the cluster of this Dask scheduler, as tcp://HOST:8786.
    resume, force
        As of :func:`.studies.optimise.search.optimise`.
    out
        Write history and result to this HDF5 file; default: <case>_optimum.h5 here.
    figure
        Draw the history into this file; default: <case>_optimum.png here.
    """
    loaded = load_case(case)
    out = target("--out", out, f"{loaded.name}_optimum.h5", HDF5)
    figure = target("--figure", figure, f"{loaded.name}_optimum.png", PICTURES)
    with (
        nullcontext() if dask is None else executor_at(dask) as executor,
        bar_of("programs") as bar,
    ):

        def progress(start: int, objective: float, excess: float) -> None:
            bar.set_postfix_str(
                f"start {start + 1}:"
                f" {objective:.5g}{'' if excess <= 0.0 else f', beyond a limit by {excess:.1g}'}"
            )
            bar.update()

        given |= {"over": over, "out": out, "executor": executor, "progress": progress}
        terms = minimise[0] if len(minimise) == 1 else list(minimise)
        found = search(loaded, minimise=terms, **given)
    if found.stopped and hasattr(signal, "setitimer"):
        signal.setitimer(
            signal.ITIMER_REAL, 0.0
        )  # the interrupt has arrived, and is repeated no more
    scene = loaded.scene
    if isinstance(found, Optimum):
        draw_optimum(scene, found, figure)
    else:
        draw_front(scene, found, figure)
    lines = optimum_lines(found) if isinstance(found, Optimum) else front_lines(found)
    echo(*lines, f"wrote {out} and {figure}")
    return 0 if found.feasible and found.converged and not found.stopped else 1
