"""Designs to start from: the best of many, evenly spread, that are apart from each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, TypeAlias

import numpy as np

from ...base.status import Status
from ...base.units import Within
from ...errors import DeclarationError, NoDesignError, check_known
from .problem import Problem
from .sampled_design import EvaluatedDesign
from .solver import Solver

_APART = 0.15
"""Distance of starts from each other, relative to the bounds."""

MOST = 1 << 24
"""Designs that are screened, or started from, at most."""

Starts: TypeAlias = Annotated[int, Within(1, MOST)] | Sequence[Mapping[str, float]]
"""Number of designs to start from, or the values of parameters for each."""


def named(solver: Solver, starts: Sequence[Mapping[str, float]]) -> list[EvaluatedDesign]:
    """Starts by their values; parameters that a start lacks have their own.

    Raises :class:`UnknownNameError` and :class:`DeclarationError` for what is not chosen or not
    within bounds, and :class:`NoDesignError` where none has a result.
    """
    box, rows = solver.question.box, []
    for values in starts:
        p = box.p.copy()
        for name, value in values.items():
            check_known("parameter that is chosen", [name], box.names)
            k = box.names.index(name)
            if not box.low[k] <= value <= box.high[k]:
                raise DeclarationError(f"starts: {name} = {value!r} is not within its bounds")
            p[box.places[k]] = value
        rows.append(box.all(np.clip(box.share(p), 0.0, 1.0)))
    return _with_results(solver, found := [solver.evaluate(p) for p in rows], found)


def screen(solver: Solver, count: int) -> list[EvaluatedDesign]:
    """Designs spread evenly over the bounds, after the parameters' own values.

    They are the points of the sequence of Sobol after its origin.
    """
    from scipy.stats import qmc  # takes a second, and only searches need it

    box = solver.question.box
    points = qmc.Sobol(len(box.names), scramble=False, bits=32).fast_forward(1).random(count)
    shares = np.vstack([np.clip(box.share(box.p), 0.0, 1.0)[None], points])
    return solver.screen(np.array([box.all(x) for x in shares]))


def chosen(
    solver: Solver, problem: Problem, screened: Sequence[EvaluatedDesign], count: int
) -> list[EvaluatedDesign]:
    """The best of screened designs for a problem that are apart from each other, looked at closely.

    Raises :class:`NoDesignError` where none has a result.
    """
    box = solver.question.box
    found: list[EvaluatedDesign] = []
    for one in sorted((one for one in screened if one.has_result), key=problem.merit):
        share = box.share(one.p)
        if len(found) == count:
            break
        if all(np.abs(share - box.share(other.p)).max() >= _APART for other in found):
            closely = solver.evaluate(one.p)
            if closely.has_result:
                found.append(closely)
    return _with_results(solver, found, screened)


def _with_results(
    solver: Solver, evaluated: Sequence[EvaluatedDesign], screened: Sequence[EvaluatedDesign]
) -> list[EvaluatedDesign]:
    found = [one for one in evaluated if one.has_result]
    if not found:
        outcome = solver.engine.evaluate(np.array([one.p for one in screened]))
        values = outcome.value[outcome.status == Status.OK]
        indeterminate = np.isnan(values).all(axis=0) & bool(len(values))
        names = ", ".join(
            name
            for name, is_open in zip(solver.engine.quantities, indeterminate, strict=True)
            if is_open
        )
        failed = outcome.status[outcome.status != Status.OK]
        why = "; evaluate one to see why"
        if names:
            why = f": {names} is indeterminate for all of them"
        elif failed.size:
            why = f": {Status(int(np.bincount(failed).argmax())).meaning}"
        raise NoDesignError(f"optimise: no design within the bounds has a result{why}")
    return found
