"""The angles that loads see of joints that loops set: with their turns, counted from the start of
the scene.

A loop gives the cosine and sine of an angle, and so the angle but for whole turns. These follow
from what counts turns of itself: the angles of drives, and those that gears and constraints tie to
them. While the drives go round, the angle goes round as often as some sum of theirs, K . beta with
whole numbers K, and about that it swings. So the angle is K . beta + centre + swing, where cosine
and sine give the swing, which is less than half a turn either way; and no instant needs to know
another. K and the centre are found once, by following the motion of the scene and a whole turn of
its drive. Wherever a swing is evaluated it is held to :data:`REACH`.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.interpret import Arithmetic, followable, interpret, numpy_arithmetic
from ..base.scalars import column
from ..errors import DeclarationError
from .iteration import NewtonLoop
from .kinematics import Kinematics, Start
from .multibody import Multibody, Turned
from .winding import swing

REACH = math.pi - 0.35
"""Largest swing of an angle [rad] from its middle for which its revolution is certain."""

LEAP = 1.5 * math.pi
"""So far from one instant to the next [rad], it has rather gone the other way, and made a turn."""

_MOST_REVOLUTIONS = 3
"""Largest number of revolutions of other angles, all together, for one of an angle."""

_STEPS, _MOST_STEPS = 512, 32768
_COUNTED_STEP, _STEP = math.pi / 16, math.pi / 4
"""Largest steps [rad] of counted angles, and of others, that can be followed."""

_DIGITS = 2
_NEWTON_STEPS, _NEWTON_DONE = 50, 1e-9
_HALF_TURN = math.pi - 1e-9


def count_revolutions(
    multibody: Multibody,
    solved: Kinematics,
    motion: ca.Function,
    span: tuple[float, float],
    start: Start,
    used: Mapping[str, ca.SX],
) -> tuple[Kinematics, dict[str, ca.SX]]:
    """The kinematics with the angles that ``used`` expressions of loads and rows see, by their
    names; and swings, by angle.

    ``motion(t, p)`` is followed over ``span``; at its start, with the parameters of ``start``,
    angles lie in (-pi, pi]. Those that are seen only where whole turns make no difference, as under
    a sine, are left there. Raises :class:`DeclarationError` for angles whose turns do not follow
    from those of drives.
    """
    angles = [c for c in multibody.coordinates if c.kind == "angle"]
    wrapped = column(c.value for c in angles if c.name in solved.wrapped)
    counted = solved.evaluate(column(c.value for c in angles if c.name not in solved.wrapped))
    values: dict[str, ca.SX] = {}
    users: dict[str, list[str]] = {}
    for turned in multibody.turned:
        users[turned.name] = [
            name for name, expression in used.items() if ca.depends_on(expression, turned.symbol)
        ]
        if not ca.depends_on(turned.angle, wrapped):
            values[turned.name] = solved.evaluate(turned.angle)
        elif not any(depends_on_turns(used[name], turned.symbol) for name in users[turned.name]):
            values[turned.name] = solved.evaluate(turned.within)
    undetermined = [turned for turned in multibody.turned if turned.name not in values]
    deviations: dict[str, ca.SX] = {}
    for turned, rule in zip(
        undetermined,
        _rules(multibody, solved, motion, span, start, undetermined, counted),
        strict=True,
    ):
        if rule is None:
            raise DeclarationError(
                f"{', '.join(users[turned.name])}: the angle of '{turned.name}' enters with its"
                " number of revolutions, which cannot be determined from the drives; use its sine"
                " and cosine, or the angle of a drive"
            )
        about = (
            ca.dot(ca.DM(rule.revolutions), counted) + rule.centre
            if any(rule.revolutions)
            else ca.SX(rule.centre)
        )
        c, s = (solved.evaluate(part) for part in (turned.cosine, turned.sine))
        deviations[turned.name] = swing(c, s, about)
        values[turned.name] = deviations[turned.name] + about
    extended = solved.found.and_of(
        column(turned.symbol for turned in multibody.turned),
        column(values[turned.name] for turned in multibody.turned),
    )
    return replace(solved, found=extended), deviations


@dataclass(frozen=True)
class _Rule:
    """An angle makes so many ``revolutions`` for one of each angle that counts them, and about that
    it swings beside a ``centre``.
    """

    revolutions: tuple[int, ...]
    centre: float

    @classmethod
    def of(cls, courses: Sequence[tuple[Array, Array]]) -> _Rule | None:
        """The rule with the fewest turns that keeps an angle within reach over courses: of itself,
        and of what counts turns.
        """
        for counts in _sums(courses[0][1].shape[0]):
            deviation = np.concatenate(
                [angle - np.array(counts, float) @ counted for angle, counted in courses]
            )
            low, high = float(deviation.min()), float(deviation.max())
            if high - low <= 2.0 * (REACH - 10.0**-_DIGITS):
                # In few digits, lest the last ones of some library's sines be seen in the graph.
                return cls(counts, round((low + high) / 2.0, _DIGITS))
        return None


def _sums(many: int) -> Iterator[tuple[int, ...]]:
    """Sums of so many angles, as how often each is taken, the fewest first."""
    for total in range(_MOST_REVOLUTIONS + 1):
        for chosen in itertools.combinations_with_replacement(range(2 * many), total):
            counts = tuple(chosen.count(2 * k) - chosen.count(2 * k + 1) for k in range(many))
            if sum(map(abs, counts)) == total:
                yield counts


def _rules(
    multibody: Multibody,
    solved: Kinematics,
    motion: ca.Function,
    span: tuple[float, float],
    start: Start,
    undetermined: Sequence[Turned],
    counted: ca.SX,
) -> list[_Rule | None]:
    """The rules of some angles, by what they do along the motion of the scene, and as its one drive
    goes all the way round.
    """
    if not undetermined:
        return []
    time, p, many = multibody.mechanism.time, multibody.mechanism.symbols, len(undetermined)
    angles = solved.evaluate(column(turned.within for turned in undetermined))
    f = ca.Function(
        "angles", [time, solved.driven, solved.iterated, p], [ca.vertcat(angles, counted)]
    )
    drives = [c.kind for c in multibody.coordinates if c.driven]
    guide = _Guide(
        f, solved.newton, start, many, tuple(i for i, kind in enumerate(drives) if kind == "angle")
    )

    def moving(parts: Array) -> tuple[Array, Array]:
        t = span[0] + (span[1] - span[0]) * parts
        return t, np.atleast_2d(motion(t[None], start.parameters)[0].full())

    def turning(parts: Array) -> tuple[Array, Array]:
        return np.full(parts.size, start.t), start.driven[0] + math.tau * parts[None]

    courses = [guide.course(moving)[0]]
    if drives == ["angle"] and not guide.timed:
        course, whole = guide.course(turning)
        # A drive that cannot go round shows angles that the motion has nothing to do with.
        courses += [course] if whole else []
    shown = [[(course[k], course[many:]) for course in courses] for k in range(many)]
    return [_Rule.of(of) or _Rule.of(of[:1]) for of in shown]


@dataclass(frozen=True, eq=False)
class _Guide:
    """Follows ``angles(t, d, z, p)``, of which the first ``many`` are known but for turns, and the
    others count them.

    ``turning`` are the drives that turn, by number.
    """

    angles: Any
    newton: NewtonLoop | None
    start: Start
    many: int
    turning: tuple[int, ...]

    @property
    def timed(self) -> bool:
        """True if time itself, and not the drives alone, moves the loops."""
        functions = [(self.angles, 0), *([(self.newton.step, 1)] if self.newton else [])]
        return any(function.jac_sparsity(0, place).nnz() > 0 for function, place in functions)

    def course(self, path: Callable[[Array], tuple[Array, Array]]) -> tuple[Array, bool]:
        """The angles, made continuous, along a path, and whether all along; the path gives times
        and drives at parts from 0 to 1.

        Steps are so small that nothing turns by much in one. They end where loops cannot be closed,
        or where they are too many.
        """
        steps, end = _STEPS, 1.0
        while True:
            t, d = path(np.linspace(0.0, end, steps + 1))
            wide, whole = _widest(d[list(self.turning)]) / _COUNTED_STEP, True
            if wide <= 1.0:
                found = self._follow(t, d)
                whole = found.shape[1] == t.size
                wide = max(
                    _widest(found[: self.many]) / _STEP, _widest(found[self.many :]) / _COUNTED_STEP
                )
                if wide <= 1.0 and (whole or steps == _MOST_STEPS):
                    return found, whole and end == 1.0
            needed = steps * max(1.1 * wide, 1.0 if whole else 4.0)
            steps, end = min(math.ceil(needed), _MOST_STEPS), end * min(_MOST_STEPS / needed, 1.0)

    def _follow(self, t: Array, d: Array) -> Array:
        """The angles at times and drives (n), as far as loops can be closed; in (-pi, pi] at first,
        then continuous.
        """
        z = self._closed(t, d)
        closed = slice(0, z.shape[1])
        found: Array = self.angles(t[None, closed], d[:, closed], z, self.start.parameters).full()
        finite = np.isfinite(found).all(axis=0)
        found = found[:, : found.shape[1] if finite.all() else int(np.argmin(finite))]
        found[: self.many] = np.unwrap(found[: self.many], axis=1)
        found[: self.many] += np.where(found[: self.many, :1] <= -_HALF_TURN, math.tau, 0.0)
        return found

    def _closed(self, t: Array, d: Array) -> Array:
        """The iterated coordinates, up to the first instant at which they do not converge."""
        if self.newton is None:
            return np.zeros((0, t.size))
        z, found = np.array(self.newton.guess), []
        for moment, drives in zip(t, d.T, strict=True):
            size = math.inf
            for _ in range(_NEWTON_STEPS):
                correction, residual = self.newton.step(z, moment, drives, self.start.parameters)
                z, size = z + correction.full().ravel(), float(residual)
                if not size >= _NEWTON_DONE:
                    break
            if not size < _NEWTON_DONE:
                break
            found.append(z)
        return np.asarray(np.array(found).reshape(-1, z.size).T)


def _widest(rows: Array) -> float:
    """The largest step of any row."""
    return float(np.max(np.abs(np.diff(rows, axis=1)), initial=0.0))


def depends_on_turns(expression: Expression, angle: Expression) -> bool:
    """Return whether an expression may change if a whole turn is added to an angle."""
    expression = ca.densify(ca.vec(ca.SX(expression)))
    others = [
        symbol for symbol in ca.symvar(expression) if symbol.element_hash() != angle.element_hash()
    ]
    function = ca.Function("seen", [angle, column(others)], [expression])
    if not followable(function):
        return True
    operations = {
        code: functools.partial(_combined, code) for code in numpy_arithmetic().operations
    }
    symbols = [[_Part(1.0)], [_Part(0.0) for _ in others]]
    (found,) = interpret(
        function, symbols, Arithmetic(lambda number: _Part(0.0, number), operations)
    )
    return any(part.slope != 0.0 for part in found)


@dataclass(frozen=True)
class _Part:
    """A part of an expression: ``slope`` times an angle, and what whole turns of it do not change;
    NaN where it is no such sum.

    ``number`` is its value where it is a constant.
    """

    slope: float
    number: float | None = None


def _combined(code: int, *operands: float | _Part) -> _Part:
    """Rule by which an operation, one of CasADi's ``OP_`` codes, combines its parts."""
    parts: list[_Part] = [operand for operand in operands if isinstance(operand, _Part)]
    first, last = parts[0], parts[-1]
    if code in (ca.OP_ADD, ca.OP_SUB):
        return _Part(first.slope + (last.slope if code == ca.OP_ADD else -last.slope))
    if code in (ca.OP_NEG, ca.OP_TWICE, ca.OP_ASSIGN):
        return _Part(first.slope * {ca.OP_NEG: -1.0, ca.OP_TWICE: 2.0, ca.OP_ASSIGN: 1.0}[code])
    if code in (ca.OP_MUL, ca.OP_DIV) and last.number:
        return _Part(first.slope * (last.number if code == ca.OP_MUL else 1.0 / last.number))
    if code == ca.OP_MUL and first.number is not None:
        return _Part(first.number * last.slope)
    turning = code in (ca.OP_SIN, ca.OP_COS, ca.OP_TAN) and first.slope.is_integer()
    remaining = (
        code == ca.OP_REMAINDER
        and bool(last.number)
        and (first.slope * math.tau / (last.number or 1.0)).is_integer()
    )
    if turning or remaining or not any(part.slope for part in parts):
        return _Part(0.0)
    return _Part(math.nan)
