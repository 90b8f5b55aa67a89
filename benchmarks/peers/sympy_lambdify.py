"""SymPy: the equilibrium of the rod's outboard piece, derived symbolically, and a NumPy function by
``lambdify``.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from .paper_case import Array, SliderCrank, Work


def sections(case: SliderCrank, t: Array, xi: Array) -> Work:
    """What returns axial, shear and bending of the rod, (3, t, xi);
    they are derived here, before.
    """
    forces, ratios = _forces(), xi[None, :]

    def call() -> Array:
        out = np.empty((3, len(t), len(xi)))
        out[0], out[1], out[2] = forces(*case.motion(t[:, None]), ratios, *case.parameters, case.g)
        return out

    return call


@cache
def _forces() -> Any:
    """The function (theta, omega, alpha, xi, parameters, g) -> (axial, shear, bending)."""
    t, x, u = sp.symbols("t x u")
    angle, rate, acceleration = sp.symbols("theta omega alpha")
    r, l, m1, m2, m3, g = sp.symbols("r l m1 m2 m3 g", positive=True)
    bx, by = sp.symbols("bx by")
    theta = sp.Function("theta")(t)
    phi = -sp.asin(r / l * sp.sin(theta))
    along, across = sp.Matrix([sp.cos(phi), sp.sin(phi)]), sp.Matrix([-sp.sin(phi), sp.cos(phi)])
    base = r * sp.Matrix([sp.cos(theta), sp.sin(theta)])
    tip = sp.Matrix([-bx, -by])  # the action of the slider on the rod

    def beyond(arm: Any, direction: sp.Matrix) -> Any:
        """Weight and inertia of the piece from ``u`` to the tip, resolved on a direction, times an
        arm linear in ``x``.
        """
        field = sp.Matrix([0, -g]) - (base + x * l * along).diff(t, 2)
        coefficients = [
            direction.dot(field.subs(x, 0)),
            direction.dot(field.subs(x, 1) - field.subs(x, 0)),
        ]
        return m2 * sum(
            c * sp.integrate(sp.expand(arm * x**power), (x, u, 1))
            for power, c in enumerate(coefficients)
        )

    axial = along.dot(tip) + beyond(sp.Integer(1), along)
    shear = across.dot(tip) + beyond(sp.Integer(1), across)
    bending = l * ((1 - u) * across.dot(tip) + beyond(x - u, across))
    pull = m3 * (base + l * along)[0].diff(t, 2)
    moment = bending.subs(u, 0)  # at the pin A, which bears none
    push = -moment.subs(by, 0) / moment.diff(by)
    known = [
        (by, push),
        (bx, pull),
        (theta.diff(t, 2), acceleration),
        (theta.diff(t), rate),
        (theta, angle),
    ]
    results = [force.subs(known).doit() for force in (axial, shear, bending)]
    return sp.lambdify(
        (angle, rate, acceleration, u, r, l, m1, m2, m3, g), results, "numpy", cse=True
    )
