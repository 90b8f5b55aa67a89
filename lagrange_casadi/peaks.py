"""Peaks between instants: where the time derivative of a quantity, by automatic differentiation, is zero or jumps.

A peak of sampled values falls short of the true one by a part that goes with the square of the step. Here the instants only tell
between which of them to look.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
import numpy.typing as npt

from .backends import follow
from .codegen.emit import NOT_CONVERGED
from .density import Array
from .derive import assembled, derive
from .errors import DeclarationError
from .evaluate import evaluate
from .motion import jerk_function
from .reciprocals import differentiable
from .scene import Scene, checked
from .scene_graph import SceneGraph
from .section_law import SectionLaw, StationLoad
from .solution import Peak, Solution

_CLOSE = 1e-12
"""How closely a peak is enclosed, over the step between instants."""

_ROUNDING = 1e-13
"""By how much of the largest value others must differ to count as larger or smaller."""

_SAME = 1e-6
"""How closely a graph must give what a solution has, over the largest value of the same unit."""

_NOTHING = 1e-12
"""What is zero but for rounding, over what is largest."""

_TRIALS, _TRIALS_BY_LINE = 150, 8


def refine(scene: Scene, solution: Solution, names: Iterable[str] | None = None) -> list[Peak]:
    """The peaks of quantities of a solution, by full name, or of all: as :meth:`.Solution.peak`, but over all times of its span.

    A peak is sought next to every instant at which the quantity is larger than at its neighbours and from which it could rise
    above all instants; what rises and falls again wholly between two instants is not seen. A smooth peak is exact to rounding, its
    time to 1e-12 of the step or the derivative's rounding, and so is one at a kink or on the higher side of a jump. Where a
    quantity grows without bound, as where the drive that a row replaces could do nothing, the peak is infinite. No peak is below
    that of the instants, and what equilibrium does not determine is NaN here too.

    Raises :class:`DeclarationError` where the solution is not of this scene, :class:`UnknownNameError` for a name that is none.
    """
    cycle = _Cycle.of(scene, solution)
    return [cycle.peak(name) for name in (solution.names() if names is None else names)]


@dataclass(frozen=True)
class Shortfall:
    """How far the peaks over ``count`` instants fall short of the true ones, over the true ones: the worst and the median force.

    ``sampled`` is at the instants, ``refined`` between them by :func:`refine`.
    """

    count: int
    sampled_worst: float
    sampled_median: float
    refined_worst: float
    refined_median: float


def shortfall(
    scene: Scene, counts: Sequence[int], names: Iterable[str] | None = None, *, parameters: Mapping[str, float] | None = None
) -> list[Shortfall]:
    """How far peaks fall short where the scene's own span of time is cut into so many instants, a row for each of ``counts``.

    ``names`` are full names of quantities; by default all efforts, reactions and section forces that are wanted and determined.
    Those that are zero but for rounding, or grow without bound, are left out. The true peaks are the largest refined ones, of all
    counts and of twice as many instants. Raises :class:`DeclarationError` for no counts or where no quantity is left, and what
    :func:`.evaluate` raises, as for so few instants that loops cannot be followed.
    """
    start, stop, own = checked("t", scene.t)
    if not counts:
        raise DeclarationError("shortfall: expected at least one number of instants")
    solutions = [
        evaluate(scene, t=(start, stop, count), parameters=parameters, backend="vm", certificate=False)
        for count in (*counts, 2 * max(*counts, own))
    ]
    last = solutions[-1]
    chosen = [name for name in (forces(last) if names is None else names) if last.determined(name)]
    refined = np.array([[abs(peak.value) for peak in refine(scene, solution, chosen)] for solution in solutions])
    sampled = np.array([[abs(solution.peak(name).value) for name in chosen] for solution in solutions])
    true = refined.max(axis=0, initial=0.0)
    finite = np.where(np.isfinite(true), true, 0.0)
    units = np.array([last.unit(name) for name in chosen])
    there = np.array([x > _NOTHING * finite[units == unit].max() for x, unit in zip(finite, units, strict=True)], dtype=bool)
    if not there.any():
        raise DeclarationError("shortfall: no quantity is there that is determined and not zero")
    missing = [1.0 - peaks[:-1, there] / true[there] for peaks in (sampled, refined)]
    columns = [spread(rows, axis=1) for rows in missing for spread in (np.max, np.median)]
    return [Shortfall(count, *map(float, row)) for count, *row in zip(counts, *columns, strict=True)]


def forces(solution: Solution) -> list[str]:
    """The full names of a solution's efforts, reactions and section forces that equilibrium determines."""
    wanted = (name for name in solution.names() if name.startswith(("effort:", "reaction:", "section:")))
    return [name for name in wanted if solution.determined(name)]


@functools.lru_cache(maxsize=32)
def rates(graph: SceneGraph) -> ca.Function:
    """The columns of a graph and, where loops are closed, their time derivatives along the motion.

    ``rates(tz, p) -> (out, out_rate)``, where ``tz`` is the time above the iterated coordinates.
    """
    instant, newton, laws = differentiable(graph.instant), graph.newton, graph.scene.motion
    tz, p = ca.MX.sym("tz", 1 + instant.size1_in("z")), ca.MX.sym("p", instant.size1_in("p"))
    t, z = tz[0], tz[1:]
    still = ca.DM.zeros(p.numel())
    d, d_rate, d_acceleration = graph.motion(t, p)
    d_jerk = jerk_function({joint: laws[joint] for joint in graph.driven}, graph.scene.mechanism.symbols)(t, p)
    z_rate = ca.MX(0, 1)
    if newton is not None:
        # The correction is -Phi_z^-1 Phi, and where Phi = 0 its time derivative at fixed z is z'.
        closed = (z, t, d, p)
        z_rate = newton.step.forward(1)(*closed, *newton.step(*closed), ca.DM.zeros(z.numel()), 1, d_rate, still)[0]
    place = (t, d, d_rate, d_acceleration, z, p)
    out = instant(*place)
    out_rate = instant.forward(1)(*place, out, 1, d_rate, d_acceleration, d_jerk, z_rate, still)
    both = ca.Function("rates", [tz, p], [out, ca.densify(out_rate)], ["tz", "p"], ["out", "out_rate"])
    return both if any(laws[joint].spline for joint in graph.driven) else both.expand("rates", {"cse": True})


class _Points(NamedTuple):
    """A quantity at some times: its value, the ratio where it is taken, and its size and the time derivative of that."""

    t: Array
    value: Array
    xi: Array
    size: Array
    slope: Array

    def at(self, which: Any) -> _Points:
        """Some of the times."""
        return _Points(*(values[which] for values in self))

    def choose(self, where: npt.NDArray[np.bool_], other: _Points) -> _Points:
        """These where told, else the others."""
        return _Points(*(np.where(where, mine, others) for mine, others in zip(self, other, strict=True)))


@dataclass(frozen=True, eq=False)
class _Cycle:
    """A solution, and what its quantities and their time derivatives are at any time of its span."""

    graph: SceneGraph
    solution: Solution
    p: Array
    z: Array
    rows: Mapping[str, int]

    @classmethod
    def of(cls, scene: Scene, solution: Solution) -> _Cycle:
        mechanism = scene.mechanism
        told = mechanism.values({name: parameter["value"] for name, parameter in solution.description["parameters"].items()})
        wanted = list(dict.fromkeys(_output(name) for name in solution.series))
        graph = derive(assembled(scene, told, wanted), wanted)
        p = np.array(list(told.values()))
        z, _ = follow(graph, solution.t, p)
        cycle = cls(graph, solution, p, z, {name: k for k, name in enumerate(graph.columns)})
        if not cycle.agrees():
            raise DeclarationError(f"the solution of '{solution.case}' is not one of this scene of '{mechanism.name}'")
        return cycle

    def agrees(self) -> bool:
        """Whether the graph gives what the solution has: at one of three instants, for at a jump rounding decides."""
        solution = self.solution
        names = [name for name in solution.series if name not in solution.undetermined]
        if not all(name in self.rows for name in names):
            return False
        names = [name for name in names if name not in self.graph.wrapped]
        some = np.array([0, solution.t.size // 2, solution.t.size - 1])
        out, _ = self._columns(solution.t[some], some)
        sizes = dict.fromkeys(map(solution.unit, names), 0.0)
        for name in names:
            sizes[solution.unit(name)] = max(sizes[solution.unit(name)], float(np.max(np.abs(solution.series[name]))))
        rounding = _NOTHING * max(sizes.values(), default=0.0)
        gaps = [np.abs(out[self.rows[name]] - solution.series[name][some]) for name in names]
        limits = [_SAME * sizes[solution.unit(name)] + rounding for name in names]
        return bool(np.all([gap <= limit for gap, limit in zip(gaps, limits, strict=True)], axis=0).any())

    def peak(self, name: str) -> Peak:
        """The peak of a quantity over all times."""
        solution = self.solution
        if not solution.determined(name):
            return solution.peak(name)
        t, (values, places) = solution.t, solution.extremes(name)
        sizes = np.abs(values)
        best = sizes.max()
        first = _summits(sizes)
        tops = self._points(name, t[first], first)
        second = first + np.sign(tops.slope).astype(int)
        rising = (second != first) & (second >= 0) & (second < t.size)
        first, second, tops = first[rising], second[rising], tops.at(rising)
        # A tangent bounds an arc that is concave.
        worth = tops.size + np.abs(tops.slope * (t[second] - t[first])) > best * (1.0 + _ROUNDING)
        if not worth.any():
            return solution.peak(name)
        found = self._enclose(name, first[worth], second[worth])
        k = int(np.argmax(found.size))
        if not found.size[k] > best:
            return solution.peak(name)
        xi = None if places is None else float(found.xi[k])
        return Peak(name, float(found.value[k]), solution.unit(name), float(found.t[k]), xi)

    def _enclose(self, name: str, first: Any, second: Any) -> _Points:
        """The peaks between pairs of instants, from the first of which a quantity, larger there, rises towards the second."""
        t = self.solution.t
        low, high = (self._points(name, t[ends], first) for ends in (np.minimum(first, second), np.maximum(first, second)))
        close = np.maximum(_CLOSE * (high.t - low.t), 4.0 * np.spacing(np.maximum(np.abs(low.t), np.abs(high.t))))
        weights, before = np.ones((2, first.size)), np.full(first.size, np.nan)
        for trial in range(_TRIALS):
            if np.all(high.t - low.t <= close):
                break
            middle = self._points(name, _between(low, high, weights, close, trial), first)
            # A peak lies between the larger end and whatever is below it, whichever way that slopes: it may be beyond a jump.
            larger = np.maximum(low.size, high.size)
            left = np.where(middle.size < larger * (1.0 - _ROUNDING), low.size < high.size, middle.slope > 0.0)
            stays = np.where(left == before, 0.5, 1.0)
            weights = np.where(left, [np.ones_like(stays), weights[1] * stays], [weights[0] * stays, np.ones_like(stays)])
            low, high, before = middle.choose(left, low), high.choose(left, middle), left.astype(float)
        found = low.choose(low.size >= high.size, high)
        # At a pole a value goes on growing however near it is.
        endless = np.abs(found.slope) * (high.t - low.t) > found.size / 10
        return found._replace(
            value=np.where(endless, np.copysign(np.inf, found.value), found.value), size=np.where(endless, np.inf, found.size)
        )

    def _points(self, name: str, t: Array, near: Any) -> _Points:
        """A quantity at times each of which is next to an instant, given by its number.

        Where along a link a force is largest moves, but for the rate of its size only at a station does that count.
        """
        out, out_rate = self._columns(t, near)
        if not name.startswith("section:"):
            value, rate = out[self.rows[name]], out_rate[self.rows[name]]
            if name in self.graph.wrapped:
                value = value + math.tau * np.round((self.solution.series[name][near] - value) / math.tau)
            xi = np.zeros_like(t)
        else:
            _, link, force = name.split(":")
            law, law_rate = self._law(link, out), self._law(link, out_rate)
            xi, value = law.extreme(force)
            places = xi[:, None]
            tip, base = (law.at(force, places, side)[:, 0] for side in ("tip", "base"))
            beyond, before = (law.rate(force, law_rate, places, side)[:, 0] for side in ("tip", "base"))
            rate = np.where(np.abs(base) > np.abs(tip), before, beyond)
        size = np.where(np.isfinite(value), np.abs(value), -np.inf)
        return _Points(t, value, xi, size, np.nan_to_num(np.sign(value) * rate))

    def _columns(self, t: Array, near: Any) -> tuple[Array, Array]:
        """The columns of the graph and their time derivatives; NaN where iterated loops do not close."""
        z = np.zeros((self.z.shape[0], t.size))
        failed = np.zeros(t.size, dtype=bool)
        for i in range(t.size if self.graph.newton else 0):
            at, status = follow(self.graph, t[i : i + 1], self.p, self.z[:, near[i]])
            z[:, i], failed[i] = at[:, 0], status[0] == NOT_CONVERGED
        out, out_rate = (np.where(failed, np.nan, x.full()) for x in rates(self.graph)(np.vstack([t, z]), self.p))
        return out, out_rate

    def _law(self, link: str, columns: Array) -> SectionLaw:
        """A link's law with columns of the graph, or of their rates, for its coefficients, loads and stations."""
        law = self.solution.section(link).law

        def row(member: str) -> Array:
            return np.asarray(columns[self.rows[f"section:{link}:{member}"]])

        coefficients = {name: row(f"law:{name}") for name in law.coefficients}
        loads = (StationLoad(load.name, *(row(f"{load.name}:{m}") for m in ("station", "n", "f", "m"))) for load in law.loads)
        return replace(law, coefficients=coefficients, loads=tuple(loads))


def _summits(sizes: Array) -> npt.NDArray[np.intp]:
    """Where values are larger than the one before and not smaller than the one after; an end has no neighbour there."""
    around = np.concatenate([[-np.inf], sizes, [-np.inf]])
    return np.flatnonzero((sizes > around[:-2]) & (sizes >= around[2:]))


def _between(low: _Points, high: _Points, weights: Array, close: Array, trial: int) -> Array:
    """Times to try: where a line through the slopes is zero; later in turn that, where the tangents meet, and the middle.

    The line finds a smooth peak, with the slope of an end that stays weighted down (the Illinois method); tangents meet at a kink;
    and halving, which serves too where the ends do not both rise inward, ends the search wherever there is a jump or a pole.
    """
    width = high.t - low.t
    up, down = low.slope, high.slope
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if trial < _TRIALS_BY_LINE or trial % 3 == 0:
            ahead = width * weights[0] * up / (weights[0] * up - weights[1] * down)
        elif trial % 3 == 1:
            ahead = (high.size - low.size - down * width) / (up - down)
        else:
            ahead = width / 2
        inside = (up >= 0.0) & (down <= 0.0) & (ahead >= 0.0) & (ahead <= width)
    # A little off the ends, so that the other end comes near too.
    off = np.minimum(close, width) / 2
    return np.asarray(low.t + np.clip(np.where(inside, ahead, width / 2), off, width - off))


def _output(name: str) -> str:
    """The output that a quantity is part of."""
    kind, part, *_ = name.split(":")
    return {"effort": "effort", "motion": "motion", "pose": "motion"}.get(kind, f"{kind}:{part}")
