"""A scene over its instants: derive, compile, evaluate, and refuse what is not a result."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..arguments import Outputs, ThreadCount
from ..base.arrays import Array
from ..base.quantities import Output
from ..base.room import cores, in_words, require
from ..declare.ends import BEYOND
from ..declare.even_points import EvenPoints, checked_ratios, points
from ..declare.giving import Elastic
from ..declare.laws import Laws
from ..declare.scene import Scene
from ..declare.times import Over, Times, Timing, instants_of, span_of
from ..declare.wanted_names import by_parameters
from ..equations.checks import Check
from ..equations.derive import compile_scene
from ..equations.model_data import ModelData
from ..equations.program import Program
from ..errors import CertificateWarning, DeclarationError, warn
from ..instants.backends import Evaluated
from ..instants.derivatives import Derivatives
from ..instants.determinacy import completed, determinate, undetermined
from ..instants.from_table import columns
from ..instants.holding import holding
from ..instants.ordering import in_order
from ..instants.phases import phases
from ..instants.refusal import refuse
from ..instants.rung import Rung, seconds
from ..instants.solution import Solution
from ..judge.accuracy import estimate, explained
from ..judge.certificate import certify, failure, tolerance
from ..sensitivity.series import series_slopes

_BESIDE, _CHECKED = 8, 2
"""Rows beside the outputs, and how many times both are in memory while they are checked."""

_LOOKED_AT = 4001
_LONG = 60.0
"""Seconds of which nothing need be said."""


def solve(
    scene: Scene,
    rung: Rung,
    *,
    parameters: Mapping[str, float] | None,
    t: Times | None,
    over: Over | None,
    xi: EvenPoints | None,
    wanted: Outputs | None,
    threads: ThreadCount | None,
    certificate: bool,
    elastic: Elastic | None,
) -> Solution:
    """Evaluate a scene by one method: see :func:`.evaluate`."""
    values = scene.values(parameters)
    timing = scene.timing(t, over)
    scene.checked(values)
    ratios = checked_ratios(scene.xi if xi is None else xi)
    scene = scene.giving(elastic)
    gives = scene.elastic
    if gives and rung.table is not None:
        raise DeclarationError(
            "elastic: a table has no place for what equilibrium leaves open; evaluate without a"
            " table"
        )
    names = scene.wanted if wanted is None else wanted
    graph = compile_scene(scene, names, parameters=values)
    rung.check(graph)
    checked_laws(graph.data, checked_span(graph.laws, timing, values), tuple(values.values()))
    require(
        "the outputs over time",
        (_CHECKED if certificate else 1, len(graph.columns) + _BESIDE, timing.count),
    )
    _announce(graph, timing.count, rung, threads or cores())
    instants, places = instants_of(graph.laws, timing, values), points(ratios)
    times = instants.t
    p = np.array(list(values.values()))
    graph.data.corners.refuse_isolated_laws(times, p.tolist())
    left_open: tuple[Output, ...] = ()
    if rung.table is not None:
        graph, left_open = determinate(graph, times, p)
    found, provenance = columns(graph, times, p, rung, threads)
    refuse(graph, found, times, p, rung)
    out = np.asarray(found.out, float)
    graph.data.corners.refuse_constraints(lambda name: graph.seen(name, out), p.tolist())
    left_open += undetermined(graph, out, p, rung)
    description = graph.data.at(p)
    elasticity, unbalanced = completed(graph, found, times, p, left_open)
    within = phases(graph, out, times, p) if certificate else {}
    outputs = outputs_of(graph, out) | {output: np.full(times.size, np.nan) for output in left_open}
    ordered = in_order(outputs, description)
    solution = Solution(
        graph.data.name,
        times,
        places,
        ordered,
        description,
        provenance,
        left_open,
        over=instants.over,
    )
    by = by_parameters(graph.data.parameters, names)
    slopes = Derivatives(series_slopes(graph, solution, p, by, rung) if by else {})
    solution = replace(
        solution, tolerance=tolerance(solution), sensitivities=slopes, elasticity=elasticity
    )
    if solution.resting.any():
        open_ = {
            name: held
            for name, held in holding(scene, solution).items()
            if np.isnan(solution.effort(name)).any()
        }
        solution = replace(solution, held=open_)
    if certificate:
        residuals = (
            _closed(graph, out, p) | residuals_of(solution, graph, out, p, within) | unbalanced
        )
        errors = explained(solution, residuals, estimate(graph, found, solution, p))
        named = {str(output): error for output, error in errors.items()}
        solution = replace(solution, certificate=residuals | _condition(graph, found), errors=named)
        if solution.failed:
            warn(f"{failure(solution)}; the solution is not certified", CertificateWarning)
    return solution


def _announce(graph: Program, count: int, rung: Rung, threads: int) -> None:
    """Warn of what takes long."""
    if rung.table is not None:
        return
    # Iterated loops are followed by one thread.
    shared = 1 if graph.newton is not None or rung.backend == "vm" else threads
    takes = seconds(graph, count, rung, interpreted=rung.backend == "vm") / shared
    if takes > _LONG:
        many, each = (
            f"{count:,}".replace(",", " "),
            "" if rung.newton is None else f" of {rung.newton} Newton steps each",
        )
        warn(f"{many} instants{each} take about {in_words(takes)}")


def checked_span(laws: Laws, timing: Timing, values: Mapping[str, float]) -> tuple[float, float]:
    """The first and the last of instants [s].

    Raises :class:`DeclarationError` where there are none, or samples of a motion end.
    """
    start, stop = span_of(laws, timing, values)
    for joint, (low, high) in zip(laws.joints, laws.spans, strict=True):
        if start < low or stop > high:
            raise DeclarationError(
                f"the samples of the motion of joint '{joint}' cover t from {low:g} to {high:g} s,"
                f" but t from {start:g} to {stop:g} s is asked for"
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
    t = np.linspace(*span, _LOOKED_AT)
    beyond = np.argwhere(~(laws.beyond(t[None], list(p)).full() <= BEYOND["double"]).T)
    if beyond.size:
        at, joint = beyond[0]
        raise DeclarationError(
            f"the motion of joint '{laws.joints[joint]}': what is put into its curve is beyond the"
            f" curve's ends at t = {t[at]:.6g} s"
        )


def outputs_of(graph: Program, out: Array) -> dict[Output, Array]:
    """The outputs among the columns ``out`` (columns, ..., t) of a graph; angles go on where they
    would jump by a turn.

    They are those columns, not copies: in ``out`` too angles go on after this.
    """
    found = {output: out[k] for output, k in graph.outputs.items()}
    parts = {
        part: out[graph.columns.index(part)]
        for signs in graph.loop_angles.values()
        for part in signs
    }
    turns = {
        part: math.tau * (row - row[..., :1]) if isinstance(part, Check) else np.unwrap(row) - row
        for part, row in parts.items()
    }
    for angle, signs in graph.loop_angles.items():
        for part, sign in signs.items():
            found[angle] += sign * turns[part]
        found[angle] -= math.tau * np.ceil(found[angle][..., :1] / math.tau - 0.5)
    return found


def residuals_of(
    solution: Solution, graph: Program, out: Array, p: Array, within: Mapping[Output, Array]
) -> dict[str, Array]:
    """Residuals of :func:`.certify` for a solution that was made of the columns ``out`` (columns,
    t) of a graph, for parameters ``p``.

    ``within`` are the angles of ``out`` without their turns (:func:`.phases`), as they were before
    the solution was made of it.
    """
    return certify(
        solution, graph.data.declared(p), _hidden(graph, out, solution.left_open), within
    )


def _hidden(graph: Program, out: Array, left_open: Sequence[Output]) -> dict[Output, Array]:
    """Forces that a solution does not give, and its certificate needs: multipliers that were not
    wanted, and what is open.
    """
    unwanted = {
        Output("multiplier", name): out[k] for name, k in graph.checks("multiplier").items()
    }
    return unwanted | {
        output: out[graph.outputs[output]] for output in left_open if output in graph.outputs
    }


def _closed(graph: Program, out: Array, p: Array) -> dict[str, Array]:
    """Residual of the loops' equations, relative to the mechanism's extent."""
    gaps = [np.abs(out[k]) / graph.extent(p) for k in graph.checks("gap").values()]
    gaps += [np.abs(out[k]) for k in graph.checks("misfit").values()]
    return {"closure": np.max(gaps, axis=0)} if gaps else {}


def _condition(graph: Program, found: Evaluated) -> dict[str, Array]:
    """Condition number of the loops, from errors of lengths or drives to those of the solution: the
    worst 1/sin(transmission angle).

    For an iterated loop it is 2/volume, the volume of its Jacobian's columns at length one.

    2/volume bounds the condition number of a matrix whose columns have length one (Guggenheimer,
    Edelman, Johnson 1995).
    """
    worst: list[Array] = []
    for name, k in graph.checks("closure").items():
        worst.append(2.0 / found.out[k] if graph.iterates(name) else 1.0 / np.sqrt(found.out[k]))
    return {"condition": np.max(worst, axis=0)} if worst else {}
