"""Laws and equations of a mechanism as they were stated, for certificates: functions of what they
measure, time and parameters.

They are made from the declared expressions alone. Nothing here comes from the derivation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import casadi as ca
import numpy as np

from ..base.arrays import Array, Expression
from ..base.scalars import called, column, entries
from ..base.symbolic import Graphs, symbolic
from ..base.templates import Template
from ..base.vectors import ZERO
from .declared_parts import Point
from .description import Triple
from .guiding import point_of
from .loads import Force, Friction, LineLoad, Spring, Torque
from .mechanism import Mechanism
from .meshes import Transmission, Wrench
from .motion_laws import Motion

EntryKind = Literal["coordinate", "x", "y", "z", "direction"]

_COMPONENTS: tuple[EntryKind, ...] = ("x", "y", "z")


@dataclass(frozen=True)
class Entry:
    """One number that is measured: a joint's coordinate, x, y or z of a point of a body, or a
    link's direction.
    """

    kind: EntryKind
    part: str
    point: Triple = ZERO


@dataclass(frozen=True, eq=False)
class Touch:
    """A mesh as numbers: the bodies' names, places in the carrier's axes, and forces and couples
    for units of lambda and of s over instants, which :meth:`Equation.touching` puts in.

    Of its friction, ``loss`` are the arm and the lean, and ``rotations`` the coordinates whose
    rates it follows, with their signs.
    """

    first: str
    second: str
    carrier: str
    slack: float
    loss: tuple[float, float]
    rotations: tuple[tuple[int, str], ...]
    centre: Any = None
    reach: Any = None
    along: Any = None
    apart: Any = None
    braking: Any = None


@dataclass(frozen=True, eq=False)
class _Measured:
    """An entry, and the symbols of its place and rate."""

    entry: Entry
    place: Any = field(default_factory=lambda: ca.SX.sym("place"))
    rate: Any = field(default_factory=lambda: ca.SX.sym("rate"))


@dataclass(frozen=True, eq=False)
class Equation(Graphs):
    """A constraint Phi = 0, or a row A q' + b = 0 where ``row``, over what it measures, for values
    ``p`` of all parameters; of a transmission, ``touches`` say how its multiplier acts.

    ``values(places, rates, accelerations, t, p)`` gives the equation and, of a constraint, its
    first and second total time derivative; ``slopes(places, rates, t, p)`` what it changes by an
    entry: by its place, or of a row by its rate. ``wrenches(places, p)`` are those of the touches,
    each after where it acts, in a column.
    """

    name: str
    row: bool
    p: tuple[Any, ...]
    entries: tuple[Entry, ...]
    touches: tuple[Touch, ...]
    wrenches: ca.Function
    values: ca.Function
    slopes: ca.Function

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        name: str,
        expression: ca.SX,
        found: Sequence[_Measured],
        transmission: Transmission | None = None,
        *,
        row: bool = False,
    ) -> Equation:
        """An equation of a mechanism over what is ``found`` in it, from its expression as it was
        declared.
        """
        places, rates = _columns(found)
        accelerations = ca.SX.sym("accelerations", len(found))
        t, p = mechanism.time, mechanism.symbols
        moving, speed = ca.vertcat(places, rates, t), ca.vertcat(rates, accelerations, 1)
        changes = [expression]
        for _ in range(0 if row else 2):
            changes.append(ca.jtimes(changes[-1], moving, speed))
        slopes = ca.densify(ca.jacobian(expression, rates if row else places).T)
        return cls(
            name=name,
            row=row,
            p=(*entries(mechanism.symbols),),
            entries=tuple(one.entry for one in found),
            touches=_touches(transmission),
            wrenches=ca.Function("wrenches", [places, p], [ca.densify(_wrenches(transmission))]),
            values=ca.Function(
                "values", [places, rates, accelerations, t, p], [ca.densify(ca.vertcat(*changes))]
            ),
            slopes=ca.Function("slopes", [places, rates, t, p], [slopes]),
        )

    def touching(self, moved: Callable[[], Array]) -> Iterator[Touch]:
        """The touches with what acts there, by the places that entries ``moved`` to, the first
        rows of what they measure.
        """
        if self.touches:
            found = called(self.wrenches, moved()[0], np.c_[[*self.p]])
            each = found.reshape(len(self.touches), 4, 2, 3, -1)
            for touch, ((at, to), along, apart, braking) in zip(self.touches, each, strict=True):
                yield replace(touch, centre=at, reach=to, along=along, apart=apart, braking=braking)

    def at(self, moved: Array, t: Array) -> Array:
        """The equation over instants and, of a constraint, its derivatives: a row each, from the
        places, rates and accelerations of entries, (3, entries, t).
        """
        return called(self.values, *moved, t[None], np.c_[[*self.p]])

    def slopes_at(self, moved: Array, t: Array) -> Array:
        """Derivatives by each entry, (entries, t)."""
        return called(self.slopes, *moved[:2], t[None], np.c_[[*self.p]])


@dataclass(frozen=True, eq=False)
class LoadLaw(Graphs):
    """The law of a load over what it measures, for values ``p`` of all parameters: its numbers are
    ``values(places, rates, t, p)``.

    A force and a torque have three; a spring its stiffness, length and damping; a load along a link
    the length on which it acts, and three for each power of its polynomial.
    """

    name: str
    p: tuple[Any, ...]
    entries: tuple[Entry, ...]
    values: ca.Function

    @classmethod
    def of(cls, mechanism: Mechanism, load: Force | Torque | Spring | LineLoad) -> LoadLaw:
        """The law of a load, from the expressions as they were declared."""
        numbers = ca.densify(ca.vertcat(*map(ca.SX, _coefficients(load))))
        found = _seen(mechanism, numbers)
        given = [*_columns(found), mechanism.time, mechanism.symbols]
        return cls(
            load.name,
            (*entries(mechanism.symbols),),
            tuple(one.entry for one in found),
            ca.Function("values", given, [numbers]),
        )

    def at(self, moved: Array, t: Array) -> Array:
        """Numbers over instants, a row each, from what entries measure, (3, entries, t)."""
        return called(self.values, *moved[:2], t[None], np.c_[[*self.p]])


@dataclass(frozen=True, eq=False)
class Stated:
    """All that was stated of a mechanism: its constraints and then its rows, its motions, and the
    laws of its loads.
    """

    equations: tuple[Equation, ...] = ()
    motions: tuple[Equation, ...] = ()
    laws: tuple[LoadLaw, ...] = ()

    @classmethod
    @symbolic
    def of(cls, mechanism: Mechanism, motions: Mapping[str, Motion]) -> Template[Stated]:
        """Declared facts of a mechanism whose coordinates, those of guides too, have ``motions``,
        for any parameters.

        Friction has a law of its own.
        """
        m, constraints, rows = mechanism, mechanism.constraints, mechanism.rows
        coordinates = m.coordinates
        moved = {
            name: _Measured(Entry("coordinate", name)) if name in coordinates else _guided(m, name)
            for name in motions
        }
        found = cls(
            equations=(
                *(
                    Equation.of(m, name, one.phi, _seen(m, one.phi), one.transmission)
                    for name, one in constraints.items()
                ),
                *(
                    Equation.of(m, name, one.expression, _seen(m, one.expression), row=True)
                    for name, one in rows.items()
                ),
            ),
            motions=tuple(
                Equation.of(m, name, one.place - motions[name].graph(m.time), [one])
                for name, one in moved.items()
            ),
            laws=tuple(
                LoadLaw.of(mechanism, load)
                for load in mechanism.loads.values()
                if not isinstance(load, Friction)
            ),
        )
        return Template.of(found, mechanism.symbols)


NOTHING = Stated()
"""Nothing is known of it, as of a mechanism in a file."""


def _seen(mechanism: Mechanism, expression: ca.SX) -> list[_Measured]:
    """Measured symbols in an expression."""
    return [
        one
        for one in _measured(mechanism)
        if any(ca.depends_on(expression, symbol) for symbol in (one.place, one.rate))
    ]


def _measured(mechanism: Mechanism) -> Iterator[_Measured]:
    for measure in mechanism.measures.asked.values():
        if isinstance(measure.of, Point):
            body, place = measure.of.body.name, measure.of.place
            entries = [Entry(component, body, place) for component in _COMPONENTS]
        elif measure.axis is not None:
            entries = [Entry("coordinate", measure.axis.coordinate)]
        else:
            entries = [Entry("direction", measure.of.name)]
        yield from map(_Measured, entries, measure.places, measure.rates)


def _guided(mechanism: Mechanism, coordinate: str) -> _Measured:
    """Coordinate that the motion of a guide moves, of a point or of a body."""
    name, _, what = coordinate.rpartition(".")
    if what == "angle":
        return _Measured(Entry("direction", name))
    point = point_of(mechanism, name)
    return _Measured(Entry("x" if what == "x" else "y", point.body.name, point.place))


def _columns(found: Sequence[_Measured]) -> tuple[ca.SX, ca.SX]:
    return column(one.place for one in found), column(one.rate for one in found)


def _coefficients(load: Force | Torque | Spring | LineLoad) -> Sequence[Expression]:
    if isinstance(load, Spring):
        return load.stiffness, load.length, load.damping
    if isinstance(load, LineLoad):
        return load.reach, *(x for power in zip(load.x, load.y, load.z, strict=True) for x in power)
    return load.components


def _touches(transmission: Transmission | None) -> tuple[Touch, ...]:
    """The meshes of a transmission in expressions, without wrenches."""
    if transmission is None:
        return ()
    loss = transmission.loss
    rotations = () if loss is None else loss.rotations
    return tuple(
        Touch(
            first=mesh.first.body.name,
            second=mesh.second.body.name,
            carrier=mesh.carrier.name,
            slack=transmission.slack,
            loss=(0.0, 0.0) if loss is None else (loss.arm, loss.lean),
            rotations=tuple((sign, joint.name) for sign, joint in rotations),
        )
        for mesh in transmission.meshes
    )


def _wrenches(transmission: Transmission | None) -> ca.SX:
    """The places and wrenches of a transmission's meshes, in a column."""
    pairs: list[tuple[Any, Any]] = []
    for mesh in () if transmission is None else transmission.meshes:
        pairs += (
            (mesh.centre, mesh.reach),
            _pair(mesh.along),
            _pair(mesh.apart),
            _pair(mesh.braking),
        )
    return column(value for pair in pairs for vector in pair for value in vector)


def _pair(wrench: Wrench | None) -> tuple[Any, Any]:
    return (ZERO, ZERO) if wrench is None else (wrench.force, wrench.couple)
