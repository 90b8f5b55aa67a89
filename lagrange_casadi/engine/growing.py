"""Frames grown outward from the ground along the spanning tree, and the coordinates that place
them.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.frames import Frame
from ..base.rotation import Rotation
from ..base.scalars import column
from ..base.vectors import AXES, ZERO, cross, dot, minus, plus, times
from ..model.declared_parts import Link, Point, Vector
from ..model.joints import Axis, Joint
from ..model.mechanism import Mechanism
from .joint_closure import turning_axes
from .multibody import Coordinate, Turned, motion_along, own_coordinate, split
from .sizes import reach
from .spherical import SphericalCoordinates
from .tree import Branch, Tree
from .two_force_links import TwoForceLink, two_force_frame


class Grown:
    """Frames of bodies, grown body by body."""

    def __init__(
        self, mechanism: Mechanism, carried: Mapping[str, tuple[Coordinate, ...]], ground: Frame
    ) -> None:
        self.mechanism = mechanism
        self.carried = carried
        self.coordinates = tuple(coordinate for found in carried.values() for coordinate in found)
        self.frames: dict[str, Frame] = {mechanism.ground.name: ground}
        self.mobilities: dict[str, Any] = {}
        self.own_axes: set[str] = set()
        self.turned: dict[str, Turned] = {}
        self.turning: dict[str, Vector] = {}

    def ends(self, joint: Joint) -> tuple[Frame, Frame]:
        """The frames of a joint's parent and child."""
        parent, child = joint.bodies
        return self.frames[parent.name], self.frames[child.name]

    def hang(self, branch: Branch, *, displace: bool, along: bool = False) -> None:
        """Place a body on its branch, with the branch's mobility where wanted: in ground axes, or
        ``along`` its own if shorter.
        """
        joint = branch.joint
        frame = self._undisplaced(branch, self.carried[joint.name])
        if displace:
            space = self.mechanism.space
            many = (3, 6) if space else (2, 3)
            rates = ca.SX.sym(f"ed_{joint.name}", many[joint.bears_moment])
            self.mobilities[joint.name] = rates
            if along and branch.far.body.oriented and frame.shortest is not frame:
                frame = frame.displaced_along(*split(rates, space=space))
                self.own_axes.add(joint.name)
            else:
                frame = frame.displaced(*split(rates, space=space))
        self.frames[branch.far.body.name] = frame

    def span(
        self, two_force_link: TwoForceLink, *, displace: Collection[str]
    ) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Place a bar between its ends, with the mobilities of the named joints, and return the
        equation of its length.
        """
        self.mobilities |= {name: ca.SX.sym(f"ed_{name}", 3) for name in displace}
        self.frames[two_force_link.link.name], residual = two_force_frame(
            two_force_link, self.frames, self.mobilities
        )
        return residual

    def at_state(self, expression: Expression, *, counted: bool = False) -> ca.SX:
        """An expression of what the user measures, with rates, in the tree's own variables. Angles
        are ``counted`` by turns, or those that are not driven are symbols of their own, for
        :mod:`.revolutions`.
        """
        symbols: list[Any] = []
        values: list[Any] = []
        for measure in self.mechanism.measures.asked.values():
            of = measure.of
            if not ca.depends_on(
                ca.SX(expression),
                ca.vertcat(*measure.places, *measure.rates, *measure.accelerations),
            ):
                continue
            symbols += [*measure.places, *measure.rates, *measure.accelerations]
            if isinstance(of, Joint):
                assert measure.axis is not None
                local = own_coordinate(measure.axis, self.coordinates)
                known = (
                    counted or measure.axis.kind == "slide" or (local is not None and local.driven)
                )
                place, *rates = motion_along(of, measure.axis, self.frames, self.coordinates)
                values += [place if known else self._counted_angle(of, measure.axis), *rates]
            elif isinstance(of, Point):
                frame, many = self.frames[of.body.name], len(measure.places)
                speed, acceleration = frame.motion_of(of.place)
                values += [*frame.place_of(of.place)[:many], *speed[:many], *acceleration[:many]]
            else:
                frame = self.frames[of.name]
                values += [
                    frame.rotation.angle if counted else self._counted_angle(of),
                    frame.rate[2],
                    frame.angular[2],
                ]
        return ca.substitute(ca.SX(expression), column(symbols), column(values))

    def vector_at_state(self, vector: Vector) -> Vector:
        """A vector of numbers, and of expressions of what the user measures, as
        :meth:`at_state`.
        """
        x, y, z = (one if isinstance(one, float) else self.at_state(one) for one in vector)
        return x, y, z

    def _counted_angle(self, of: Joint | Link, axis: Axis | None = None) -> Expression:
        """The symbol of an angle."""
        name = of.name if axis is None else axis.coordinate
        if name not in self.turned:
            local = None if axis is None else own_coordinate(axis, self.coordinates)
            if local is not None:
                variables: list[Any] = ca.vertsplit(local.variables)
                c, s, angle = variables
            elif isinstance(of, Link) or not self.mechanism.space:
                turn = self.frames[of.name].rotation if isinstance(of, Link) else self._between(of)
                c, s, angle = turn.c, turn.s, turn.angle
            else:
                assert axis is not None
                angle, *_ = motion_along(of, axis, self.frames, self.coordinates)
                c, s = ca.cos(angle), ca.sin(angle)
            symbol = ca.SX.sym(f"{name}_seen")
            self.turned[name] = Turned(name, symbol, ca.SX(c), ca.SX(s), ca.SX(angle))
        return self.turned[name].symbol

    def _between(self, joint: Joint) -> Rotation:
        parent, child = self.ends(joint)
        return child.rotation.against(parent.rotation)

    def _undisplaced(self, branch: Branch, coordinates: Sequence[Coordinate]) -> Frame:
        """The frame of the body that hangs on a branch, anchored at the
        joint's point on its child.
        """
        base = self.frames[branch.near.body.name]
        rotation, rate, angular = self._turn(branch, coordinates, base)
        slides = _slides(coordinates)
        point, anchor = _ends(branch, slides)
        speed, acceleration = base.motion_of(point)
        carrier, turning = (rotation, rate) if branch.reverse else (base.rotation, base.rate)
        ways = [(carrier.apply(times(branch.sign, direction)), c) for direction, c in slides]
        moved = _slid(Frame(speed=speed, acceleration=acceleration, rate=turning), ways)
        motion = (
            base.place_of(point),
            moved.speed,
            moved.acceleration,
            rotation,
            rate,
            angular,
            anchor,
        )
        if base.carried is None:
            return Frame(*motion)
        if free := [coordinate for coordinate in coordinates if coordinate.spherical is not None]:
            local = replace(
                _rolling(free),
                speed=rotation.resolve(moved.speed),
                acceleration=rotation.resolve(moved.acceleration),
            )
        else:
            local = _own(branch, coordinates, base.carried, base.rotation)
        return Frame(
            *motion,
            replace(local, anchor=anchor),
            base.rotations + sum(coordinate.kind != "slide" for coordinate in coordinates),
        )

    def _turn(
        self, branch: Branch, coordinates: Sequence[Coordinate], base: Frame
    ) -> tuple[Rotation, Vector, Vector]:
        """Direction, angular velocity and its change of the body that hangs on a branch."""
        if not branch.far.body.oriented:
            return Rotation(), ZERO, ZERO
        joint, motion = branch.joint, Frame(rate=base.rate, angular=base.angular)
        rotations = [c for c in coordinates if c.kind == "angle"]
        if rotations and not rotations[0].relative:
            (coordinate,) = rotations
            c, s, angle = ca.vertsplit(coordinate.variables)
            if coordinate.driven:
                motion = _spun(motion, (0.0, 0.0, branch.sign), coordinate)
                assert base.rotation.angle is not None
                angle = base.rotation.angle + branch.sign * angle
            else:
                motion = _spun(Frame(), AXES[2], coordinate)
            return Rotation.flat(c, s, angle), motion.rate, motion.angular
        if free := [c for c in coordinates if c.spherical is not None]:
            assert free[0].spherical is not None
            rotation, rolling = free[0].spherical.rotation, _rolling(free)
            return rotation, rotation.apply(rolling.rate), rotation.apply(rolling.angular)
        zero = joint.turned
        rotation = base.rotation.then(zero.inverse) if branch.reverse else base.rotation
        for coordinate in reversed(rotations) if branch.reverse else rotations:
            direction = coordinate.axis.direction
            local = Rotation.about(direction, *ca.vertsplit(coordinate.variables))
            self.turning[coordinate.name] = rotation.apply(direction)
            motion = _spun(motion, times(branch.sign, self.turning[coordinate.name]), coordinate)
            rotation = rotation.then(local.inverse if branch.reverse else local)
        return rotation if branch.reverse else rotation.then(zero), motion.rate, motion.angular

    def along(self, joint: Joint, axis: Axis) -> Vector:
        """The force or couple on a joint's child, in ground axes, that does a unit of work along an
        axis, and none along others.
        """
        parent, child = self.ends(joint)
        if axis.kind == "slide":
            return parent.rotation.apply(axis.direction)
        rotations = [one.coordinate for one in joint.axes if one.kind == "angle"]
        number = rotations.index(axis.coordinate)
        if len(rotations) < 3:
            return turning_axes(joint, parent, child)[number]
        # The first axis and the last one are not at right angles: each couple is at right angles to
        # the other two axes.
        first, second, last = (self.turning[name] for name in rotations)
        if number == 1:
            return second
        local, other = (first, last) if number == 0 else (last, first)
        slope = dot(first, last)
        return times(1 / (1 - slope * slope), minus(local, times(slope, other)))


def coordinates_of(
    mechanism: Mechanism, tree: Tree, driven: Collection[str], given: Collection[str]
) -> dict[str, tuple[Coordinate, ...]]:
    """The coordinates of every branch, by its joint; none where a branch leaves no freedom.

    A joint with three turns none of which is ``driven`` or ``given`` is a ball.
    """
    # Directions that drives alone set, and their rates, by body: of a plane.
    turned: dict[str, tuple[Any, Any]] = (
        {} if mechanism.space else {mechanism.ground.name: (ca.SX(0), ca.SX(0))}
    )
    found: dict[str, tuple[Coordinate, ...]] = {}
    size = mechanism.ownership.at_defaults(reach(mechanism))
    for branch in tree.branches:
        joint, near, far = branch.joint, branch.near.body.name, branch.far.body
        if joint.holds_direction and near in turned:
            turned[far.name] = (
                turned[near][0] + branch.sign * ca.SX(joint.turned.angle),
                turned[near][1],
            )
        local: list[Coordinate] = []
        axes = joint.axes_of(far)
        turns = [axis for axis in axes if axis.kind == "angle"]
        spherical = None
        if len(turns) == 3 and {*driven, *given}.isdisjoint(axis.coordinate for axis in turns):
            spherical = SphericalCoordinates.of(joint, near, reverse=branch.reverse)
            axes = tuple(axis for axis in axes if axis not in turns)
        for axis in axes:
            name, drives = axis.coordinate, axis.coordinate in driven
            q, rate, acceleration = (
                ca.SX.sym(f"{name}{end}") for end in ("", "_rate", "_acceleration")
            )
            if axis.kind == "slide":
                local.append(
                    Coordinate(name, far.name, axis, drives, q, rate, rate, acceleration, size=size)
                )
                continue
            turn, spin = q, rate
            if drives and near in turned:
                turn, spin = (
                    before + branch.sign * one
                    for before, one in zip(turned[near], (q, rate), strict=True)
                )
                turned[far.name] = turn, spin
            c, s = ca.SX.sym(f"cos_{name}"), ca.SX.sym(f"sin_{name}")
            variables, change = ca.vertcat(c, s, q), ca.vertcat(-s * spin, c * spin, rate)
            relative = mechanism.space or (drives and near not in turned)
            local.append(
                Coordinate(
                    name,
                    far.name,
                    axis,
                    drives,
                    variables,
                    change,
                    rate,
                    acceleration,
                    turn,
                    relative=relative,
                )
            )
        if spherical is not None:
            local += _of_spherical(spherical, far.name, turns)
        found[joint.name] = tuple(local)
    return found


def _of_spherical(
    spherical: SphericalCoordinates, body: str, axes: Sequence[Axis]
) -> list[Coordinate]:
    """The three coordinates of a ball."""
    rates, accelerations = (
        [ca.SX.sym(f"{axis.coordinate}_{what}") for axis in axes] for what in ("spin", "spin_rate")
    )
    changes = spherical.changes(rates)
    return [
        Coordinate(
            axis.coordinate,
            body,
            axis,
            False,
            spherical.axes[3 * k : 3 * k + 3],
            changes[k],
            rates[k],
            accelerations[k],
            spherical=spherical,
        )
        for k, axis in enumerate(axes)
    ]


def _rolling(free: Sequence[Coordinate]) -> Frame:
    """The turning of a ball, on its own axes."""
    x, y, z = free
    return Frame(
        rate=(x.rate, y.rate, z.rate),
        angular=(x.acceleration, y.acceleration, z.acceleration),
    )


def _slides(coordinates: Sequence[Coordinate]) -> list[tuple[Vector, Coordinate]]:
    """The coordinates along which a joint slides, each with how far and where
    a unit of it leads.
    """
    return [
        (times(c.axis.pitch, c.axis.direction) if c.axis.move == "screw" else c.axis.direction, c)
        for c in coordinates
        if c.axis.move != "turn"
    ]


def _ends(branch: Branch, slides: Sequence[tuple[Vector, Coordinate]]) -> tuple[Vector, Vector]:
    """The point of the body near the ground, and that of the one that hangs on it, that are at one
    place.
    """
    near, far = branch.near.place, branch.far.place
    for direction, coordinate in slides:
        along = times(coordinate.value, direction)
        near, far = (near, plus(far, along)) if branch.reverse else (plus(near, along), far)
    return near, far


def _slid(motion: Frame, slides: Sequence[tuple[Vector, Coordinate]]) -> Frame:
    """A motion with that along axes, which turn at the motion's rate under what slides on them
    (Coriolis).
    """
    speed, acceleration = motion.speed, motion.acceleration
    for axis, coordinate in slides:
        spin = times(coordinate.rate, times(2, motion.rate))
        change = plus(times(coordinate.acceleration, axis), cross(spin, axis))
        speed = plus(speed, times(coordinate.rate, axis))
        acceleration = plus(acceleration, change)
    return replace(motion, speed=speed, acceleration=acceleration)


def _spun(motion: Frame, axis: Vector, coordinate: Coordinate) -> Frame:
    """A motion with that about an axis, which it turns itself."""
    spin = cross(times(coordinate.rate, motion.rate), axis)
    change = plus(times(coordinate.acceleration, axis), spin)
    rate = plus(motion.rate, times(coordinate.rate, axis))
    return replace(motion, rate=rate, angular=plus(motion.angular, change))


def _own(
    branch: Branch, coordinates: Sequence[Coordinate], base: Frame, rotation: Rotation
) -> Frame:
    """The motion of the body that hangs on a branch, in its own axes: handed on from axes to axes,
    each turned from the last. The first are those of ``base``, whose direction is ``rotation``.
    """
    slides = _slides(coordinates)
    speed, acceleration = base.motion_of(_ends(branch, slides)[0])
    motion = Frame(speed=speed, acceleration=acceleration, rate=base.rate, angular=base.angular)
    if not branch.reverse:
        motion = _slid(motion, slides)
    if not branch.far.body.oriented:
        # A point has no axes of its own: the ground's.
        return replace(_seen_from(motion, rotation.inverse), rate=ZERO, angular=ZERO)
    zero, rotations = branch.joint.turned, [c for c in coordinates if c.kind == "angle"]
    if branch.reverse:
        motion = _seen_from(motion, zero.inverse)
    for coordinate in reversed(rotations) if branch.reverse else rotations:
        turn = Rotation.about(coordinate.axis.direction, *ca.vertsplit(coordinate.variables))
        motion = _spun(motion, times(branch.sign, coordinate.axis.direction), coordinate)
        motion = _seen_from(motion, turn.inverse if branch.reverse else turn)
    if not branch.reverse:
        return _seen_from(motion, zero)
    return _slid(motion, [(times(-1, direction), c) for direction, c in slides])


def _seen_from(motion: Frame, turn: Rotation) -> Frame:
    """A motion in axes that are turned."""
    speed, acceleration, rate, angular = map(
        turn.resolve, (motion.speed, motion.acceleration, motion.rate, motion.angular)
    )
    return Frame(speed=speed, acceleration=acceleration, rate=rate, angular=angular)
