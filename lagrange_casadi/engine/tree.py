"""The spanning tree of a mechanism: which joints carry the coordinates, and which close loops.

The tree is grown from the ground, always by the joint of the highest rank in reach, then the one
nearest the ground, then the one declared first. Driven joints rank first, so that a driven motion
is a coordinate of its own; then screws, whose turns nothing else counts; then joints that hold a
direction, so that directions tied together stay one coordinate; then pins; a point mass on a line
last, since opening it leaves a single equation.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush
from typing import NoReturn, TypeAlias

from ..errors import DeclarationError
from ..model.declared_parts import Body, Ground, Link, Point, PointMass
from ..model.joints import Axis, Joint
from ..model.mechanism import Mechanism
from ..model.spatial import SpatialMechanism
from .two_force_links import TwoForceLink, find_two_force_links


@dataclass(frozen=True, eq=False)
class Branch:
    """A joint of the tree; ``reverse`` where the tree runs from the joint's child to its parent."""

    joint: Joint
    reverse: bool

    @property
    def near(self) -> Point:
        """The joint's point on the body nearer the ground."""
        return self.joint.child if self.reverse else self.joint.parent

    @property
    def far(self) -> Point:
        """The joint's point on the body that hangs on it."""
        return self.joint.parent if self.reverse else self.joint.child

    @property
    def sign(self) -> int:
        """1, or -1 where the tree runs against the joint."""
        return -1 if self.reverse else 1


Step: TypeAlias = tuple[Point, Joint, Point]
"""The way from one body to the next, by a point of each."""


@dataclass(frozen=True, eq=False)
class Tree:
    """``branches`` in an order in which each hangs on the ground or on an earlier one; ``closing``
    joints close the loops.

    ``two_force_links`` lie between bodies of the tree, and close loops as well.
    """

    branches: tuple[Branch, ...]
    closing: tuple[Joint, ...]
    two_force_links: tuple[TwoForceLink, ...] = ()

    @cached_property
    def branch_of(self) -> dict[str, Branch]:
        """The branch of each joint that closes no loop, by the joint's name."""
        return {branch.joint.name: branch for branch in self.branches}

    @cached_property
    def two_force_link_of(self) -> dict[Joint, TwoForceLink]:
        """The two-force link of each joint that is at an end of one."""
        return {joint: link for link in self.two_force_links for joint in link.joints}

    @cached_property
    def lines(self) -> dict[Body, Joint]:
        """The joint of each point mass of a plane, and of each link in space, that closes a loop by
        a line of the ground: what the line bears of the mass is no difference of what other joints
        bear.
        """
        return {
            body: joint
            for joint in self.closing
            for body in (joint.child.body,)
            if isinstance(joint.parent.body, Ground)
            and (
                joint.slides and not body.oriented
                if joint.planar
                else joint.kind == "cylindrical" and body.oriented
            )
        }

    def around(self, joint: Joint) -> list[Step]:
        """The way around a loop that a joint closes, from body to body and back, by itself last."""
        led = {branch.far.body: branch for branch in self.branches}
        ways: list[list[Branch]] = [[], []]
        for way, body in zip(ways, joint.bodies, strict=True):
            while body in led:
                way.append(led[body])
                body = led[body].near.body
        up = [(b.far, b.joint, b.near) for b in ways[0] if b not in ways[1]]
        down = [(b.near, b.joint, b.far) for b in reversed(ways[1]) if b not in ways[0]]
        return [*up, *down, (joint.child, joint, joint.parent)]

    def measures(self, joint: Joint, axis: Axis) -> bool:
        """Return whether the motion of a joint along an axis is an output: not the angles of one
        with three turns that closes a loop.
        """
        return axis.kind == "slide" or joint.turns < 3 or joint.name in self.branch_of


def span(mechanism: Mechanism, driven: Collection[str]) -> Tree:
    """The spanning tree of a frozen mechanism whose coordinates ``driven`` have a prescribed
    motion.

    Raises :class:`DeclarationError` for drives that close a loop among themselves, and for a link
    that only slides on a point.
    """
    tree, lacking = grow(mechanism, driven)
    _refuse_unplaced(mechanism, lacking)
    _refuse_unused(mechanism, tree.two_force_links)
    moved = {joint for name, (joint, _) in mechanism.coordinates.items() if name in driven}
    for joint in tree.closing:
        if joint in moved:
            _refuse_driven(mechanism, joint, tree, driven)
        if joint.kind == "screw":
            # Where its bodies are does not show how often it has turned.
            raise DeclarationError(
                f"joint '{joint.name}' is a screw between bodies whose positions already follow"
                " from drives and other screws; drive the screw itself, or replace it by a"
                " constraint between their coordinates"
            )
    return tree


def grow(mechanism: Mechanism, driven: Collection[str]) -> tuple[Tree, list[Link | PointMass]]:
    """The tree as far as joints carry it, and the bodies that it has no place for."""
    two_force_links = find_two_force_links(mechanism, driven)
    barred = {joint for one in two_force_links for joint in one.joints}
    joints = [joint for joint in mechanism.joints.values() if joint not in barred]
    driven = {joint.name for name, (joint, _) in mechanism.coordinates.items() if name in driven}
    # What a driven joint can carry one way only is left to it, for its motion would else close a
    # loop.
    kept = {
        j.child.body
        for j in joints
        if j.name in driven and (_can_carry(j, False), _can_carry(j, True)) == (True, False)
    }
    at: dict[Body, list[int]] = {}
    for number, joint in enumerate(joints):
        for body in joint.bodies:
            at.setdefault(body, []).append(number)
    depth: dict[Body, int] = {}
    branches: list[Branch] = []
    reachable: list[tuple[bool, int, int, int]] = []

    def place(body: Body, far: int) -> None:
        """Place a body, and note the joints that then are in reach, the best first."""
        depth[body] = far
        for number in at.get(body, ()):
            branch = Branch(joints[number], joints[number].parent.body not in depth)
            if branch.far.body not in depth and _can_carry(branch.joint, branch.reverse):
                free = branch.joint.name not in driven
                rank = _rank(branch.joint, driven)
                heappush(reachable, (branch.far.body in kept and free, -rank, far, number))

    place(mechanism.ground, 0)
    while reachable:
        *_, number = heappop(reachable)
        branch = Branch(joints[number], joints[number].parent.body not in depth)
        if branch.far.body not in depth:
            branches.append(branch)
            place(branch.far.body, depth[branch.near.body] + 1)
    taken = {branch.joint for branch in branches}
    waiting = [joint for joint in joints if joint not in taken]
    lying = {one.link for one in two_force_links}
    lacking = [body for body in mechanism.moving if body not in depth and body not in lying]
    return Tree(tuple(branches), tuple(waiting), two_force_links), lacking


def _refuse_unplaced(mechanism: Mechanism, lacking: Sequence[Body]) -> None:
    """Raise :class:`DeclarationError` for a body that neither tree nor bars have a place for."""
    for body in lacking:
        if mechanism.space:
            raise DeclarationError(
                f"'{body.name}' is connected by two-force links only; declare a free() joint from"
                " the ground to it, which transmits no force"
            )
        raise DeclarationError(
            f"link '{body.name}' is connected by sliding on a point only; pin it to a point mass,"
            " of mass 0 if need be, that slides in its place"
        )


def _refuse_unused(mechanism: Mechanism, two_force_links: Sequence[TwoForceLink]) -> None:
    """Raise :class:`DeclarationError` for a link whose ``between`` or ``beside`` nothing takes.

    A bar takes ``beside``, and so does a joint that is given in the reference posture; ``turned``
    is named in place of ``between``.
    """
    if not isinstance(mechanism, SpatialMechanism):
        return
    taken = {
        body
        for joint in mechanism.joints.values()
        if joint.name in mechanism.hard
        for body in joint.bodies
    }
    taken |= {one.link for one in two_force_links}
    turned = {
        body
        for joint in mechanism.joints.values()
        if joint.turned.angle is None
        for body in joint.bodies
    }
    for link in mechanism.links.values():
        if (
            link.name not in mechanism.references
            or link in taken
            or (link.beside is None and link in turned)
        ):
            continue
        reason = (
            "beside= gives its y axis"
            if link.beside is not None
            else ("between= gives its position")
        )
        way_out = "leave beside out" if link.beside is not None else "give its length"
        raise DeclarationError(
            f"link '{link.name}': {reason} in the reference posture, but none of its joints has a"
            f" position there; give one of them at=, its position, or {way_out} and give turned=,"
            " the orientation of the link"
        )


def _refuse_driven(
    mechanism: Mechanism, joint: Joint, tree: Tree, given: Collection[str]
) -> NoReturn:
    """Raise :class:`DeclarationError` for a driven joint that closes a loop; ``given`` are the
    coordinates that have a motion.
    """
    axes = [axis for _, one, _ in tree.around(joint) for axis in one.axes if mechanism.space]
    following = [axis.coordinate for axis in axes if axis.coordinate not in given]
    if following:
        raise DeclarationError(
            f"joint '{joint.name}': every joint of its loop has a given motion, so"
            f" {', '.join(following)} cannot follow; remove the motion of one joint (it may still"
            " be listed in drives=)"
        )
    if joint.kind == "slot" and joint.child.body.oriented:
        raise DeclarationError(
            f"joint '{joint.name}' is a slot and cannot be driven; drive another joint of its loop"
        )
    raise DeclarationError(
        f"the drive of joint '{joint.name}' is redundant: the positions of its bodies already"
        " follow from the other driven joints; remove one of these drives"
    )


def _can_carry(joint: Joint, reverse: bool) -> bool:
    """Return whether a joint can place a body: in a plane a point on a line places neither the body
    that carries the line, nor the direction of the one that slides.
    """
    if not joint.planar:
        return not reverse or (
            joint.parent.body.oriented and (joint.child.body.oriented or joint.turns == 3)
        )
    if joint.slides and not joint.holds_direction:
        return not reverse and not joint.child.body.oriented
    return not (reverse and joint.kind == "weld" and not joint.child.body.oriented)


def _rank(joint: Joint, driven: Collection[str]) -> int:
    if joint.name in driven:
        return 4
    if joint.kind == "screw":
        return 3
    if joint.holds_direction:
        return 2
    if not joint.planar:
        # What lets more free is rather cut: fewer equations close it.
        return 1 - len(joint.freedoms)
    return 0 if joint.slides else 1
