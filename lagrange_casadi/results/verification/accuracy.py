"""Error estimates: the distance of a result from its formulas' exact value, for every output.

The graphs are followed once more at some of the instants (:mod:`.interpret`), every operation with
a random error as large as its rounding, several times over (Monte Carlo arithmetic: D. S. Parker,
*Monte Carlo Arithmetic*, UCLA CSD-970002, 1997). What that does to an output is its condition,
times the rounding. The result itself is one trial more, so that what a compiler or a narrower type
has made of it shows. Iterated coordinates take the corrections with them that they still want, so
loops that were left half closed show, times what they do to each output.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...base.arrays import Array, spread
from ...base.compensated import DTYPES, ROUNDING
from ...base.quantities import Output
from ...engine.instants.backends import Evaluated
from ...engine.instants.cycle_table import CycleTable
from ...engine.instants.refusing import resting
from ...engine.program import Program
from ..histories import Histories
from ..sizes import largest
from .digits import blur
from .disturbed import Instants, effects, openness

INSTANTS = 48
_MANY, _FIRST, _WORST = 2000, 10, 30
_CLOSED = 10.0
_DEAD = ("closure", "gimbal", "roll", "hold")
_FORCES = (
    "effort",
    "reaction",
    "multiplier",
    "friction",
    "section",
    "law",
    "station",
    "spread",
    "output",
)
_UNEXPLAINED = 100.0
_SUMS = 64.0
ALONG = np.linspace(0.0, 1.0, 5)
"""Ratios xi/l at which errors of section forces are looked at."""


def estimate(
    program: Program, evaluated: Evaluated, histories: Histories, p: Array
) -> dict[Output, float]:
    """Largest error over the instants of each quantity of histories, in its unit.

    ``evaluated`` has the columns that the histories were made of. Section forces are looked at from
    base to tip, either side of a station by itself, and so is either side of a jump. Empty where
    the graphs call functions that cannot be followed.
    """
    if evaluated.cycle is not None:
        return _of_cycle(program, evaluated.cycle, histories)
    instants = Instants(evaluated.stages, histories.t, p, np.asarray(evaluated.iterated, float))
    if not instants.followable:
        return {}
    found, angles = [], np.array([column in program.loop_angles for column in program.columns])
    for some in instants.blocks(np.union1d(_chosen(program, evaluated), _open(instants))):
        found.append(
            _worst(
                program,
                histories,
                *effects(instants.at(some), np.asarray(evaluated.out[:, some], float), angles),
            )
        )
    worst = (
        {output: max(errors[output] for errors in found) for output in found[0]} if found else {}
    )
    # What was exact at all these instants may be rounded once at others; and what underflows is in
    # no trial.
    once = ROUNDING[evaluated.stages.precision]
    least = float(np.finfo(DTYPES[evaluated.stages.precision]).tiny)
    return {
        output: max(least, error or once * abs(histories.peak(output).value))
        for output, error in worst.items()
    }


def _worst(
    program: Program, histories: Histories, changes: Array, columns: Array
) -> dict[Output, float]:
    """The largest changes, (columns, trials, n), of columns (columns, n) by the quantities of
    histories.

    A trial that came to nothing, as a root of less than zero does, says nothing.
    """
    change, at = (
        {output: rows[k] for output, k in program.outputs.items()} for rows in (changes, columns)
    )
    errors = {output: most(values) for output, values in change.items()}
    for link in histories.links_with_sections:
        law = histories.section(link).law
        for force, (residuals, sizes) in (
            law.of(link, at).changed(law.of(link, change), ALONG).items()
        ):
            # A force is itself a sum that is rounded, in doubles always.
            errors[Output("section", link, force)] = max(
                most(residuals), ROUNDING["double"] * most(sizes)
            )
    return {output: error for output, error in errors.items() if histories.determined(output)}


def most(values: Array) -> float:
    """The largest size among values, 0 where none is a number."""
    return float(np.fmax.reduce(np.abs(values), axis=None, initial=0.0))


def explained(
    histories: Histories, residuals: Mapping[str, Array], errors: Mapping[Output, float]
) -> dict[Output, float]:
    """The estimates, made larger where the certificate's residuals are far above what they explain.

    Such a residual is then taken for the relative error of every force: not rounding is at work,
    but something is wrong.
    """
    worst = max((float(np.max(values)) for values in residuals.values()), default=0.0)
    sizes = {output: most(values) for output, values in histories.outputs.items()}
    relative = [
        error / sizes[o]
        for o, error in errors.items()
        if o.group in _FORCES and sizes.get(o, 0.0) > error
    ]
    if not errors or worst <= _UNEXPLAINED * max([*relative, blur(histories)]):
        return dict(errors)
    forces = [
        output
        for output in histories.quantities()
        if output.group in _FORCES and histories.determined(output)
    ]
    return dict(errors) | {
        output: max(errors[output], worst * abs(histories.peak(output).value)) for output in forces
    }


def _of_cycle(program: Program, cycle: CycleTable, histories: Histories) -> dict[Output, float]:
    """Measured interpolation error of a table's splines, and the rounding of their sums; for a
    section force, the sum over its parts.
    """
    # A table of singles was itself looked at for what it rounds, over its period; angles go on
    # counting.
    rounding = _SUMS * ROUNDING["double"] if cycle.dtype.itemsize == 8 else 2 * ROUNDING["single"]
    missed = cycle.errors * cycle.peaks
    sizes: dict[str, float] = {}
    for output, k in program.outputs.items():
        reached = max(float(cycle.peaks[k]), most(histories.outputs[output]))
        sizes[histories.unit(output)] = max(sizes.get(histories.unit(output), 0.0), reached)
    errors = {
        output: float(missed[k]) + rounding * sizes[histories.unit(output)]
        for output, k in program.outputs.items()
    }
    nothing = {output: np.zeros(1) for output in histories.indeterminate}
    bounds = replace(
        histories, outputs=nothing | {output: np.array([error]) for output, error in errors.items()}
    )
    for link in bounds.links_with_sections:
        law = bounds.section(link).law
        forces = (Output("section", link, force) for force in law.table.forces)
        errors |= {
            output: law.bound(output.member, ALONG)
            for output in forces
            if histories.determined(output)
        }
    return errors


def _chosen(program: Program, evaluated: Evaluated) -> Array:
    """Instants to look at: evenly spread ones, those at which a loop is nearest to a dead centre,
    and where outputs peak.
    """
    n = evaluated.status.size
    distributed = spread(n, INSTANTS)
    closures = [k for kind in _DEAD for k in program.checks(kind).values()]
    peaks = [
        int(np.argmin(row) if k in closures else largest(row))
        for k, row in enumerate(evaluated.out)
    ]
    chosen: Array = np.unique([*distributed, *peaks])
    return np.asarray(chosen[~resting(program, evaluated.out)[chosen]])


def _open(instants: Instants) -> Array:
    """The instants at which iterated loops are open furthest; none where no more than rounding is
    left of what they want.

    Steps that are too few leave most anywhere: the first instant is closed, so the second may be
    the worst.
    """
    n = instants.t.size
    looked_at = np.unique([*range(min(n, _FIRST)), *spread(n, _MANY)])
    residual = openness(instants.at(looked_at))
    return (
        looked_at[np.argsort(residual)[-_WORST:]]
        if np.fmax.reduce(residual) > _CLOSED
        else looked_at[:0]
    )
