"""Kinks and jumps of an expression, found numerically along a path, from the operations in which
there can be one.

What is differentiated twice must have a slope that does not jump: else rates jump, and
accelerations say nothing of it. With comparisons, sizes, whole parts and divisors, and with
functions at the ends of where they are defined, it may jump or not: the pieces of a cam's curve may
go on smoothly, and those of a table do not. So every place at which an operation may make a kink is
found to the last bit, and value and slopes on both sides of it are compared.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Array, Expression
from ..base.interpret import followable, operations
from ..base.lookups import is_entry
from ..base.scalars import entries
from ..base.symbolic import symbolic_property
from ..errors import DeclarationError
from .clearance import Clearance, Flags
from .steps import Side, Steps, between, called, sides_of, vanishes

_SAME, _FAINT = 1e-6, 1e-9
"""Relative size of a jump that is rounding: of the value or slope there, and of the largest along
the path.
"""

_MOST_PLACES = 0.9
"""Fraction of instants at which a constraint's terms are no larger than their reference."""

_ROUNDS, _SLACK = 8, 10.0
"""Number of places that are sought in a step; and the factor by which extrapolated limits may
differ more.
"""

_DIP, _TOUCH = 0.3, 1e-12
"""Relative distance to zero at which an argument is examined, and that which counts as zero."""

_APART = (-1.0, -(2.0**-10), -(2.0**-20), 2.0**-20, 2.0**-10, 1.0)
"""Distances, in steps, from an instant to the neighbours with which it is first compared."""

_STRETCHES = 0.25 ** np.arange(20, -1, -1)
"""Numbers of steps over which rounding may spread a place."""

_ROUNDING = 16 * np.finfo(float).eps

_LEAST, _MOST = 2.0**-40, 1 << 20
"""Part of a step in which nothing is left but a kink, and the number of such parts that are looked
at together.
"""

_AT_ONCE = 1 << 17
"""Numbers of each operation that are looked at together."""


@dataclass(frozen=True, eq=False)
class Smooth:
    """A scalar expression whose slopes must not jump, and operations in it that may make them.

    ``symbols`` are those of the moving symbols that it depends on. ``marks(x, p)`` are arguments of
    operations that may make a kink where they pass zero, or a whole number if ``whole``; what is
    ``open`` there may be without bound, or have a slope that is, and may make a kink where it only
    touches zero too. ``turns(x, p, way)`` are the marks' derivatives along a way, ``slopes(x, p)``
    the value and its derivatives by the symbols. ``uses`` (fixed,) says on which fixed symbols it
    depends.
    """

    symbols: tuple[Any, ...]
    marks: Any
    turns: Any
    slopes: Any
    whole: Flags
    open: Flags
    uses: Flags

    @classmethod
    def of(cls, expression: Expression, moving: ca.SX, fixed: ca.SX) -> Smooth | None:
        """Make it from an expression of ``moving`` and ``fixed`` symbols; None if nothing can make
        a kink.
        """
        expression = ca.SX(expression)
        symbols = [symbol for symbol in entries(moving) if ca.depends_on(expression, symbol)]
        if not symbols:
            return None
        x, direction = ca.vertcat(*symbols), ca.SX.sym("way", len(symbols))
        function = ca.Function("sought", [x, fixed], [ca.densify(expression)], {"cse": True})
        found: dict[tuple[int, bool, bool], Any] = {}
        followed = followable(function)
        for operation, operands in operations(function, [x, fixed]) if followed else ():
            for mark, whole, crossing in marks_of(operation, operands):
                if not mark.is_constant() and ca.depends_on(mark, x):
                    found[mark.element_hash(), whole, crossing] = mark
        if not found and followed:
            return None
        rows = ca.vertcat(*found.values()) if followed else ca.SX(0, 1)
        kinds = np.array([key[1:] for key in found], bool).reshape(-1, 2)
        slopes = ca.vertcat(expression, ca.gradient(expression, x))
        turns = ca.densify(ca.jtimes(rows, x, direction))
        uses = [ca.depends_on(expression, symbol) for symbol in entries(fixed)]
        return (cls if followed else Opaque)(
            tuple(symbols),
            ca.Function("marks", [x, fixed], [ca.densify(rows)], {"cse": True}),
            ca.Function("turns", [x, fixed, direction], [turns], {"cse": True}),
            ca.Function("slopes", [x, fixed], [ca.densify(slopes)], {"cse": True}),
            kinds[:, 0],
            kinds[:, 1],
            np.array(uses, bool),
        )

    def kink(self, path: Array, values: Sequence[float]) -> Kink | None:
        """The worst kink along a path (symbols, n) of straight steps, for ``values`` of the fixed
        symbols.
        """
        found = [*self._kinks(np.asarray(path, float)[None], np.array(values, float)[None])]
        if not found:
            return None
        _, what, jump, place = max(found, key=lambda one: (one[1] == "value", one[2]))
        return Kink(what, jump, self._named(place))

    def isolated(
        self, path: Array, values: Sequence[float], *, between: bool = False
    ) -> Isolated | None:
        """An instant of a path (symbols, n), or a place ``between`` two, at which something is
        other than on both sides of it.
        """
        found = next(
            self._isolated(np.asarray(path, float)[None], np.array(values, float)[None], between),
            None,
        )
        return None if found is None else Isolated(found[1], self._named(found[2]))

    def _named(self, place: Array) -> dict[str, float]:
        return {symbol.name(): float(x) for symbol, x in zip(self.symbols, place, strict=True)}

    @symbolic_property
    def _bends(self) -> ca.Function:
        """The function ``(x, p, way)`` of the value, its derivatives by the symbols, and the second
        one along a way.
        """
        x, p, direction = self.turns.sx_in()
        slopes = self.slopes(x, p)
        along = ca.jtimes(ca.dot(slopes[1:], direction), x, direction)
        return ca.Function(
            "bends", [x, p, direction], [ca.densify(ca.vertcat(slopes, along))], {"cse": True}
        )

    @symbolic_property
    def clearance(self) -> Clearance:
        """Return along which paths no mark comes near to where it passes, at a small part of the
        cost of looking for kinks.
        """
        return Clearance(self.marks, self.whole, self.open)

    def broken(self, paths: Array, p: Array) -> Flags:
        """Return which paths (d, symbols, n) have a kink, for values ``p`` (d, fixed) of each."""
        return _owners(self._kinks, paths, p)

    def isolates(self, paths: Array, p: Array, *, between: bool = False) -> Flags:
        """Return which paths (d, symbols, n) have an isolated instant, or place ``between``, for
        values ``p`` (d, fixed) of each.
        """
        return _owners(partial(self._isolated, between=between), paths, p)

    def _kinks(self, paths: Array, p: Array) -> Iterator[tuple[int, str, float, Array]]:
        """Every kink: the number of its path, what jumps, by what part of it, and where."""
        count, _, n = paths.shape
        if n < 2 or not count:
            return
        flat = np.moveaxis(paths, 1, 0).reshape(len(self.symbols), -1)
        fixed = np.repeat(p.T, n, axis=1)
        with np.errstate(all="ignore"):
            marks = called(self.marks, flat, fixed).reshape(-1, count, n)
            passed, touched, _ = self._places(Steps.of(paths, p), marks)
            if not (passed.owner.size or touched.owner.size):
                return
            usual = _usual(called(self.slopes, flat, fixed).reshape(-1, count, n), paths)
            found = [*self._compared(passed, usual), *self._limits(touched, usual)]
        yield from found

    def _isolated(self, paths: Array, p: Array, between: bool) -> Iterator[tuple[int, str, Array]]:
        """Every instant with a value, slope or curvature of its own: the number of its path, what
        it is, and where.

        It is where an operation's mark is zero, or a whole number, to the last bit. Where one of
        them jumps, what lies between both sides is no other.
        """
        count, symbols, n = paths.shape
        if not count:
            return
        flat, fixed = np.moveaxis(paths, 1, 0).reshape(symbols, -1), np.repeat(p.T, n, axis=1)
        with np.errstate(all="ignore"):
            marks = called(self.marks, flat, fixed)
            steps = Steps.through(paths, p)
            steps = steps.some(self._exact(marks).any(axis=0).nonzero()[0])
            if between and n > 1:
                passed, _, turned = self._places(Steps.of(paths, p), marks.reshape(-1, count, n))
                ends = [of.to(end, end) for of in (passed, turned) for end in (of.low, of.high)]
                steps = Steps.joined([steps, *ends])
            # It is no place alone where a mark stays as it is.
            exact, *beside = (
                self._exact(self._marks(steps, steps.low + far)) for far in (0.0, *_APART)
            )
            alone = exact & ~np.all(beside, axis=0)
            steps, alone = steps.some(alone.any(axis=0).nonzero()[0]), alone[:, alone.any(axis=0)]
            if not steps.owner.size:
                return
            here = called(self._bends, steps.at(steps.low), steps.p, steps.change)
            # Most are at rest, or go on as they are.
            others = [
                called(self._bends, steps.at(steps.low + far), steps.p, steps.change)
                for far in _APART
            ]
            some = np.isfinite(here).all(axis=0) & ~np.all(
                [row == here for row in others], axis=(0, 1)
            )
            if not some.any():
                return
            steps, here, alone = steps.some(np.flatnonzero(some)), here[:, some], alone[:, some]
            rows = called(self._bends, flat, fixed, Steps.through(paths, p).change).reshape(
                -1, count, n
            )
            usual = np.concatenate([_usual(rows[:-1], paths), _finite(rows[-1:]).max(axis=2)])[
                :, steps.owner
            ]
            kinds = np.array([0, *[1] * symbols, 2])
            # A curvature goes on to change over what a place is spread.
            faint = _FAINT * usual
            faint[2] = np.maximum(_FAINT, self._stretch(steps, alone)) * usual[2]
            sides = [
                Side(side.value - here[:, None], side.off, side.there)
                for side in sides_of(self._bends, steps, steps.low)
            ]
            same, signs = [], []
            for side in sides:
                sizes = np.abs(side.value) + np.abs(here)[:, None]
                sizes = np.array([sizes[kinds == kind].max(axis=0) for kind in range(3)])
                least = _SLACK * (_SAME * sizes + faint[:, None])
                same.append(vanishes(side, sizes[kinds], least[kinds])[0])
                signs.append(side.nearest_signs)
        other = ~(same[0] | same[1] | (signs[0] * signs[1] < 0.0))
        places = steps.at(steps.low)
        for k in np.flatnonzero(other.any(axis=0)):
            what = ("value", "slope", "curvature")[kinds[other[:, k].argmax()]]
            yield int(steps.owner[k]), what, places[:, k]

    def _stretch(self, steps: Steps, alone: Flags) -> Array:
        """Number of steps over which a place is spread: the least for which a mark that is
        ``alone`` there, (marks, m), does not change.

        Two curves that touch in a third power are the same number for so long.
        """
        found = np.where(alone, _STRETCHES[0], np.inf)
        for far, beyond in itertools.pairwise(_STRETCHES):
            ends = [
                self._exact(self._marks(steps, steps.low + direction * far))
                for direction in (-1.0, 1.0)
            ]
            found[alone & np.any(ends, axis=0)] = beyond
        return np.asarray(found.min(axis=0))

    def _exact(self, marks: Array) -> Flags:
        """Return which marks (marks, m) are zero, or a whole number, to the last bit."""
        return np.asarray(marks == np.where(self.whole[:, None], np.rint(marks), 0.0))

    def _places(self, steps: Steps, marks: Array) -> tuple[Steps, Steps, Steps]:
        """Places at which marks pass, are undefined, or turn back: steps from just before to just
        after.
        """
        states = self._states(marks)
        changed = np.flatnonzero((states[..., 1:] != states[..., :-1]).any(axis=0))
        turned, row = self._turned(steps, marks)
        at = turned.at(turned.low)
        there = self._marks(turned, turned.low)
        largest = np.where(np.isfinite(marks), np.abs(marks), 0.0).max(axis=2)[row, turned.owner]
        beside = np.maximum(
            *(np.abs(self._marks(turned, x)[row, np.arange(row.size)]) for x in (0.0, 1.0))
        )
        zero = np.abs(there[row, np.arange(row.size)]) <= _TOUCH * beside + _ROUNDING * largest
        touched = [turned.some(zero & self.open[row])]
        waiting = [steps.some(changed)]
        if at.size:
            waiting += [turned.to(0.0, turned.low), turned.to(turned.low, 1.0)]
        passed = []
        for _ in range(_ROUNDS):
            rest = Steps.joined(waiting)
            ends = [self._state(rest, x) for x in (rest.low, rest.high)]
            rest = rest.some((ends[0] != ends[1]).any(axis=0))
            if not rest.owner.size:
                break
            found = rest.halved(partial(self._state, rest))
            ends = [self._state(found, x) for x in (found.low, found.high)]
            changes, crossing = ends[0] != ends[1], self.open[:, None]
            passed.append(found.some((changes & ~crossing).any(axis=0)))
            touched.append(found.some((changes & crossing).any(axis=0)))
            waiting = [found.to(found.high, rest.high)]
        return Steps.joined(passed or [steps.some([])]), Steps.joined(touched), turned

    def _turned(self, steps: Steps, marks: Array) -> tuple[Steps, npt.NDArray[np.intp]]:
        """Places between instants at which marks turn back near zero, or near a whole number; and
        which marks.
        """
        n = marks.shape[2]
        if n < 3:
            return steps.some([]), np.zeros(0, np.intp)
        whole = self.whole[:, None, None]
        far = np.abs(marks - np.where(whole, np.rint(marks), 0.0))
        before, here, after = far[..., :-2], far[..., 1:-1], far[..., 2:]
        lowest = here - (after - before) ** 2 / (8.0 * (after - 2.0 * here + before))
        row, owner, place = np.nonzero((here <= before) & (here <= after) & (lowest <= _DIP * here))
        number = np.concatenate([owner * (n - 1) + place, owner * (n - 1) + place + 1])
        row, some = np.concatenate([row, row]), steps.some(number)

        def rises(x: Array, of: Steps = some, rows: npt.NDArray[np.int64] = row) -> Flags:
            slopes = called(self.turns, of.at(x), of.p, of.change)
            return np.asarray(slopes[rows, np.arange(rows.size)] > 0.0)[None]

        turning = (rises(some.low) != rises(some.high))[0]
        some, row = some.some(turning), row[turning]
        return some.halved(lambda x: rises(x, some, row)), row

    def _state(self, steps: Steps, x: Array | float) -> Array:
        return self._states(self._marks(steps, x))

    def _marks(self, steps: Steps, x: Array | float) -> Array:
        return called(self.marks, steps.at(x), steps.p)

    def _states(self, marks: Array) -> Array:
        """Side of a place on which each mark is."""
        whole = self.whole.reshape(-1, *[1] * (marks.ndim - 1))
        return np.where(whole, np.floor(marks), marks > 0.0)

    def _compared(self, steps: Steps, usual: Array) -> Iterator[tuple[int, str, float, Array]]:
        """Kinks where marks pass, by what is just before and just after; what seems one must have
        other limits on both sides.

        A size of what only touches zero has a slope of zero where rounding makes it nothing. Where
        the path ends there is one side.
        """
        off = steps.off(4.0, 1.0)
        # Off the place itself, where a size has the slope of neither side.
        before, after = (
            called(self.slopes, steps.at(x), steps.p) for x in (steps.low - off, steps.high + off)
        )
        gaps = _both(np.abs(after - before))
        sizes = _both(np.maximum(np.abs(before), np.abs(after)))
        broken = gaps > _SAME * sizes + _FAINT * usual[:, steps.owner]
        at_end = (steps.low - off <= steps.least) | (steps.high + off >= steps.most)
        yield from _worst(steps.some(at_end), (gaps / sizes)[:, at_end], broken[:, at_end])
        yield from self._limits(steps.some(broken.any(axis=0) & ~at_end), usual)

    def _limits(self, steps: Steps, usual: Array) -> Iterator[tuple[int, str, float, Array]]:
        """Kinks where something may be without bound: both sides must have limits, and the same
        ones.

        What is beyond the path's ends has no say.
        """
        if not steps.owner.size:
            return
        before, after = sides = sides_of(self.slopes, steps, (steps.low + steps.high) / 2)
        # The largest of slopes says what is large or small for all of them.
        rows = np.minimum(np.arange(len(self.symbols) + 1), 1)

        faint = _FAINT * usual[:, steps.owner]

        def vanishing(side: Side, sizes: Array, faint: Array) -> tuple[Flags, Array]:
            sizes = _both(sizes)
            least = _SLACK * (_SAME * sizes + faint[:, None])
            found, part = vanishes(side, sizes[rows], least[rows])
            return np.array([found[0], found[1:].all(axis=0)]), _both(part)

        same, part = vanishing(
            between(before, after), np.maximum(np.abs(before.value), np.abs(after.value)), faint
        )
        # What is large elsewhere may be so for it has no limit here.
        limits = np.array(
            [vanishing(side.steps, side.sizes, 0.0 * faint)[0] for side in sides]
        ).all(axis=0)
        yield from _worst(steps, np.where(limits, part, np.inf), ~(same & limits))


class Opaque(Smooth):
    """An expression that calls what cannot be followed, as a function of another program: nobody
    knows where it may have kinks, and its values, slopes and curvatures are compared instead.
    """

    @property
    def clearance(self) -> Clearance:
        """Nothing is known to be clear."""
        return Unclear(self.marks, self.whole, self.open)

    def _kinks(self, paths: Array, p: Array) -> Iterator[tuple[int, str, float, Array]]:
        """Steps in which value, slope and curvature at the ends do not agree, however often they
        are halved: cubic polynomials miss the value by h^5, and the slope by h^3.
        """
        steps, bends = Steps.of(paths, p), self._bends

        def at(steps: Steps, share: Array) -> Array:
            rows = called(bends, steps.at(share), steps.p, steps.change)
            return np.array([rows[0], (rows[1:-1] * steps.change).sum(axis=0), rows[-1]])

        with np.errstate(all="ignore"):
            before, after = at(steps, steps.low), at(steps, steps.high)
            usual = np.fmax.reduce(_finite(before[:2]), axis=1, initial=0.0)[:, None]
            while steps.low.size:
                h = steps.high - steps.low
                value, slope, _ = after - before
                value = value - h * (before[1] + after[1]) / 2 + h**2 * (after[2] - before[2]) / 12
                slope = slope - h * (before[2] + after[2]) / 2
                parts = np.abs([value, slope]) / np.fmax(usual, np.finfo(float).tiny)
                parts = np.where(np.isnan(parts), np.inf, parts)
                left = (parts > _SAME).any(axis=0)
                steps, before, after, parts = (
                    steps.some(np.flatnonzero(left)),
                    before[:, left],
                    after[:, left],
                    parts[:, left],
                )
                middle = (steps.low + steps.high) / 2
                if steps.low.size > _MOST or (h < _LEAST).all():
                    parts = parts if (h < _LEAST).all() else np.full_like(parts, np.inf)
                    yield from _worst(steps, parts, parts > _SAME)
                    return
                there = at(steps, middle)
                steps = Steps.joined([steps.to(steps.low, middle), steps.to(middle, steps.high)])
                before, after = np.hstack([before, there]), np.hstack([there, after])

    def _isolated(self, paths: Array, p: Array, between: bool) -> Iterator[tuple[int, str, Array]]:
        """Nothing is known of single instants."""
        yield from ()


class Unclear(Clearance):
    """Clearance of what cannot be followed: all paths are looked at."""

    def near(self, low: Array, high: Array, p: Array, paths: Callable[..., Array]) -> Flags:
        """Every path, (d,)."""
        return np.ones(len(p), bool)


def _usual(slopes: Array, paths: Array) -> Array:
    """Size of the value and the slopes (rows, d, n) along paths (d, symbols, n), (2, d).

    A constraint's value is zero but for rounding: it is as large as what is added up in it, at most
    places. A slope beside a pole says nothing of what is added up elsewhere.
    """
    sizes = _finite(slopes)
    terms = (sizes[1:] * np.abs(np.moveaxis(paths, 1, 0))).sum(axis=0)
    value = np.maximum(sizes[0].max(axis=1), np.quantile(terms, _MOST_PLACES, axis=1))
    return np.array([value, sizes[1:].max(axis=(0, 2))])


def _finite(rows: Array) -> Array:
    """Sizes, without those that are no numbers."""
    return np.where(np.isfinite(rows), np.abs(rows), 0.0)


def _owners(
    search: Callable[
        [Array, Array], Iterator[tuple[int, str, float, Array]] | Iterator[tuple[int, str, Array]]
    ],
    paths: Array,
    p: Array,
) -> Flags:
    """Return which paths (d, symbols, n) have a finding."""
    found = np.zeros(len(paths), bool)
    size = max(1, _AT_ONCE // max(paths.shape[2], 1))
    for start in range(0, len(paths), size):
        some = slice(start, start + size)
        found[[start + k for k, *_ in search(paths[some], p[some])]] = True
    return found


def _both(rows: Array) -> Array:
    """Row of the value, and that of the largest of slopes."""
    return np.array([rows[0], rows[1:].max(axis=0)])


def _worst(steps: Steps, parts: Array, broken: Flags) -> Iterator[tuple[int, str, float, Array]]:
    """Kinks by what part of it jumps of the value and of slopes, (2, m); without bound where there
    is no limit.
    """
    places = steps.at(steps.high)
    for k in np.flatnonzero(broken.any(axis=0)):
        row = 0 if broken[0, k] else 1
        yield int(steps.owner[k]), ("value", "slope")[row], float(parts[row, k]), places[:, k]


@dataclass(frozen=True)
class Kink:
    """A place, by symbol, at which a value or a slope jumps; by what part of it, infinite where it
    has no limit.
    """

    what: str
    jump: float
    at: Mapping[str, float]

    def __str__(self) -> str:
        does = f"jumps by {100.0 * self.jump:.3g} %" if math.isfinite(self.jump) else "has no limit"
        return f"its {self.what} {does} where {_place(self.at)}"

    def refused(self, what: str) -> DeclarationError:
        """The error for ``what`` has the kink."""
        return DeclarationError(
            f"{what}: {self}: rates would jump there, and accelerations would be wrong; expected a"
            " curve with a continuous slope, as curve(x, y) in place of a table, a polynomial or"
            " a Fourier sum"
        )


@dataclass(frozen=True)
class Isolated:
    """An instant, by symbol, at which a value, a slope or a curvature is other than on both sides
    of it.
    """

    what: str
    at: Mapping[str, float]

    def __str__(self) -> str:
        return f"its {self.what} where {_place(self.at)} differs from its values on both sides"

    def refused(self, what: str) -> DeclarationError:
        """The error for ``what`` is isolated at an instant."""
        return DeclarationError(
            f"{what}: {self}: the value is that of this instant alone; expected other instants, or"
            " a curve that is continuous there: if_else, fabs, sign and floor are not, so in"
            " place of if_else(x == 0, 1, sin(x)/x) take a series for small x"
        )


def _place(at: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.6g}" for name, value in at.items())


_TRUTHS = (ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_NOT, ca.OP_AND, ca.OP_OR)


def marks_of(operation: int, operands: Sequence[ca.SX]) -> Iterator[tuple[Expression, bool, bool]]:
    """Expressions at whose zeros, or whole numbers, an operation has a kink; and whether it is
    undefined there.
    """
    x, y = operands[0], operands[-1]
    if operation in (ca.OP_LE, ca.OP_FMIN, ca.OP_FMAX, ca.OP_LT):
        yield (y - x if operation == ca.OP_LT else x - y), False, False
    elif operation in (ca.OP_FABS, ca.OP_SIGN, ca.OP_COPYSIGN):
        yield from ((one, False, False) for one in operands)
    elif operation in (ca.OP_EQ, ca.OP_NE):
        yield from ((one, False, False) for one in _zeros(x - y))
    elif operation in (ca.OP_NOT, ca.OP_IF_ELSE_ZERO):
        yield from ((one, False, False) for one in _zeros(x))
    elif operation in (ca.OP_AND, ca.OP_OR):
        yield from ((mark, False, False) for one in operands for mark in _zeros(one))
    elif operation in (ca.OP_FLOOR, ca.OP_CEIL):
        # What a table has for a cell is a whole number already.
        if not is_entry(x):
            yield (x if operation == ca.OP_FLOOR else -x), True, False
    elif operation in (ca.OP_FMOD, ca.OP_REMAINDER):
        yield x / y + (0.5 if operation == ca.OP_REMAINDER else 0.0), True, False
        yield y, False, True
    elif operation in (ca.OP_DIV, ca.OP_INV):
        yield y, False, True
    elif operation == ca.OP_TAN:
        yield ca.cos(x), False, True
    elif operation in (ca.OP_SQRT, ca.OP_LOG):
        yield x, False, True
    elif operation == ca.OP_LOG1P:
        yield 1.0 + x, False, True
    elif operation in (ca.OP_ASIN, ca.OP_ACOS, ca.OP_ATANH):
        yield 1.0 - x * x, False, True
    elif operation == ca.OP_ACOSH:
        yield x - 1.0, False, True
    elif operation == ca.OP_HYPOT:
        yield x * x + y * y, False, True
    elif operation == ca.OP_ATAN2:
        # Its cut is where the first is zero and the second negative.
        yield x, False, False
        yield x * x + y * y, False, True
    elif operation in (ca.OP_POW, ca.OP_CONSTPOW) and not (
        y.is_constant() and float(y) >= 0.0 and float(y).is_integer()
    ):
        yield x, False, True


def _zeros(x: ca.SX) -> Iterator[Expression]:
    """Marks of where something is zero, for a stretch or at a place that it passes; a comparison
    has marks of its own.
    """
    if x.op() not in _TRUTHS:
        yield from (ca.fabs(x), x)
