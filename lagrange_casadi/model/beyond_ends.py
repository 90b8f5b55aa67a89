"""Distance of arguments of curves and tables beyond their ends, where they are not
defined.
"""

from __future__ import annotations

import math
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.lookups import lookup
from ..base.symbolic import symbolic
from ..base.vocabulary import Precision

BEYOND: dict[Precision, float] = {"double": 1e-8, "single": 1e-5}
"""Largest distance of an argument beyond the ends of a curve that is rounding, in the measure of
:func:`beyond_ends`.
"""


@symbolic
def beyond_ends(expression: ca.SX) -> list[tuple[str, Expression]]:
    """Distance of each argument of an expression's curves and tables beyond their ends, where they
    have ends; before it their kind and their range in words, as "table, from 0 to 40,".

    The square of how far it is from the middle between the ends, over the square of how far these
    are, less one: it is above zero beyond the ends, and smooth, so that splines may follow it.
    """
    expression = ca.densify(ca.vec(ca.SX(expression)))
    function = ca.Function("arguments", ca.symvar(expression), [expression], {"cse": True})
    calls = [
        k for k in range(function.n_instructions()) if function.instruction_id(k) == ca.OP_CALL
    ]
    written: Any = function.instructions_sx() if calls else None
    found: list[tuple[str, Expression]] = []
    for k in calls:
        table = lookup(written[k].which_function())
        if table is not None and table.ends:
            low, high = float(table.numbers[0]), float(table.numbers[-1])
            far = (2.0 / (high - low)) * written[k].dep(0) - (high + low) / (high - low)
            kind = "table" if table.alone else "curve"
            found.append((f"{kind}, from {low:g} to {high:g},", far**2 - 1.0))
    return found


def words_beyond(what: str, argument: str, where: str) -> str:
    """Message for ``what`` has an ``argument``, in the words of :func:`beyond_ends`, beyond its
    ends; ``where`` says where.
    """
    kind = argument.partition(",")[0]
    cure = "; expected points that reach further, or beyond='hold' or beyond='line'"
    return (
        f"{what}: the argument of its {argument} is outside the {kind}'s range{where}"
        f"{cure if kind == 'table' else ''}"
    )


def share_beyond(beyond: float) -> float:
    """Distance beyond the nearer end, relative to the distance of the ends."""
    return (math.sqrt(1.0 + max(beyond, -1.0)) - 1.0) / 2.0
