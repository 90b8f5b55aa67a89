"""Verdicts on an instant: which columns decide if it has a result, their limits, and the words of
a refusal.

:data:`VERDICTS` is the one table, by the kind of a column (:class:`.Check`), in the order in which
broken rules are reported. ``status(checks, limits, beside, iterated)`` is the number of the first
rule that is broken, from one on, or zero, by :func:`rules_of`. ``checks`` are the columns of
:func:`bounds_of`, ``limits`` what they must keep to, and ``beside`` what else a bound is seen with.
``iterated`` is the status of the iterated loops. The function is printed for packs of instants and
for exported C, and interpreted by NumPy. That all columns are finite is for the one who evaluates
them to see.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

import casadi as ca

from ..base.arrays import Expression
from ..base.quantities import Check, Column, Kinds, Output
from ..base.scalars import graph
from ..base.status import Status
from ..base.tables import MOMENT
from ..base.vocabulary import Precision
from ..model.beyond_ends import BEYOND, share_beyond, words_beyond
from ..model.limits import APART, MISSES
from .compensated import ROUNDING
from .friction import SLIP
from .iteration import NEWTON_LOST
from .loop_turns import LEAP, REACH

MISFIT: dict[Precision, float] = {"double": 1e-8, "single": 1e-5}
"""Largest residual of redundant equations, relative to the links' length, and of a row, relative to
its terms.
"""

DEAD: dict[Precision, float] = {name: 64.0 * rounding for name, rounding in ROUNDING.items()}
"""Closure of a loop, the square of a sine, that is zero within rounding."""

OPEN: dict[Precision, float] = {"double": 1e-9, "single": 1e-4}
_COUNTED = 1e-3
"""Limit for iterated loops that are closed by a fixed number of steps: zero is as small as their
residual.
"""

Beside: TypeAlias = Literal["", "CLOSURE", "BRANCH", "ROW", "TURNED"]
"""Neighbouring value that rules of a column take, as macros of the emitted C name it.

``CLOSURE``, of the square of a sine, and ``BRANCH``, of a sine: one if a dead centre lies between
this instant and the next (:mod:`.dead_centres`), else zero. ``ROW``: the largest size of the row's
terms, or of the contacts' forces. ``TURNED``: the change to the next instant.
"""


@dataclass(frozen=True)
class Tolerances:
    """Numbers on which limits depend: the precision, whether iterated loops are closed by a
    ``counted`` number of steps, the :attr:`.ModelData.rounding` of axes, and the ``extent`` [m].
    """

    precision: Precision
    counted: bool
    rounding: float
    extent: Expression

    def residual(self, limits: Mapping[Precision, float]) -> float:
        """Limit of a residual that depends on how far loops are closed."""
        return max(limits[self.precision], _COUNTED if self.counted else 0.0)

    @property
    def open(self) -> float:
        """Limit of how far a determined force may change with what equilibrium leaves open."""
        return max(self.residual(OPEN), APART * self.rounding)


@dataclass(frozen=True)
class Instance:
    """A rule that an instant breaks, for the words of the rule: the ``part`` of its column, what
    ``closed`` says that closes the loops, ``at`` when it is, the column's ``value`` and ``limit``.
    """

    part: str
    closed: str
    at: str
    value: float
    limit: float

    @property
    def after(self) -> str:
        """The instant before a step."""
        return f"after {self.at.removeprefix('at ')}"

    @property
    def size(self) -> float:
        """Absolute value of the column."""
        return abs(self.value)

    @property
    def degrees(self) -> float:
        """Value of an angle [deg]."""
        return math.degrees(self.value)

    @property
    def sine(self) -> float:
        """Limit of a sine whose square is the column."""
        return math.sqrt(self.limit)

    @property
    def frictions(self) -> str:
        """The frictions that the part names."""
        return f"{'frictions' if ', ' in self.part else 'friction'} '{self.part}'"

    @property
    def beyond(self) -> str:
        """Message on a curve whose argument is beyond its ends."""
        what, argument = self.part.rsplit(": ", 1)
        far = f" {self.at}, by {share_beyond(self.value):.3g} of that range"
        return words_beyond(f"the {what}", argument, far)

    @property
    def stroke(self) -> str:
        """Message on a cylinder or strut that is beyond its stroke."""
        state, way = "shorter than closed", "further apart"
        if self.value > 0.0:
            state, way = "longer than open", "nearer to each other"
        return (
            f"{self.part} is {state} {self.at}, by {(self.size - 1.0) / 2.0:.3g} of its stroke:"
            f" move its mounts {way}, or give it a longer stroke"
        )


@dataclass(frozen=True)
class Rule:
    """A rule of an instant: ``broken(column, limit, beside)`` as an expression, the status where it
    is broken, and a message whose ``it`` is an :class:`Instance`.

    What is no number breaks some rules, and not others.
    """

    status: Status
    broken: Callable[[Any, Any, Any], Any]
    words: str = ""


@dataclass(frozen=True)
class Verdict:
    """Limit of a kind of column, its rules, and the neighbouring value that these take."""

    limit: Callable[[Tolerances], Expression]
    rules: tuple[Rule, ...]
    beside: Beside = ""


def _above(x: ca.SX, limit: ca.SX, _: ca.SX) -> ca.SX:
    return limit < x


def _not_above(x: ca.SX, limit: ca.SX, _: ca.SX) -> ca.SX:
    return ca.logic_not(limit < x)


def _is(status: Status) -> Callable[[Any, Any, Any], Any]:
    return lambda iterated, *_: ca.SX(iterated) == int(status)


def _closure(dead: str, passes: str, *reach: Rule, beside: Beside = "CLOSURE") -> Verdict:
    """Verdict on what is zero at a ``dead`` centre, above its limit, and changes its sign if it
    ``passes`` one; a closure of loops has a rule of its own for values below zero.
    """
    return Verdict(
        lambda at: math.sqrt(DEAD[at.precision]) if beside == "BRANCH" else DEAD[at.precision],
        (
            *reach,
            Rule(Status.DEAD_CENTRE, _not_above, dead),
            Rule(Status.PASSES_DEAD_CENTRE, lambda x, limit, passed: passed > 0, passes),
        ),
        beside,
    )


def _loop(status: Status, below: str, sine: str, beside: Beside) -> Verdict:
    closed = "the loop closed by {it.closed}"
    return _closure(
        f"{closed} is at a dead centre {{it.at}}, within rounding, which is a sine of {sine} of its"
        " transmission angle: its forces are indeterminate",
        f"{closed} passes a dead centre {{it.after}}, where it can continue on either branch",
        Rule(status, lambda x, limit, _: x < -limit, f"{closed} {below}"),
        beside=beside,
    )


def _lost(words: str) -> Verdict:
    """Verdict on a force of a contact that must not be negative, beside the contacts' forces."""
    return Verdict(
        lambda at: at.residual(OPEN),
        (Rule(Status.LOST_CONTACT, lambda x, limit, size: x < -limit * size, words),),
        "ROW",
    )


_GIMBAL = (
    "its third axis becomes parallel to its first; choose axis and second so that turn_2 stays away"
    " from 90 deg"
)
_ROLL = "so its y axis is undefined; choose a direction that stays across it"
_HOLD = "the mechanism can move there while they are at rest; drive other joints"
_TURNED = "the angle of '{it.part}', on whose number of revolutions a load depends,"

VERDICTS: Mapping[str, Verdict] = {
    # How far what is put into the curves of a load, constraint or row is beyond their ends.
    "beyond": Verdict(
        lambda at: BEYOND[at.precision], (Rule(Status.BEYOND_ENDS, _above, "{it.beyond}"),)
    ),
    # The iterated loops as a whole. Where they are not closed, all else follows from that.
    "unclosed": Verdict(
        lambda at: 0.0,
        (
            Rule(
                Status.NOT_CONVERGED,
                _is(Status.NOT_CONVERGED),
                "the loops closed by {it.closed} did not converge {it.at}: their links do not"
                " reach, or the instant before is too far off",
            ),
        ),
    ),
    # Square of the cosine of the second of a joint's three turns, zero in gimbal lock.
    "gimbal": _closure(
        f"joint '{{it.part}}' is in gimbal lock {{it.at}}: {_GIMBAL}",
        f"joint '{{it.part}}' passes gimbal lock {{it.after}}: {_GIMBAL}",
    ),
    # Square of the sine of a bar's angle with the direction that was declared for its y axis.
    "roll": _closure(
        f"two-force link '{{it.part}}' lies along its beside= direction {{it.at}}, {_ROLL}",
        f"two-force link '{{it.part}}' passes through its beside= direction {{it.after}}, {_ROLL}",
    ),
    # Square of the sine of a loop's transmission angle (:mod:`.loops`), by the joint or constraint
    # that closes the loop.
    "closure": _loop(
        Status.OUT_OF_REACH,
        "cannot be closed {it.at}: its links do not reach",
        "{it.sine:.2g}",
        "CLOSURE",
    ),
    # A closure of an iterated loop: the sine itself.
    "branch": _loop(
        Status.JUMPED,
        "has jumped to another branch {it.at}: take more instants",
        "{it.limit:.2g}",
        "BRANCH",
    ),
    # The iterated loops again: what is at a dead centre is also slow.
    "slow": Verdict(
        lambda at: 0.0,
        (
            Rule(
                Status.SLOW,
                _is(Status.SLOW),
                "the loops closed by {it.closed} converge slowly {it.at}: they are near a dead"
                " centre, or the instant before is too far off",
            ),
        ),
    ),
    # Gap of a loop [m] (:mod:`.residuals`).
    "gap": Verdict(
        lambda at: (NEWTON_LOST if at.counted else MISFIT[at.precision]) * at.extent,
        (
            Rule(
                Status.NOT_CLOSED,
                lambda x, limit, _: limit < ca.fabs(x),
                "the solution of the loop closed by {it.closed} does not close it {it.at}: a gap of"
                " {it.size:.3g} m",
            ),
        ),
    ),
    # Residual of the equations of over-constrained loops, beside the links' length.
    "misfit": Verdict(
        lambda at: max(at.residual(MISFIT), MISSES * at.rounding),
        (
            Rule(
                Status.MISFIT,
                _above,
                "the loops closed by {it.closed} are over-constrained and do not fit {it.at}: a gap"
                " of {it.value:.3g} of the links' length",
            ),
        ),
    ),
    # Twice the share of a stroke that is out, less one.
    "stroke": Verdict(
        lambda at: 1.0 + BEYOND[at.precision],
        (Rule(Status.STROKE, lambda x, limit, _: limit < ca.fabs(x), "{it.stroke}"),),
    ),
    # Residual of a non-holonomic row.
    "row": Verdict(
        lambda at: at.residual(MISFIT),
        (
            Rule(
                Status.ROW_VIOLATED,
                lambda x, limit, size: ca.logic_not(ca.fabs(x) <= limit * size),
                "the motion violates the non-holonomic constraint '{it.part}' by {it.value:.6g}"
                " {it.at}",
            ),
        ),
        "ROW",
    ),
    # How far an angle that is seen with its turns is from the middle of its range, in radians
    # (:mod:`.revolutions`).
    "turned": Verdict(
        lambda at: REACH,
        (
            Rule(
                Status.TURNED,
                lambda x, limit, _: ca.logic_not(ca.fabs(x) <= limit),
                f"{_TURNED} is {{it.degrees:.3g}} deg from the middle of its range over the"
                " scene's motion {it.at}: its number of revolutions cannot be determined; take"
                " defaults and a motion that cover its range",
            ),
            Rule(
                Status.TURNED,
                lambda x, limit, change: ca.fabs(change) > LEAP,
                f"{_TURNED} changes by most of a turn from the instant {{it.at}} to the next: take"
                " more instants",
            ),
        ),
        "TURNED",
    ),
    # Whether drives can make the motion (:mod:`.drives`).
    "hold": _closure(
        f"the drives {{it.part}} cannot produce the motion {{it.at}}: {_HOLD}",
        f"the drives {{it.part}} cannot produce the motion {{it.after}}: {_HOLD}",
    ),
    # Normal force of a contact [N], beside those of all contacts.
    "pulls": _lost(
        "{it.part} pulls {it.at}: its normal force is {it.value:.4g} N, and the ground only pushes;"
        " shift the weight, move slower, or leave the contact out of this scene"
    ),
    # Distance of a contact's force from the cone of friction [N].
    "slides": _lost(
        "{it.part} slides {it.at}: its force is outside the cone of friction by {it.size:.4g} N;"
        " give it more friction or weight, or move slower"
    ),
    # How far frictions are from holding each other (:mod:`.friction`).
    "jam": Verdict(
        lambda at: DEAD[at.precision],
        (
            Rule(
                Status.JAMS,
                _not_above,
                "{it.frictions}: the mechanism jams {it.at}: friction has no unique solution there"
                " (jamming); reduce mu, lengthen the guide, or push closer to its axis",
            ),
        ),
    ),
    # Relative residual of frictions' laws.
    "slip": Verdict(
        lambda at: at.residual(SLIP),
        (
            Rule(
                Status.JAMS,
                _above,
                "the law of friction '{it.part}' has a relative residual of {it.value:.3g} {it.at}:"
                " it nearly jams",
            ),
        ),
    ),
    # One where a friction is at rest, else zero: what depends on it is no number there.
    "rest": Verdict(lambda at: 0.5, (Rule(Status.AT_REST, _above),)),
    # How far an output changes with what equilibrium leaves open (:mod:`.determinacy`). Whoever
    # asks for that gives a limit; else it is no reason against an instant.
    "open": Verdict(lambda at: at.open, (Rule(Status.OK, _above),)),
    "open moment": Verdict(lambda at: at.open * at.extent, (Rule(Status.OK, _above),)),
}
"""Verdict on each kind of column, in the order in which broken rules are reported.

A closure is called ``branch`` here if its loop is iterated, and ``open`` is called ``open moment``
of a moment.
"""

_ITERATED = ("unclosed", "slow")
"""Verdicts on the status of iterated loops, which is no column."""


@dataclass(frozen=True)
class Bound:
    """A column with a verdict, by its number and its kind in :data:`VERDICTS`; ``size`` is the
    column with the size of a row's terms.
    """

    column: int
    kind: str
    part: str | Output
    size: int = -1

    @property
    def verdict(self) -> Verdict:
        """The verdict on it."""
        return VERDICTS[self.kind]

    @property
    def beside(self) -> Beside:
        """Neighbouring value that its rules take."""
        return self.verdict.beside


Broken: TypeAlias = tuple[Rule, int | None]
"""A rule, and the number of its bound, or None of iteration."""


def bounds_of(
    columns: Sequence[Column], kinds: Kinds, iterated: Sequence[str]
) -> tuple[Bound, ...]:
    """Bounds of columns, in their order; ``iterated`` names the closures of iterated loops."""
    found, rows = list[Bound](), {column: k for k, column in enumerate(columns)}
    for k, check in enumerate(columns):
        if not isinstance(check, Check):
            continue
        kind, part = check.kind, check.part
        if isinstance(part, Output):
            # The unit of a user's output says nothing of what it is made of; a loss is seen by its
            # friction.
            force = replace(part, member="along") if part.member == "loss" else part
            moment = force.group != "output" and force.unit(kinds) == MOMENT
            kind = "open moment" if moment else kind
        elif kind == "closure" and part in iterated:
            kind = "branch"
        if kind in VERDICTS:
            found.append(Bound(k, kind, part, rows.get(Check("rowsize", part), -1)))
    return tuple(found)


def rules_of(bounds: Sequence[Bound], *, iterated: bool) -> tuple[Broken, ...]:
    """Rules of bounds, in the order in which they are reported; also those of loops that are
    ``iterated``.
    """
    numbers: dict[str, list[int | None]] = {kind: [None] for kind in _ITERATED if iterated}
    for k, bound in enumerate(bounds):
        numbers.setdefault(bound.kind, []).append(k)
    return tuple(
        (rule, k)
        for kind, verdict in VERDICTS.items()
        for k in numbers.get(kind, ())
        for rule in verdict.rules
    )


def status_of(rules: Sequence[Broken], many: int) -> ca.Function:
    """The function ``status(checks, limits, beside, iterated)`` of so ``many`` bounds: the number
    of the first rule that is broken.
    """
    checks, limits, beside = (ca.SX.sym(name, many) for name in ("checks", "limits", "beside"))
    iterated, first = ca.SX.sym("iterated"), ca.SX(0)
    for number, (rule, k) in reversed([*enumerate(rules, 1)]):
        seen = (iterated, 0, 0) if k is None else (checks[k], limits[k], beside[k])
        first = ca.if_else(rule.broken(*seen), number, first)
    given = {"checks": checks, "limits": limits, "beside": beside, "iterated": iterated}
    return graph("status", given, rule=first)
