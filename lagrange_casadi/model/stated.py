"""Laws and equations of a mechanism as they were stated, for certificates: functions of what they
measure, time and parameters.

They are made from the declared expressions alone. Nothing here comes from the derivation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.scalars import column
from ..base.symbolic import Graphs, symbolic
from .mechanism import Mechanism
from .meshes import Mesh, Transmission, Wrench
from .motion import Motion
from .parts import Constraint, Force, Friction, LineLoad, Point, Row, Spring, Torque

Triple = tuple[float, float, float]
"""A vector in plain numbers."""

EntryKind = Literal["coordinate", "x", "y", "z", "direction"]

LoadKind = Literal["force", "torque", "spring", "lineload"]

_ORIGIN = (0.0, 0.0, 0.0)

_COMPONENTS: tuple[EntryKind, ...] = ("x", "y", "z")

_WRENCHES = 8
"""The vectors of a mesh: two places, and force and couple of three wrenches."""


@dataclass(frozen=True)
class Entry:
    """One number that is measured: a joint's coordinate, x, y or z of a point of a body, or a
    link's direction.
    """

    kind: EntryKind
    part: str
    point: Triple


@dataclass(frozen=True, eq=False)
class Touch:
    """A mesh as numbers: the bodies' names, places in the carrier's axes, and forces and couples
    for units of lambda and of s.

    Of its friction, ``loss`` are the arm and the lean, and ``rotations`` the coordinates whose
    rates it follows, with their signs.
    """

    first: str
    second: str
    carrier: str
    centre: Triple
    reach: Triple
    along: tuple[Triple, Triple]
    apart: tuple[Triple, Triple]
    braking: tuple[Triple, Triple]
    slack: float
    loss: tuple[float, float]
    rotations: tuple[tuple[int, str], ...]


@dataclass(frozen=True, eq=False)
class _Measured:
    """A number that is measured: its kind and part, the place on a body, and the symbols of its
    place and rate.
    """

    kind: EntryKind
    part: str
    point: tuple[Any, ...] = _ORIGIN
    place: Any = field(default_factory=lambda: ca.SX.sym("place"))
    rate: Any = field(default_factory=lambda: ca.SX.sym("rate"))


@dataclass(frozen=True, eq=False)
class Entries(Graphs):
    """Numbers that are measured, by kind and part; ``points(p)`` are their places on bodies, a
    column each.
    """

    each: tuple[tuple[EntryKind, str], ...]
    points: ca.Function

    @classmethod
    def of(cls, found: Sequence[_Measured], p: Expression) -> Entries:
        """Make it from symbols."""
        points = ca.horzcat(ca.SX(3, 0), *(ca.vertcat(*one.point) for one in found))
        return cls(
            tuple((one.kind, one.part) for one in found),
            ca.Function("points", [p], [ca.densify(points)]),
        )

    def at(self, p: Sequence[float]) -> tuple[Entry, ...]:
        """Evaluate it for values of all parameters."""
        points = self.points(list(p)).full().T.tolist()
        return tuple(
            Entry(*one, tuple(point)) for one, point in zip(self.each, points, strict=True)
        )


@dataclass(frozen=True, eq=False)
class EquationGraph(Graphs):
    """A constraint Phi = 0, or a row A q' + b = 0 where ``row``, over what it measures, for any
    parameters.

    ``values(places, rates, accelerations, t, p)`` gives the equation and, of a constraint, its
    first and second total time derivative; ``slopes(places, rates, t, p)`` what it changes by an
    entry: by its place, or of a row by its rate. ``meshes`` name the bodies of a transmission, and
    ``wrenches(p)`` are the numbers of a :class:`Touch`, a column each.
    """

    name: str
    row: bool
    entries: Entries
    values: ca.Function
    slopes: ca.Function
    meshes: tuple[tuple[str, str, str], ...]
    rotations: tuple[tuple[int, str], ...]
    wrenches: ca.Function

    @classmethod
    def of(cls, mechanism: Mechanism, declared: Constraint | Row) -> EquationGraph:
        """The graph of one equation of a mechanism, from the expressions as they were declared."""
        row = isinstance(declared, Row)
        expression = ca.SX(declared.expression if isinstance(declared, Row) else declared.phi)
        transmission = None if isinstance(declared, Row) else declared.transmission
        return cls._over(
            mechanism, declared.name, expression, _seen(mechanism, expression), row, transmission
        )

    @classmethod
    def driven(
        cls, mechanism: Mechanism, coordinate: str, moved: _Measured, law: Motion
    ) -> EquationGraph:
        """A prescribed motion, of a joint, a point or a body, as the equation that what is
        ``moved`` is where its law says.
        """
        gap = moved.place - law.graph(mechanism.time)
        return cls._over(mechanism, coordinate, gap, [moved], False, None)

    @classmethod
    def _over(
        cls,
        mechanism: Mechanism,
        name: str,
        expression: ca.SX,
        found: Sequence[_Measured],
        row: bool,
        transmission: Transmission | None,
    ) -> EquationGraph:
        places, rates = _columns(found)
        accelerations = ca.SX.sym("accelerations", len(found))
        t, p = mechanism.time, mechanism.symbols
        moving, speed = ca.vertcat(places, rates, t), ca.vertcat(rates, accelerations, 1)
        changes = [expression]
        for _ in range(0 if row else 2):
            changes.append(ca.jtimes(changes[-1], moving, speed))
        slopes = ca.densify(ca.jacobian(expression, rates if row else places).T)
        meshes = transmission.meshes if transmission else ()
        wrenches = ca.horzcat(
            ca.SX(3 * _WRENCHES + 3, 0),
            *(_numbers(transmission, mesh) for mesh in meshes if transmission),
        )
        rotations = (
            transmission.loss.rotations
            if transmission is not None and transmission.loss is not None
            else ()
        )
        return cls(
            name=name,
            row=row,
            entries=Entries.of(found, p),
            values=ca.Function(
                "values", [places, rates, accelerations, t, p], [ca.densify(ca.vertcat(*changes))]
            ),
            slopes=ca.Function("slopes", [places, rates, t, p], [slopes]),
            meshes=tuple(
                (mesh.first.body.name, mesh.second.body.name, mesh.carrier.name) for mesh in meshes
            ),
            rotations=tuple((sign, joint.name) for sign, joint in rotations),
            wrenches=ca.Function("wrenches", [p], [ca.densify(wrenches)]),
        )

    def at(self, p: tuple[float, ...]) -> Equation:
        """The equation for values of all parameters."""
        touches = (
            self._touch(names, row)
            for names, row in zip(
                self.meshes, self.wrenches(list(p)).full().T.tolist(), strict=True
            )
        )
        return Equation(self, p, self.entries.at(p), tuple(touches))

    def _touch(self, names: tuple[str, str, str], row: list[float]) -> Touch:
        centre, reach, *parts = (
            (row[k], row[k + 1], row[k + 2]) for k in range(0, 3 * _WRENCHES, 3)
        )
        along, apart, braking = ((parts[k], parts[k + 1]) for k in (0, 2, 4))
        slack, arm, lean = row[3 * _WRENCHES :]
        return Touch(
            *names, centre, reach, along, apart, braking, slack, (arm, lean), self.rotations
        )


@dataclass(frozen=True, eq=False)
class Equation:
    """An equation for values ``p`` of all parameters; of a transmission, ``touches`` say how its
    multiplier acts.
    """

    graph: EquationGraph
    p: tuple[float, ...]
    entries: tuple[Entry, ...]
    touches: tuple[Touch, ...]

    @property
    def name(self) -> str:
        """The name of the constraint or row."""
        return self.graph.name

    @property
    def row(self) -> bool:
        """True if it is a non-holonomic row."""
        return self.graph.row

    def at(self, places: Array, rates: Array, accelerations: Array, t: Array) -> Array:
        """The equation over instants and, of a constraint, its derivatives: a row each, from
        entries (entries, t).
        """
        return np.asarray(
            self.graph.values(places, rates, accelerations, t[None], list(self.p)).full()
        )

    def slopes_at(self, places: Array, rates: Array, t: Array) -> Array:
        """Derivatives by each entry, (entries, t)."""
        return np.asarray(self.graph.slopes(places, rates, t[None], list(self.p)).full())


@dataclass(frozen=True, eq=False)
class LoadGraph(Graphs):
    """The law of a load over what it measures, for any parameters: its numbers are ``values(places,
    rates, t, p)``.

    A force and a torque have three; a spring its stiffness, length and damping; a load along a link
    the length on which it acts, and three for each power of its polynomial. They are on the body's
    own axes where ``turning``, else on those of the ground.
    """

    name: str
    kind: LoadKind
    turning: bool
    entries: Entries
    values: ca.Function

    @classmethod
    def of(cls, mechanism: Mechanism, load: Force | Torque | Spring | LineLoad) -> LoadGraph:
        """The law of a load, from the expressions as they were declared."""
        kind, coefficients = _kind_and_numbers(load)
        numbers = ca.densify(ca.vertcat(*map(ca.SX, coefficients)))
        found = _seen(mechanism, numbers)
        given = [*_columns(found), mechanism.time, mechanism.symbols]
        turning = getattr(load, "turning", False)
        return cls(
            load.name,
            kind,
            turning,
            Entries.of(found, mechanism.symbols),
            ca.Function("values", given, [numbers]),
        )

    def at(self, p: tuple[float, ...]) -> LoadLaw:
        """The law for values of all parameters."""
        return LoadLaw(self, p, self.entries.at(p))


@dataclass(frozen=True, eq=False)
class LoadLaw:
    """The law of a load for values ``p`` of all parameters."""

    graph: LoadGraph
    p: tuple[float, ...]
    entries: tuple[Entry, ...]

    @property
    def name(self) -> str:
        """The load's name."""
        return self.graph.name

    def at(self, places: Array, rates: Array, t: Array) -> Array:
        """Numbers over instants, a row each, from entries (entries, t)."""
        return np.asarray(self.graph.values(places, rates, t[None], list(self.p)).full())


@dataclass(frozen=True, eq=False)
class Stated:
    """All that was stated of a mechanism: its constraints and then its rows, its motions, and the
    laws of its loads.
    """

    equations: tuple[EquationGraph, ...]
    motions: tuple[EquationGraph, ...]
    laws: tuple[LoadGraph, ...]

    @classmethod
    @symbolic
    def of(cls, mechanism: Mechanism, motions: Mapping[str, Motion]) -> Stated:
        """Declared facts of a mechanism whose coordinates, those of guides too, have ``motions``.

        Friction has a law of its own.
        """
        stated: tuple[Constraint | Row, ...] = (
            *mechanism.constraints.values(),
            *mechanism.rows.values(),
        )
        coordinates = mechanism.coordinates
        return cls(
            equations=tuple(EquationGraph.of(mechanism, one) for one in stated),
            motions=tuple(
                EquationGraph.driven(
                    mechanism, name, _moved(mechanism, name, joint=name in coordinates), law
                )
                for name, law in motions.items()
            ),
            laws=tuple(
                LoadGraph.of(mechanism, load)
                for load in mechanism.loads.values()
                if not isinstance(load, Friction)
            ),
        )


def _seen(mechanism: Mechanism, expression: ca.SX) -> list[_Measured]:
    """Measured symbols in an expression."""
    return [
        one
        for one in _measured(mechanism)
        if any(ca.depends_on(expression, symbol) for symbol in (one.place, one.rate))
    ]


def _measured(mechanism: Mechanism) -> Iterator[_Measured]:
    for measure in mechanism.measures.asked:
        of = measure.of
        if isinstance(of, Point):
            for component, place, rate in zip(
                _COMPONENTS, measure.places, measure.rates, strict=False
            ):
                yield _Measured(component, of.body.name, of.place, place, rate)
        elif measure.axis is not None:
            yield _Measured(
                "coordinate", measure.axis.coordinate, _ORIGIN, measure.places[0], measure.rates[0]
            )
        else:
            yield _Measured("direction", of.name, _ORIGIN, measure.places[0], measure.rates[0])


def _moved(mechanism: Mechanism, coordinate: str, *, joint: bool) -> _Measured:
    """Coordinate that a motion moves: of a joint, or, for a guide, of a point or of a body."""
    if joint:
        return _Measured("coordinate", coordinate)
    name, _, what = coordinate.rpartition(".")
    if what == "angle":
        return _Measured("direction", name)
    point = (
        mechanism.paths[name].point
        if name in mechanism.paths
        else Point(mechanism.bodies[name], 0.0, 0.0)
    )
    return _Measured("x" if what == "x" else "y", point.body.name, point.place)


def _columns(found: Iterable[_Measured]) -> tuple[ca.SX, ca.SX]:
    places, rates = (
        zip(*((one.place, one.rate) for one in found), strict=True) if found else ((), ())
    )
    return column(places), column(rates)


def _kind_and_numbers(
    load: Force | Torque | Spring | LineLoad,
) -> tuple[LoadKind, Sequence[Expression]]:
    """The kind of a load, and its numbers."""
    if isinstance(load, Spring):
        return "spring", (load.stiffness, load.length, load.damping)
    if isinstance(load, LineLoad):
        return "lineload", (
            load.reach,
            *(x for power in zip(load.x, load.y, load.z, strict=True) for x in power),
        )
    return ("force" if isinstance(load, Force) else "torque"), load.components


def _numbers(transmission: Transmission, mesh: Mesh) -> ca.SX:
    """The numbers of a mesh as one column, for :meth:`EquationGraph._touch`."""
    wrenches = (wrench or Wrench() for wrench in (mesh.along, mesh.apart, mesh.braking))
    vectors = [
        mesh.centre,
        mesh.reach,
        *(vector for wrench in wrenches for vector in (wrench.force, wrench.couple)),
    ]
    loss = (
        (0.0, 0.0) if transmission.loss is None else (transmission.loss.arm, transmission.loss.lean)
    )
    return ca.vertcat(*(ca.SX(x) for vector in vectors for x in vector), transmission.slack, *loss)
