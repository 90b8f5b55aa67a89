"""The trade between speed and accuracy, measured: every method of evaluation on one scene,
side by side on this machine.

Errors are against the scene's own graphs in many digits (:mod:`.reference`), at instants of the
scene's own grid, relative to the peak of each quantity over them; of what is zero by structure,
relative to the largest peak of its unit. Times are of the instants alone, nothing derived or
compiled, on one thread: the least processor time of many short samples, taken in turns, so that
other work of the machine meets all methods alike and hardly counts.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import TypeAlias, TypeVar, get_args

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Json, spread
from ..base.status import Status
from ..base.tables import ANGLE, LENGTH
from ..base.vocabulary import PeakSearch, Precision
from ..engine.codegen import find_compiler
from ..engine.derive import compile_scene
from ..engine.instants.backends import Evaluated, run
from ..engine.instants.evaluation_method import EvaluationMethod
from ..engine.instants.from_table import columns
from ..engine.instants.refusing import resting, unfinished
from ..engine.program import Program
from ..errors import AccuracyError, AssemblyError, CompilerError, DeclarationError
from ..model.scene import Scene
from ..model.times import Over, Times, Timing, instants_of
from ..results.verification.reference import reference
from .designs.engine import DesignEngine
from .peaks_between import Shortfall, shortfall

INSTANTS = 1000
"""Instants of a sample, over the scene's own span of time; of the virtual machine a tenth."""

COMPARED = 101
COUNTS = (25, 50, 100, 200, 400, 800)
"""Instants of a cycle, for what they miss of the peaks."""

QUIET, LONGEST = 40, 20.0
"""Rounds of samples that no least time falls in any more, and seconds that all rounds take."""

_Way = TypeVar("_Way")
_Work: TypeAlias = tuple[Callable[[int], Callable[[], object]], int]
"""A function ``of(count)``, which prepares a call that does ``count`` pieces of work; and a count.
"""

_NIL, _TICK = 1e-9, 1e-9
_ALIKE = 1.2
"""Ratio of times that are held to be equal: other work of the machine changes them by so much."""

METHODS = (
    *(
        EvaluationMethod(backend, precision)
        for precision in get_args(Precision)
        for backend in ("lanes", "c")
    ),
    *(
        EvaluationMethod("c", flags=flags)
        for flags in ("-O1", "-march=native -ffp-contract=fast", "-ffast-math")
    ),
    EvaluationMethod("lanes", flags="-ffast-math"),
    *(
        EvaluationMethod(backend, precision, newton=1)
        for precision in get_args(Precision)
        for backend in ("lanes", "c")
    ),
    *(EvaluationMethod(backend, newton=2) for backend in ("lanes", "c")),
    *(EvaluationMethod("c", table=accuracy) for accuracy in (1e-3, 1e-6, 1e-9, 1e-12)),
    *(EvaluationMethod("c", "single", table=accuracy) for accuracy in (1e-3, 1e-5)),
    EvaluationMethod("vm"),
)


@dataclass(frozen=True)
class Measurement:
    """Cost and accuracy of a method: seconds an instant, and errors relative to each quantity's
    peak.

    ``instructions`` are those of its graphs an instant, with as many steps of Newton's method as
    the method takes, at least one; reading a table is not among them.
    ``largest`` is over all quantities and instants, ``median`` over the quantities' largest;
    ``worst`` names the quantity that errs most. ``note`` says what else there is to know, such as
    how many nodes a table has.
    """

    method: EvaluationMethod
    seconds: float
    instructions: int
    largest: float
    median: float
    worst: str
    note: str = ""


@dataclass(frozen=True)
class PeakCost:
    """Cost of ``exact`` or ``sampled`` peaks of designs: seconds an instant, the instants included.

    ``error`` is what the peaks miss of the exact ones, and ``bound`` what they are said to miss at
    most, of the quantity of which it is largest, relative to its peak; infinite where nothing
    bounds it.
    """

    peaks: PeakSearch
    seconds: float
    error: float
    bound: float


@dataclass(frozen=True)
class Trade:
    """The methods of one scene, fastest first, and those that it has not, with the reason.

    ``peaks`` says how far peaks fall short, by how many instants a cycle is sampled at, and
    ``searches`` what peaks of designs cost; empty where that cannot be said.
    """

    case: str
    instants: int
    compared: int
    measurements: tuple[Measurement, ...]
    refused: Mapping[str, str]
    peaks: tuple[Shortfall, ...] = ()
    searches: tuple[PeakCost, ...] = ()

    @property
    def front(self) -> tuple[Measurement, ...]:
        """The methods that no other one beats in both speed and accuracy, fastest first."""
        return tuple(one for one in self.measurements if one is self.fastest(one.largest))

    @property
    def exported(self) -> Trade:
        """Measurements of what exported C can be: one instant at a time, by a compiler's usual
        flags.
        """
        return replace(
            self,
            measurements=tuple(
                one
                for one in self.measurements
                if one.method.backend == "c" and not one.method.flags
            ),
        )

    def fastest(self, accuracy: float) -> Measurement:
        """The fastest method whose largest error is at most ``accuracy``, relative to the peak.

        Times within 20 % are held to be equal: of these, the method with the shortest options.

        Raises :class:`AccuracyError` where none is; it names the most accurate one.
        """
        if not accuracy > 0.0:
            raise DeclarationError(f"accuracy: expected a finite number above 0, got {accuracy!r}")
        enough = [one for one in self.measurements if one.largest <= accuracy]
        if not enough:
            best = min(self.measurements, key=lambda one: one.largest)
            raise AccuracyError(
                f"no method evaluates '{self.case}' to {accuracy:g} of the peak; the best, "
                f"{best.method.options}, has an error of {best.largest:.2g} (in {best.worst})"
            )
        least = _ALIKE * min(one.seconds for one in enough)
        alike = [one for one in enough if one.seconds <= least]
        return min(alike, key=lambda one: (len(one.method.options), one.method.options))

    def as_dict(self) -> dict[str, Json]:
        """All of it as plain numbers and words, for JSON."""
        methods = [
            {"rung" if key == "method" else key: value for key, value in asdict(one).items()}
            | {"options": one.method.options, "front": one in self.front}
            for one in self.measurements
        ]
        found: dict[str, Json] = {
            "case": self.case,
            "instants": self.instants,
            "compared": self.compared,
            "rungs": methods,
        }
        searches = [
            asdict(row) | {"bound": row.bound if math.isfinite(row.bound) else None}
            for row in self.searches
        ]
        return found | {
            "refused": dict(self.refused),
            "peaks": [asdict(row) for row in self.peaks],
            "searches": searches,
        }


def trade(
    scene: Scene,
    *,
    parameters: Mapping[str, float] | None = None,
    t: Times | None = None,
    over: Over | None = None,
    wanted: Sequence[str] | None = None,
    methods: Sequence[EvaluationMethod] = METHODS,
    progress: Callable[[EvaluationMethod], None] = lambda method: None,
) -> Trade:
    """Measure every method on a scene, ``t`` or ``over`` as in :func:`.evaluate`; ``progress`` is
    called with each before it is measured.

    Raises :class:`DeclarationError` for graphs that call functions of their own, and what
    :func:`.evaluate` raises where the scene has no result.
    """
    parameter_values = scene.values(parameters)
    values = np.array(list(parameter_values.values()))
    times = instants_of(scene.prescribed, scene.timing(t, over), parameter_values).t
    program = compile_scene(scene, wanted, parameters=parameter_values)
    compared = spread(times.size, COMPARED)
    truth = _Truth(program, times, compared, values)
    refused: dict[str, str] = {}
    works: dict[EvaluationMethod, _Work] = {}
    found: dict[EvaluationMethod, tuple[int, float, float, str, str]] = {}
    for method in methods:
        progress(method)
        if method.newton is not None and program.newton is None:
            continue
        try:
            evaluated, _ = columns(program, times, values, method, 1)
            if unfinished(program, evaluated).any():
                raise AssemblyError("some instants have no result")
            works[method] = (
                partial(_evaluation, program, times, values, method),
                INSTANTS // 10 if method.backend == "vm" else INSTANTS,
            )
        except (AssemblyError, CompilerError, DeclarationError) as error:
            refused[method.options] = str(error)
            continue
        nodes = (
            ""
            if evaluated.cycle is None
            else f"{evaluated.cycle.nodes} nodes,"
            f" {evaluated.cycle.coefficients.nbytes / 1000:.3g} kB"
        )
        counts = evaluated.stages.instructions(method.newton or 1)
        found[method] = (counts, *truth.errors(program, evaluated), nodes)
    seconds = _in_turns(works)
    measured = [Measurement(method, seconds[method], *found[method]) for method in works]
    ordered = tuple(sorted(measured, key=lambda one: one.seconds))
    sampled = replace(scene, wanted=scene.wanted if wanted is None else wanted)
    try:
        peaks = tuple(shortfall(sampled, COUNTS, parameters=parameters, t=t, over=over))
    except (AssemblyError, CompilerError, DeclarationError):
        peaks = ()
    try:
        searches = _peak_costs(sampled, scene.timing(t, over), values)
    except (AssemblyError, CompilerError, DeclarationError):
        searches = ()
    return Trade(
        program.data.name, INSTANTS, truth.compared.size, ordered, refused, peaks, searches
    )


def _peak_costs(scene: Scene, timing: Timing, p: Array) -> tuple[PeakCost, ...]:
    """Measure both kinds of peaks of one design many times; nothing where it has no result."""
    engines = {
        peaks: DesignEngine.of(scene, timing=timing, peaks=peaks) for peaks in get_args(PeakSearch)
    }
    works = {
        peaks: (partial(_designs, engine, p), 1 + math.ceil(INSTANTS / timing.count))
        for peaks, engine in engines.items()
    }
    found = {peaks: engine.evaluate(p[None]) for peaks, engine in engines.items()}
    if any(outcome.status[0] != Status.OK for outcome in found.values()):
        return ()
    seconds = {peaks: one / timing.count for peaks, one in _in_turns(works).items()}
    exact, sampled = (np.abs(found[peaks].value[0]) for peaks in get_args(PeakSearch))
    units = np.array(engines["exact"].kept.units)
    largest = np.array([np.nanmax(exact[units == unit], initial=0.0) for unit in units])
    there = np.isfinite(exact) & (exact > _NIL * largest)
    error, bound = (
        float(np.max(missed[there] / exact[there], initial=0.0))
        for missed in (exact - sampled, np.asarray(found["sampled"].error)[0])
    )
    return (
        PeakCost("exact", seconds["exact"], 0.0, 0.0),
        PeakCost("sampled", seconds["sampled"], error, bound),
    )


class _Truth:
    """The reference at some instants, and how far an evaluation is from it."""

    def __init__(
        self, program: Program, t: Array, compared: npt.NDArray[np.intp], p: Array
    ) -> None:
        evaluated, _ = run(program, t, p, EvaluationMethod("c" if find_compiler() else "vm"), 1)
        moves = ~resting(program, evaluated.out)  # at rest there is nothing to compare
        compared = compared[moves[compared]] if moves[compared].any() else compared
        self.compared = compared
        rows = reference(program, list(t[compared]), list(p), evaluated.iterated[:, compared])
        self.columns = {output: [row[k] for row in rows] for output, k in program.outputs.items()}
        peaks = {name: max(abs(float(x)) for x in column) for name, column in self.columns.items()}
        largest = _motions(program, t, p)
        for name, peak in peaks.items():
            unit = name.quantity.unit
            largest[unit] = max(largest.get(unit, 0.0), peak)
        of_unit = {name: largest[name.quantity.unit] for name in peaks}
        self.scales = {
            name: (peak if peak > _NIL * of_unit[name] else of_unit[name]) or 1.0
            for name, peak in peaks.items()
        }

    def errors(self, program: Program, evaluated: Evaluated) -> tuple[float, float, str]:
        """The largest and the median error relative to the peaks, and which quantity errs most."""
        worst = {}
        for name, k in program.outputs.items():
            both = zip(self.columns[name], evaluated.out[k, self.compared], strict=True)
            gaps = [float(x - float(y)) for x, y in both]
            if name in program.loop_angles:
                gaps = [math.remainder(gap, math.tau) for gap in gaps]
            worst[name] = max(abs(gap) for gap in gaps) / self.scales[name]
        name = max(worst, key=lambda name: worst[name])
        return worst[name], float(np.median(list(worst.values()))), str(name)


def _motions(program: Program, t: Array, p: Array) -> dict[str, float]:
    """Reference motions of each unit: those of a point as far away as the mechanism is large,
    turned by the fastest drive.
    """
    extent, (_, rates, _) = (
        program.extent(p),
        (np.atleast_2d(part.full()) for part in program.motion(t[None], p)),
    )
    kinds = [program.data.kinds.coordinates[name] for name in program.driven]
    turning = [
        np.abs(row).max() / (1.0 if kind == "angle" else extent or 1.0)
        for row, kind in zip(rates, kinds, strict=True)
    ]
    rate = float(max(turning, default=0.0))
    units = ((ANGLE, 1.0), (LENGTH, extent), ("1", 1.0))
    return {
        unit + per: size * rate**power
        for unit, size in units
        for power, per in enumerate(("", "/s", "/s^2"))
        if unit + per != "1"
    }


def _evaluation(
    program: Program, t: Array, p: Array, method: EvaluationMethod, count: int
) -> Callable[[], object]:
    """Prepare a call that evaluates ``count`` instants."""
    dense = np.linspace(t[0], t[-1], count)
    evaluated, _ = columns(program, dense, p, method, 1)
    return partial(columns, program, dense, p, method, 1, into=evaluated)


def _designs(engine: DesignEngine, p: Array, count: int) -> Callable[[], object]:
    """Prepare a call that evaluates one design ``count`` times."""
    return partial(engine.evaluate, np.tile(p, (count, 1)), threads=1)


def _in_turns(works: Mapping[_Way, _Work]) -> dict[_Way, float]:
    """Seconds of a processor for one piece of each work, without what a call of any size takes.

    Each way has its turn in each round, with all pieces and with one; the least times count.
    Rounds end when these fall no more, by a fiftieth.
    """
    calls = {(way, n): of(n) for way, (of, count) in works.items() for n in (count, 1)}
    least, quiet, begun = dict.fromkeys(calls, math.inf), 0, time.monotonic()
    while quiet < QUIET and time.monotonic() - begun < LONGEST:
        quiet += 1
        for key, call in calls.items():
            start = time.process_time()
            call()
            taken = time.process_time() - start
            quiet = 0 if taken < 0.98 * least[key] else quiet
            least[key] = min(least[key], taken)
    return {
        way: max(least[way, count] - least[way, 1], _TICK) / (count - 1)
        for way, (_, count) in works.items()
    }
