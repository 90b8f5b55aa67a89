"""The search for a design, or for a front of designs, from several starts."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import Annotated, Any, overload

from ...base.arguments import public
from ...base.units import Within
from ...base.vocabulary import POINTS, Compiled
from ...errors import DeclarationError
from ...model.scene import Scene
from ...model.times import Times
from ...results.store.opening import SEARCH
from ...results.store.runs import check_target
from ..case import Case, scene_of
from ..checkpoint import Checkpoint, check_resuming
from ..sweep.workers import Executor
from .front import Front, FrontSearch
from .optimum import Optimum
from .problem import Problem, Question
from .search_file import save
from .searching import Progress, Search, by_executor, one_by_one
from .solver import Solver
from .starts import MOST, Starts

Over = Mapping[str, tuple[Any, Any]]


@overload
def optimise(
    scene: Scene | Case,
    *,
    minimise: str,
    over: Over,
    subject_to: Sequence[str] = ...,
    starts: Starts = ...,
    screen: int = ...,
    points: int = ...,
    transmission: float = ...,
    t: Times | None = ...,
    parameters: Mapping[str, float] | None = ...,
    backend: Compiled = ...,
    executor: Executor | None = ...,
    out: str | os.PathLike[str] | None = ...,
    resume: bool = ...,
    force: bool = ...,
    progress: Progress | None = ...,
) -> Optimum: ...


@overload
def optimise(
    scene: Scene | Case,
    *,
    minimise: list[str] | tuple[str, ...],
    over: Over,
    subject_to: Sequence[str] = ...,
    starts: Starts = ...,
    screen: int = ...,
    points: int = ...,
    transmission: float = ...,
    t: Times | None = ...,
    parameters: Mapping[str, float] | None = ...,
    backend: Compiled = ...,
    executor: Executor | None = ...,
    out: str | os.PathLike[str] | None = ...,
    resume: bool = ...,
    force: bool = ...,
    progress: Progress | None = ...,
) -> Front: ...


@public
def optimise(
    scene: Scene | Case,
    *,
    minimise: str | list[str] | tuple[str, ...],
    over: Over,
    subject_to: Sequence[str] = (),
    starts: Starts = 4,
    screen: Annotated[int, Within(1, MOST)] = 256,
    points: Annotated[int, Within(2, MOST)] = POINTS,
    transmission: float = 0.05,
    t: Times | None = None,
    parameters: Mapping[str, float] | None = None,
    backend: Compiled = "auto",
    executor: Executor | None = None,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Progress | None = None,
) -> Optimum | Front:
    """Find the values of parameters that minimise a peak or a mean; for several terms, their front.

    Nonlinear programs with some points of every quantity are solved by IPOPT with exact
    derivatives. Points where a limit is exceeded are added until there are none. An interrupt ends
    the search; the best design so far is returned. A design that violates a constraint is not
    ``feasible``.

    Parameters
    ----------
    scene
        A scene, or a case from :func:`.load_case`. Workers of a cluster do not need its file.
    minimise
        Minimise peak:QUANTITY, max:, mean: or rms: of one, fluctuation:effort:JOINT, or a
        parameter; of several, find the Pareto front.

        ``peak:QUANTITY`` is the largest magnitude of a quantity over the whole motion,
        ``max:QUANTITY`` its largest value; ``mean:`` and ``rms:`` are of an effort or an output;
        ``fluctuation:effort:JOINT`` is the fluctuation of energy of a drive [J]. A list asks for a
        :class:`.Front`: designs of which none is better in all of them.
    over
        Choose this parameter between two bounds, in SI units or with a unit.
    subject_to
        Keep within this limit, in SI units, as 'peak:effort:O<=12'.

        ``min:QUANTITY`` is for lower limits. Limits hold at all times of the motion, and along the
        whole link.
    starts
        Start from this number of designs.

        They are the best of designs spread evenly over the bounds, with the parameters' own values
        among them. Or values of parameters for each start.
    screen
        Choose the starts among this number of designs.
    points
        Find at most this number of points of a front.
    transmission
        Keep the sine of all transmission angles above this number.

        Of an iterated loop it is a volume.
    t
        As of :func:`.studies.evaluate.evaluate`.

        Instants may depend on parameters that are chosen.
    parameters
        Set a parameter that is not chosen, as l=0.25 or phi=30deg.
    backend
        As of :func:`.studies.sweep.sweeping.sweep`.
    executor
        Executor whose workers run the starts: one of :mod:`concurrent.futures`, or a client of
        Dask.
    out
        The file to write. A folder beside it keeps finished runs until the search ends.
    resume
        Continue a search that was stopped; start it if there is none.

        Finished runs of one that was killed are kept too.
    force
        Start anew and replace the file.

        The runs that are kept are replaced too.
    progress
        Function that is called after each step with the number of the start, the objective and the
        largest violation of a limit.

    Returns
    -------
    Optimum or Front
        The best design with its history; for several terms the front.

    Raises
    ------
    DeclarationError, UnknownNameError, ParameterError
        For mistakes in the arguments.
    NoDesignError
        If no design has a result.
    PathError, StoreError, BusyError
        If the file or the folder belongs to another search, or cannot be written.
    ClusterError
        If the executor is lost, or its workers fail or have other versions.
    """
    found_scene = scene_of(scene)
    question = Question.of(
        found_scene,
        minimise,
        over,
        subject_to,
        transmission=transmission,
        t=t,
        parameters=parameters,
        backend=backend,
    )
    check_resuming(resume, force)
    if resume and out is None:
        raise DeclarationError("resume: expected out, the file of the search that was stopped")
    engine = question.engine(found_scene)
    question = question.measured(engine.program.data)
    solver = Solver.of(question, engine)
    target = None if out is None else Path(out)
    if target is not None:
        check_target(target, SEARCH)
    options = {
        "starts": starts if isinstance(starts, int) else [dict(start) for start in starts],
        "screen": screen,
    }
    parts = None if target is None else Checkpoint.of(target, "search")
    identity = {**question.words(solver.engine), **options}
    runs = one_by_one if executor is None else partial(by_executor, executor)
    with parts.opened(identity, resume=resume, force=force) if parts else nullcontext():
        search = Search(solver, parts, runs, progress or (lambda *_: None), starts, screen)
        found: Optimum | Front
        if isinstance(minimise, str):
            problem = Problem(question.objectives[0], question.constraints)
            found, _ = search.solve(problem, search.begin(problem))
        else:
            found = FrontSearch(search, points).front()
        if parts is not None:
            search.whole(partial(_finish, found, parts))
    return found


def _finish(found: Optimum | Front, parts: Checkpoint) -> None:
    """Write the file of a search; parts stay where it was stopped."""
    save(found, parts.target)
    if not found.stopped:
        parts.clear()
