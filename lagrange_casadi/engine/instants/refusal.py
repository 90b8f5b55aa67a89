"""Reasons why an evaluation has no result: the first instant at which a loop does not close, or at
which forces are indeterminate.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.compensated import DTYPES
from ...base.status import Status
from ...base.vocabulary import Precision
from ...errors import AssemblyError, DeclarationError
from ...model.ends import BEYOND, share_beyond, words_beyond
from ..codegen.stages import plain
from ..iteration import LARGEST_STEP
from ..kinematics import where
from ..model_data import ModelData
from ..program import Program
from ..status import Bound, Rule
from .backends import Evaluated, Interpreter
from .dead_centres import Placed, dead_steps
from .evaluation_method import EvaluationMethod
from .rules import first_broken, limits

_JAM = (
    "friction has no unique solution there (jamming); reduce mu, lengthen the guide, or push"
    " closer to its axis"
)
_TRIALS, _WIDE = 100, 0.1
_SAMPLED = 4001


@dataclass(frozen=True)
class Refusal:
    """Reason why there is no result: a status, and a message that names the joint, the instant and
    the driven coordinates.
    """

    status: Status
    message: str


@functools.lru_cache(maxsize=64)
def refuse_laws(data: ModelData, span: tuple[float, float], p: tuple[float, ...]) -> None:
    """Raise :class:`DeclarationError` for a motion whose rate jumps within a span of time, for
    values of the parameters.

    Also where it puts into a curve what is beyond the curve's ends.
    """
    data.corners.refuse_laws(span, p)
    laws = data.laws
    if laws.beyond is None:
        return
    t = np.linspace(*span, _SAMPLED)
    beyond = np.argwhere(~(laws.beyond(t[None], list(p)).full() <= BEYOND["double"]).T)
    if beyond.size:
        at, joint = beyond[0]
        raise DeclarationError(
            f"the motion of joint '{laws.joints[joint]}': the argument of its curve is outside the"
            f" curve's range at t = {t[at]:.6g} s"
        )


def refuse(
    program: Program, evaluated: Evaluated, t: Array, p: Array, method: EvaluationMethod
) -> None:
    """Raise :class:`AssemblyError` for the first instant that has no result."""
    found = refusal(program, evaluated, t, p, method)
    if found is not None:
        raise AssemblyError(found.message)


def refusal(
    program: Program, evaluated: Evaluated, t: Array, p: Array, method: EvaluationMethod
) -> Refusal | None:
    """Reason why the first instant without a result has none; None if all have one."""
    precision = evaluated.stages.precision
    shares = zip(
        program.bounds, limits(program, precision, method.newton, program.extent(p)), strict=True
    )
    most = [math.inf if bound.kind.startswith("OPEN") else limit for bound, limit in shares]
    near = _beside(program, evaluated, most, t, p)
    numbers = first_broken(program, evaluated.out, most, near, evaluated.status)
    if not numbers.any() and not (evaluated.status == Status.NOT_FINITE).any():
        return None
    statuses = np.array([Status.OK, *(rule.status for rule in program.rules)])[numbers]
    finite = (evaluated.status != Status.NOT_FINITE) | (statuses == Status.AT_REST)
    bad = ~(finite & ((statuses == Status.OK) | (statuses == Status.AT_REST)))
    if not bad.any():
        return None
    i = int(np.argmax(bad))
    coordinates = program.data.kinds.coordinates
    driven = np.atleast_1d(program.motion(t[i], p)[0].full().ravel())
    at = where(
        (name, coordinates[name], value) for name, value in zip(program.driven, driven, strict=True)
    )
    at = f"at t = {t[i]:.6g} s{at}"
    status = Status(int(statuses[i]))
    if status in (Status.OK, Status.AT_REST):
        refused = Refusal(Status.NOT_FINITE, _not_finite(program, evaluated.out[:, i], at))
    else:
        loops = functools.partial(
            _unclosed_loops, program, evaluated.iterated[:, i], float(t[i]), p
        )
        refused = Refusal(
            status,
            _Broken(program, program.rules[numbers[i] - 1], evaluated.out[:, i], most, at).words(
                loops
            ),
        )
    return replace(refused, message=_beyond(program, p, precision, at) or refused.message)


def _beside(
    program: Program, evaluated: Evaluated, most: Sequence[float], t: Array, p: Array
) -> Array:
    """Values beside the checks of each instant (bounds, t), for :class:`.Bound`."""
    interpreter = Interpreter(program, plain(program))

    def place(i: int, x: Array) -> Placed:
        times = t[i] + x * (t[i + 1] - t[i])
        z = evaluated.iterated[:, np.where(x < 0.5, i, i + 1)].astype(float)
        interpreter.close(times, p, z)
        return t[i + 1] - t[i], times, program.motion(times[None], p), z

    closed = evaluated.status != Status.NOT_CONVERGED
    found = dead_steps(program, t, evaluated.out, closed, most, p, place)
    for k, bound in enumerate(program.bounds):
        if bound.kind == "ROW":
            # Where all stands still, what rounding leaves of rates violates nothing.
            found[k] = np.fmax.reduce(evaluated.out[bound.size], initial=0.0)
        elif bound.kind == "TURNED":
            found[k, :-1] = np.diff(evaluated.out[bound.column])
    return found


def resting(program: Program, out: Array) -> npt.NDArray[np.bool_]:
    """Instants, from the columns ``out`` (columns, t), at which a joint with friction is at rest:
    forces that depend on its friction are indeterminate.
    """
    found = np.zeros(out.shape[-1], dtype=bool)
    for row in program.checks("rest").values():
        found |= np.asarray(out[row]) > 0.5
    return found


def unfinished(program: Program, evaluated: Evaluated) -> npt.NDArray[np.bool_]:
    """Instants (t,) without a result; at rest there is one, except for what depends on friction."""
    rests = (evaluated.status == Status.NOT_FINITE) & resting(program, evaluated.out)
    return np.asarray((evaluated.status != Status.OK) & ~rests)


def _beyond(program: Program, p: Array, precision: Precision, at: str) -> str | None:
    """Message if the square of a link's length overflows in a precision."""
    numbers = np.finfo(DTYPES[precision])
    low, high = math.sqrt(numbers.tiny), math.sqrt(numbers.max)
    for name, body in program.data.at(p)["bodies"].items():
        length = body["length"]
        if length is not None and not low <= length <= high:
            what = (
                f"link '{name}' is {length:.3g} m long, but squares in {precision} precision need"
                f" {low:.1g} to {high:.1g} m"
            )
            return f"the mechanism has no result {at}: {what}"
    return None


def _unclosed_loops(program: Program, start: Array, t: float, p: Array) -> str:
    """Describe the loops that iteration does not close at an instant: those with the largest
    residuals, or all if these are not known.

    What it was begun from says nothing of that: it goes on from there, each coordinate by steps of
    its own, so that loops that can be closed are.
    """
    assert program.newton is not None
    motion, z = program.motion(t, p), start[:, None]
    largest = LARGEST_STEP * np.where(program.newton.turning, 1.0, program.extent(p))[:, None]
    for _ in range(_TRIALS):
        correction, size = (found.full() for found in program.newton.step(z, t, motion[0], p))
        z = z + np.clip(correction * max(1.0, float(size[0, 0]) / LARGEST_STEP), -largest, largest)
    out = program.instant(t, *motion, z, p).full()[:, 0]
    gaps = {closing: abs(float(out[k])) for closing, k in program.checks("gap").items()}
    widest = max(gaps.values(), default=math.nan)
    remaining = [
        program.data.closing(closing) for closing, gap in gaps.items() if gap > _WIDE * widest
    ]
    return ", ".join(remaining) if 0 < len(remaining) < len(gaps) else program.newton.joints


def _not_finite(program: Program, out: Array, at: str) -> str:
    name = next(
        column
        for column, value in zip(program.columns, out, strict=True)
        if not math.isfinite(value)
    )
    return f"'{name}' is not finite {at}: the mechanism is singular there, or its numbers overflow"


@dataclass(frozen=True, eq=False)
class _Broken:
    """A rule that an instant breaks, whose columns are ``out``; ``at`` says in words when it is."""

    program: Program
    rule: Rule
    out: Array
    most: Sequence[float]
    at: str

    def words(self, unclosed: Callable[[], str]) -> str:
        """Message of a refusal; ``unclosed`` names the loops that iteration did not close."""
        newton, at, k = self.program.newton, self.at, self.rule.bound
        if k is None:
            assert newton is not None
            if self.rule.status == Status.SLOW:
                cause = "they are near a dead centre, or the instant before is too far off"
                return f"the loops closed by {newton.joints} converge slowly {at}: {cause}"
            cause = "their links do not reach, or the instant before is too far off"
            return f"the loops closed by {unclosed()} did not converge {at}: {cause}"
        bound = self.program.bounds[k]
        part, value = str(bound.part), float(self.out[bound.column])
        if bound.kind in ("CLOSURE", "BRANCH"):
            return self._loop(bound)
        if bound.kind == "BEYOND":
            far = f"by {share_beyond(value):.3g} of that range"
            what, argument = part.rsplit(": ", 1)
            return words_beyond(f"the {what}", argument, f" {at}, {far}")
        if bound.kind == "GAP":
            what = (
                f"the solution of the loop closed by {self.program.data.closing(part)} does not"
                " close it"
            )
            return f"{what} {at}: a gap of {abs(value):.3g} m"
        if bound.kind == "MISFIT":
            gap = f"a gap of {value:.3g} of the links' length"
            return (
                f"the loops closed by {self.program.data.closing(part)} are over-constrained and do"
                f" not fit {at}: {gap}"
            )
        if bound.kind == "TURNED":
            what = f"the angle of '{part}', on whose number of revolutions a load depends,"
            if abs(value) <= self.most[k]:
                return (
                    f"{what} changes by most of a turn from the instant {at} to the next: take"
                    " more instants"
                )
            swing = (
                f"is {math.degrees(value):.3g} deg from the middle of its range over the scene's"
                f" motion {at}"
            )
            further = (
                "its number of revolutions cannot be determined; take defaults and a motion that"
                " cover its range"
            )
            return f"{what} {swing}: {further}"
        if bound.kind == "JAM":
            what = "frictions" if ", " in part else "friction"
            return f"{what} '{part}': the mechanism jams {at}: {_JAM}"
        if bound.kind == "SLIP":
            return (
                f"the law of friction '{part}' has a relative residual of {value:.3g} {at}: it"
                " nearly jams"
            )
        return f"the motion violates the non-holonomic constraint '{part}' by {value:.6g} {at}"

    def _loop(self, bound: Bound) -> str:
        """Message on a loop, on three turns, or on constraints of drives."""
        status, at, part = self.rule.status, self.at, bound.part
        closed = self.program.data.closing(str(part))
        if status == Status.JUMPED:
            return (
                f"the loop closed by {closed} has jumped to another branch {at}: take more instants"
            )
        if status == Status.OUT_OF_REACH:
            return f"the loop closed by {closed} cannot be closed {at}: its links do not reach"
        passes = status == Status.PASSES_DEAD_CENTRE
        after = f"after {at.removeprefix('at ')}"
        if bound.column in self.program.checks("gimbal").values():
            lock = f"passes gimbal lock {after}" if passes else f"is in gimbal lock {at}"
            why = (
                "its third axis becomes parallel to its first; choose axis and second so that"
                " turn_2 stays away from 90 deg"
            )
            return f"joint '{part}' {lock}: {why}"
        if bound.column in self.program.checks("roll").values():
            lies = (
                f"passes through its beside= direction {after}"
                if passes
                else f"lies along its beside= direction {at}"
            )
            return (
                f"two-force link '{part}' {lies}, so its y axis is undefined; choose a"
                " direction that stays across it"
            )
        if bound.column in self.program.checks("hold").values():
            where_to = f"cannot produce the motion {after if passes else at}"
            return (
                f"the drives {part} {where_to}: the mechanism can move there while they are at"
                " rest; drive other joints"
            )
        if not passes:
            limit = self.most[self.program.bounds.index(bound)]
            band = limit if bound.kind == "BRANCH" else math.sqrt(limit)
            return (
                f"the loop closed by {closed} is at a dead centre {at}, within rounding, which is a"
                f" sine of {band:.2g} of its transmission angle: its forces are indeterminate"
            )
        return (
            f"the loop closed by {closed} passes a dead centre {after}, where it can"
            " continue on either branch"
        )
