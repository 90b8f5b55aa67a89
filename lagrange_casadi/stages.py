"""What is evaluated at an instant, in order: the drive, iterated loops, and all that follows from them.

What is *counted* (time, driven coordinates, and sums, products and whole parts of them) grows with the turns; nothing else does.
Where turns are few, the drive hands on time and coordinates as they are. Where they are many, or numbers are single, all that is
counted is followed in pairs (:mod:`.compensated`), and handed on when it is small again: an angle under a sine or cosine without
its whole turns, the rest rounded once. What comes after does not know the difference.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from .compensated import Pair, Pairs, Precision, unsimplified
from .density import Array
from .interpret import Arithmetic, followable, interpret
from .scene_graph import SceneGraph

FEW_TURNS = 128.0
"""Up to so many radians an angle in one double has lost no more than 1.4e-14 rad of its phase in each rounding."""

_SAMPLES = 17


@dataclass(frozen=True, eq=False)
class Stages:
    """The functions of an instant, in a precision.

    ``drive(t, p) -> (counted, d_rate, d_acceleration)``; ``loops(z, counted, p) -> (correction, size)`` where loops are iterated;
    ``instant(counted, d_rate, d_acceleration, z, p) -> out``. The drive of single precision takes t and p as pairs, all the rests
    after all the values.
    """

    drive: Any
    loops: Any | None
    instant: Any
    precision: Precision = "double"
    compensated: bool = False


@functools.lru_cache(maxsize=32)
def plain(graph: SceneGraph) -> Stages:
    """The stages of a graph in doubles that count turns themselves."""
    t, d, rate, acceleration, z, p = graph.instant.sx_in()
    counted = ca.vertcat(t, d)
    instant = ca.Function("instant", [counted, rate, acceleration, z, p], graph.instant.call([t, d, rate, acceleration, z, p]))
    loops = None
    if graph.newton is not None:
        loops = ca.Function("loops", [z, counted, p], graph.newton.step.call([z, t, d, p]))
    smooth = graph.motion.is_a("SXFunction")
    time, values = (t, p) if smooth else (ca.MX.sym("t"), ca.MX.sym("p", p.numel()))
    driven = graph.motion.call([time, values])
    drive = ca.Function("drive", [time, values], [ca.vertcat(time, driven[0]), *driven[1:]])
    return Stages(drive, loops, instant)


@functools.lru_cache(maxsize=32)
def compensated(graph: SceneGraph, precision: Precision) -> tuple[Stages, Any]:
    """The stages of a graph in pairs; and the angles that they reduce, as a function of t and p in doubles.

    Raises :class:`DeclarationError` for a graph that calls functions of its own.
    """
    with unsimplified():
        return _compensated(graph, precision)


def counts(graph: SceneGraph, t: Array, p: Array) -> bool:
    """Whether some angle counts so many turns over the instants that one double loses its phase."""
    if not all(followable(function) for function in (graph.instant, graph.motion, *([graph.newton.step] if graph.newton else []))):
        return False
    sampled = t[np.linspace(0, t.size - 1, min(t.size, _SAMPLES)).astype(int)]
    return _largest(graph, tuple(sampled), tuple(p)) > FEW_TURNS


@functools.lru_cache(maxsize=256)
def _largest(graph: SceneGraph, t: tuple[float, ...], p: tuple[float, ...]) -> float:
    """The largest angle under a sine or cosine [rad]."""
    angles = compensated(graph, "double")[1]
    return float(np.max(np.abs(angles(np.array([t]), np.array(p)).full()), initial=0.0))


@dataclass(frozen=True, eq=False)
class _Value:
    """A value of a stage: as it is evaluated at an instant, and as a pair where it can be followed in pairs.

    ``fixed`` is what parameters alone set.
    """

    plain: Any = None
    pair: Pair | None = None
    fixed: bool = False


class _Counting:
    """Arithmetic that follows in pairs what is counted, and makes a symbol where it goes over into what is not."""

    def __init__(self, pairs: Pairs) -> None:
        self.pairs = pairs
        self.symbols: dict[tuple[Any, ...], tuple[Any, Any]] = {}

    @property
    def arithmetic(self) -> Arithmetic:
        codes = [code for name, code in vars(ca).items() if name.startswith("OP_") and code not in _NO_OPERATIONS]
        return Arithmetic(self.constant, {code: functools.partial(self.apply, code) for code in codes})

    def constant(self, value: float) -> _Value:
        return _Value(ca.SX(value), self.pairs.turn if value == math.tau else self.pairs.constant(value), fixed=True)

    def apply(self, code: int, *values: _Value) -> _Value:
        fixed = all(value.fixed for value in values)
        followed = all(value.pair is not None for value in values)
        pair = None
        if followed and code in (_FOLLOWED | (_FIXED if fixed else set())):
            pair = self.pairs.arithmetic.operations[code](*(value.pair for value in values))
            if not fixed:
                return _Value(pair=pair)
        if followed and not fixed and code in _TURNING:
            return _Value(ca.SX.unary(code, self._small(values[0])))
        if followed and not fixed and code == ca.OP_FMOD:
            return _Value(self.settled(_Value(pair=self.pairs.arithmetic.operations[code](*(value.pair for value in values)))))
        operands = [self.settled(value) for value in values]
        plain = ca.SX.unary(code, *operands) if len(operands) == 1 else ca.SX.binary(code, *operands)
        return _Value(plain, pair, fixed)

    def settled(self, value: _Value) -> Any:
        """A value as one number."""
        if value.plain is not None:
            return value.plain
        assert value.pair is not None
        return self._symbol(value.pair, "counted", value.pair)

    def _small(self, value: _Value) -> Any:
        assert value.pair is not None
        return self._symbol(self.pairs.reduced(value.pair), "angle", value.pair)

    def _symbol(self, pair: Pair, kind: str, key: Pair) -> Any:
        name = (kind, *(None if part is None else part.element_hash() for part in (key.high, key.low)))
        return self.symbols.setdefault(name, (ca.SX.sym(f"{kind}{len(self.symbols)}"), pair))[0]


_NO_OPERATIONS = {ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CALL}
_TURNING = {ca.OP_SIN, ca.OP_COS}
_FOLLOWED = {ca.OP_ADD, ca.OP_SUB, ca.OP_NEG, ca.OP_MUL, ca.OP_SQ, ca.OP_TWICE, ca.OP_DIV, ca.OP_FLOOR, ca.OP_CEIL}
_FIXED = {ca.OP_INV, ca.OP_SIN, ca.OP_COS, ca.OP_FABS, ca.OP_SQRT}


def _compensated(graph: SceneGraph, precision: Precision) -> tuple[Stages, Any]:
    pairs = Pairs(precision)
    _, d, rate, acceleration, z, p = graph.instant.sx_in()
    single = precision == "single"
    time, parameters = ca.SX.sym("t", 2 if single else 1), ca.SX.sym("p", p.numel(), 2 if single else 1)
    t_pair, *p_pairs = (Pair(row[0], row[1] if single else None) for row in (time.T, *ca.vertsplit(parameters)))
    counting = _Counting(pairs)
    t_value = _Value(pair=t_pair)
    p_values = [_Value(symbol, pair, fixed=True) for symbol, pair in zip(ca.vertsplit(p), p_pairs, strict=True)]
    smooth = graph.motion.is_a("SXFunction")
    if smooth:
        driven = interpret(graph.motion, [[t_pair], p_pairs], pairs.arithmetic)
    else:
        driven = [[Pair(x) for x in ca.vertsplit(symbols)] if symbols.numel() else [] for symbols in (d, rate, acceleration)]
    d_values = [_Value(pair=pair) for pair in driven[0]]
    z_values, rates, accelerations = ([_Value(x) for x in ca.vertsplit(s)] if s.numel() else [] for s in (z, rate, acceleration))
    found = [interpret(graph.newton.step, [z_values, [t_value], d_values, p_values], counting.arithmetic)] if graph.newton else []
    found.append(interpret(graph.instant, [[t_value], d_values, rates, accelerations, z_values, p_values], counting.arithmetic))
    results = [[_column([counting.settled(value) for value in output]) for output in outputs] for outputs in found]
    counted = _column([symbol for symbol, _ in counting.symbols.values()])
    handed = _column([pair.value for _, pair in counting.symbols.values()])
    names = ["counted", "d_rate", "d_acceleration", "z", "p"]
    instant = ca.Function("instant", [counted, rate, acceleration, z, p], results[-1], names, ["out"], {"cse": True})
    loops = ca.Function("loops", [z, counted, p], results[0], {"cse": True}) if graph.newton else None
    given = [_column([pair.value for pair in row]) for row in driven]
    inputs = [time, ca.vec(parameters)]
    turned = _column([pair.value for pair in pairs.reductions])
    if smooth:
        angles = ca.Function("angles", inputs, [turned], {"cse": True})
        drive = ca.Function("drive", inputs, [handed, *given[1:]], {"cse": True})
    else:
        angles = ca.Function("angles", [*inputs, d], [turned], {"cse": True})
        following = ca.Function("following", [*inputs, d], [handed], {"cse": True})
        t, values = ca.MX.sym("t", time.numel()), ca.MX.sym("p", parameters.numel())
        motion = graph.motion.call([t[0], values[: p.numel()]])
        drive = ca.Function("drive", [t, values], [following(t, values, motion[0]), *motion[1:]])
    return Stages(drive, loops, instant, precision, compensated=True), angles


def _column(parts: list[Any]) -> Any:
    return ca.densify(ca.vertcat(ca.SX(0, 1), *parts))
