"""The search for a design: from several starts, by programs whose points grow until no peak between them exceeds a limit."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..declare.density import Array
from ..declare.scene import Scene
from ..declare.times import Times
from ..designs.engine import DesignEngine
from ..errors import AssemblyError, DeclarationError, NoDesignError, UnknownNameError
from ..instants.refusal import Status
from ..instants.rung import Backend, Rung
from ..quantities import Output
from .look import Look, Point
from .optimum import Limit, Optimum, Start
from .program import Box, Found, Held, Program
from .terms import Constraint, Term
from .values import Followed, PointValues

_SCREENED = 256
"""Designs, evenly spread, among which the starts are chosen."""

_ROUNDS, _HALVINGS = 40, 12
_HOLDS = 1e-7
"""Of its limit: by how much a constraint may be violated that holds."""

_KEEP = 0.7
"""Of the largest: local peaks that a program knows from the beginning."""

_NEAR = 1e-3
"""Of its scale: how near to its limit a local peak is that later programs know too."""

_PEAKS, _TRIALS, _NUDGE, _REACH = 24, 6, 1e-2, 8.0
"""Local peaks that are looked for; steps of Newton's method to each; steps between instants, of which second derivatives are taken,
and which a peak follows at most."""

_STEEP = 1e-4
"""Of its value: how much a quantity changes in a step of time where its peak is not smooth."""

_APART = 0.15
_CLOSED = 12
"""Instants at which a program watches how its loops close, from the beginning."""


@dataclass(frozen=True, eq=False)
class _Judged:
    """A design as it is: the value of every term, objective first, and the worst excess over a limit; NaN without a result."""

    p: Array
    values: Array
    excess: float
    look: Look | None
    closure: float = math.nan
    points: tuple[tuple[tuple[Point, float], ...], ...] = ()

    @property
    def merit(self) -> tuple[float, float]:
        """What a better design has less of."""
        if math.isnan(self.excess):
            return math.inf, math.inf
        return (max(self.excess, 0.0) if self.excess > _HOLDS else 0.0), float(self.values[0])


@dataclass(eq=False)
class _Search:
    """A search under way."""

    engine: DesignEngine
    box: Box
    objective: Term
    constraints: tuple[Constraint, ...]
    least_closure: float
    program: Program
    progress: Callable[[int, float, float], None] | None
    history: list[list[float]] = field(default_factory=list)
    evaluations: int = 0
    scales: tuple[float, ...] = ()

    @property
    def terms(self) -> tuple[Term, ...]:
        return (self.objective, *(c.term for c in self.constraints))

    def judge(self, p: Array, *, closely: bool = True) -> _Judged:
        """A design's terms, by the engine of sweeps; largest and smallest values by its instants and parabolas between them."""
        self.evaluations += 1
        engine, graph = self.engine, self.program.values.graph
        found = engine.evaluate(p[None], threads=1)
        if found.status[0] != Status.OK:
            return _Judged(p, np.full(len(self.terms), np.nan), math.nan, None)
        look, closure = None, math.nan
        if closely or any(term.kind in ("max", "min") for term in self.terms):
            look = Look.at(graph, engine.times.of(p[None])[0][0], p, engine.rung)
            closures = look.closures()
            closure = float(closures.min()) if closures.size else math.nan
            if closures.size and not closure > 0.0:
                return _Judged(p, np.full(len(self.terms), np.nan), math.nan, None)
        values, points = [], []
        for term in self.terms:
            own: list[tuple[Point, float]] = []
            if look is not None and term.output is not None and not term.averaged:
                own = self._points(look, term)
                if term.kind == "peak":
                    k = engine.quantities.index(term.name)
                    own = [*_told(own, look, float(found.value[0, k]), float(found.t[0, k]), float(found.xi[0, k])), *own]
            points.append(tuple(own))
            if term.kind == "parameter":
                values.append(float(p[list(engine.parameters).index(term.name)]))
            elif term.kind == "peak":
                values.append(abs(float(found.value[0, engine.quantities.index(term.name)])))
            elif term.averaged:
                values.append(float(getattr(found, term.kind)[0, engine.efforts.index(term.name)]))
            else:
                values.append(
                    max((sign * point.value for point, sign in own), default=math.nan) * (-1 if term.kind == "min" else 1)
                )
        excess = max((c.excess(v) / _scale(c, v) for c, v in zip(self.constraints, values[1:], strict=True)), default=-math.inf)
        if not math.isnan(closure):
            excess = max(excess, (self.least_closure - closure) / self.least_closure)
        excess = excess if np.isfinite(values).all() else math.nan
        return _Judged(p, np.array(values), excess, look, closure, tuple(points))

    def _points(self, look: Look, term: Term) -> list[tuple[Point, float]]:
        """The local peaks of a term, the largest first, with the signs by which they count."""
        assert term.output is not None
        if term.kind != "peak":
            sign = -1.0 if term.kind == "min" else 1.0
            return [(point, sign) for point in look.points(term.output, sign)]
        return [(point, math.copysign(1.0, point.value)) for point in look.points(term.output, 0.0)]

    def note(self, start: int, judged: _Judged) -> None:
        row = [float(start), float(judged.values[0]), judged.excess, float(judged.look is not None)]
        self.history.append([*row, *judged.p[list(self.box.places)].tolist()])
        if self.progress is not None:
            self.progress(start, float(judged.values[0]), judged.excess)

    def descend(self, number: int, first: _Judged, better: Callable[[_Judged, Found | None, str], None]) -> None:
        """Go from a design to the best near it; ``better`` is told every design on the way."""
        self.note(number, first)
        better(first, None, "start")
        look = first.look
        assert look is not None
        # A program is of one scale.
        values = zip(self.constraints, first.values[1:].tolist(), strict=True)
        self.scales = self.scales or (abs(float(first.values[0])) or 1.0, *(_scale(c, v) for c, v in values))
        held = [Held(self.objective, None, self.scales[0])]
        held += [Held(c.term, c.limit, scale, c.least) for c, scale in zip(self.constraints, self.scales[1:], strict=True)]
        near = (look.t[-1] - look.t[0]) / max(look.t.size - 1, 1) * 1e-6
        closures = [look.instant(k) for k in np.unique(np.linspace(0, look.t.size - 1, _CLOSED).astype(int)).tolist()]
        self._learn(held, closures, first, near, everything=True)
        current, tried = first, 0
        averages = look
        for _ in range(_ROUNDS):
            every = [averages.instant(k) for k in range(averages.t.size)] if self.program.averaged else []
            found = self.program.solve(self.box.share(current.p), held, closures, every)
            x = found.x
            if not np.isfinite(x).all():
                better(current, None, "the program has no solution: no derivative where it looked")
                return
            following = self.judge(self.box.all(x))
            self.note(number, following)
            back = 0
            while following.look is None and back < _HALVINGS:
                # Loops do not close somewhere between the points: go back until they do, and look there from then on.
                back += 1
                x = (x + self.box.share(current.p)) / 2
                following = self.judge(self.box.all(x))
            if following.look is None:
                better(current, None, "loops close nowhere near")
                return
            added = self._learn(held, closures, following, near, everything=back > 0)
            done = not back and self._settled(found, following)
            moved = float(np.abs(self.box.share(following.p) - self.box.share(current.p)).max())
            better(following, found if not back else None, "converged" if done else f"IPOPT: {found.status}")
            if done and found.status == "Solve_Succeeded":
                return
            tried = tried + 1 if moved <= 1e-9 and not added else 0
            current, averages = following, following.look
            if tried >= 2:
                return

    def _settled(self, found: Found, judged: _Judged) -> bool:
        """Whether a program's solution is what it says, with all peaks that it did not know."""
        gap = abs(judged.values[0] - found.objective) / (abs(judged.values[0]) or 1.0)
        return judged.excess <= _HOLDS and gap <= _HOLDS

    def _learn(self, held: Sequence[Held], closures: list[Point], judged: _Judged, near: float, *, everything: bool) -> bool:
        """Hold terms at the peaks of a design that programs do not know; whether there were any."""
        added = False
        assert judged.look is not None
        for k, (term, points) in enumerate(zip(held, judged.points, strict=True)):
            if not points:
                continue
            largest = points[0][1] * points[0][0].value
            least = _KEEP * largest if largest > 0.0 else largest / _KEEP
            if not everything:
                # Only what may exceed what the program found.
                level = largest if k == 0 else term.bound
                least = max(least, level - _NEAR * term.scale)
            exact = self._exact(term.term, points, judged)
            for point, sign in exact:
                if sign * point.value >= least:
                    added |= term.add(point, sign, near)
            if not term.points:
                added |= term.add(*exact[0], near)
        sines = judged.look.closures()
        for row in sines:
            k = int(np.argmin(row))
            point = judged.look.instant(k)
            if row[k] < 4 * self.least_closure and all(abs(point.t - other.t) > near for other in closures):
                closures.append(point)
                added = True
        return added

    def _exact(self, term: Term, points: Sequence[tuple[Point, float]], judged: _Judged) -> list[tuple[Point, float]]:
        """Local peaks, the smooth ones where the derivatives by time and place are zero, and how they follow from there."""
        look = judged.look
        assert look is not None
        followed = self.program.functions[term.name]
        step = (look.t[-1] - look.t[0]) / max(look.t.size - 1, 1)
        found = []
        for point, sign in points[:_PEAKS]:
            where = np.zeros(followed.size)
            where[min(point.place, followed.size - 1)] = 1.0
            free = bool(term.output and term.output.group == "section" and point.place == 0 and 0.0 < point.xi < 1.0)
            found.append((_top(followed, point, judged.p, where, sign, step, (look.t[0], look.t[-1]), free=free), sign))
        return found


def _top(
    followed: Followed, point: Point, p: Array, where: Array, sign: float, step: float, span: tuple[float, float], *, free: bool
) -> Point:
    """The smooth peak that is near a point, by Newton's method; the point itself where there is none. ``free`` may xi be."""
    guess = list(point.guess)
    nudges = np.array([_NUDGE * step, _NUDGE])

    def slopes(at: Array) -> Array:
        found = followed.slopes(at[0], guess, p, at[1], where).full().ravel()
        return found if free else np.array([found[0], 0.0])

    at = np.array([point.t, point.xi])
    turn = np.zeros((2, 2))
    for _ in range(_TRIALS):
        if not span[0] < at[0] < span[1] or (free and not 0.0 < at[1] < 1.0):
            return point
        bend = np.zeros((2, 2))
        for k in range(1 + free):
            nudge = np.eye(2)[k] * nudges
            bend[k] = (slopes(at + nudge) - slopes(at - nudge)) / (2 * nudges[k])
        bend = (bend + bend.T) / 2
        size = 2 if free else 1
        inner = bend[:size, :size]
        if not np.isfinite(inner).all() or not (np.linalg.eigvalsh(sign * inner) < 0.0).all():
            return point
        turn = np.zeros((2, 2))
        turn[:size, :size] = -np.linalg.inv(inner)
        away = turn @ slopes(at)
        if not (abs(away[0]) <= step and abs(away[1]) <= 0.1):
            return point
        at = at + away
        if abs(away[0]) <= 1e-9 * step and abs(away[1]) <= 1e-9:
            break
    value = float(followed.value(at[0], guess, p, at[1], where))
    if not sign * value >= sign * point.value - 1e-9 * abs(point.value):
        return point
    reach = (_REACH * step, 0.1 if free else 0.0)
    return replace(
        point,
        t=float(at[0]),
        xi=float(at[1]),
        value=value,
        turn=(float(turn[0, 0]), float(turn[0, 1]), float(turn[1, 1])),
        reach=reach,
    )


def _told(points: Sequence[tuple[Point, float]], look: Look, value: float, t: float, xi: float) -> list[tuple[Point, float]]:
    """The largest of local peaks, where it is between instants."""
    sign = math.copysign(1.0, value)
    step = (look.t[-1] - look.t[0]) / max(look.t.size - 1, 1)
    near = [point for point, its in points if its == sign and abs(point.t - t) <= 2 * step]
    ratio = 0.0 if math.isnan(xi) else xi

    def apart(point: Point) -> float:
        return abs(point.xi - ratio) + abs(point.value - value) / abs(value)

    if not near or value == 0.0:
        k = int(np.argmin(np.abs(look.t - t)))
        return [(Point(t, ratio, 0, value, look.instant(k).guess), sign)]
    best = min(near, key=apart)
    return [(Point(t, ratio, best.place, value, best.guess), sign)]


def _scale(constraint: Constraint, value: float) -> float:
    return abs(constraint.limit) or abs(value) or 1.0


def optimise(
    scene: Scene,
    *,
    minimise: str,
    over: Mapping[str, tuple[Any, Any]],
    subject_to: Sequence[str] = (),
    starts: int | Sequence[Mapping[str, float]] = 4,
    transmission: float = 0.05,
    t: Times | None = None,
    parameters: Mapping[str, float] | None = None,
    backend: Backend = "auto",
    progress: Callable[[int, float, float], None] | None = None,
) -> Optimum:
    """Find the values of parameters for which a peak, or a mean, is least.

    Parameters
    ----------
    minimise
        ``peak:QUANTITY``, the largest size of a quantity over the whole motion; ``max:QUANTITY``, its largest value; ``mean:`` or
        ``rms:`` of an effort or an output; or a parameter's name.
    over
        The parameters to choose, and of each its least and its largest value.
    subject_to
        Constraints, as ``"peak:effort:O <= 12"``; ``min:QUANTITY`` is for those from below. They hold at all times of the motion,
        and along the whole link.
    starts
        How many designs the search starts from: the best of designs spread evenly over the bounds, with the parameters' own values
        among them. Or values of parameters for each start.
    transmission
        The least sine of a loop's transmission angle, of an iterated loop of its volume.
    t
        Instants, as in :func:`.evaluate`.
    parameters
        Values of the parameters that are not chosen.
    progress
        Is called after each step with the number of the start, the objective and the worst excess over a limit.

    Programs with some points of every quantity are solved by IPOPT with exact derivatives. What exceeds a limit elsewhere is added
    to them, until nothing does. An interrupt ends the search; the best design so far is given. One that violates a constraint is
    marked: it is not ``feasible``.

    Raises :class:`DeclarationError`, :class:`UnknownNameError` and :class:`ParameterError` for mistakes in the arguments,
    :class:`NoDesignError` where no design has a result.
    """
    if not isinstance(scene, Scene):
        raise DeclarationError(f"optimise: expected a Scene, got {scene!r}")
    declared = scene.mechanism.parameters
    objective = Term.parse(minimise, declared)
    if objective.kind == "min":
        raise DeclarationError(f"minimise: a smallest value has no least one that could be told; use max:{objective.name}")
    constraints = tuple(Constraint.parse(text, declared) for text in subject_to)
    box = _box(scene, over, parameters)
    if not (0.0 < transmission < 1.0):
        raise DeclarationError(f"transmission: expected a sine between 0 and 1, got {transmission!r}")
    outputs = [term.output for term in (objective, *(c.term for c in constraints)) if term.output is not None]
    wanted = list(dict.fromkeys(map(_wanted, outputs))) or ["motion"]
    engine = DesignEngine.of(scene, wanted, rung=Rung(backend), timing=scene.timing(t))
    if not engine.times.common:
        raise DeclarationError("optimise: the instants must be the same for all designs; give t in numbers")
    for term in (objective, *(c.term for c in constraints)):
        there = engine.efforts if term.averaged else engine.quantities
        if term.output is not None and term.name not in there:
            raise UnknownNameError(f"quantity with a {term.kind}", term.name, there)
    instants = engine.times.of(box.p[None])[0][0]
    program = Program(PointValues(engine.graph), box, objective, constraints, instants, transmission**2)
    search = _Search(engine, box, objective, constraints, transmission**2, program, progress)
    return _run(search, starts)


def _box(scene: Scene, over: Mapping[str, tuple[Any, Any]], parameters: Mapping[str, float] | None) -> Box:
    """The parameters to choose. Raises :class:`DeclarationError` for what is no pair of bounds, or out of a parameter's range."""
    declared = scene.mechanism.parameters
    if not isinstance(over, Mapping) or not over:
        raise DeclarationError(f"over: expected bounds by parameter, as {{'l': (0.15, 0.4)}}, got {over!r}")
    names, low, high = tuple(over), [], []
    for name, bounds in over.items():
        if name not in declared:
            raise UnknownNameError("parameter", name, declared)
        if not isinstance(bounds, (tuple, list)) or len(bounds) != 2:
            raise DeclarationError(f"over: expected (least, largest) for '{name}', got {bounds!r}")
        for bound in bounds:
            declared[name].check(bound)
        a, b = (declared[name].number(bound) for bound in bounds)
        if not a < b:
            raise DeclarationError(f"over: of '{name}' the least value {a:g} must be below the largest, {b:g}")
        low.append(a)
        high.append(b)
    values = scene.mechanism.values(parameters)
    places = tuple(list(declared).index(name) for name in names)
    return Box(names, places, np.array(low), np.array(high), np.array(list(values.values())))


def _wanted(output: Output) -> str:
    kinds = {"effort": "effort", "motion": "motion", "pose": "motion"}
    return kinds.get(output.group, f"{output.group}:{output.part}")


def _spread(count: int, dimensions: int) -> Array:
    """Points of the unit cube, evenly spread: multiples of powers of the generalized golden ratio (Roberts 2018), less their whole
    parts."""
    ratio = 2.0
    for _ in range(64):
        ratio = (1.0 + ratio) ** (1.0 / (dimensions + 1))
    return np.asarray((0.5 + np.outer(np.arange(1, count + 1), ratio ** -np.arange(1.0, dimensions + 1))) % 1.0)


def _begin(search: _Search, starts: int | Sequence[Mapping[str, float]]) -> list[_Judged]:
    """The designs to start from. Raises :class:`NoDesignError` where none has a result."""
    box, declared = search.box, list(search.engine.parameters)
    if not isinstance(starts, int):
        rows = []
        for values in starts:
            p = box.p.copy()
            for name, value in values.items():
                if name not in box.names:
                    raise UnknownNameError("parameter that is chosen", name, box.names)
                p[declared.index(name)] = value
            rows.append(box.all(np.clip(box.share(p), 0.0, 1.0)))
        judged = [search.judge(p) for p in rows]
    else:
        if isinstance(starts, bool) or starts < 1:
            raise DeclarationError(f"starts: expected a whole number above 0, or values of parameters, got {starts!r}")
        shares = np.vstack([np.clip(box.share(box.p), 0.0, 1.0)[None], _spread(_SCREENED, len(box.names))])
        rows = [box.all(x) for x in shares]
        order = sorted((search.judge(p, closely=False) for p in rows), key=lambda one: one.merit)
        judged = []
        for one in order:
            share = box.share(one.p)
            apart = all(np.abs(share - box.share(other.p)).max() >= _APART for other in judged)
            if len(judged) < starts and apart and math.isfinite(one.merit[0]):
                judged.append(one)
        judged = [search.judge(one.p) for one in judged]
    judged = [one for one in judged if one.look is not None]
    if not judged:
        raise NoDesignError("optimise: no design within the bounds has a result; evaluate one to see why")
    return judged


def _run(search: _Search, starts: int | Sequence[Mapping[str, float]]) -> Optimum:
    """Search from all starts, and keep the best."""
    judged = _begin(search, starts)
    best: list[tuple[_Judged, Found | None, str, int]] = []
    ends: list[Start] = []
    stopped = False
    for number, first in enumerate(judged):
        own: list[tuple[_Judged, Found | None, str, int]] = []

        def better(found: _Judged, by: Found | None, ending: str, own: Any = own, number: int = number) -> None:
            if not own or found.merit <= own[-1][0].merit or (by is not None and ending == "converged"):
                own.append((found, by, ending, number))

        try:
            search.descend(number, first, better)
        except KeyboardInterrupt:
            stopped = True
        except AssemblyError as error:
            own.append((first, None, str(error), number))
        if own:
            last = min(reversed(own), key=lambda one: _rounded(one[0].merit))
            best.append(last)
            ends.append(_start(search, first, last))
        if stopped:
            break
    if not best:
        raise NoDesignError("optimise: stopped before a design was looked at")
    return _optimum(search, best, ends, stopped=stopped)


def _rounded(merit: tuple[float, float]) -> tuple[float, float]:
    """A merit less its last digits, so that of designs as good the one that converged is taken."""
    return merit[0], float(f"{merit[1]:.8g}")


def _start(search: _Search, first: _Judged, last: tuple[_Judged, Found | None, str, int]) -> Start:
    chosen = list(search.box.places)

    def told(p: Array) -> dict[str, float]:
        return dict(zip(search.box.names, p[chosen].tolist(), strict=True))

    return Start(told(first.p), told(last[0].p), float(last[0].values[0]), last[0].excess, last[2])


def _optimum(
    search: _Search, best: Sequence[tuple[_Judged, Found | None, str, int]], ends: Sequence[Start], *, stopped: bool
) -> Optimum:
    judged, found, ending, number = min(best, key=lambda one: _rounded(one[0].merit))
    box = search.box
    multipliers = found.multipliers if found else (math.nan,) * len(search.constraints)
    limits = []
    for constraint, value, multiplier in zip(search.constraints, judged.values[1:].tolist(), multipliers, strict=True):
        near = abs(constraint.excess(value)) <= 1e-5 * _scale(constraint, value)
        limits.append(Limit(constraint, value, bool(near), float(multiplier) if near else 0.0))
    bounds = dict.fromkeys(box.names, math.nan)
    if found is not None:
        by_unit = found.bounds / (box.high - box.low)
        at_bound = np.minimum(found.x, 1.0 - found.x) <= 1e-6
        bounds = dict(zip(box.names, np.where(at_bound, by_unit, 0.0).tolist(), strict=True))
    everything = dict(zip(search.engine.parameters, judged.p.tolist(), strict=True))
    scene = search.engine.scene
    output = search.objective.output
    unit = scene.mechanism.parameters[search.objective.name].unit if output is None else output.unit(scene.mechanism)
    return Optimum(
        case=scene.mechanism.name,
        minimised=search.objective,
        unit=unit,
        values={name: everything[name] for name in box.names},
        parameters=everything,
        objective=float(judged.values[0]),
        start=ends[[one[3] for one in best].index(number)],
        starts=tuple(ends),
        limits=tuple(limits),
        bounds=bounds,
        transmission=math.sqrt(judged.closure) if judged.closure >= 0.0 else math.nan,
        feasible=judged.excess <= _HOLDS,
        converged=ending == "converged" and found is not None,
        stopped=stopped,
        residual=found.residual if found else math.nan,
        curvature=found.curvature if found else math.nan,
        history=np.array(search.history),
        evaluations=search.evaluations,
        notes=tuple(_notes(search, judged)),
    )


def _notes(search: _Search, judged: _Judged) -> Iterator[str]:
    """Which active peaks are at a kink or a jump, where the program knows one side only."""
    look = judged.look
    assert look is not None
    step = (look.t[-1] - look.t[0]) / max(look.t.size - 1, 1)
    for k, (term, points) in enumerate(zip(search.terms, judged.points, strict=True)):
        active = k == 0 or abs(search.constraints[k - 1].excess(judged.values[k])) <= 1e-5 * search.scales[k]
        if not points or not active:
            continue
        point, _ = points[0]
        followed = search.program.functions[term.name]
        place = np.zeros(followed.size)
        place[min(point.place, followed.size - 1)] = 1.0
        rate = float(followed.slopes(point.t, list(point.guess), judged.p, point.xi, place)[0])
        if abs(rate) * step > _STEEP * abs(point.value) and look.t[0] < point.t < look.t[-1]:
            yield f"{term} is at a kink or a jump, at t = {point.t:.6g} s: what follows it there is its value, not its time"
