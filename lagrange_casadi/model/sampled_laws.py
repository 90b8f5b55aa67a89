"""The motions of several drives as a function that holds nothing else, and the times and knots of
their samples.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from ..base.arrays import Expression
from ..base.scalars import column, entries
from ..base.symbolic import Graphs, symbolic
from ..errors import DeclarationError
from .beyond_ends import beyond_ends
from .expressions import expressed, scalar
from .motion_laws import Motion

_NAMES = ["t", "p"], ["d", "d_rate", "d_acceleration"]


@dataclass(frozen=True, eq=False)
class Laws(Graphs):
    """The motion of several drives, ``joints``, by one function ``motion(t, p) -> (d, d_rate,
    d_acceleration)`` of scalars.

    ``spans`` are the times that each law covers, and ``knots`` those of its samples [s]. ``beyond``
    is the function of :func:`.ends_function`, or None.
    """

    joints: tuple[str, ...]
    motion: ca.Function
    spans: tuple[tuple[float, float], ...]
    knots: tuple[tuple[float, ...], ...]
    beyond: ca.Function | None

    @classmethod
    @symbolic
    def of(cls, laws: Mapping[str, Motion], parameters: Expression) -> Laws:
        """The function of laws by the joint's name."""
        spans = tuple(law.span for law in laws.values())
        knots = tuple(law.knots for law in laws.values())
        motion, beyond = motion_function(laws, parameters), ends_function(laws, parameters)
        return cls(tuple(laws), motion, spans, knots, beyond)

    @property
    def span(self) -> tuple[float, float]:
        """The time that all laws cover [s]."""
        lows, highs = zip((-math.inf, math.inf), *self.spans, strict=True)
        return max(lows), min(highs)

    @symbolic
    def only(self, joints: Sequence[str]) -> Laws:
        """The laws of some of the drives, in an order of their own."""
        if self.joints == tuple(joints):
            return self
        t, p = self.motion.sx_in()
        some = [self.joints.index(joint) for joint in joints]
        motion = ca.Function(
            "motion", [t, p], [row[some] for row in self.motion(t, p)], *_NAMES, {"cse": True}
        )
        beyond = None
        if self.beyond is not None:
            beyond = ca.Function(
                "beyond", [t, p], [self.beyond(t, p)[some]], ["t", "p"], ["beyond"], {"cse": True}
            )
        spans, knots = tuple(self.spans[k] for k in some), tuple(self.knots[k] for k in some)
        return Laws(tuple(joints), motion, spans, knots, beyond)

    @symbolic
    def jerk(self) -> ca.Function:
        """The CasADi function ``jerk(t, p) -> d_jerk``, the third derivatives; at a knot, that
        after it.
        """
        t, p = self.motion.sx_in()
        by_t = ca.densify(ca.jacobian(self.motion(t, p)[2], t))
        return ca.Function("jerk", [t, p], [by_t], ["t", "p"], ["d_jerk"], {"cse": True})


@symbolic
def motion_function(laws: Mapping[str, Motion], parameters: ca.SX) -> ca.Function:
    """The CasADi function ``motion(t, p) -> (d, d_rate, d_acceleration)`` of several laws, by the
    joint's name.

    Raises :class:`DeclarationError` for a law that is not a scalar expression of t and parameters.
    """
    t = ca.SX.sym("t")
    rows = [
        _derivatives(law_expression(joint, law, t, parameters), t) for joint, law in laws.items()
    ]
    stacked = [column(row[order] for row in rows) for order in range(3)]
    return ca.Function("motion", [t, parameters], stacked, *_NAMES, {"cse": True})


@symbolic
def ends_function(laws: Mapping[str, Motion], parameters: ca.SX) -> ca.Function | None:
    """The CasADi function ``beyond(t, p)``: how far what the laws put into curves is beyond their
    ends, a row a joint of the laws.

    Below zero where it is between them; None where no law has a curve with ends.
    """
    t = ca.SX.sym("t")
    found = [
        [] if law.knots else beyond_ends(law_expression(joint, law, t, parameters))
        for joint, law in laws.items()
    ]
    if not any(found):
        return None
    rows = [functools.reduce(ca.fmax, [far for _, far in one], ca.SX(-1.0)) for one in found]
    beyond = ca.densify(ca.vertcat(*rows))
    return ca.Function("beyond", [t, parameters], [beyond], ["t", "p"], ["beyond"], {"cse": True})


def law_expression(joint: str, law: Motion, t: ca.SX, parameters: ca.SX) -> Expression:
    """A law as a scalar expression of t and parameters.

    Raises :class:`.DeclarationError` for what is none.
    """
    what = f"the motion of joint '{joint}'"
    value = expressed(what, law.graph, [t], "the time t")
    if isinstance(value, float) and math.isnan(value):
        raise DeclarationError(
            f"{what} is not a number; use CasADi's functions, as casadi.sin in place of math.sin"
        )
    return scalar(what, value, [t, *entries(parameters)], "parameter")


def _derivatives(value: ca.SX, t: ca.SX) -> list[ca.SX]:
    value = ca.SX(value)
    rate = ca.densify(ca.jacobian(value, t))
    return [ca.densify(value), rate, ca.densify(ca.jacobian(rate, t))]
