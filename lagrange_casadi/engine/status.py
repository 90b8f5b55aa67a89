"""Rules of an instant: when it has a result, as one function of its checks; and in which order
broken ones are reported.

``status(checks, limits, beside, iterated)`` is the number of the first rule that is broken, from
one on, or zero. ``checks`` are the columns that are bound, ``limits`` what they must keep to, and
``beside`` what else a bound is seen with: see :class:`Bound`. ``iterated`` is the status of the
iterated loops. It is printed for packs of instants and for exported C, and interpreted by NumPy.
That all columns are finite is for the one who evaluates them to see.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import casadi as ca

from ..base.quantities import Output
from ..base.scalars import graph
from ..base.status import Status
from ..base.tables import MOMENT
from .checks import Check
from .checks import Kind as CheckKind
from .revolutions import LEAP

if TYPE_CHECKING:
    from .program import Program

Kind: TypeAlias = Literal[
    "BEYOND",
    "CLOSURE",
    "BRANCH",
    "GAP",
    "MISFIT",
    "ROW",
    "TURNED",
    "OPEN",
    "OPEN_MOMENT",
    "JAM",
    "SLIP",
    "REST",
]

_KINDS: Mapping[CheckKind, Kind] = {
    "beyond": "BEYOND",
    "closure": "CLOSURE",
    "gimbal": "CLOSURE",
    "roll": "CLOSURE",
    "hold": "CLOSURE",
    "gap": "GAP",
    "misfit": "MISFIT",
    "row": "ROW",
    "jam": "JAM",
    "slip": "SLIP",
    "rest": "REST",
    "turned": "TURNED",
}


@dataclass(frozen=True)
class Bound:
    """Limit of a column.

    A ``CLOSURE``, of a loop, of three turns, of a bar's roll or of what drives hold, must be above
    its limit, and above its opposite unless links do not reach; so must a ``BRANCH``, whose loop is
    iterated. Of both ``beside`` is one if a dead centre lies between this instant and the next
    (:mod:`.dead_centres`), else zero. ``GAP`` and ``TURNED`` must be within the limit by
    size; beside the latter stands its change to the next instant. A ``MISFIT``, a ``SLIP``, which
    is what is left of frictions' laws, and what is ``BEYOND`` the ends of a curve must not be above
    it, nor a ``ROW`` by size, times what is beside it: the ``size`` of its terms, a column. What
    says of a ``JAM`` must be above its limit. A friction at ``REST`` is above it: what depends on
    it is no number there, and the rest is. What is ``OPEN``, or an ``OPEN_MOMENT``, is above it
    where equilibrium does not determine the output ``part``.
    """

    kind: Kind
    column: int
    part: str | Output
    size: int = -1


@dataclass(frozen=True)
class Rule:
    """A test of a bound, by number, or where that is None of iteration; what the ``status`` is
    where it fails.

    Whoever asks for what is open gives it a limit; else an output that is left open is no reason
    against an instant.
    """

    status: Status
    bound: int | None = None


def bounds_of(program: Program) -> tuple[Bound, ...]:
    """Limits of columns of a program, in their order."""
    sizes, found = program.checks("rowsize"), list[Bound]()
    for k, check in enumerate(program.columns):
        if not isinstance(check, Check):
            continue
        part = check.part
        if isinstance(part, Output):
            found.append(
                Bound("OPEN_MOMENT" if part.unit(program.data.kinds) == MOMENT else "OPEN", k, part)
            )
        elif (kind := _KINDS.get(check.kind)) is not None:
            iterated = check.kind == "closure" and program.iterates(part)
            found.append(
                Bound("BRANCH" if iterated else kind, k, part, sizes[part] if kind == "ROW" else -1)
            )
    return tuple(found)


def rules_of(program: Program) -> tuple[Rule, ...]:
    """Rules of an instant, in the order in which they are reported."""
    return tuple(rule for rule, _ in _tests(program))


def status_of(program: Program) -> ca.Function:
    """The function ``status(checks, limits, beside, iterated)``: the number of the first rule that
    is broken.
    """
    many = len(program.bounds)
    checks, limits, beside = (ca.SX.sym(name, many) for name in ("checks", "limits", "beside"))
    iterated, first = ca.SX.sym("iterated"), ca.SX(0)
    for number, (rule, fails) in reversed([*enumerate(_tests(program), 1)]):
        k = rule.bound
        broken = fails(iterated, 0, 0) if k is None else fails(checks[k], limits[k], beside[k])
        first = ca.if_else(broken, number, first)
    given = {"checks": checks, "limits": limits, "beside": beside, "iterated": iterated}
    return graph("status", given, rule=first)


_Fails: TypeAlias = Callable[[Any, Any, Any], Any]
"""Test of a rule, by a column, its limit, and neighbouring values.

What is no number breaks some rules, and not others.
"""


def _above(x: ca.SX, limit: ca.SX, _: ca.SX) -> ca.SX:
    return limit < x


def _not_above(x: ca.SX, limit: ca.SX, _: ca.SX) -> ca.SX:
    return ca.logic_not(limit < x)


_TESTS: Mapping[Kind, Sequence[tuple[Status, _Fails]]] = {
    "BEYOND": [(Status.BEYOND_ENDS, _above)],
    "CLOSURE": [
        (Status.OUT_OF_REACH, lambda x, limit, _: x < -limit),
        (Status.DEAD_CENTRE, _not_above),
        (Status.PASSES_DEAD_CENTRE, lambda x, limit, passes: passes > 0),
    ],
    "BRANCH": [
        (Status.JUMPED, lambda x, limit, _: x < -limit),
        (Status.DEAD_CENTRE, _not_above),
        (Status.PASSES_DEAD_CENTRE, lambda x, limit, passes: passes > 0),
    ],
    "GAP": [(Status.NOT_CLOSED, lambda x, limit, _: limit < ca.fabs(x))],
    "MISFIT": [(Status.MISFIT, _above)],
    "ROW": [(Status.ROW_VIOLATED, lambda x, limit, size: ca.logic_not(ca.fabs(x) <= limit * size))],
    "TURNED": [
        (Status.TURNED, lambda x, limit, _: ca.logic_not(ca.fabs(x) <= limit)),
        (Status.TURNED, lambda x, limit, change: ca.fabs(change) > LEAP),
    ],
    "JAM": [(Status.JAMS, _not_above)],
    "SLIP": [(Status.JAMS, _above)],
    "REST": [(Status.AT_REST, _above)],
    "OPEN": [(Status.OK, _above)],
    "OPEN_MOMENT": [(Status.OK, _above)],
}


def _tests(program: Program) -> list[tuple[Rule, _Fails]]:
    """The rules in their order, and when each is broken.

    Loops that iteration did not close come right after the ends of curves, and those that it closes
    slowly after those that are at a dead centre: what else is wrong follows from that. What is at
    rest or open comes where nothing is wrong.
    """
    numbered = [*enumerate(program.bounds)]
    first, last = ("BEYOND",), ("REST", "OPEN", "OPEN_MOMENT")
    between = [(k, bound) for k, bound in numbered if bound.kind not in (*first, *last)]
    count = next(
        (n for n, (_, bound) in enumerate(between) if bound.kind not in ("CLOSURE", "BRANCH")),
        len(between),
    )

    def rules_of(some: Iterable[tuple[int, Bound]]) -> list[tuple[Rule, _Fails]]:
        return [
            (Rule(status, k), fails) for k, bound in some for status, fails in _TESTS[bound.kind]
        ]

    found = (
        [(Rule(status), _is(status)) for status in (Status.NOT_CONVERGED, Status.SLOW)]
        if program.newton is not None
        else []
    )
    ends = rules_of(one for one in numbered if one[1].kind in first)
    rest = rules_of(
        sorted(
            (one for one in numbered if one[1].kind in last),
            key=lambda one: last.index(one[1].kind),
        )
    )
    return [
        *ends,
        *found[:1],
        *rules_of(between[:count]),
        *found[1:],
        *rules_of(between[count:]),
        *rest,
    ]


def _is(status: Status) -> _Fails:
    return lambda iterated, _, __: ca.SX(iterated) == int(status)
