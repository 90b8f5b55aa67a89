"""Sweeps from Python: a scene, or a case, over a grid or a list of designs."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated

from ...base.arguments import LATER, Outputs, ThreadCount, public
from ...base.vocabulary import Compiled, Keep, PeakSearch, Precision
from ...engine.instants.evaluation_method import EvaluationMethod
from ...model.even_points import EvenPoints
from ...model.scene import Scene
from ...model.times import Over, Times
from ..case import Case, reference, scene_of
from ..request import Request
from .axes import DesignsLike, designs_of
from .carrying_out import Progress, carry_out
from .plan import Plan
from .reading import Sweep, opened_sweep
from .workers import Executor, by_executor, by_threads


@public
def sweep(
    scene: Scene | Case,
    grid: Annotated[DesignsLike, LATER],
    *,
    out: str | os.PathLike[str] | None = None,
    parameters: Mapping[str, float] | None = None,
    t: Times | None = None,
    over: Over | None = None,
    xi: EvenPoints | None = None,
    wanted: Outputs | None = None,
    keep: Keep = "peaks",
    peaks: PeakSearch = "exact",
    fluctuation: bool = False,
    backend: Compiled = "auto",
    precision: Precision = "double",
    newton: Annotated[int | None, LATER] = None,
    flags: Annotated[str, LATER] = "",
    workers: ThreadCount | None = None,
    executor: Executor | None = None,
    resume: bool = False,
    force: bool = False,
    many: bool = False,
    progress: Progress | None = None,
) -> Sweep:
    """Evaluate a scene for many designs, and keep the results that size its parts.

    Nothing is compiled for a single design.

    Parameters
    ----------
    scene
        A scene, or a case from :func:`.load_case`. Workers of a cluster do not need its file.
    grid
        A mapping of parameters to axes, each a tuple (start, stop, count), a sequence of values, or
        a :class:`.Range`; or a :class:`.Listed` of designs, as :func:`.read_designs` reads it from
        CSV.
    out
        The file; default: a temporary one, removed with the result.
    parameters
        Set a parameter that is not swept, as l=0.25 or phi=30deg.
    t, over
        As of :func:`.studies.evaluate.evaluate`.

        With ``over``, or with bounds of ``t`` that are expressions of parameters, every design has
        its own times.
    wanted
        As in :func:`.evaluate`; ``all`` leaves out the motion, unless it is named too.
    xi
        Also store the peak over time of the section forces at each of these ratios xi/l.

        Start, stop and count. Of each force the value of largest magnitude over the instants.
    keep
        Store for each design its peaks only, its section laws as well, or all outputs over time as
        well.
    peaks
        Search for peaks between the instants, or take those of the instants, each with an error.

        The error of what is sampled is in ``peak_error:QUANTITY``.
    fluctuation
        Store the fluctuation of energy of each drive as well, for which a flywheel is sized.

        It is in ``fluctuation:effort:JOINT`` [J]: the largest swing of the work of its effort
        beyond that of the mean effort.
    backend
        Evaluate designs with SIMD in C++ (lanes), or with C.
    precision, newton, flags
        As of :class:`.engine.instants.evaluation_method.EvaluationMethod`.
    workers
        Use this number of threads, or send a cluster this number of blocks at a time; default: one
        per core, or 128.
    executor
        Executor whose workers evaluate instead: one of :mod:`concurrent.futures`, or a client of
        Dask.
    resume
        Continue a sweep that was stopped; start it if there is none.
    force
        Start anew and replace the file.
    many
        Allow more than 10^9 designs.
    progress
        Function that is called with the name of the present step (``designs``, after an interrupt
        ``stopping``, then ``file``), the amount that is done, and the total.

    Returns
    -------
    Sweep
        The designs with their results and statuses, read from the file when asked for.

    Raises
    ------
    DeclarationError, UnknownNameError, ParameterError, PathError
        For mistakes in the arguments.
    StoreError
        If the file belongs to another sweep, or cannot be written.
    BusyError
        If another process writes it.
    ClusterError
        If the executor is lost, or its workers fail or have other versions.
    SizeError
        If memory does not hold the results of a design.
    StoppedError
        After an interrupt; finished designs are kept.
    """
    one = scene_of(scene)
    designs = designs_of(grid, one.parameters)
    method = EvaluationMethod(backend, precision, newton, None, flags)
    request = Request(parameters, t, over, xi, wanted, method)
    plan = Plan.of(one, designs, request, keep, peaks=peaks, fluctuation=fluctuation, many=many)
    keeper = _Temporary() if out is None else None
    target = keeper.path / "sweep.h5" if keeper else Path(out or "")
    if isinstance(scene, Case) and not keeper:
        plan = replace(plan, case_file=reference(scene, target.parent))
    workforce = (
        partial(by_threads, workers)
        if executor is None
        else partial(by_executor, executor, workers)
    )
    verified = carry_out(
        plan, target, workforce, resume=resume, force=force, progress=progress or (lambda *_: None)
    )
    return opened_sweep(target, verified, keeper)


class _Temporary:
    """A folder that goes with the object."""

    def __init__(self) -> None:
        self.path = Path(tempfile.mkdtemp(prefix="lagrange_casadi-"))
        weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)
