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
        law, peaks = stretch.law, [0.0, 0.0, 0.0]
        if law is not None and by:
            each = enumerate((law.speed, law.acceleration, law.jerk), 1)
            peaks = [number(peak) * abs(by) / time**order for order, peak in each]
        found.append(
            TimedStretch(
                stretch.name, "dwell" if law is None else law.name, start, stop, at, by, *peaks
            )
        )
    return found


def _jumps(stretches: Sequence[Stretch], number: Evaluator, *, cyclic: bool) -> list[Jump]:
    """Times at which accelerations jump, and at which only jerks do, in the order of time."""
    names = [stretch.name for stretch in stretches]
    pairs = itertools.pairwise(names)
    seams = [f"where '{names[0]}' begins", *(f"from '{one}' to '{next_}'" for one, next_ in pairs)]
    each = [_changes(stretch, number) for stretch in stretches]
    ended = each[-1][-1] if cyclic else (0.0, 0.0, 0.0)
    every = []
    for name, seam, (begun, *inner, end) in zip(names, seams, each, strict=True):
        every.append((begun[0], seam, ended[1] + begun[1], ended[2] + begun[2]))
        every += [(t, f"within '{name}'", bend, sharp) for t, bend, sharp in inner]
        ended = end
    if not cyclic:
        every.append((ended[0], f"where '{names[-1]}' ends", *ended[1:]))
    bends = max(abs(bend) for *_, bend, _ in every)
    sharps = max(abs(sharp) for *_, sharp in every)
    found = []
    for t, where, bend, sharp in sorted(every):
        if abs(bend) > _SAME * bends:
            found.append(Jump(t, "acceleration", bend, where))
        elif abs(sharp) > _SAME * sharps:
            found.append(Jump(t, "jerk", sharp, where))
    return found


def _changes(stretch: Stretch, number: Evaluator) -> list[tuple[float, float, float]]:
    """By how much acceleration and jerk jump where a stretch begins, within it and where it ends,
    after the time; within it jumps at one place are one, as between parts without constant
    acceleration.
    """
    start, stop, by = map(number, (stretch.start, stretch.stop, stretch.by))
    law = stretch.law
    if law is None or not by:
        return [(start, 0.0, 0.0), (stop, 0.0, 0.0)]
    time, inner = number(stretch.time), [(-1.0, 0.0, 0.0)]
    for place, change in law.inner:
        share, bend, sharp = number(place), *map(number, change)
        if share - inner[-1][0] <= _SAME:
            _, bend_before, sharp_before = inner.pop()
            bend, sharp = bend + bend_before, sharp + sharp_before
        inner.append((share, bend, sharp))
    bend, sharp = map(number, law.begins)
    places = [(start, bend, sharp), *((start + u * time, *jump) for u, *jump in inner[1:])]
    places.append((stop, bend, -sharp))
    return [(t, bend * by / time**2, sharp * by / time**3) for t, bend, sharp in places]
