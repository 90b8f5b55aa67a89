"""Where an expression has a kink or a jump: found numerically, from the operations in which it can have one.

What is differentiated twice must have a slope that does not jump: else rates jump, and accelerations say nothing of it. With
comparisons, sizes and whole parts it may jump or not: the pieces of a cam's curve may go on smoothly, and those of a table do not.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..arithmetic.interpret import Arithmetic, followable, interpret, numpy_arithmetic, steps
from ..errors import DeclarationError

Span = tuple[float, float]

_SAME = 1e-6
"""Of a slope or value: what is no jump."""

_FAINT = 1e-9
"""Of an ordinary slope or value: what is none."""

_HALVINGS, _MOST = 60, 64
_LINEAR, _NEAR, _FAR = 4001, 8.0, 5

_STATES: dict[int, Callable[..., Any]] = {
    ca.OP_LT: np.less,
    ca.OP_LE: np.less_equal,
    ca.OP_FMIN: np.less,
    ca.OP_FMAX: np.less,
    ca.OP_FABS: np.signbit,
    ca.OP_SIGN: np.signbit,
    ca.OP_COPYSIGN: lambda x, y: np.signbit(y),
    ca.OP_FLOOR: np.floor,
    ca.OP_CEIL: np.ceil,
    ca.OP_FMOD: lambda x, y: np.trunc(x / y),
    ca.OP_REMAINDER: lambda x, y: np.rint(x / y),
}
"""On which side of a place where an operation has a kink or a jump its arguments are."""


@dataclass(frozen=True)
class Kink:
    """A place, by symbol, at which a value or a slope jumps; by what part of it."""

    what: str
    jump: float
    at: dict[str, float]

    def __str__(self) -> str:
        place = ", ".join(f"{name} = {value:.6g}" for name, value in self.at.items())
        return f"its {self.what} jumps by {100.0 * self.jump:.3g} % where {place}"


def refuse_kinks(what: str, expression: Any, moving: Any, fixed: Any, values: Sequence[float], span: Span | None = None) -> None:
    """Raise :class:`DeclarationError` for what is to be differentiated twice and has a kink; arguments as of :func:`kink`."""
    found = kink(expression, moving, fixed, values, span)
    if found is not None:
        raise DeclarationError(
            f"{what}: {found}: rates would jump there, and accelerations would miss that; expected a curve whose slope does not "
            "jump, of CasADi's functions: in place of a table, a curve(x, y), a polynomial or a Fourier sum"
        )


def kink(expression: Any, moving: Any, fixed: Any, values: Sequence[float], span: Span | None) -> Kink | None:
    """A kink or jump of a scalar expression along lines through its ``moving`` symbols; None where it has none there.

    ``fixed`` symbols have ``values``. With a ``span`` there is one moving symbol, which is looked at within the span.
    """
    own = [symbol for symbol in ca.vertsplit(moving) if ca.depends_on(expression, symbol)] if moving.numel() else []
    if not own:
        return None
    symbols = ca.vertcat(*own)
    function = ca.Function("sought", [symbols, fixed], [ca.SX(expression)])
    if not followable(function) or not any(step.operation in _STATES for step in steps(function)):
        return None
    slopes = ca.Function("slopes", [symbols, fixed], [ca.vertcat(expression, ca.gradient(ca.SX(expression), symbols))])
    for start, way, parts in _lines(len(own), span):
        with np.errstate(all="ignore"):
            # Within a span, what stands still most of the time has its largest values for ordinary ones.
            found = _along(function, slopes, start, way, parts, values, np.median if span is None else np.max)
        if found is not None:
            what, jump, place = found
            return Kink(what, jump, {symbol.name(): float(x) for symbol, x, b in zip(own, place, way, strict=True) if b != 0.0})
    return None


def _lines(many: int, span: Span | None) -> Iterator[tuple[Any, Any, Any]]:
    """Starts, directions and parts of lines: along each symbol, the others anywhere, and a few across all."""
    if span is not None:
        yield np.zeros(1), np.ones(1), np.linspace(*span, _LINEAR)
        return
    generator = np.random.default_rng(0)
    far = np.logspace(-_FAR, _FAR, 20 * _FAR)
    parts = np.sort(np.concatenate([np.linspace(-_NEAR, _NEAR, _LINEAR), far, -far]))
    for way in [*np.eye(many), *([generator.normal(size=many) for _ in range(3)] if many > 1 else [])]:
        yield generator.uniform(-1.0, 1.0, many) * (way == 0.0), way, parts


def _along(
    function: Any, slopes: Any, start: Any, way: Any, parts: Any, values: Sequence[float], ordinary: Callable[[Any], Any]
) -> tuple[str, float, Any] | None:
    """What jumps along a line, by what part of it, and where; ``ordinary`` tells of many sizes what is an ordinary one."""

    def states(at: Any) -> Any:
        seen: list[Any] = []

        def of(code: int, rule: Callable[..., Any], *arguments: Any) -> Any:
            if code in _STATES:
                seen.append(np.broadcast_to(np.asarray(_STATES[code](*arguments), float), at.shape))
            return rule(*arguments)

        known = numpy_arithmetic()
        operations = {code: functools.partial(of, code, rule) for code, rule in known.operations.items()}
        rows = [a + b * at for a, b in zip(start, way, strict=True)]
        interpret(function, [rows, [np.float64(value) for value in values]], Arithmetic(known.constant, operations))
        return np.array(seen)

    at = states(parts)
    changes = np.flatnonzero((at[:, 1:] != at[:, :-1]).any(axis=0))
    changes = changes[np.linspace(0, changes.size - 1, min(changes.size, _MOST)).astype(int)] if changes.size else changes
    low, high, before = parts[changes], parts[changes + 1], at[:, changes]
    for _ in range(_HALVINGS if changes.size else 0):
        middle = (low + high) / 2
        same = (states(middle) == before).all(axis=0)
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    # Off the place itself, where a size has the slope of neither side.
    off = 4.0 * np.spacing(np.maximum(np.abs(low), 1.0))
    low, high = low - off, high + off
    ends = [slopes(start[:, None] + way[:, None] * x[None], values).full() for x in (low, high)] if changes.size else []
    if not ends:
        return None
    usual = np.abs(slopes(start[:, None] + way[:, None] * parts[None, ::50], values).full())
    usual = np.where(np.isfinite(usual), usual, 0.0)
    for what, rows in (("value", slice(0, 1)), ("slope", slice(1, None))):
        gap = np.abs(ends[1][rows] - ends[0][rows]).max(axis=0)
        size = np.maximum(*(np.abs(end[rows]).max(axis=0) for end in ends))
        least = _FAINT * ordinary(usual[rows].max(axis=0))
        jumps = np.flatnonzero(gap > _SAME * size + least)
        if jumps.size:
            worst = jumps[np.argmax(gap[jumps] / size[jumps])]
            return what, float(gap[worst] / size[worst]), start + way * high[worst]
    return None
