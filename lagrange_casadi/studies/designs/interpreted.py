"""Results of a design without a compiler: those of the emitted C, by CasADi's virtual machine and
NumPy.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...base.arrays import Array
from ...base.status import Status
from ...equations.program import Program
from ...instants.backends import Evaluated, run
from ...instants.determinacy import undetermined
from ...instants.evaluation_method import EvaluationMethod
from ...instants.refusal import refusal
from ...instants.signals import Quantity, Signals, section_forces
from ...instants.statistics import counted, shares
from ...peak_search.intervals import TOPS, Listed
from .outcome import KEPT
from .reduction import KeptOutputs


def columns_of(
    program: Program, kept: KeptOutputs, t: Array, p: Array, newton: int | None
) -> tuple[Status, Evaluated | None]:
    """The columns of a design at instants, or why it has no result; no number where friction at
    rest reaches.
    """
    if not np.isfinite(p).all():
        return Status.INVALID, None
    reduction = kept.reduction
    margins = reduction.mass_properties(p).full().ravel()[: reduction.margins]
    if not (
        np.isfinite(margins).all()
        and (margins >= 0.0).all()
        and (margins[: reduction.positive] > 0.0).all()
    ):
        return Status.IMPOSSIBLE, None
    if not t[-1] >= t[0]:
        return Status.NO_INSTANTS, None
    method = EvaluationMethod("vm", newton=newton)
    evaluated, _ = run(program, t, p, method)
    why = refusal(program, evaluated, t, p, method)
    if why is not None:
        return why.status, None
    return Status.OK, evaluated


def outcome(
    program: Program,
    kept: KeptOutputs,
    t: Array,
    p: Array,
    newton: int | None,
    listed: Listed | None = None,
) -> tuple[Status, dict[str, Array] | None]:
    """Results of a design, by their names in C, or the reason why it has none."""
    status, evaluated = columns_of(program, kept, t, p, newton)
    if evaluated is None:
        return status, None
    reduction, method = kept.reduction, EvaluationMethod("vm", newton=newton)
    left_open = {
        program.indeterminate[output] for output in undetermined(program, evaluated.out, p, method)
    }
    doubted = {
        quantity
        for check, quantity in reduction.indeterminate_checks
        if reduction.checks[check][0] in left_open
    }
    determined = [k for k in range(len(reduction.units)) if k not in doubted]
    efforts = evaluated.out[[program.outputs[effort] for effort in kept.efforts]]
    with np.errstate(all="ignore"):
        means = np.array([_means(t, effort) for effort in efforts]).reshape(-1, 2).T
    peaks, tops = (
        np.full((3, len(reduction.units)), np.nan),
        np.full((len(reduction.units), TOPS, 4), np.nan),
    )
    if determined:
        signals = _signals(program, kept, t, p, newton, evaluated, determined)
        found = signals.peaks([reduction.units[k] for k in determined], listed=listed)
        if not found.resolved.all():
            return Status.PEAK_NOT_TOLD, None
        peaks[:, determined] = found.value, found.t, found.xi
        tops[determined] = np.nan if found.tops is None else found.tops
    means[:, [effort not in determined for effort in reduction.efforts]] = np.nan
    every = dict(zip(KEPT, (*peaks, *means), strict=True))
    return Status.OK, every | {
        "history": evaluated.out,
        "iterated": evaluated.iterated,
        "tops": tops,
    }


def _means(t: Array, values: Array) -> tuple[float, float]:
    """Mean and root of the mean square over the times that count, by trapezia."""
    counts = counted(values)
    weights, values = shares(np.arange(t.size, dtype=float), counts), np.where(counts, values, 0.0)
    return float(values @ weights), float(np.sqrt(values**2 @ weights))


def _signals(
    program: Program,
    kept: KeptOutputs,
    t: Array,
    p: Array,
    newton: int | None,
    evaluated: Evaluated,
    some: Sequence[int],
) -> Signals:
    """Some quantities that are kept of a design, as curves over time."""
    description, reduction = program.data.at(p), kept.reduction
    sections = [
        one
        for link in kept.links
        for one in section_forces(description, link, program.outputs).values()
    ]
    quantities: list[Quantity] = [*reduction.quantities, *sections]
    return Signals(
        program,
        evaluated.stages,
        kept.sharpness,
        [quantities[k] for k in some],
        t,
        p,
        evaluated.iterated,
        newton,
    )
