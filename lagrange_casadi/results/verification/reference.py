"""A scene's own graphs evaluated with any number of digits: what rounding alone does to a result,
seen from outside.

The same instructions as in the emitted C, followed one by one (:mod:`.interpret`) in mpmath's
arithmetic. Formulas are not checked by it: it takes the same ones.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from ...base.arrays import Array, Operand
from ...base.interpret import Arithmetic, codes, interpret
from ...engine.program import Program
from ...errors import AssemblyError

if TYPE_CHECKING:
    from mpmath import mpf
    from mpmath.ctx_mp import MPContext

DIGITS = 50
_STEPS = 30


def reference(
    program: Program,
    t: Sequence[float],
    p: Sequence[float],
    z: Array | None = None,
    following: Callable[[Arithmetic], Arithmetic] = lambda arithmetic: arithmetic,
) -> list[list[mpf]]:
    """Every column of a graph at instants ``t``, a row an instant, as mpmath numbers of
    :data:`DIGITS` digits.

    Times and parameters are doubles, taken as exact, or mpmath numbers. Iterated loops start from
    ``z`` (k, n), and are closed to all digits. A motion by samples is read in doubles.
    ``following`` has the last word on the arithmetic of an instant. Raises :class:`AssemblyError`
    where a loop does not close, and :class:`DeclarationError` for graphs that call functions of
    their own.
    """
    from mpmath import mp  # takes its time

    with mp.workdps(DIGITS):
        # A turn is meant, not the double that is nearest to it.
        plain = Arithmetic(mp.mpf, _operations(mp))
        known = replace(
            plain, constant=lambda value: 2 * mp.pi if value == math.tau else plain.constant(value)
        )
        values = [mp.mpf(value) for value in p]
        rows = []
        for i, moment in enumerate(t):
            time = mp.mpf(moment)
            driven = interpret(program.laws.motion, [[time], values], plain)
            guess = [] if z is None else [mp.mpf(float(x)) for x in z[:, i]]
            if program.newton is not None:
                given = [[time], driven[0], values]
                small = mp.mpf(10) ** (4 - DIGITS)
                guess, done = closed(program.newton.step, guess, given, plain, small.__gt__, _STEPS)
                if not done:
                    raise AssemblyError(
                        f"the loops closed by {program.newton.joints} do not close to all digits at"
                        f" t = {float(time):.6g} s"
                    )
            (out,) = interpret(program.instant, [[time], *driven, guess, values], following(known))
            rows.append(out)
    return rows


@functools.cache
def elementwise() -> Arithmetic:
    """Arrays of mpmath's numbers of :data:`DIGITS` digits, whatever digits are set."""

    def rule(known: Callable[..., mpf]) -> Callable[..., Operand]:
        return lambda *values: np.frompyfunc(known, len(values), 1)(*values)

    from mpmath import mp

    digits = mp.clone()
    digits.dps = DIGITS
    known = _operations(digits)
    return Arithmetic(digits.mpf, {code: rule(known[code]) for code in known})


@functools.cache
def _operations(mp: MPContext) -> Mapping[int, Callable[..., mpf]]:
    one, zero = mp.mpf(1), mp.mpf(0)
    unary = {
        ca.OP_NEG: lambda x: -x,
        ca.OP_TWICE: lambda x: 2 * x,
        ca.OP_SQ: lambda x: x * x,
        ca.OP_INV: lambda x: 1 / x if x else mp.inf,
        ca.OP_ASSIGN: lambda x: x,
        ca.OP_FABS: abs,
        ca.OP_SIGN: mp.sign,
        ca.OP_NOT: lambda x: zero if x else one,
        ca.OP_CALL: lambda lookup, x: mp.mpf(float(lookup.at(float(x)))),
    }
    names = codes(
        "sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp log log1p expm1 erf sqrt"
        " floor ceil"
    )
    binary = {
        ca.OP_ADD: lambda x, y: x + y,
        ca.OP_SUB: lambda x, y: x - y,
        ca.OP_MUL: lambda x, y: x * y,
        ca.OP_DIV: lambda x, y: x / y if y else x * mp.inf,
        ca.OP_POW: mp.power,
        ca.OP_CONSTPOW: mp.power,
        ca.OP_ATAN2: mp.atan2,
        ca.OP_HYPOT: mp.hypot,
        ca.OP_FMIN: min,
        ca.OP_FMAX: max,
        ca.OP_LT: lambda x, y: one if x < y else zero,
        ca.OP_LE: lambda x, y: one if x <= y else zero,
        ca.OP_EQ: lambda x, y: one if x == y else zero,
        ca.OP_NE: lambda x, y: one if x != y else zero,
        ca.OP_AND: lambda x, y: one if x and y else zero,
        ca.OP_OR: lambda x, y: one if x or y else zero,
        ca.OP_COPYSIGN: lambda x, y: abs(x) if y >= 0 else -abs(x),
        ca.OP_IF_ELSE_ZERO: lambda x, y: y if x else zero,
        ca.OP_FMOD: lambda x, y: mp.sign(x) * mp.fmod(abs(x), abs(y)),
        ca.OP_REMAINDER: lambda x, y: x - y * mp.nint(x / y),
    }
    return unary | {code: getattr(mp, name) for code, name in names.items()} | binary


def closed(
    step: ca.Function,
    z: Sequence[Operand],
    given: Sequence[Sequence[Operand]],
    arithmetic: Arithmetic,
    small: Callable[[Operand], Any],
    most: int,
) -> tuple[list[Operand], bool]:
    """Iterated coordinates after at most so many Newton steps from ``z`` in an arithmetic, and
    whether the size of the last correction is ``small``.
    """
    add, z = arithmetic.operations[ca.OP_ADD], list(z)
    for _ in range(most):
        correction, (size,) = interpret(step, [z, *given], arithmetic)
        z = [add(a, b) for a, b in zip(z, correction, strict=True)]
        if small(size):
            return z, True
    return z, False
