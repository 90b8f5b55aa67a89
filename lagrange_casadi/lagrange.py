"""The Lagrange terms of any system, by automatic differentiation of its kinetic energy and force function.

The equations are those of Nguyen, Petre, Stroe, *Application of Lagrange equations for calculus of internal forces in a
mechanism*, eq. (10)-(13): with E the kinetic energy, U the force function (the negative of the potential energy), Q* the other
generalized forces, and U_Phi = sum lambda_i Phi_i for constraints Phi = 0,

    R = d/dt(dE/dq') - dE/dq - dU/dq - dU_Phi/dq - Q*.

Along the coordinates R is the effort that the motion needs (zero where nothing drives); along an extra mobility, taken at
rest, it is the internal force that the mobility would release.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from .errors import DeclarationError


def _none() -> Any:
    return ca.SX(0, 1)


@dataclass(frozen=True, eq=False)
class LagrangeSystem:
    """A system given by its energy: CasADi SX graphs over symbols.

    Parameters
    ----------
    kinetic, force_function
        E(p, q', e, e') [J] and U(p, e) [J], scalars.
    rates, accelerations
        Symbols of q' and q'', columns of n.
    coordinates
        Symbols p in which E and U are written: by default the n coordinates q themselves.
    tangent
        The matrix T(p) of p' = T q', where p is more convenient than q: a rotation carried as p = (cos q, sin q) has
        T = (-p[1], p[0]), and no sine is ever taken. The default is the identity.
    mobilities, mobility_rates
        Symbols e and e' of extra mobilities, columns of k. To first order in e is enough.
    forces, mobility_forces
        Q*, columns of n and k; zero by default.
    constraints, multipliers
        Phi(p, e), a column of c, and the symbols lambda of their multipliers.

    Raises :class:`DeclarationError` where the columns do not fit each other, or where a graph holds what may not be in it.
    """

    kinetic: Any
    force_function: Any
    coordinates: Any
    rates: Any
    accelerations: Any
    tangent: Any = None
    mobilities: Any = field(default_factory=_none)
    mobility_rates: Any = field(default_factory=_none)
    forces: Any = None
    mobility_forces: Any = None
    constraints: Any = field(default_factory=_none)
    multipliers: Any = field(default_factory=_none)

    def __post_init__(self) -> None:
        n, p, k = self.rates.numel(), self.coordinates.numel(), self.mobilities.numel()
        for name in ("coordinates", "rates", "accelerations", "mobilities", "mobility_rates", "multipliers"):
            if not getattr(self, name).is_valid_input():
                raise DeclarationError(f"{name} must be symbols, got {getattr(self, name)}")
        _expect("kinetic", self.kinetic, 1)
        _expect("force_function", self.force_function, 1)
        _expect("accelerations", self.accelerations, n)
        _expect("mobility_rates", self.mobility_rates, k)
        _expect("multipliers", self.multipliers, ca.SX(self.constraints).numel())
        if self.forces is not None:
            _expect("forces", self.forces, n)
        if self.mobility_forces is not None:
            _expect("mobility_forces", self.mobility_forces, k)
        if self.tangent is None and p != n:
            raise DeclarationError(f"{p} coordinates and {n} rates: say by 'tangent' how coordinates change with the rates")
        if self.tangent is not None and ca.SX(self.tangent).shape != (p, n):
            raise DeclarationError(f"tangent must have shape {(p, n)}, got {ca.SX(self.tangent).shape}")
        if ca.depends_on(ca.SX(self.kinetic), self.accelerations):
            raise DeclarationError("kinetic must not depend on the accelerations")
        if ca.depends_on(ca.SX(self.force_function), ca.vertcat(self.rates, self.mobility_rates)):
            raise DeclarationError("force_function must not depend on rates; put what does into 'forces'")

    def terms(self) -> tuple[Any, Any]:
        """R along the coordinates (n) and along the mobilities (k), at e = e' = e'' = 0.

        One reverse sweep of E and one forward sweep of its result, whatever n and k, so the cost is a small multiple of E's.
        """
        n, p, k = self.rates.numel(), self.coordinates.numel(), self.mobilities.numel()
        tangent = ca.SX.eye(n) if self.tangent is None else ca.SX(self.tangent)
        lagrangian = self.kinetic + self.force_function + ca.dot(self.multipliers, self.constraints)
        slopes = ca.gradient(lagrangian, ca.vertcat(self.coordinates, self.mobilities, self.rates, self.mobility_rates))
        resting = ca.vertcat(self.mobilities, self.mobility_rates)
        slopes = ca.substitute(slopes, resting, ca.SX.zeros(resting.numel()))
        by_place, by_mobility, momenta = ca.vertsplit(slopes, [0, p, p + k, p + 2 * k + n])
        # The mobilities stay at rest: neither e nor e' moves in the total time derivative of the momenta.
        inertia = ca.jtimes(
            momenta,
            ca.vertcat(self.coordinates, self.rates),
            ca.vertcat(tangent @ self.rates, self.accelerations),
        )
        along, across = ca.vertsplit(inertia, [0, n, n + k])
        along -= tangent.T @ by_place
        across -= by_mobility
        if self.forces is not None:
            along -= self.forces
        if self.mobility_forces is not None:
            across -= self.mobility_forces
        return along, across


def _expect(name: str, value: Any, size: int) -> None:
    if ca.SX(value).numel() != size:
        raise DeclarationError(f"{name} must have {size} entries, got {ca.SX(value).numel()}")
