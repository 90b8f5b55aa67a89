"""Results of a design without a compiler: those of the emitted C, by CasADi's virtual machine and
NumPy.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...base.arrays import Array
from ...base.status import Status
from ...equations.program import Program
from ...instants.backends import Evaluated, run
from ...instants.determinacy import undetermined
from ...instants.refusal import refusal
from ...instants.rung import Rung
from ...instants.signals import Quantity, Signals, section_forces
from ...instants.statistics import counted, shares
from ...summits.panels import TOPS, Listed
from .outcome import KEPT
from .reduction import KeptOutputs


def columns_of(
    graph: Program, kept: KeptOutputs, t: Array, p: Array, newton: int | None
) -> tuple[Status, Evaluated | None]:
    """The columns of a design at instants, or why it has no result; no number where friction at
    rest reaches.
    """
    if not np.isfinite(p).all():
        return Status.INVALID, None
    reduction = kept.reduction
    margins = reduction.matter(p).full().ravel()[: reduction.margins]
    if not (
        np.isfinite(margins).all()
        and (margins >= 0.0).all()
        and (margins[: reduction.positive] > 0.0).all()
    ):
        return Status.IMPOSSIBLE, None
    if not t[-1] >= t[0]:
        return Status.NO_INSTANTS, None
    rung = Rung("vm", newton=newton)
    evaluated, _ = run(graph, t, p, rung)
    why = refusal(graph, evaluated, t, p, rung)
    if why is not None:
        return why.status, None
    return Status.OK, evaluated


def outcome(
    graph: Program,
    kept: KeptOutputs,
    t: Array,
    p: Array,
    newton: int | None,
    listed: Listed | None = None,
) -> tuple[Status, dict[str, Array] | None]:
    """Results of a design, by their names in C, or the reason why it has none."""
    status, evaluated = columns_of(graph, kept, t, p, newton)
    if evaluated is None:
        return status, None
    reduction, rung = kept.reduction, Rung("vm", newton=newton)
    left_open = {graph.doubtful[output] for output in undetermined(graph, evaluated.out, p, rung)}
    doubted = {
        quantity for check, quantity in reduction.doubts if reduction.checks[check][0] in left_open
    }
    told = [k for k in range(len(reduction.units)) if k not in doubted]
    efforts = evaluated.out[[graph.outputs[effort] for effort in kept.efforts]]
    with np.errstate(all="ignore"):
        means = np.array([_means(t, effort) for effort in efforts]).reshape(-1, 2).T
    peaks, tops = (
        np.full((3, len(reduction.units)), np.nan),
        np.full((len(reduction.units), TOPS, 4), np.nan),
    )
    if told:
        signals = _signals(graph, kept, t, p, newton, evaluated, told)
        found = signals.peaks([reduction.units[k] for k in told], listed=listed)
        if not found.told.all():
            return Status.PEAK_NOT_TOLD, None
        peaks[:, told] = found.value, found.t, found.xi
        tops[told] = np.nan if found.tops is None else found.tops
    means[:, [effort not in told for effort in reduction.efforts]] = np.nan
    every = dict(zip(KEPT, (*peaks, *means), strict=True))
    return Status.OK, every | {
        "history": evaluated.out,
        "iterated": evaluated.iterated,
        "tops": tops,
    }


def _means(t: Array, values: Array) -> tuple[Any, Any]:
    """Mean and root of the mean square over the times that count, by trapezia."""
    counts = counted(values)
    weights, values = shares(np.arange(t.size, dtype=float), counts), np.where(counts, values, 0.0)
    return values @ weights, np.sqrt(values**2 @ weights)


def _signals(
    graph: Program,
    kept: KeptOutputs,
    t: Array,
    p: Array,
    newton: int | None,
    evaluated: Evaluated,
    some: Sequence[int],
) -> Signals:
    """Some quantities that are kept of a design, as curves over time."""
    description, reduction = graph.data.at(p), kept.reduction
    sections = [
        one
        for link in kept.links
        for one in section_forces(description, link, graph.outputs).values()
    ]
    quantities: list[Quantity] = [*reduction.quantities, *sections]
    return Signals(
        graph,
        evaluated.stages,
        kept.sharpness,
        [quantities[k] for k in some],
        t,
        p,
        evaluated.iterated,
        newton,
    )
