"""The stages of an instant: the functions that are called one after another to evaluate it.

First the drive, which gives the driven coordinates and their rates at a time; then, where loops are
iterated, a Newton step of theirs, as often as it takes; last the instant itself, all that follows
from both.

What is *counted* (time, driven coordinates, and sums, products and whole parts of them) grows with
the turns; nothing else does. Where turns are few, the drive hands on time and coordinates as they
are. Where they are many, or numbers are single, all that is counted is followed in pairs
(:mod:`.compensated`), and handed on when it is small again: an angle under a sine or cosine without
its whole turns, the rest rounded once. What comes after does not know the difference.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from ...base.arrays import Array, Expression, Operand, spread
from ...base.interpret import REMAINDERS, Arithmetic, codes, followable, interpret, numpy_arithmetic
from ...base.scalars import applied, column, entries, graph
from ...base.symbolic import Graphs, symbolic
from ...base.vocabulary import Precision
from ..compensated import Pair, Pairs
from ..program import Program

FEW_TURNS = 128.0
"""Up to so many radians an angle in one double has lost no more than 1.4e-14 rad of its phase in
each rounding.
"""

_SAMPLES = 65


@dataclass(frozen=True, eq=False)
class Stages(Graphs):
    """The functions of an instant, in a precision.

    ``drive(t, p) -> (counted, d_rate, d_acceleration)``; ``loops(z, counted, p) -> (correction,
    size)`` where loops are iterated; ``instant(counted, d_rate, d_acceleration, z, p) -> out``, and
    ``closing`` of the same, see :func:`.closing_of`, where it is asked for. The drive of single
    precision takes t and p as pairs, all the rests after all the values. Where drives are given
    (:func:`controlled`), ``law(t, p) -> (d, d_rate, d_acceleration)`` is what they would do.
    """

    drive: ca.Function
    loops: Any | None
    instant: ca.Function
    closing: ca.Function | None = None
    precision: Precision = "double"
    law: Any = None

    def instructions(self, steps: int) -> int:
        """Number of instructions an instant, with ``steps`` Newton steps if loops are iterated."""
        loops = steps * self.loops.n_instructions() if self.loops is not None else 0
        return int(self.drive.n_instructions() + loops + self.instant.n_instructions())


@symbolic
@functools.lru_cache(maxsize=32)
def plain(program: Program, *, closing: bool = False) -> Stages:
    """The stages of a graph in doubles that count turns themselves; with ``closing`` or without."""
    t, d, rate, acceleration, z, p = program.instant.sx_in()
    counted, given = ca.vertcat(t, d), [t, d, rate, acceleration, z, p]
    taken = [counted, rate, acceleration, z, p]
    instant = ca.Function("instant", taken, program.instant.call(given))
    closed = ca.Function("closing", taken, program.closing.call(given)) if closing else None
    loops = None
    if program.newton is not None:
        loops = ca.Function("loops", [z, counted, p], program.newton.step.call([z, t, d, p]))
    driven = program.motion.call([t, p])
    drive = ca.Function("drive", [t, p], [ca.vertcat(t, driven[0]), *driven[1:]])
    return Stages(drive, loops, instant, closed)


@symbolic
@functools.lru_cache(maxsize=32)
def compensated(program: Program, precision: Precision, *, closing: bool = False) -> Stages:
    """The stages of a graph in pairs; with ``closing`` or without.

    Raises :class:`DeclarationError` for a graph that cannot be followed.
    """
    pairs, single = Pairs(precision), precision == "single"
    time = ca.SX.sym("t", 2 if single else 1)
    parameters = ca.SX.sym("p", program.instant.size1_in("p"), 2 if single else 1)
    t_pair, *p_pairs = (
        Pair(row[0], row[1] if single else None) for row in (time.T, *ca.vertsplit(parameters))
    )
    driven, *changes = interpret(program.laws.motion, [[t_pair], p_pairs], pairs.arithmetic)
    # As a controller gives them: see controlled().
    driven = [Pair(x.high, _rest(x)) for x in driven] if single else driven
    handed, loops, instant, closed = _counted(
        program, pairs, t_pair, driven, p_pairs, closing=closing
    )
    given = [handed, *(_column([pair.value for pair in row]) for row in changes)]
    drive = ca.Function("drive", [time, ca.vec(parameters)], given, {"cse": True})
    return Stages(drive, loops, instant, closed, precision)


@symbolic
@functools.lru_cache(maxsize=32)
def controlled(
    program: Program, precision: Precision, fixed: tuple[float, ...] | None = None
) -> Stages:
    """The stages of a graph by its driven coordinates, for code that a controller calls; in doubles
    the caller counts turns, in singles pairs do.

    The drive is ``count(moment, p) -> counted``. A moment is the time and the driven coordinates;
    in single precision all of them once more follow, what rounding them to single left. So do t and
    d of the law; parameters do not.

    Where parameters are ``fixed``, pairs have all the digits of these numbers, as of other
    constants. Raises :class:`DeclarationError` for a graph that cannot be followed in pairs.
    """
    if precision == "double":
        stages, p = plain(program, closing=True), program.instant.sx_in("p")
        moment = ca.SX.sym("moment", stages.instant.size1_in(0))
        count = graph("count", {"moment": moment, "p": p}, counted=moment)
        return replace(stages, drive=count, law=program.laws.motion)
    pairs, rows = Pairs(precision), 1 + len(program.driven)
    moment, p = ca.SX.sym("moment", rows, 2), program.instant.sx_in("p")
    t, *driven = (Pair(row[0], row[1]) for row in ca.vertsplit(moment))
    known = [Pair(x) for x in entries(p)] if fixed is None else [pairs.constant(x) for x in fixed]
    handed, loops, instant, closed = _counted(program, pairs, t, driven, known, closing=True)
    count = graph("count", {"moment": ca.vec(moment), "p": p}, counted=handed)
    law = _paired_law(program.laws.motion, pairs, p, known)
    return Stages(count, loops, instant, closed, precision, law)


def _rest(pair: Pair) -> ca.SX:
    return ca.SX(0) if pair.low is None else pair.low


def _paired_law(smooth: ca.Function, pairs: Pairs, p: ca.SX, known: Sequence[Pair]) -> ca.Function:
    """The motion of drives by a time in pairs, each coordinate as a pair; ``known`` are the
    parameters.
    """
    time = ca.SX.sym("t", 2)
    values, *changes = interpret(smooth, [[Pair(time[0], time[1])], known], pairs.arithmetic)
    driven = [*(x.high for x in values), *map(_rest, values)]
    found = [_column(driven), *(_column([pair.value for pair in row]) for row in changes)]
    return ca.Function("law", [time, p], found, {"cse": True})


def stages_for(
    program: Program, precision: Precision, t: Array, p: Array, *, closing: bool = False
) -> Stages:
    """Stages for instants and parameters: in pairs if numbers are single, and if angles count many
    turns; with ``closing`` or without.
    """
    return (
        compensated(program, precision, closing=closing)
        if precision == "single" or turns_many(program, t, p)
        else plain(program, closing=closing)
    )


def turns_many(program: Program, t: Array, p: Array) -> bool:
    """Return whether some angle counts so many turns over the instants that one double loses its
    phase.
    """
    functions = (
        program.instant,
        program.laws.motion,
        *([program.newton.step] if program.newton else []),
    )
    if not all(followable(function) for function in functions):
        return False
    return (
        _largest(program, tuple(t[spread(t.size, _SAMPLES)].tolist()), tuple(p.tolist()))
        > FEW_TURNS
    )


@functools.lru_cache(maxsize=256)
def _largest(program: Program, instants: tuple[float, ...], p: tuple[float, ...]) -> float:
    """The largest counted angle under a sine or cosine [rad], or of which whole turns are taken.

    What is counted is a row over the instants, what parameters set a number, and anything else
    nothing.
    """
    angles = [0.0]
    known = numpy_arithmetic().operations

    def measured(code: int, *values: Operand) -> Operand:
        if np.ndim(values[0]) and code in _PHASES | REMAINDERS | {ca.OP_FLOOR}:
            angles.append(
                float(np.max(np.abs(values[0]))) * (math.tau if code == ca.OP_FLOOR else 1.0)
            )
        return known[code](*values)

    def counted(code: int, *values: Operand | None) -> Operand | None:
        if any(value is None for value in values):
            return None
        found = measured(code, *values)
        return found if code in _FOLLOWED or not np.ndim(found) else None

    following, of_counted = (
        Arithmetic(np.float64, {code: functools.partial(rule, code) for code in known})
        for rule in (measured, counted)
    )
    t = np.array(instants)
    unknown, rates = [None] * program.instant.size1_in("z"), [None] * len(program.driven)
    with np.errstate(all="ignore"):
        driven = list(interpret(program.laws.motion, [[t], p], following)[0])
        if program.newton is not None:
            interpret(program.newton.step, [unknown, [t], driven, p], of_counted)
        interpret(program.instant, [[t], driven, rates, rates, unknown, p], of_counted)
    return max(angles)


@dataclass(frozen=True, eq=False)
class _Value:
    """A value of a stage: as it is evaluated at an instant, and as a pair where it can be followed
    in pairs.

    ``fixed`` is what parameters alone set.
    """

    plain: Any = None
    pair: Pair | None = None
    fixed: bool = False


class _Counting:
    """Arithmetic that follows in pairs what is counted, and makes a symbol where it goes over into
    what is not.
    """

    def __init__(self, pairs: Pairs) -> None:
        self.pairs = pairs
        self.symbols: dict[tuple[Any, ...], tuple[Any, Pair, Pair]] = {}

    @property
    def arithmetic(self) -> Arithmetic:
        known = numpy_arithmetic().operations
        rules: dict[int, Any] = {code: functools.partial(self.apply, code) for code in known}
        rules[ca.OP_CALL] = lambda table, value: _Value(table.function(self.settled(value)))
        return Arithmetic(self.constant, rules)

    def constant(self, value: float) -> _Value:
        return _Value(
            ca.SX(value),
            self.pairs.turn if value == math.tau else self.pairs.constant(value),
            fixed=True,
        )

    def apply(self, code: int, *values: _Value) -> _Value:
        pairs = [value.pair for value in values if value.pair is not None]
        if len(pairs) < len(values):
            return _Value(self._plain(code, values))
        if all(value.fixed for value in values):
            return _Value(
                self._plain(code, values), self.pairs.operations[code](*pairs), fixed=True
            )
        if code in _FOLLOWED:
            return _Value(pair=self.pairs.operations[code](*pairs))
        if code in REMAINDERS:
            return _Value(self.settled(_Value(pair=self.pairs.operations[code](*pairs))))
        if code in _PHASES:
            return _Value(ca.SX.unary(code, self._symbol("angle", pairs[0], self.pairs.reduced)))
        return _Value(self._plain(code, values))

    def settled(self, value: _Value) -> Expression:
        """A value as one number."""
        if value.plain is not None:
            return value.plain
        assert value.pair is not None
        return self._symbol("counted", value.pair, lambda pair: pair)

    def handed(self) -> tuple[ca.SX, ca.SX]:
        """The symbols that were made, and what the drive hands on for them."""
        return _column([symbol for symbol, *_ in self.symbols.values()]), _column(
            [pair.value for _, pair, _ in self.symbols.values()]
        )

    def _plain(self, code: int, values: Sequence[_Value]) -> ca.SX:
        return applied(code, *map(self.settled, values))

    def _symbol(self, kind: str, pair: Pair, made: Callable[[Pair], Pair]) -> Expression:
        """The symbol of what is made of a pair, which is known by its nodes: they are kept, lest
        others take their place.
        """
        key = (
            kind,
            *(None if part is None else part.element_hash() for part in (pair.high, pair.low)),
        )
        if key not in self.symbols:
            self.symbols[key] = ca.SX.sym(f"{kind}{len(self.symbols)}"), made(pair), pair
        return self.symbols[key][0]


_PHASES = {*codes("sin cos tan")}
_FOLLOWED = codes("add sub neg mul sq twice div inv sqrt fabs floor ceil")


def _counted(
    program: Program,
    pairs: Pairs,
    t: Pair,
    driven: Sequence[Pair],
    p: Sequence[Pair],
    *,
    closing: bool,
) -> tuple[ca.SX, ca.Function | None, ca.Function, ca.Function | None]:
    """Outputs of the drive stage for time and driven coordinates, and the loops, the instant and,
    if it is asked for, the ``closing`` that take them.
    """
    counting = _Counting(pairs)
    _, _, rate, acceleration, z, symbols = program.instant.sx_in()
    t_value, d_values = _Value(pair=t), [_Value(pair=pair) for pair in driven]
    p_values = [
        _Value(symbol, pair, fixed=True) for symbol, pair in zip(entries(symbols), p, strict=True)
    ]
    z_values, rates, accelerations = (
        [_Value(x) for x in entries(column)] for column in (z, rate, acceleration)
    )
    whole = [[t_value], d_values, rates, accelerations, z_values, p_values]

    functions = [("instant", program.instant, whole)]
    if program.newton is not None:
        step = [z_values, [t_value], d_values, p_values]
        functions.insert(0, ("loops", program.newton.step, step))
    if closing:
        functions.append(("closing", program.closing, whole))
    results = {
        name: [
            _column([counting.settled(value) for value in output])
            for output in interpret(function, given, counting.arithmetic)
        ]
        for name, function, given in functions
    }
    counted, handed = counting.handed()
    taken = {"loops": [z, counted, symbols]}
    found = {
        name: ca.Function(
            name, taken.get(name, [counted, rate, acceleration, z, symbols]), out, {"cse": True}
        )
        for name, out in results.items()
    }
    return handed, found.get("loops"), found["instant"], found.get("closing")


def _column(parts: list[ca.SX]) -> ca.SX:
    return ca.densify(column(parts))
