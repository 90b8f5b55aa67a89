"""The stretches of a motion made of moves, in numbers: when they are, how fast they go, and where
accelerations and jerks jump.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from ..base.brief import Brief
from .declared_parts import Expression
from .rest_laws import RestLaw
from .validity import Evaluator

_SAME = 1e-9
"""Relative size of a jump, of the largest of its kind, that is rounding."""


@dataclass(frozen=True, eq=False, repr=False)
class Stretch(Brief):
    """A move or a dwell of a motion: when it is, from where and how far it goes, and by which law;
    a dwell has none.
    """

    name: str
    law: RestLaw | None
    start: Expression
    stop: Expression
    time: Expression
    at: Expression
    by: Expression


@dataclass(frozen=True)
class TimedStretch:
    """A stretch in numbers: from ``start`` to ``stop`` [s], from the place ``at`` by ``by`` [rad or
    m].

    ``speed``, ``acceleration`` and ``jerk`` are the largest sizes within it; a jerk is infinite
    where the acceleration jumps.
    """

    name: str
    law: str
    start: float
    stop: float
    at: float
    by: float
    speed: float
    acceleration: float
    jerk: float


@dataclass(frozen=True)
class Jump:
    """A time [s] at which the acceleration jumps, or where that does not the jerk, and by how much;
    ``where`` says it in words.
    """

    t: float
    what: str
    by: float
    where: str


@dataclass(frozen=True)
class Timetable:
    """The stretches of a motion in numbers, and where it jumps; ``period`` [s] is the time of one
    cycle, of those that go on.
    """

    stretches: tuple[TimedStretch, ...]
    jumps: tuple[Jump, ...]
    period: float | None


def timetable(
    stretches: Sequence[Stretch], period: Expression | None, number: Evaluator
) -> Timetable:
    """Stretches in numbers, as ``number`` gives the value of an expression."""
    cyclic = period is not None
    return Timetable(
        tuple(_timed(stretches, number)),
        tuple(_jumps(stretches, number, cyclic=cyclic)),
        number(period) if cyclic else None,
    )


def _timed(stretches: Sequence[Stretch], number: Evaluator) -> list[TimedStretch]:
    found = []
    for stretch in stretches:
        start, stop, time, at, by = map(
            number, (stretch.start, stretch.stop, stretch.time, stretch.at, stretch.by)
        )
        law, size = stretch.law, abs(by)
        each = (
            (0.0, 0.0, 0.0)
            if law is None or not size
            else tuple(map(number, (law.speed, law.acceleration, law.jerk)))
        )
        peaks = (peak * size / time**order if size else 0.0 for order, peak in enumerate(each, 1))
        found.append(
            TimedStretch(
                stretch.name, "dwell" if law is None else law.name, start, stop, at, by, *peaks
            )
        )
    return found


def _jumps(stretches: Sequence[Stretch], number: Evaluator, *, cyclic: bool) -> list[Jump]:
    """Times at which accelerations jump, and at which only jerks do, in the order of time."""
    rest = (0.0, 0.0)
    begins, ends, inner = [], [], []
    for stretch in stretches:
        law, time, by = stretch.law, number(stretch.time), number(stretch.by)
        bend, sharp = rest if law is None or not by else map(number, law.begins)
        bend, sharp = (x * by / time**k for x, k in ((bend, 2), (sharp, 3)))
        begins.append((bend, sharp))
        ends.append((-bend, sharp))
        for share, bent, sharpened in () if law is None or not by else _places(law, number):
            jump = bent * by / time**2, sharpened * by / time**3
            inner.append((number(stretch.start) + share * time, f"within '{stretch.name}'", jump))
    seams = []
    for k, (before, after) in enumerate(itertools.pairwise(stretches)):
        where = f"from '{before.name}' to '{after.name}'"
        seams.append((number(after.start), where, _change(ends[k], begins[k + 1])))
    opening = _change(ends[-1] if cyclic else rest, begins[0])
    seams.append((number(stretches[0].start), f"where '{stretches[0].name}' begins", opening))
    if not cyclic:
        last = stretches[-1]
        seams.append((number(last.stop), f"where '{last.name}' ends", _change(ends[-1], rest)))
    every = sorted([*seams, *inner])
    sizes = [max((abs(jump[k]) for *_, jump in every), default=0.0) for k in (0, 1)]
    found = []
    for t, where, (bend, sharp) in every:
        if abs(bend) > _SAME * sizes[0]:
            found.append(Jump(t, "acceleration", bend, where))
        elif abs(sharp) > _SAME * sizes[1]:
            found.append(Jump(t, "jerk", sharp, where))
    return found


def _places(law: RestLaw, number: Evaluator) -> list[tuple[float, float, float]]:
    """Places and sizes of jumps within a law; jumps at one place are one, as between parts without
    constant acceleration.
    """
    found: list[tuple[float, float, float]] = []
    for place, change in law.inner:
        share, bent, sharpened = number(place), *map(number, change)
        if found and share - found[-1][0] <= _SAME:
            _, bent_before, sharpened_before = found.pop()
            bent, sharpened = bent + bent_before, sharpened + sharpened_before
        found.append((share, bent, sharpened))
    return found


def _change(before: tuple[float, float], after: tuple[float, float]) -> tuple[float, float]:
    return after[0] - before[0], after[1] - before[1]
