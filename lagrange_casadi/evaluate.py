"""A scene over its instants: derive, compile, evaluate, and refuse what is not a result."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from .accuracy import estimate, explained
from .backends import Table
from .certificate import Held, certify
from .codegen import cores
from .compensated import Precision
from .cost import seconds
from .density import Array
from .derive import derive
from .description import describe
from .errors import DeclarationError
from .reading import columns
from .refusal import refuse
from .room import MOST_THREADS, in_words, require
from .rung import Backend, Rung
from .scene import Grid, Scene, checked, checked_ratios, points
from .scene_graph import SceneGraph
from .solution import Solution, in_order

_BESIDE, _CHECKED = 8, 2
"""Rows beside the outputs, and how many times both are in memory while they are checked."""

_LONG = 60.0
"""Seconds of which nothing need be said."""


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
    if threads is not None and (type(threads) is not int or not 1 <= threads <= MOST_THREADS):
        raise DeclarationError(f"threads: expected a whole number from 1 to {MOST_THREADS}, got {threads!r}")
    rung = Rung(backend, precision, newton, table, flags)
    values = scene.mechanism.values(parameters)
    start, stop, count = checked_times(scene, t)
    ratios = checked_ratios(scene.xi if xi is None else xi)
    graph = derive(scene, wanted, iterate=newton is not None)
    require("the outputs over time", (_CHECKED if certificate else 1, len(graph.columns) + _BESIDE, count))
    _announce(graph, count, rung, threads or cores())
    times, places = points((start, stop, count)), points(ratios)
    p = np.array(list(values.values()))
    found, provenance = columns(graph, times, p, rung, threads)
    refuse(graph, found, times, p, rung)
    out = np.asarray(found.out, float)
    series = outputs_of(graph, out) | {name: np.full(times.size, np.nan) for name in graph.undetermined}
    description = describe(scene.mechanism, values, scene.motion)
    ordered = in_order(series, description)
    solution = Solution(scene.mechanism.name, times, places, ordered, description, provenance, graph.undetermined)
    if not certificate:
        return solution
    residuals = certify(solution, _held(graph, found))
    errors = explained(solution, residuals, estimate(graph, found, solution, p))
    return replace(solution, certificate=residuals | _condition(graph, found), errors=errors)


def _announce(graph: SceneGraph, count: int, rung: Rung, threads: int) -> None:
    """Warn of what takes long."""
    if rung.table is not None:
        return
    # Iterated loops are followed by one thread.
    shared = 1 if graph.newton is not None or rung.backend == "vm" else threads
    takes = seconds(graph, count, rung, interpreted=rung.backend == "vm") / shared
    if takes > _LONG:
        many, each = f"{count:,}".replace(",", " "), "" if rung.newton is None else f" of {rung.newton} Newton steps each"
        warnings.warn(f"{many} instants{each} take about {in_words(takes)}", stacklevel=3)


def checked_times(scene: Scene, t: Grid | None) -> Grid:
    """A grid of instants, or the scene's own, in numbers. Raises :class:`DeclarationError` where samples of a motion end before."""
    start, stop, count = checked("t", scene.t if t is None else t)
    for joint, law in scene.motion.items():
        low, high = law.span
        if start < low or stop > high:
            raise DeclarationError(
                f"the samples of the motion of joint '{joint}' cover t from {low:g} to {high:g} s, but t from "
                f"{start:g} to {stop:g} s is asked for"
            )
    return start, stop, count


def outputs_of(graph: SceneGraph, out: Array) -> dict[str, Array]:
    """The outputs among the columns ``out`` (columns, ..., t) of a graph, by name; angles go on where they would jump by a turn."""
    series = {name: out[k] for k, name in enumerate(graph.columns) if not name.startswith("_")}
    parts = {part: out[graph.columns.index(part)] for signs in graph.wrapped.values() for part in signs}
    turns = {
        name: math.tau * (row - row[..., :1]) if name.startswith("_turns:") else np.unwrap(row) - row for name, row in parts.items()
    }
    for name, signs in graph.wrapped.items():
        for part, sign in signs.items():
            series[name] += sign * turns[part]
        series[name] -= math.tau * np.ceil(series[name][..., :1] / math.tau - 0.5)
    return series


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
