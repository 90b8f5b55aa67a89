"""Golden vectors of an exported program: inputs and outputs at instants of the scene's motion, with
tolerances.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...base.arrays import Array, Operand
from ...base.interpret import Arithmetic, interpret, numpy_arithmetic
from ...base.quantities import Output, motion_names
from ...base.vocabulary import Precision
from ...engine.codegen.stages import compensated
from ...engine.compensated import ROUNDING
from ...engine.instants.backends import Evaluated, run
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.program import Program
from ...results.solution import Solution
from ...results.verification.accuracy import estimate
from .contract import FAINT, REST, Contract, largest_of

INSTANTS = 9
RATIOS = (0.0, 0.5, 1.0)
ALLOWED = 16.0
"""Estimates of the error: the same arithmetic by other compilers, libraries
and machines is within.
"""

_STEPS = 3
"""Newton steps in single precision from loops that are closed in doubles."""

_MOTION = 4096.0
"""Roundings of a motion's largest value."""


@dataclass(frozen=True, eq=False)
class Golden:
    """Instants, ``steps`` of the scene's grid apart, and there ``inputs`` (instants, inputs) and
    ``outputs`` (instants, outputs).

    ``forces`` (instants, links, ratios, forces) are those of sections. What has a tolerance has one
    a column, ``forces`` one a link and force. ``times`` and, in single precision, ``inputs`` are
    what two singles hold of a value. ``worst`` is the largest error expected of an output, of its
    largest value, and which output that is.
    """

    times: Array
    steps: int
    inputs: Array
    outputs: Array
    forces: Array
    inputs_off: Array
    outputs_off: Array
    forces_off: Array
    worst: tuple[float, str]


def golden(
    program: Program, contract: Contract, solution: Solution, exact: Solution, p: Array
) -> Golden:
    """The golden vectors of a contract, over the scene's grid and in doubles: by ``exact``, which
    saves nothing of the graph.

    ``solution`` is what the program's method makes of it: what that misses is allowed, twice.
    """
    precision = contract.precision
    least, errors = ALLOWED * ROUNDING[precision], _errors(program, precision, exact, p)
    count = solution.t.size
    stride = max(1, (count - 1) // (INSTANTS - 1))
    chosen = np.arange(0, count, stride)
    t = solution.t[chosen]
    moved = {"time": t} | motions_at(program, t, p)
    inputs = np.stack([_input(moved, m.source, precision) for m in contract.inputs], axis=1)
    whole, found = (
        np.stack([one.series[m.source] for m in contract.outputs]) for one in (exact, solution)
    )
    outputs, gaps = whole[:, chosen].T, found - whole
    wrapped = np.array([m.wrapped for m in contract.outputs])
    gaps[wrapped] -= math.tau * np.round(gaps[wrapped] / math.tau)
    saved = np.abs(gaps).max(axis=1)
    rounding = np.array([ALLOWED * errors[m.source] for m in contract.outputs])
    off = rounding + 2.0 * saved + least * np.abs(outputs).max(axis=0)
    names = contract.table.forces
    forces = np.zeros((t.size, len(contract.links), len(RATIOS), len(names)))
    forces_off = np.zeros((len(contract.links), len(names)))
    for i, link in enumerate(contract.links):
        laws = [solved.section(link.name).law for solved in (exact, solution)]
        for k, force in enumerate(names):
            true, found = (law.at(force, np.tile(RATIOS, (exact.t.size, 1))) for law in laws)
            forces[:, i, :, k] = true[chosen]
            forces_off[i, k] = (
                ALLOWED * errors[str(Output("section", link.name, force))]
                + least * np.abs(true).max()
                + 2.0 * np.abs(found - true).max()
            )
    inputs_off = _MOTION * ROUNDING[precision] * np.abs(inputs).max(axis=0)
    steps = stride if program.newton is not None else 1
    worst = _worst(contract, np.abs(whole).max(axis=1), rounding / ALLOWED + saved)
    return Golden(t, steps, inputs, outputs, forces, inputs_off, off, forces_off, worst)


def _errors(program: Program, precision: Precision, exact: Solution, p: Array) -> dict[str, float]:
    """Errors of outputs and section forces in a precision, by their names: larger in proportion to
    its roundings.

    What is a product of roundings grows with their square; so the graph is followed in that
    precision too.
    """
    errors = {
        name: error * (ROUNDING[precision] / ROUNDING["double"])
        for name, error in exact.errors.items()
    }
    if precision == "single":
        estimated = estimate(program, _in_singles(program, exact.t, p), exact, p)
        errors |= {
            str(output): max(errors[str(output)], error) for output, error in estimated.items()
        }
    return errors


def _in_singles(program: Program, t: Array, p: Array) -> Evaluated:
    """The columns of a graph in single precision, by NumPy: without a compiler."""
    evaluated, _ = run(program, t, p, EvaluationMethod("vm"))
    stages, known = compensated(program, "single"), numpy_arithmetic().operations
    singles = Arithmetic(np.float32, {code: _rounded(rule) for code, rule in known.items()})
    moment, values = ([np.float32(x), np.float32(remainder(x))] for x in (t, p))
    z: list[Any] = [*np.float32(evaluated.iterated)]
    with np.errstate(all="ignore"):
        counted, *changes = interpret(stages.drive, [moment, [*values[0], *values[1]]], singles)
        for _ in range(_STEPS):
            if stages.loops is not None:
                correction, _size = interpret(stages.loops, [z, counted, values[0]], singles)
                z = [a + b for a, b in zip(z, correction, strict=True)]
        (found,) = interpret(stages.instant, [counted, *changes, z, values[0]], singles)
    out = np.array([np.broadcast_to(row, t.shape) for row in found], float)
    return replace(evaluated, out=out, iterated=np.array(z).reshape(-1, t.size), stages=stages)


def _rounded(rule: Callable[..., Operand]) -> Callable[..., Operand]:
    return lambda *values: np.float32(rule(*values))


def remainder(values: Array) -> Array:
    """Remainder of values after rounding to single precision."""
    return np.asarray(values - values.astype(np.float32))


def _worst(contract: Contract, peaks: Array, errors: Array) -> tuple[float, str]:
    """The largest of some errors, of an output's largest value, which are its ``peaks``, where that
    is more than rounding of others of its unit.
    """
    largest = largest_of((m.unit for m in contract.outputs), peaks)
    rows = zip(errors, peaks, contract.outputs, strict=True)
    return max(
        ((float(e / p), m.name) for e, p, m in rows if p > FAINT * largest[m.unit]),
        default=(0.0, ""),
    )


def motions_at(program: Program, t: Array, p: Array) -> dict[str, Array]:
    """The motion of the drives over instants, by full names."""
    rows = np.vstack([order.full() for order in program.motion(t[None, :], p)])
    return dict(zip(itertools.chain(*motion_names(program.driven)), rows, strict=True))


def _input(moved: Mapping[str, Array], source: str, precision: Precision) -> Array:
    """The values of an input over instants; of a rest, what rounding its value to single leaves."""
    values = moved[source.removeprefix(REST)]
    if source.startswith(REST):
        return remainder(values)
    return np.asarray(values.astype(np.float32).astype(float) if precision == "single" else values)
