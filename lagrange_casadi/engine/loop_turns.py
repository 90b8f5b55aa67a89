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
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.interpret import Step, expressed, followable, replay
from ..base.scalars import column
from ..model.polynomials import powers
from .iteration import NewtonLoop, Start
from .multibody import Multibody

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
_NEWTON_STEPS, _NEWTON_DONE = 20, 1e-9
_HALF_TURN = math.pi - 1e-9


@dataclass(frozen=True)
class Rule:
    """An angle makes so many ``revolutions`` for one of each angle that counts them, and about that
    it swings beside a ``centre``.
    """

    revolutions: tuple[int, ...]
    centre: float

    def angle(self, cosine: Expression, sine: Expression, counted: ca.SX) -> tuple[ca.SX, ca.SX]:
        """The angle of a cosine and a sine, over angles that count turns; and its swing."""
        about = ca.SX(self.centre)
        if any(self.revolutions):
            about += ca.dot(ca.DM(self.revolutions), counted)
        c, s = ca.cos(about), ca.sin(about)
        swing = ca.atan2(sine * c - cosine * s, cosine * c + sine * s)
        return about + swing, swing

    @classmethod
    def of(cls, courses: Sequence[tuple[Array, Array]]) -> Rule | None:
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


@dataclass(frozen=True, eq=False)
class Guide:
    """Guide of angles from the ``start`` of the motion, over ``inputs``: time, the driven
    coordinates, the iterated unknowns and the parameters.

    ``newton`` closes iterated loops; ``turning`` are the drives that turn, by number.
    """

    inputs: tuple[Any, ...]
    newton: NewtonLoop | None
    start: Start
    turning: tuple[int, ...]

    @classmethod
    def of(
        cls,
        multibody: Multibody,
        driven: ca.SX,
        iterated: Expression,
        newton: NewtonLoop | None,
        start: Start,
    ) -> Guide:
        """The guide of a mechanism, over the symbols of its driven coordinates and unknowns."""
        drives = [c.kind for c in multibody.coordinates if c.driven]
        return cls(
            (multibody.mechanism.time, driven, iterated, multibody.mechanism.symbols),
            newton,
            start,
            tuple(i for i, kind in enumerate(drives) if kind == "angle"),
        )

    def rules(self, angles: ca.SX, counted: ca.SX) -> list[Rule | None]:
        """The rules of angles that are known up to whole turns, over angles that count them: by
        what they do along the motion, and as each drive alone goes all the way round.
        """
        many = angles.numel()
        if not many:
            return []
        f = ca.Function("angles", self.inputs, [ca.vertcat(angles, counted)])
        courses = [self._course(f, many, self._moving)[0]]
        for drive in self.turning:
            course, whole = self._course(f, many, functools.partial(self._turned, drive))
            # A drive that cannot go round shows angles that the motion has nothing to do with.
            courses += [course] if whole else []
        shown = [[(course[k], course[many:]) for course in courses] for k in range(many)]
        return [Rule.of(of) or Rule.of(of[:1]) for of in shown]

    def _moving(self, parts: Array) -> tuple[Array, Array]:
        """Times and driven coordinates at parts of the motion."""
        first, last = self.start.span
        t = first + (last - first) * parts
        return t, np.atleast_2d(self.start.motion(t[None], self.start.parameters)[0].full())

    def _turned(self, drive: int, parts: Array) -> tuple[Array, Array]:
        """Times and driven coordinates at parts of a turn of one drive."""
        d = np.repeat(np.array(self.start.driven)[:, None], parts.size, axis=1)
        d[drive] += math.tau * parts
        return np.full(parts.size, self.start.t), d

    def _course(
        self, f: ca.Function, many: int, path: Callable[[Array], tuple[Array, Array]]
    ) -> tuple[Array, bool]:
        """The values of ``f``, of which the first ``many`` are made continuous, along a path, and
        whether all along; the path gives times and driven coordinates at parts from 0 to 1.

        Steps are so small that nothing turns by much in one. They end where loops cannot be closed,
        or where they are too many.
        """
        steps, end = _STEPS, 1.0
        while True:
            found = self._followed(f, *path(np.linspace(0.0, end, steps + 1)))
            found[:many] = np.unwrap(found[:many], axis=1)
            found[:many] += np.where(found[:many, :1] <= -_HALF_TURN, math.tau, 0.0)
            whole = found.shape[1] > steps
            wide = max(_widest(found[:many]) / _STEP, _widest(found[many:]) / _COUNTED_STEP)
            if wide <= 1.0 and (whole or steps == _MOST_STEPS):
                return found, whole and end == 1.0
            needed = steps * max(1.1 * wide, 1.0 if whole else 4.0)
            steps, end = min(math.ceil(needed), _MOST_STEPS), end * min(_MOST_STEPS / needed, 1.0)

    def _followed(self, f: ca.Function, t: Array, d: Array) -> Array:
        """The values of ``f`` at times and driven coordinates, as far as loops can be closed."""
        p, z, closed = self.start.parameters, ca.DM(0, t.size), np.isfinite(t)
        if self.newton is not None:
            given = self.newton.step.mx_in()
            following, size = given[0], ca.MX()
            for _ in range(_NEWTON_STEPS):
                correction, size = self.newton.step(following, *given[1:])
                following += correction
            settle = ca.Function("settle", given, [following, size]).mapaccum(t.size)
            z, size = settle(self.newton.guess, t[None], d, p)
            closed &= size.full()[0] < _NEWTON_DONE
        found: Array = f(t[None], d, z, p).full()
        closed &= np.isfinite(found).all(axis=0)
        return found if closed.all() else found[:, : int(np.argmin(closed))]


def _widest(rows: Array) -> float:
    """The largest step of any row."""
    return float(np.max(np.abs(np.diff(rows, axis=1)), initial=0.0))


def depends_on_turns(expression: Expression, angle: Expression) -> bool:
    """Return whether an expression may change if a whole turn is added to an angle.

    A sine, cosine, tangent or remainder that repeats by a whole turn counts as a number of its own.
    """
    expression = ca.densify(ca.vec(ca.SX(expression)))
    symbols = ca.symvar(expression)
    function = ca.Function("seen", symbols, [expression])
    if not followable(function):
        return True

    def made(_k: int, step: Step, operands: list[ca.SX]) -> ca.SX:
        repeats = _repeats(step.operation, operands, angle)
        return ca.SX.sym("repeated") if repeats else expressed(step, operands)

    (found,) = replay(function, [[symbol] for symbol in symbols], made)
    return bool(ca.depends_on(column(found), angle))


def _repeats(operation: int, operands: list[ca.SX], angle: ca.SX) -> bool:
    """Return whether an operation, one of CasADi's ``OP_`` codes, is periodic in an angle by a
    whole turn: that of a whole multiple of the angle, and of what does not depend on the angle.
    """
    period: Expression = ca.SX(math.tau)
    if operation == ca.OP_REMAINDER:
        period = operands[1]
    elif operation not in (ca.OP_SIN, ca.OP_COS, ca.OP_TAN):
        return False
    terms = powers(operands[0], angle, (ca.SX(0), ca.SX(1)))
    if terms is None or len(terms) != 2:
        return False
    turns = math.tau * terms[1] / period
    return bool(turns.is_constant()) and float(turns).is_integer()
