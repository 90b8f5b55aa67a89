"""Bent bars and bell cranks: straight pieces that are welded to each other, with sections along
each.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ...base.arguments import public
from ...base.brief import Brief
from ...base.vectors import Vector, minus, norm
from ...errors import DeclarationError
from ..declared_parts import Expression, Link, Point
from ..mechanism import Mechanism
from ..spatial import SpatialMechanism


@public
@dataclass(frozen=True, eq=False, repr=False)
class Bent(Brief):
    """A bar of straight ``pieces``, links called NAME_1, NAME_2 and so on, and its ``corners`` from
    the base to the tip.
    """

    pieces: tuple[Link, ...]
    corners: tuple[Point, ...]

    @property
    def base(self) -> Point:
        """The first corner."""
        return self.corners[0]

    @property
    def tip(self) -> Point:
        """The last one."""
        return self.corners[-1]

    def corner(self, number: int) -> Point:
        """Return a corner; that of number 0 is the base.

        Parameters
        ----------
        number : int
            Number of the corner, from 0.

        Returns
        -------
        Point
            The corner.

        Raises
        ------
        DeclarationError
            If there is no such corner.
        """
        if not 0 <= number < len(self.corners):
            raise DeclarationError(
                f"'{self.pieces[0].name}': there is no corner {number!r}, expected 0 to"
                f" {len(self.corners) - 1}"
            )
        return self.corners[number]


@public
def bent_bar(
    mechanism: Mechanism,
    name: str,
    corners: Sequence[Sequence[Expression]],
    *,
    mass: Expression | None = None,
    per_length: Expression | None = None,
) -> Bent:
    """Declare a bar that is straight from corner to corner, such as a bell crank or a bracket.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    corners
        At least three places [m], numbers or expressions of parameters, on the bar's own axes:
        (x, y), in space (x, y, z). In the plane the direction of the first piece in a posture is
        that from the first corner to the second.
    mass, per_length
        Either the mass of the whole bar [kg], or its mass per length [kg/m], which is uniform.

    Returns
    -------
    Bent
        The bar: links NAME_1, NAME_2 and so on, welded to each other, each with its sections. A
        bell crank turns about its middle corner: ``m.revolute("pivot", m.ground,
        bell.corner(1))``.

    Raises
    ------
    DeclarationError
        For corners that are no places or coincide, and as for links.
    """
    what = f"bent bar '{name}'"
    places = corners_of(mechanism, what, corners)
    if (mass is None) == (per_length is None):
        raise DeclarationError(f"{what}: expected mass= or per_length=")
    directions = [minus(b, a) for a, b in itertools.pairwise(places)]
    lengths = [norm(direction) for direction in directions]
    for k, length in enumerate(lengths):
        if isinstance(length, float) and not length > 0.0:
            raise DeclarationError(f"{what}: corners {k} and {k + 1} coincide")
    checked = mechanism.ownership.expression
    density = (
        checked(f"{what}: per_length", per_length, "kg/m")
        if mass is None
        else checked(f"{what}: mass", mass, "kg") / sum(lengths)
    )
    pieces = [
        mechanism.link(f"{name}_{k}", length=length, mass=density * length)
        for k, length in enumerate(lengths, 1)
    ]
    joined = zip(itertools.pairwise(pieces), itertools.pairwise(directions), strict=True)
    for k, (pair, ways) in enumerate(joined, 1):
        _weld(mechanism, f"{name}_bend_{k}", *pair, *ways)
    return Bent(tuple(pieces), (pieces[0].base, *(piece.tip for piece in pieces)))


def corners_of(
    mechanism: Mechanism, what: str, corners: Sequence[Sequence[Expression]]
) -> list[Vector]:
    """Three corners [m] or more; in a plane their third component is zero.

    Raises :class:`.DeclarationError`, naming ``what``, for anything else.
    """
    if not isinstance(corners, Sequence) or len(corners) < 3:
        raise DeclarationError(f"{what}: expected three corners or more; a straight bar is a link")
    found, size = [], 3 if mechanism.space else 2
    for k, corner in enumerate(corners):
        where = f"{what}: corner {k}"
        if not isinstance(corner, Sequence) or isinstance(corner, str) or len(corner) != size:
            raise DeclarationError(f"{where}: expected {size} numbers, got {corner!r}")
        x, y, *z = (mechanism.ownership.expression(where, number, "m") for number in corner)
        found.append((x, y, z[0] if z else 0.0))
    return found


def _weld(
    mechanism: Mechanism,
    name: str,
    first: Link,
    second: Link,
    direction: Vector,
    onward: Vector,
) -> None:
    """Weld a piece to the tip of the one before, at the angle between their ways."""
    if not isinstance(mechanism, SpatialMechanism):
        # By the sine and cosine of the angle between them, so that it is half a turn at most.
        angle = ca.atan2(
            direction[0] * onward[1] - direction[1] * onward[0],
            direction[0] * onward[0] + direction[1] * onward[1],
        )
        mechanism.weld(name, first.tip, second, angle=angle)
        return
    (bearing, rise), (next_bearing, next_rise) = (
        (ca.atan2(y, x), ca.atan2(z, norm((x, y, 0.0)))) for x, y, z in (direction, onward)
    )
    rotations: Any = [("y", rise), ("z", next_bearing - bearing), ("y", -next_rise)]
    mechanism.weld(name, first.tip, second, turned=rotations)
