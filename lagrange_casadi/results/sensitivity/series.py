"""Derivatives of all histories by parameters: of series over time, of section forces over
time and xi/l.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import casadi as ca
import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output, parts_along
from ...base.scalars import graph
from ...base.space import require
from ...base.symbolic import symbolic
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.program import Program
from ...engine.reciprocals import differentiable
from ..histories import Histories
from ..section_laws import made_of
from .jacobian import section_slopes, total
from .slopes import Batch, Loops

_BLOCK = 1 << 20
"""Numbers of one argument that are made ready at once."""


def series_slopes(
    program: Program, histories: Histories, p: Array, by: Sequence[str], method: EvaluationMethod
) -> dict[str, dict[Output, Array]]:
    """The derivatives by each of some parameters of all that equilibrium determines of the
    histories of a graph, by output.

    Series have (t,), section forces (t, xi); instants and ratios stand still. They are always made
    in doubles, by the compiler of a method, at loops that are closed. Where a quantity is NaN, so
    are they. Raises :class:`.SizeError` where they do not fit into memory.
    """
    series = [o for o in histories.quantities() if o.group != "section" and histories.determined(o)]
    rows = [o for o in histories.outputs if (o in series or o.along) and o in program.outputs]
    sections = len(histories.table.forces) * len(histories.links_with_sections)
    require(
        "the sensitivities", (len(by), histories.t.size, len(rows) + sections * histories.xi.size)
    )
    numbers = [list(program.data.parameters).index(name) for name in by]
    columns = np.moveaxis(at_instants(program, rows, histories.t, p, numbers, method), 1, 0)
    found = {
        output: np.where(np.isnan(histories.outputs[output])[:, None], np.nan, column)
        for output, column in zip(rows, columns, strict=True)
    }
    changes = {output: found[output][:, 1:] for output in series}
    for link in histories.links_with_sections:
        changes |= dict(_along(program, histories, link, found, p, numbers, method))
    return {
        name: {output: np.ascontiguousarray(values[..., k]) for output, values in changes.items()}
        for k, name in enumerate(by)
    }


@symbolic
def at_instants(
    program: Program,
    rows: Sequence[Output],
    t: Array,
    p: Array,
    by: Sequence[int],
    method: EvaluationMethod,
) -> Array:
    """Rows of a graph at instants, and their derivatives, (t, rows, 1 + parameters)."""
    numbers = [program.outputs[output] for output in rows]
    slopes = total(program, numbers, by)
    time, *_, z, values = slopes.sx_in()
    inputs = time, *program.motion.call([time, values]), z, values
    both = ca.vertcat(differentiable(program.instant)(*inputs)[numbers].T, slopes(*inputs))
    function = graph("at_once", {"t": time, "z": z, "p": values}, found=both)
    place = Loops.of(program, method).at(t, p, t)
    given = {"t": (t[:, None], 1), "z": (place, 1), "p": (p[None], 0)}
    found = Batch.of(function, method).at(t.size, given)
    return found.reshape(t.size, len(rows), 1 + len(by))


def _along(
    program: Program,
    histories: Histories,
    link: str,
    found: Mapping[Output, Array],
    p: Array,
    by: Sequence[int],
    method: EvaluationMethod,
) -> Iterator[tuple[Output, Array]]:
    """Derivatives of the section forces of a link that are determined, each (t, xi, parameters)."""
    table, indeterminate = histories.table, histories.indeterminate
    columns = [*parts_along(histories.outputs, link)]
    function = section_slopes(program.data, link, columns, by)
    batch, xi, forces = Batch.of(function, method), histories.xi, table.forces
    grids = np.empty((histories.t.size, xi.size, len(forces), len(by)))
    unknown = np.full((histories.t.size, 1 + len(by)), np.nan)
    both = np.stack([found.get(column, unknown) for column in columns], axis=1)
    values, changes = both[:, :, 0], both[:, :, 1:]
    height = max(1, _BLOCK // (xi.size * function.numel_in("slopes")))
    for start in range(0, histories.t.size, height):
        some = slice(start, start + height)
        many = values[some].shape[0]
        given = {
            "columns": (values[some], xi.size),
            "slopes": (changes[some].reshape(many, -1), xi.size),
            "xi": (np.tile(xi, many)[:, None], 1),
            "p": (p[None], 0),
        }
        grids[some] = batch.at(many * xi.size, given).reshape(many, xi.size, len(forces), len(by))
    for k, force in enumerate(forces):
        if not made_of(indeterminate, link, force, table):
            yield Output("section", link, force), grids[:, :, k]
