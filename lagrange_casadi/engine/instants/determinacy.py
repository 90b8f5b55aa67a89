"""Determinacy of forces by equilibrium, decided for the parameters and instants that are evaluated.

In a mechanism with more constraints than it needs, forces are f + s u, where u is what equilibrium
leaves open, and elasticity does not determine. A check ``open`` of a force is the size of s. A
force is determined where that is zero: by structure, and then it has no such check, in every
posture, or in one alone.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Check, Column, Output
from ...base.status import Status
from ..program import Program
from ..verdicts import bounds_of
from .backends import Evaluated, run
from .beyond_equilibrium import Elasticity
from .evaluation_method import EvaluationMethod


def undetermined(
    program: Program, out: Array, p: Array, method: EvaluationMethod
) -> tuple[Output, ...]:
    """The outputs that equilibrium leaves open at any of some instants, by the columns there,
    (columns, t).
    """
    return _beyond(
        program, {output: out[k] for output, k in program.indeterminate.items()}, p, method
    )


def completed(
    program: Program, found: Evaluated, t: Array, p: Array, indeterminate: Sequence[Output]
) -> tuple[Elasticity, dict[str, Array]]:
    """Report what least strain energy determined at instants ``t``, why some are ``indeterminate``,
    and its residual for a certificate.
    """
    completion = program.completion
    if completion is None:
        return Elasticity(), {}
    known = np.isfinite(found.out).all(axis=0)
    if not known.any():
        return Elasticity(), {}
    driven = program.motion(t[None, known], p)
    iterated = np.asarray(found.iterated, float)[:, known]
    rows = completion.function(t[None, known], *driven, iterated, p).full()
    changes, (*through, idle, chosen, unbalanced) = np.split(rows, [len(completion.doubted)])
    doubted = _beyond(
        program, dict(zip(completion.doubted, changes, strict=True)), p, EvaluationMethod()
    )
    completed_outputs = tuple(output for output in doubted if output not in indeterminate)
    reasons = (
        completion.reasons([bool(row.any()) for row in through], idle=bool(idle.any()))
        if indeterminate
        else ()
    )
    residual = np.zeros(t.size)
    residual[known] = unbalanced
    return Elasticity(completed_outputs, reasons), {"elasticity": residual} if chosen.any() else {}


def _beyond(
    program: Program, changes: Mapping[Output, Array], p: Array, method: EvaluationMethod
) -> tuple[Output, ...]:
    """The outputs that change at any of some instants by more than what is none."""
    if not changes:
        return ()
    at = program.tolerances(method.precision, method.newton, program.extent(p))
    checks = [Check("open", output) for output in changes]
    limits = [bound.verdict.limit(at) for bound in bounds_of(checks, program.data.kinds, ())]
    return tuple(
        output
        for (output, sizes), limit in zip(changes.items(), limits, strict=True)
        if np.any(sizes > limit)
    )


def determinate(
    program: Program, t: Array, p: Array, *, reusable: bool = False
) -> tuple[Program, tuple[Output, ...]]:
    """The graph without the outputs that are open at some of the instants, for parameters ``p``;
    and these outputs.

    With ``reusable`` the program keeps the check of the other outputs, for other parameters and
    instants.
    """
    if not program.indeterminate:
        return program, ()
    table, _ = run(program, t, p, EvaluationMethod("vm"))
    indeterminate = undetermined(
        program, table.out[:, table.status == Status.OK], p, EvaluationMethod()
    )
    others = (
        ()
        if reusable
        else tuple(output for output in program.indeterminate if output not in indeterminate)
    )
    return _without(
        program, (*indeterminate, *(Check("open", output) for output in (*indeterminate, *others)))
    ), indeterminate


@functools.lru_cache(maxsize=32)
def _without(program: Program, columns: tuple[Column, ...]) -> Program:
    kept = [k for k, column in enumerate(program.columns) if column not in columns]
    out = program.instant(*program.instant.sx_in())[kept]
    return program.with_columns([program.columns[k] for k in kept], out)
