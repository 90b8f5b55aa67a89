"""Peaks between instants: where a quantity is largest over all times of a solution's span.

A peak of sampled values falls short of the true one by a part that goes with the square of the
step. The search in C (:mod:`.codegen.peak_search`) finds peaks between the instants; here the time
derivatives that automatic differentiation gives then say at which time a smooth peak is.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..base.arguments import Count, public
from ..base.arrays import Array
from ..base.brief import Brief
from ..base.quantities import Output, compared, parts_along
from ..base.symbolic import symbolic
from ..base.tables import LARGEST
from ..engine.codegen.peak_search import TOPS, Listed, Peaks
from ..engine.codegen.stages import stages_for
from ..engine.derive import compile_scene
from ..engine.instants.backends import Interpreter
from ..engine.instants.evaluation_method import EvaluationMethod
from ..engine.program import Program
from ..engine.sharpness import Sharpness
from ..errors import DeclarationError
from ..model.even_points import EvenPoints, are_even
from ..model.scene import Scene
from ..model.times import Over, Times, span_of
from ..results.histories import Peak
from ..results.ordering import ordered
from ..results.sensitivity.slopes import Loops, Slopes
from ..results.signals import Quantity, SectionForce, Signals
from ..results.solution import Solution
from ..results.vector_sizes import largest, most
from ..results.verification.accuracy import by_unit
from .evaluate import evaluate

_SAME = 1e-6
"""Largest difference of a graph from a solution, relative to the largest value of the same unit."""

_NOTHING = 1e-12
"""Relative size that is zero within rounding."""

_NEAR, _LESS = 1e-4, 1e-13
"""Distance of a smooth peak from the place where it was found, in steps between instants, and the
relative amount by which rounding may lower it.
"""

_TRIALS = 3


@public
def refine(scene: Scene, solution: Solution, names: Iterable[str] | None = None) -> list[Peak]:
    """Return the peaks of quantities over all times of a solution's span, between its instants too.

    A smooth peak is exact to rounding, and its time to 1e-12 of the step or to the derivative's
    rounding. So is a peak at a kink, and one at a jump, where the higher side counts. No peak is
    below that of the instants. Of several peaks that differ by rounding only, the first one in time
    is returned.

    Parameters
    ----------
    scene
        The scene.
    solution
        A solution of it.
    names
        Full names of quantities; default: all.

    Returns
    -------
    list of Peak
        The peaks, as of :meth:`.Solution.peak`. The value is infinite for a quantity that grows
        without bound. It is NaN, with the largest magnitude found as ``least``, if the search would
        take too long: smooth what switches so often. It is NaN without a ``least`` for what
        equilibrium does not determine; where least strain energy does, the peak is that of the
        instants.

    Raises
    ------
    DeclarationError
        If the solution is not of this scene, or the value of a motion or constraint at a point
        between instants differs from that on both sides.
    UnknownNameError
        For a name that the solution does not have.
    """
    sampled = [solution.peak(name) for name in (solution.names() if names is None else names)]
    return ContinuousSolution.of(scene, solution.by_equilibrium).refined(sampled)[0]


@dataclass(frozen=True)
class Shortfall:
    """Shortfall of the peaks over ``count`` instants from the true ones, relative to the true ones:
    the worst and the median force.

    ``sampled`` is at the instants, ``refined`` between them by :func:`refine`.
    """

    count: int
    sampled_worst: float
    sampled_median: float
    refined_worst: float
    refined_median: float


@public
def shortfall(
    scene: Scene,
    counts: Sequence[Count],
    names: Iterable[str] | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    t: Times | None = None,
    over: Over | None = None,
) -> list[Shortfall]:
    """Return by how much peaks at instants are below the true peaks, by the number of instants.

    Parameters
    ----------
    scene : Scene
        A mechanism and its motion.
    counts : sequence of int
        Numbers of instants into which the span is divided.
    names : iterable of str, optional
        Full names of quantities; by default all efforts, reactions and section forces that are
        wanted and determinate.
    parameters : mapping, optional
        Values of parameters, by name.
    t, over : tuple, optional
        The span, as of :func:`.evaluate`; by default that of the scene.

    Returns
    -------
    list of Shortfall
        A row for each of ``counts``. The true peaks are the largest refined ones, of all counts and
        of twice as many instants. Quantities that are zero within rounding, grow without bound or
        have no reported peak are left out.

    Raises
    ------
    DeclarationError
        Without counts, if no quantity is left, and as :func:`.evaluate` does, as for so few
        instants that loops cannot be followed.
    """
    timing = scene.timing(t, over)
    start, stop = span_of(scene.prescribed, timing, scene.values(parameters))
    if not counts:
        raise DeclarationError("shortfall: expected at least one number of instants")
    solutions = [
        evaluate(
            scene, t=(start, stop, count), parameters=parameters, backend="vm", certificate=False
        )
        for count in (*counts, 2 * max(*counts, timing.count))
    ]
    last = solutions[-1]
    chosen = [name for name in (forces(last) if names is None else names) if last.determined(name)]
    refined = np.array(
        [[abs(peak.value) for peak in refine(scene, solution, chosen)] for solution in solutions]
    )
    sampled = np.array(
        [[abs(solution.peak(name).value) for name in chosen] for solution in solutions]
    )
    true = refined.max(axis=0, initial=0.0)
    finite = np.where(np.isfinite(true), true, 0.0)
    units = np.array([last.unit(name) for name in chosen])
    there = np.array(
        [x > _NOTHING * finite[units == unit].max() for x, unit in zip(finite, units, strict=True)],
        dtype=bool,
    )
    if not there.any():
        raise DeclarationError(
            "shortfall: all peaks are zero or indeterminate; expected a scene with one that is not"
        )
    missing = [1.0 - peaks[:-1, there] / true[there] for peaks in (sampled, refined)]
    columns = [distributed(rows, axis=1) for rows in missing for distributed in (np.max, np.median)]
    return [
        Shortfall(count, *map(float, row)) for count, *row in zip(counts, *columns, strict=True)
    ]


def resultants(solution: Solution) -> list[str]:
    """The full names of the resultants of a solution's reactions that equilibrium determines, and
    of how large its loads are.
    """
    sizes = solution.table.reactions
    found = (one for one in ordered(solution) if one.group == "load" or one.member in sizes)
    return [str(output) for output in found if solution.determined(output)]


@public
def forces(solution: Solution) -> list[str]:
    """Return the names of the quantities whose peaks :func:`refine` finds by default.

    Parameters
    ----------
    solution : Solution
        Result of :func:`.evaluate`.

    Returns
    -------
    list of str
        Full names of efforts, reactions, section forces, stresses, deflections and user-defined
        outputs, without those that are indeterminate.
    """
    wanted = (
        output
        for output in solution.quantities()
        if output.group in ("effort", "reaction", "section", *LARGEST, "output")
    )
    return [str(output) for output in wanted if solution.determined(output)]


@symbolic
@functools.lru_cache(maxsize=32)
def _slopes_of(program: Program, quantities: tuple[Output, ...]) -> Slopes:
    """Derivatives of quantities of a graph, kept for its other solutions."""
    return Slopes.of(program, quantities, None, EvaluationMethod("vm"))


@dataclass(frozen=True, eq=False, repr=False)
class ContinuousSolution(Brief):
    """A solution, and what its quantities and their time derivatives are at any time of its span.

    ``again`` makes that of the same parameters at other instants, for outputs that are wanted.
    """

    interpreter: Interpreter
    solution: Solution
    p: Array
    z: Array
    again: Callable[[EvenPoints, Sequence[str]], ContinuousSolution]

    @property
    def program(self) -> Program:
        """Program of which the solution is made."""
        return self.interpreter.program

    @classmethod
    def of(cls, scene: Scene, solution: Solution) -> ContinuousSolution:
        """Make it from a solution.

        Raises :class:`.DeclarationError` where the solution is not one of this scene.
        """
        other = DeclarationError(
            f"the solution of '{solution.case}' is not one of this scene of '{scene.name}'"
        )
        if (
            scene.name != solution.case
            or scene.parameters.keys() != solution.description.parameters.keys()
        ):
            raise other
        values = scene.values(solution.description.values)
        wanted = list(dict.fromkeys(map(wanted_for, solution.outputs)))
        program = compile_scene(scene, wanted, parameters=values)
        p = np.array(list(values.values()))
        interpreter = Interpreter(program, stages_for(program, "double", solution.t, p))
        z = Loops.of(program, EvaluationMethod("vm")).at(solution.t, p, solution.t).T

        def again(t: EvenPoints, names: Sequence[str]) -> ContinuousSolution:
            asked: dict[str, Any] = {"backend": "vm", "certificate": False, "elastic": False}
            return cls.of(scene, evaluate(scene, parameters=values, t=t, wanted=names, **asked))

        found = cls(interpreter, solution, p, z, again)
        if not found.agrees():
            raise other
        return found

    def agrees(self) -> bool:
        """Return whether the graph agrees with the solution: at one of three instants, for at a
        jump rounding decides.
        """
        solution = self.solution
        outputs = [output for output in solution.outputs if output not in solution.indeterminate]
        if not all(output in self.program.outputs for output in outputs):
            return False
        outputs = [output for output in outputs if output not in self.program.loop_angles]
        moving = np.flatnonzero(solution.resting.all() | ~solution.resting)
        some = moving[[0, moving.size // 2, -1]]
        out = self.interpreter.columns(solution.t[some], self.p, self.z[:, some])
        largest = {output: most(values) for output, values in solution.outputs.items()}
        sizes = by_unit(solution.description.kinds, largest)
        rounding = _NOTHING * max(sizes.values(), default=0.0)
        found = np.ones(some.size, bool)
        for output in outputs:
            gaps = np.abs(out[self.program.outputs[output]] - solution.outputs[output][some])
            found &= ~(gaps > _SAME * sizes[solution.unit(output)] + rounding)
        return bool(found.any())

    def in_equal_steps(self, *wanted: str) -> ContinuousSolution:
        """The same, or what is ``wanted``, from as many instants in equal steps of time, between
        which peaks are sought.
        """
        t = self.solution.t
        names = list(wanted) or list(dict.fromkeys(map(wanted_for, self.solution.outputs)))
        return self.again((float(t[0]), float(t[-1]), t.size), names)

    def refined(
        self, sampled: Sequence[Peak], listed: Listed | None = None
    ) -> tuple[list[Peak], Array]:
        """The peaks over all times, with the coordinate of the drive, of quantities whose peaks at
        the instants are known.

        And of each quantity the local peaks that are ``listed``, (q, :data:`.TOPS`, 4): see
        :class:`.Peaks`.
        """
        over = self.solution.over
        peaks, tops = (self if are_even(self.solution.t) else self.in_equal_steps()).searched(
            sampled, listed
        )
        if over is not None:
            row, p = self.program.driven.index(over.joint), self.p
            peaks = [
                replace(peak, over=float(self.program.motion(peak.t, p)[0][row])) for peak in peaks
            ]
        return peaks, tops

    def searched(
        self, sampled: Sequence[Peak], listed: Listed | None = None
    ) -> tuple[list[Peak], Array]:
        """The same, and local peaks of each: see :meth:`refined`."""
        solution, nothing = self.solution, np.full((TOPS, 4), np.nan)
        found = {Output.of(peak.name): peak for peak in sampled}
        sought = [output for output in found if solution.determined(output)]
        if not sought or (solution.t.size == 1 and listed is None):
            return list(sampled), np.array([nothing for _ in sampled]).reshape(-1, TOPS, 4)
        self._refuse_isolated()
        turned = {
            k: solution.outputs[name]
            for k, name in enumerate(sought)
            if name in self.program.loop_angles
        }
        signals = self.signals([self.quantity(name) for name in sought], turned)
        units, scales = self.scales(sought)
        searched = signals.peaks(units, scales, listed)
        there = {} if searched.tops is None else dict(zip(sought, searched.tops, strict=True))
        tops = np.array([there.get(Output.of(peak.name), nothing) for peak in sampled])
        if solution.t.size == 1:
            return list(sampled), tops
        value, t, xi = self.timed(signals, sought, searched)
        for k, output in enumerate(sought):
            peak = found[output]
            along = None if peak.xi is None else float(xi[k])
            if not searched.resolved[k]:
                least = max(abs(peak.value), float(abs(value[k])))
                found[output] = Peak(peak.name, math.nan, peak.unit, float(t[k]), along, least)
            elif abs(value[k]) > abs(peak.value):
                found[output] = Peak(peak.name, float(value[k]), peak.unit, float(t[k]), along)
        return [found[Output.of(peak.name)] for peak in sampled], tops

    def _refuse_isolated(self) -> None:
        """Raise :class:`.DeclarationError` where a motion or constraint is other at a place between
        instants than on both sides.
        """
        corners, t, p = self.program.data.corners, self.solution.t, self.p.tolist()
        corners.refuse_laws(t, p, between=True)
        if corners.constraints:
            out = self.interpreter.columns(t, self.p, self.z)
            corners.refuse_constraints(
                lambda name: out[..., self.program.seen_columns(name), :], p, between=True
            )

    def signals(self, quantities: Sequence[Quantity], turned: Mapping[int, Array]) -> Signals:
        """Quantities as curves over time; ``turned`` as in :class:`.Signals`."""
        columns = {
            k
            for quantity in quantities
            for k in (quantity if isinstance(quantity, tuple) else quantity.columns.values())
        }
        sharpness, t = Sharpness.of(self.program, sorted(columns)), self.solution.t
        return Signals(self.interpreter, sharpness, quantities, t, self.p, self.z, turned)

    def quantity(self, output: Output) -> Quantity:
        """Number of a quantity's column."""
        if output.group != "section":
            return tuple(
                self.program.outputs[component] for component in self.solution.made_of(output)
            )
        link, law = output.part, self.solution.section(output.part).law
        rows = parts_along(self.program.outputs, link)
        return SectionForce(output.member, link, rows, law.length, law.density)

    def scales(self, names: Sequence[Output]) -> tuple[list[int], list[float]]:
        """The units of quantities, by number, and the largest size of anything that has each."""
        solution = self.solution
        others = [
            output
            for output in solution.quantities()
            if output in solution.outputs and solution.determined(output)
        ]
        units = np.array(compared([solution.unit(output) for output in (*names, *others)]))
        own, beside = np.split(units, [len(names)])
        scales = np.zeros(len(units))
        np.maximum.at(scales, beside, [most(solution.outputs[output]) for output in others])
        return own.tolist(), scales[: own.max() + 1].tolist()

    def timed(
        self, signals: Signals, names: Sequence[Output], peaks: Peaks
    ) -> tuple[Array, Array, Array]:
        """Values, times and ratios of peaks, the smooth ones at the times where their derivative is
        zero, by a chord of the derivative.
        """
        value, t, xi, instants = (
            peaks.value.copy(),
            peaks.t.copy(),
            peaks.xi.copy(),
            self.solution.t,
        )
        reach = _NEAR * (instants[-1] - instants[0]) / (instants.size - 1)
        some = np.flatnonzero(np.isfinite(value) & ~np.isin(t, instants)).tolist()
        if not some:
            return value, t, xi
        rates, first = _slopes_of(self.program, tuple(names)), t[some]
        later = np.clip(first + reach / 2, instants[0], instants[-1])
        _, _, slope_first = self.slopes(signals, rates, some, first)
        now, slope = first, slope_first
        with np.errstate(all="ignore"):
            bend = (self.slopes(signals, rates, some, later)[2] - slope_first) / (later - first)
            for _ in range(_TRIALS):
                ahead = now - slope / bend
                now = np.where(np.abs(ahead - first) < reach, ahead, now)
                sizes, places, slope = self.slopes(signals, rates, some, now)
        better = (np.abs(sizes) >= np.abs(value[some]) * (1.0 - _LESS)) & (
            np.abs(slope) < np.abs(slope_first)
        )
        t[some], xi[some] = np.where(better, now, first), np.where(better, places, xi[some])
        value[some] = np.where(better & (np.abs(sizes) > np.abs(value[some])), sizes, value[some])
        return value, t, xi

    def slopes(
        self, signals: Signals, rates: Slopes, chosen: Sequence[int], t: Array
    ) -> tuple[Array, Array, Array]:
        """Value, ratio, and time derivative of the size of each of the ``chosen`` signals at a time
        of its own, by the derivatives of all signals.

        Where along a link a force is largest moves, but for the rate of its size only at a station
        does that count.
        """
        near = signals.near(t)
        z, _ = signals.closed(t, near)
        columns, best = signals.columns(t, z), []
        for k, number in enumerate(chosen):
            places, values = signals.curves_of(number, columns[:, [k]], near[[k]])
            highest = largest(values)
            best.append((values[highest, 0], places[highest, 0]))
        value, place = np.array(best).T
        found = rates.at(t, z.T, self.p, np.array(chosen, np.intc), place, value)
        return value, place, np.sign(value) * found.rate


def wanted_for(output: Output) -> str:
    """Outputs to be wanted for an output."""
    kinds = {
        "effort": "effort",
        "motion": "motion",
        "pose": "motion",
        "utilisation": f"safety:{output.part}",
    }
    kind = "section" if output.along else output.group
    return kinds.get(output.group, f"{kind}:{output.part}" if output.part else kind)
