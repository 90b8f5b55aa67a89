"""Mechanisms in space: the same declaration, with three components where a plane has two."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from ..base.arguments import public
from ..base.rotation import Rotation
from ..base.symbolic import symbolic
from ..errors import DeclarationError, check_kind
from .beams.beam import Beam
from .declared_parts import Body, Expression, Ground, Link, Point, PointMass, Vector
from .directions import Reference, triad_of, turned_by
from .directions import between as lying
from .joints import Joint, JointKind, Triad, check_ends
from .link_density import Density
from .load_arguments import Between, LoadDensity, line_load
from .loads import Force, LineLoad, Torque
from .measures import Measures
from .mechanism import Mechanism

Turns = Sequence[tuple[str, Expression]] | tuple[Vector, Vector]
"""Turns in sequence, each about the ``"x"``, ``"y"`` or ``"z"`` axis that the turns before it
carry, by an angle [rad, or text].

Or the directions of the child's x and y axes, in the parent's axes.
"""


@public
@symbolic
@dataclass(eq=False, repr=False)
class SpatialMechanism(Mechanism):
    """A mechanism under declaration whose links lie in space.

    What is common with :class:`.Mechanism` reads the same.

    Points are (x, y, z), axes and gravity have three components; gravity is (0, 0, -9.81) m/s^2
    unless :meth:`set_gravity` says otherwise. A link's x axis runs from its base to its tip; y and
    z are the axes of its cross-section.

    Where things are is said in one of two ways, joint by joint:

    - *relative*: a joint is between a point of its parent and a point of its child, its ``axis`` in
      the parent's axes, and ``turned`` turns the child against the parent;
    - *hard points*: all is said in ground axes, in one reference posture. A link lies ``between``
      two places, a joint is ``at`` a place, its ``axis`` in ground axes; coordinates are zero in
      the reference posture, from where loops are assembled.
    """

    space: ClassVar[bool] = True
    gravity: Vector = field(default=(0.0, 0.0, -9.81), init=False)
    measures: Measures = field(default_factory=lambda: Measures(components="xyz"), init=False)
    references: dict[str, Reference] = field(default_factory=dict, init=False)
    hard: set[str] = field(default_factory=set, init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.references[self.ground.name] = Reference()

    def link(  # type: ignore[override]
        self,
        name: str,
        *,
        length: Expression = None,
        between: tuple[Vector, Vector] | None = None,
        beside: Vector | None = None,
        mass: Expression = None,
        density: Density | None = None,
        centre: Vector | None = None,
        inertia: Expression = None,
        accept_inertia: bool = False,
        beam: Beam | None = None,
    ) -> Link:
        """Declare a link: a body with a straight x axis from its base to its tip.

        Parameters
        ----------
        name : str
            Name of the link.
        length : float, str or casadi.SX, optional
            Distance of the tip from the base [m], if its position follows from its joint.
        between : tuple, optional
            Base and tip in the reference posture, two places (x, y, z) on ground axes [m].
        beside : tuple, optional
            For a link ``between`` places: a direction on ground axes whose component across the
            link is its y axis; by default the ground's axis that is most nearly at right angles to
            the link.
        mass : float, str or casadi.SX, optional
            Mass [kg]. Alone, it is that of a uniform slender rod.
        density : Density, optional
            Mass per length, of :mod:`.density`, in place of ``mass``.
        centre : tuple, optional
            Centre of mass (x, y, z) [m]; with ``mass`` and ``inertia`` the link is a rigid body
            without sections.
        inertia : tuple or matrix, optional
            Three moments of inertia about the centre, or a matrix of three rows [kg m^2].
        accept_inertia : bool
            True for moments of inertia that no body has, as some files of robots give them: with a
            negative one the energy may be negative.
        beam : Beam, optional
            Cross-section and material; the mass follows from them unless it is given too.

        Returns
        -------
        Link
            The link. It stands for its base; ``tip`` is its other end, ``at(x, y, z)`` another
            point.

        Raises
        ------
        DeclarationError
            If the name is taken, or the arguments do not determine the length.

        Notes
        -----
        ``centre`` and ``inertia`` are on the link's axes, for a link ``between`` places on ground
        axes, in the reference posture. The y axis is fixed in the link, with one exception: a
        two-force link, slender and between two spherical joints, spins freely. At every instant its
        y axis is the component of ``beside``, fixed in the ground, across the link. Without
        ``beside`` its stresses are evaluated only if its cross-section is round.
        """
        self.ownership.free("link", name, self.bodies)
        what = f"link '{name}'"
        if (length is None) == (between is None):
            raise DeclarationError(f"{what}: expected its length, or between=, its two ends")
        if beside is not None and between is None:
            raise DeclarationError(
                f"{what}: beside needs between; the orientation of a link with a length follows"
                " from its joint"
            )
        if accept_inertia and centre is None:
            raise DeclarationError(f"{what}: accept_inertia needs centre= and inertia=")
        reference, aside = None, None
        if between is not None:
            reference, length, aside = lying(what, between, beside, self.ownership)
        masses = mass, density, centre, inertia, accept_inertia
        link = self._link(name, length, masses, beam, reference, aside)
        if reference is not None:
            self.references[name] = reference
        return link

    def at(self, body: Body, x: Expression, y: Expression, z: Expression) -> Point:
        """Return the point of a body at a place of the reference posture.

        Parameters
        ----------
        body : Link, PointMass or Ground
            The body.
        x, y, z : float or casadi.SX
            The place on ground axes [m].

        Returns
        -------
        Point
            The point, which moves with the body.

        Raises
        ------
        DeclarationError
            If the body has no position in the reference posture.
        """
        check_kind("place", body, "a body", Ground, Link, PointMass)
        what = f"place on '{body.name}'"
        return self._reference(what, body).point(body, self.ownership.vector(what, (x, y, z), "m"))

    def revolute(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: Vector = (0.0, 0.0, 1.0),
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Let ``child`` turn about ``axis`` through a point of ``parent``.

        Parameters
        ----------
        name : str
            Name of the joint.
        parent, child : Link, PointMass, Ground or Point
            The points that coincide. A link stands for its base, the ground for its origin.
        axis : tuple
            Direction (x, y, z) on the parent's axes; with ``at`` on ground axes.
        at : tuple, optional
            Place (x, y, z) [m] in the reference posture, in place of points of the bodies.
        turned : tuple, optional
            Turns of the child against the parent at zero coordinates, as ``[("x", "90 deg")]``, or
            the directions of its x and y axes; not with ``at``. By default as in the reference
            posture, else none.

        Returns
        -------
        Joint
            The joint. Its coordinate is the child's angle about the axis [rad], right-handed.

        Raises
        ------
        DeclarationError
            If it joins a body to itself, a direction has no length, or a body has no position in
            the reference posture for ``at``.
        """
        return self._spatial(name, "revolute", (parent, child), (axis, None), at, turned)

    def prismatic(  # type: ignore[override]
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: Vector,
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Let a point of ``child`` slide along ``axis`` through a point of ``parent``.

        The child does not turn: ``axis`` does not turn it, ``turned`` does.

        Parameters
        ----------
        name, parent, child, axis, at, turned
            As of :meth:`revolute`.

        Returns
        -------
        Joint
            The joint. Its coordinate is the position along the axis [m].
        """
        return self._spatial(name, "prismatic", (parent, child), (axis, None), at, turned)

    def cylindrical(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: Vector,
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Let ``child`` slide along ``axis`` and turn about it.

        Parameters
        ----------
        name, parent, child, axis, at, turned
            As of :meth:`revolute`.

        Returns
        -------
        Joint
            The joint, with the coordinates ``slide`` [m] and ``turn`` [rad].
        """
        return self._spatial(name, "cylindrical", (parent, child), (axis, None), at, turned)

    def universal(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: Vector,
        second: Vector,
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Let ``child`` turn about two axes at right angles.

        Parameters
        ----------
        axis, second : tuple
            Directions at zero coordinates: the first is carried by the parent, the second by the
            child.
        name, parent, child, at, turned
            As of :meth:`revolute`.

        Returns
        -------
        Joint
            The joint, with the coordinates ``turn_1`` and ``turn_2`` [rad] about them.
        """
        return self._spatial(name, "universal", (parent, child), (axis, second), at, turned)

    def spherical(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: Vector | None = None,
        second: Vector | None = None,
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Hold a point of ``child`` at a point of ``parent``.

        Parameters
        ----------
        axis, second : tuple, optional
            Directions of the first two rotations, by default x and y; the third is at right angles
            to both. Each is turned by those before.
        name, parent, child, at, turned
            As of :meth:`revolute`.

        Returns
        -------
        Joint
            The joint, with the coordinates ``turn_1`` to ``turn_3`` [rad]; none if it closes a
            loop.
        """
        return self._spatial(name, "spherical", (parent, child), (axis, second), at, turned)

    def screw(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: Vector,
        lead: Expression,
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Let ``child`` turn about ``axis`` and slide along it.

        Parameters
        ----------
        name, parent, child, axis, at, turned
            As of :meth:`revolute`.
        lead : float, str or casadi.SX
            Slide along the axis for each revolution [m].

        Returns
        -------
        Joint
            The joint. Its coordinate is the angle [rad].
        """
        pitch = self.ownership.expression(f"joint '{name}': lead", lead, "m") / math.tau
        return self._spatial(name, "screw", (parent, child), (axis, None), at, turned, pitch)

    def planar(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: Vector,
        second: Vector | None = None,
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Let ``child`` move in the plane normal to ``axis`` through a point of ``parent``.

        Parameters
        ----------
        axis, second : tuple
            Normal of the plane, and a direction in it, by default any.
        name, parent, child, at, turned
            As of :meth:`revolute`.

        Returns
        -------
        Joint
            The joint, with the coordinates ``slide_1`` [m] along ``second``, ``slide_2`` at right
            angles to both, and ``turn`` [rad] about ``axis``.
        """
        return self._spatial(name, "planar", (parent, child), (axis, second), at, turned)

    def slot(  # type: ignore[override]
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: Vector = (1.0, 0.0, 0.0),
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Let ``child`` turn freely about its point, which slides along a line of ``parent``.

        Parameters
        ----------
        name, parent, child, axis, at, turned
            As of :meth:`revolute`.

        Returns
        -------
        Joint
            The joint, with the coordinate ``slide`` [m] and those of a spherical joint; with the
            slide only if it closes a loop.
        """
        return self._spatial(name, "slot", (parent, child), (axis, None), at, turned)

    def weld(  # type: ignore[override]
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Fix ``child`` to ``parent``.

        Parameters
        ----------
        name, parent, child, at, turned
            As of :meth:`revolute`.

        Returns
        -------
        Joint
            The joint, without coordinates.
        """
        return self._spatial(name, "weld", (parent, child), (None, None), at, turned)

    def free(
        self,
        name: str,
        parent: Body | Point,
        child: Body | Point,
        *,
        axis: Vector | None = None,
        second: Vector | None = None,
        at: Expression = None,
        turned: Turns = (),
    ) -> Joint:
        """Connect two bodies without any force, to prescribe a pose, or to let ``child`` fly.

        Parameters
        ----------
        axis, second : tuple, optional
            Directions of the first two coordinates, by default the parent's x and y; the third is
            at right angles to both.
        name, parent, child, at, turned
            As of :meth:`revolute`.

        Returns
        -------
        Joint
            The joint, with the coordinates ``slide_1`` to ``slide_3`` [m] of the child's point
            along them, and ``turn_1`` to ``turn_3`` [rad] of a spherical joint.
        """
        return self._spatial(name, "free", (parent, child), (axis, second), at, turned)

    def contact(  # type: ignore[override]
        self,
        name: str,
        point: Body | Point,
        *,
        friction: Expression,
        normal: Vector = (0.0, 0.0, 1.0),
        at: Expression = None,
    ) -> Joint:
        """Let a point of a body stand on the ground, as :meth:`.Mechanism.contact` does.

        Parameters
        ----------
        name : str
            Name of the contact, which is a spherical joint.
        point, friction
            As of :meth:`.Mechanism.contact`.
        normal : tuple
            Direction (x, y, z) out of the ground.
        at : tuple, optional
            Place (x, y, z) of the point [m], by default that of the reference posture.

        Returns
        -------
        Joint
            The joint, from the ground to the body.

        Raises
        ------
        DeclarationError
            If the coefficient is negative, the normal has no length, or the body has no position
            in the reference posture and ``at`` is missing.
        """
        if at is None:
            foot = self.ownership.point(f"contact '{name}'", point)
            if foot.body.name not in self.references:
                raise DeclarationError(
                    f"contact '{name}': '{foot.body.name}' has no position in the reference"
                    " posture; expected at=, the place of the point"
                )
            at = self.references[foot.body.name].place(foot.place)
        return self._contact(name, point, friction, at, normal, self.spherical)

    def force(
        self,
        name: str,
        point: Body | Point,
        *,
        x: Expression = 0.0,
        y: Expression = 0.0,
        z: Expression = 0.0,
        turning: bool = False,
    ) -> Force:
        """Apply a force at a point.

        Parameters
        ----------
        name : str
            Name of the load.
        point : Link, PointMass or Point
            The point, not of the ground; a link stands for its base.
        x, y, z : float or casadi.SX
            Components [N], on ground axes.
        turning : bool
            True for components on the axes of the body.

        Returns
        -------
        Force
        """
        return self._force(name, point, (x, y, z), turning)

    def torque(  # type: ignore[override]
        self,
        name: str,
        point: Body | Point,
        *,
        x: Expression = 0.0,
        y: Expression = 0.0,
        z: Expression = 0.0,
        against: Body | Point | None = None,
        turning: bool = False,
    ) -> Torque:
        """Apply a torque to a body at a point, and the opposite torque to another.

        Parameters
        ----------
        name : str
            Name of the load.
        point : Link or Point
            The point, which matters only to the sections of a link.
        x, y, z : float or casadi.SX
            Components [N m], on ground axes.
        against : Link, Ground or Point, optional
            Body with the opposite torque, by default the ground.
        turning : bool
            True for components on the axes of the body.

        Returns
        -------
        Torque
        """
        return self._torque(name, point, (x, y, z), against, turning)

    def line_load(
        self,
        name: str,
        link: Link,
        *,
        x: LoadDensity = 0.0,
        y: LoadDensity = 0.0,
        z: LoadDensity = 0.0,
        between: Between = None,
        turning: bool = False,
    ) -> LineLoad:
        """Apply a load along a link, as in a plane.

        Parameters
        ----------
        name, link, between
            As of :meth:`.Mechanism.line_load`.
        x, y, z : float, pair, casadi.SX or callable
            Components [N/m], on ground axes.
        turning : bool
            True for components on the link's axes.

        Returns
        -------
        LineLoad
        """
        return self._add(line_load(self.ownership, name, link, (x, y, z), between, turning))

    def set_gravity(self, x: Expression, y: Expression, z: Expression = 0.0) -> None:
        """Set the acceleration of gravity.

        Parameters
        ----------
        x, y, z : float or casadi.SX
            Components [m/s^2] on ground axes, numbers or expressions of parameters.
        """
        self.ownership.refuse_frozen("set gravity")
        self.gravity = self.ownership.vector("gravity", (x, y, z), "m/s^2")

    def _spatial(
        self,
        name: str,
        kind: JointKind,
        bodies: tuple[Body | Point, Body | Point],
        axes: tuple[Vector | None, Vector | None],
        at: Expression,
        turned: Turns,
        pitch: Expression = 0.0,
    ) -> Joint:
        self.ownership.free("joint", name, self.joints)
        what, (parent, child) = f"joint '{name}'", bodies
        directions: Triad = triad_of(what, *axes, self.ownership)
        placed = at is not None
        if at is None:
            start, end = self.ownership.point(what, parent), self.ownership.point(what, child)
            zero = turned_by(what, turned, self.ownership)
            near, far = (self.references.get(point.body.name) for point in (start, end))
            if not turned and near and far and start.body.oriented and end.body.oriented:
                zero, placed = near.directions_of(far), True
        else:
            start, end, directions, zero = self._at_reference(
                what, parent, child, at, directions, turned
            )
        check_ends(what, kind, start, end)
        if not start.body.oriented or not end.body.oriented:
            kind = "spherical" if kind == "revolute" else kind
        given = placed or bool(turned)
        self.joints[name] = joint = Joint(
            name, kind, start, end, directions, Rotation.of(*zero), pitch, given
        )
        if placed:
            self.hard.add(name)
            self.rough |= {axis.coordinate: 0.0 for axis in joint.axes}
        return joint

    def _at_reference(
        self,
        what: str,
        parent: Body | Point,
        child: Body | Point,
        at: Expression,
        directions: Triad,
        turned: Turns,
    ) -> tuple[Point, Point, Triad, tuple[Vector, Vector]]:
        """Points, directions and orientation of a joint from where it is
        in the reference posture.
        """
        if turned:
            raise DeclarationError(
                f"{what}: turned needs points of bodies; at= already sets the reference posture"
            )
        for body in (parent, child):
            if not isinstance(body, Body) or self.bodies.get(body.name) is not body:
                got = f"a point of '{body.body.name}'" if isinstance(body, Point) else repr(body)
                raise DeclarationError(
                    f"{what}: at needs bodies of '{self.name}', not their points, got {got}"
                )
        assert isinstance(parent, Body)
        assert isinstance(child, Body)
        place = self.ownership.vector(f"{what}: at", at, "m")
        for body in (parent, child):
            if isinstance(body, PointMass) and body.name not in self.references:
                self.references[body.name] = Reference(place)
        first, second = self._reference(what, parent), self._reference(what, child)
        start, end = (
            self.ownership.point(what, one.point(body, place))
            for one, body in ((first, parent), (second, child))
        )
        return start, end, first.directions(directions), first.directions_of(second)

    def _reference(self, what: str, body: Body) -> Reference:
        if body.name not in self.references:
            raise DeclarationError(
                f"{what}: '{body.name}' has no position in the reference posture; declare"
                f" '{body.name}' with between=, the places of its two ends, or give the joint a"
                " point of each body in place of at="
            )
        return self.references[body.name]
