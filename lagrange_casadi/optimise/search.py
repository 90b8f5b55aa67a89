"""The search for a design, from several starts."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ..declare.density import Array
from ..declare.scene import Scene
from ..declare.times import Times
from ..designs.engine import DesignEngine
from ..errors import AssemblyError, DeclarationError, NoDesignError, UnknownNameError
from ..instants.rung import Backend, Rung
from ..study.peaks import wanted_for
from .descent import Descent
from .judge import HOLDS, Judge, Judged, scale_of
from .optimum import Limit, Optimum, Start
from .program import Box, Found, Program
from .strength_limits import constraints_of
from .terms import Term
from .values import PointValues

_SCREENED = 256
"""Designs, evenly spread, among which the starts are chosen."""

_STEEP = 1e-4
"""Of its value: how much a quantity changes in a step of time where its peak is not smooth."""

_APART = 0.15
"""Of the bounds: how far starts are from each other."""


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
    constraints = tuple(found for text in subject_to for found in constraints_of(text, scene.mechanism))
    box = _box(scene, over, parameters)
    if not (0.0 < transmission < 1.0):
        raise DeclarationError(f"transmission: expected a sine between 0 and 1, got {transmission!r}")
    outputs = [term.output for term in (objective, *(c.term for c in constraints)) if term.output is not None]
    wanted = list(dict.fromkeys(map(wanted_for, outputs))) or ["motion"]
    engine = DesignEngine.of(scene, wanted, rung=Rung(backend), timing=scene.timing(t))
    if not engine.times.common:
        raise DeclarationError("optimise: the instants must be the same for all designs; give t in numbers")
    for term in (objective, *(c.term for c in constraints)):
        if term.output is None:
            term.of_parameters(scene.mechanism)
        there = engine.efforts if term.averaged else engine.quantities
        if term.output is not None and term.name not in there:
            raise UnknownNameError(f"quantity with a {term.kind}", term.name, there)
    instants = engine.times.of(box.p[None])[0][0]
    program = Program(PointValues(engine.graph), box, objective, constraints, instants, transmission**2)
    return _run(Descent(Judge(engine, program), box, progress), starts)


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


def _spread(count: int, dimensions: int) -> Array:
    """Points of the unit cube, evenly spread: multiples of powers of the generalized golden ratio (Roberts 2018), less their whole
    parts."""
    ratio = 2.0
    for _ in range(64):
        ratio = (1.0 + ratio) ** (1.0 / (dimensions + 1))
    return np.asarray((0.5 + np.outer(np.arange(1, count + 1), ratio ** -np.arange(1.0, dimensions + 1))) % 1.0)


def _begin(search: Descent, starts: int | Sequence[Mapping[str, float]]) -> list[Judged]:
    """The designs to start from. Raises :class:`NoDesignError` where none has a result."""
    box, declared = search.box, list(search.judge.engine.parameters)
    if not isinstance(starts, int):
        rows = []
        for values in starts:
            p = box.p.copy()
            for name, value in values.items():
                if name not in box.names:
                    raise UnknownNameError("parameter that is chosen", name, box.names)
                if not search.box.holds(name, value):
                    raise DeclarationError(f"starts: {name} = {value!r} is not within its bounds")
                p[declared.index(name)] = value
            rows.append(box.all(np.clip(box.share(p), 0.0, 1.0)))
        judged = [search.judge.look(p) for p in rows]
    else:
        if isinstance(starts, bool) or starts < 1:
            raise DeclarationError(f"starts: expected a whole number above 0, or values of parameters, got {starts!r}")
        shares = np.vstack([np.clip(box.share(box.p), 0.0, 1.0)[None], _spread(_SCREENED, len(box.names))])
        rows = [box.all(x) for x in shares]
        order = sorted((search.judge.look(p, closely=False) for p in rows), key=lambda one: one.merit)
        judged = []
        for one in order:
            share = box.share(one.p)
            apart = all(np.abs(share - box.share(other.p)).max() >= _APART for other in judged)
            if len(judged) < starts and apart and math.isfinite(one.merit[0]):
                judged.append(one)
        judged = [search.judge.look(one.p) for one in judged]
    judged = [one for one in judged if one.look is not None]
    if not judged:
        raise NoDesignError("optimise: no design within the bounds has a result; evaluate one to see why")
    return judged


def _run(search: Descent, starts: int | Sequence[Mapping[str, float]]) -> Optimum:
    """Search from all starts, and keep the best."""
    judged = _begin(search, starts)
    best: list[tuple[Judged, Found | None, str, int]] = []
    ends: list[Start] = []
    stopped = False
    for number, first in enumerate(judged):
        own: list[tuple[Judged, Found | None, str, int]] = []

        def better(found: Judged, by: Found | None, ending: str, own: Any = own, number: int = number) -> None:
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


def _start(search: Descent, first: Judged, last: tuple[Judged, Found | None, str, int]) -> Start:
    chosen = list(search.box.places)

    def told(p: Array) -> dict[str, float]:
        return dict(zip(search.box.names, p[chosen].tolist(), strict=True))

    return Start(told(first.p), told(last[0].p), float(last[0].values[0]), last[0].excess, last[2])


def _optimum(
    search: Descent, best: Sequence[tuple[Judged, Found | None, str, int]], ends: Sequence[Start], *, stopped: bool
) -> Optimum:
    judged, found, ending, number = min(best, key=lambda one: _rounded(one[0].merit))
    box = search.box
    multipliers = found.multipliers if found else (math.nan,) * len(search.judge.constraints)
    limits = []
    for constraint, value, multiplier in zip(search.judge.constraints, judged.values[1:].tolist(), multipliers, strict=True):
        near = abs(constraint.excess(value)) <= 1e-5 * scale_of(constraint, value)
        limits.append(Limit(constraint, value, bool(near), float(multiplier) if near else 0.0))
    bounds = dict.fromkeys(box.names, math.nan)
    if found is not None:
        by_unit = found.bounds / (box.high - box.low)
        at_bound = np.minimum(found.x, 1.0 - found.x) <= 1e-6
        bounds = dict(zip(box.names, np.where(at_bound, by_unit, 0.0).tolist(), strict=True))
    everything = dict(zip(search.judge.engine.parameters, judged.p.tolist(), strict=True))
    scene = search.judge.engine.scene
    return Optimum(
        case=scene.mechanism.name,
        minimised=search.judge.program.objective,
        unit=search.judge.program.objective.unit(scene.mechanism),
        values={name: everything[name] for name in box.names},
        parameters=everything,
        objective=float(judged.values[0]),
        start=ends[[one[3] for one in best].index(number)],
        starts=tuple(ends),
        limits=tuple(limits),
        bounds=bounds,
        transmission=math.sqrt(judged.closure) if judged.closure >= 0.0 else math.nan,
        feasible=judged.excess <= HOLDS,
        converged=ending == "converged" and found is not None,
        stopped=stopped,
        residual=found.residual if found else math.nan,
        curvature=found.curvature if found else math.nan,
        history=np.array(search.history),
        evaluations=search.judge.evaluations,
        notes=tuple(_notes(search, judged)),
    )


def _notes(search: Descent, judged: Judged) -> Iterator[str]:
    """Which active peaks are at a kink or a jump, where the program knows one side only."""
    look = judged.look
    assert look is not None
    step = (look.t[-1] - look.t[0]) / max(look.t.size - 1, 1)
    for k, (term, points) in enumerate(zip(search.judge.terms, judged.points, strict=True)):
        active = k == 0 or abs(search.judge.constraints[k - 1].excess(judged.values[k])) <= 1e-5 * search.scales[k]
        if not points or not active:
            continue
        point, _ = points[0]
        followed = search.judge.program.functions[term.name]
        place = np.zeros(followed.size)
        place[min(point.place, followed.size - 1)] = 1.0
        rate = float(followed.slopes(point.t, list(point.guess), judged.p, point.xi, place)[0])
        if abs(rate) * step > _STEEP * abs(point.value) and look.t[0] < point.t < look.t[-1]:
            yield f"{term} is at a kink or a jump, at t = {point.t:.6g} s: what follows it there is its value, not its time"
