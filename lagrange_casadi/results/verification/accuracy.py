"""Error estimates: the distance of a result from its formulas' exact value, for every output.

The graphs are followed once more in longer numbers (:mod:`.longer`), at all instants or at many.
What a result is off there is its error: what a compiler or a narrower type has made of it shows,
and so do loops that were left half closed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...base.arrays import Array, spread
from ...base.interpret import Arithmetic, followable
from ...base.quantities import Kinds, Output
from ...engine.codegen.stages import plain
from ...engine.compensated import DTYPES, ROUNDING
from ...engine.instants.backends import Evaluated
from ...engine.instants.cycle_table import CycleTable
from ...engine.instants.refusing import resting
from ...engine.program import Program
from ..histories import Histories
from ..vector_sizes import largest, most, size_of
from .longer import LONG, long_doubles, missed
from .reference import elementwise
from .reported import blur

_LONG, _FEW, _OPERATIONS = 1000, 6, 4_000_000
"""The most evenly spread instants that are looked at in long doubles, and in many digits; and the
most operations of them all.
"""

_ALLOWED, _UNSEEN = 1.1, 2.0
"""Factors of what was seen: for what longer numbers round themselves and for sections between those
that are looked at, and for other instants too.
"""

_DIGITS = 2.0**10
"""Longer numbers round so much less."""

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
    if not all(
        map(followable, [program.instant, *([program.newton.step] if program.newton else [])])
    ):
        return {}
    chosen, factor, longer = _chosen(program, evaluated)
    out, z = (np.asarray(rows[:, chosen], float) for rows in (evaluated.out, evaluated.iterated))
    precision = evaluated.stages.precision
    stages = evaluated.stages if precision == "double" else plain(program)
    off = missed(program, stages, out, histories.t[chosen], p, z, longer)
    worst = _worst(program, histories, *off)
    unit, least = ROUNDING[precision], float(np.finfo(DTYPES[precision]).tiny)
    errors = {output: max(least, factor * error) for output, error in worst.items()}
    kinds = histories.description.kinds
    sizes = {output: most(values) for output, values in histories.outputs.items()}
    # Coefficients of section laws are in no result.
    read = {output: size for output, size in sizes.items() if not output.along}
    largest_of_unit = by_unit(kinds, read)
    for output in errors.keys() & sizes.keys():
        # The last digit is never sure; nor is, of what vanishes, that of the largest of its unit.
        size = sizes[output]
        vanishes = size <= 2.0 * errors[output]
        beside = largest_of_unit.get(output.unit(kinds), size) if vanishes else size
        errors[output] = max(errors[output], unit * beside)
    return errors


def _worst(
    program: Program, histories: Histories, changes: Array, columns: Array
) -> dict[Output, float]:
    """The largest changes of columns, both (columns, n), by the quantities of histories."""
    change, at = (
        {output: rows[k] for output, k in program.outputs.items()} for rows in (changes, columns)
    )
    errors = {output: most(values) for output, values in change.items()}
    for link in histories.links_with_sections:
        law = histories.section(link).law.of(link, at)
        off = dict(law.changed(law.of(link, change), ALONG))
        # A force is itself a sum that is rounded, in doubles always.
        rounded = {force: 2.0 * ROUNDING["double"] * law.bound(force, ALONG) for force in off}
        for force in law.table.forces:
            parts = law.table.parts("section", force)
            error = most(size_of(off[part] for part in parts))
            error += math.hypot(*(rounded[part] for part in parts))
            errors[Output("section", link, force)] = error
    if not histories.indeterminate:
        return errors
    return {output: error for output, error in errors.items() if histories.determined(output)}


def by_unit(kinds: Kinds, sizes: Mapping[Output, float]) -> dict[str, float]:
    """The largest size of any output, by unit."""
    found: dict[str, float] = {}
    for output, size in sizes.items():
        unit = output.unit(kinds)
        found[unit] = max(found.get(unit, 0.0), size)
    return found


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
    kinds = histories.description.kinds
    reached = {
        output: max(float(cycle.peaks[k]), most(histories.outputs[output]))
        for output, k in program.outputs.items()
    }
    sizes = by_unit(kinds, reached)
    errors = {
        output: float(missed[k]) + rounding * sizes[output.unit(kinds)]
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


def _chosen(program: Program, evaluated: Evaluated) -> tuple[Array, float, Arithmetic]:
    """Instants to look at, the factor of what is seen there, and the numbers to look with.

    The instants are evenly spread; if these are not all, there are those at which a loop is nearest
    to a dead centre too, and in long doubles those where columns peak.
    """
    stages, out = evaluated.stages, evaluated.out
    moving = ~resting(program, out)
    long = ROUNDING[stages.precision] >= LONG * _DIGITS
    most = min(_LONG, _OPERATIONS // stages.instructions(1)) if long else _FEW
    chosen = [*spread(moving.size, most)]
    if most < moving.size:
        dead = [k for kind in _DEAD for k in program.checks(kind).values()]
        chosen += [int(np.argmin(out[k])) for k in dead]
        chosen += [largest(row) for row in out] if long else []
    some = np.unique(chosen)
    factor = _ALLOWED if some.size == moving.size else _UNSEEN
    return some[moving[some]], factor, long_doubles() if long else elementwise()
