"""The motions of several drives as a function that holds nothing else, and the times and knots of
their samples.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from ..base.arrays import Expression
from ..base.symbolic import Graphs, symbolic
from .motion import Motion, ends_function, motion_function

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
        spans, knots = (
            tuple(law.span for law in laws.values()),
            tuple(law.knots for law in laws.values()),
        )
        return cls(
            tuple(laws),
            motion_function(laws, parameters),
            spans,
            knots,
            ends_function(laws, parameters),
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
