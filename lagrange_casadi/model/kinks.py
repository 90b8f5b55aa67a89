"""Kinks and jumps of an expression along a path, from the marks of its operations.

What is differentiated twice must have a slope that does not jump: else rates jump, and
accelerations say nothing of it. A mark is an argument of an operation that may jump, have a kink or
have no bound where the mark is zero, or a whole number: of comparisons, sizes, whole parts,
divisors, and of functions at the ends of where they are defined. An expression without marks is
smooth. Where a mark changes its side along the path, or touches zero, is bisected to the last bit;
there the limits of value and slopes from both sides, taken over distances that halve, decide.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression, Flags
from ..base.interpret import followable, operations
from ..base.lookups import is_entry
from ..base.scalars import column, entries, graph, inputs_of
from ..base.symbolic import symbolic_property
from ..errors import DeclarationError
from .one_sided_limits import (
    CROSSED,
    INSTANT,
    OPEN,
    TOUCHED,
    Line,
    Numbers,
    Places,
    Side,
    halved,
)

_SAME, _FAINT, _SLACK = 1e-6, 1e-9, 10.0
"""Relative size of a jump that is rounding: of value or slope there, and of the largest along the
path; and the factor by which limits may differ more.
"""

_CURVED = 1e-4
"""Relative size of a jump of the curvature that is rounding."""

_ROUNDS = 8
"""Number of places that are sought in a step."""

_DIP, _TOUCH = 0.3, 1e-12
"""Relative distance to zero at which a mark is examined, and that which counts as zero."""

_ROUNDING = 16 * float(np.finfo(float).eps)
"""Rounding of a mark, relative to its largest size."""

_APART = (-1.0, -(2.0**-20), 2.0**-20, 1.0)
"""Distances, in steps, at which a mark that stays zero is no place."""

_LEAST, _MOST = 2.0**-40, 1 << 13
"""Part of a step in which nothing is left but a kink, and the most parts of steps that are halved
together.
"""

_AT_ONCE = 1 << 17
"""Number of instants that are looked at together."""


class Kink(NamedTuple):
    """A place on the path of a number, its ``owner``, at which a value or a slope jumps by a part
    of it, infinite where it has no limit, NaN where that is not known; or is other than on both
    sides, ``alone``.
    """

    owner: int
    what: str
    jump: float
    alone: bool
    place: Array

    def refusal(self, where: str) -> str:
        """Reason why what has the kink is refused, in words; ``where`` names the place."""
        if self.alone:
            return (
                f"its {self.what} where {where} differs from its values on both sides: the value is"
                " that of this instant alone; expected other instants, or a curve that is"
                " continuous there: if_else, fabs, sign and floor are not"
            )
        if math.isnan(self.jump):
            return (
                f"its {self.what} near {where} changes too fast between two instants for a kink to"
                " be seen; expected a shorter span, more instants or a slower curve"
            )
        does = f"jumps by {100.0 * self.jump:.3g} %" if math.isfinite(self.jump) else "has no limit"
        return (
            f"its {self.what} {does} where {where}: rates would jump there, and accelerations would"
            " be wrong; expected a curve with a continuous slope, as curve(x, y) in place of a"
            " table, a polynomial or a Fourier sum"
        )


@dataclass(frozen=True, eq=False)
class Smooth:
    """A scalar expression whose slopes must not jump, and its marks; messages call it ``what``.

    ``symbols`` are those of the moving symbols that it depends on. ``marks(x, p)`` count where they
    are zero, or a whole number if ``whole``; what is ``open`` may have no bound there, and may have
    a kink where the mark only touches zero too. Without marks the expression cannot be followed.
    ``bends(x, p, way)`` are the value, its derivatives by the symbols, and the second derivative
    along a way. ``uses`` (fixed,) says on which fixed symbols the expression depends.
    """

    what: str
    symbols: tuple[Any, ...]
    marks: Any
    bends: Any
    whole: Flags
    open: Flags
    uses: Flags

    @classmethod
    def of(cls, what: str, expression: Expression, moving: ca.SX, fixed: ca.SX) -> Smooth | None:
        """Make it from an expression of ``moving`` and ``fixed`` symbols; None if nothing can make
        a kink.

        Raises :class:`.DeclarationError` for a comparison by == or !=, which says something of
        single instants only.
        """
        expression = ca.SX(expression)
        symbols = [symbol for symbol in entries(moving) if ca.depends_on(expression, symbol)]
        if not symbols:
            return None
        x, way = ca.vertcat(*symbols), ca.SX.sym("way", len(symbols))
        given = {"x": x, "p": fixed}
        function = graph("sought", given, sought=expression)
        found: dict[tuple[int, bool, bool], Any] = {}
        followed = followable(function)
        for operation, operands in operations(function, [x, fixed]) if followed else ():
            for mark, whole, crossing in marks_of(operation, operands):
                if mark.is_constant() or not ca.depends_on(mark, x):
                    continue
                if operation in (ca.OP_EQ, ca.OP_NE):
                    raise DeclarationError(
                        f"{what}: it compares {operands[0]} with {operands[1]} by == or !=, which"
                        " differ at single instants; expected <, <=, > or >=, and in place of"
                        " if_else(x == 0, 1, sin(x)/x) a series for small x"
                    )
                found[mark.element_hash(), whole, crossing] = mark
        if not found and followed:
            return None
        slopes = ca.gradient(expression, x)
        along = ca.jtimes(ca.dot(slopes, way), x, way)
        kinds = np.array([key[1:] for key in found], bool).reshape(-1, 2)
        return cls(
            what,
            tuple(symbols),
            graph("marks", given, marks=column(found.values())),
            graph("bends", given | {"way": way}, bends=ca.vertcat(expression, slopes, along)),
            kinds[:, 0],
            kinds[:, 1],
            np.array([ca.depends_on(expression, symbol) for symbol in entries(fixed)], bool),
        )

    @symbolic_property
    def _turns(self) -> ca.Function:
        """The function ``(x, p, way)`` of the derivatives of marks along a way."""
        given = inputs_of(self.bends)
        x, p, way = given.values()
        return graph("turns", given, turns=ca.jtimes(self.marks(x, p), x, way))

    def kink(
        self, path: Array, values: Sequence[float], *, between: bool = False, at: bool = True
    ) -> Kink | None:
        """The worst kink along a path (symbols, n) of straight steps, for ``values`` of the fixed
        symbols; or what is other ``at`` an instant alone, or at a place ``between`` two.
        """
        paths, p = np.asarray(path, float)[None], np.array(values, float)[None]
        found = self._kinks(paths, p, between, at)
        return max(
            found, key=lambda one: (not one.alone, one.what == "value", one.jump), default=None
        )

    def refuse(self, path: Array, values: Sequence[float], **asked: bool) -> None:
        """Raise :class:`.DeclarationError` for the worst kink, as of :meth:`kink`."""
        if worst := self.kink(path, values, **asked):
            places = zip(self.symbols, worst.place.tolist(), strict=True)
            where = ", ".join(f"{symbol.name()} = {value:.6g}" for symbol, value in places)
            raise DeclarationError(f"{self.what}: {worst.refusal(where)}")

    def broken(self, paths: Array, p: Array) -> Flags:
        """Return which paths (d, symbols, n) have a kink, or a place alone, for values ``p`` (d,
        fixed) of each.
        """
        found = np.zeros(len(paths), bool)
        size = max(1, _AT_ONCE // paths.shape[2])
        for start in range(0, len(paths), size):
            some = slice(start, start + size)
            owners = {one.owner for one in self._kinks(paths[some], p[some], True, True)}
            found[[start + k for k in owners]] = True
        return found

    def _kinks(self, paths: Array, p: Array, between: bool, at: bool) -> list[Kink]:
        """Everything that is found along paths (d, symbols, n) for values ``p`` (d, fixed)."""
        with np.errstate(all="ignore"):
            line = Line(paths, p)
            if not self.whole.size:
                return [*_inconsistent(self.bends, line)]
            places = self._places(line, line.all(self.marks), between, at)
            if not places.step.size:
                return []
            usual = line.usual(self.bends)[self._kinds][:, line.owner[places.step]]
            some = self._unequal(line, places, usual, between)
            if not some.size:
                return []
            known, places = places.middle, places.some(some)
            return [*self._judged(line, places, usual[:, some], known, between)]

    def _sides(self, marks: Array) -> Array:
        """Side of a place on which marks (marks, m) are."""
        return np.where(self.whole[:, None], np.floor(marks), marks > 0.0)

    def _off(self, marks: Array) -> Array:
        """Distance of marks (marks, m) from where they count."""
        return np.asarray(np.abs(marks - np.where(self.whole[:, None], np.rint(marks), 0.0)))

    def _places(self, line: Line, marks: Array, between: bool, at: bool) -> Places:
        """Places at which ``marks`` (marks, instants) change their sides, touch zero, or are zero
        ``at`` an instant.
        """
        sides = self._sides(marks).reshape(len(marks), *line.shape)
        # A mark that touches zero at an instant, but for rounding, does not pass it.
        off, least = self._off(marks).reshape(sides.shape), _rounding(marks.reshape(sides.shape))
        inner, before, after = sides[..., 1:-1], sides[..., :-2], sides[..., 2:]
        touches = (off[..., 1:-1] <= least[..., None]) & (before == after)
        inner[touches] = before[touches]
        changed = (sides[..., 1:] != sides[..., :-1]).any(axis=0)
        step = np.flatnonzero(np.pad(changed, ((0, 0), (0, 1))))
        turned, zero = self._turned(line, marks)
        kind = np.where(self.open[turned.kind], OPEN, TOUCHED)
        parts = [turned._replace(kind=kind).some(zero & (between | (kind == OPEN)))]
        turned = turned.some(~zero)
        step = np.concatenate([step, turned.step, turned.step])
        low = np.concatenate([np.zeros(step.size - turned.low.size), turned.high])
        end = np.concatenate([np.ones(changed.sum()), turned.low, np.ones(turned.low.size)])
        for _ in range(_ROUNDS):
            before, after = (self._sides(line.rows(self.marks, step, x)) for x in (low, end))
            left = (before != after).any(axis=0)
            step, low, end, before = step[left], low[left], end[left], before[:, left]
            if not step.size:
                break
            low, high = halved(partial(self._same, line, step, before), low, end)
            ends = (self._sides(line.rows(self.marks, step, x)) for x in (low, high))
            crossing = np.logical_and(np.not_equal(*ends), self.open[:, None]).any(axis=0)
            parts.append(Places(step, low, high, np.where(crossing, OPEN, CROSSED)))
            low = high
        if at:
            parts.append(self._instants(line, self._off(marks) == 0.0))
        return Places(*map(np.concatenate, zip(*parts, strict=True)))

    def _same(self, line: Line, step: Numbers, before: Array, share: Array) -> Flags:
        return np.asarray((self._sides(line.rows(self.marks, step, share)) == before).all(axis=0))

    def _instants(self, line: Line, zero: Flags) -> Places:
        """Instants at which a mark is ``zero`` (marks, instants), but does not stay so."""
        step = np.flatnonzero(zero.any(axis=0))
        stays = [
            self._off(line.rows(self.marks, step, np.full(step.size, far), free=True)) == 0.0
            for far in _APART
        ]
        step = step[(zero[:, step] & ~np.all(stays, axis=0)).any(axis=0)]
        none = np.zeros(step.size)
        return Places(step, none, none, np.full(step.size, INSTANT))

    def _turned(self, line: Line, marks: Array) -> tuple[Places, Flags]:
        """Places at which marks turn back near zero, with the number of the mark for a kind; and
        which of them touch zero.
        """
        n = line.shape[1]
        off = self._off(marks).reshape(-1, *line.shape)
        before, here, after = off[..., :-2], off[..., 1:-1], off[..., 2:]
        lowest = here - (after - before) ** 2 / (8.0 * (after - 2.0 * here + before))
        row, owner, k = np.nonzero((here <= before) & (here <= after) & (lowest <= _DIP * here))
        row, step = np.tile(row, 2), np.concatenate([owner * n + k, owner * n + k + 1])
        none = np.zeros(step.size)
        rises = [self._rises(line, step, row, none + end) for end in (0.0, 1.0)]
        least = np.tile(_rounding(marks.reshape(off.shape))[row[: k.size], owner], 2)
        some = rises[0] != rises[1]
        step, row, first, none = step[some], row[some], rises[0][some], none[some]
        low, high = halved(
            lambda x: np.asarray(self._rises(line, step, row, x) == first), none, none + 1.0
        )
        each = np.arange(row.size)
        there = np.minimum(
            *(self._off(line.rows(self.marks, step, x))[row, each] for x in (low, high))
        )
        ends = (np.abs(line.rows(self.marks, step, none + x))[row, each] for x in (0.0, 1.0))
        zero = there <= _TOUCH * np.maximum(*ends) + least[some]
        return Places(step, low, high, row), np.asarray(zero)

    def _rises(self, line: Line, step: Numbers, row: Numbers, share: Array) -> Flags:
        return np.asarray(line.rows(self._turns, step, share)[row, np.arange(row.size)] > 0.0)

    @property
    def _kinds(self) -> Numbers:
        """Kind of each row of ``bends``: 0 for the value, 1 for slopes, 2 for the curvature."""
        return np.array([0, *[1] * len(self.symbols), 2])

    def _tolerance(self, sides: Sequence[Array] | Array, usual: Array) -> Array:
        """Difference of rows (rows, m) from two sides that is rounding."""
        sizes = np.maximum(*np.abs(sides))
        sizes[1:-1] = sizes[1:-1].max(axis=0)
        tight, faint = np.array([[_SAME, _SAME, _CURVED], [_FAINT, _FAINT, _CURVED]])
        return np.asarray(tight[self._kinds, None] * sizes + faint[self._kinds, None] * usual)

    def _unequal(self, line: Line, places: Places, usual: Array, between: bool) -> Numbers:
        """Numbers of places that rows just before and just after do not show to be smooth."""
        step, low, high, kind = places
        off, free = line.off(step), kind == INSTANT
        near = [line.rows(self.bends, step, x, free) for x in (low - off, high + off)]
        least = self._tolerance(near, usual)
        smooth = (kind == CROSSED) & (np.abs(near[1] - near[0]) <= least)[:-1].all(axis=0)
        for share in (low, high) if between else ():
            smooth &= _within(line.rows(self.bends, step, share), near, least).all(axis=0)
        ends = (low - off < line.least[step]) | (high + off > line.most[step])
        return np.flatnonzero(~(smooth | (ends & (kind == CROSSED))))

    def _judged(
        self, line: Line, places: Places, usual: Array, known: Array, between: bool
    ) -> Iterator[Kink]:
        """Places at which value or slopes have other limits on both sides, or are other than both
        limits.
        """
        before, after = line.limits(self.bends, places, known)
        sides, gap = (before.limit, after.limit), np.abs(after.limit - before.limit)
        least = self._tolerance(np.nan_to_num(sides), usual) + before.off + after.off
        jumps = (gap > _SLACK * least) & ~(before.absent | after.absent)
        jumps &= ~(before.rounds(after.limit) | after.rounds(before.limit))
        endless = before.endless(usual) | after.endless(usual)
        broken = (jumps | endless) & (places.kind != INSTANT)
        asked = (between | (places.kind == INSTANT)) & ~(broken.any(axis=0) | endless)
        low, high = (
            asked & self._alone(line, places, share, before, after, _SLACK * least)
            for share in (places.low, places.high)
        )
        at = line.at(places.step, np.where(low.any(axis=0), places.low, places.high))
        part = np.where(endless, np.inf, gap / np.maximum(*np.abs(sides)))
        kinks, alone = broken[:-1], low | high
        for k in np.flatnonzero(kinks.any(axis=0) | alone.any(axis=0)):
            lone = not kinks[:, k].any()
            row = int((alone if lone else kinks)[:, k].argmax())
            jump = 0.0 if lone else float(part[row : 1 if row == 0 else -1, k].max())
            what = ("value", "slope", "curvature")[self._kinds[row]]
            yield Kink(int(line.owner[places.step[k]]), what, jump, lone, at[:, k])

    def _alone(
        self, line: Line, places: Places, share: Array, before: Side, after: Side, least: Array
    ) -> Flags:
        """Return which rows (rows, m) are at a share of steps neither of the limits, nor between
        them: only where a mark is zero to the last bit.
        """
        here = line.rows(self.bends, places.step, share)
        exact = (self._off(line.rows(self.marks, places.step, share)) == 0.0).any(axis=0)
        sides = [
            np.where(side.absent, other.limit, side.limit)
            for side, other in ((before, after), (after, before))
        ]
        rounds = before.rounds(here) | after.rounds(here) | (before.absent & after.absent)
        return np.asarray(exact & ~rounds & ~_within(here, sides, least))


def _rounding(marks: Array) -> Array:
    """Rounding of marks (marks, d, n) along each path, (marks, d)."""
    sizes = np.where(np.isfinite(marks), np.abs(marks), 0.0)
    return np.asarray(_ROUNDING * sizes.max(axis=2, initial=0.0))


def _within(here: Array, sides: Sequence[Array], least: Array) -> Flags:
    """Return where values lie between two sides, or as near to one as ``least``, or are none."""
    low, high = np.minimum(*sides) - least, np.maximum(*sides) + least
    return np.asarray((here >= low) & (here <= high) | ~np.isfinite(here))


def _inconsistent(bends: ca.Function, line: Line) -> Iterator[Kink]:
    """Steps over which value and slope do not change by the integrals of slope and curvature,
    however often they are halved: Simpson's rule misses these by h^5.

    For what cannot be followed, as a function of another program.
    """
    n = line.shape[1]
    step = np.flatnonzero(np.tile(np.arange(n) < n - 1, line.shape[0]))

    def at(share: Array) -> Array:
        rows = line.rows(bends, step, share)
        return np.array([rows[0], (rows[1:-1] * line.way[:, step]).sum(axis=0), rows[-1]])

    low, high = np.zeros(step.size), np.ones(step.size)
    before, after = at(low), at(high)
    usual = np.where(np.isfinite(before[:2]), np.abs(before[:2]), 0.0).max(axis=1, initial=0.0)
    usual = np.fmax(usual, np.finfo(float).tiny)[:, None]
    while step.size:
        middle, there = (low + high) / 2, at((low + high) / 2)
        rates = (before + 4.0 * there + after)[1:] / 6.0
        part = np.abs((after - before)[:2] - (high - low) * rates) / usual
        left = ~(part <= _SAME).all(axis=0)
        step, part = step[left], part[:, left]
        low, middle, high = low[left], middle[left], high[left]
        if step.size > _MOST or (high - low < _LEAST).all():
            break
        before, there, after = (rows[:, left] for rows in (before, there, after))
        step, low, high = np.tile(step, 2), np.r_[low, middle], np.r_[middle, high]
        before, after = np.hstack([before, there]), np.hstack([there, after])
    for k, place in enumerate(line.at(step, high).T):
        row = 1 if part[0, k] <= _SAME else 0
        jump = float(part[row, k]) if high[k] - low[k] < _LEAST else math.nan
        yield Kink(int(line.owner[step[k]]), ("value", "slope")[row], jump, False, place)


_TRUTHS = (ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_NOT, ca.OP_AND, ca.OP_OR)


def marks_of(operation: int, operands: Sequence[ca.SX]) -> Iterator[tuple[Expression, bool, bool]]:
    """Expressions at whose zeros, or whole numbers, an operation has a kink; and whether it is
    undefined there.
    """
    x, y = operands[0], operands[-1]
    for marks, whole, crossing in ((_CROSSED, 0, 0), (_WHOLE, 1, 0), (_UNDEFINED, 0, 1)):
        if operation in marks:
            yield from ((mark, bool(whole), bool(crossing)) for mark in marks[operation](x, y))


def _zeros(x: ca.SX) -> Iterator[Expression]:
    """Marks of where something is zero, for a stretch or at a place that it passes; a comparison
    has marks of its own.
    """
    if x.op() not in _TRUTHS:
        yield from (ca.fabs(x), x)


def _unless_natural(x: ca.SX, y: ca.SX) -> list[ca.SX]:
    """The mark of a power; one with a natural number as exponent has none."""
    natural = y.is_constant() and float(y) >= 0.0 and float(y).is_integer()
    return [] if natural else [x]


_Marks = dict[int, Callable[[Any, Any], Iterable[Any]]]

_CROSSED: _Marks = {
    ca.OP_LT: lambda x, y: [y - x],
    **dict.fromkeys((ca.OP_LE, ca.OP_FMIN, ca.OP_FMAX), lambda x, y: [x - y]),
    **dict.fromkeys((ca.OP_EQ, ca.OP_NE), lambda x, y: [x - y]),
    **dict.fromkeys((ca.OP_FABS, ca.OP_SIGN), lambda x, _: [x]),
    ca.OP_COPYSIGN: lambda x, y: [x, y],
    **dict.fromkeys((ca.OP_NOT, ca.OP_IF_ELSE_ZERO), lambda x, _: _zeros(x)),
    **dict.fromkeys((ca.OP_AND, ca.OP_OR), lambda x, y: [*_zeros(x), *_zeros(y)]),
    # Its cut is where the first is zero and the second negative.
    ca.OP_ATAN2: lambda x, _: [x],
}
"""Marks at whose zeros an operation of two operands, or of one alone, has a kink or jumps."""

_WHOLE: _Marks = {
    # What a table has for a cell is a whole number already.
    ca.OP_FLOOR: lambda x, _: [] if is_entry(x) else [x],
    ca.OP_CEIL: lambda x, _: [] if is_entry(x) else [-x],
    ca.OP_FMOD: lambda x, y: [x / y],
    ca.OP_REMAINDER: lambda x, y: [x / y + 0.5],
}
"""Marks at whose whole numbers an operation jumps."""

_UNDEFINED: _Marks = {
    **dict.fromkeys((ca.OP_FMOD, ca.OP_REMAINDER, ca.OP_DIV, ca.OP_INV), lambda _, y: [y]),
    ca.OP_TAN: lambda x, _: [ca.cos(x)],
    **dict.fromkeys((ca.OP_SQRT, ca.OP_LOG), lambda x, _: [x]),
    ca.OP_LOG1P: lambda x, _: [1.0 + x],
    **dict.fromkeys((ca.OP_ASIN, ca.OP_ACOS, ca.OP_ATANH), lambda x, _: [1.0 - x * x]),
    ca.OP_ACOSH: lambda x, _: [x - 1.0],
    **dict.fromkeys((ca.OP_HYPOT, ca.OP_ATAN2), lambda x, y: [x * x + y * y]),
    **dict.fromkeys((ca.OP_POW, ca.OP_CONSTPOW), _unless_natural),
}
"""Marks at whose zeros an operation has no bound, or is not defined on both sides."""
