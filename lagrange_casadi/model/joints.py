"""Joints: what each kind lets free, as one table, and a joint as the sequence of axes along which
it does.

A kind's freedoms are slides and turns about the directions u, v, w of the joint's triad, which the
parent carries. Slides come first; of several turns each is carried by the turns before it. A new
kind of joint is an entry of the table.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from ..base.brief import Brief
from ..base.rotation import Rotation
from ..base.vectors import AXES, cross
from ..errors import DeclarationError
from .declared_parts import Body, Expression, Point, Vector

JointKind = Literal[
    "revolute",
    "prismatic",
    "cylindrical",
    "universal",
    "spherical",
    "screw",
    "planar",
    "slot",
    "weld",
    "free",
]
Move = Literal["slide", "turn", "screw"]
Triad = tuple[Vector, Vector, Vector]


class Freedom(NamedTuple):
    """Degree of freedom of a kind of joint: a slide or turn along a direction of its triad, by
    number.

    ``name`` distinguishes it among the freedoms of its joint; None if it is no coordinate.
    """

    name: str | None
    move: Move
    direction: int


_TURNS = (Freedom("turn_1", "turn", 0), Freedom("turn_2", "turn", 1), Freedom("turn_3", "turn", 2))
_SLIDES = (
    Freedom("slide_1", "slide", 0),
    Freedom("slide_2", "slide", 1),
    Freedom("slide_3", "slide", 2),
)

IN_SPACE: dict[JointKind, tuple[Freedom, ...]] = {
    "revolute": (Freedom("", "turn", 0),),
    "prismatic": (Freedom("", "slide", 0),),
    "cylindrical": (Freedom("slide", "slide", 0), Freedom("turn", "turn", 0)),
    "universal": _TURNS[:2],
    "spherical": _TURNS,
    "screw": (Freedom("", "screw", 0),),
    "planar": (
        Freedom("slide_1", "slide", 1),
        Freedom("slide_2", "slide", 2),
        Freedom("turn", "turn", 0),
    ),
    "slot": (Freedom("slide", "slide", 0), *_TURNS),
    "weld": (),
    "free": (*_SLIDES, *_TURNS),
}
"""The freedoms of the kinds of joints, and their names."""

_PLANAR_SLOT = (Freedom("", "slide", 0), Freedom(None, "turn", 2))
"""Freedoms of a slot in a plane, whose normal is the third direction of its triad."""


@dataclass(frozen=True, eq=False)
class Axis:
    """A coordinate of a joint: along what it is measured, in the parent's axes where all
    coordinates are zero.

    ``name`` is its own among the coordinates of its joint, empty where there is one; ``coordinate``
    is its full name, ``JOINT`` or ``JOINT:NAME``. Of a screw, ``pitch`` is how far it slides for an
    angle [m/rad].
    """

    name: str
    coordinate: str
    move: Move
    direction: Vector
    pitch: Expression = 0.0

    @property
    def kind(self) -> Literal["angle", "slide"]:
        """Kind of the coordinate."""
        return "slide" if self.move == "slide" else "angle"


@dataclass(frozen=True, eq=False, repr=False)
class Joint(Brief):
    """A joint between a point of its parent and a point of its child.

    - ``revolute`` holds the two points together; the coordinate is the child's direction less the
      parent's [rad].
    - ``prismatic`` holds the child's point on a line of the parent and the child's direction; the
      coordinate is the place on the line [m].
    - ``slot`` holds the child's point on that line and leaves its direction free.
    - ``weld`` holds the points and the child's direction; it has no coordinate.

    A child that slides on a line loads the parent, which carries the line, at its present position.

    ``triad`` are three directions of length 1 at right angles that the parent carries, in its axes;
    :data:`IN_SPACE` has those along which the joint moves. ``turned`` are the child's axes as the
    parent sees them where all coordinates are zero. A ``planar`` joint holds nothing out of the x-y
    plane, for a mechanism in a plane. ``pitch`` is that of a screw [m/rad]. ``turn_given`` says
    whether ``turned`` was declared, and not taken by default.
    """

    name: str
    kind: JointKind
    parent: Point
    child: Point
    triad: Triad
    turned: Rotation
    pitch: Expression = 0.0
    turn_given: bool = True
    planar: bool = False

    @classmethod
    def flat(
        cls,
        name: str,
        kind: JointKind,
        parent: Point,
        child: Point,
        axis: Vector = AXES[0],
        angle: Expression = 0.0,
        *,
        turn_given: bool = True,
    ) -> Joint:
        """A joint of a plane, with the direction ``axis`` of its line, if it has one, and the
        ``angle`` [rad] from the parent to the child.
        """
        across, normal = cross(AXES[2], axis), AXES[2]
        slides = kind in ("prismatic", "slot")
        triad = (axis, across, normal) if slides else (normal, axis, across)
        return cls(
            name, kind, parent, child, triad, Rotation.by(angle), turn_given=turn_given, planar=True
        )

    @property
    def bodies(self) -> tuple[Body, Body]:
        """Parent and child."""
        return self.parent.body, self.child.body

    def on(self, body: Body) -> Point:
        """Point of the joint on one of its bodies."""
        return self.child if self.child.body is body else self.parent

    @property
    def freedoms(self) -> tuple[Freedom, ...]:
        """The freedoms of its kind."""
        return _PLANAR_SLOT if self.planar and self.kind == "slot" else IN_SPACE[self.kind]

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Coordinates, in the sequence in which they move the child; without directions there are
        no turns to measure.
        """
        return self._axes(turns=all(body.oriented for body in self.bodies))

    def axes_of(self, body: Body) -> tuple[Axis, ...]:
        """Coordinates that place a body, measured from whichever body of the joint is its
        parent.
        """
        return self._axes(turns=body.oriented)

    def _axes(self, *, turns: bool) -> tuple[Axis, ...]:
        found = []
        for name, move, direction in self.freedoms:
            if name is not None and (turns or move == "slide"):
                coordinate = f"{self.name}:{name}" if name else self.name
                found.append(Axis(name, coordinate, move, self.triad[direction], self.pitch))
        return tuple(found)

    @property
    def slides(self) -> bool:
        """True if the child's point moves along a line of the parent, or more."""
        return any(freedom.move != "turn" for freedom in self.freedoms)

    @property
    def holds_direction(self) -> bool:
        """True if the child's direction follows from the parent's."""
        return self.child.body.oriented and all(
            freedom.move == "slide" for freedom in self.freedoms
        )

    @property
    def turns(self) -> int:
        """About how many axes it lets its child turn."""
        return sum(freedom.move != "slide" for freedom in self.freedoms)

    @property
    def bears_moment(self) -> bool:
        """True if the joint can transmit a moment about some axis."""
        return (
            self.child.body.oriented
            and self.parent.body.oriented
            and self.turns < (1 if self.planar else 3)
        )

    @property
    def aligns(self) -> bool:
        """True if the joint holds a direction that must not be off by half a turn."""
        return self.bears_moment and self.turns < (1 if self.planar else 2)

    @property
    def coordinate(self) -> Literal["angle", "slide"] | None:
        """The kind of its coordinate, where it has one; None too for a pin at a point mass, which
        has no direction to measure.
        """
        axes = self.axes
        return axes[0].kind if len(axes) == 1 else None


def check_ends(what: str, kind: JointKind, parent: Point, child: Point) -> None:
    """Raise :class:`DeclarationError` for a joint of a body with itself, and for a parent that has
    no direction for what the joint holds.
    """
    if parent.body is child.body:
        raise DeclarationError(f"{what} joins '{parent.body.name}' to itself")
    if kind not in ("revolute", "spherical") and not parent.body.oriented:
        raise DeclarationError(
            f"{what}: its parent '{parent.body.name}' is a point mass, which has no direction for"
            f" {'the weld' if kind == 'weld' else 'the axis'}; make the other body the parent"
        )
