"""A scene over its instants: derive, compile, evaluate, and refuse what is not a result."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output
from ..base.space import cores, in_words, require
from ..engine.derive import compile_scene
from ..engine.instants.backends import Evaluated
from ..engine.instants.determinacy import completed, determinate, undetermined
from ..engine.instants.evaluation_method import EvaluationMethod, seconds
from ..engine.instants.from_table import columns
from ..engine.instants.phases import phases
from ..engine.instants.refusal import refuse
from ..engine.model_data import ModelData
from ..engine.program import Program
from ..errors import CertificateWarning, DeclarationError, warn
from ..model.ends import BEYOND
from ..model.even_points import checked_ratios, points
from ..model.laws import Laws
from ..model.scene import Scene
from ..model.scene_arguments import Elastic
from ..model.times import Timing, instants_of, span_of
from ..model.wanted_names import by_parameters
from ..results.derivatives import Derivatives
from ..results.holding import holding
from ..results.ordering import in_order
from ..results.sensitivity.series import series_slopes
from ..results.solution import Solution
from ..results.verification.accuracy import estimate, explained
from ..results.verification.certificate import certify, failure, tolerance
from .request import Request

_BESIDE, _CHECKED = 8, 2
"""Rows beside the outputs, and how many times both are in memory while they are checked."""

_SAMPLED = 4001
_LONG = 60.0
"""Seconds of which nothing need be said."""

_ENDS = 1e-12
"""Part of the requested time by which rounding may put an end of it beyond samples: a motion is
inverted to find the times of ``over=``.
"""


def solve(
    scene: Scene,
    request: Request,
    *,
    threads: int | None = None,
    certificate: bool = True,
    elastic: Elastic | None = None,
) -> Solution:
    """Evaluate a scene: see :func:`.evaluate`."""
    method, values = request.method, scene.values(request.parameters)
    timing = scene.timing(request.t, request.over)
    scene.checked(values)
    ratios = checked_ratios(scene.xi if request.xi is None else request.xi)
    scene = scene.with_elastic(elastic)
    gives = scene.elastic
    if gives and method.table is not None:
        raise DeclarationError(
            "elastic: a table cannot hold statically indeterminate forces; evaluate without a table"
        )
    names = scene.wanted if request.wanted is None else request.wanted
    program = compile_scene(scene, names, parameters=values)
    method.check(program)
    checked_laws(program.data, checked_span(program.laws, timing, values), tuple(values.values()))
    require(
        "the outputs over time",
        (_CHECKED if certificate else 1, len(program.columns) + _BESIDE, timing.count),
    )
    _announce(program, timing.count, method, threads or cores())
    instants, places = instants_of(program.laws, timing, values), points(ratios)
    times = instants.t
    p = np.array(list(values.values()))
    program.data.corners.refuse_isolated_laws(times, p.tolist())
    indeterminate: tuple[Output, ...] = ()
    if method.table is not None:
        program, indeterminate = determinate(program, times, p)
    found, provenance = columns(program, times, p, method, threads)
    refuse(program, found, times, p, method)
    out = np.asarray(found.out, float)
    program.data.corners.refuse_constraints(lambda name: program.seen(name, out), p.tolist())
    indeterminate += undetermined(program, out, p, method)
    description = program.data.at(p)
    elasticity, unbalanced = completed(program, found, times, p, indeterminate)
    within = phases(program, out, times, p) if certificate else {}
    outputs = outputs_of(program, out) | {
        output: np.full(times.size, np.nan) for output in indeterminate
    }
    ordered = in_order(outputs, description)
    solution = Solution(
        program.data.name,
        times,
        places,
        ordered,
        description,
        provenance,
        indeterminate,
        over=instants.over,
    )
    by = by_parameters(program.data.parameters, names)
    slopes = Derivatives(series_slopes(program, solution, p, by, method) if by else {})
    solution = replace(
        solution, tolerance=tolerance(solution), sensitivities=slopes, elasticity=elasticity
    )
    if solution.resting.any():
        unknown = {
            name: held
            for name, held in holding(scene, solution).items()
            if np.isnan(solution.effort(name)).any()
        }
        solution = replace(solution, holding=unknown)
    if certificate:
        residuals = (
            _closed(program, out, p) | residuals_of(solution, program, out, p, within) | unbalanced
        )
        errors = explained(solution, residuals, estimate(program, found, solution, p))
        named = {str(output): error for output, error in errors.items()}
        solution = replace(
            solution, certificate=residuals | _condition(program, found), errors=named
        )
        if solution.failed:
            warn(f"{failure(solution)}; the solution is not certified", CertificateWarning)
    return solution


def _announce(program: Program, count: int, method: EvaluationMethod, threads: int) -> None:
    """Warn of what takes long."""
    if method.table is not None:
        return
    # Iterated loops are followed by one thread.
    shared = 1 if program.newton is not None or method.backend == "vm" else threads
    takes = seconds(program, count, method) / shared
    if takes > _LONG:
        many, each = (
            f"{count:,}".replace(",", " "),
            "" if method.newton is None else f" of {method.newton} Newton steps each",
        )
        warn(f"{many} instants{each} take about {in_words(takes)}")


def checked_span(laws: Laws, timing: Timing, values: Mapping[str, float]) -> tuple[float, float]:
    """The first and the last of instants [s].

    Raises :class:`DeclarationError` where there are none, or samples of a motion end.
    """
    start, stop = span_of(laws, timing, values)
    slack = _ENDS * (stop - start)
    for joint, (low, high) in zip(laws.joints, laws.spans, strict=True):
        if start < low - slack or stop > high + slack:
            raise DeclarationError(
                f"the samples of the motion of joint '{joint}' cover t from {low:g} to {high:g} s,"
                f" but t from {start:g} to {stop:g} s was requested"
            )
    return start, stop


@functools.lru_cache(maxsize=64)
def checked_laws(data: ModelData, span: tuple[float, float], p: tuple[float, ...]) -> None:
    """Raise :class:`DeclarationError` for a motion whose rate jumps within a span of time, for
    values of the parameters.

    Also where it puts into a curve what is beyond the curve's ends.
    """
    data.corners.refuse_laws(span, p)
    laws = data.laws
    if laws.beyond is None:
        return
    t = np.linspace(*span, _SAMPLED)
    beyond = np.argwhere(~(laws.beyond(t[None], list(p)).full() <= BEYOND["double"]).T)
    if beyond.size:
        at, joint = beyond[0]
        raise DeclarationError(
            f"the motion of joint '{laws.joints[joint]}': the argument of its curve is outside the"
            f" curve's range at t = {t[at]:.6g} s"
        )


def outputs_of(program: Program, out: Array) -> dict[Output, Array]:
    """The outputs among the columns ``out`` (columns, ..., t) of a graph; angles go on where they
    would jump by a turn.

    They are those columns, not copies: in ``out`` too angles go on after this.
    """
    unwind(program, out)
    return {output: out[k] for output, k in program.outputs.items()}


def unwind(program: Program, out: Array) -> None:
    """Let angles go on where they would jump by a turn, in the columns ``out`` (columns, ..., t)
    of a graph.
    """
    parts, angles = program.loop_rows
    revolutions = [
        math.tau * (out[k] - out[k][..., :1]) if whole else _jumps(out[k]) for k, whole in parts
    ]
    for k, signs in angles:
        angle = out[k]
        for number, sign in signs:
            angle += sign * revolutions[number]
        angle -= math.tau * np.ceil(angle[..., :1] / math.tau - 0.5)


def _jumps(angle: Array) -> Array | float:
    """Addition that lets an angle (..., t) go on where it jumps by a turn."""
    jumps = not (np.abs(angle[..., 1:] - angle[..., :-1]) < math.pi).all()
    return np.unwrap(angle) - angle if jumps else 0.0


def residuals_of(
    solution: Solution, program: Program, out: Array, p: Array, within: Mapping[Output, Array]
) -> dict[str, Array]:
    """Residuals of :func:`.certify` for a solution that was made of the columns ``out`` (columns,
    t) of a graph, for parameters ``p``.

    ``within`` are the angles of ``out`` without their turns (:func:`.phases`), as they were before
    the solution was made of it.
    """
    return certify(
        solution, program.data.declared(p), _hidden(program, out, solution.indeterminate), within
    )


def _hidden(program: Program, out: Array, indeterminate: Sequence[Output]) -> dict[Output, Array]:
    """Forces that a solution does not give, and its certificate needs: multipliers that were not
    wanted, and what is open.
    """
    unwanted = {
        Output("multiplier", name): out[k] for name, k in program.checks("multiplier").items()
    }
    return unwanted | {
        output: out[program.outputs[output]]
        for output in indeterminate
        if output in program.outputs
    }


def _closed(program: Program, out: Array, p: Array) -> dict[str, Array]:
    """Residual of the loops' equations, relative to the mechanism's extent."""
    gaps = [np.abs(out[k]) / program.extent(p) for k in program.checks("gap").values()]
    gaps += [np.abs(out[k]) for k in program.checks("misfit").values()]
    return {"closure": np.max(gaps, axis=0)} if gaps else {}


def _condition(program: Program, found: Evaluated) -> dict[str, Array]:
    """Condition number of the loops, from errors of lengths or drives to those of the solution: the
    worst 1/sin(transmission angle).

    For an iterated loop it is 2/volume, the volume of its Jacobian's columns at length one.

    2/volume bounds the condition number of a matrix whose columns have length one (Guggenheimer,
    Edelman, Johnson 1995).
    """
    worst: list[Array] = []
    for name, k in program.checks("closure").items():
        worst.append(2.0 / found.out[k] if program.iterates(name) else 1.0 / np.sqrt(found.out[k]))
    return {"condition": np.max(worst, axis=0)} if worst else {}
