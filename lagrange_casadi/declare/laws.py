"""The motions of several drives as functions that hold nothing else, and what is asked of them beside their values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from ..base.symbolic import Graphs, symbolic
from ..errors import DeclarationError
from .curves import curve
from .motion import Motion, ends_function, motion_function

_NAMES = ["t", "p"], ["d", "d_rate", "d_acceleration"]


@dataclass(frozen=True, eq=False)
class Laws(Graphs):
    """The motion of several drives, ``joints``, in two functions as :func:`.motion_function` makes them.

    ``smooth`` is of the laws that are written in scalars, ``sampled`` of those by samples, or None; ``order`` says of each drive
    where it is, the sampled ones counted after the smooth ones. ``spans`` are the times that each law covers, and ``knots`` those
    of its samples [s]. ``beyond`` is the function of :func:`.ends_function`, or None.
    """

    joints: tuple[str, ...]
    smooth: Any
    sampled: Any | None
    order: tuple[int, ...]
    spans: tuple[tuple[float, float], ...]
    knots: tuple[tuple[float, ...], ...]
    beyond: Any | None

    @classmethod
    @symbolic
    def of(cls, laws: Mapping[str, Motion], parameters: Any) -> Laws:
        """The functions of laws by the joint's name."""
        smooth, sampled = ({name: law for name, law in laws.items() if law.spline is spline} for spline in (False, True))
        order = tuple([*smooth, *sampled].index(name) for name in laws)
        functions = motion_function(smooth, parameters), motion_function(sampled, parameters) if sampled else None
        spans, knots = tuple(law.span for law in laws.values()), tuple(law.knots for law in laws.values())
        return cls(tuple(laws), *functions, order, spans, knots, ends_function(laws, parameters))

    @property
    def span(self) -> tuple[float, float]:
        """The time that all laws cover [s]."""
        lows, highs = zip((-math.inf, math.inf), *self.spans, strict=True)
        return max(lows), min(highs)

    @symbolic
    def only(self, joint: str) -> Laws:
        """The law of one of the drives."""
        k = self.joints.index(joint)
        place, many = self.order[k], self.smooth.size1_out(0)
        t, p = self.smooth.sx_in()
        if place < many:
            smooth, sampled = ca.Function("motion", [t, p], [row[place] for row in self.smooth(t, p)], *_NAMES), None
        else:
            time, values = ca.MX.sym("t"), ca.MX.sym("p", p.numel())
            assert self.sampled is not None
            rows = [row[place - many] for row in self.sampled(time, values)]
            smooth = ca.Function("motion", [t, p], [ca.SX(0, 1)] * 3, *_NAMES)
            sampled = ca.Function("motion", [time, values], rows, *_NAMES)
        beyond = None if self.beyond is None else ca.Function("beyond", [t, p], [self.beyond(t, p)[k]], ["t", "p"], ["beyond"])
        return Laws((joint,), smooth, sampled, (0,), (self.spans[k],), (self.knots[k],), beyond)

    @cached_property
    @symbolic
    def motion(self) -> Any:
        """The CasADi function ``motion(t, p) -> (d, d_rate, d_acceleration)`` of all drives."""
        if self.sampled is None:
            return self.smooth
        if not self.smooth.size1_out(0):
            return self.sampled
        t, p = ca.MX.sym("t"), ca.MX.sym("p", self.smooth.size1_in(1))
        both = zip(self.smooth(t, p), self.sampled(t, p), strict=True)
        return ca.Function("motion", [t, p], [ca.vertcat(*pair)[list(self.order)] for pair in both], *_NAMES)

    @property
    def with_samples(self) -> tuple[str, ...]:
        """The drives whose laws are by samples."""
        many = self.smooth.size1_out(0)
        return tuple(joint for joint, place in zip(self.joints, self.order, strict=True) if place >= many)

    @property
    def known(self) -> bool:
        """Whether all samples tell their knots."""
        return all(self.knots[self.joints.index(joint)] for joint in self.with_samples)

    @symbolic
    def jerk(self) -> Any:
        """The CasADi function ``jerk(t, p) -> d_jerk``, the third derivatives; at a spline's knot, that of one side.

        Raises :class:`.DeclarationError` for a spline that does not tell its knots.
        """
        t, p = self.smooth.sx_in()
        by_t = ca.densify(ca.jacobian(self.smooth(t, p)[2], t))
        bend = ca.Function("jerk", [t, p], [by_t], ["t", "p"], ["d_jerk"], {"cse": True})
        if self.sampled is None:
            return bend
        time, values = ca.MX.sym("t"), ca.MX.sym("p", p.numel())
        rows = [bend(time, values)]
        for place, knots in self._splines("its third derivative needs"):
            # Not by the spline's own derivative: at a knot CasADi's splines of degree 0 write beside their memory.
            bends = self.sampled(ca.DM(knots).T, ca.DM.zeros(p.numel()))[2][place, :].full().ravel()
            rows.append(ca.densify(ca.jacobian(ca.interpolant("bend", "linear", [knots], bends)(time), time)))
        return ca.Function("jerk", [time, values], [ca.vertcat(*rows)[list(self.order)]], ["t", "p"], ["d_jerk"])

    @symbolic
    def in_scalars(self) -> Laws:
        """The same laws, none of them a spline of CasADi's own, so that they can be differentiated as often as one likes.

        The spline through what one is at its knots is the same one. Raises :class:`.DeclarationError` where it does not tell them.
        """
        if self.sampled is None:
            return self
        t, p = self.smooth.sx_in()
        value = self.smooth(t, p)[0]
        rows: list[Any] = [value[k] for k in range(value.numel())]
        for place, knots in self._splines("its further derivatives need"):
            values = self.sampled(ca.DM(knots).T, ca.DM.zeros(p.numel()))[0][place, :].full().ravel()
            rows.append(ca.SX(curve(knots, values.tolist())(t)))
        value = ca.vertcat(ca.SX(0, 1), *(rows[k] for k in self.order))
        rate = ca.densify(ca.jacobian(value, t))
        found = [ca.densify(value), rate, ca.densify(ca.jacobian(rate, t))]
        whole = ca.Function("motion", [t, p], found, *_NAMES, {"cse": True})
        return Laws(self.joints, whole, None, tuple(range(len(self.joints))), self.spans, self.knots, self.beyond)

    def _splines(self, needs: str) -> list[tuple[int, tuple[float, ...]]]:
        """The places among the sampled laws and the knots, in that order."""
        many, found = self.smooth.size1_out(0), []
        for joint, place, knots in sorted(zip(self.joints, self.order, self.knots, strict=True), key=lambda law: law[1]):
            if place >= many:
                if not knots:
                    raise DeclarationError(f"the motion of joint '{joint}' does not tell its knots, which {needs}")
                found.append((place - many, knots))
        return found

    def words(self) -> list[Any]:
        """The laws for JSON; functions as the text in which CasADi writes them."""
        functions = (None if f is None else f.serialize() for f in (self.smooth, self.sampled, self.beyond))
        return [self.joints, self.order, self.spans, self.knots, *functions]

    @classmethod
    def loads(cls, words: Sequence[Any]) -> Laws:
        """The laws that :meth:`words` made."""
        joints, order, spans, knots, *functions = words
        smooth, sampled, beyond = (None if f is None else ca.Function.deserialize(f) for f in functions)
        spans, knots = tuple((low, high) for low, high in spans), tuple(map(tuple, knots))
        return cls(tuple(joints), smooth, sampled, tuple(order), spans, knots, beyond)
