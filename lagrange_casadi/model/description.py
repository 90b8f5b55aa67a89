"""A mechanism as one tree of frozen dataclasses. Its leaves are expressions of the parameters, or
their numbers: then a file keeps it, pictures are drawn from it, and a certificate checks against
it.

All of it comes from the declaration and nothing from the derivation, so a wrong derivation cannot
hide. Places and directions have three components; a plane is z = 0.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, TypeAlias

import casadi as ca
import numpy as np

from ..base.arrays import Json
from ..base.brief import Brief
from ..base.quantities import Kinds
from ..base.templates import mapped
from ..base.vectors import ZERO
from .beams.beam import Beam, Notch
from .beams.material import Material
from .beams.shape import Course, Shape
from .declared_parts import Link, PitchCircles, PointMass, RigidMass, Roller, Track
from .declared_parts import Place as Place
from .drives import Drive
from .fitted import Fittings, Pin, Plain, Rolling
from .guiding import kind_of
from .joints import Joint, JointKind
from .link_density import Density, NumericDensity
from .loads import Friction, Load, Spring, Torque
from .mass_properties import mass_of
from .mechanism import Mechanism

Triple: TypeAlias = tuple[float, float, float]
"""A vector."""

Rows: TypeAlias = tuple[Triple, Triple, Triple]
"""Three directions, or a matrix by its rows."""

Pair: TypeAlias = tuple[float, float]

CoordinateKind: TypeAlias = Literal["angle", "slide"]


@dataclass(frozen=True)
class ParameterNumbers:
    """A parameter: its value and its range, in its unit."""

    value: float
    unit: str
    low: float
    high: float


@dataclass(frozen=True, repr=False)
class BodyNumbers(Brief):
    """A body: its length [m], None for a point mass, and its mass [kg].

    A rigid body has a ``centre`` [m] and the ``inertia`` about the centre [kg m^2], on the body's
    axes. A link with sections has a ``density``, and may have a ``beam`` and the second moments yy,
    zz and yz of its ``slices``, each like a density.
    """

    length: float | None
    mass: float
    centre: Triple | None = None
    inertia: Rows | None = None
    density: NumericDensity | None = None
    slices: tuple[NumericDensity, ...] = ()
    beam: Beam | None = None

    @property
    def length_and_density(self) -> tuple[float, NumericDensity]:
        """The length [m] and the density of a link with sections.

        Raises ``ValueError`` for another body.
        """
        if self.length is None or self.density is None:
            raise ValueError("a body without a density has no sections")
        return self.length, self.density

    @cached_property
    def whole(self) -> RigidMass:
        """Mass, centre and inertia; of a link with sections from the density.

        Not with the mass above, which is computed as the derivation does it.
        """
        if self.centre is not None and self.inertia is not None:
            return RigidMass(self.mass, self.centre, self.inertia)
        if self.length is None or self.density is None:
            return RigidMass(self.mass)
        mass, first, second = (float(tail[0]) for tail in self.density.tails(np.zeros(1)))
        if mass == 0.0:
            return RigidMass(mass)
        middle = first / mass
        across = (second - first * middle) * self.length**2
        yy, zz, yz = (one.mass for one in self.slices) if self.slices else ZERO
        inertia = (yy + zz, 0.0, 0.0), (0.0, across + zz, -yz), (0.0, -yz, across + yy)
        return RigidMass(mass, (middle * self.length, 0.0, 0.0), inertia)


@dataclass(frozen=True)
class AxisNumbers:
    """A coordinate of a joint by its full name, and its direction in the parent's axes where all
    coordinates are zero.
    """

    coordinate: str
    kind: CoordinateKind
    direction: Triple


@dataclass(frozen=True, repr=False)
class JointNumbers(Brief):
    """A joint between two places; see :class:`.Joint`.

    ``axes`` are in sequence. The first direction of the ``triad`` is that of the joint's axis.
    ``turned`` are the child's axes in the parent's where all coordinates are zero, a row each.
    A slot in a plane turns too, about an axis that no coordinate describes. ``fitted`` are its pin
    and bearings; ``turning`` is the coordinate by which a shaft turns in a bearing.
    """

    name: str
    kind: JointKind
    parent: Place
    child: Place
    triad: Rows
    turned: Rows
    axes: tuple[AxisNumbers, ...] = ()
    pitch: float = 0.0
    fitted: Fittings | None = None
    turning: str | None = None

    @property
    def ends(self) -> tuple[Place, Place]:
        """The places on the parent and on the child."""
        return self.parent, self.child

    @property
    def carried(self) -> Triple | None:
        """The second axis of a universal joint in the axes of the child, which carries it."""
        if self.kind != "universal" or len(self.axes) < 2:
            return None
        x, y, z = (np.array(self.turned) @ self.axes[1].direction).tolist()
        return x, y, z


@dataclass(frozen=True)
class LoadNumbers:
    """The places of a load, the second one bearing the opposite; of a friction its coordinate and
    its numbers by their words.

    Pictures show a load of two places by its ``symbols``, "spring" and "damper", or by the distance
    at which a gas spring is ``closed`` [m]; that of a torque is a coil.
    """

    kind: str
    points: tuple[Place, ...]
    turning: bool = False
    coordinate: str = ""
    friction: Mapping[str, float] | None = None
    symbols: tuple[str, ...] = ()
    closed: float | None = None

    @property
    def size(self) -> str:
        """Output that is its size: of a torque its moment, of any other its force; none of a
        friction, which has outputs of its own.
        """
        return {"friction": "", "torque": "moment"}.get(self.kind, "resultant")


@dataclass(frozen=True)
class DriveNumbers:
    """A drive of a coordinate: the inertia that the coordinate sees, the rotor's ``spin`` for a
    unit of its rate, and the largest effort and speed, see :class:`.Drive`.
    """

    coordinate: str
    reflected: float
    spin: float
    effort: float | None = None
    speed: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Description(Brief):
    """A mechanism, with expressions or numbers.

    ``rows`` have the drives that they replace. ``driven`` are the coordinates whose motion is
    given, those of guides too (:mod:`.guiding`), and their kinds; ``drives`` those whose efforts
    make the motion; ``motors`` are the drives that were declared.
    ``beside`` are the directions in ground axes that were declared for y axes of
    links. ``losses`` are transmissions with friction. ``unturned`` are the joints whose child is a
    slender link that slides in a direction that was not declared. ``snapped`` are the corrections
    of a rounded drawing [rad and m]; its loops may miss within ``rounding``, and ``missed`` says by
    how much each of them does. ``bars`` are two-force links in space, whose spin about their own
    axis is taken to be none, and ``unmeasured`` coordinates without a value.
    ``one_way`` are outputs of forces that cannot pull, and what happens where they are negative.
    """

    name: str
    space: bool
    parameters: Mapping[str, ParameterNumbers] = field(default_factory=dict)
    gravity: Triple = ZERO
    bodies: Mapping[str, BodyNumbers] = field(default_factory=dict)
    joints: Mapping[str, JointNumbers] = field(default_factory=dict)
    loads: Mapping[str, LoadNumbers] = field(default_factory=dict)
    rows: Mapping[str, str] = field(default_factory=dict)
    motors: Mapping[str, DriveNumbers] = field(default_factory=dict)
    constraints: tuple[str, ...] = ()
    driven: Mapping[str, CoordinateKind] = field(default_factory=dict)
    drives: tuple[str, ...] = ()
    outputs: Mapping[str, str] = field(default_factory=dict)
    paths: Mapping[str, Place] = field(default_factory=dict)
    outlines: Mapping[str, tuple[tuple[Pair, ...], ...]] = field(default_factory=dict)
    rollers: Mapping[str, Roller] = field(default_factory=dict)
    pitch_circles: Mapping[str, PitchCircles] = field(default_factory=dict)
    tracks: Mapping[str, Track] = field(default_factory=dict)
    losses: tuple[str, ...] = ()
    beside: Mapping[str, Triple] = field(default_factory=dict)
    unturned: tuple[str, ...] = ()
    rounding: float = 0.0
    missed: Mapping[str, float] = field(default_factory=dict)
    snapped: Mapping[str, Pair] = field(default_factory=dict)
    bars: tuple[str, ...] = ()
    unmeasured: tuple[str, ...] = ()
    one_way: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(
        cls, mechanism: Mechanism, driven: Collection[str], drives: Collection[str] | None
    ) -> Description:
        """Describe a mechanism in expressions of its parameters.

        ``driven`` are the coordinates whose motion is given, ``drives`` those whose efforts make
        it, if others were declared.
        """
        rows = {name: row.replaces for name, row in mechanism.rows.items()}
        coordinates = mechanism.coordinates
        moved = [name for name in coordinates if name in driven]
        given = dict.fromkeys([*moved, *(driven if drives else ())])
        usual = [name for name in moved if name not in rows.values()]
        return cls(
            name=mechanism.name,
            space=mechanism.space,
            gravity=_numbers(mechanism.gravity),
            parameters={
                name: ParameterNumbers(_numbers(one.symbol), one.unit, one.low, one.high)
                for name, one in mechanism.parameters.items()
            },
            bodies={body.name: _body(body) for body in mechanism.moving},
            joints={name: _joint(mechanism, one) for name, one in mechanism.joints.items()},
            loads={name: _load(load) for name, load in mechanism.loads.items()},
            motors={name: _drive(one) for name, one in mechanism.drives.items()},
            rows=rows,
            constraints=tuple(mechanism.constraints),
            driven={name: kind_of(coordinates, name) for name in given},
            drives=tuple(name for name in (drives or usual) if not drives or name in coordinates),
            outputs={name: output.unit for name, output in mechanism.outputs.items()},
            paths={name: _numbers(path.point.on_body) for name, path in mechanism.paths.items()},
            outlines={
                body: tuple(tuple(_numbers((x, y)) for x, y in outline) for outline in outlines)
                for body, outlines in mechanism.outlines.items()
            },
            rollers=_numbers(mechanism.rollers),
            pitch_circles=dict(mechanism.pitch_circles),
            tracks=dict(mechanism.tracks),
            losses=tuple(
                name
                for name, one in mechanism.constraints.items()
                if one.transmission is not None and one.transmission.loss is not None
            ),
            beside={
                name: _numbers(link.beside)
                for name, link in mechanism.links.items()
                if link.beside is not None
            },
            unturned=tuple(
                name for name, joint in mechanism.joints.items() if _lies_by_default(joint)
            ),
            rounding=mechanism.rounding,
            snapped=dict(mechanism.snapped),
            one_way=dict(mechanism.one_way),
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Description) and self.plain() == other.plain()

    def plain(self) -> dict[str, Json]:
        """Return it as JSON has it, without what is empty or has no value."""
        return asdict(
            self,
            dict_factory=lambda items: {
                key: value for key, value in items if value not in (None, (), {})
            },
        )

    def check_places(self) -> None:
        """Raise ``ValueError`` where a joint or a load is at a place on a body that there is
        not.
        """
        places = [(name, end) for name, joint in self.joints.items() for end in joint.ends]
        places += [(name, point) for name, load in self.loads.items() for point in load.points]
        for name, place in places:
            if place.body != "ground" and place.body not in self.bodies:
                raise ValueError(
                    f"'{name}' is at a place on '{place.body}', which is not a body of the"
                    " mechanism"
                )

    @cached_property
    def size(self) -> float:
        """The length of all links [m]."""
        return sum(body.length or 0.0 for body in self.bodies.values()) or 1.0

    @cached_property
    def extent(self) -> float:
        """The size of the mechanism, and how far from the origin it stands [m]."""
        grounded = (place.at for place in self.acted_at if place.body == "ground")
        return self.size + max((abs(x) for at in grounded for x in at), default=0.0)

    @property
    def acted_at(self) -> list[Place]:
        """The places at which joints and loads act on bodies."""
        ends = (end for joint in self.joints.values() for end in joint.ends)
        return [*ends, *(place for load in self.loads.values() for place in load.points)]

    @cached_property
    def coordinates(self) -> dict[str, CoordinateKind]:
        """The coordinates of all joints, with their kinds."""
        return {axis.coordinate: axis.kind for joint in self.joints.values() for axis in joint.axes}

    @cached_property
    def kinds(self) -> Kinds:
        """The kinds of coordinates, those of guides too, and of frictions, and the units of the
        user's outputs.
        """
        coordinates = {**self.coordinates, **self.driven}
        frictions = {
            name: coordinates[load.coordinate]
            for name, load in self.loads.items()
            if load.coordinate
        }
        return Kinds(coordinates, frictions, self.outputs)

    @property
    def values(self) -> dict[str, float]:
        """The values of all parameters."""
        return {name: parameter.value for name, parameter in self.parameters.items()}

    @property
    def multipliers(self) -> tuple[str, ...]:
        """The names of all constraints and rows."""
        return *self.constraints, *self.rows

    @property
    def parts(self) -> tuple[str, ...]:
        """The names of all parts that outputs are of."""
        tables = (self.bodies, self.joints, self.constraints, self.rows, self.loads, self.outputs)
        return tuple(part for table in tables for part in table)

    @property
    def links(self) -> list[str]:
        """The bodies with a length: all but point masses."""
        return [name for name, body in self.bodies.items() if body.length is not None]

    @property
    def beams(self) -> dict[str, Beam]:
        """The beams of the links that have sections and a beam."""
        return {name: body.beam for name, body in self.bodies.items() if body.beam is not None}

    @property
    def materials(self) -> dict[str, Material]:
        """The materials of the links with a beam."""
        return {name: beam.material for name, beam in self.beams.items()}

    @property
    def springs(self) -> dict[str, tuple[Place, ...]]:
        """The two ends of each spring and damper."""
        return {name: one.points for name, one in self.loads.items() if one.kind == "spring"}

    @property
    def fitted(self) -> list[str]:
        """The joints that have a pin or a bearing."""
        return [name for name, joint in self.joints.items() if joint.fitted]

    @property
    def bends(self) -> list[str]:
        """The welds between the pieces of bent bars, by the names that they get there."""
        found = []
        for name, joint in self.joints.items():
            bar, bend, number = name.rpartition("_bend_")
            if bend and number.isdigit() and joint.kind == "weld":
                pieces = joint.parent.body, joint.child.body
                if pieces == (f"{bar}_{number}", f"{bar}_{int(number) + 1}"):
                    found.append(name)
        return found

    @property
    def pieces(self) -> set[str]:
        """The links that bent bars were cut into."""
        return {end.body for name in self.bends for end in self.joints[name].ends}

    @property
    def has_friction(self) -> bool:
        """True if a joint or a transmission has friction."""
        return bool(self.losses) or any(load.friction for load in self.loads.values())

    def components(self, vector: Triple) -> tuple[float, ...]:
        """The components of a vector that may differ from zero: in a plane x and y."""
        return vector if self.space else vector[:2]

    def oriented(self, body: str) -> bool:
        """Return whether a body has a direction; a point mass has none."""
        return body == "ground" or self.bodies[body].length is not None


DESCRIBED = (
    *(AxisNumbers, BodyNumbers, Description, DriveNumbers, JointNumbers, LoadNumbers),
    *(NumericDensity, ParameterNumbers, PitchCircles, Place, Roller, Track),
    *(Beam, Course, Shape, Material, Notch, Fittings, Pin, Plain, Rolling),
)
"""Kinds of what a description is made of."""


def _numbers(tree: Any) -> Any:
    """A tree in which every number is an expression."""
    return mapped(tree, lambda leaf: leaf if isinstance(leaf, str | None) else ca.SX(leaf))


def _body(body: Link | PointMass) -> BodyNumbers:
    mass = body.mass
    if isinstance(body, PointMass):
        return BodyNumbers(None, _numbers(mass_of(body)))
    if isinstance(mass, RigidMass):
        return BodyNumbers(*_numbers((body.length, mass_of(body), mass.centre, mass.inertia)))
    return BodyNumbers(
        _numbers(body.length),
        _numbers(mass_of(body)),
        density=mass.at(_numbers, body.length),
        slices=tuple(
            one.at(_numbers, body.length) for one in (mass.slices.each if mass.slices else ())
        ),
        beam=None if body.beam is None else replace(body.beam, shape=body.beam.course),
    )


def _joint(mechanism: Mechanism, joint: Joint) -> JointNumbers:
    turned = joint.turned
    return JointNumbers(
        joint.name,
        joint.kind,
        _numbers(joint.parent.on_body),
        _numbers(joint.child.on_body),
        _numbers(joint.triad),
        _numbers((turned.x, turned.y, turned.z)),
        tuple(AxisNumbers(a.coordinate, a.kind, _numbers(a.direction)) for a in joint.axes),
        _numbers(joint.pitch),
        mechanism.fitted.get(joint.name),
        mechanism.turning.get(joint.name) or None,
    )


def _load(load: Load) -> LoadNumbers:
    found = type(load).__name__.lower(), tuple(_numbers(point.on_body) for point in load.points)
    if isinstance(load, Friction):
        numbers = _numbers(load.numbers)
        return LoadNumbers(*found, coordinate=load.axis.coordinate, friction=numbers)
    symbols: tuple[str, ...] = ()
    if isinstance(load, Spring):
        parts = {"spring": load.stiffness, "damper": load.damping}
        symbols = tuple(name for name, x in parts.items() if not ca.SX(x).is_zero())
    elif isinstance(load, Torque) and load.coiled:
        symbols = ("spring",)
    turning, closed = getattr(load, "turning", False), _numbers(getattr(load, "closed", None))
    return LoadNumbers(*found, turning, symbols=symbols, closed=closed)


def _drive(drive: Drive) -> DriveNumbers:
    numbers = drive.reflected, drive.spin, drive.effort, drive.speed
    return DriveNumbers(drive.axis.coordinate, *_numbers(numbers))


def _lies_by_default(joint: Joint) -> bool:
    """Return whether a slender link slides along one line of its parent, and its direction there
    was not declared.
    """
    body = joint.child.body
    slender = isinstance(body, Link) and isinstance(body.mass, Density)
    return slender and joint.kind in ("prismatic", "cylindrical", "screw") and not joint.turn_given
