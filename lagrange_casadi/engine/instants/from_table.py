"""A scene read from a table: its drive is evaluated, as by any method, and everything else is read
at the drive's angle.
"""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import casadi as ca
import numpy as np

from ...base.arrays import Array
from ...base.quantities import Check
from ...base.scalars import graph, inputs_of
from ...base.space import cores
from ...base.status import Status
from ...base.symbolic import symbolic
from ..program import Program
from ..threads import in_threads
from .backends import Evaluated, run, unevaluated
from .cycle_table import CycleTable
from .cycle_terms import TURNS, the_drive
from .evaluation_method import EvaluationMethod, Provenance
from .tabulate import still, tabulate

_SHARE = 1 << 14
_MARGIN = 1.01


def columns(
    program: Program,
    t: Array,
    p: Array,
    method: EvaluationMethod,
    threads: int | None = None,
    *,
    into: Evaluated | None = None,
) -> tuple[Evaluated, Provenance]:
    """The columns of a graph at instants ``t`` and parameters ``p``: evaluated, or read from a
    table, as the method says.

    ``into`` is what an earlier call with the same method and as many instants gave, to be filled
    anew. Raises :class:`DeclarationError`, with the reason, where the scene cannot be tabulated,
    and what :func:`.run` raises.
    """
    if method.table is None:
        return run(program, t, p, method, threads, into=into)
    the_drive(program)
    drive, provenance = run(drive_of(program), t, p, replace(method, table=None), threads)
    angle, rate, acceleration, *within = drive.out
    cycle = _serving(program, p, method, rate, acceleration)
    phase = within[cycle.turns - 1]
    found = into or replace(unevaluated(program, drive.stages, t.size), cycle=cycle)
    found.iterated[:] = np.nan
    found.status[:] = drive.status

    def fill(start: int) -> None:
        cut = slice(start, start + size)
        cycle.evaluate(phase[cut], rate[cut], acceleration[cut], found.out[:, cut])

    shares = max(1, min(threads or cores(), t.size // _SHARE))
    size = -(-t.size // shares)
    in_threads(fill, range(0, t.size, size), shares)
    for k in np.flatnonzero(cycle.drift):
        found.out[k] += cycle.drift[k] * (angle - phase)
    for output, place in still(program, tuple(p.tolist())).items():
        found.out[program.outputs[output]] = place
    found.status[~np.isfinite(found.out.sum(axis=0)) & (found.status == Status.OK)] = (
        Status.NOT_FINITE
    )
    return found, replace(provenance, method=method.options)


def table_of(program: Program, t: Array, p: Array, method: EvaluationMethod) -> CycleTable:
    """The table that :func:`columns` reads.

    Raises :class:`DeclarationError` where the scene cannot be tabulated.
    """
    the_drive(program)
    _, rate, acceleration, *_ = run(drive_of(program), t, p, EvaluationMethod("vm"))[0].out
    return _serving(program, p, method, rate, acceleration)


def _serving(
    program: Program, p: Array, method: EvaluationMethod, rate: Array, acceleration: Array
) -> CycleTable:
    assert method.table is not None
    cycle = tabulate(program, tuple(p), method.table, (_above(rate), _above(acceleration)))
    return _single(cycle) if method.precision == "single" else cycle


_single = functools.lru_cache(maxsize=32)(CycleTable.single)


@symbolic
@functools.lru_cache(maxsize=32)
def drive_of(program: Program) -> Program:
    """The graph of the one drive alone: its angle, rate and acceleration, and the angle within one
    turn, two, and so on.
    """
    given = inputs_of(program.instant) | {"z": ca.SX(0, 1)}
    d = given["d"]
    within = [
        d - math.tau * (revolutions * ca.floor(d * (1 / (revolutions * math.tau))))
        for revolutions in range(1, TURNS + 1)
    ]
    out = ca.vertcat(d, given["d_rate"], given["d_acceleration"], *within)
    instant = graph("instant", given, out=out)
    columns = (
        "angle",
        "rate",
        "acceleration",
        *(f"within_{revolutions}" for revolutions in range(1, TURNS + 1)),
    )
    return replace(
        program,
        instant=instant,
        newton=None,
        columns=tuple(Check("drive", name) for name in columns),
        loop_angles={},
    )


def _above(values: Array) -> float:
    """A little more than the largest size: a table serves motions that are
    nearly as fast as well.
    """
    return float(f"{_MARGIN * np.max(np.abs(values), initial=0.0):.2e}")
