"""Many designs without a compiler: what the C gives, by CasADi's virtual machine and NumPy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.status import Status
from ...engine.instants.backends import Evaluated, Interpreter, run
from ...engine.instants.determinacy import undetermined
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.instants.refusal import refusal
from ...engine.peak_search.intervals import TOPS, Listed
from ...engine.program import Program
from ...results.signals import Quantity, Signals, section_forces
from ...results.statistics import counted, shares
from .outcome import KEPT, Results
from .reduction import KeptOutputs


@dataclass(frozen=True, eq=False)
class InterpretedDesigns:
    """CasADi's virtual machine and NumPy in the place of a :class:`.codegen.Library` of many
    designs.
    """

    program: Program
    kept: KeptOutputs
    newton: int | None
    sampled: bool = False

    def designs(
        self,
        t: Array,
        bent: npt.NDArray[np.bool_],
        p: Array,
        results: Results,
        threads: int = 1,
        listed: Listed | None = None,
    ) -> None:
        """Fill ``results`` as :meth:`.Library.designs` does, one design after another."""
        peaks = results.get("value") is not None
        for i, row in enumerate(p):
            status, design = self._design(t[min(i, len(t) - 1)], row, peaks, listed)
            results["status"][i] = status
            for name, array in results.items():
                if name != "status" and array is not None:
                    array[i] = np.nan if design is None else design[name]

    def bound(
        self,
        t: Array,
        bent: npt.NDArray[np.bool_],
        p: Array,
        results: Results,
        listed: Listed | None = None,
    ) -> Callable[[], None]:
        """Return a function that fills ``results``, as :meth:`.Library.bound` does."""
        return partial(self.designs, t, bent, p, results, listed=listed)

    def _design(
        self, t: Array, p: Array, peaks: bool, listed: Listed | None
    ) -> tuple[Status, dict[str, Array] | None]:
        """Results of a design by their names in C, or the reason why it has none."""
        status = self._parts(t, p)
        if status != Status.OK:
            return status, None
        method = EvaluationMethod("vm", newton=self.newton)
        evaluated, _ = run(self.program, t, p, method)
        why = refusal(self.program, evaluated, t, p, method)
        if why is not None:
            return why.status, None
        series = {"history": evaluated.out, "iterated": evaluated.iterated}
        if not peaks:
            return Status.OK, series
        kept = self._reduced(t, p, evaluated, method, listed)
        return (Status.PEAK_NOT_TOLD, None) if kept is None else (Status.OK, series | kept)

    def _parts(self, t: Array, p: Array) -> Status:
        """Return ``OK`` where there are such parts and instants, or why not."""
        if not np.isfinite(p).all():
            return Status.INVALID
        reduction = self.kept.reduction
        margins = reduction.mass_properties(p).full().ravel()[: reduction.margins]
        positive = margins[: reduction.positive]
        if not (np.isfinite(margins).all() and (margins >= 0.0).all() and (positive > 0.0).all()):
            return Status.IMPOSSIBLE
        return Status.OK if t[-1] >= t[0] else Status.NO_INSTANTS

    def _reduced(
        self,
        t: Array,
        p: Array,
        evaluated: Evaluated,
        method: EvaluationMethod,
        listed: Listed | None,
    ) -> dict[str, Array] | None:
        """Peaks and means of a design that has a result; None if a peak cannot be located."""
        program, reduction = self.program, self.kept.reduction
        indeterminate = {
            program.indeterminate[output]
            for output in undetermined(program, evaluated.out, p, method)
        }
        doubted = {
            quantity
            for check, quantity in reduction.indeterminate_checks
            if reduction.checks[check][0] in indeterminate
        }
        determined = [k for k in range(len(reduction.units)) if k not in doubted]
        efforts = evaluated.out[[program.outputs[effort] for effort in self.kept.efforts]]
        with np.errstate(all="ignore"):
            means = np.array([_means(t, effort) for effort in efforts]).reshape(-1, 2).T
        peaks = np.full((3, len(reduction.units)), np.nan)
        tops = np.full((len(reduction.units), TOPS, 4), np.nan)
        error = np.full(len(reduction.units), np.nan)
        if determined:
            signals = self._signals(t, p, evaluated, determined)
            units = [reduction.units[k] for k in determined]
            found = signals.peaks(units, listed=listed, sampled=self.sampled)
            if not found.resolved.all():
                return None
            peaks[:, determined] = found.value, found.t, found.xi
            tops[determined] = np.nan if found.tops is None else found.tops
            error[determined] = np.nan if found.error is None else found.error
        means[:, [effort not in determined for effort in reduction.efforts]] = np.nan
        return dict(zip(KEPT, (*peaks, *means), strict=True)) | {"tops": tops, "error": error}

    def _signals(self, t: Array, p: Array, evaluated: Evaluated, some: Sequence[int]) -> Signals:
        """Some quantities that are kept of a design, as curves over time."""
        program, kept = self.program, self.kept
        description = program.data.at(p)
        sections = [
            one
            for link in kept.links
            for one in section_forces(description, link, program.outputs).values()
        ]
        quantities: list[Quantity] = [*kept.reduction.quantities, *sections]
        interpreter = Interpreter(program, evaluated.stages, self.newton)
        chosen = [quantities[k] for k in some]
        return Signals(interpreter, kept.sharpness, chosen, t, p, evaluated.iterated)


def _means(t: Array, values: Array) -> tuple[float, float]:
    """Mean and root of the mean square over the times that count, by trapezia."""
    counts = counted(values)
    weights, values = shares(np.arange(t.size, dtype=float), counts), np.where(counts, values, 0.0)
    return float(values @ weights), float(np.sqrt(values**2 @ weights))
