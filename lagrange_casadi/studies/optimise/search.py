"""The search for a design, or for a front of designs, from several starts."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, overload

from ...arguments import public
from ...base.publish import uninterrupted
from ...base.units import Within
from ...base.vocabulary import POINTS, Backend
from ...case import Case, scene_of
from ...declare.scene import Scene
from ...declare.times import Times
from ...errors import DeclarationError
from ...methods import method
from ...store.runs import check_target
from .executors import Executor, LocalExecutor
from .file import SCHEMA, save
from .front import Front, front_of
from .journal import kept
from .optimum import Optimum
from .problem import Problem, Question
from .searching import Progress, Search
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
    backend: Backend = ...,
    dask: str | None = ...,
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
    backend: Backend = ...,
    dask: str | None = ...,
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
    backend: Backend = "auto",
    dask: str | None = None,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Progress | None = None,
) -> Optimum | Front:
    """Find the values of parameters for which a peak, or a mean, is least; of several terms, their
    front.

    Parameters
    ----------
    scene
        A scene, or a case from :func:`.load_case`. Workers of a cluster need no file of it: they
        are sent what is derived.
    minimise
        ``peak:QUANTITY``, the largest size of a quantity over the whole motion; ``max:QUANTITY``,
        its largest value; ``mean:`` or ``rms:`` of an effort or an output; or a parameter's name. A
        list of them asks for a :class:`.Front`: designs of which none is better in all of them.
    over
        The parameters to choose, and of each its least and its largest value.
    subject_to
        Constraints, as ``"peak:effort:O <= 12"``; ``min:QUANTITY`` is for those from below. They
        hold at all times of the motion, and along the whole link.
    starts
        How many designs the search starts from: the best of designs spread evenly over the bounds,
        with the parameters' own values among them. Or values of parameters for each start.
    screen
        Among how many designs the starts are chosen.
    points
        How many points a front has at most.
    transmission
        The least sine of a loop's transmission angle, of an iterated loop its volume.
    t
        Instants, as in :func:`.evaluate`; they may go with parameters that are chosen.
    parameters
        Values of the parameters that are not chosen.
    dask
        The address of a Dask scheduler, whose workers go the ways from the starts.
    out
        The file to write. Beside it a journal keeps what is done, until all is: a search that was
        stopped, or killed, goes on with ``resume``; ``force`` starts it anew.
    progress
        Is called after each step with the number of the start, the objective and the worst excess
        over a limit.

    Notes ----- Programs with some points of every quantity are solved by IPOPT with exact
    derivatives. What exceeds a limit elsewhere is added to them, until nothing does. An interrupt
    ends the search; the best design so far is given. One that violates a constraint is marked: it
    is not ``feasible``.

    Raises :class:`DeclarationError`, :class:`UnknownNameError` and :class:`ParameterError` for
    mistakes in the arguments, :class:`NoDesignError` where no design has a result,
    :class:`PathError`, :class:`StoreError` or :class:`BusyError` where the file or its journal is
    another search's or cannot be written, :class:`ClusterError` where a cluster cannot serve.
    """
    own = scene_of(scene)
    question = Question.of(
        own,
        minimise,
        over,
        subject_to,
        transmission=transmission,
        t=t,
        parameters=parameters,
        backend=backend,
    )
    if resume and force:
        raise DeclarationError(
            "resume and force exclude each other: continue with what is there, or start anew"
        )
    if resume and out is None:
        raise DeclarationError("resume: expected out, the file of the search that was stopped")
    executor: Executor = LocalExecutor() if dask is None else method("optimise.dask")(dask)
    solver = Solver.of(question, question.engine(own))
    target = None if out is None else Path(out)
    if target is not None:
        check_target(target, SCHEMA)
    options = {
        "starts": starts if isinstance(starts, int) else [dict(start) for start in starts],
        "screen": screen,
    }
    with kept(
        target, {**question.words(solver.engine), **options}, resume=resume, force=force
    ) as journal:
        search = Search(solver, journal, executor, progress or (lambda *_: None), starts, screen)
        found: Optimum | Front
        if isinstance(minimise, str):
            problem = Problem(question.objectives[0], question.constraints)
            found = search.solve(problem, search.begin(problem))
        else:
            found = front_of(search, points)
        if target is not None:
            try:
                with uninterrupted():
                    save(found, target)
                    if not found.stopped:
                        journal.remove()
            except KeyboardInterrupt:  # it came when there was nothing left to interrupt
                pass
    return found
