"""The declaration of a mechanism: parameters, links and point masses, joints, loads, constraints
and gravity.

A :class:`Mechanism` is filled part by part and freezes when a scene is made of it. Numbers are
checked when a part is declared, what depends on the whole when the mechanism freezes, and what
depends on the parameters' values by :meth:`Mechanism.values`.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

import casadi as ca

from ..base.arguments import public
from ..base.drawn import Drawing
from ..base.methods import method
from ..base.symbolic import symbolic
from ..base.tables import FORCE, MOMENT
from ..base.units import Number, quantity, typed
from ..base.vectors import dot, minus, norm, times
from ..errors import DeclarationError, listed
from .beams.beam import Beam
from .constraints import Constraint, Row
from .declaration import Declaration
from .declared_parts import (
    Body,
    Expression,
    Link,
    Parameter,
    Path,
    Point,
    PointMass,
    UserOutput,
    Vector,
)
from .directions import Reference, directed
from .drives import Drive
from .expressions import check_line
from .joints import Joint, JointKind, check_ends
from .limits import check_connected, parameter_values
from .link_density import Density
from .load_arguments import Between, LoadDensity, drive, friction, line_load
from .loads import Force, Friction, LineLoad, Load, Spring, Torque
from .mass_properties import UNDECLARED, Masses, beam_of, mass_properties_of
from .ownership import Ownership
from .results import Results
from .validity import demands

_Load = TypeVar("_Load", bound=Load)


@public
@symbolic
@dataclass(eq=False)
class Mechanism(Declaration):
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

    def __repr__(self) -> str:
        bodies = listed((body.name for body in self.moving), "no body yet")
        joints = listed(self.joints, "none yet")
        return f"<{type(self).__name__} {self.name}: {bodies}; joints: {joints}>"

    def _repr_html_(self) -> str:
        """Show a drawing in a notebook, or where there is none the parts."""
        return str(method("Mechanism._repr_html_")(self))

    def draw(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        parameters: Mapping[str, float] | None = None,
        posture: Mapping[str, float | str] | None = None,
    ) -> Drawing:
        """Draw what is declared so far, whether its loops close or not.

        Parameters
        ----------
        path : path, optional
            The file, which ends in .svg or .png; by default none is written.
        parameters : mapping, optional
            Values by name; by default the parameters' defaults.
        posture : mapping, optional
            Rough directions of links and coordinates of joints, as of a :class:`.Scene`; by
            default they are zero.

        Returns
        -------
        Drawing
            The drawing, which a notebook shows. Its ``gaps`` say which loops do not close, and how
            wide they are open.

        Raises
        ------
        DeclarationError
            For another ending, and what the posture cannot be.
        UnknownNameError
            For names that the mechanism does not have.
        ParameterError
            For values that are not finite, or out of their range.
        """
        draw: Callable[..., Drawing] = method("Mechanism.draw")
        return draw(self, path, parameters=parameters, posture=posture)

    @property
    def ownership(self) -> Ownership:
        """Names, points and expressions of the mechanism, as its declarations check them."""
        return Ownership(self)

    @property
    def results(self) -> Results:
        """The symbols of accelerations and forces, for :meth:`output`."""
        return Results(self.ownership)

    def parameter(
        self,
        name: str,
        default: Number,
        unit: str = "",
        *,
        low: Number = -math.inf,
        high: Number = math.inf,
    ) -> Expression:
        """Declare a parameter: a number that may change without a new derivation.

        Parameters
        ----------
        name : str
            A letter, then letters, digits or underscores.
        default : float or str
            Its value, in ``unit``, or a text with its unit such as ``"45 deg"`` or ``"5 kN"``.
        unit : str, optional
            Its unit; by default that of the text, in SI, or none.
        low, high : float or str
            Its range, ends included.

        Returns
        -------
        casadi.SX
            Its symbol, for lengths, masses, places, loads and motions.

        Raises
        ------
        DeclarationError
            If the name is taken.
        ParameterError
            If the default is out of the range.
        """
        self.ownership.free("parameter", name, self.parameters)
        check_line(f"parameter '{name}': its unit", unit)
        unit = unit or typed(default)[1] or "1"
        default, low, high = (
            quantity(f"parameter '{name}'", x, unit, finite=False) for x in (default, low, high)
        )
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
        """Declare a link: a body with a straight axis from its base to its tip.

        Parameters
        ----------
        name : str
            Name of the link.
        length : float, str or casadi.SX
            Distance of the tip from the base [m].
        mass : float, str or casadi.SX, optional
            Mass [kg]. Alone, it is that of a uniform rod. A link may be drawn without, but a scene
            needs it, or a density.
        density : Density, optional
            Mass per length, of :mod:`.density`, in place of ``mass``.
        centre : tuple, optional
            Centre of mass (x, y) on the link's axes [m]; with ``mass`` and ``inertia`` the link is
            a rigid body without sections.
        inertia : float or casadi.SX, optional
            Moment of inertia about the centre [kg m^2].
        beam : Beam, optional
            Cross-section and material; the mass follows from them unless it is given too.

        Returns
        -------
        Link
            The link. It stands for its base; ``tip`` is its other end, ``at(x, y)`` another point.

        Raises
        ------
        DeclarationError
            If the name is taken, or the arguments contradict each other.
        """
        self.ownership.free("link", name, self.bodies)
        return self._link(name, length, (mass, density, centre, inertia, False), beam)

    def _link(
        self,
        name: str,
        length: Expression,
        masses: Masses,
        beam: Beam | None,
        reference: Reference | None = None,
        beside: Vector | None = None,
    ) -> Link:
        what, own = f"link '{name}'", self.ownership
        beam = beam_of(own, what, beam)
        mass_properties = mass_properties_of(own, what, masses, beam, reference)
        length = own.expression(f"{what}: length", length, "m")
        self.bodies[name] = link = Link(name, length, mass_properties, beam, beside=beside)
        return link

    def point_mass(self, name: str, mass: Expression) -> PointMass:
        """Declare a body without extent.

        It has no direction; welded to a link it moves with the link.

        Parameters
        ----------
        name : str
            Name of the body.
        mass : float, str or casadi.SX
            Mass [kg].

        Returns
        -------
        PointMass
            The body, which stands for its point.

        Raises
        ------
        DeclarationError
            If the name is taken.
        """
        self.ownership.free("point mass", name, self.bodies)
        mass = self.ownership.expression(f"point mass '{name}': mass", mass, "kg")
        self.bodies[name] = body = PointMass(name, mass)
        return body

    def revolute(self, name: str, parent: Body | Point, child: Body | Point) -> Joint:
        """Declare a pin: a point of ``child`` coincides with a point of ``parent``.

        Parameters
        ----------
        name : str
            Name of the joint.
        parent, child : Link, PointMass, Ground or Point
            The points that coincide. A link stands for its base, the ground for its origin.

        Returns
        -------
        Joint
            The joint. Its coordinate is the child's angle relative to the parent [rad],
            counter-clockwise.

        Raises
        ------
        DeclarationError
            If the name is taken, or the joint joins a body to itself.
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
        """Declare a guide: a point of ``child`` slides on a line of ``parent``, and the child keeps
        its angle.

        Parameters
        ----------
        name : str
            Name of the joint.
        parent, child : Link, PointMass, Ground or Point
            The body with the line, through this point of it, and the body with the sliding point.
        axis : tuple
            Direction of the line (x, y), on the parent's axes.
        angle : float, str or casadi.SX, optional
            Direction of the child relative to the parent [rad], by default 0. If it is not given
            and a link lies across the line, a note says so.

        Returns
        -------
        Joint
            The joint. Its coordinate is the position along the line [m]; its force acts on the
            parent at that position.

        Raises
        ------
        DeclarationError
            If the axis has no length, the parent is a point mass, or both are one body.
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
        """Declare a pin in a slot: a point of ``child`` slides on a line of ``parent``, and the
        child turns freely.

        Parameters
        ----------
        name, parent, child
            As of :meth:`prismatic`.
        axis : tuple
            Direction of the line (x, y), on the parent's axes, by default their x axis.

        Returns
        -------
        Joint
            The joint. Its coordinate is the position along the line [m]; its force acts on the
            parent at that position.

        Raises
        ------
        DeclarationError
            As of :meth:`prismatic`.
        """
        return self._joint(name, "slot", parent, child, axis)

    def weld(
        self, name: str, parent: Body | Point, child: Body | Point, *, angle: Expression = 0.0
    ) -> Joint:
        """Fix a point of ``child`` to a point of ``parent``.

        Parameters
        ----------
        name, parent, child
            As of :meth:`revolute`.
        angle : float, str or casadi.SX
            Direction of the child relative to the parent [rad, or a text such as ``"90 deg"``],
            counter-clockwise.

        Returns
        -------
        Joint
            The joint, without coordinates.

        Raises
        ------
        DeclarationError
            If the parent is a point mass, or both are one body.
        """
        return self._joint(name, "weld", parent, child, angle=angle)

    def contact(
        self,
        name: str,
        point: Body | Point,
        *,
        friction: Expression,
        at: tuple[Expression, Expression],
        normal: tuple[Expression, Expression] = (0.0, 1.0),
    ) -> Joint:
        """Let a point of a body stand on the ground, where it stays over the scene and may turn.

        Its reaction is the ground's force on the body. The outputs ``NAME_normal`` and
        ``NAME_margin`` [N] are the part of the force along the normal, negative where the contact
        pulls, and its distance from the cone of friction, (friction normal - tangential) /
        sqrt(1 + friction^2), negative where the point slides or pulls. An instant at which one is
        negative has the status ``LOST_CONTACT``, if any force is evaluated and equilibrium
        determines that of the contact.

        Parameters
        ----------
        name : str
            Name of the contact, which is a revolute joint.
        point : Link, PointMass or Point
            The point; a link stands for its base.
        friction : float or casadi.SX
            Coefficient of friction.
        at : tuple
            Place (x, y) of the point [m].
        normal : tuple
            Direction (x, y) out of the ground.

        Returns
        -------
        Joint
            The joint, from the ground to the body.

        Raises
        ------
        DeclarationError
            If the coefficient is negative, or the normal has no length.
        """
        return self._contact(name, point, friction, at, normal, self.revolute)

    def _contact(
        self,
        name: str,
        point: Body | Point,
        friction: Expression,
        at: Expression,
        normal: tuple[Expression, ...],
        pin: Callable[[str, Point, Point], Joint],
    ) -> Joint:
        what, own = f"contact '{name}'", self.ownership
        foot, mu = own.point(what, point), own.expression(f"{what}: friction", friction)
        if isinstance(mu, float) and mu < 0.0:
            raise DeclarationError(f"{what}: friction must be at least 0, got {mu:g}")
        upward = directed(f"{what}: normal: axis", normal, own)
        joint = pin(name, self.ground.at(*own.vector(f"{what}: at", at, "m")), foot)
        fx, fy, *fz = self.results.reaction(joint)
        force = (fx, fy, fz[0] if self.space else 0.0)
        pressing = dot(upward, force)
        sliding = norm(minus(force, times(pressing, upward)))
        margin = (mu * pressing - sliding) / ca.sqrt(1 + mu * mu)
        self.output(f"{name}_normal", pressing, unit="N")
        self.output(f"{name}_margin", margin, unit="N")
        self.contacts.append(name)
        return joint

    def gear(
        self, name: str, first: Joint, second: Joint, *, ratio: Expression, offset: Expression = 0.0
    ) -> Constraint:
        """Couple two joints: the coordinate of ``second`` is ``ratio`` times that of ``first`` plus
        ``offset``.

        Parameters
        ----------
        name : str
            Name of the constraint.
        first, second : Joint
            Joints of one coordinate each.
        ratio : float or casadi.SX
            Ratio of the coordinates; for two gears -z1/z2.
        offset : float, str or casadi.SX
            Coordinate of ``second`` at zero of ``first`` [rad or m, or a text such as ``"15
            deg"``].

        Returns
        -------
        Constraint
            The constraint, as of :meth:`constraint`.

        Raises
        ------
        DeclarationError
            If the name is taken, or a joint has no coordinate or several.
        """
        unit = "m" if self.ownership.moving_joint(second)[1].kind == "slide" else "rad"
        ratio = self.ownership.expression(f"gear '{name}': ratio", ratio)
        offset = self.ownership.expression(f"gear '{name}': offset", offset, unit)
        return self.constraint(
            name, self.coordinate(second) - ratio * self.coordinate(first) - offset
        )

    def constraint(self, name: str, phi: Expression) -> Constraint:
        """Declare a constraint Phi = 0 (paper, eq. 5).

        Parameters
        ----------
        name : str
            Name of the constraint; its multiplier lambda is the output ``multiplier:NAME``.
        phi : casadi.SX
            An expression of coordinates, places, directions, time and parameters, with a continuous
            slope.

        Returns
        -------
        Constraint
            The constraint.

        Raises
        ------
        DeclarationError
            If it depends on no coordinate, or on rates.

        Notes
        -----
        The force is + lambda dPhi/dq (paper, eq. 2). Along a joint's coordinate it acts between the
        bodies of the joint, along a place or a direction from the ground.
        """
        self.ownership.free("constraint", name, self.constraints)
        phi = self.ownership.expression(f"constraint '{name}'", phi, moving=True)
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
        """Declare a non-holonomic constraint A(q) q' + b = 0 (paper, eq. 3).

        Parameters
        ----------
        name : str
            Name of the constraint; its multiplier is the output ``multiplier:NAME``.
        expression : casadi.SX
            The left side, linear in rates and velocities.
        replaces : Joint
            A driven joint, in space one of one coordinate. Its motion is prescribed and must
            satisfy the constraint; the multiplier of the constraint takes the place of its effort.

        Returns
        -------
        Row
            The constraint.

        Raises
        ------
        DeclarationError
            If it is not linear in rates, or another one replaces the same drive.
        """
        self.ownership.free("non-holonomic constraint", name, self.rows)
        what, rates = f"non-holonomic constraint '{name}'", self.measures.rates
        expression = self.ownership.expression(what, expression, moving=True)
        if not isinstance(expression, ca.SX) or not ca.depends_on(expression, rates):
            raise DeclarationError(
                f"{what} depends on no rate; expected an expression of rate(JOINT) or"
                " velocity(POINT)"
            )
        if ca.depends_on(ca.jacobian(expression, rates), rates):
            raise DeclarationError(f"{what} must be linear in the rates")
        joint = self.ownership.joint(replaces)
        if self.space and joint.coordinate is None:
            found = ", ".join(axis.coordinate for axis in joint.axes) or "none"
            raise DeclarationError(
                f"{what}: expected a joint of one coordinate, those of joint '{joint.name}' are"
                f" {found}; use a chain of joints of one coordinate each"
            )
        for other in self.rows.values():
            if other.replaces == joint.name:
                raise DeclarationError(
                    f"{what}: '{other.name}' already replaces the drive of joint '{joint.name}'"
                )
        return self.rows.setdefault(name, Row(name, expression, joint.name))

    def force(
        self,
        name: str,
        point: Body | Point,
        *,
        x: Expression = 0.0,
        y: Expression = 0.0,
        turning: bool = False,
    ) -> Force:
        """Apply a force at a point.

        Parameters
        ----------
        name : str
            Name of the load.
        point : Link, PointMass or Point
            The point, not of the ground; a link stands for its base.
        x, y : float or casadi.SX
            Components [N], on ground axes.
        turning : bool
            True for components on the axes of the body.

        Returns
        -------
        Force
            The load.

        Raises
        ------
        DeclarationError
            If the point is of the ground, or ``turning`` is asked of a point mass.
        """
        return self._force(name, point, (x, y, 0.0), turning)

    def _force(self, name: str, point: Body | Point, components: Vector, turning: bool) -> Force:
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
        x, y, z = (self._load(name, component, FORCE) for component in components)
        return self._add(Force(name, place, (x, y, z), turning))

    def torque(
        self,
        name: str,
        point: Body | Point,
        value: Expression,
        *,
        against: Body | Point | None = None,
    ) -> Torque:
        """Apply a torque to a body at a point, and the opposite torque to another.

        Parameters
        ----------
        name : str
            Name of the load.
        point : Link, Ground or Point
            The point, which matters only to the sections of a link.
        value : float or casadi.SX
            Torque [N m], counter-clockwise.
        against : Link, Ground or Point, optional
            Body with the opposite torque, by default the ground.

        Returns
        -------
        Torque
            The load.

        Raises
        ------
        DeclarationError
            If one of the bodies is a point mass.
        """
        return self._torque(name, point, (0.0, 0.0, value), against)

    def _torque(
        self,
        name: str,
        point: Body | Point,
        components: Vector,
        against: Body | Point | None,
        turning: bool = False,
    ) -> Torque:
        first = self._load_point(name, point)
        second = self._load_point(name, self.ground if against is None else against)
        for end in (first, second):
            if not end.body.oriented:
                raise DeclarationError(
                    f"load '{name}': point mass '{end.body.name}' cannot take a torque; expected a"
                    " link"
                )
        x, y, z = (self._load(name, component, MOMENT) for component in components)
        return self._add(Torque(name, first, (x, y, z), second, turning))

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
        """Apply a load along a link.

        Parameters
        ----------
        name : str
            Name of the load.
        link : Link
            The link.
        x, y : float, pair, casadi.SX or callable
            Components [N/m], on ground axes: each one value, a pair of values at both ends of the
            load, or a function of the distance xi from the base [m] that is a polynomial.
        between : tuple, optional
            Two distances from the base [m], start and end of the load; by default the whole link.
        turning : bool
            True for components on the link's axes.

        Returns
        -------
        LineLoad
            The load: see :class:`.LineLoad`.

        Raises
        ------
        DeclarationError
            If the body is not a link, the distances do not increase, or a function is not a
            polynomial of degree 7 at most.
        """
        return self._add(line_load(self.ownership, name, link, (x, y), between, turning))

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
        """Put a spring between two points. Its force acts along the line through both points: see
        :class:`.Spring`.

        Parameters
        ----------
        name : str
            Name of the load.
        first, second : Link, PointMass, Ground or Point
            Its ends.
        stiffness : float or casadi.SX
            Stiffness [N/m].
        length : float, str or casadi.SX
            Free length [m]; a longer spring pulls its ends together.
        damping : float or casadi.SX
            Damping [N s/m].

        Returns
        -------
        Spring
            The load.

        Raises
        ------
        DeclarationError
            If the name is taken.
        """
        ends = self._load_point(name, first), self._load_point(name, second)
        stiffness, length = self._load(name, stiffness, "N/m"), self._load(name, length, "m")
        damping = self._load(name, damping, "N s/m")
        return self._add(Spring(name, *ends, stiffness, length, damping))

    def damper(
        self, name: str, first: Body | Point, second: Body | Point, *, damping: Expression
    ) -> Spring:
        """Put a damper between two points. Its force acts along the line through both.

        Parameters
        ----------
        name, first, second, damping
            As of :meth:`spring`.

        Returns
        -------
        Spring
            The load, a spring without stiffness.

        Raises
        ------
        DeclarationError
            If the name is taken.
        """
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
        """Put a torsion spring on a revolute joint. The joint's angle counts revolutions.

        Parameters
        ----------
        name : str
            Name of the load.
        joint : Joint
            The joint.
        stiffness : float or casadi.SX
            Stiffness [N m/rad].
        angle : float, str or casadi.SX
            Angle of the joint without torque [rad].
        damping : float or casadi.SX
            Damping [N m s/rad].

        Returns
        -------
        Torque
            The load: on the child -stiffness (angle of the joint - ``angle``) - damping times its
            rate, on the parent the opposite.

        Raises
        ------
        DeclarationError
            If the coordinate of the joint is not an angle.
        """
        if self.ownership.joint(joint).coordinate != "angle":
            raise DeclarationError(
                f"load '{name}': joint '{joint.name}' has no angle for a torsion spring"
            )
        k, free = self._load(name, stiffness, "N m/rad"), self._load(name, angle, "rad")
        c = self._load(name, damping, "N m s/rad")
        torque = -(k * (self.coordinate(joint) - free)) - c * self.rate(joint)
        axis = times(torque, joint.turned.resolve(joint.triad[0]))
        load = self._torque(name, joint.child, axis, joint.parent, turning=self.space)
        return self._add(replace(load, coiled=True))

    def friction(
        self,
        name: str,
        joint: Joint,
        *,
        mu: Expression | None = None,
        coulomb: Expression | None = None,
        radius: Expression | None = None,
        length: Expression | None = None,
        viscous: Expression | None = None,
        static: Expression | None = None,
        stribeck: Expression | None = None,
        smooth: Expression | None = None,
        along: str = "",
    ) -> Friction:
        """Declare friction in a joint, which may depend on the joint's reaction.

        Parameters
        ----------
        name : str
            Name of the friction, as in ``friction:NAME:along``.
        joint : Joint
            A pin, a guide or a slot; in space also a screw, a spherical or a cylindrical joint.
        mu : float or casadi.SX, optional
            Friction coefficient.
        coulomb : float or casadi.SX, optional
            In place of ``mu``: friction that does not depend on the reaction [N m or N].
        radius : float or casadi.SX, optional
            Radius of the pin or ball, or mean radius of the thread [m].
        length : float or casadi.SX, optional
            Length of the guide, in space the distance of two bearings [m].
        viscous : float or casadi.SX, optional
            Viscous coefficient [N m s/rad or N s/m].
        static, stribeck : float or casadi.SX, optional
            Coefficient at the start of sliding, and the sliding speed [m/s] within which it falls
            to ``mu``.
        smooth : float or casadi.SX, optional
            Rate [rad/s or m/s] within which the sign of the rate is replaced by a tanh.
        along : str
            The coordinate, for a joint of two: ``"slide"`` or ``"turn"``.

        Returns
        -------
        Friction
            The friction, for :attr:`results`.

        Raises
        ------
        DeclarationError
            If the joint has no such friction, or a number that it needs is missing.
        """
        numbers = {"mu": mu, "coulomb": coulomb, "radius": radius, "length": length}
        numbers |= {"viscous": viscous, "static": static, "stribeck": stribeck, "smooth": smooth}
        return self._add(friction(self.ownership, name, joint, along, numbers))

    def drive(
        self,
        name: str,
        joint: Joint,
        *,
        rotor_inertia: Expression = 0.0,
        ratio: Expression = 1.0,
        armature: Expression = 0.0,
        effort: Expression | None = None,
        speed: Expression | None = None,
    ) -> Drive:
        """Declare the drive of a joint: the inertia of its rotor, and what it can do.

        Its effort is at the joint, behind the gear. The joint's parent carries the housing, and the
        rotor's mass is among that of the parent. See :class:`.Drive` for the gyroscopic terms.

        Parameters
        ----------
        name : str
            Name of the drive.
        joint : Joint
            A joint of one coordinate.
        rotor_inertia : float or casadi.SX
            Moment of inertia of what turns with the rotor, about its axis, which is along that of
            the joint [kg m^2].
        ratio : float or casadi.SX
            Turns of the rotor for one of the joint; of a slide [rad/m]. Negative for a rotor that
            turns the other way.
        armature : float or casadi.SX
            Inertia that the joint sees, for a rotor whose ratio is not known, without gyroscopic
            terms: as MuJoCo has it [kg m^2 or kg].
        effort, speed : float or casadi.SX, optional
            Largest effort [N m or N] and rate [rad/s or m/s] of the joint, for
            :meth:`.Solution.drives_used`.

        Returns
        -------
        Drive
            The drive.

        Raises
        ------
        DeclarationError
            If the joint has no coordinate or several, or has a drive, or a number is negative.
        """
        numbers = {"rotor_inertia": rotor_inertia, "armature": armature}
        numbers |= {"effort": effort, "speed": speed}
        self.drives[name] = found = drive(self.ownership, name, joint, ratio, numbers)
        return found

    def output(self, name: str, expression: Expression, *, unit: str = "1") -> UserOutput:
        """Declare an additional output ``output:NAME`` with a unit.

        Parameters
        ----------
        name : str
            Name of the output.
        expression : float or casadi.SX
            It may use everything that loads may use, and :attr:`results`: accelerations, efforts,
            reactions, loads, friction, multipliers and section forces.
        unit : str
            Its unit, by default none.

        Returns
        -------
        UserOutput
            The output.

        Raises
        ------
        DeclarationError
            If the name is taken, or the expression has other symbols.
        """
        self.ownership.free("output", name, self.outputs)
        check_line(f"output '{name}': its unit", unit)
        expression = ca.SX(
            self.ownership.expression(f"output '{name}'", expression, moving=True, found=True)
        )
        every = self.asked.values()
        made_of = tuple(asked for asked in every if ca.depends_on(expression, asked.symbol))
        self.outputs[name] = UserOutput(name, expression, unit, made_of)
        return self.outputs[name]

    def path(self, name: str, point: Body | Point) -> Path:
        """Declare a point whose motion is an output, and may be prescribed by a scene.

        Parameters
        ----------
        name : str
            Name of the path. Its outputs in SI units are NAME_x, NAME_vx, NAME_ax, and the same for
            y.
        point : Link, PointMass or Point
            The point, not of the ground; a link stands for its base.

        Returns
        -------
        Path
            The path.

        Raises
        ------
        DeclarationError
            If the name is taken, or the point is of the ground.
        """
        self.ownership.free("path", name, self.paths)
        path = Path(name, self.ownership.point(f"path '{name}'", point))
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
        """Return the symbol of a joint's coordinate, for loads and constraints.

        Parameters
        ----------
        joint : Joint
            The joint.
        axis : str
            Name of the coordinate, as ``turn_1``, if the joint has several.

        Returns
        -------
        casadi.SX
            The symbol [rad or m]. An angle counts revolutions from the start of the scene.

        Raises
        ------
        DeclarationError
            If the joint has no such coordinate.
        """
        return self.measures.joint(*self.ownership.moving_joint(joint, axis)).places[0]

    def rate(self, joint: Joint, axis: str = "") -> Expression:
        """Return the symbol of a joint's rate, for loads and non-holonomic constraints.

        Parameters
        ----------
        joint, axis
            As of :meth:`coordinate`.

        Returns
        -------
        casadi.SX
            The symbol [rad/s or m/s].

        Raises
        ------
        DeclarationError
            If the joint has no such coordinate.
        """
        return self.measures.joint(*self.ownership.moving_joint(joint, axis)).rates[0]

    def place(self, point: Body | Point) -> tuple[Expression, ...]:
        """Return the symbols of a point's place, for loads and constraints.

        Parameters
        ----------
        point : Link, PointMass, Ground or Point
            The point; a link stands for its base.

        Returns
        -------
        tuple of casadi.SX
            x and y, in space also z, on ground axes [m].

        Raises
        ------
        DeclarationError
            If the point is of another mechanism.
        """
        return self.measures.point(self.ownership.point("place", point)).places

    def velocity(self, point: Body | Point) -> tuple[Expression, ...]:
        """Return the symbols of a point's velocity, for loads and non-holonomic constraints.

        Parameters
        ----------
        point
            As of :meth:`place`.

        Returns
        -------
        tuple of casadi.SX
            Components on ground axes [m/s].

        Raises
        ------
        DeclarationError
            If the point is of another mechanism.
        """
        return self.measures.point(self.ownership.point("velocity", point)).rates

    def direction(self, link: Link) -> Expression:
        """Return the symbol of the direction of a link.

        Parameters
        ----------
        link : Link
            The link.

        Returns
        -------
        casadi.SX
            Angle of its axis from the ground's x axis [rad], counter-clockwise. It counts
            revolutions as a coordinate does.

        Raises
        ------
        DeclarationError
            If the body is not a link, and in space, where a link has no single angle.
        """
        if self.space:
            raise DeclarationError(
                "direction: a link in space has no single angle; use place() of its points, or"
                " coordinate()"
            )
        if not isinstance(body := self.ownership.point("direction", link).body, Link):
            raise DeclarationError(f"direction: expected a link, got '{body.name}'")
        return self.measures.link(body).places[0]

    def set_gravity(self, x: Expression, y: Expression) -> None:
        """Set the acceleration of gravity.

        Parameters
        ----------
        x, y : float or casadi.SX
            Components [m/s^2] on ground axes, numbers or expressions of parameters.

        Raises
        ------
        DeclarationError
            If a scene has been made.
        """
        self.ownership.refuse_frozen("set gravity")
        self.gravity = self.ownership.vector("gravity", (x, y), "m/s^2")

    def freeze(self) -> None:
        """Check the whole mechanism and end the declaration.

        Raises :class:`DeclarationError` for a part that is not connected to the ground, and for a
        link without a mass.
        """
        if not self.moving:
            raise DeclarationError(f"mechanism '{self.name}' has no link and no point mass")
        check_connected(self.name, self.ground, self.moving, self.joints.values())
        for name, link in self.links.items():
            if link.mass is UNDECLARED:
                raise DeclarationError(f"link '{name}': expected either mass= or density=")
        self.frozen = True

    def values(self, overrides: Mapping[str, float] | None = None) -> dict[str, float]:
        """Return the values of all parameters.

        Parameters
        ----------
        overrides : mapping, optional
            Values by name, in the parameters' units, in place of the defaults.

        Returns
        -------
        dict
            Values by name.

        Raises
        ------
        UnknownNameError
            For a name that is not a parameter.
        ParameterError
            For values that are not finite, out of their range, or make a part impossible: a length
            that is not positive, a negative mass or density, a load point outside its link, or a
            mechanism without mass.
        """
        values = parameter_values(self.parameters, overrides)
        demands(self).check(list(values.values()), lambda e: self.number(e, values))
        return values

    def _joint(
        self,
        name: str,
        kind: JointKind,
        parent: Body | Point,
        child: Body | Point,
        axis: tuple[Expression, Expression] | None = None,
        angle: Expression | None = None,
    ) -> Joint:
        own, what = self.ownership, f"joint '{name}'"
        own.free("joint", name, self.joints)
        start, end = own.point(what, parent), own.point(what, child)
        check_ends(what, kind, start, end)
        along = directed(f"{what}: axis", (1.0, 0.0) if axis is None else axis, own)
        turn = 0.0 if angle is None else own.expression(f"{what}: angle", angle, "rad")
        joint = Joint.flat(name, kind, start, end, along, turn, turn_given=angle is not None)
        return self.joints.setdefault(name, joint)

    def _load_point(self, name: str, place: Body | Point) -> Point:
        self.ownership.free("load", name, self.loads)
        return self.ownership.point(f"load '{name}'", place)

    def _load(self, name: str, value: Expression, unit: str) -> Expression:
        return self.ownership.expression(f"load '{name}'", value, unit, moving=True)

    def _add(self, load: _Load) -> _Load:
        self.loads[load.name] = load
        return load
