"""How far a result may be from what its formulas mean: an estimate of the error of every output.

The graphs are followed once more at some of the instants (:mod:`.interpret`), every operation with a random error as large as its
rounding, several times over (Monte Carlo arithmetic: D. S. Parker, *Monte Carlo Arithmetic*, UCLA CSD-970002, 1997). What that does
to an output is its condition, times the rounding. The result itself is one trial more, so that what a compiler or a narrower type
has made of it shows. Iterated coordinates take the corrections with them that they still want, so loops that were left half closed
show, times what they do to each output.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..arithmetic.compensated import DTYPES, ROUNDING
from ..declare.density import Array
from ..equations.scene_graph import SceneGraph
from ..instants.backends import Table
from ..instants.cycle_table import CycleTable
from ..instants.section_law import FORCES
from ..instants.solution import Solution
from .certificate import blur
from .disturbed import Instants, effects, openness

INSTANTS = 48
_MANY, _FIRST, _WORST = 2000, 10, 30
_CLOSED = 10.0
_FORCES = ("effort:", "reaction:", "multiplier:", "section:")
_UNEXPLAINED = 100.0
_SUMS = 64.0
_ALONG = np.linspace(0.0, 1.0, 5)


def estimate(graph: SceneGraph, table: Table, solution: Solution, p: Array) -> dict[str, float]:
    """How far each quantity of a solution may be off, by full name, in its unit: the largest error over the instants.

    ``table`` are the columns that the solution was made of. Section forces are looked at from base to tip, either side of a station
    by itself, and so is either side of a jump. Empty where the graphs call functions that cannot be followed.
    """
    if table.cycle is not None:
        return _of_cycle(graph, table.cycle, solution)
    instants = Instants(table.stages, solution.t, p, np.asarray(table.iterated, float))
    if not instants.followable:
        return {}
    found, angles = [], np.array([name in graph.wrapped for name in graph.columns])
    for some in instants.blocks(np.union1d(_chosen(graph, table), _open(instants))):
        found.append(_worst(graph, solution, *effects(instants.at(some), np.asarray(table.out[:, some], float), angles)))
    largest = {name: max(errors[name] for errors in found) for name in found[0]}
    # What was exact at all these instants may be rounded once at others; and what underflows is in no trial.
    once, least = ROUNDING[table.stages.precision], float(np.finfo(DTYPES[table.stages.precision]).tiny)
    return {name: max(least, error or once * abs(solution.peak(name).value)) for name, error in largest.items()}


def _worst(graph: SceneGraph, solution: Solution, changes: Array, columns: Array) -> dict[str, float]:
    """The largest changes, (columns, trials, n), of columns (columns, n) by the quantities of a solution.

    A trial that came to nothing, as a root of less than zero does, says nothing.
    """
    change, at = (dict(zip(graph.columns, rows, strict=True)) for rows in (changes, columns))
    names = [name for name in graph.columns if not name.startswith("_")]
    errors = {name: _largest(change[name]) for name in names}
    for link in solution.links_with_sections:
        law = solution.section(link).law
        for force, (gaps, sizes) in law.of(link, at).changed(law.of(link, change), _ALONG).items():
            # A force is itself a sum that is rounded, in doubles always.
            errors[f"section:{link}:{force}"] = max(_largest(gaps), ROUNDING["double"] * _largest(sizes))
    return {name: error for name, error in errors.items() if solution.determined(name)}


def _largest(values: Array) -> float:
    return float(np.fmax.reduce(np.abs(values), axis=None, initial=0.0))


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


def _open(instants: Instants) -> Array:
    """The instants at which iterated loops are open furthest; none where no more than rounding is left of what they want.

    Steps that are too few leave most anywhere: the first instant is closed, so the second may be the worst.
    """
    n = instants.t.size
    looked_at = np.unique([*range(min(n, _FIRST)), *np.linspace(0, n - 1, min(n, _MANY)).astype(int)])
    left = openness(instants.at(looked_at))
    return looked_at[np.argsort(left)[-_WORST:]] if np.fmax.reduce(left) > _CLOSED else looked_at[:0]
