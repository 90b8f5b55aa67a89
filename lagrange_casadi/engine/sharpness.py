"""Places at which a scene may be sharper than its instants: arguments of divisions, comparisons,
rotations and powers of its graph, to be watched.

Every quantity is made of time by a graph of operations. Sums and products make nothing sharp; what
does is a divisor that nearly vanishes, a comparison that changes, an angle that turns far between
two instants, or a steep function. The arguments of all such operations are smooth wherever those
inside them are, so their values at the instants show between which of them something may rise and
fall unseen. The search for peaks (``codegen/between.c``) reads them.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence, Set
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Flags
from ..base.interpret import Step, codes, expressed, followable, operation_of, replay
from ..base.lookups import is_entry
from ..base.quantities import Check
from ..base.scalars import column, graph, inputs_of
from ..base.symbolic import symbolic
from ..base.tables import LARGEST
from .program import Program


class Kind(enum.IntEnum):
    """Effect of a watched argument on what is made of it."""

    RATE = 0
    """Rate [rad/s] of an angle under a sine or cosine."""
    TURN = 1
    """Angle under a sine or cosine, known up to whole turns."""
    POLE = 2
    """Divisor: the quotient is without bound where it is zero."""
    ROOT = 3
    """A kink, at most, where it is zero."""
    SWITCH = 4
    """A jump or a kink where it passes one of some numbers."""
    STEP = 5
    """Jump at every whole number."""
    SOFT = 6
    """A steep change within some number of zero, and nothing beyond."""
    POWER = 7
    """An exponent."""
    KNOT = 8
    """A kink, at most, where it comes to one of some numbers."""


@dataclass(frozen=True)
class Watch:
    """A watched argument; ``at`` are the numbers at which it switches or has knots, or the one
    beyond which it changes nothing.
    """

    kind: Kind
    at: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Sharpness:
    """Watched functions of a scene.

    ``watched(t, d, d_rate, d_acceleration, z, p) -> out`` has a row for each of ``watches``.
    ``knots`` are the times at which the second derivative of a motion by samples has a kink.
    ``depends`` (watches, columns) says which columns of the graph depend on which watched function.
    """

    watched: ca.Function
    watches: tuple[Watch, ...]
    knots: tuple[float, ...]
    depends: Flags

    @classmethod
    @symbolic
    def of(cls, program: Program, columns: Sequence[int]) -> Sharpness:
        """Make it for some columns of a scene's graph.

        What is largest along a link is compared with much, and not looked into: it is as sharp as
        the link's law, and no sharper.
        """
        largest = {k for output, k in program.outputs.items() if output.group in LARGEST}
        laws = (
            {k for output, k in program.outputs.items() if output.along}
            if largest & {*columns}
            else set()
        )
        columns = sorted({*columns, *laws} - largest)
        given = inputs_of(program.instant)
        inputs = [*given.values()]
        knots = {t for knots in program.laws.knots for t in knots}
        found, depends = _Found(inputs, knots), dict[int, frozenset[int]]()
        sets = [[_NONE] * given.numel() for given in inputs]
        if followable(program.laws.motion):
            sets[1:4] = found.visit(
                program.laws.motion, [inputs[0], inputs[-1]], [sets[0], sets[5]]
            )
            sets[4] = [_NONE.union(*(one for some in sets[1:4] for one in some))] * len(sets[4])
        if followable(program.instant):
            out = ca.densify(program.instant(*inputs)[list(columns)])
            wanted = ca.Function("wanted", inputs, [out], {"cse": True})
            depends = dict(zip(columns, found.visit(wanted, inputs, sets)[0], strict=True))
        watched = graph("watched", given, out=column(row for row, _ in found.kept.values()))
        every = frozenset(number for _, number in found.kept)
        return cls(
            watched,
            tuple(watch for _, watch in found.kept.values()),
            tuple(sorted(knots)),
            np.array(
                [
                    [number in depends.get(k, every) for k in range(program.instant.size1_out(0))]
                    for _, number in found.kept
                ],
                bool,
            ).reshape(-1, program.instant.size1_out(0)),
        )

    def dependence(self, quantities: Iterable[Iterable[int]]) -> Flags:
        """Return which watched functions each quantity depends on, (watches, quantities), from the
        columns that each quantity is made of.
        """
        return np.stack([self.depends[:, [*columns]].any(axis=1) for columns in quantities], axis=1)


@symbolic
def with_watched(program: Program, sharpness: Sharpness) -> Program:
    """The graph with what is watched as further columns, the last ones: first for the search for
    peaks, then the marks of motions and constraints that may have kinks.
    """
    inputs = program.instant.sx_in()
    out, corners, p = program.instant(*inputs), program.data.corners, inputs[-1]
    marks = [smooth.marks(inputs[0], p) for smooth in corners.laws]
    marks += [
        smooth.marks(out[program.seen_columns(name)], p)
        for name, smooth in corners.constraints.items()
    ]
    rows = ca.vertcat(sharpness.watched(*inputs), *marks)
    watched = [Check("watched", str(k)) for k in range(rows.numel())]
    return program.with_columns([*program.columns, *watched], ca.vertcat(out, ca.densify(rows)))


def bent(program: Program, sharpness: Sharpness, t: Array, p: Array) -> Flags:
    """Between which of the instants ``t`` a motion by samples bends more than the instants show, (t
    - 1,).
    """
    found = np.zeros(max(t.size - 1, 0), bool)
    knots = np.array([knot for knot in sharpness.knots if t[0] < knot < t[-1]])
    if not knots.size or t.size < 3:
        return found | (t.size < 3)
    here, there = (np.atleast_2d(program.motion(times[None], p)[2].full()) for times in (t, knots))
    bends = np.abs(np.diff(here, 2))
    bends = np.concatenate([bends[:, :1], bends, bends[:, -1:]], axis=1)
    allowed = np.maximum(bends[:, :-1], bends[:, 1:]) / 2 + _ROUNDING * np.abs(here).max(
        axis=1, keepdims=True
    )
    place = np.searchsorted(t, knots, side="right") - 1
    chord = np.array([np.interp(knots, t, row) for row in here])
    np.logical_or.at(found, place, (np.abs(there - chord) > allowed[:, place]).any(axis=0))
    return found


_ROUNDING = 1e-12


class _Found:
    """Watched functions that have been found, by kind and argument, and their symbols.

    The time's own ``knots`` are known beforehand, and are not watched.
    """

    def __init__(self, inputs: Sequence[ca.SX], knots: Set[float]) -> None:
        self.knots = knots
        t, d, rate, acceleration, z, _ = inputs
        self.moving = ca.vertcat(t, d, rate, acceleration, z)
        self.place, self.place_rate = ca.vertcat(t, d), ca.vertcat(1, rate)
        self.others = ca.vertcat(rate, acceleration, z)
        self.kept: dict[tuple[Kind, int], tuple[Any, Watch]] = {}
        self.held: list[Any] = []

    def visit(
        self,
        function: ca.Function,
        inputs: Sequence[ca.SX],
        sets: Sequence[Sequence[frozenset[int]]],
    ) -> list[list[frozenset[int]]]:
        """Go through the operations of a function of ``inputs``, and return on which watched
        functions each nonzero of its outputs depends, from those of its inputs, ``sets``.
        """

        def made(
            _k: int, step: Step, given: list[tuple[ca.SX, frozenset[int]]]
        ) -> tuple[ca.SX, frozenset[int]]:
            operands = [expression for expression, _ in given]
            keys = _NONE.union(*(keys for _, keys in given))
            # So that no other node takes the place of one that is known by its number.
            self.held += operands
            for operation in operation_of(step, operands):
                keys = keys.union(*(self.add(*watched) for watched in _watched(*operation)))
            return expressed(step, operands), keys

        nodes = [
            [*zip(given.nonzeros(), keys, strict=True)]
            for given, keys in zip(inputs, sets, strict=True)
        ]
        return [[keys for _, keys in output] for output in replay(function, nodes, made)]

    def add(self, kind: Kind, argument: ca.SX, at: tuple[float, ...]) -> frozenset[int]:
        """Watch an argument, unless parameters alone set it, and return its number as a set."""
        argument = self.bare(argument) if kind in (Kind.POLE, Kind.ROOT) else argument
        if not self.moves(argument):
            return _NONE
        if (
            kind is Kind.KNOT
            and argument.element_hash() == self.moving[0].element_hash()
            and self.knots >= {*at}
        ):
            return _NONE
        self.held.append(argument)
        row = argument
        if kind is Kind.TURN and not ca.depends_on(argument, self.others):
            kind, row = Kind.RATE, ca.jtimes(argument, self.place, self.place_rate)
        elif kind is Kind.TURN and argument.is_symbolic():
            return _NONE  # an iterated angle, which is followed from instant to instant
        key = kind, argument.element_hash()
        if kind is Kind.ROOT and (Kind.POLE, key[1]) in self.kept:
            return frozenset(key[1:])
        if kind is Kind.POLE:
            self.kept.pop((Kind.ROOT, key[1]), None)
        known = self.kept[key][1].at if key in self.kept else ()
        self.kept[key] = row, Watch(kind, tuple(sorted({*known, *at})))
        return frozenset(key[1:])

    def moves(self, expression: ca.SX) -> bool:
        return not expression.is_constant() and bool(ca.depends_on(expression, self.moving))

    def bare(self, divisor: ca.SX) -> ca.SX:
        """A divisor without what is zero where it is, or nowhere: roots, squares, signs, and what
        parameters alone set.
        """
        while not (divisor.is_constant() or divisor.is_symbolic()):
            operation = divisor.op()
            if operation in _ALIKE:
                divisor = divisor.dep(0)
            elif operation in (ca.OP_MUL, ca.OP_DIV):
                moving = [part for part in (divisor.dep(0), divisor.dep(1)) if self.moves(part)]
                if len(moving) != 1:
                    return divisor
                divisor = moving[0]
            else:
                return divisor
        return divisor


_NONE: frozenset[int] = frozenset()
_ALIKE = codes("neg inv sq sqrt twice fabs copysign constpow")


_WATCHED: tuple[tuple[Collection[int], Kind, Callable[[Any, Any], Any], tuple[float, ...]], ...] = (
    (codes("div inv"), Kind.POLE, lambda _, y: y, ()),
    (codes("sin cos tan"), Kind.TURN, lambda x, _: x, ()),
    (codes("tan"), Kind.POLE, lambda x, _: ca.cos(x), ()),
    (codes("sqrt"), Kind.ROOT, lambda x, _: x, (0.0,)),
    (codes("hypot"), Kind.ROOT, lambda x, y: x * x + y * y, (0.0,)),
    (codes("eq ne fmin fmax"), Kind.SWITCH, lambda x, y: x - y, (0.0,)),
    (codes("fabs sign"), Kind.SWITCH, lambda x, _: x, (0.0,)),
    (codes("fmod"), Kind.STEP, lambda x, y: x / y, ()),
    (codes("remainder"), Kind.STEP, lambda x, y: x / y + 0.5, ()),
    (codes("fmod remainder"), Kind.POLE, lambda _, y: y, ()),
    # Beyond these numbers they are one, but for less than a rounding.
    (codes("tanh"), Kind.SOFT, lambda x, _: x, (20.0,)),
    (codes("erf"), Kind.SOFT, lambda x, _: x, (6.0,)),
    (codes("exp expm1 sinh cosh"), Kind.POWER, lambda x, _: x, ()),
    (codes("sinh cosh"), Kind.POWER, lambda x, _: -x, ()),
    (codes("log"), Kind.POLE, lambda x, _: x, ()),
    (codes("log1p"), Kind.POLE, lambda x, _: 1 + x, ()),
    (codes("asin acos"), Kind.ROOT, lambda x, _: 1 - x * x, (0.0,)),
    (codes("atanh"), Kind.POLE, lambda x, _: 1 - x * x, ()),
    (codes("acosh"), Kind.ROOT, lambda x, _: x * x - 1, (0.0,)),
    (codes("atan asinh"), Kind.POLE, lambda x, _: 1 + x * x, ()),
    (codes("atan2"), Kind.POLE, lambda x, y: x * x + y * y, ()),
)
"""Operations, and the watched argument that they make of their first and their last operand."""


def _watched(
    operation: int, operands: Sequence[ca.SX]
) -> Iterator[tuple[Kind, ca.SX, tuple[float, ...]]]:
    """Watched functions of an operation."""
    x, y = operands[0], operands[-1]
    for operations, kind, argument, at in _WATCHED:
        if operation in operations:
            yield kind, argument(x, y), at
    if operation in (ca.OP_LT, ca.OP_LE):
        if y.is_constant():
            yield Kind.SWITCH, x, (float(y),)
        elif x.is_constant():
            yield Kind.SWITCH, y, (float(x),)
        else:
            yield Kind.SWITCH, x - y, (0.0,)
    elif operation == ca.OP_COPYSIGN:
        # That of a root or a reciprocal keeps a sign through a division or a reflection, and makes
        # no jump.
        if x.is_constant() or x.is_symbolic() or x.op() not in (ca.OP_SQRT, ca.OP_INV):
            yield Kind.SWITCH, y, (0.0,)
    elif operation == ca.OP_CALL:
        yield Kind.KNOT, x, tuple(float(number) for number in ca.vertsplit(y))
    elif operation in (ca.OP_FLOOR, ca.OP_CEIL):
        if not is_entry(x):
            yield Kind.STEP, x, ()
    elif operation in (ca.OP_POW, ca.OP_CONSTPOW):
        power = float(y) if y.is_constant() else None
        if power is None or power < 0 or power != int(power):
            yield Kind.POLE, x, ()
        if power is None or abs(power) > _SMOOTH:
            yield Kind.POWER, y * ca.log(ca.fabs(x)), ()


_SMOOTH = 8
"""Up to this power nothing hides between instants."""
