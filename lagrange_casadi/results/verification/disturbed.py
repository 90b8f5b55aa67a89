"""Graphs followed with errors put in, where an exact operation stays exact and what was decided
stays decided.

Monte Carlo arithmetic (D. S. Parker, *Monte Carlo Arithmetic*, UCLA CSD-970002, 1997) gives every
operation a random error as large as its rounding. Two effects would make that far too large. A
difference without a rounding error would be given one, which the next operation magnifies. And if a
load jumps, an error may move a trial over the jump. So the operations are first computed in the
precision of the result: this determines the rounding error of each operation, and the outcome of
every comparison. Trials then use these. If errors could reverse a comparison, a result may be on
either side of the jump: the side of the result is found.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Array, Operand
from ...base.compensated import DTYPES, ROUNDING
from ...base.interpret import (
    REMAINDERS,
    ROUNDINGS,
    Arithmetic,
    followable,
    interpret,
    numpy_arithmetic,
)
from ...engine.codegen.stages import Stages
from .roundings import rounding_error

TRIALS = 8
MAGNIFIED = 8.0
"""Magnification of the errors, so that the trials' own rounding does not hide them: their effect is
divided by it.
"""

_BESIDE = 4.0
"""Distance, in magnified errors, at which a result may be on the other side of a jump."""

_LEAST = 0.01
"""The least part of half a unit in the last place that a rounding is taken for, of what is not
exact throughout.
"""

_JUMP = 1e3
"""Number of errors by which an output of a drive jumps."""

_STEPS, _CLOSED = 20, 1e-9
_AT_ONCE = 4_000_000
_POOL = 1 << 12
_KNOWN = numpy_arithmetic().operations
_TRUTHS = {ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_NOT, ca.OP_AND, ca.OP_OR}
_WHOLE = {*_TRUTHS, ca.OP_SIGN, ca.OP_FLOOR, ca.OP_CEIL}
_DECIDING = {*_WHOLE, *REMAINDERS, ca.OP_ATAN2, ca.OP_COPYSIGN, ca.OP_IF_ELSE_ZERO}
_HANDED = -1
"""The code of a number that a drive hands on which is not followed itself."""


@dataclass(frozen=True, eq=False)
class Instants:
    """Some instants of a scene's stages: times (n,), parameters, and
    iterated coordinates (k, n).
    """

    stages: Stages
    t: Array
    p: Array
    z: Array

    @property
    def followable(self) -> bool:
        """True if the operations can be followed."""
        return all(
            followable(function)
            for function in (
                self.stages.instant,
                *([self.stages.loops] if self.stages.loops else []),
            )
        )

    def at(self, which: Operand) -> Instants:
        """Some of them."""
        return replace(self, t=self.t[which], z=self.z[:, which])

    def blocks(self, chosen: Array) -> list[Array]:
        """Chosen instants, as many at a time as memory bears: all that is done there is kept."""
        size = max(16, _AT_ONCE // max(1, self.stages.instant.n_instructions()))
        return [chosen[k : k + size] for k in range(0, chosen.size, size)]

    @property
    def kind(self) -> type[np.floating]:
        """The precision's numbers."""
        kind: type[np.floating] = DTYPES[self.stages.precision].type
        return kind

    @property
    def unit(self) -> float:
        """The largest relative error of one rounding."""
        return ROUNDING[self.stages.precision]

    @property
    def smooth(self) -> bool:
        """True if the drive is followed like the rest."""
        return not self.stages.compensated and followable(self.stages.drive)

    @cached_property
    def handed(self) -> list[Array]:
        """Outputs of the drive, in doubles: counted numbers, rates, and accelerations, each (...,
        n).
        """
        return self._drive(self.t[None], self.p[:, None])

    def handed_beside(self, noise: _Noise) -> list[Array]:
        """The same, each (..., trials, n), with errors in times and parameters as large as those of
        a pair of numbers.
        """
        t, p = (
            np.tile(values, TRIALS)
            for values in (self.t[None], np.tile(self.p[:, None], self.t.size))
        )
        return [
            rows.reshape(-1, TRIALS, self.t.size)
            for rows in self._drive(noise.paired(t), noise.paired(p))
        ]

    def _drive(self, t: Array, p: Array) -> list[Array]:
        if self.stages.precision == "single":
            t, p = (
                np.concatenate([x.astype(np.float32), x - x.astype(np.float32)]) for x in (t, p)
            )
        return [rows.full() for rows in self.stages.drive(t, p)]


@dataclass(frozen=True, eq=False)
class _Step:
    """An operation as it was done: its code, operands and result, (n,) or numbers; and what it
    decided, if it decides.
    """

    code: int
    operands: tuple[Any, ...]
    result: Any
    decision: Any = None


@dataclass(frozen=True, eq=False)
class _Course:
    """The columns (columns, n) of instants followed as they are computed, and all that was done for
    them.
    """

    instants: Instants
    steps: list[_Step]
    columns: Array


def effects(instants: Instants, out: Array, angles: npt.NDArray[np.bool_]) -> tuple[Array, Array]:
    """Effects of errors on the columns, a row a trial, (columns, trials, n), and the columns,
    (columns, n), with closed loops.

    The last row is what was done to ``out``, a result, whose ``angles`` among its columns are known
    up to whole turns. It decides on which side of a jump to look.
    """
    z, _ = _closed(instants, _STEPS)
    course = _followed(instants, {})
    out = out - _turns(out - course.columns, angles)
    trials, sides = _trials(course, z)
    taken = _taken(course, trials, sides, out) if sides else {}
    if taken:
        course = _followed(instants, taken)
        trials, _ = _trials(course, z)
    columns = (
        _quiet(instants, [step.decision for step in course.steps], list(z))
        if z.size
        else course.columns
    )
    changes = trials - columns[:, None]
    changes = (changes - _turns(changes, angles)) / MAGNIFIED
    return np.concatenate([changes, (out - columns)[:, None]], axis=1), columns


def openness(instants: Instants) -> Array:
    """Residual of iterated loops, (n,), in roundings: their next correction, angles in rad, slides
    over all links' length.
    """
    return _closed(instants, 1)[1] / instants.unit


def _turns(residuals: Array, angles: npt.NDArray[np.bool_]) -> Array:
    """The whole turns in gaps of angles."""
    return np.where(
        angles.reshape(-1, *(1,) * (residuals.ndim - 1)),
        math.tau * np.rint(residuals / math.tau),
        0.0,
    )


def _closed(instants: Instants, most: int) -> tuple[Array, Array]:
    """Iterated coordinates after at most so many steps of Newton's method, (k, n), in doubles; and
    how large the first step was.
    """
    loops, z, first = instants.stages.loops, instants.z, np.zeros_like(instants.t)
    if loops is None:
        return z, first
    counted = instants.handed[0]
    for k in range(most):
        correction, size = (x.full() for x in loops(z, counted, instants.p))
        z, first = z + correction, size[0] if k == 0 else first
        if not np.fmax.reduce(size[0]) >= _CLOSED:
            break
    return z, first


def _followed(instants: Instants, taken: Mapping[int, Array]) -> _Course:
    """Follow instants in the precision's own numbers; ``taken`` are decisions (n,) taken before, by
    the number of the step.
    """
    kind, steps = instants.kind, list[_Step]()

    def apply(k: int, code: int, values: tuple[Operand, ...]) -> Array:
        result, decision = np.asarray(_operation(code, values), kind), None
        if code in _DECIDING or code == _HANDED:
            decision = taken.get(k, _decision(code, values, result))
            result = np.asarray(_following(code, values, decision), kind)
        steps.append(_Step(code, values, result, decision))
        return result

    found = _columns(
        instants,
        apply,
        kind,
        [kind(value) for value in instants.p],
        [row.astype(kind) for row in instants.z],
    )
    if instants.stages.precision == "single":
        found = _quiet(instants, [step.decision for step in steps])
    return _Course(instants, steps, found)


def _quiet(
    instants: Instants, decisions: Sequence[Array | None], z: Sequence[Array] | None = None
) -> Array:
    """The columns in doubles, by parameters and constants as given, with decisions (..., n) taken
    before: (columns, ..., n).
    """

    def apply(k: int, code: int, values: tuple[Operand, ...]) -> Operand:
        return (
            _operation(code, values)
            if decisions[k] is None
            else _following(code, values, decisions[k])
        )

    shape = np.broadcast_shapes(
        instants.t.shape, *(np.shape(decision) for decision in decisions if decision is not None)
    )
    return _columns(
        instants,
        apply,
        np.float64,
        list(instants.p),
        list(instants.z) if z is None else z,
        shape=shape,
    )


def _trials(course: _Course, z: Array) -> tuple[Array, dict[int, Array]]:
    """The columns with errors, (columns, trials, n), and what else trials would have decided,
    (trials, n), by number.
    """
    instants, shape = course.instants, (TRIALS, course.instants.t.size)
    noise, sizes, sides = _Noise(instants, shape), _sizes(course), dict[int, Array]()

    def apply(k: int, code: int, values: tuple[Operand, ...]) -> Operand:
        step = course.steps[k]
        if step.decision is not None:
            decision = _decision(code, values, _operation(code, values))
            differs = _differs(step, decision, instants.unit)
            if differs.any():
                sides[k] = np.broadcast_to(np.where(differs, decision, step.decision), shape)
            if code == _HANDED:
                return noise.handed(np.where(differs, step.decision, decision))
            return _following(code, values, step.decision)
        value = _KNOWN[code](*values)
        return value if sizes[k] is None else noise.put(value, sizes[k])

    def closed(counted: Sequence[Array]) -> list[Array]:
        assert instants.stages.loops is not None
        correction, _ = interpret(
            instants.stages.loops, [list(z), counted, rounded], noise.arithmetic
        )
        return [noise.rounded(a + b) for a, b in zip(z, correction, strict=True)]

    rounded = [float(instants.kind(value)) for value in instants.p]
    handed = None if instants.smooth else instants.handed_beside(noise)
    return _columns(
        instants, apply, noise.constant, rounded, closed if z.size else [], handed, shape
    ), sides


def _columns(
    instants: Instants,
    apply: Callable[[int, int, tuple[Operand, ...]], Operand],
    constant: Callable[[float], Operand],
    p: Sequence[float],
    z: Sequence[Operand] | Callable[[Sequence[Operand]], Sequence[Operand]],
    handed: Sequence[Array] | None = None,
    shape: tuple[int, ...] | None = None,
) -> Array:
    """The columns by an arithmetic that receives each operation's number, code and operands; ``z``
    may wait for what is counted.
    """
    count = itertools.count()

    def rule(code: int) -> Callable[..., Operand]:
        return lambda *values: apply(next(count), code, values)

    arithmetic = Arithmetic(constant, {code: rule(code) for code in _KNOWN})
    with np.errstate(all="ignore"):
        if instants.smooth:
            driven = interpret(instants.stages.drive, [[instants.t], p], arithmetic)
        else:
            driven = [[rule(_HANDED)(row) for row in rows] for rows in (handed or instants.handed)]
        z = z(driven[0]) if callable(z) else z
        (found,) = interpret(instants.stages.instant, [*driven, z, p], arithmetic)
    shape = instants.t.shape if shape is None else shape
    return np.array([np.broadcast_to(row, shape) for row in found], float).reshape(-1, *shape)


def _taken(
    course: _Course, trials: Array, sides: Mapping[int, Array], out: Array
) -> dict[int, Array]:
    """The decisions, by number, that a result ``out`` has taken otherwise, as some trial would
    have; none where it took none.
    """
    instants = course.instants
    size = ROUNDING["double"] * np.fmax.reduce(np.abs(trials), axis=(1, 2), initial=0.0)[:, None]
    size = np.fmax.reduce(np.abs(trials - course.columns[:, None]), axis=1) + size
    beside = np.abs(out - course.columns) / np.where(size > 0.0, size, np.inf)
    uncertain = np.any(
        [(found != course.steps[k].decision).any(axis=0) for k, found in sides.items()], axis=0
    )
    where = np.flatnonzero(uncertain & (np.fmax.reduce(beside, axis=0) > _BESIDE))
    if not where.size:
        return {}
    moved = [
        None if step.decision is None else np.broadcast_to(step.decision, instants.t.shape)
        for step in course.steps
    ]
    lanes: list[Any] = [None if decision is None else decision[where] for decision in moved]
    for k, found in sides.items():
        lanes[k] = np.concatenate([lanes[k][None], found[:, where]])
    residuals = (
        np.abs(_quiet(instants.at(where), lanes) - out[:, None, where])
        / np.where(size > 0.0, size, np.inf)[:, None, where]
    )
    best = np.argmin(np.fmax.reduce(residuals, axis=0), axis=0)
    taken = {k: np.array(moved[k], float) for k in sides}
    for k in taken:
        taken[k][where] = lanes[k][best, np.arange(where.size)]
    return taken if best.any() else {}


def _operation(code: int, values: tuple[Operand, ...]) -> Operand:
    return values[0] if code == _HANDED else _KNOWN[code](*values)


def _decision(code: int, operands: tuple[Operand, ...], result: Operand) -> Operand:
    """Decision of an operation: a truth, a sign, a whole number; or a number on the side of a jump
    on which it is.
    """
    return (
        operands[1]
        if code == ca.OP_COPYSIGN
        else operands[0]
        if code == ca.OP_IF_ELSE_ZERO
        else result
    )


def _following(code: int, values: tuple[Operand, ...], decision: Operand) -> Operand:
    """A deciding operation's result, its decision being taken."""
    if code in _WHOLE or code == _HANDED:
        return decision
    if code == ca.OP_COPYSIGN:
        return np.copysign(values[0], decision)
    if code == ca.OP_IF_ELSE_ZERO:
        return _KNOWN[code](decision, values[1])
    result = _KNOWN[code](*values)
    period = np.abs(values[1]) if code in REMAINDERS else math.tau
    return result - period * np.rint((result - decision) / period)


def _differs(step: _Step, decision: Operand, unit: float) -> npt.NDArray[np.bool_]:
    """Return whether a decision differs from the one that was taken."""
    moved = step.decision
    if step.code == _HANDED:
        off = np.abs(decision - moved)
        return np.asarray(off > _JUMP * (np.median(off) + unit**2 * np.abs(moved)))
    if step.code == ca.OP_COPYSIGN:
        return np.asarray(np.signbit(decision) != np.signbit(moved))
    if step.code == ca.OP_IF_ELSE_ZERO:
        return np.asarray((decision != 0) != (moved != 0))
    if step.code in _WHOLE:
        return np.asarray(decision != moved)
    return np.asarray(
        np.abs(decision - moved)
        > (np.abs(step.operands[1]) if step.code in REMAINDERS else math.tau) / 2
    )


def _sizes(course: _Course) -> list[Array | None]:
    """Largest rounding of each operation, (n,); None if it rounds nothing at any instant.

    An error may be half a unit in the last place. Where it happened to be next to nothing, it may
    be more at instants that are not looked at, but not where one operation at one instant is all
    that counts. So the mean of what it may be and what it is: by its square the arithmetic one, so
    that many operations have the errors that they should; where one counts, the geometric one.
    """
    groups: dict[int, list[int]] = {}
    for k, step in enumerate(course.steps):
        if step.code in ROUNDINGS:
            groups.setdefault(step.code, []).append(k)
    sizes: list[Any] = [None] * len(course.steps)
    with np.errstate(all="ignore"):
        for code, numbers in groups.items():
            rows = np.empty(
                (1 + len(course.steps[numbers[0]].operands), len(numbers), course.instants.t.size),
                course.instants.kind,
            )
            for i, k in enumerate(numbers):
                step = course.steps[k]
                for j, values in enumerate((step.result, *step.operands)):
                    rows[j, i] = values
            most = np.spacing(np.abs(rows[0])) * (ROUNDINGS[code] / 2)
            rest = np.abs(rounding_error(code, *rows))
            between = np.where(
                np.isnan(rest), most, np.sqrt(2.0 * most * np.maximum(rest, _LEAST * most))
            )
            for k, row, exact in zip(
                numbers, between, (rest == 0.0).all(axis=1).tolist(), strict=True
            ):
                sizes[k] = None if exact else row
    return sizes


class _Noise:
    """Random errors as large as roundings, magnified."""

    def __init__(self, instants: Instants, shape: tuple[int, int]) -> None:
        self.instants, self.n, self.generator = instants, shape[1], np.random.default_rng(0)
        self.pool = self.generator.uniform(-MAGNIFIED, MAGNIFIED, (shape[0], shape[1] + _POOL))
        self.starts = itertools.cycle(self.generator.permutation(_POOL).tolist())

    def put(self, value: Operand, size: Operand) -> Operand:
        """A value with an error of up to a size."""
        start = next(self.starts)
        return value + self.pool[:, start : start + self.n] * size

    def rounded(self, value: Operand, roundings: float = 1.0) -> Operand:
        """A value with an error of up to so many roundings, exact or not."""
        return self.put(
            value, np.spacing(np.abs(value).astype(self.instants.kind)) * (roundings / 2)
        )

    def handed(self, value: Array) -> Operand:
        """A value with the error that it gets where pairs end, or a double becomes a single."""
        single = self.instants.kind is np.float32
        return (
            self.put(value, np.abs(value - value.astype(np.float32)))
            if single
            else self.rounded(value)
        )

    def paired(self, values: Array) -> Array:
        """Values with errors as large as those of a pair of numbers."""
        return (
            values
            + values
            * self.generator.uniform(-MAGNIFIED, MAGNIFIED, values.shape)
            * self.instants.unit**2
        )

    def constant(self, value: float) -> float:
        """A constant as the precision has it."""
        return float(self.instants.kind(value))

    @property
    def arithmetic(self) -> Arithmetic:
        """NumPy's operations with such errors."""

        def rule(code: int) -> Callable[..., Operand]:
            known, roundings = _KNOWN[code], ROUNDINGS.get(code)
            return (
                known
                if roundings is None
                else lambda *values: self.rounded(known(*values), roundings)
            )

        return Arithmetic(self.constant, {code: rule(code) for code in _KNOWN})
