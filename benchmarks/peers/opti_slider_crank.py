"""The least peak torque of the slider-crank under a limit of its rod's bending, written by hand in
CasADi's Opti.

The closed form is that of :mod:`.numpy_closed`. Peaks are held at all instants, and at some ratios
along the rod.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from .paper_case import Array, SliderCrank


def solved(
    case: SliderCrank,
    t: Array,
    xi: Array,
    limit: float,
    bounds: Mapping[str, tuple[float, float]],
    start: Mapping[str, float],
) -> tuple[dict[str, float], float]:
    """The values of ``l`` and ``r``, and the least peak torque [N m] for bending [N m] within a
    limit.
    """
    opti = ca.Opti()
    chosen = {name: opti.variable() for name in bounds}
    level = opti.variable()
    torque, bending = _forces(case).map(t.size)(
        ca.DM(np.array(case.motion(t))), ca.vertcat(chosen["r"], chosen["l"]), ca.DM(xi)
    )
    opti.minimize(level)
    opti.subject_to(opti.bounded(-level, ca.vec(torque), level))
    opti.subject_to(opti.bounded(-limit, ca.vec(bending), limit))
    for name, variable in chosen.items():
        opti.subject_to(opti.bounded(bounds[name][0], variable, bounds[name][1]))
        opti.set_initial(variable, start[name])
    first, _ = _forces(case).map(t.size)(
        ca.DM(np.array(case.motion(t))), ca.DM([start["r"], start["l"]]), ca.DM(xi)
    )
    opti.set_initial(level, float(np.abs(first.full()).max()))
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes", "tol": 1e-10})
    solution = opti.solve()
    return {name: float(solution.value(variable)) for name, variable in chosen.items()}, float(
        solution.value(level)
    )


def _forces(case: SliderCrank) -> Any:
    """The torque of the crank, and the bending along the rod, at one instant."""
    motion, lengths, v = ca.SX.sym("motion", 3), ca.SX.sym("lengths", 2), ca.SX.sym("xi", 11)
    (theta, omega, alpha), (r, l) = ca.vertsplit(motion), ca.vertsplit(lengths)
    m1, m2, m3, g = case.m1, case.m2, case.m3, case.g
    c, s = ca.cos(theta), ca.sin(theta)
    sin = -r / l * s
    cos = ca.sqrt(1.0 - sin**2)
    spin = -r * c * omega / (l * cos)
    ax, ay = -r * (c * omega**2 + s * alpha), r * (c * alpha - s * omega**2)
    turn = (sin * spin**2 - ay / l) / cos
    acceleration = ax - l * (cos * spin**2 + sin * turn)
    bx = m3 * acceleration
    by = ((bx + m2 * ax / 2) * sin - m2 * l * turn / 3) / cos - m2 * (ay + g) / 2
    fx, fy = bx + m2 * (ax + acceleration) / 2, by + m2 * (ay / 2 + g)
    torque = r * (fy * c - fx * s) + m1 * r * (g * c / 2 + r * alpha / 3)
    f0, f1, f2 = bx * sin - by * cos, ax * sin - (ay + g) * cos, -turn
    rest = 1.0 - v
    bending = l * rest * (f0 + rest * (m2 / 2 * (f1 + l * f2) - m2 * l / 6 * f2 * rest))
    return ca.Function("forces", [motion, lengths, v], [torque, bending], {"cse": True})
