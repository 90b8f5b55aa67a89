"""The C of a scene: functions of its graph, and what runs them over instants.

One file serves two compilers. As C every value is a double. As C++, with ``lanes.h`` put before it,
what is done for each instant is done for a pack of instants at once; what depends on the instant
before (iterated loops) stays with doubles.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import casadi as ca

from ...base.scalars import column
from ...base.status import Status
from ...base.symbolic import symbolic
from ...base.vocabulary import Precision
from ..iteration import NEWTON_LOST
from ..program import Program
from .calls import Call
from .compiler import WIDE, start, written
from .printer import defined, function_name, literal, print_functions
from .reduction import Reduction, reduced
from .stages import Stages, plain

EVALUATE, FOLLOW = "lagrange_casadi_evaluate", "lagrange_casadi_follow"
NEWTON_STEPS = 50

_NEWTON: dict[Precision, dict[str, float]] = {
    "double": {"done": 1e-9, "rate": 1e-2, "rounding": 1e-13},
    "single": {"done": 1e-4, "rate": 0.25, "rounding": 1e-5},
}
"""Corrections of each precision: that after which the next one would be rounding (``done``), and
that which is ``rounding``; and the least ratio of one correction to the one before, the ``rate``,
from which corrections shrink too slowly to be quadratic. At a dead centre it is 1/2; if corrections
end early, as in single precision, their square is not far below them.
"""

INSTANTS = Call(
    "lagrange_casadi_instants",
    {
        "n": "long long",
        "stride": "long long",
        "t": "real*",
        "p": "real*",
        "guess": "const real*",
        "z": "real*",
        "out": "real*",
        "apart": "long long",
        "status": "int*",
    },
)
"""Instants of a design, of which :data:`EVALUATE` and :data:`FOLLOW` take some; the C says which
members it reads and writes.
"""


def emit(
    program: Program,
    stages: Stages | None = None,
    newton: int | None = None,
    reduction: Reduction | None = None,
) -> str:
    """The whole C file of a scene; the same text in every process, on every machine, for the same
    version of CasADi.

    ``stages`` say in which arithmetic, default: :func:`.plain`. ``newton`` is how many steps
    iterated loops take an instant, None for as many as they need. The file is called for instants
    of one design; with a ``reduction`` it is called for many designs, and gives what that keeps of
    each.
    """
    stages = plain(program) if stages is None else stages
    precision = stages.precision
    constants, instant = hoisted(stages.instant)
    narrow = {"lead": stages.drive, "loops": stages.loops} if stages.loops else {}
    wide = {"drive": stages.drive, "constants_of": constants, "instant": instant}
    macros = _sizes(program, stages, reduction) | {"CONSTANTS": constants.size1_out(0)}
    macros |= {status.name: int(status) for status in Status}
    if program.newton is not None:
        macros |= _closing(program.newton.turning, precision, newton)
    macros["BEGINS"] = int(reduction is not None and newton is not None)
    rare = {}
    if reduction is not None:
        macros["REDUCED"] = ""
        if stages.closing is not None and stages.closing.size1_out(0):
            rare["closing"] = stages.closing
    text = (
        start(precision)
        + INSTANTS.text()
        + print_functions(narrow, precision, prefix="follow")
        + WIDE
        + print_functions(wide, precision, prefix="scene", packs=True)
        + print_functions(rare, precision, prefix="closing", packs=True, rare=True)
        + defined("SCENE", macros)
        + written("scene.c")
    )
    return text if reduction is None else text + reduced(program, reduction, precision)


def _sizes(program: Program, stages: Stages, reduction: Reduction | None) -> dict[str, object]:
    columns, watched = len(program.columns), reduction.watched if reduction else 0
    nt = stages.drive.size1_in(0)
    nc = stages.drive.size1_out(0)
    nd = program.instant.size1_in("d")
    return {
        "NT": nt,
        "NP": program.instant.size1_in("p"),
        "NC": nc,
        "ND": nd,
        "NZ": program.instant.size1_in("z"),
        "PLACE": nt + nc + 2 * nd,
        "COLUMNS": columns,
        "OUTPUTS": columns - watched,
    }


def _closing(turning: Sequence[bool], precision: Precision, steps: int | None) -> dict[str, object]:
    """Numbers that close iterated loops: at any instant, and where the first one is begun."""
    number = literal(precision)
    rules = ", ".join(_rule(precision, count) for count in (steps, None))
    return {
        "TURNING": f"{{{', '.join(str(int(turning_flags)) for turning_flags in turning)}}}",
        "TURN": number(math.tau),
        "INVERSE": number(1.0 / math.tau),
        "HALF": number(0.5),
        "FLOOR": function_name("floor", precision),
        "RULES": f"{{{rules}}}",
    }


def _rule(precision: Precision, steps: int | None) -> str:
    """A rule as C has it: a fixed number of steps is never slow."""
    rule, number = newton_rule(precision, steps), literal(precision)
    if steps is not None:
        rule |= {"rate": math.inf}
    limits = (number(rule[name]) for name in ("done", "lost", "rate", "rounding"))
    return f"{{{', '.join([str(int(rule['steps'])), *limits])}}}"


def newton_rule(precision: Precision, steps: int | None) -> dict[str, float]:
    """Limits of Newton's method for iterated loops: the numbers that the emitted C and the virtual
    machine share.
    """
    rule = _NEWTON[precision]
    if steps is not None:
        return rule | {"steps": steps, "done": 0.0, "lost": NEWTON_LOST}
    return rule | {"steps": NEWTON_STEPS, "lost": rule["done"]}


@symbolic
def hoisted(
    instant: ca.Function, rows: Sequence[int] | None = None
) -> tuple[ca.Function, ca.Function]:
    """Split an instant: ``constants_of(p) -> c``, the part that depends on parameters alone, and
    the instant with c for p; of some ``rows``.
    """
    inputs = instant.sx_in()
    out = instant(*inputs) if rows is None else instant(*inputs)[list(rows)]
    rest, symbols, constants = ca.extract_parametric(out, inputs[-1], {"extract_trivial": True})
    c = column(symbols)
    hoisted = ca.Function(
        "constants_of",
        [inputs[-1]],
        [ca.densify(column(constants))],
        {"cse": True},
    )
    return hoisted, ca.Function("instant", [*inputs[:-1], c], [ca.densify(rest)], {"cse": True})
