"""Motions made of moves from rest to rest and of dwells, once or over and over."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, TypeAlias

import casadi as ca

from ..base.arguments import Symbolic, public
from ..base.numerals import readable
from ..base.symbolic import symbolic
from ..base.vectors import nil
from ..errors import DeclarationError
from .declared_parts import Expression
from .expressions import check_name, coordinates, parametric, plain, sound
from .motion_laws import Motion
from .rest_laws import RestLaw, rest_law, s_curve_within, trapezoid_within
from .stretches import Stretch
from .validity import Demand, Evaluator

_PER = {"speed": "/s", "acceleration": "/s^2", "jerk": "/s^3"}
Limits: TypeAlias = Mapping[str, Expression]
"""Limits of speed, acceleration and jerk that are given, by name, in rad or m and s."""

_FORGIVEN = 1e-9
"""Relative tolerance by which a time may be too short, or a cycle not close, by rounding."""


@dataclass(frozen=True, eq=False)
class Move:
    """A move from rest to rest, from :func:`move`; ``limits`` are those that are given, by name."""

    name: str
    to: Expression | str | None
    by: Expression | str | None
    time: Expression | None
    law: str | RestLaw | None
    limits: Limits


@dataclass(frozen=True, eq=False)
class Dwell:
    """A rest, from :func:`dwell`; without a time it fills up the period."""

    name: str
    time: Expression | None


@public
def move(
    to: Symbolic | None = None,
    *,
    by: Symbolic | None = None,
    time: Symbolic | None = None,
    law: str | RestLaw | None = None,
    speed: Symbolic | None = None,
    acceleration: Symbolic | None = None,
    jerk: Symbolic | None = None,
    name: str = "",
) -> Move:
    """Return a move from rest to rest, for :func:`moves`.

    All numbers may be expressions of parameters.

    Parameters
    ----------
    to, by
        Either the end position, or the distance [rad or m, or a text such as ``"90 deg"``].
    time
        Duration [s]. By default the shortest within the limits; with both, the move takes this
        time and is refused if that breaks a limit.
    law
        One of ``cycloidal``, ``modified_sine``, ``modified_trapezoid``, ``polynomial_345``,
        ``polynomial_4567``, ``simple_harmonic``, ``trapezoid`` and ``s_curve``, or
        :func:`trapezoid` or :func:`s_curve` with other shares. By default ``polynomial_345``;
        with limits of speed and acceleration the trapezoid that reaches them, with all three
        limits the S-curve of seven segments that does.
    speed, acceleration, jerk
        Limits of the size of these [rad/s or m/s and so on].
    name
        Name of the part in the timetable; by default its number.

    Returns
    -------
    Move
        The move, a part of a motion by :func:`moves`.

    Raises
    ------
    DeclarationError
        If not exactly one of ``to`` and ``by`` is given, and for numbers that make no move.
    """
    what = f"move '{name}'" if name else "move"
    if (to is None) == (by is None):
        raise DeclarationError(f"{what}: expected either to=, an end value, or by=, a distance")
    return Move(_named(name), to, by, time, law, _given(speed, acceleration, jerk))


@public
def dwell(time: Symbolic | None = None, *, name: str = "") -> Dwell:
    """Return a rest between moves, for :func:`moves`.

    Parameters
    ----------
    time
        Duration [s]. One dwell of a motion may have none: it then fills up the ``period``.
    name
        Name of the part in the timetable; by default its number.

    Returns
    -------
    Dwell
        The rest, a part of a motion by :func:`moves`.
    """
    return Dwell(_named(name), time)


@public
@symbolic
def moves(
    parts: Sequence[object],
    *,
    start: Expression | str = 0.0,
    begin: Expression = 0.0,
    cyclic: bool = False,
    period: Expression | None = None,
    advance: Expression | str = 0.0,
    speed: Expression | None = None,
    acceleration: Expression | None = None,
    jerk: Expression | None = None,
) -> Motion:
    """Return a motion of moves and dwells in sequence, at rest before and after them.

    Parameters
    ----------
    parts
        The moves and dwells, in order.
    start
        Position before the first part [rad or m, or a text such as ``"90 deg"``].
    begin
        Time at which the first part begins [s].
    cyclic
        True for a motion that is repeated. It must return to its start, or end ``advance`` beyond
        it, as an indexing table does.
    period
        Time of all parts together [s]; a dwell without a time fills it up. By default the sum of
        their times.
    advance
        Distance by which each cycle of a ``cyclic`` motion ends beyond its start [rad or m].
    speed, acceleration, jerk
        Limits of every move that has none of its own.

    Returns
    -------
    Motion
        The law of motion. Called with an expression, it is the same law of that:
        ``lift(m.coordinate(cam))`` rises by the angle of a cam, and its times are angles.

    Raises
    ------
    DeclarationError
        For moves that are too fast for their limits, a time that is not positive, a cycle that
        does not close, and a period that is not the sum of the times. If parameters decide, such
        designs are refused when they are evaluated.
    """
    each = _sequence(parts)
    common = _given(speed, acceleration, jerk)
    demands = _Demanded([], set())
    origin = demands.coordinate("moves: start", start)
    place, terms, found = origin, [origin], []
    for number, part in enumerate(each):
        what = _what(part, number)
        if isinstance(part, Dwell):
            law, time, by, after = None, part.time, 0.0, place
        else:
            by, after = _way(what, part, place, terms, demands)
            law, time = _timed(what, part, by, common, demands)
        found.append((part.name or f"part {number + 1}", law, time, place, by))
        place = after
    times = _filled(each, [row[2] for row in found], period, demands)
    for number, (part, time) in enumerate(zip(each, times, strict=True)):
        words = f"{_what(part, number)}: its time must be positive, got {{got}} s"
        demands.add(Demand.saying(time, True, words))
    first = plain(parametric("moves: begin", begin, "s"))
    seams = [first, *(_sum(first, *times[: k + 1]) for k in range(len(times)))]
    stretches = tuple(
        Stretch(name, law, seams[k], seams[k + 1], times[k], at, by)
        for k, (name, law, _, at, by) in enumerate(found)
    )
    far = demands.coordinate("moves: advance", advance)
    length = None
    if cyclic:
        length = _sum(0.0, *times)
        _demand_closure(origin, place, far, demands)
    elif not nil(far):
        raise DeclarationError("moves: advance= needs cyclic=True")
    each_demand = tuple(demands.each)
    if len(demands.units) > 1:
        raise DeclarationError(
            "moves: mixes angles and lengths; expected the unit of one coordinate"
        )
    graph = _graph(stretches, place, length, far, each_demand)
    unit = next(iter(demands.units), "")
    return Motion(
        graph, stretches=stretches, period=length, parameter_constraints=each_demand, unit=unit
    )


def _graph(
    stretches: tuple[Stretch, ...],
    last: Expression,
    period: float | None,
    advance: float,
    demands: tuple[Demand, ...],
) -> Expression:
    """The law as a function of its argument: which stretch it is in is decided once, and each law
    is written once.
    """
    # What cannot be has no value, wherever the law is used.
    held: Any = 1.0
    for demand in demands:
        value = ca.SX(demand.value)
        held = held * sound(value > 0.0 if demand.positive else value >= 0.0)

    def graph(t: ca.SX) -> Expression:
        x, gone, each = t, 0.0, [*stretches]
        first, final = stretches[0], stretches[-1]
        if period is None:
            rest = replace(final, law=None, start=final.stop, at=last)
            each = [replace(first, law=None), *stretches, rest]
        else:
            # A remainder is exact; it is of the middle of the cycle.
            middle = first.start + period / 2.0
            x = ca.remainder(t - middle, period)
            if _bends(first) or _bends(final):
                # At the seam, as near to one middle as to the next, C takes the one and the other
                # by turns. The acceleration jumps there: the next cycle begins, however it is
                # evaluated.
                x = x - period * (x >= period / 2.0)
            x = x + middle
            gone = advance * ca.floor((t - x) / period + 0.5)
        later = [x >= stretch.start for stretch in each[1:]]
        # By rounding an instant may be before the first seam. Then a difference of two comparisons,
        # the later of which holds only where the earlier does.
        begun = x < each[1].start if later else ca.SX(1)
        inside = [begun, *(here - gone_by for here, gone_by in pairwise([*later, ca.SX(0)]))]
        going = [(here, s) for here, s in zip(inside, each, strict=True) if s.law is not None]
        share = (x - _chosen((here, s.start) for here, s in going)) * _chosen(
            (here, 1.0 / s.time) for here, s in going
        )
        value = _chosen((here, s.at) for here, s in zip(inside, each, strict=True)) + gone
        for law in dict.fromkeys(s.law for _, s in going if s.law is not None):
            value = value + _chosen((here, s.by) for here, s in going if s.law is law) * law.shape(
                share
            )
        return value * held

    return graph


def _bends(stretch: Stretch) -> bool:
    """Return whether a stretch may begin and end with an acceleration."""
    return stretch.law is not None and not nil(stretch.law.begins[0])


def _chosen(rows: Expression) -> Expression:
    """Select the value whose condition holds, of which at most one does; zero if none does."""
    total: Any = 0.0
    for here, value in rows:
        if not nil(value):
            total = total + ca.if_else(here, value, 0.0)
    return total


def _sum(*terms: Expression) -> Expression:
    """A sum: of numbers as their decimals say, rounded once; else of expressions."""
    if any(isinstance(term, ca.SX) for term in terms):
        return plain(sum(terms[1:], terms[0]))
    return float(sum((Fraction(repr(term)) for term in terms), Fraction(0)))


@dataclass(frozen=True)
class _Demanded:
    """Demands that are found: one of numbers is held at once, those that parameters decide are
    kept; and units of texts.
    """

    each: list[Demand]
    units: set[str]

    def coordinate(self, what: str, value: Expression, per: str = "") -> Expression:
        (found,), unit = coordinates(what, [(value, per)])
        self.units.update([unit] if unit else [])
        return plain(found)

    def add(self, demand: Demand) -> None:
        value = plain(demand.value)
        if isinstance(value, ca.SX):
            self.each.append(demand)
        elif not (math.isfinite(value) and (value > 0.0 or (value == 0.0 and not demand.positive))):
            raise DeclarationError(demand.refusal(float))


def _sequence(parts: Sequence[object]) -> list[Move | Dwell]:
    given = list(parts) if isinstance(parts, Sequence) else []
    each = [part for part in given if isinstance(part, Move | Dwell)]
    if not each or len(each) < len(given):
        raise DeclarationError(f"moves: expected a list of move(...) and dwell(...), got {parts!r}")
    names = [part.name for part in each if part.name]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise DeclarationError(
            f"moves: two parts are called '{twice}'; expected different names, or none"
        )
    if not any(isinstance(part, Move) for part in each):
        raise DeclarationError(
            "moves: there are only dwells; expected a move, or polynomial(VALUE) for a joint at"
            " rest"
        )
    return each


def _what(part: Move | Dwell, number: int) -> str:
    kind = "move" if isinstance(part, Move) else "dwell"
    return f"{kind} '{part.name}'" if part.name else f"{kind} {number + 1} of the moves"


def _named(name: str) -> str:
    if name:
        check_name("move", name)
    return name


def _given(*limits: Expression | None) -> Limits:
    """Limits of speed, acceleration and jerk that are given, by name."""
    return {name: x for name, x in zip(_PER, limits, strict=True) if x is not None}


def _way(
    what: str, part: Move, place: Expression, terms: list[Expression], demands: _Demanded
) -> tuple[Expression, Expression]:
    """Distance of a move, and its end, which is the sum of ``terms``."""
    if part.by is not None:
        by = demands.coordinate(f"{what}: by", part.by)
        terms.append(by)
        return by, _sum(*terms)
    to = demands.coordinate(f"{what}: to", part.to)
    terms[:] = [to]
    return _sum(to, -place), to


def _timed(
    what: str, part: Move, by: Expression, common: Limits, demands: _Demanded
) -> tuple[RestLaw, Expression]:
    """The law of a move and its time, with what its limits demand."""
    limits = _limits(what, part.limits or common, demands)
    if not limits and part.time is None:
        raise DeclarationError(f"{what}: expected a time, or limits of speed, acceleration or jerk")
    size = ca.fabs(ca.SX(by))
    if limits and part.time is None:
        words = f"{what}: its distance is zero, so limits give no duration; expected a dwell"
        demands.add(Demand.saying(size, True, words))
    named = part.law if part.law is not None else "polynomial_345"
    standard_law = part.law is None or part.law in ("trapezoid", "s_curve")
    if standard_law and limits.keys() == {"speed", "acceleration"} and part.law != "s_curve":
        law = trapezoid_within(by, **limits)
    elif standard_law and limits.keys() == {*_PER} and part.law != "trapezoid":
        law = s_curve_within(by, **limits)
    else:
        law = rest_law(what, named)
    if "jerk" in limits and isinstance(law.jerk, float) and math.isinf(law.jerk):
        raise DeclarationError(
            f"{what}: accelerations of the law {law.name} jump, so its jerk is infinite; expected"
            " another law, or no limit of jerk"
        )
    if not limits:
        return law, plain(parametric(f"{what}: time", part.time, "s"))
    least = plain(law.least_time(by, limits))
    if part.time is None:
        return law, least
    time = plain(parametric(f"{what}: time", part.time, "s"))

    def refusal(number: Evaluator) -> str:
        broken = ", ".join(f"{name} {readable(number(limit))}" for name, limit in limits.items())
        asked = f"{readable(abs(number(by)))} in {readable(number(time))} s"
        needed = f"{number(least):.6g} s or more"
        return (
            f"{what}: {asked} by the law {law.name} breaks its limits ({broken}): it takes {needed}"
        )

    demands.add(Demand(time - (1.0 - _FORGIVEN) * least, False, refusal))
    return law, time


def _limits(what: str, limits: Limits, demands: _Demanded) -> Limits:
    found: dict[str, Expression] = {}
    for name, value in limits.items():
        found[name] = demands.coordinate(f"{what}: {name}", value, _PER[name])
        words = f"{what}: {name} must be positive, got {{got}}"
        demands.add(Demand.saying(found[name], True, words))
    return found


def _filled(
    parts: list[Move | Dwell], times: list[float | None], period: float | None, demands: _Demanded
) -> list[Expression]:
    """The times of all parts, the dwell that has none filled up."""
    known = [
        None if time is None else plain(parametric(f"{_what(parts[k], k)}: time", time, "s"))
        for k, time in enumerate(times)
    ]
    lacking = [k for k, time in enumerate(known) if time is None]
    given = [time for time in known if time is not None]
    if period is None:
        if lacking:
            raise DeclarationError(
                f"{_what(parts[lacking[0]], lacking[0])}: expected its time, or a period of all"
                " moves"
            )
        return given
    whole, total = plain(parametric("moves: period", period, "s")), _sum(0.0, *given)
    if len(lacking) > 1:
        raise DeclarationError(
            f"moves: {len(lacking)} dwells have no time; expected a time for all but one"
        )
    remaining = _sum(whole, *(-time for time in given))
    if lacking:
        words = (
            "moves: no time is left for the part without one: the others take {total} s of the"
            " period of {whole} s"
        )
        demands.add(Demand.saying(remaining, True, words, total=total, whole=whole))
    else:
        gap = ca.fabs(ca.SX(whole) - total)
        demands.add(
            Demand.saying(
                _FORGIVEN * ca.fabs(ca.SX(whole)) - gap,
                False,
                "moves: the times add up to {total} s, but the period is {whole} s",
                total=total,
                whole=whole,
            )
        )
    return [remaining if time is None else time for time in known]


def _demand_closure(
    start: Expression, end: Expression, advance: Expression, demands: _Demanded
) -> None:
    gap = ca.fabs(ca.SX(end) - start - advance)
    size = ca.fabs(ca.SX(start)) + ca.fabs(ca.SX(end)) + ca.fabs(ca.SX(advance))
    aside = "" if nil(advance) else ", {advance} beyond it"
    words = (
        f"moves: a cyclic motion must end where it starts, at {{start}}{aside}, but it ends at"
        " {end}; expected a move back, or advance={climb}"
    )
    numbers = {"start": start, "advance": advance, "end": end, "climb": end - start}
    demands.add(Demand.saying(_FORGIVEN * size - gap, False, words, **numbers))
