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
from ..base.scalars import column, entries, graph, inputs_of
from ..base.symbolic import Graphs, symbolic
from ..errors import DeclarationError
from .beyond_ends import beyond_ends
from .expressions import expressed, scalar
from .motion_laws import Motion


@dataclass(frozen=True, eq=False)
class Laws(Graphs):
    """The motion of several drives, ``joints``, by one function ``motion(t, p) -> (d, d_rate,
    d_acceleration)`` of scalars.

    ``spans`` are the times that each law covers, and ``knots`` those of its samples [s].
    ``beyond(t, p)`` says how far what the laws put into curves is beyond their ends, a row a joint;
    below zero where it is between them. It is None where no law has a curve with ends.
    """

    joints: tuple[str, ...]
    motion: ca.Function
    spans: tuple[tuple[float, float], ...]
    knots: tuple[tuple[float, ...], ...]
    beyond: ca.Function | None

    @classmethod
    @symbolic
    def of(cls, laws: Mapping[str, Motion], parameters: Expression) -> Laws:
        """The function of laws by the joint's name.

        Raises :class:`DeclarationError` for a law that is not a scalar expression of t and
        parameters.
        """
        given = {"t": ca.SX.sym("t"), "p": parameters}
        values = [law_expression(joint, law, *given.values()) for joint, law in laws.items()]
        ends = [
            [] if law.knots else [far for _, far in beyond_ends(value)]
            for law, value in zip(laws.values(), values, strict=True)
        ]
        beyond = [functools.reduce(ca.fmax, one, ca.SX(-1.0)) for one in ends]
        d = column(values)
        rate = ca.jacobian(d, given["t"])
        bend = ca.jacobian(rate, given["t"])
        return cls(
            tuple(laws),
            graph("motion", given, d=d, d_rate=rate, d_acceleration=bend),
            tuple(law.span for law in laws.values()),
            tuple(law.knots for law in laws.values()),
            graph("beyond", given, beyond=column(beyond)) if any(ends) else None,
        )

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
        given = inputs_of(self.motion)
        some = [self.joints.index(joint) for joint in joints]
        d, rate, bend = (row[some] for row in self.motion(*given.values()))
        beyond = self.beyond
        if beyond is not None:
            beyond = graph("beyond", given, beyond=beyond(*given.values())[some])
        return Laws(
            tuple(joints),
            graph("motion", given, d=d, d_rate=rate, d_acceleration=bend),
            tuple(self.spans[k] for k in some),
            tuple(self.knots[k] for k in some),
            beyond,
        )

    @symbolic
    def jerk(self) -> ca.Function:
        """The CasADi function ``jerk(t, p) -> d_jerk``, the third derivatives; at a knot, that
        after it.
        """
        given = inputs_of(self.motion)
        bends = self.motion(*given.values())[2]
        return graph("jerk", given, d_jerk=ca.jacobian(bends, given["t"]))


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
