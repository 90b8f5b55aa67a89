"""The Lagrange terms of any system, by automatic differentiation of its kinetic energy and force function.

The equations are those of Nguyen, Petre, Stroe, *Application of Lagrange equations for calculus of internal forces in a
mechanism*, eq. (10)-(13): with E the kinetic energy, U the force function (the negative of the potential energy), Q* the other
generalized forces, and U_Phi = sum lambda_i Phi_i for constraints Phi = 0,

    R = d/dt(dE/dq') - dE/dq - dU/dq - dU_Phi/dq - Q*.

Along the coordinates R is the effort that the motion needs (zero where nothing drives); along an extra mobility, taken at
rest, it is the internal force that the mobility would release.

Where E is written in velocities w = dx/dt of places x(q) (of points in axes at rest, of angles), half of R cancels the other
half: dw/dq' = dx/dq, so d/dt(dw/dq') = dw/dq, and by the chain rule

    d/dt(dE/dq') - dE/dq = (dw/dq')' d/dt(dE/dw) + d/dt((dw/dq')') dE/dw - (dw/dq)' dE/dw = (dw/dq')' d/dt(dE/dw).

Then nothing is differentiated but E by w, and one reverse sweep of w by the rates does the rest: forces on w, and fields, too.
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
        E(p, q', e, e', w) [J] and U(p, e) [J], scalars.
    rates, accelerations
        Symbols of q' and q'', columns of n.
    coordinates
        Symbols p in which E and U are written: by default the n coordinates q themselves.
    tangent
        The matrix T(p) of p' = T q', where p is more convenient than q: a rotation carried as p = (cos q, sin q) has
        T = (-p[1], p[0]), and no sine is ever taken. The default is the identity.
    mobilities, mobility_rates
        Symbols e and e' of extra mobilities, columns of k. To first order in e is enough, and where only velocities depend on
        them, e may be left out.
    forces, mobility_forces
        Q*, columns of n and k; zero by default.
    constraints, multipliers
        Phi(p, e), a column of c, and the symbols lambda of their multipliers.
    velocities, velocity_graphs
        Symbols w in which E may be written, and w(p, q', e, e') itself: rates of places and angles, so in axes at rest.
    velocity_rates
        w' at e = e' = 0, less the acceleration of a field like gravity where U leaves it out; by default w differentiated.
    velocity_forces
        Forces that do work along w, zero by default: of loads, and of multipliers where Phi leaves them out.

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
    velocities: Any = field(default_factory=_none)
    velocity_graphs: Any = field(default_factory=_none)
    velocity_rates: Any = None
    velocity_forces: Any = None

    def __post_init__(self) -> None:
        n, p, k = self.rates.numel(), self.coordinates.numel(), self.mobility_rates.numel()
        for name in ("coordinates", "rates", "accelerations", "mobilities", "mobility_rates", "multipliers", "velocities"):
            if not getattr(self, name).is_valid_input():
                raise DeclarationError(f"{name} must be symbols, got {getattr(self, name)}")
        _expect("kinetic", self.kinetic, 1)
        _expect("force_function", self.force_function, 1)
        _expect("accelerations", self.accelerations, n)
        if self.mobilities.numel():
            _expect("mobility_rates", self.mobility_rates, self.mobilities.numel())
        _expect("multipliers", self.multipliers, ca.SX(self.constraints).numel())
        _expect("velocity_graphs", self.velocity_graphs, self.velocities.numel())
        sizes = {"forces": n, "mobility_forces": k, "velocity_rates": self.velocities.numel()}
        for name, size in (sizes | {"velocity_forces": self.velocities.numel()}).items():
            if getattr(self, name) is not None:
                _expect(name, getattr(self, name), size)
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

        One reverse sweep of E and one forward sweep of its result, and one reverse sweep of the velocities, whatever n and k, so
        the cost is a small multiple of E's.
        """
        n, p, k = self.rates.numel(), self.coordinates.numel(), self.mobility_rates.numel()
        tangent = ca.SX.eye(n) if self.tangent is None else ca.SX(self.tangent)
        energies = self.kinetic + self.force_function + ca.dot(self.multipliers, self.constraints)
        rates = ca.vertcat(self.rates, self.mobility_rates)
        slopes = self._at_rest(ca.gradient(energies, ca.vertcat(self.coordinates, self.mobilities, rates)))
        by_place, by_mobility, momenta = ca.vertsplit(slopes, [0, p, p + self.mobilities.numel(), slopes.numel()])
        # The mobilities stay at rest: neither e nor e' moves in the total time derivative of the momenta.
        state, change = ca.vertcat(self.coordinates, self.rates), ca.vertcat(tangent @ self.rates, self.accelerations)
        # What several velocities share, they share by name, so that the reverse sweep adds up the forces that meet there first.
        w, graphs = self.velocities, ca.cse(ca.SX(self.velocity_graphs))
        seen = self._at_rest(graphs)
        w_change = ca.jtimes(seen, state, change) if self.velocity_rates is None else self._at_rest(self.velocity_rates)
        state, change = ca.vertcat(state, w), ca.vertcat(change, w_change)
        # E by w twice, not its gradient once: for a sum of squares CasADi then leaves no factor 2 beside a half.
        hessian, by_velocity = ca.hessian(ca.SX(self.kinetic), w)
        forces = hessian @ w_change + ca.jtimes(by_velocity, state[: p + n], change[: p + n])
        if self.velocity_forces is not None:
            forces -= self.velocity_forces
        terms = ca.jtimes(momenta, state, change) + self._at_rest(ca.jtimes(graphs, rates, forces, True))
        terms -= ca.vertcat(tangent.T @ by_place, by_mobility if self.mobilities.numel() else ca.SX.zeros(k))
        along, across = ca.vertsplit(ca.substitute(terms, w, seen), [0, n, n + k])
        if self.forces is not None:
            along -= self.forces
        if self.mobility_forces is not None:
            across -= self.mobility_forces
        return along, across

    def _at_rest(self, expression: Any) -> Any:
        resting = ca.vertcat(self.mobilities, self.mobility_rates)
        return ca.substitute(ca.SX(expression), resting, ca.SX.zeros(resting.numel()))


def _expect(name: str, value: Any, size: int) -> None:
    if ca.SX(value).numel() != size:
        raise DeclarationError(f"{name} must have {size} entries, got {ca.SX(value).numel()}")
