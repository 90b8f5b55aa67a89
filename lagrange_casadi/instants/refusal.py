"""What is no result, and why: the first instant at which a loop does not close, or is where its forces are not determined."""

from __future__ import annotations

import enum
import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arithmetic.compensated import DTYPES
from ..base.arrays import Array
from ..base.vocabulary import Precision
from ..codegen.designs import INSIDE, ROUNDS
from ..codegen.emit import NOT_CONVERGED, NOT_FINITE, OK, SLOW
from ..declare.ends import share_beyond
from ..equations.iteration import LARGEST_STEP
from ..equations.kinematics import where
from ..equations.program import Program
from ..equations.turns import LEAP
from ..errors import AssemblyError
from .backends import Evaluated, run
from .rules import Rule, passes_dead_centre, rules
from .rung import Rung

_JAM = "friction there has no force that holds its law, or several; expected less mu, a longer guide, or a push nearer to its line"
_TRIALS, _WIDE = 100, 0.1


class Status(enum.IntEnum):
    """Whether there is a result, or why there is none."""

    OK = OK
    NOT_CONVERGED = NOT_CONVERGED
    NOT_FINITE = NOT_FINITE
    SLOW = SLOW
    OUT_OF_REACH = 4
    JUMPED = 5
    DEAD_CENTRE = 6
    PASSES_DEAD_CENTRE = 7
    MISFIT = 8
    ROW_VIOLATED = 9
    IMPOSSIBLE = 10
    INVALID = 11
    NOT_CLOSED = 12
    UNCERTIFIED = 13
    TURNED = 14
    PEAK_NOT_TOLD = 15
    BEYOND_ENDS = 16
    NO_INSTANTS = 17
    JAMS = 18
    AT_REST = 19
    CORNER = 20

    @property
    def meaning(self) -> str:
        """The same in words."""
        return _MEANINGS[self]


_MEANINGS = {
    Status.OK: "there is a result",
    Status.NOT_CONVERGED: "the iterated loops did not converge",
    Status.NOT_FINITE: "a result is not finite: the mechanism is singular, or its numbers overflow",
    Status.SLOW: "the iterated loops converge slowly: they are near a dead centre",
    Status.OUT_OF_REACH: "a loop cannot be closed: its links do not reach",
    Status.JUMPED: "an iterated loop has jumped to another branch: more instants may help",
    Status.DEAD_CENTRE: "a loop is at a dead centre, a joint in gimbal lock, a bar along its beside, or drives cannot make the "
    "motion: forces are open",
    Status.PASSES_DEAD_CENTRE: "a loop passes a dead centre between two instants, a joint gimbal lock, a bar its beside, or drives "
    "such a place",
    Status.MISFIT: "loops are over-constrained and do not fit",
    Status.ROW_VIOLATED: "the motion violates a non-holonomic constraint",
    Status.IMPOSSIBLE: "a length is not positive, a mass or density is negative, a station is off its link, a move cannot be, "
    "or gears do not fit",
    Status.INVALID: "a parameter is not finite",
    Status.NOT_CLOSED: "what was found for a loop does not satisfy its equations",
    Status.UNCERTIFIED: "the design was checked in full, and fails its certificate: others may be wrong as well",
    Status.TURNED: "an angle that a load sees with its turns might be a turn further",
    Status.PEAK_NOT_TOLD: "a peak cannot be told: too much may hide between the instants; more instants may help",
    Status.BEYOND_ENDS: "what is put into a curve is beyond its ends",
    Status.JAMS: "the mechanism jams: friction has no force that holds its law, or several",
    Status.AT_REST: "a joint that rubs is at rest: its friction is open; take instants that move, or smooth friction",
    Status.CORNER: "the slope of a motion, a constraint or a lift jumps, and forces there are without bound; or one is other at a "
    "place than on both sides",
    Status.NO_INSTANTS: "its instants cannot be: the motion does not go where they are asked for, or they end before they start",
}


@dataclass(frozen=True)
class Refusal:
    """Why there is no result: a status, and the same in words that name the joint, the instant and the driven coordinates."""

    status: Status
    message: str


def refuse(graph: Program, evaluated: Evaluated, t: Array, p: Array, rung: Rung) -> None:
    """Raise :class:`AssemblyError` for the first instant that has no result."""
    found = refusal(graph, evaluated, t, p, rung)
    if found is not None:
        raise AssemblyError(found.message)


def refusal(graph: Program, evaluated: Evaluated, t: Array, p: Array, rung: Rung) -> Refusal | None:
    """Why the first instant that has no result has none; None where all have."""
    held, extent = rules(graph, evaluated.stages.precision, rung.newton), graph.extent(p)
    bad = unfinished(graph, evaluated)
    passed: dict[Rule, npt.NDArray[np.bool_]] = {}
    for rule in held:
        bad |= broken(rule, evaluated.out, extent)
        if rule.kind in ("CLOSURE", "BRANCH"):
            passed[rule] = passes_dead_centre(evaluated.out[rule.column], ends=graph.newton is None)
    for rule, found in passed.items():
        if graph.newton is None and found.any():
            after = np.flatnonzero(found)
            found[after] = _dead_between(graph, rule, t[after], t[after + 1], p, rung)
        bad |= found
    if not bad.any():
        return None
    i = int(np.argmax(bad))
    coordinates = graph.data.kinds.coordinates
    driven = np.atleast_1d(graph.motion(t[i], p)[0].full().ravel())
    at = where((name, coordinates[name], value) for name, value in zip(graph.driven, driven, strict=True))
    at = f"at t = {t[i]:.6g} s{at}"
    bad_one = _Bad(graph, evaluated, held, i, at, [rule for rule in passed if passed[rule][i]], extent)
    status, why = bad_one.why(functools.partial(_left_open, graph, evaluated.iterated[:, i], float(t[i]), p))
    return Refusal(status, _beyond(graph, p, evaluated.stages.precision, at) or why)


def resting(graph: Program, out: Array) -> npt.NDArray[np.bool_]:
    """At which instants of the columns ``out`` (columns, t) a joint that rubs is at rest: what depends on its friction is open."""
    found = np.zeros(out.shape[-1], dtype=bool)
    for row in graph.checks("rest").values():
        found |= np.asarray(out[row]) > 0.5
    return found


def unfinished(graph: Program, evaluated: Evaluated) -> npt.NDArray[np.bool_]:
    """At which instants (t,) there is no result; at rest there is one, beside what friction reaches."""
    return np.asarray((evaluated.status != OK) & ~((evaluated.status == NOT_FINITE) & resting(graph, evaluated.out)))


def broken(rule: Rule, out: Array, extent: float) -> npt.NDArray[np.bool_]:
    """At which instants of the columns ``out`` (columns, t) a rule is broken; what is open is no reason to refuse the rest."""
    column = np.asarray(out[rule.column], float)
    if rule.kind in ("CLOSURE", "BRANCH", "JAM"):
        return np.asarray(~(column > rule.limit))
    if rule.kind == "GAP":
        return np.asarray(~(np.abs(column) <= rule.limit * extent))
    if rule.kind == "MISFIT":
        return np.asarray(~(column <= rule.limit))
    if rule.kind in ("BEYOND", "SLIP"):
        # No number where a loop is open, or at rest: rules of their own say so.
        return np.asarray(column > rule.limit)
    if rule.kind == "ROW":
        # Where all stands still, what rounding leaves of rates violates nothing.
        return np.asarray(~(np.abs(column) <= rule.limit * float(np.fmax.reduce(out[rule.beside], initial=0.0))))
    if rule.kind == "TURNED":
        # Too far from the middle of its swing, or about to be as far on the other side.
        return np.asarray(~(np.abs(column) <= rule.limit) | (np.abs(np.diff(column, append=column[-1:])) > LEAP))
    return np.zeros(column.shape, dtype=bool)


def _dead_between(graph: Program, rule: Rule, start: Array, stop: Array, p: Array, rung: Rung) -> npt.NDArray[np.bool_]:
    """Whether a closure is zero between instants, looked for where it is lowest, ever closer."""
    lowest = np.full(start.size, np.inf)
    for _ in range(ROUNDS):
        inside = np.linspace(start, stop, INSIDE)
        evaluated, _ = run(graph, inside.ravel(), p, Rung(rung.backend, rung.precision, flags=rung.flags))
        closure = evaluated.out[rule.column].reshape(inside.shape)
        place = np.argmin(closure, axis=0)[None]
        lowest = np.fmin(lowest, np.take_along_axis(closure, place, 0)[0])
        start, stop = (np.take_along_axis(inside, np.clip(place + k, 0, INSIDE - 1), 0)[0] for k in (-1, 1))
    return ~(lowest > rule.limit)


def _beyond(graph: Program, p: Array, precision: Precision, at: str) -> str | None:
    """What to say where a link's length cannot be squared in a precision."""
    numbers = np.finfo(DTYPES[precision])
    low, high = math.sqrt(numbers.tiny), math.sqrt(numbers.max)
    for name, body in graph.data.at(p)["bodies"].items():
        length = body["length"]
        if length is not None and not low <= length <= high:
            what = f"link '{name}' is {length:.3g} m long, and {precision} precision can only square {low:.1g} to {high:.1g} m"
            return f"the mechanism has no result {at}: {what}"
    return None


def _left_open(graph: Program, start: Array, t: float, p: Array) -> str:
    """What closes the loops that iteration leaves open at an instant: those with the widest gaps, or all where these do not tell.

    What it was begun from says nothing of that: it goes on from there, each coordinate by steps of its own, so that loops that can
    be closed are.
    """
    assert graph.newton is not None
    motion, z = graph.motion(t, p), start[:, None]
    largest = LARGEST_STEP * np.where(graph.newton.turning, 1.0, graph.extent(p))[:, None]
    for _ in range(_TRIALS):
        correction, size = (found.full() for found in graph.newton.step(z, t, motion[0], p))
        z = z + np.clip(correction * max(1.0, float(size[0, 0]) / LARGEST_STEP), -largest, largest)
    out = graph.instant(t, *motion, z, p).full()[:, 0]
    gaps = {closing: abs(float(out[k])) for closing, k in graph.checks("gap").items()}
    widest = max(gaps.values(), default=math.nan)
    left = [graph.data.closing(closing) for closing, gap in gaps.items() if gap > _WIDE * widest]
    return ", ".join(left) if 0 < len(left) < len(gaps) else graph.newton.joints


@dataclass(frozen=True, eq=False)
class _Bad:
    """The instant ``i`` that has no result; ``at`` says in words when it is, ``passed`` are the loops' rules broken after it."""

    graph: Program
    evaluated: Evaluated
    held: Sequence[Rule]
    i: int
    at: str
    passed: Sequence[Rule]
    extent: float

    def why(self, still_open: Callable[[], str]) -> tuple[Status, str]:
        """Why it has none: what the first rule that is broken says; ``still_open`` names what iteration left open."""
        ends = [rule for rule in self.held if rule.kind == "BEYOND"]
        for rule in ends:
            if self._breaks(rule):
                return self._beyond_ends(rule)
        if self._status == NOT_CONVERGED:
            cause = "their links do not reach, or the instant before is too far off"
            return Status.NOT_CONVERGED, f"the loops closed by {still_open()} did not converge {self.at}: {cause}"
        for rule in self.held:
            if rule in ends:
                continue
            if rule.kind in ("CLOSURE", "BRANCH"):
                found = self._loop(rule)
            elif self._status == SLOW:
                break
            else:
                found = self._other(rule) if self._breaks(rule) else None
            if found is not None:
                return found
        return self._slow() if self._status == SLOW else self._not_finite()

    @property
    def _status(self) -> int:
        return int(self.evaluated.status[self.i])

    def _value(self, rule: Rule) -> float:
        return float(self.evaluated.out[rule.column, self.i])

    def _breaks(self, rule: Rule) -> bool:
        return bool(broken(rule, self.evaluated.out, self.extent)[self.i])

    def _beyond_ends(self, rule: Rule) -> tuple[Status, str]:
        far = f"by {share_beyond(self._value(rule)):.3g} of what is between them"
        return Status.BEYOND_ENDS, f"the {rule.part}: what is put into its curve is beyond the curve's ends {self.at}, {far}"

    def _loop(self, rule: Rule) -> tuple[Status, str] | None:
        """What is wrong with a loop, with three turns, or with what drives hold; None where nothing is."""
        value, closed = self._value(rule), self.graph.data.closing(str(rule.part))
        if value < -rule.limit:
            if rule.kind == "BRANCH":
                return Status.JUMPED, f"the loop closed by {closed} has jumped to another branch {self.at}: take more instants"
            return Status.OUT_OF_REACH, f"the loop closed by {closed} cannot be closed {self.at}: its links do not reach"
        passes = value > rule.limit
        if passes and rule not in self.passed:
            return None
        status = Status.PASSES_DEAD_CENTRE if passes else Status.DEAD_CENTRE
        after = f"after {self.at.removeprefix('at ')}"
        if rule.column in self.graph.checks("gimbal").values():
            lock = f"passes gimbal lock {after}" if passes else f"is in gimbal lock {self.at}"
            why = "its third axis comes to lie along its first; choose axis and second so that turn_2 keeps away from 90 deg"
            return status, f"joint '{rule.part}' {lock}: {why}"
        if rule.column in self.graph.checks("roll").values():
            lies = f"comes to lie along its beside {after}" if passes else f"lies along its beside {self.at}"
            return status, f"bar '{rule.part}' {lies}, which then tells no y axis; choose a direction that stays across it"
        if rule.column in self.graph.checks("hold").values():
            where_to = f"cannot make the motion {after if passes else self.at}"
            return status, f"the drives {rule.part} {where_to}: it can go on there without moving them; drive other joints"
        if not passes:
            why = f"the loop closed by {closed} is at a dead centre {self.at}, within rounding: its forces are not determined there"
            return status, why
        near = "; if it only comes near one, take more instants" if self.graph.newton is not None else ""
        return status, f"the loop closed by {closed} passes a dead centre {after}, and can go on in two ways{near}"

    def _other(self, rule: Rule) -> tuple[Status, str] | None:
        """What a broken rule says; None where its column is no number, and a later one says why."""
        part, value, at = str(rule.part), self._value(rule), self.at
        if rule.kind == "GAP" and math.isfinite(value):
            what = f"what was found for the loop closed by {self.graph.data.closing(part)} does not close it"
            return Status.NOT_CLOSED, f"{what} {at}: a gap of {abs(value):.3g} m"
        if rule.kind == "MISFIT" and math.isfinite(value):
            gap = f"a gap of {value:.3g} of the links' length"
            closed = self.graph.data.closing(part)
            return Status.MISFIT, f"the loops closed by {closed} are over-constrained and do not fit {at}: {gap}"
        if rule.kind == "TURNED":
            what = f"the angle of '{part}', which a load sees with its turns,"
            if abs(value) <= rule.limit:
                return Status.TURNED, f"{what} goes most of a turn from the instant {at} to the next: take more instants"
            swing = f"swings {math.degrees(value):.3g} deg from the middle of its swing over the scene's motion {at}"
            further = "it might be a turn further; take defaults and a motion that show how far it goes"
            return Status.TURNED, f"{what} {swing}: {further}"
        if rule.kind == "JAM":
            what = "frictions" if ", " in part else "friction"
            return Status.JAMS, f"{what} '{part}': the mechanism jams {at}: {_JAM}"
        if rule.kind == "SLIP":
            return Status.JAMS, f"the laws of friction '{part}' are not met {at}, by {value:.3g} of its size: it nearly jams"
        if rule.kind == "ROW":
            return Status.ROW_VIOLATED, f"the motion violates the non-holonomic constraint '{part}' by {value:.6g} {at}"
        return None

    def _slow(self) -> tuple[Status, str]:
        assert self.graph.newton is not None
        cause = "they are near a dead centre, or the instant before is too far off"
        return Status.SLOW, f"the loops closed by {self.graph.newton.joints} converge slowly {self.at}: {cause}"

    def _not_finite(self) -> tuple[Status, str]:
        values = zip(self.graph.columns, self.evaluated.out[:, self.i], strict=True)
        name = next(column for column, value in values if not math.isfinite(value))
        return Status.NOT_FINITE, f"'{name}' is not finite {self.at}: the mechanism is singular there, or its numbers overflow"
