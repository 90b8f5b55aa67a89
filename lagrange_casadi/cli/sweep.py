"""``lagrange-casadi sweep``: a case over many designs."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing, nullcontext
from pathlib import Path
from typing import Any

from ..base.status import Status
from ..errors import CertificateError
from ..model.notes import drawing_notes
from ..studies.case import load_case
from ..studies.sweep import Axis, Sweep, read_designs
from ..studies.sweep import sweep as carry_out
from ..studies.sweep.axes import counted, grouped
from ..studies.sweep.sweep_notes import fatigue_notes, resting_note, turning_note
from .echo import echo
from .executor import executor_at
from .options import HDF5, refuse, target
from .progress import Progress


def sweep(
    case: Path,
    *,
    grid: Mapping[str, Axis] = {},
    designs: Path | None = None,
    quiet: bool = False,
    dask: str | None = None,
    out: Path | None = None,
    **given: Any,
) -> None:
    """Compute CASE for each design of a grid or a list.

    CASE is a folder with a case.py, a Python file, or a name that the command cases lists. One HDF5
    file stores, for each design, the peaks of the outputs with their times and places, and the
    means of efforts. A sweep that was stopped continues with --resume. The commands best, table and
    plot read the file.

    lagrange-casadi sweep cases/slider_crank --grid l=0.12:0.4:57 --grid m3=0.1,0.5
    lagrange-casadi best slider_crank_sweep.h5 --minimise peak:section:rod:bending

    Parameters
    ----------
    case : CASE
    grid : NAME=START:STOP:COUNT[:log]|NAME=VALUE,...
        Sweep a parameter over a range or a list of values, in SI units or with a unit; the last
        varies fastest.
    designs : FILE.csv
        Sweep the designs of a list: one row of parameter names, then one row per design.
    parameters, t, over, xi
        As of :func:`.studies.sweep.sweeping.sweep`.
    wanted
        As of :func:`.studies.sweep.sweeping.sweep`: Compute these outputs, as info CASE lists them;
        all leaves out the motion.
    keep, peaks, fluctuation, backend, precision, newton
        As of :func:`.studies.sweep.sweeping.sweep`.
    flags, workers
        As of :func:`.studies.sweep.sweeping.sweep`.
    dask : ADDRESS
        Evaluate on the cluster of this Dask scheduler, as tcp://HOST:8786.
    resume, force, many
        As of :func:`.studies.sweep.sweeping.sweep`.
    quiet
        Show no progress.
    out
        Write the sweep to this HDF5 file; default: <case>_sweep.h5 here.
    """
    refuse(
        (
            bool(grid) == bool(designs),
            "expected either --grid, as in --grid l=0.1:0.4:31, or --designs FILE.csv",
        )
    )
    loaded = load_case(case)
    scene = loaded.scene
    out = target("--out", out, f"{loaded.name}_sweep.h5", HDF5)
    swept = read_designs(designs, scene.parameters) if designs else grid
    with (
        nullcontext() if dask is None else executor_at(dask) as executor,
        closing(Progress(quiet)) as progress,
    ):
        found = carry_out(loaded, swept, out=out, executor=executor, progress=progress, **given)
    _report(found)
    fixed, t, over = (given[name] for name in ("parameters", "t", "over"))
    turning = turning_note(scene, scene.timing(t, over), swept, fixed)
    rests = resting_note(scene, found, fixed, t=t, over=over, wanted=given["wanted"])
    notes = (*drawing_notes(found.description), rests, turning, *fatigue_notes(found))
    echo(
        *(f"note: {note}" for note in notes if note),
        (
            f"wrote {found.path}"
            if progress.begun
            else f"{found.path} was complete already: nothing was done"
        ),
    )
    if wrong := found.counts()[Status.UNCERTIFIED]:
        raise CertificateError(
            f"{counted(wrong)} of those that were checked in full, one of each block,"
            f" {'fails its' if wrong == 1 else 'fail their'} certificate: others may be wrong as"
            " well"
        )


def _report(found: Sweep) -> None:
    shape = " x ".join(str(length) for length in found.dimensions.values())
    product = f"{shape} = " if len(found.dimensions) > 1 else ""
    echo(
        f"{found.case}: {product}{counted(found.size)} over {', '.join(found.parameters)}",
        *(
            f"  {grouped(many)} without a result: {found.statuses[status][1]}"
            for status, many in found.counts().items()
            if status and many
        ),
    )
