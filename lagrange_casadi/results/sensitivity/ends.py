"""Derivatives of the first and the last instant by the parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ...base.arrays import Array
from ...base.symbolic import symbolic_property
from ...model.sampled_laws import Laws
from ...model.times import Timing


@dataclass(frozen=True, eq=False)
class Ends:
    """The first and the last of ``instants`` that a ``timing`` asks for, with parameters ``p``;
    without a timing they stand still.

    Where they are asked for by a drive, an end is where its coordinate is at a bound.
    """

    laws: Laws
    timing: Timing | None
    instants: Array
    p: Array

    @symbolic_property
    def slopes(self) -> Array:
        """Derivatives of both ends by all parameters, (2, parameters) [s]."""
        if self._still:
            return np.zeros((2, self.p.size))
        gradients = self._gaps(lambda gap, by: ca.gradient(gap, by).T)[:, 0]
        return -gradients[:, 1:] / gradients[:, :1]

    @symbolic_property
    def bends(self) -> Array:
        """Second derivatives by all parameters, (2, parameters, parameters) [s]."""
        if self._still:
            return np.zeros((2, self.p.size, self.p.size))
        gaps = self._gaps(
            lambda gap, by: ca.vertcat(ca.gradient(gap, by).T, ca.hessian(gap, by)[0])
        )
        return implicit_bends(gaps[:, 0, 0], gaps[:, 1:], self.slopes)

    @property
    def _still(self) -> bool:
        return self.timing is None or self.timing.shared or not self.p.size

    def _gaps(self, derivatives: Callable[[ca.SX, ca.SX], ca.SX]) -> Array:
        """Derivatives, (2, rows, 1 + parameters), by time and by all parameters, of each end's
        distance from its target.
        """
        assert self.timing is not None
        t, values, joint = ca.SX.sym("t"), ca.SX.sym("p", self.p.size), self.timing.joint
        along = self.laws.only([joint]).motion(t, values)[0] if joint else t
        found = []
        for time, bound in zip(
            self.instants[[0, -1]].tolist(), self.timing.ends(values), strict=True
        ):
            rows = ca.densify(derivatives(ca.SX(along - bound), ca.vertcat(t, values)))
            found.append(ca.Function("gap", [t, values], [rows])(time, self.p).full())
        return np.stack(found)


def implicit_bends(rate: Array, second: Array, moved: Array) -> Array:
    """The second derivatives of the time T(p) at which W(t, p) is nothing: from W_t (n,), all
    second derivatives of W by t and p, (n, 1 + parameters, 1 + parameters), and T' (n, parameters).
    """
    tt, tp, pp = second[:, 0, 0], second[:, 0, 1:], second[:, 1:, 1:]
    across = tp[:, :, None] * moved[:, None, :]
    total = (
        pp
        + across
        + np.swapaxes(across, 1, 2)
        + tt[:, None, None] * moved[:, :, None] * moved[:, None, :]
    )
    return np.asarray(-total / rate[:, None, None])
