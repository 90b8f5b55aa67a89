"""Directions in space as users give them: axes, turns in sequence, places of a reference posture,
moments of inertia.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from ..base.rotation import Rotation, direction
from ..base.vectors import AXES, ZERO, Vector, cross, dot, minus, norm, plus, times
from ..errors import DeclarationError
from .declared_parts import Body, Expression, Link, Point
from .joints import Triad
from .limits import ROUNDED
from .ownership import Ownership

RIGHT = 1e-9
"""A cosine that is smaller is that of a right angle."""

SAME = 1e-12
"""Numbers that differ by less, over a size beside them, are one but for rounding."""

FAINT = 1e-15
"""A component of a direction that is smaller is rounding."""


@dataclass(frozen=True, eq=False)
class Reference:
    """Pose of a body in the reference posture: its origin, its axes, and the tip of a link, in
    ground axes.
    """

    origin: Vector = ZERO
    rotation: Rotation = Rotation()  # noqa: RUF009 - it is frozen
    tip: Vector | None = None

    def point(self, body: Body, place: Vector) -> Point:
        """The body's point at a place; of a link its base or tip to the last digit, where that is
        the place but for rounding.
        """
        if isinstance(body, Link) and self.tip is not None:
            for end, there in ((body.base, self.origin), (body.tip, self.tip)):
                if all(
                    _is_same(one, other, body.length)
                    for one, other in zip(place, there, strict=True)
                ):
                    return end
        x, y, z = self.local(place)
        if isinstance(body, Link):
            # What lies on its axis lies there to the last digit.
            x, y, z = (
                0.0 if _is_same(component, 0.0, body.length) else component
                for component in (x, y, z)
            )
        return Point(body, x, y, z=z)

    def local(self, place: Vector) -> Vector:
        """The body's point at a place."""
        return self.rotation.resolve(minus(place, self.origin))

    def place(self, point: Vector) -> Vector:
        """The place of a point that is given on the body's axes."""
        return plus(self.origin, self.rotation.apply(point))

    def directions(self, triad: Triad) -> Triad:
        """Directions in ground axes on the body's axes."""
        u, v, w = (_settled(self.rotation.resolve(one)) for one in triad)
        return u, v, w

    def directions_of(self, other: Reference) -> tuple[Vector, Vector]:
        """The directions of another body's x and y axes on this one's."""
        return self.rotation.resolve(other.rotation.x), self.rotation.resolve(other.rotation.y)


def directed(what: str, value: object, own: Ownership) -> Vector:
    """A direction of length 1. Raises :class:`DeclarationError` for one of length zero."""
    return _unit(what, own.vector(what, value))


def triad_of(
    what: str, axis: object, second: Expression, ownership: Ownership, part: str = ""
) -> Triad:
    """Directions u, v, w at right angles: along an axis, along a second one or any across it, and
    at right angles to both.

    A second one that is off a right angle by the rounding of a drawing is made exact: its part
    across the first is taken. Where parameters set them, so it is if their defaults are off; what
    other values are off by more than that is left, to be refused. It is noted for the joint
    ``what``. Raises :class:`DeclarationError`, which names a ``part`` of it, for an axis of length
    zero, and for a second one that is off by more.
    """
    said = f"{what}{part}"
    if axis is None:
        if second is not None:
            raise DeclarationError(
                f"{said}: second= needs axis=, and must be at right angles to it"
            )
        return AXES
    u = directed(f"{said}: axis", axis, ownership)
    if second is None:
        v = across(u)
    else:
        v = directed(f"{said}: second axis", second, ownership)
        cosine = dot(u, v)
        if isinstance(cosine, float) and abs(cosine) > ROUNDED:
            raise DeclarationError(not_right(said, cosine))
        if SAME < abs(off := ownership.at_defaults(cosine)) <= ROUNDED:
            along = (
                cosine if isinstance(cosine, float) else ca.fmax(-ROUNDED, ca.fmin(ROUNDED, cosine))
            )
            v = _unit(f"{said}: second axis", minus(v, times(along, u)))
            ownership.snapped(what, angle=abs(off))
    return u, v, cross(u, v)


def not_right(what: str, cosine: float) -> str:
    """Reason why two axes are refused, in words."""
    degrees = math.degrees(math.acos(max(-1.0, min(1.0, cosine))))
    return f"{what}: its axes must be at right angles, and are at {degrees:.6g} deg"


def most_across(axis: Sequence[float]) -> int:
    """Coordinate axis that is most across a direction; of those that are equal within rounding, the
    first.
    """
    least = min(map(abs, axis))
    return next(k for k in range(3) if abs(axis[k]) <= least + ROUNDED)


def across(axis: Vector) -> Vector:
    """A direction at right angles to one: the part across it of the coordinate axis that is most
    across; of symbols, any.
    """
    if all(isinstance(component, float) for component in axis):
        most = most_across(axis)
        return _unit("axis", minus(AXES[most], times(axis[most], axis)))
    # Duff et al., Building an orthonormal basis, revisited, JCGT 6, 2017.
    x, y, z = (ca.SX(component) for component in axis)
    sign = ca.if_else(z >= 0, 1.0, -1.0)
    factor = -1 / (sign + z)
    return 1 + sign * x * x * factor, sign * x * y * factor, -sign * x


def turned_by(what: str, turned: Expression, own: Ownership) -> tuple[Vector, Vector]:
    """The directions of a body's x and y axes: as given, or after turns in sequence, each about an
    axis that those before carry.
    """
    expected = (
        "rotations about 'x', 'y' or 'z' in sequence, as [('x', '90 deg')], or the directions of"
        " the child's x and y axes"
    )
    if not isinstance(turned, (list, tuple)):
        raise DeclarationError(f"{what}: turned= expected {expected}, got {turned!r}")
    if len(turned) == 2 and all(isinstance(one, (tuple, list)) and len(one) == 3 for one in turned):
        x, y, _ = triad_of(what, turned[0], turned[1], own, ": turned")
        return x, y
    found = Rotation()
    for turn in turned:
        if not isinstance(turn, (tuple, list)) or len(turn) != 2 or turn[0] not in ("x", "y", "z"):
            raise DeclarationError(f"{what}: turned= expected {expected}, got {turn!r}")
        angle = own.expression(f"{what}: turned", turn[1], "rad")
        found = found.then(Rotation.about(AXES["xyz".index(turn[0])], *direction(angle), angle))
    return found.x, found.y


def between(
    what: str, places: Expression, beside: Expression, own: Ownership
) -> tuple[Reference, Expression, Vector | None]:
    """The reference of a link that lies between two places, its length, and the direction
    ``beside`` of length 1, if given.
    """
    if not isinstance(places, (tuple, list)) or len(places) != 2:
        raise DeclarationError(f"{what}: between must be two places, got {places!r}")
    base, tip = (own.vector(f"{what}: between", place, "m") for place in places)
    along = minus(tip, base)
    length = norm(along)
    if isinstance(length, float) and length == 0.0:
        raise DeclarationError(
            f"{what}: expected two different places in between=, got the same one twice"
        )
    x = times(1 / length, along)
    aside = None
    if beside is None:
        y = across(x)
    else:
        aside = directed(f"{what}: beside", beside, own)
        part = minus(aside, times(dot(aside, x), x))
        if all(isinstance(component, float) and abs(component) < RIGHT for component in part):
            raise DeclarationError(
                f"{what}: beside lies along the link; expected a direction across it, towards its"
                " y axis"
            )
        y = _unit(f"{what}: beside", part)
    return Reference(base, Rotation.of(x, y), tip), length, aside


def tensor(what: str, inertia: Expression, own: Ownership) -> tuple[Vector, Vector, Vector]:
    """Moments of inertia as three rows, symmetric to the last digit where they are but for
    rounding; in a plane there is that about z alone.

    Raises :class:`DeclarationError` for what is no symmetric matrix, and are not three moments.
    """
    where = f"{what}: inertia"
    if not own.declared.space:
        return ZERO, ZERO, (0.0, 0.0, own.expression(where, inertia, "kg m^2"))
    if (
        isinstance(inertia, (tuple, list))
        and len(inertia) == 3
        and not any(isinstance(row, (tuple, list)) for row in inertia)
    ):
        x, y, z = own.vector(where, inertia, "kg m^2")
        return (x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z)
    if not isinstance(inertia, (tuple, list)) or len(inertia) != 3:
        raise DeclarationError(
            f"{where} must be three moments of inertia or a 3 x 3 matrix, got {inertia!r}"
        )
    rows = [list(own.vector(where, row, "kg m^2")) for row in inertia]
    size = max(
        (abs(entry) for row in rows for entry in row if isinstance(entry, float)), default=0.0
    )
    for i in range(3):
        for j in range(i):
            if not _is_same(rows[i][j], rows[j][i], size):
                raise DeclarationError(
                    f"{where} must be symmetric, and entries ({i + 1}, {j + 1}) and ({j + 1},"
                    f" {i + 1}) differ"
                )
            rows[i][j] = rows[j][i]
    x, y, z = ((one, two, three) for one, two, three in rows)
    return x, y, z


def rotated(
    moments: tuple[Vector, Vector, Vector], reference: Reference
) -> tuple[Vector, Vector, Vector]:
    """Moments of inertia on ground axes, on a body's."""
    axes = (reference.rotation.x, reference.rotation.y, reference.rotation.z)
    x, y, z = (
        tuple(
            dot(one, (dot(moments[0], other), dot(moments[1], other), dot(moments[2], other)))
            for other in axes
        )
        for one in axes
    )
    return (x[0], x[1], x[2]), (x[1], y[1], y[2]), (x[2], y[2], z[2])


def _is_same(one: Expression, other: Expression, size: Expression) -> bool:
    """Return whether two expressions are the same as written; numbers within rounding, relative to
    a size.
    """
    if isinstance(one, float) and isinstance(other, float):
        return one == other or (isinstance(size, float) and abs(one - other) <= SAME * size)
    return bool(ca.is_equal(ca.SX(one), ca.SX(other), 9))


def _unit(what: str, value: Vector) -> Vector:
    size = norm(value)
    if isinstance(size, float) and size == 0.0:
        raise DeclarationError(f"{what} must not be of length zero")
    if isinstance(size, float):
        x, y, z = (component / size for component in value)
        return _settled((x, y, z))
    return times(1 / size, value)


def _settled(direction: Vector) -> Vector:
    """A direction whose components are nothing where they are rounding: so what slides across a
    link stays at its end.
    """
    x, y, z = (
        0.0 if isinstance(component, float) and abs(component) < FAINT else component
        for component in direction
    )
    return x, y, z
