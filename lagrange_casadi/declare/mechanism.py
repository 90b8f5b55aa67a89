"""The declaration of a mechanism: parameters, links and point masses, joints, loads, constraints
and gravity.

A :class:`Mechanism` is filled part by part and freezes when a scene is made of it. Numbers are
checked when a part is declared, what depends on the whole when the mechanism freezes, and what
depends on the parameters' values by :meth:`Mechanism.values`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, cast

import casadi as ca

from ..arguments import public
from ..arithmetic.scalars import column
from ..base.symbolic import Graphs, symbolic
from ..base.units import Number
from ..beams.beam import Beam
from ..errors import DeclarationError
from .density import Density
from .expressions import bound, check_line, check_name, unit_vector, value_of
from .fitted import Fitted
from .friction import friction
from .joints import Axis, Joint, JointKind
from .limits import check_connected, parameter_values
from .line_loads import Between, LoadDensity, line_load
from .mass_properties import beam_of, mass_properties_of
from .measures import Measures
from .ownership import Ownership
from .parts import (
    Body,
    Constraint,
    Expression,
    Force,
    Friction,
    Ground,
    LineLoad,
    Link,
    Load,
    Parameter,
    Path,
    Point,
    PointMass,
    Row,
    Spring,
    Torque,
    Vector,
)
from .results import Asked, Results, UserOutput
from .validity import demands


@public
@symbolic
@dataclass(eq=False)
class Mechanism(Graphs):
    """A planar mechanism under declaration: links and point masses in the x-y plane, joined to each
    other and to the ground.

    Gravity is (0, -9.81) m/s^2 unless :meth:`set_gravity` says otherwise. Lengths, masses, places
    and gravity may be numbers or expressions in the symbols that :meth:`parameter` returns. Loads
    and constraints may also depend on :attr:`time` [s], :meth:`coordinate`, :meth:`place` and
    :meth:`direction`; loads and non-holonomic constraints on :meth:`rate` and :meth:`velocity`.

    Methods that declare raise :class:`.DeclarationError`, which names the part: for a name that is
    taken, a part of another mechanism, an expression in other symbols, and once a scene has been
    made. :class:`.Joint` says what joints hold.
    """

    name: str
    parameters: dict[str, Parameter] = field(default_factory=dict, init=False)
    bodies: dict[str, Body] = field(default_factory=dict, init=False)
    joints: dict[str, Joint] = field(default_factory=dict, init=False)
    loads: dict[str, Load] = field(default_factory=dict, init=False)
    constraints: dict[str, Constraint] = field(default_factory=dict, init=False)
    rows: dict[str, Row] = field(default_factory=dict, init=False)
    outputs: dict[str, UserOutput] = field(default_factory=dict, init=False)
    paths: dict[str, Path] = field(default_factory=dict, init=False)
    fitted: dict[str, dict[str, Fitted]] = field(default_factory=dict, init=False)
    turning: dict[str, str] = field(default_factory=dict, init=False)
    rough: dict[str, float] = field(default_factory=dict, init=False)
    snapped: dict[str, tuple[float, float]] = field(default_factory=dict, init=False)
    rounded: dict[str, tuple[float, float]] = field(default_factory=dict, init=False)
    gravity: Vector = field(default=(0.0, -9.81, 0.0), init=False)
    frozen: bool = field(default=False, init=False)
    time: Any = field(default_factory=lambda: ca.SX.sym("t"), init=False)
    measures: Measures = field(default_factory=Measures, init=False)
    asked: list[Asked] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        check_name("mechanism", self.name)
        self.bodies["ground"] = Ground("ground")

    def __repr__(self) -> str:
        names = ", ".join(body.name for body in self.moving)
        return (
            f"<Mechanism {self.name}: {names or 'no body yet'}; joints:"
            f" {', '.join(self.joints) or 'none yet'}>"
        )

    @property
    def ground(self) -> Ground:
        """The fixed frame; ``ground.at(x, y)`` is a point of it, ``ground`` itself its origin."""
        return cast(Ground, self.bodies["ground"])

    @property
    def moving(self) -> tuple[Link | PointMass, ...]:
        """The links and point masses, in the order of declaration."""
        return tuple(body for body in self.bodies.values() if isinstance(body, Link | PointMass))

    @property
    def links(self) -> dict[str, Link]:
        """The links by name."""
        return {name: body for name, body in self.bodies.items() if isinstance(body, Link)}

    @property
    def coordinates(self) -> dict[str, tuple[Joint, Axis]]:
        """The coordinates by name, as the joint and its axis: ``JOINT``, or ``JOINT:NAME`` where a
        joint has several.
        """
        return {
            axis.coordinate: (joint, axis) for joint in self.joints.values() for axis in joint.axes
        }

    @property
    def space(self) -> bool:
        """True if it lies in space, not in a plane."""
        return False

    @property
    def own(self) -> Ownership:
        """Parts and names of the mechanism."""
        return Ownership(self)

    @property
    def results(self) -> Results:
        """The symbols of accelerations and forces, for :meth:`output`."""
        return Results(self)

    @property
    def symbols(self) -> Expression:
        """The parameters' symbols as one column, in the order of declaration."""
        return column(parameter.symbol for parameter in self.parameters.values())

    def parameter(
        self,
        name: str,
        default: Number,
        unit: str = "1",
        *,
        low: Number = -math.inf,
        high: Number = math.inf,
    ) -> Expression:
        """Declare a parameter from ``low`` to ``high``, and return its ``casadi.SX`` symbol to
        build lengths and places from.
        """
        self.own.free("parameter", name, self.parameters)
        check_line(f"parameter '{name}': its unit", unit)
        default, low, high = (bound(f"parameter '{name}'", x, unit) for x in (default, low, high))
        parameter = Parameter(name, default, unit, low, high, ca.SX.sym(name))
        parameter.check(parameter.default)
        return self.parameters.setdefault(name, parameter).symbol

    def link(
        self,
        name: str,
        *,
        length: Expression,
        mass: Expression = None,
        density: Density | None = None,
        centre: tuple[Expression, Expression] | None = None,
        inertia: Expression = None,
        beam: Beam | None = None,
    ) -> Link:
        """Declare a link of a length [m].

        Its mass is one of: ``mass`` [kg] alone, a uniform rod; a ``density`` of :mod:`.density`;
        that of a ``beam`` of :mod:`.beams` alone; or ``mass``, ``centre`` (in the link's axes [m])
        and ``inertia`` about the centre [kg m^2], for a body whose sections are not wanted.
        """
        self.own.free("link", name, self.bodies)
        what, checked = f"link '{name}'", self.own.expression
        beam = beam_of(what, beam, checked)
        mass_properties = mass_properties_of(
            what, mass, density, centre, inertia, checked, beam=beam
        )
        return cast(
            Link,
            self.bodies.setdefault(
                name, Link(name, checked(f"{what}: length", length, "m"), mass_properties, beam)
            ),
        )

    def point_mass(self, name: str, mass: Expression) -> PointMass:
        """Declare a mass [kg] without extent, at a point; welded to a link
        it moves with the link.
        """
        self.own.free("point mass", name, self.bodies)
        body = PointMass(name, self.own.expression(f"point mass '{name}': mass", mass, "kg"))
        return cast(PointMass, self.bodies.setdefault(name, body))

    def revolute(self, name: str, parent: Body | Point, child: Body | Point) -> Joint:
        """Pin a point of ``child`` to a point of ``parent``; a link stands for its base, the ground
        for its origin.
        """
        return self._joint(name, "revolute", parent, child)

    def prismatic(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: tuple[Expression, Expression],
        angle: Expression | None = None,
    ) -> Joint:
        """Let a point of ``child`` slide along ``axis`` (in the parent's axes) through a point of
        ``parent``.

        ``angle`` [rad] is the child's direction against the parent's, 0 if it is not given: a note
        says so where a link lies across ``axis``. The parent carries the line, loaded where the
        point is at the moment. The coordinate is the place on it [m].
        """
        return self._joint(name, "prismatic", parent, child, axis, angle)

    def slot(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: tuple[Expression, Expression] = (1.0, 0.0),
    ) -> Joint:
        """Let a pin at a point of ``child`` slide in a slot of ``parent`` along ``axis``, in the
        parent's axes.
        """
        return self._joint(name, "slot", parent, child, axis)

    def weld(
        self, name: str, parent: Body | Point, child: Body | Point, *, angle: Expression = 0.0
    ) -> Joint:
        """Fix a point of ``child`` to a point of ``parent``, its direction at ``angle`` [rad, or as
        text ``"90 deg"``].
        """
        return self._joint(name, "weld", parent, child, angle=angle)

    def gear(
        self, name: str, first: Joint, second: Joint, *, ratio: Expression, offset: Expression = 0.0
    ) -> Constraint:
        """Tie two joints: coordinate of ``second`` = ratio (that of ``first``) + offset (or ``"15
        deg"``); a mesh has -z1/z2.
        """
        numbers = (
            ("ratio", ratio, "1"),
            ("offset", offset, "m" if self.own.moving_joint(second)[1].kind == "slide" else "rad"),
        )
        ratio, offset = (
            self.own.expression(f"gear '{name}': {word}", value, of) for word, value, of in numbers
        )
        return self.constraint(
            name, self.coordinate(second) - ratio * self.coordinate(first) - offset
        )

    def constraint(self, name: str, phi: Expression) -> Constraint:
        """Declare Phi = 0, an expression of coordinates, places, directions, time and parameters
        (paper eq. 5); no slope may jump.

        The force of its multiplier lambda is + lambda dPhi/dq (paper eq. 2). It acts on what Phi is
        written in: on a joint's coordinate between the joint's bodies, on a place from the ground.
        """
        self.own.free("constraint", name, self.constraints)
        phi = self.own.expression(f"constraint '{name}'", phi, moving=True)
        if not isinstance(phi, ca.SX) or not ca.depends_on(phi, self.measures.places):
            raise DeclarationError(
                f"constraint '{name}' depends on no coordinate; expected an expression of"
                " coordinate(JOINT), place(POINT) or direction(LINK)"
            )
        if ca.depends_on(phi, self.measures.rates):
            raise DeclarationError(
                f"constraint '{name}' depends on rates; expected m.nonholonomic() for it"
            )
        return self.constraints.setdefault(name, Constraint(name, phi))

    def nonholonomic(self, name: str, expression: Expression, *, replaces: Joint) -> Row:
        """Declare a non-holonomic constraint A(q) q' + b = 0 (paper eq. 3).

        It is an expression that is linear in rates and velocities.

        ``replaces`` is a driven joint. Its motion is prescribed and must satisfy the constraint;
        the constraint's multiplier then takes the place of the joint's effort.
        """
        self.own.free("non-holonomic constraint", name, self.rows)
        what, rates = f"non-holonomic constraint '{name}'", self.measures.rates
        expression = self.own.expression(what, expression, moving=True)
        if not isinstance(expression, ca.SX) or not ca.depends_on(expression, rates):
            raise DeclarationError(
                f"{what} depends on no rate; expected an expression of rate(JOINT) or"
                " velocity(POINT)"
            )
        if ca.depends_on(ca.jacobian(expression, rates), rates):
            raise DeclarationError(f"{what} must be linear in the rates")
        found = Row(name, expression, self.own.joint(replaces).name)
        for other in self.rows.values():
            if other.replaces == found.replaces:
                raise DeclarationError(
                    f"{what}: '{other.name}' already replaces the drive of joint '{found.replaces}'"
                )
        return self.rows.setdefault(name, found)

    def force(
        self,
        name: str,
        point: Body | Point,
        *,
        x: Expression = 0.0,
        y: Expression = 0.0,
        turning: bool = False,
    ) -> Force:
        """Apply a force [N] at a point, in ground axes, or in the body's own where ``turning``."""
        place = self._load_point(name, point)
        if turning and not place.body.oriented:
            raise DeclarationError(
                f"load '{name}': point mass '{place.body.name}' has no axes; use a link, or"
                " leave turning out"
            )
        if place.body is self.ground:
            raise DeclarationError(
                f"load '{name}': a force on the ground has no effect; expected a point of a link"
                " or a point mass"
            )
        load = Force(name, place, self._load(name, x), self._load(name, y), turning)
        return cast(Force, self.loads.setdefault(name, load))

    def torque(
        self,
        name: str,
        point: Body | Point,
        value: Expression,
        *,
        against: Body | Point | None = None,
    ) -> Torque:
        """Apply a torque [N m], counter-clockwise, to a body at a point, and its opposite to
        another one (default: the ground).

        Where on a link it acts matters to the link's sections only; a link stands for its base.
        """
        ends = (
            self._load_point(name, point),
            self._load_point(name, self.ground if against is None else against),
        )
        for end in ends:
            if not end.body.oriented:
                raise DeclarationError(
                    f"load '{name}': point mass '{end.body.name}' cannot take a torque; expected a"
                    " link"
                )
        load = Torque(name, ends[0], self._load(name, value), ends[1])
        self.loads[name] = load
        return load

    def line_load(
        self,
        name: str,
        link: Link,
        *,
        x: LoadDensity = 0.0,
        y: LoadDensity = 0.0,
        between: Between = None,
        turning: bool = False,
    ) -> LineLoad:
        """Apply a load [N/m] along a link: a value, a pair for its two ends, or a polynomial as a
        function of the distance xi [m].

        It acts ``between`` two distances from the base, else along the whole link:
        :class:`.LineLoad`.
        """
        return cast(
            LineLoad,
            self.loads.setdefault(name, line_load(self.own, name, link, (x, y), between, turning)),
        )

    def spring(
        self,
        name: str,
        first: Body | Point,
        second: Body | Point,
        *,
        stiffness: Expression,
        length: Expression,
        damping: Expression = 0.0,
    ) -> Spring:
        """Stretch a spring [N/m] of a free length [m], with a damper [N s/m] beside it, between two
        points: :class:`.Spring`.
        """
        ends = self._load_point(name, first), self._load_point(name, second)
        numbers = [
            self._load(name, stiffness),
            self._load(name, length, "m"),
            self._load(name, damping),
        ]
        return cast(Spring, self.loads.setdefault(name, Spring(name, *ends, *numbers)))

    def damper(
        self, name: str, first: Body | Point, second: Body | Point, *, damping: Expression
    ) -> Spring:
        """Put a damper [N s/m] between two points."""
        return self.spring(name, first, second, stiffness=0.0, length=0.0, damping=damping)

    def torsion_spring(
        self,
        name: str,
        joint: Joint,
        *,
        stiffness: Expression,
        angle: Expression = 0.0,
        damping: Expression = 0.0,
    ) -> Torque:
        """Put a spring [N m/rad], free at ``angle``, and a damper [N m s/rad] on a revolute joint,
        whose angle counts turns.
        """
        if self.own.joint(joint).coordinate != "angle":
            raise DeclarationError(
                f"load '{name}': joint '{joint.name}' has no angle for a torsion spring"
            )
        k, free, c = (
            self._load(name, stiffness),
            self._load(name, angle, "rad"),
            self._load(name, damping),
        )
        return self._turn_back(
            name, joint, -(k * (self.coordinate(joint) - free)) - c * self.rate(joint)
        )

    def _turn_back(self, name: str, joint: Joint, value: Expression) -> Torque:
        return self.torque(name, joint.child, value, against=joint.parent)

    def friction(
        self,
        name: str,
        joint: Joint,
        *,
        mu: Expression | None = None,
        radius: Expression | None = None,
        length: Expression | None = None,
        viscous: Expression | None = None,
        static: Expression | None = None,
        stribeck: Expression | None = None,
        smooth: Expression | None = None,
        along: str = "",
    ) -> Friction:
        """Let a joint rub, a pin or a guide, by what it bears; ``along`` one of two coordinates of
        it: see :class:`.Friction`.
        """
        numbers = {"mu": mu, "radius": radius, "length": length, "viscous": viscous}
        numbers |= {"static": static, "stribeck": stribeck, "smooth": smooth}
        return cast(
            Friction, self.loads.setdefault(name, friction(self.own, name, joint, along, numbers))
        )

    def output(self, name: str, expression: Expression, *, unit: str = "1") -> UserOutput:
        """Declare an output of one's own, ``output:NAME``, with its unit: an expression of what
        loads see and of `results`.
        """
        self.own.free("output", name, self.outputs)
        check_line(f"output '{name}': its unit", unit)
        expression = ca.SX(
            self.own.expression(f"output '{name}'", expression, moving=True, found=True)
        )
        made_of = tuple(asked for asked in self.asked if ca.depends_on(expression, asked.symbol))
        self.outputs[name] = UserOutput(name, expression, unit, made_of)
        return self.outputs[name]

    def path(self, name: str, point: Body | Point) -> Path:
        """Declare a point whose motion a scene may give; outputs NAME_x, NAME_vx, NAME_ax, and of
        y, are its motion in SI units.
        """
        self.own.free("path", name, self.paths)
        path = Path(name, self.own.point(f"path '{name}'", point))
        if path.point.body is self.ground:
            raise DeclarationError(
                f"path '{name}': a point of the ground does not move; expected a point of a link"
                " or a point mass"
            )
        for kind, unit, of in (
            ("", "m", self.place),
            ("v", "m/s", self.velocity),
            ("a", "m/s^2", self.results.acceleration),
        ):
            for axis, symbol in zip(self.measures.components, of(path.point), strict=True):
                self.output(f"{name}_{kind}{axis}", symbol, unit=unit)
        self.paths[name] = path
        return path

    def coordinate(self, joint: Joint, axis: str = "") -> Expression:
        """The symbol of a joint's coordinate, for loads and constraints; an angle counts turns from
        the start of the scene on.

        Where a joint has several, ``axis`` names one of them, as ``turn_1``.
        """
        return self.measures.joint(*self.own.moving_joint(joint, axis)).places[0]

    def rate(self, joint: Joint, axis: str = "") -> Expression:
        """The symbol of a joint's rate, for loads and non-holonomic rows."""
        return self.measures.joint(*self.own.moving_joint(joint, axis)).rates[0]

    def place(self, point: Body | Point) -> tuple[Expression, ...]:
        """The symbols of a point's x and y, and in space z, in ground axes [m], for loads and
        constraints.
        """
        return self.measures.point(self.own.point("place", point)).places

    def velocity(self, point: Body | Point) -> tuple[Expression, ...]:
        """The symbols of a point's velocity in ground axes [m/s], for
        loads and non-holonomic rows.
        """
        return self.measures.point(self.own.point("velocity", point)).rates

    def direction(self, link: Link) -> Expression:
        """The symbol of the direction of a link's axis against the ground's x axis [rad]; it counts
        turns as a coordinate does.
        """
        if not isinstance(body := self.own.point("direction", link).body, Link):
            raise DeclarationError(f"direction: expected a link, got '{body.name}'")
        return self.measures.link(body).places[0]

    def set_gravity(self, x: Expression, y: Expression) -> None:
        """Set the acceleration of gravity [m/s^2], in ground axes; numbers or expressions in
        parameters.
        """
        self.own.refuse_frozen("set gravity")
        self.gravity = (self.own.expression("gravity", x), self.own.expression("gravity", y), 0.0)

    def freeze(self) -> None:
        """Check the whole and end the declaration.

        Raises :class:`DeclarationError` for a part that hangs on nothing.
        """
        if not self.moving:
            raise DeclarationError(f"mechanism '{self.name}' has no link and no point mass")
        check_connected(self.name, self.ground, self.moving, self.joints.values())
        self.frozen = True

    def values(self, overrides: Mapping[str, float] | None = None) -> dict[str, float]:
        """Every parameter's value, the defaults overridden, checked against the ranges and against
        what the parts allow.

        Raises :class:`UnknownNameError` for names that are no parameters', :class:`ParameterError`
        for values that are not finite or out of range, all of them at once, a length that is not
        positive, a mass or density that is negative, a station outside its link, or a mechanism
        without any mass.
        """
        values = parameter_values(self.parameters, overrides)
        demands(self).check(list(values.values()), lambda e: self.number(e, values))
        return values

    def number(self, expression: Expression, values: Mapping[str, float]) -> float:
        """The value of an expression in the parameters."""
        return value_of(
            expression, {name: one.symbol for name, one in self.parameters.items()}, values
        )

    def _joint(
        self,
        name: str,
        kind: JointKind,
        parent: Body | Point,
        child: Body | Point,
        axis: tuple[Expression, Expression] | None = None,
        angle: Expression | None = None,
    ) -> Joint:
        own, what = self.own, f"joint '{name}'"
        own.free("joint", name, self.joints)
        start, end = own.point(what, parent), own.point(what, child)
        if start.body is end.body:
            raise DeclarationError(f"{what} joins '{start.body.name}' to itself")
        if kind != "revolute" and not start.body.oriented:
            raise DeclarationError(
                f"{what}: its parent '{start.body.name}' is a point mass, which has no direction"
                f" for {'the weld' if kind == 'weld' else 'the axis'}; make the other body the"
                " parent"
            )
        unit = (
            (1.0, 0.0)
            if axis is None
            else unit_vector(what, axis, lambda a: own.expression(f"{what}: axis", a))
        )
        turn = 0.0 if angle is None else own.expression(f"{what}: angle", angle, "rad")
        joint = Joint(name, kind, start, end, unit, turn, turn_given=angle is not None)
        return self.joints.setdefault(name, joint)

    def _load_point(self, name: str, place: Body | Point) -> Point:
        self.own.free("load", name, self.loads)
        return self.own.point(f"load '{name}'", place)

    def _load(self, name: str, value: Expression, unit: str = "1") -> Expression:
        return self.own.expression(f"load '{name}'", value, unit, moving=True)
