"""Reasons why an evaluation has no result: the first instant at which a loop does not close, or at
which forces are indeterminate.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.scalars import called
from ...base.status import Status
from ...base.vocabulary import Precision
from ...errors import AssemblyError, DeclarationError
from ...model.beyond_ends import BEYOND
from ...model.description import Description
from ..codegen.stages import plain
from ..compensated import DTYPES
from ..kinematics import where
from ..model_data import ModelData
from ..program import Program
from ..verdicts import Instance
from .backends import Evaluated, Interpreter
from .evaluation_method import EvaluationMethod
from .passed_dead_centres import Placed, dead_steps

_SAMPLED = 4001
_TURNING = (Status.OUT_OF_REACH, Status.DEAD_CENTRE, Status.PASSES_DEAD_CENTRE)
"""Statuses where a cylinder may be at its longest or shortest."""


@dataclass(frozen=True)
class Refusal:
    """Reason why there is no result at an instant ``t`` [s]: a status, and a message that names the
    joint, the instant and the driven coordinates.
    """

    status: Status
    message: str
    t: float


@functools.lru_cache(maxsize=64)
def refuse_laws(data: ModelData, span: tuple[float, float], p: tuple[float, ...]) -> None:
    """Raise :class:`DeclarationError` for a motion whose rate jumps within a span of time, for
    values of the parameters.

    Also where it puts into a curve what is beyond the curve's ends.
    """
    laws, t = data.laws, np.linspace(*span, _SAMPLED)
    data.corners.refuse_laws(t, p, at=False)
    if laws.beyond is None:
        return
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
        error = AssemblyError(found.message)
        error.t = found.t
        raise error


def refusal(
    program: Program, evaluated: Evaluated, t: Array, p: Array, method: EvaluationMethod
) -> Refusal | None:
    """Reason why the first instant without a result has none; None if all have one."""
    precision = evaluated.stages.precision
    most = program.limits(precision, method.newton, program.extent(p))
    near = _beside(program, evaluated, most, t, p)
    numbers = first_broken(program, evaluated.out, most, near, evaluated.status)
    if not numbers.any() and not (evaluated.status == Status.NOT_FINITE).any():
        return None
    statuses = np.array([Status.OK, *(rule.status for rule, _ in program.rules)])[numbers]
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
    status, out = Status(int(statuses[i])), evaluated.out[:, i]
    if status in (Status.OK, Status.AT_REST):
        status, words = Status.NOT_FINITE, _not_finite(program, out, at)
    else:
        words = words_of(program, int(numbers[i]), out, most, at)
    return Refusal(status, _beyond(program, p, precision, at) or words, float(t[i]))


def words_of(program: Program, number: int, out: Array, most: Sequence[float], at: str) -> str:
    """Message for the rule of a number, broken by columns ``out`` (columns,) ``at`` an instant."""
    rule, k = program.rules[number - 1]
    if k is None:
        assert program.newton is not None
        it = Instance("", program.newton.joints, at, math.nan, math.nan)
    else:
        part, column = str(program.bounds[k].part), program.bounds[k].column
        it = Instance(part, program.data.closing(part), at, float(out[column]), most[k])
    words = rule.words.format(it=it)
    if rule.status in _TURNING:
        where = "before that" if rule.status == Status.OUT_OF_REACH else "there"
        for name in _cylinders(program.data.content, it.part.split(", ")):
            words += (
                f"; cylinder '{name}' is at its longest or shortest {where}, and drives no further:"
                " move its mount"
            )
    return words


def _cylinders(description: Description, parts: Collection[str]) -> Iterator[str]:
    """The slides that drive, between two moving bodies with a pin each, which are among ``parts``
    or whose pins are.
    """
    joints = description.joints
    for name in description.drives:
        slide = joints.get(name)
        if slide is not None and slide.kind == "prismatic":
            ends = {place.body for place in slide.ends}
            pins = [
                joint
                for joint in joints.values()
                if joint is not slide and ends & {place.body for place in joint.ends}
            ]
            kinds = [joint.kind for joint in pins]
            pinned = "ground" not in ends and kinds == ["revolute", "revolute"]
            if pinned and any(joint.name in parts for joint in (slide, *pins)):
                yield name


def first_broken(
    program: Program,
    out: Array,
    most: Sequence[float],
    beside: Array,
    status: npt.NDArray[np.generic],
) -> npt.NDArray[np.intp]:
    """The number of the first rule that each instant of columns ``out`` (columns, t) breaks (t,),
    or zero.

    ``most`` are the limits, ``beside`` (bounds, t) the values beside checks, ``status`` (t,) that
    of iterated loops.
    """
    checks, limits = out[[one.column for one in program.bounds]], np.array(most, float)[:, None]
    if not status.any():
        # A rule is kept within an interval: if the least and the largest keep it, all do.
        few, near = (
            np.array([rows.min(axis=1), rows.max(axis=1)], float).T for rows in (checks, beside)
        )
        if not np.isnan([few, near]).any():
            broken = called(program.status, few, limits, near, np.zeros((1, 2)))
            if not broken.any():
                return np.zeros(status.shape, np.intp)
    iterated = np.asarray(status, float)[None]
    return np.asarray(called(program.status, checks, limits, beside, iterated)[0], np.intp)


def _beside(
    program: Program, evaluated: Evaluated, most: Sequence[float], t: Array, p: Array
) -> Array:
    """Values beside the checks of each instant (bounds, t), as :data:`.Beside` says."""
    interpreter = Interpreter(program, plain(program))

    def place(i: int, x: Array) -> Placed:
        times = t[i] + x * (t[i + 1] - t[i])
        z = evaluated.iterated[:, np.where(x < 0.5, i, i + 1)].astype(float)
        interpreter.close(times, p, z)
        return t[i + 1] - t[i], times, program.motion(times[None], p), z

    closed = evaluated.status != Status.NOT_CONVERGED
    found = dead_steps(program, t, evaluated.out, closed, most, p, place)
    for k, bound in enumerate(program.bounds):
        if bound.beside == "ROW":
            # Where all stands still, what rounding leaves of rates violates nothing.
            found[k] = np.fmax.reduce(evaluated.out[bound.size], initial=0.0)
        elif bound.beside == "TURNED":
            found[k, :-1] = np.diff(evaluated.out[bound.column])
    return found


def resting(program: Program, out: Array) -> npt.NDArray[np.bool_]:
    """Instants, from the columns ``out`` (columns, t), at which a joint with friction is at rest:
    forces that depend on its friction are indeterminate.
    """
    return np.asarray((out[[*program.checks("rest").values()]] > 0.5).any(axis=0))


def unfinished(program: Program, evaluated: Evaluated) -> npt.NDArray[np.bool_]:
    """Instants (t,) without a result; at rest there is one, except for what depends on friction."""
    rests = (evaluated.status == Status.NOT_FINITE) & resting(program, evaluated.out)
    return np.asarray((evaluated.status != Status.OK) & ~rests)


def _beyond(program: Program, p: Array, precision: Precision, at: str) -> str | None:
    """Message if the square of a link's length overflows in a precision."""
    numbers = np.finfo(DTYPES[precision])
    low, high = math.sqrt(numbers.tiny), math.sqrt(numbers.max)
    for name, body in program.data.at(p).bodies.items():
        length = body.length
        if length is not None and not low <= length <= high:
            return (
                f"the mechanism has no result {at}: link '{name}' is {length:.3g} m long, but"
                f" squares in {precision} precision need {low:.1g} to {high:.1g} m"
            )
    return None


def _not_finite(program: Program, out: Array, at: str) -> str:
    name = next(
        column
        for column, value in zip(program.columns, out, strict=True)
        if not math.isfinite(value)
    )
    return f"'{name}' is not finite {at}: the mechanism is singular there, or its numbers overflow"
