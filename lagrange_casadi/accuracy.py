"""How far a result may be from what its formulas mean: an estimate of the error of every output.

The graphs are followed once more at some of the instants (:mod:`.interpret`), every operation with a random error as large as its
rounding, several times over (Monte Carlo arithmetic: D. S. Parker, *Monte Carlo Arithmetic*, UCLA CSD-970002, 1997). What that does
to an output is its condition, times the rounding. The result itself is one trial more, so that what a compiler or a narrower type
has made of it shows. Iterated coordinates take the corrections with them that they still want, so loops that were left half closed
show, times what they do to each output.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from .backends import Table
from .certificate import blur
from .compensated import DTYPES, ROUNDING
from .cycle_table import CycleTable
from .density import Array
from .interpret import Arithmetic, followable, interpret, numpy_arithmetic
from .scene_graph import SceneGraph
from .section_law import FORCES, SectionLaw
from .solution import Solution
from .stages import Stages, compensated

TRIALS = 8
INSTANTS = 48
_FORCES = ("effort:", "reaction:", "multiplier:", "section:")
_UNEXPLAINED = 100.0
_SUMS = 64.0
_ALONG = np.linspace(0.0, 1.0, 5)
_STEPS, _CLOSED = 20, 1e-6


def estimate(graph: SceneGraph, table: Table, solution: Solution, p: Array) -> dict[str, float]:
    """How far each quantity of a solution may be off, by full name, in its unit: the largest error over the instants.

    ``table`` are the columns that the solution was made of. Section forces are looked at from base to tip. Empty where the graphs
    call functions that cannot be followed.
    """
    if table.cycle is not None:
        return _of_cycle(graph, table.cycle, solution)
    chosen = _chosen(graph, table)
    found = disturbed(graph, table.stages, solution.t[chosen], p, table.iterated[:, chosen])
    if found is None:
        return {}
    rough = np.concatenate([found[0], np.asarray(table.out[:, chosen], float)[:, None]], axis=1)
    after, before = ({n: x[k] for k, n in enumerate(graph.columns) if not n.startswith("_")} for x in (rough, found[1]))
    errors = {name: _worst(after[name] - before[name], name in graph.wrapped) for name in after}
    exact = replace(solution, series=before, t=solution.t[chosen])
    rows = replace(solution, series={name: x.ravel() for name, x in after.items()})
    for link in solution.links_with_sections:
        for force in FORCES:
            if solution.determined(f"section:{link}:{force}"):
                off, true = (_along(of.section(link).law, force).reshape(-1, chosen.size, _ALONG.size) for of in (rows, exact))
                errors[f"section:{link}:{force}"] = _worst(off - true)
    # What underflows is in no trial.
    least = float(np.finfo(DTYPES[table.stages.precision]).tiny)
    return {name: max(error, least) for name, error in errors.items() if solution.determined(name)}


def explained(solution: Solution, residuals: Mapping[str, Array], errors: Mapping[str, float]) -> dict[str, float]:
    """The estimates, made larger where the certificate's residuals are far above what they explain.

    Such a residual is then taken for the relative error of every force: not rounding is at work, but something is wrong.
    """
    worst = max((float(np.max(values)) for values in residuals.values()), default=0.0)
    largest = {name: float(np.max(np.abs(values), initial=0.0)) for name, values in solution.series.items()}
    relative = [errors[n] / largest[n] for n in errors if n.startswith(_FORCES) and largest.get(n, 0.0) > errors[n]]
    if not errors or worst <= _UNEXPLAINED * max([*relative, blur(solution)]):
        return dict(errors)
    forces = [name for name in solution.names() if name.startswith(_FORCES) and solution.determined(name)]
    return dict(errors) | {name: max(errors[name], worst * abs(solution.peak(name).value)) for name in forces}


def _of_cycle(graph: SceneGraph, cycle: CycleTable, solution: Solution) -> dict[str, float]:
    """What the splines of a table were found to miss, and the rounding of their sums; of a section force, all parts' together."""
    # A table of singles was itself looked at for what it rounds, over its period; angles go on counting.
    rounding = _SUMS * ROUNDING["double"] if cycle.dtype.itemsize == 8 else 2 * ROUNDING["single"]
    names = [name for name in graph.columns if not name.startswith("_")]
    missed = dict(zip(cycle.columns, cycle.errors * cycle.peaks, strict=True))
    peaks = dict(zip(cycle.columns, cycle.peaks, strict=True))
    largest: dict[str, float] = {}
    for name in names:
        reached = max(float(peaks[name]), float(np.max(np.abs(solution.series[name]), initial=0.0)))
        largest[solution.unit(name)] = max(largest.get(solution.unit(name), 0.0), reached)
    errors = {name: float(missed[name]) + rounding * largest[solution.unit(name)] for name in names}
    nothing = {name: np.zeros(1) for name in solution.undetermined}
    bounds = replace(solution, series=nothing | {name: np.array([error]) for name, error in errors.items()})
    for link in bounds.links_with_sections:
        law = bounds.section(link).law
        determined = (force for force in FORCES if solution.determined(f"section:{link}:{force}"))
        errors |= {f"section:{link}:{force}": law.bound(force, _ALONG) for force in determined}
    return errors


def _chosen(graph: SceneGraph, table: Table) -> Array:
    """Instants to look at: evenly spread ones, those at which a loop is nearest to a dead centre, and where outputs peak."""
    n = table.status.size
    spread = np.linspace(0, n - 1, min(n, INSTANTS)).astype(int)
    rows = [row if name.startswith("_closure:") else -np.abs(row) for name, row in zip(graph.columns, table.out, strict=True)]
    peaks = [int(np.argmin(row)) for row in rows]
    return np.unique([*spread, *peaks])


def _along(law: SectionLaw, force: str) -> Array:
    return law.at(force, np.tile(_ALONG, (law.coefficients["n0"].size, 1)))


def _worst(gaps: Array, angle: bool = False) -> float:
    """The largest size; a trial that came to nothing, as a root of less than zero does, says nothing."""
    if angle:
        gaps = gaps - math.tau * np.rint(gaps / math.tau)
    return float(np.fmax.reduce(np.abs(gaps), axis=None, initial=0.0))


def disturbed(graph: SceneGraph, stages: Stages, t: Array, p: Array, z: Array) -> tuple[Array, Array] | None:
    """The columns at instants ``t`` with errors put in, (columns, trials, n), and in doubles without them, (columns, n).

    ``z`` (k, n) are the iterated coordinates there. None where the graphs call functions that cannot be followed.
    """
    if not all(followable(function) for function in (stages.instant, *([stages.loops] if stages.loops else []))):
        return None
    noise = _Noise(ROUNDING[stages.precision], np.random.default_rng(0), (TRIALS, t.size))
    rough, known = noise.arithmetic(DTYPES[stages.precision].type), compensated(graph, "double") if stages.compensated else stages
    values = [float(DTYPES[stages.precision].type(value)) for value in p]
    with np.errstate(all="ignore"):
        (before,) = interpret(known.instant, [*_driven(known, t, p), list(z), list(p)], numpy_arithmetic())
        if not stages.compensated and followable(stages.drive):
            driven = interpret(stages.drive, [[t], values], rough)
        else:
            trials = [_driven(stages, noise.paired(t), noise.paired(p)) for _ in range(TRIALS)]
            driven = [[noise.rounded(np.array(values)) for values in zip(*rows, strict=True)] for rows in zip(*trials, strict=True)]
        at = list(z)
        for _ in range(_STEPS if stages.loops else 0):
            correction, (size,) = interpret(stages.loops, [at, driven[0], values], rough)
            at = [noise.rounded(a + b) for a, b in zip(at, correction, strict=True)]
            if np.max(size) < _CLOSED:
                break
        (after,) = interpret(stages.instant, [*driven, at, values], rough)
    return _stack(after, (TRIALS, t.size)), _stack(before, (t.size,))


def _driven(stages: Stages, t: Array, p: Array) -> list[list[Array]]:
    """What the drive hands on at instants, in doubles."""
    if stages.precision == "single":
        pair = np.float32
        t, p = (np.concatenate([pair(x)[None], pair(x - pair(x))[None]]).astype(float) for x in (t, p))
        p = p.ravel()
    return [list(np.atleast_2d(row.full())) for row in stages.drive(t if t.ndim == 2 else t[None], p)]


def _stack(rows: list[Any], shape: tuple[int, ...]) -> Array:
    return np.array([np.broadcast_to(row, shape) for row in rows]).reshape(-1, *shape)


class _Noise:
    """Random errors as large as roundings."""

    def __init__(self, unit: float, generator: np.random.Generator, shape: tuple[int, ...]) -> None:
        self.unit, self.generator, self.shape = unit, generator, shape

    def rounded(self, value: Any, roundings: float = 1.0) -> Any:
        """A value with an error of up to so many roundings."""
        return value + value * (self.generator.random(self.shape) * (2.0 * roundings * self.unit) - roundings * self.unit)

    def paired(self, values: Array) -> Array:
        """Values with errors as large as those of a pair of numbers."""
        return values + values * (self.generator.random(values.shape) * 2.0 - 1.0) * self.unit**2

    def arithmetic(self, kind: Any) -> Arithmetic:
        """NumPy's operations with such errors, on constants of a kind."""
        return replace(numpy_arithmetic(self.rounded), constant=lambda value: float(kind(value)))
