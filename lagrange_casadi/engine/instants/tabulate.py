"""The table of a scene's cycle, with a given number of nodes, or with as
many as an accuracy takes.
"""

from __future__ import annotations

import functools
import math

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.quantities import Output
from ...base.tables import LARGEST as LARGEST_ALONG
from ...errors import DeclarationError
from ..program import Program
from .cycle_table import CycleTable, arranged, splines
from .cycle_terms import FRACTIONS, Cycle, cycle_of
from .evaluation_method import FEWEST_NODES

FEWEST, MOST = 16, 16384
"""Nodes: the first to try for an accuracy, and the most."""

LARGEST = 256_000_000
"""Bytes of a table."""

_EPSILON = 2.0**-52
_HALFWAY = np.array([1, 237, 1682, 1682, 237, 1]) / 32
"""The weights, times 120, of the six coefficients around the middle between two nodes."""


@functools.lru_cache(maxsize=32)
def tabulate(
    program: Program, p: tuple[float, ...], table: float, rates: tuple[float, float]
) -> CycleTable:
    """Tabulate a scene's cycle, for any motion of its one drive; kept while the process lasts.

    Parameters
    ----------
    program
        The compiled scene.
    p
        Parameters in the mechanism's order.
    table
        Number of nodes, from 8 to 16384. Or an accuracy between 0 and 1: nodes are then doubled,
        from 16 on, until no column's largest error, halfway between nodes and beyond rounding, is
        more than that times its peak over the cycle.
    rates
        The largest rate [rad/s] and acceleration [rad/s^2] of the motion, of either sign. A faster
        motion has errors that are larger in proportion.

    Returns
    -------
    CycleTable
        The columns at the nodes.

    Raises
    ------
    DeclarationError
        For a scene whose cycle cannot be tabulated, a motion that is not finite, an accuracy that
        is not reached, and too many nodes.
    """
    accuracy, nodes = (None, table) if isinstance(table, int) else (table, FEWEST)
    if nodes > MOST:
        raise DeclarationError(
            f"table: expected a whole number of nodes from {FEWEST_NODES} to {MOST}, or an accuracy"
            f" between 0 and 1, got {table!r}"
        )
    for output in program.outputs:
        if output.group in LARGEST_ALONG:
            raise DeclarationError(
                f"table: {output} is not a polynomial of the rate; want section:{output.part} in"
                " place of it, and evaluate strength from the solution"
            )
    if not np.isfinite(rates).all():
        raise DeclarationError(
            f"table: expected a finite rate and acceleration of the drive, got {rates!r}"
        )
    cycle = cycle_of(program, np.array(p), rates)
    values, best = cycle.values(nodes), None
    while True:
        between = cycle.values(nodes, halfway=True)
        kept = (
            np.maximum(np.abs(values).max(axis=-1), np.abs(between).max(axis=-1)) > cycle.rounding
        )
        if 8 * nodes * np.count_nonzero(kept) > LARGEST:
            if best is None:
                raise DeclarationError(
                    f"table: {nodes} nodes take more than {LARGEST // 10**6} MB; expected fewer, or"
                    " fewer outputs"
                )
            break
        values[~kept] = between[~kept] = 0.0
        found = _table(cycle, values, between, kept, rates)
        if accuracy is None or found.error <= accuracy:
            return found
        best = found if best is None or found.error < best.error else best
        if 2 * nodes > MOST:
            break
        values = np.stack((values, between), axis=-1).reshape(*values.shape[:2], -1)
        nodes = 2 * nodes
    worst = best.columns[int(np.argmax(best.errors))].removeprefix("_")
    raise DeclarationError(
        f"table: an accuracy of {accuracy:g} is not possible; the best is {best.error:.2g}, with"
        f" {best.nodes} nodes, and '{worst}' is the worst there"
    )


@functools.lru_cache(maxsize=32)
def still(program: Program, p: tuple[float, ...]) -> dict[Output, float]:
    """The stations that do not move, as ratios xi/l for parameters ``p``: a spline would round them
    to either side of a section.

    And where loads along links begin and end.
    """
    members = {("station", "station"), ("spread", "width"), ("spread", "end")}
    rows = {
        output: k
        for output, k in program.outputs.items()
        if (output.group, output.member) in members
    }
    if not rows:
        return {}
    t, *moving, parameters = program.instant.sx_in()
    changing = ca.vertcat(t, *moving)
    found = program.instant(t, *moving, parameters)[[*rows.values()]]
    depends = ca.jacobian_sparsity(found, changing).row()
    fixed = {output: k for k, output in enumerate(rows) if k not in depends}
    places = ca.substitute(found[[*fixed.values()]], changing, 0)
    values = ca.Function("still", [parameters], [places])(list(p)).full().ravel()
    return dict(zip(fixed, values.tolist(), strict=True))


def _table(
    cycle: Cycle,
    values: Array,
    between: Array,
    kept: npt.NDArray[np.bool_],
    rates: tuple[float, float],
) -> CycleTable:
    """The table through values at the nodes, and its errors by those between them, (factors,
    columns, nodes).
    """
    program = cycle.drive.program
    rate, acceleration = rates
    places = arranged(kept).terms
    coefficients = splines(
        np.array([values[place] for place in places]).reshape(len(places), values.shape[-1])
    )
    gaps = between.copy()
    for place, spline in zip(places, coefficients.T, strict=True):
        gaps[place] -= np.convolve(spline, _HALFWAY, "valid")
    peaks = np.max(
        [_reach(part, rate, acceleration).max(axis=-1) for part in (values, between)], axis=0
    )
    peaks += np.abs(cycle.drift) * cycle.period
    peaks[[k for kind in FRACTIONS for k in program.checks(kind).values()]] = 1.0
    # The rate's square and the acceleration have one unit: where there is but one, the other still
    # rounds.
    turning = max(rate**2, acceleration)
    rounding = np.array([1.0, math.sqrt(turning), turning, turning]) @ cycle.rounding
    beyond = np.maximum(_reach(gaps, rate, acceleration).max(axis=-1) - rounding, _EPSILON * peaks)
    errors = np.divide(beyond, peaks, out=np.zeros_like(beyond), where=peaks > 0.0)
    return CycleTable(
        cycle.turns, program.names, kept, coefficients, cycle.drift, rates, peaks, errors
    )


def _reach(terms: Array, rate: float, acceleration: float) -> Array:
    """The largest absolute columns (columns, n), of terms (factors, columns, n), over both signs of
    rate and acceleration.
    """
    constant, by_rate, by_square, by_acceleration = terms
    return np.asarray(
        np.abs(constant + rate**2 * by_square)
        + rate * np.abs(by_rate)
        + acceleration * np.abs(by_acceleration)
    )
