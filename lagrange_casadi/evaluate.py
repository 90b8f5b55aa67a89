"""A scene over its instants: derive, compile, evaluate, and refuse what is not a result."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from .accuracy import estimate, explained
from .backends import Table, run
from .certificate import Held, certify
from .codegen.emit import NOT_CONVERGED, OK, SLOW
from .compensated import ROUNDING, Precision
from .density import Array
from .derive import derive
from .description import describe
from .errors import AssemblyError, DeclarationError
from .grids import require
from .kinematics import where
from .rung import Backend, Rung
from .scene import Grid, Scene, checked, checked_ratios
from .scene_graph import SceneGraph
from .solution import Solution, in_order

MISFIT: dict[Precision, float] = {"double": 1e-8, "single": 1e-5}
"""How far equations that are too many may miss, of the links' length, and a row, of the size of its terms."""

_DEAD = 64.0
"""Roundings below which a closure says nothing but that it is zero."""

_NEAR = 0.3
_BESIDE = 8


def evaluate(
    scene: Scene,
    *,
    parameters: Mapping[str, float] | None = None,
    t: Grid | None = None,
    xi: Grid | None = None,
    wanted: Sequence[str] | None = None,
    backend: Backend = "auto",
    precision: Precision = "double",
    newton: int | None = None,
    table: float | None = None,
    flags: str = "",
    threads: int | None = None,
    certificate: bool = True,
) -> Solution:
    """Evaluate a scene, with its own grids and outputs or with others.

    Parameters
    ----------
    parameters
        Values that replace defaults, by name. Nothing is derived or compiled again for them.
    t, xi
        Start, stop and count of the instants [s] and of the section ratios xi/l.
    wanted
        Output names.
    backend, precision, newton, table, flags
        How it is evaluated: see :class:`.Rung`.
    threads
        How many threads share the instants; default: one a core. The result does not depend on it.
    certificate
        Whether to check the solution by :mod:`.certificate`, as far as the wanted outputs allow, and to estimate its errors by
        :mod:`.accuracy`.

    Raises :class:`AssemblyError` where a loop does not close at some instant, :class:`SizeError` where the outputs over time do not
    fit into memory, :class:`CompilerError`, and for mistakes in the arguments :class:`UnknownNameError`, :class:`ParameterError` or
    :class:`DeclarationError`.
    """
    if not isinstance(scene, Scene):
        raise DeclarationError(f"evaluate: expected a Scene, got {scene!r}")
    if threads is not None and (not isinstance(threads, int) or isinstance(threads, bool) or threads < 1):
        raise DeclarationError(f"threads: expected a whole number of at least 1, got {threads!r}")
    rung = Rung(backend, precision, newton, table, flags)
    values = scene.mechanism.values(parameters)
    start, stop, count = checked("t", scene.t if t is None else t)
    ratios = checked_ratios(scene.xi if xi is None else xi)
    for joint, law in scene.motion.items():
        low, high = law.span
        if start < low or stop > high:
            raise DeclarationError(
                f"the samples of the motion of joint '{joint}' cover t from {low:g} to {high:g} s, but t from "
                f"{start:g} to {stop:g} s is asked for"
            )
    graph = derive(scene, wanted, iterate=newton is not None)
    require("the outputs over time", (len(graph.columns) + _BESIDE, count))
    require("the grid of ratios", (ratios[2],))
    times, places = np.linspace(start, stop, count), np.linspace(*ratios)
    p = np.array(list(values.values()))
    found, provenance = run(graph, times, p, rung, threads)
    _refuse(graph, found, times, list(values.values()))
    out = np.asarray(found.out, float)
    series = {name: out[k] for k, name in enumerate(graph.columns) if not name.startswith("_")}
    loose = {name: out[k] for k, name in enumerate(graph.columns) if name.startswith("_angle:")}
    turns = {name: np.unwrap(angle) - angle for name, angle in loose.items()}
    for name, parts in graph.wrapped.items():
        for part, sign in parts.items():
            series[name] += sign * turns[part]
        series[name] -= math.tau * math.ceil(series[name][0] / math.tau - 0.5)
    series |= {name: np.full(times.size, np.nan) for name in graph.undetermined}
    description = describe(scene.mechanism, values, scene.motion)
    ordered = in_order(series, description)
    solution = Solution(scene.mechanism.name, times, places, ordered, description, provenance, graph.undetermined)
    if not certificate:
        return solution
    residuals = certify(solution, _held(graph, found))
    errors = explained(solution, residuals, estimate(graph, found, solution, p))
    return replace(solution, certificate=residuals | _condition(graph, found), errors=errors)


def _held(graph: SceneGraph, table: Table) -> list[Held] | None:
    """What multipliers do to the bodies, or None where it was not asked for, or is not determined."""
    rows = dict(zip(graph.columns, table.out, strict=True))
    parts = [[f"_held:{i}:{name}" for name in ("x", "y", "fx", "fy", "mz")] for i in range(len(graph.held))]
    if not all(name in rows for names in parts for name in names):
        return None
    return [Held(body, *(rows[name] for name in names)) for body, names in zip(graph.held, parts, strict=True)]


def _condition(graph: SceneGraph, table: Table) -> dict[str, Array]:
    """How much the loops magnify what goes into them: the worst of 1/sin(transmission angle), or for iterated loops 2/volume.

    2/volume bounds the condition number of a matrix whose columns have length one (Guggenheimer, Edelman, Johnson 1995).
    """
    worst: list[Array] = []
    for name, values in zip(graph.columns, table.out, strict=True):
        if name.startswith("_closure:"):
            worst.append(2.0 / values if graph.iterates(name.partition(":")[2]) else 1.0 / np.sqrt(values))
    return {"condition": np.max(worst, axis=0)} if worst else {}


def _refuse(graph: SceneGraph, table: Table, t: Array, p: list[float]) -> None:
    """Raise for the first instant that has no result, naming the joint and the driven coordinates."""
    bad, misfit = table.status != OK, MISFIT[table.stages.precision]
    for k, name in enumerate(graph.columns):
        if name.startswith("_closure:"):
            bad |= ~(table.out[k] > _dead(graph, table, name)) | _passes(table.out[k])
        elif name.startswith("_misfit:"):
            bad |= ~(table.out[k] <= misfit)
        elif name.startswith("_row:"):
            size = table.out[graph.columns.index(name.replace("_row:", "_rowsize:"))]
            bad |= ~(np.abs(table.out[k]) <= misfit * size)
    if not bad.any():
        return
    i = int(np.argmax(bad))
    joints = graph.scene.mechanism.joints
    driven = np.atleast_1d(graph.motion(t[i], p)[0].full().ravel())
    at = where((name, joints[name].coordinate or "", value) for name, value in zip(graph.driven, driven, strict=True))
    raise AssemblyError(_why(graph, table, i, f"at t = {t[i]:.6g} s{at}"))


def _dead(graph: SceneGraph, table: Table, closure: str) -> float:
    """Below what a closure says nothing: of a closed form it is the square of a sine, of an iterated loop as the sine itself."""
    square = _DEAD * ROUNDING[table.stages.precision]
    return math.sqrt(square) if graph.iterates(closure.partition(":")[2]) else square


def _passes(closure: Array) -> npt.NDArray[np.bool_]:
    """After which instants a loop passes a dead centre: the sine of its transmission angle meets zero, straight on from both sides.

    The closed forms keep to their branch there, with a kink; the mechanism itself may not.
    """
    found = np.zeros(closure.size, dtype=bool)
    if closure.size >= 4:
        sine = np.sqrt(np.maximum(closure, 0.0))
        left, right = 2 * sine[1:-2] - sine[:-3], 2 * sine[2:-1] - sine[3:]
        found[1:-2] = (left < 0.0) & (right < 0.0) & (np.maximum(sine[1:-2], sine[2:-1]) < _NEAR)
    return found


def _why(graph: SceneGraph, table: Table, i: int, at: str) -> str:
    if table.status[i] == NOT_CONVERGED:
        assert graph.newton is not None
        return f"the loops closed by {graph.newton.joints} did not converge {at}"
    values, misfit = dict(zip(graph.columns, table.out[:, i], strict=True)), MISFIT[table.stages.precision]
    for name, value in values.items():
        kind, _, joint = name.partition(":")
        dead = _dead(graph, table, name)
        closed = f"{'joint' if joint in graph.scene.mechanism.joints else 'constraint'} '{joint}'"
        if kind == "_closure" and value < -dead:
            if graph.iterates(joint):
                return f"the loop closed by {closed} has jumped to another branch {at}: take more instants"
            return f"the loop closed by {closed} cannot be closed {at}: its links do not reach"
        if kind == "_closure" and not value > dead:
            return f"the loop closed by {closed} is at a dead centre {at}, within rounding: its forces are not determined there"
        if kind == "_closure" and _passes(table.out[graph.columns.index(name)])[i]:
            return (
                f"the loop closed by {closed} passes a dead centre after {at.removeprefix('at ')}, and how it goes on is open; "
                "if it only comes near one, take more instants"
            )
        if kind == "_misfit" and not value <= misfit:
            return (
                f"the loops closed by {closed} are over-constrained and do not fit {at}: a gap of {value:.3g} of the links' length"
            )
        if kind == "_row" and not abs(value) <= misfit * values[f"_rowsize:{joint}"]:
            return f"the motion violates the non-holonomic row '{joint}' by {value:.6g} {at}"
    if table.status[i] == SLOW:
        assert graph.newton is not None
        return f"the loops closed by {graph.newton.joints} converge slowly {at}: they are near a dead centre"
    name = next(name for name, value in values.items() if not math.isfinite(value))
    return f"'{name}' is not finite {at}: the mechanism is singular there, or its numbers overflow"
