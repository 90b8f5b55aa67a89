"""Many designs of one scene at once: of each parameter set the peaks, means, and whether there is a
result at all.

Instants of a design are evaluated several at once, by SIMD, and reduced in C to what is kept.
Between instants peaks are sought by evaluating the same graph at a few more instants there. A
design depends on nothing but its own parameters: its row has the same bytes whatever stands beside
it.
"""

from __future__ import annotations

import functools
import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import get_args

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.quantities import Output
from ...base.space import cores, require
from ...base.status import Status
from ...base.symbolic import symbolic_property
from ...base.vocabulary import Compiled, PeakSearch
from ...engine import codegen
from ...engine.codegen.peak_search import TOPS, Listed
from ...engine.codegen.stages import Stages
from ...engine.derive import compile_scene
from ...engine.instants.backends import begun, compiled, provenance
from ...engine.instants.determinacy import undetermined
from ...engine.instants.evaluation_method import EvaluationMethod, Provenance, seconds
from ...engine.instants.grids import empty
from ...engine.instants.phases import unwind
from ...engine.program import Program
from ...engine.sharpness import bent
from ...errors import DeclarationError, check_known
from ...model.beyond_ends import BEYOND
from ...model.scene import Scene
from ...model.times import Times, Timing, checked_span
from ...results.sensitivity.ends import Ends
from ...results.sensitivity.peak_derivatives import (
    AS_LARGE,
    MeanSlopes,
    MovingPeaks,
    PeakSlopes,
    faint,
)
from ...results.sensitivity.slopes import Slopes
from .design_reduction import KeptOutputs, stages_of
from .design_times import DesignTimes
from .outcome import KEPT, History, Outcome, Results, outcome_of, refuse, rows_of
from .spot_check import failures

_PIECE = 1 << 22
"""Number of instants of designs with instants of their own that are kept at once."""

_SAMPLES = 32
"""Number of instants at which the peak of a quantity is sought."""


@functools.lru_cache(maxsize=32)
def _library(
    kept: KeptOutputs,
    stages: Stages,
    method: EvaluationMethod,
    guess: tuple[float, ...],
    compiler: codegen.Compiler,
) -> codegen.Library:
    """The code of designs whose iterated loops begin from a ``guess``."""
    source = codegen.emit(kept.watched, stages, method.newton, kept.reduction)
    extra = tuple(shlex.split(method.flags))
    designs = codegen.Designs.of(kept.reduction, guess, compiler, extra, method.precision)
    return codegen.load(source, compiler, extra, designs=designs)


@dataclass(frozen=True, eq=False)
class DesignEngine:
    """A scene compiled for many designs.

    ``parameters`` are the columns of what :meth:`evaluate` takes; ``quantities`` and
    ``efforts`` those of what it gives; ``columns`` those of histories. What equilibrium leaves open
    for a design is NaN there. ``sampled`` peaks are those of the instants, with an error.
    """

    method: EvaluationMethod
    times: DesignTimes
    kept: KeptOutputs
    program: Program
    library: codegen.Library
    provenance: Provenance
    sampled: bool = False

    @classmethod
    def of(
        cls,
        scene: Scene,
        wanted: Sequence[str] | None = None,
        t: Times | None = None,
        method: EvaluationMethod | None = None,
        *,
        timing: Timing | None = None,
        peaks: PeakSearch = "exact",
    ) -> DesignEngine:
        """Derive and compile: ``wanted`` outputs, ``t`` and ``method`` as in :func:`.evaluate`; a
        ``timing`` in place of ``t``; ``peaks`` exactly, or those of the instants.
        """
        method = method or EvaluationMethod()
        program = compile_scene(scene, wanted)
        scene.checked(scene.values())
        return cls.compiled(program, timing or scene.timing(t), method, peaks)

    @classmethod
    def compiled(
        cls,
        program: Program,
        timing: Timing,
        method: EvaluationMethod,
        peaks: PeakSearch = "exact",
    ) -> DesignEngine:
        """Compile a graph for designs at instants that are asked for."""
        check_known("backend of designs", [method.backend], get_args(Compiled))
        check_known("choice of peaks", [str(peaks)], get_args(PeakSearch))
        method.check(program)
        sampled = peaks == "sampled"
        data = program.data
        times, p = DesignTimes(data.laws, data.values(data.defaults), timing), data.defaults
        checked_span(data.laws, timing, times.values)
        instants, even = times.default
        kept = KeptOutputs.of(program, method)
        require("the instants of a design", (kept.reduction.rows, instants.size))
        stages = stages_of(kept.watched, method, even, alike=times.common)
        guess = program.newton.guess if program.newton else ()
        if timing.joint:
            guess = begun(program, float(even[0]), tuple(p.tolist()))
        found = compiled(method, functools.partial(_library, kept, stages, method, guess))
        if found is None:
            raise codegen.no_compiler("designs need a compiler")
        made = provenance(method, found)
        return cls(method, times, kept, program, found[1], made, sampled)

    def __reduce__(self) -> tuple[Callable[..., DesignEngine], tuple[object, ...]]:
        """Sent to another process, an engine is compiled there."""
        peaks = "sampled" if self.sampled else "exact"
        return DesignEngine.compiled, (self.program, self.times.timing, self.method, peaks)

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters."""
        return tuple(self.program.data.parameters)

    @cached_property
    def quantities(self) -> tuple[str, ...]:
        """The names of the quantities that have peaks."""
        return tuple(map(str, self.kept.quantities))

    @cached_property
    def efforts(self) -> tuple[str, ...]:
        """The names of the efforts that have means."""
        return tuple(map(str, self.kept.efforts))

    @property
    def indeterminate(self) -> tuple[str, ...]:
        """The names of quantities, and outputs in histories, that equilibrium or friction at rest
        may leave open for designs.
        """
        if self.program.checks("rest"):
            return tuple(dict.fromkeys([*self.quantities, *self.columns]))
        doubted = sorted({k for _, k in self.kept.reduction.indeterminate_checks})
        outputs = map(str, self.program.indeterminate)
        return tuple(dict.fromkeys([*(self.quantities[k] for k in doubted), *outputs]))

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the outputs that histories have."""
        return tuple(map(str, self.program.outputs))

    @cached_property
    def drives(self) -> tuple[Output, ...]:
        """The efforts of joints whose motion is given."""
        efforts = self.kept.efforts
        return tuple(o for o in efforts if o.group == "effort" and o.part in self.program.driven)

    @property
    def count(self) -> int:
        """Number of instants of a design."""
        return self.times.timing.count

    @property
    def cost(self) -> float:
        """Seconds that a core takes for a design, within a factor of three or so: counted, not
        measured, the same everywhere.
        """
        return seconds(
            self.program,
            self.count + _SAMPLES * len(self.quantities),
            self.method,
        )

    @property
    def capacity(self) -> int:
        """Bytes of memory that a core takes while it evaluates."""
        return 8 * self.kept.reduction.rows * self.count

    def evaluate(self, p: Array, *, threads: int | None = None, histories: bool = False) -> Outcome:
        """The outcome of designs ``p``, (n, parameters), in the order of :attr:`parameters`; with
        ``histories``, its series too.

        Values are not checked against the parameters' ranges. ``threads`` share the designs, by
        default one a core; no byte depends on them. Raises :class:`DeclarationError` for another
        shape, :class:`SizeError` where the outcome does not fit into memory.
        """
        p = np.ascontiguousarray(p, float)
        if p.ndim != 2 or p.shape[1] != len(self.parameters):
            raise DeclarationError(
                f"designs: expected an array of shape (n, {len(self.parameters)}), got {p.shape}"
            )
        n, history = len(p), (len(p), len(self.program.columns), self.count)
        require(
            "the peaks of the designs", (n, 3 * len(self.kept.quantities) + 2 * len(self.efforts))
        )
        columns = empty("the histories of the designs", history) if histories else None
        found, times = (
            self._results(n, columns),
            np.empty((n, self.count)) if histories and not self.times.timing.shared else None,
        )
        # What all have in common is not cut: it is made once.
        many = len(self.program.columns) if self.program.data.corners.constraints else 1
        size = n if self.times.common and many == 1 else max(1, _PIECE // (many * self.count))
        for start in range(0, n, max(size, 1)):
            some = slice(start, start + size)
            self._fill(
                p[some],
                rows_of(found, some),
                threads or cores(),
                None if times is None else times[some],
            )
        if columns is not None:
            # A design without a result may have anything in its columns.
            with np.errstate(invalid="ignore"):
                self.finish(columns, p)
        series = None if columns is None else columns[:, [*self.program.outputs.values()]]
        over = None if self.times.law is None else self.times.at_drive(found["peak_t"], p)
        return outcome_of(found, series, over, times)

    def history(self, p: Array, listed: Listed | None = None) -> History:
        """One design (parameters,) over the instants that are asked for, or, with local peaks, in
        equal steps of time.

        Without, no peaks are sought, so none can be untold.
        """
        p, columns = p[None], np.empty((1, len(self.program.columns), self.count))
        t = self.times.of(p, asked=listed is None)[listed is None]
        found = self._results(1, columns) | {
            "iterated": np.empty((1, self.program.instant.size1_in("z"), self.count)),
            "near": self.near(1),
        }
        tops = np.full((1, len(self.kept.quantities), TOPS, 4), np.nan)
        if listed is None:
            self._series(p, t, found, 1)
        else:
            self.library.designs(t, self.bent(p, t), p, found | {"tops": tops}, 1, listed)
        self._refuse_motions(p, t, found)
        return History(outcome_of(found), t[0], columns[0], found["iterated"][0], tops[0])

    def finish(self, out: Array, p: Array) -> None:
        """Put NaN into the columns (n, columns, t) of designs (n, parameters) for what equilibrium
        leaves open, and let angles go on.
        """
        program = self.program
        if program.indeterminate:
            for rows, values in zip(out, p, strict=True):
                indeterminate = undetermined(program, rows, values, self.method)
                rows[[program.outputs[output] for output in indeterminate]] = np.nan
        unwind(program, out.swapaxes(0, 1))

    def _results(self, n: int, columns: Array | None) -> Results:
        """Arrays for what is kept of n designs, and the columns that histories are made of."""
        q, e = len(self.kept.quantities), len(self.efforts)
        sizes = {"value": q, "peak_t": q, "xi": q, "mean": e, "rms": e}
        sizes |= {"error": q} if self.sampled else {}
        kept = {name: np.empty((n, size)) for name, size in sizes.items()}
        return {"status": np.zeros(n, np.int8), **kept, "history": columns}

    def _fill(self, p: Array, found: Results, threads: int, times: Array | None) -> None:
        """Evaluate designs: peaks between instants in equal steps of time; histories at the
        instants that were asked for.
        """
        series = found["history"]
        even, asked = self.times.of(p, asked=series is not None)
        if times is not None:
            times[:] = asked
        together = series is not None and asked is even
        results = found | {"history": series if together else None, "near": self.near(len(p))}
        self.library.designs(even, self.bent(p, even), p, results, threads)
        self._refuse_motions(p, even, results, threads)
        if series is None or together:
            return
        others: Results = {"status": np.zeros(len(p), np.int8), "history": series}
        self._series(p, asked, others, threads)
        failed = (found["status"] == Status.OK) & (others["status"] != Status.OK)
        refuse(found, failed, others["status"])
        series[found["status"] != Status.OK] = np.nan

    def _series(self, p: Array, t: Array, found: Results, threads: int) -> None:
        """The columns of designs at any instants, without peaks."""
        nowhere = np.zeros((1, 0), bool)
        self.library.designs(t, nowhere, p, found | dict.fromkeys(KEPT), threads)

    def bent(self, p: Array, t: Array) -> npt.NDArray[np.bool_]:
        """Steps between the instants of each design in which its motion bends more than they show;
        one row if none has knots.
        """
        if len(t) == 1 or not self.kept.sharpness.knots:
            # Of the defaults: a row of what is found must not depend on the designs beside it.
            t, p = t[:1], self.program.data.defaults[None]
        known = [
            bent(self.program, self.kept.sharpness, times, row)
            for times, row in zip(t, p, strict=True)
        ]
        return np.array(known) if known else np.zeros((1, 0), bool)

    def _refuse_motions(self, p: Array, t: Array, found: Results, threads: int = 1) -> None:
        """Take the result from designs whose motion cannot be."""
        near = found.pop("near")
        if near is None:
            return
        status = self.statuses(p, t, found["status"], near, threads)
        refuse(found, status != found["status"], status)

    def near(self, n: int) -> npt.NDArray[np.int8] | None:
        """Array for whether n designs are to be looked at for corners; None if no motion and no
        constraint can have one, nor end.
        """
        laws, corners = self.program.laws, self.program.data.corners
        watched = laws.beyond is not None or corners.laws or corners.constraints
        return np.zeros(n, np.int8) if watched else None

    def statuses(
        self,
        p: Array,
        t: Array,
        status: npt.NDArray[np.int8],
        near: npt.NDArray[np.int8],
        threads: int = 1,
    ) -> npt.NDArray[np.int8]:
        """The statuses of designs ``p`` (n, parameters) that had ``status``, at instants ``t`` (1
        or n, t), by what is beyond a curve's ends, and by kinks.

        Kinks are sought in those whose marks come ``near`` (n,).
        """
        found: npt.NDArray[np.int8] = status.copy()
        ends, corners = self.program.laws.beyond, self.program.data.corners
        if ends is not None:
            for k, row in enumerate(p):
                share = float(ends(t[min(k, len(t) - 1)][None], row).full().max(initial=0.0))
                if not share <= BEYOND["double"] and np.isfinite(row).all():
                    found[k] = Status.BEYOND_ENDS
        some = np.flatnonzero((found == Status.OK) & ((near != 0) | corners.hidden))
        if not some.size:
            return found
        p, t = p[some], t[some] if len(t) > 1 else t
        broken = corners.broken_laws(t, p)
        if corners.constraints:
            series = np.empty((len(p), len(self.program.columns), t.shape[1]))
            self._series(p, t, {"status": np.zeros(len(p), np.int8), "history": series}, threads)
            broken |= corners.broken_constraints(
                lambda name: series[:, self.program.seen_columns(name)], p
            )
        found[some[broken]] = Status.CORNER
        return found

    @symbolic_property
    def slopes(self) -> Slopes:
        """The derivatives of :attr:`quantities` at points; they are derived and compiled when they
        are first asked for.
        """
        return Slopes.of(self.program, self.kept.quantities, self.kept.sharpness, self.method)

    def moving(self, p: Array) -> MovingPeaks:
        """Derivatives of peaks and means of a design (parameters,) by all parameters."""
        ends = Ends(self.program.laws, self.times.timing, self.times.even(p), p)
        return MovingPeaks(self.slopes, ends)

    def gradient(self, p: Array, value: Array, t: Array, xi: Array) -> PeakSlopes:
        """Gradient by all parameters of the peaks (q,) of a design (parameters,), which are at
        times ``t`` and ratios ``xi``.
        """
        if self.sampled:
            raise DeclarationError("peaks: 'sampled' ones have no derivatives; expected 'exact'")
        chosen = np.arange(value.size, dtype=np.intc)
        return self.moving(p).gradient(chosen, (value, t, xi), self._faint(value))

    def curvature(
        self, p: Array, value: Array, t: Array, xi: Array, first_order: PeakSlopes
    ) -> Array:
        """The second derivatives (q, parameters, parameters) of the peaks of a design, whose
        gradient is ``first_order``.
        """
        chosen = np.arange(value.size, dtype=np.intc)
        return self.moving(p).curvature(chosen, (value, t, xi), first_order, self._faint(value))

    def tied(self, p: Array, value: Array, first_order: PeakSlopes) -> npt.NDArray[np.bool_]:
        """Return which of the peaks (q,) of a design, whose gradient is ``first_order``, tie with
        another one: see :meth:`.MovingPeaks.ties`.
        """
        others = self.history(p, Listed(1.0 - AS_LARGE[self.method.precision])).tops
        chosen = np.arange(value.size, dtype=np.intc)
        return self.moving(p).ties(chosen, value, first_order, others) & ~self._faint(value)

    def _faint(self, value: Array) -> npt.NDArray[np.bool_]:
        """Return which peaks are zero within rounding, relative to the largest of their unit."""
        sizes, units = np.where(np.isfinite(value), np.abs(value), 0.0), self.kept.reduction.units
        same = np.equal.outer(units, units)
        return faint(value, np.where(same, sizes, 0.0).max(axis=1, initial=0.0))

    def mean_slopes(self, p: Array) -> MeanSlopes:
        """Derivatives by all parameters of the means of :attr:`efforts` over time, and of their
        root mean squares.
        """
        chosen = np.array([self.quantities.index(name) for name in self.efforts], np.intc)
        return self.moving(p).means(chosen)

    def failures(self, p: Array, whole: Program) -> dict[str, float]:
        """Failures of one design that has a result, (parameters,), by a graph of all outputs: see
        :mod:`.spot_check`.
        """
        series = self.evaluate(p[None], threads=1, histories=True).series
        assert series is not None
        found = dict(zip(self.program.outputs, series[0], strict=True))
        return failures(whole, p, self.times.of(p[None])[1][0], self.method, found)
