"""Plates: rigid bodies of any polygon, whose mass, centre and moment of inertia follow from their
corners.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from ...base.arguments import public
from ...base.brief import Brief
from ...base.scalars import column
from ...base.vectors import norm
from ...errors import DeclarationError
from ..beams.solid import polygon_area, polygon_moments
from ..declared_parts import Expression, Link, Point
from ..expressions import plain
from ..mechanism import Mechanism
from .bent import corners_of


@public
@dataclass(frozen=True, eq=False, repr=False)
class Plate(Brief):
    """A plate: its ``link``, and its ``corners`` as points of it."""

    link: Link
    corners: tuple[Point, ...]

    def corner(self, number: int) -> Point:
        """Return a corner.

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
                f"'{self.link.name}': there is no corner {number!r}, expected 0 to"
                f" {len(self.corners) - 1}"
            )
        return self.corners[number]

    def at(self, x: Expression, y: Expression) -> Point:
        """Return a point of the plate.

        Parameters
        ----------
        x, y : float or casadi.SX
            Its place on the axes of the corners [m].

        Returns
        -------
        Point
            The point.
        """
        return self.link.at(x, y)


@public
def plate(
    mechanism: Mechanism,
    name: str,
    corners: Sequence[Sequence[Expression]],
    *,
    mass: Expression | None = None,
    per_area: Expression | None = None,
) -> Plate:
    """Declare a rigid plate in a plane, a polygon of uniform thickness without sections.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    corners
        At least three corners (x, y) [m] in order around the plate, on its own axes, numbers or
        expressions of parameters. The direction of the link ``name`` in a posture is that of
        these axes.
    mass, per_area
        Either the mass [kg], or the mass per area [kg/m^2], thickness times density.

    Returns
    -------
    Plate
        The plate, with its corners as points. For sections use :func:`.bent_bar`.

    Raises
    ------
    DeclarationError
        For fewer than three corners, edges that cross, a polygon without area, and in space.
    """
    what, checked = f"plate '{name}'", mechanism.ownership.expression
    if mechanism.space:
        raise DeclarationError(
            f"{what}: only a mechanism in a plane has plates; in space declare a link with mass,"
            " centre and inertia"
        )
    places = [(x, y) for x, y, _ in corners_of(mechanism, what, corners)]
    if (mass is None) == (per_area is None):
        raise DeclarationError(f"{what}: expected mass= or per_area=")
    _refuse_crossing(what, places)
    enclosed = polygon_area(places)
    if isinstance(enclosed, float) and enclosed == 0.0:
        raise DeclarationError(f"{what}: its corners lie on a line")
    area, centre, (about_x, about_y, _) = polygon_moments(places)
    if per_area is None:
        whole = checked(what, mass, "kg")
    else:
        whole = ca.fabs(ca.SX(area)) * checked(what, per_area, "kg/m^2")
    farthest = ca.mmax(column(norm((x, y, 0.0)) for x, y in places))
    link = mechanism.link(
        name,
        length=plain(farthest),
        mass=plain(whole),
        centre=centre,
        inertia=plain(whole * (about_x + about_y) / area),
    )
    mechanism.outlines[name] = [places]
    return Plate(link, tuple(link.at(*corner) for corner in places))


def _refuse_crossing(what: str, places: Sequence[Expression]) -> None:
    """Raise for a polygon of numbers of which two edges cross."""
    if any(isinstance(number, ca.SX) for corner in places for number in corner):
        return
    count = len(places)
    edges = [(places[k], places[(k + 1) % count]) for k in range(count)]
    for (i, first), (j, second) in itertools.combinations(enumerate(edges), 2):
        if j - i not in (1, count - 1) and _cross(*first, *second):
            raise DeclarationError(
                f"{what}: the edges from corners {i} and {j} cross; expected the corners in order"
                " around the plate"
            )


def _cross(a: Expression, b: Expression, c: Expression, d: Expression) -> bool:
    beside, along = (
        polygon_area((*one, other[0])) * polygon_area((*one, other[1]))
        for one, other in (((a, b), (c, d)), ((c, d), (a, b)))
    )
    return bool(beside < 0.0 and along < 0.0)
