"""Derivatives of the first and the last instant by the parameters."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from ..base.arrays import Array
from ..declare.laws import Laws
from ..declare.times import Timing


def end_slopes(laws: Laws, timing: Timing, first: float, last: float, p: Array) -> Array:
    """The derivatives by all parameters of the first and the last instant, (2, parameters) [s].

    Where instants are asked for by a drive, that of coordinate = bound at its time.
    """
    if timing.shared or not p.size:
        return np.zeros((2, p.size))
    bounds = timing.bound_slopes(p)
    if not timing.joint:
        return bounds
    motion = laws.only([timing.joint]).motion
    rates = np.array([float(motion(time, p)[1]) for time in (first, last)])
    t, values = motion.sx_in()
    slope = ca.Function(
        "slope", [t, values], [ca.densify(ca.jacobian(motion(t, values)[0], values))]
    )
    own = np.stack([slope(time, p).full().ravel() for time in (first, last)])
    return np.asarray((bounds - own) / rates[:, None])


def end_bends(laws: Laws, timing: Timing, first: float, last: float, p: Array) -> Array:
    """Second derivatives by all parameters, (2, parameters, parameters) [s]."""
    if timing.shared or not p.size:
        return np.zeros((2, p.size, p.size))
    t, values = ca.SX.sym("t"), ca.SX.sym("p", p.size)
    along: Any = t
    if timing.joint:
        along = laws.only([timing.joint]).motion(t, values)[0]
    found = []
    for time, bound in zip((first, last), timing.ends(values), strict=True):
        hessian, gradient = ca.hessian(ca.SX(along - bound), ca.vertcat(t, values))
        told = ca.Function("bends", [t, values], [ca.densify(gradient), ca.densify(hessian)])(
            time, p
        )
        slopes, second = told[0].full().ravel(), told[1].full()
        found.append(implicit_bends(slopes[:1], second[None], -slopes[None, 1:] / slopes[0])[0])
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
