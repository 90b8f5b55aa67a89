"""The Lagrange terms of any system, by automatic differentiation of its kinetic energy and force
function.

The equations are those of Nguyen, Petre, Stroe, *Application of Lagrange equations for calculus of
internal forces in a mechanism*, eq. (10)-(13): with E the kinetic energy, U the force function (the
negative of the potential energy), Q* the other generalized forces, and U_Phi = sum lambda_i Phi_i
for constraints Phi = 0,

    R = d/dt(dE/dq') - dE/dq - dU/dq - dU_Phi/dq - Q*.

Along the coordinates R is the effort that the motion needs (zero where nothing drives); along an
extra mobility, taken at rest, it is the internal force that the mobility would release.

Where E is written in velocities w = dx/dt of places x(q) (of points in axes at rest, of angles),
half of R cancels the other half: dw/dq' = dx/dq, so d/dt(dw/dq') = dw/dq, and by the chain rule

    d/dt(dE/dq') - dE/dq = (dw/dq')' d/dt(dE/dw) + d/dt((dw/dq')') dE/dw - (dw/dq)' dE/dw =
    (dw/dq')' d/dt(dE/dw).

Then nothing is differentiated but E by w, and one reverse sweep of w by the rates does the rest:
forces on w, and fields, too. All this holds too where places and energies depend on time itself, as
those of a pivot that is moved: d/dt is the total derivative.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca

from ..base.arguments import Graph, public
from ..base.arrays import Expression
from ..base.brief import Brief
from ..base.scalars import entries
from ..errors import DeclarationError
from .integrability import Course, no_rates

_SYMBOLS = (
    "coordinates",
    "rates",
    "accelerations",
    "mobilities",
    "mobility_rates",
    "multipliers",
    "velocities",
)
_TIMES = ("t", "time")


def _none() -> ca.SX:
    return ca.SX(0, 1)


@public
@dataclass(frozen=True, eq=False, repr=False)
class LagrangeSystem(Brief):
    """A system given by its energy: CasADi SX graphs over symbols.

    Parameters
    ----------
    kinetic, force_function
        E(p, q', e, e', w) [J] and U(p, e) [J], scalars.
    rates, accelerations
        Symbols of q' and q'', columns of n.
    coordinates
        Symbols p in which E and U are written: by default the n coordinates q themselves.
    tangent, drift
        The matrix T(p, t) and the column r(p, t) of p' = T q' + r, where p is more convenient than
        q: a rotation carried as p = (cos q, sin q) has T = (-p[1], p[0]), and no sine is ever
        taken; p = (cos(q + W t), sin(q + W t)) has r = W T as well. The defaults are the identity
        and zero.
    coordinate_rates
        p' itself, in place of T and r: a graph that is linear in q', shorter than T where many
        rates move each of p.
    mobilities, mobility_rates
        Symbols e and e' of extra mobilities, columns of k. To first order in e is enough, and where
        only velocities depend on them, e may be left out.
    forces, mobility_forces
        Q*, columns of n and k; zero by default.
    constraints, multipliers
        Phi(p, e), a column of c, and the symbols lambda of their multipliers.
    velocities, velocity_graphs
        Symbols w in which E may be written, and w(p, q', e, e', t) itself: rates of places and
        angles, so in axes at rest. Where only forces work along one, it may be any velocity.
    velocity_rates
        w' at e = e' = 0, less the acceleration of a field like gravity where U leaves it out; by
        default w differentiated.
    velocity_forces
        Forces that do work along w, zero by default: of loads, and of multipliers where Phi leaves
        them out.
    time
        The symbol t, where any graph depends on time itself. A symbol that is none of all these is
        a parameter and does not change.

    Raises
    ------
    DeclarationError
        If the columns do not fit each other, or an expression has symbols that may not be in it;
        for w that are no rates of positions, and for p that are no functions of coordinates with
        the rates q', which are checked at random points and named by number; and if E, w, T or r
        depend on a symbol called t or time, and no ``time`` is given.
    """

    kinetic: Graph
    force_function: Graph
    coordinates: Graph
    rates: Graph
    accelerations: Graph
    tangent: Graph | None = None
    mobilities: Graph = field(default_factory=_none)
    mobility_rates: Graph = field(default_factory=_none)
    forces: Graph | None = None
    mobility_forces: Graph | None = None
    constraints: Graph = field(default_factory=_none)
    multipliers: Graph = field(default_factory=_none)
    velocities: Graph = field(default_factory=_none)
    velocity_graphs: Graph = field(default_factory=_none)
    velocity_rates: Graph | None = None
    velocity_forces: Graph | None = None
    drift: Graph | None = None
    time: Graph | None = None
    coordinate_rates: Graph | None = None

    def __post_init__(self) -> None:
        n, p, k = self.rates.numel(), self.coordinates.numel(), self.mobility_rates.numel()
        for name in _SYMBOLS:
            if not getattr(self, name).is_valid_input():
                raise DeclarationError(f"{name} must be symbols, got {getattr(self, name)}")
        if self.time is not None and not (
            isinstance(self.time, ca.SX) and self.time.is_symbolic() and self.time.numel() == 1
        ):
            raise DeclarationError(f"time must be one symbol, got {self.time}")
        self._check_roles()
        velocities = self.velocities.numel()
        sizes = {
            "kinetic": 1,
            "force_function": 1,
            "accelerations": n,
            "mobility_rates": self.mobilities.numel() or k,
            "multipliers": ca.SX(self.constraints).numel(),
            "velocity_graphs": velocities,
            "forces": n,
            "mobility_forces": k,
            "velocity_rates": velocities,
            "velocity_forces": velocities,
            "drift": p,
            "coordinate_rates": p,
        }
        for name, size in sizes.items():
            graph = getattr(self, name)
            if graph is not None and ca.SX(graph).numel() != size:
                raise DeclarationError(
                    f"{name} must have {size} entries, got {ca.SX(graph).numel()}"
                )
        if self.tangent is None and self.coordinate_rates is None and p != n:
            raise DeclarationError(
                f"{p} coordinates and {n} rates: set 'tangent', the derivatives of coordinates by"
                " the rates"
            )
        if self.tangent is not None and ca.SX(self.tangent).shape != (p, n):
            raise DeclarationError(
                f"tangent must have shape {(p, n)}, got {ca.SX(self.tangent).shape}"
            )
        if self.coordinate_rates is not None and (
            self.tangent is not None or self.drift is not None
        ):
            raise DeclarationError(
                "coordinate_rates cannot be combined with tangent and drift; leave one of them out"
            )
        if self.coordinate_rates is not None and not ca.is_linear(
            ca.SX(self.coordinate_rates), self.rates
        ):
            raise DeclarationError("coordinate_rates must be linear in the rates")
        self._check_graphs()
        self._check_rates()

    def _check_roles(self) -> None:
        """Raise for a symbol that is to be two things."""
        known: dict[int, str] = {}
        for name in (*_SYMBOLS, "time"):
            symbols = getattr(self, name)
            for symbol in () if symbols is None else entries(symbols):
                if symbol.element_hash() in known:
                    raise DeclarationError(
                        f"symbol '{symbol}' stands both in {known[symbol.element_hash()]} and in"
                        f" {name}"
                    )
                known[symbol.element_hash()] = name

    def _check_graphs(self) -> None:
        """Raise for a graph that depends on what it may not, and for a time that is not said to be
        one.
        """
        accelerations = ("accelerations",)
        others = ("rates", "mobility_rates", "velocities", *accelerations)
        barred = {
            "kinetic": accelerations,
            "force_function": others,
            "constraints": others,
            "tangent": others,
            "drift": others,
            "coordinate_rates": ("mobility_rates", "velocities", *accelerations),
            "velocity_graphs": ("velocities", *accelerations),
        }
        for name, kinds in barred.items():
            graph = ca.vec(ca.SX(0 if getattr(self, name) is None else getattr(self, name)))
            for kind in kinds:
                if ca.depends_on(graph, getattr(self, kind)):
                    advice = (
                        "; move such terms into 'forces'"
                        if name == "force_function" and kind != "accelerations"
                        else ""
                    )
                    raise DeclarationError(
                        f"{name} must not depend on {kind.replace('_', ' ')}{advice}"
                    )
            # Only what is differentiated goes wrong where time is taken for a parameter.
            fixed = name in ("force_function", "constraints") or (
                name == "velocity_graphs" and self.velocity_rates is not None
            )
            for symbol in ca.symvar(graph) if self.time is None and not fixed else ():
                if symbol.name() in _TIMES:
                    raise DeclarationError(
                        f"{name} depends on '{symbol}': set time={symbol} if it is the time, else"
                        " rename the parameter"
                    )

    def _check_rates(self) -> None:
        """Raise for coordinates, or velocities, that are no functions' rates."""
        course = self._course
        carried = {
            "coordinate_rates": self.coordinate_rates,
            "tangent": self.tangent,
            "drift": self.drift,
        }
        named = " and ".join(name for name, graph in carried.items() if graph is not None)
        wrong = no_rates(course.coordinate_rates, course, _none(), _none()) if named else []
        if wrong:
            raise DeclarationError(
                f"{named}: {_listed('coordinate', wrong)} not integrable to coordinates; the"
                " angular velocity of a body in space, for example, is not the rate of coordinates"
            )
        # Along what bears no energy, forces do work whatever it is.
        symbols = {symbol.element_hash() for symbol in ca.symvar(ca.SX(self.kinetic))}
        bearing = [
            k
            for k, velocity in enumerate(self.velocities.nonzeros())
            if velocity.element_hash() in symbols
        ]
        rates_given = no_rates(
            ca.SX(self.velocity_graphs)[bearing], course, self.mobilities, self.mobility_rates
        )
        wrong = [bearing[k] for k in rates_given]
        if wrong:
            late = "" if self.time is not None else ", or it depends on time and 'time' is not set"
            raise DeclarationError(
                f"velocity_graphs: {_listed('velocity', wrong)} not integrable, not the rate of a"
                f" position or angle in fixed axes: d/dt(dw/dq') differs from dw/dq{late}; for a"
                " body that rotates in space use the velocities of points or axes in place of its"
                " angular velocity"
            )

    @property
    def _course(self) -> Course:
        time = ca.SX(0, 1) if self.time is None else self.time
        speed = self.coordinate_rates
        if speed is None:
            speed = self.rates if self.tangent is None else ca.SX(self.tangent) @ self.rates
            speed = speed if self.drift is None else speed + self.drift
        return Course(self.coordinates, self.rates, self.accelerations, time, ca.SX(speed))

    def terms(self) -> tuple[ca.SX, ca.SX]:
        """R along the coordinates (n) and along the mobilities (k), at e = e' = e'' = 0, as CasADi
        SX columns.

        Each entry has the unit of E over that of its coordinate: N along a length, N m along an
        angle. Along a coordinate R is the effort that the motion needs. Along a mobility it is the
        internal force on what the mobility moves (paper eq. 13, 20): where the mobility stretches a
        rope, minus the tension.

        The cost is a small multiple of E's, whatever n and k: one reverse sweep of E, one forward
        sweep of its result, and one reverse sweep of the velocities.
        """
        n, p, k = self.rates.numel(), self.coordinates.numel(), self.mobility_rates.numel()
        course = self._course
        energies = self.kinetic + self.force_function + ca.dot(self.multipliers, self.constraints)
        rates = ca.vertcat(self.rates, self.mobility_rates)
        slopes = self._at_rest(
            ca.gradient(energies, ca.vertcat(self.coordinates, self.mobilities, rates))
        )
        by_place, by_mobility, momenta = ca.vertsplit(
            slopes, [0, p, p + self.mobilities.numel(), slopes.numel()]
        )
        # What several velocities share, they share by name, so that the reverse sweep adds up the
        # forces that meet there first.
        w, graphs = self.velocities, ca.cse(ca.SX(self.velocity_graphs))
        known = self._at_rest(graphs)
        # The mobilities stay at rest: neither e nor e' moves in the total time derivative of the
        # momenta.
        w_change = (
            course.derivative(known)
            if self.velocity_rates is None
            else self._at_rest(self.velocity_rates)
        )
        # E by w twice, not its gradient once: for a sum of squares CasADi then leaves no factor 2
        # beside a half.
        hessian, by_velocity = ca.hessian(ca.SX(self.kinetic), w)
        forces = hessian @ w_change + course.derivative(by_velocity)
        if self.velocity_forces is not None:
            forces -= self.velocity_forces
        terms = (
            course.derivative(momenta)
            + ca.jtimes(momenta, w, w_change)
            + self._at_rest(ca.jtimes(graphs, rates, forces, True))
        )
        terms -= ca.vertcat(
            course.along_rates(by_place), by_mobility if self.mobilities.numel() else ca.SX.zeros(k)
        )
        along, across = ca.vertsplit(ca.substitute(terms, w, known), [0, n, n + k])
        if self.forces is not None:
            along -= self.forces
        if self.mobility_forces is not None:
            across -= self.mobility_forces
        return along, across

    def _at_rest(self, expression: Expression) -> ca.SX:
        resting = ca.vertcat(self.mobilities, self.mobility_rates)
        return ca.substitute(ca.SX(expression), resting, ca.SX.zeros(resting.numel()))


def _listed(what: str, numbers: Sequence[int]) -> str:
    """Entries by number, with the verb."""
    plural = f"{what[:-1]}ies" if what.endswith("y") else f"{what}s"
    named = ", ".join(map(str, numbers))
    return (
        f"{what} {named} (counted from 0) is"
        if len(numbers) == 1
        else f"{plural} {named} (counted from 0) are"
    )
