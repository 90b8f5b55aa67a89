"""Evidence that the histories of an evaluation are right: the residuals of their certificate, and
estimates of their errors.

The columns of a Program add what histories do not show: forces that were not wanted, and the
residuals of the loops' own equations.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...engine.instants.backends import Evaluated
from ...engine.program import Program
from ..histories import Histories
from .accuracy import estimate, explained
from .certificate import certify


def verified(
    program: Program,
    evaluated: Evaluated,
    histories: Histories,
    p: Array,
    within: Mapping[Output, Array],
    unbalanced: Mapping[str, Array],
) -> tuple[dict[str, Array], dict[str, float]]:
    """Return the residuals, each (t,), and the error of each quantity by full name, in its unit.

    ``within`` are as in :func:`residuals_of`, ``unbalanced`` the residuals of least strain energy.
    """
    out = np.asarray(evaluated.out, float)
    residuals = _closed(program, out, p) | residuals_of(histories, program, out, p, within)
    residuals |= unbalanced
    errors = explained(histories, residuals, estimate(program, evaluated, histories, p))
    named = {str(output): error for output, error in errors.items()}
    return residuals | _condition(program, out), named


def residuals_of(
    histories: Histories, program: Program, out: Array, p: Array, within: Mapping[Output, Array]
) -> dict[str, Array]:
    """Residuals of :func:`.certify` for histories that were made of the columns ``out`` (columns,
    t) of a graph, for parameters ``p``.

    ``within`` are the angles of ``out`` without their turns (:func:`.phases`), as they were before
    the histories were made of it.
    """
    stated = program.data.stated.at(p)
    return certify(histories, stated, _hidden(program, out, histories.indeterminate), within)


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


def _condition(program: Program, out: Array) -> dict[str, Array]:
    """Condition number of the loops, from errors of lengths or drives to those of the solution: the
    worst 1/sin(transmission angle).

    For an iterated loop it is 2/volume, the volume of its Jacobian's columns at length one.

    2/volume bounds the condition number of a matrix whose columns have length one (Guggenheimer,
    Edelman, Johnson 1995).
    """
    worst = [
        2.0 / out[k] if program.iterates(name) else 1.0 / np.sqrt(out[k])
        for name, k in program.checks("closure").items()
    ]
    return {"condition": np.max(worst, axis=0)} if worst else {}
