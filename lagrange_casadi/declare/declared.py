"""A mechanism as its certificate reads it: straight from the declaration, as numbers in space; a plane is z = 0.

Nothing here comes from the derivation, so a wrong derivation cannot hide. An :class:`EquationGraph` serves any values of the
parameters; :class:`Declared` are the numbers for some values.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import casadi as ca
import numpy as np

from ..base.arrays import Array
from ..base.symbolic import Graphs, symbolic
from .description import Description, density_of, drives_of, in_space, motions_of, slices_of
from .mechanism import Mechanism
from .meshes import Mesh, Transmission, Wrench
from .parts import Constraint, Point, Row

Triple = tuple[float, float, float]
"""A vector in plain numbers."""

Rows = tuple[Triple, Triple, Triple]
"""Three directions, or a matrix by its rows."""

EntryKind = Literal["coordinate", "x", "y", "z", "direction"]

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_WRENCHES = 8
"""The vectors of a mesh: two places, and force and couple of three wrenches."""


@dataclass(frozen=True)
class Place:
    """A place on a body, in the body's axes [m]."""

    body: str
    at: Triple


@dataclass(frozen=True)
class BodyNumbers:
    """A body's length [m], None for a point mass; its mass, and its centre and inertia about the centre, in its axes."""

    length: float | None
    mass: float
    centre: Triple = (0.0, 0.0, 0.0)
    inertia: Rows = ((0.0, 0.0, 0.0),) * 3


@dataclass(frozen=True)
class AxisNumbers:
    """A coordinate of a joint by its full name, and its direction in the parent's axes where all coordinates are zero."""

    coordinate: str
    kind: Literal["angle", "slide"]
    direction: Triple


@dataclass(frozen=True)
class JointNumbers:
    """A joint between two places; see :class:`.Joint`.

    ``axes`` are in sequence. The first direction of the ``triad`` is that of the joint's axis. ``turned`` are the child's axes in
    the parent's where all coordinates are zero. ``free`` says whether it turns about an axis of which no coordinate tells.
    """

    kind: str
    parent: Place
    child: Place
    axes: tuple[AxisNumbers, ...]
    triad: Rows
    turned: Rows
    pitch: float = 0.0
    free: bool = False


@dataclass(frozen=True)
class LoadNumbers:
    """The places of a load, the second one bearing the opposite; of a friction its coordinate and its numbers by their words."""

    points: tuple[Place, ...]
    coordinate: str = ""
    friction: Mapping[str, float] | None = None


@dataclass(frozen=True)
class Entry:
    """One number that an equation measures: a joint's coordinate, x, y or z of a point of a body, or a link's direction."""

    kind: EntryKind
    part: str
    point: Triple


@dataclass(frozen=True, eq=False)
class Touch:
    """A mesh as numbers: the bodies' names, places in the carrier's axes, and forces and couples for units of lambda and of s.

    Of its friction, ``loss`` are the arm and the lean, and ``turns`` the coordinates whose rates it follows, with their signs.
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
    turns: tuple[tuple[int, str], ...]


@dataclass(frozen=True, eq=False)
class EquationGraph(Graphs):
    """A constraint Phi = 0, or a row A q' + b = 0 where ``row``, over what it measures, for any parameters.

    ``values(places, rates, accelerations, t, p)`` gives the equation and, of a constraint, its first and second total time
    derivative; ``slopes(places, rates, t, p)`` what it changes by an entry: by its place, or of a row by its rate.
    ``points(p)`` are the places of its entries on their bodies, a column each. ``meshes`` name the bodies of a transmission, and
    ``wrenches(p)`` are the numbers of a :class:`Touch`, a column each.
    """

    name: str
    row: bool
    entries: tuple[tuple[EntryKind, str], ...]
    values: Any
    slopes: Any
    points: Any
    meshes: tuple[tuple[str, str, str], ...]
    turns: tuple[tuple[int, str], ...]
    wrenches: Any

    @classmethod
    def of(cls, mechanism: Mechanism, told: Constraint | Row) -> EquationGraph:
        """The graph of one equation of a mechanism, from the expressions as they were declared."""
        row = isinstance(told, Row)
        expression = ca.SX(told.expression if isinstance(told, Row) else told.phi)
        measured = _entries(mechanism)
        found = [entry for entry in measured if any(ca.depends_on(expression, symbol) for symbol in entry[3:])]
        places = ca.vertcat(ca.SX(0, 1), *(place for *_, place, _ in found))
        rates = ca.vertcat(ca.SX(0, 1), *(rate for *_, rate in found))
        accelerations, t, p = ca.SX.sym("accelerations", len(found)), mechanism.time, mechanism.symbols
        moving, speed = ca.vertcat(places, rates, t), ca.vertcat(rates, accelerations, 1)
        changes = [expression]
        for _ in range(0 if row else 2):
            changes.append(ca.jtimes(changes[-1], moving, speed))
        slopes = ca.densify(ca.jacobian(expression, rates if row else places).T)
        points = ca.horzcat(ca.SX(3, 0), *(ca.vertcat(*point) for _, _, point, _, _ in found))
        transmission = None if isinstance(told, Row) else told.transmission
        meshes = transmission.meshes if transmission else ()
        wrenches = ca.horzcat(ca.SX(3 * _WRENCHES + 3, 0), *(_numbers(transmission, mesh) for mesh in meshes if transmission))
        return cls(
            name=told.name,
            row=row,
            entries=tuple((kind, part) for kind, part, *_ in found),
            values=ca.Function("values", [places, rates, accelerations, t, p], [ca.densify(ca.vertcat(*changes))]),
            slopes=ca.Function("slopes", [places, rates, t, p], [slopes]),
            points=ca.Function("points", [p], [ca.densify(points)]),
            meshes=tuple((mesh.first.body.name, mesh.second.body.name, mesh.carrier.name) for mesh in meshes),
            turns=tuple((sign, joint.name) for sign, joint in _turns(transmission)),
            wrenches=ca.Function("wrenches", [p], [ca.densify(wrenches)]),
        )

    def at(self, p: tuple[float, ...]) -> Equation:
        """The equation for values of all parameters."""
        points = self.points(list(p)).full().T.tolist()
        entries = (Entry(*entry, tuple(point)) for entry, point in zip(self.entries, points, strict=True))
        touches = (
            self._touch(names, row) for names, row in zip(self.meshes, self.wrenches(list(p)).full().T.tolist(), strict=True)
        )
        return Equation(self, p, tuple(entries), tuple(touches))

    def words(self) -> list[Any]:
        """Return the graph for JSON; functions as the text in which CasADi writes them."""
        functions = [function.serialize() for function in (self.values, self.slopes, self.points, self.wrenches)]
        return [self.name, self.row, self.entries, self.meshes, self.turns, *functions]

    @classmethod
    def loads(cls, words: Sequence[Any]) -> EquationGraph:
        """Return the graph that :meth:`words` made words of."""
        name, row, entries, meshes, turns, *functions = words
        values, slopes, points, wrenches = map(ca.Function.deserialize, functions)
        names = (tuple(map(tuple, pairs)) for pairs in (entries, meshes, turns))
        return cls(name, row, next(names), values, slopes, points, next(names), next(names), wrenches)

    def _touch(self, names: tuple[str, str, str], row: list[float]) -> Touch:
        centre, reach, *parts = (tuple(row[k : k + 3]) for k in range(0, 3 * _WRENCHES, 3))
        along, apart, braking = ((parts[k], parts[k + 1]) for k in (0, 2, 4))
        slack, *loss = row[3 * _WRENCHES :]
        return Touch(*names, centre, reach, along, apart, braking, slack, tuple(loss), self.turns)  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class Equation:
    """A constraint or row for values ``p`` of all parameters; of a transmission, ``touches`` say how its multiplier acts."""

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
        """Whether it is a non-holonomic row."""
        return self.graph.row

    def at(self, places: Array, rates: Array, accelerations: Array, t: Array) -> Array:
        """The equation over instants and, of a constraint, its derivatives: a row each, from entries (entries, t)."""
        return np.asarray(self.graph.values(places, rates, accelerations, t[None], list(self.p)).full())

    def slopes_at(self, places: Array, rates: Array, t: Array) -> Array:
        """What it changes by each entry, (entries, t)."""
        return np.asarray(self.graph.slopes(places, rates, t[None], list(self.p)).full())


@dataclass(frozen=True, eq=False)
class Declared:
    """A mechanism in plain numbers, and its constraints and rows as functions of what they measure.

    ``drives`` are the coordinates whose efforts make the motion, ``driven`` those whose motion is given. ``beside`` are the
    directions in ground axes that were declared for y axes of links. ``multipliers`` are the names of all constraints and rows,
    and ``equations`` are these; there are none where they are not known, as of a file.
    """

    gravity: Triple
    bodies: Mapping[str, BodyNumbers]
    joints: Mapping[str, JointNumbers]
    loads: Mapping[str, LoadNumbers]
    drives: tuple[str, ...]
    driven: tuple[str, ...]
    beside: Mapping[str, Triple]
    multipliers: tuple[str, ...]
    equations: tuple[Equation, ...] = ()

    @classmethod
    def of(cls, description: Description, equations: tuple[Equation, ...] = ()) -> Declared:
        """The numbers of a description, which a file holds too."""
        space = in_space(description)
        loads = description["loads"].items()
        return cls(
            gravity=_triple(description["gravity"]),
            bodies={name: _body(body, space) for name, body in description["bodies"].items()},
            joints={name: (_joint if space else _planar_joint)(name, joint) for name, joint in description["joints"].items()},
            loads={name: LoadNumbers(tuple(map(_place, load["points"])), *_friction(load)) for name, load in loads},
            drives=tuple(drives_of(description)),
            driven=tuple(motions_of(description)),
            beside={name: _triple(direction) for name, direction in description.get("beside", {}).items()},
            multipliers=(*description["constraints"], *description["rows"]),
            equations=equations,
        )

    @cached_property
    def size(self) -> float:
        """The length of all links [m]."""
        return sum(body.length or 0.0 for body in self.bodies.values()) or 1.0

    @cached_property
    def extent(self) -> float:
        """The size of the mechanism, and how far from the origin it stands: the largest of places."""
        points = [place for joint in self.joints.values() for place in (joint.parent, joint.child)]
        points += [place for load in self.loads.values() for place in load.points]
        return self.size + max((abs(x) for place in points if place.body == "ground" for x in place.at), default=0.0)

    @cached_property
    def kinds(self) -> dict[str, Literal["angle", "slide"]]:
        """The kinds of all coordinates."""
        return {axis.coordinate: axis.kind for joint in self.joints.values() for axis in joint.axes}

    def oriented(self, body: str) -> bool:
        """Whether a body has a direction, as a point mass has not."""
        return body == "ground" or self.bodies[body].length is not None


@symbolic
def equations_of(mechanism: Mechanism) -> tuple[EquationGraph, ...]:
    """Return the constraints of a mechanism, and then its rows."""
    stated: tuple[Constraint | Row, ...] = (*mechanism.constraints.values(), *mechanism.rows.values())
    return tuple(EquationGraph.of(mechanism, one) for one in stated)


def _entries(mechanism: Mechanism) -> Iterator[tuple[EntryKind, str, tuple[Any, ...], Any, Any]]:
    """All that is measured: its kind and part, the place on a body, and the symbols of its place and rate."""
    components: tuple[EntryKind, ...] = ("x", "y", "z")
    for measure in mechanism.measures.asked:
        of = measure.of
        if isinstance(of, Point):
            for component, place, rate in zip(components, measure.places, measure.rates, strict=False):
                yield component, of.body.name, of.place, place, rate
        elif measure.axis is not None:
            yield "coordinate", measure.axis.coordinate, _ORIGIN, measure.places[0], measure.rates[0]
        else:
            yield "direction", of.name, _ORIGIN, measure.places[0], measure.rates[0]


_ORIGIN = (0.0, 0.0, 0.0)


def _turns(transmission: Transmission | None) -> Any:
    return transmission.loss.turns if transmission is not None and transmission.loss is not None else ()


def _numbers(transmission: Transmission, mesh: Mesh) -> Any:
    """The numbers of a mesh as one column, for :meth:`EquationGraph._touch`."""
    wrenches = (wrench or Wrench() for wrench in (mesh.along, mesh.apart, mesh.braking))
    vectors = [mesh.centre, mesh.reach, *(vector for wrench in wrenches for vector in (wrench.force, wrench.couple))]
    loss = (0.0, 0.0) if transmission.loss is None else (transmission.loss.arm, transmission.loss.lean)
    return ca.vertcat(*(ca.SX(x) for vector in vectors for x in vector), transmission.slack, *loss)


def _triple(vector: Any) -> Triple:
    """A vector of two or three numbers in space."""
    x, y, *z = vector
    return x, y, *(z or (0.0,))


def _rows(matrix: Any) -> Rows:
    """Three rows of three numbers."""
    x, y, z = map(tuple, matrix)
    return x, y, z


def _place(told: Description) -> Place:
    return Place(told["body"], (told["x"], told["y"], told.get("z", 0.0)))


def _body(told: Description, space: bool) -> BodyNumbers:
    length, mass = told["length"], told["mass"]
    if "centre" in told:
        centre = told["centre"]
        inertia = _rows(centre["inertia"]) if space else (_ORIGIN, _ORIGIN, (0.0, 0.0, centre["inertia"]))
        return BodyNumbers(length, mass, (centre["x"], centre["y"], centre.get("z", 0.0)), inertia)
    if length is None or mass == 0.0:
        return BodyNumbers(length, mass)
    _, first, second = (float(tail[0]) for tail in density_of(told).tails(np.zeros(1)))
    middle = first / mass
    across = (second - first * middle) * length**2
    yy, zz, yz = slices_of(told)
    inertia = (yy + zz, 0.0, 0.0), (0.0, across + zz, -yz), (0.0, -yz, across + yy)
    return BodyNumbers(length, mass, (middle * length, 0.0, 0.0), inertia)


def _joint(_: str, told: Description) -> JointNumbers:
    axes = zip(told["coordinates"].items(), told["axes"], strict=True)
    return JointNumbers(
        kind=told["kind"],
        parent=_place(told["parent"]),
        child=_place(told["child"]),
        axes=tuple(AxisNumbers(name, kind, tuple(direction)) for (name, kind), direction in axes),
        triad=_rows(told["triad"]),
        turned=_rows(told["turned"]),
        pitch=told["pitch"],
    )


def _planar_joint(name: str, told: Description) -> JointNumbers:
    """A joint of the plane: what turns does so about z."""
    x, y = told["axis"]
    slides = told["kind"] in ("prismatic", "slot")
    c, s = math.cos(told["angle"]), math.sin(told["angle"])
    axis = [AxisNumbers(name, told["coordinate"], (x, y, 0.0) if slides else _Z)] if told["coordinate"] else []
    return JointNumbers(
        kind=told["kind"],
        parent=_place(told["parent"]),
        child=_place(told["child"]),
        axes=tuple(axis),
        triad=((x, y, 0.0), (-y, x, 0.0), _Z) if slides else (_Z, _X, _Y),
        turned=((c, s, 0.0), (-s, c, 0.0), _Z),
        free=told["kind"] == "slot",
    )


def _friction(told: Description) -> tuple[Any, ...]:
    return (told["friction"]["coordinate"], told["friction"]["numbers"]) if "friction" in told else ()
