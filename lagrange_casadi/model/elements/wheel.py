"""Wheels: gears, pulleys and flywheels as round bodies, whose mass and moments of inertia follow
from what they are made of.
"""

from __future__ import annotations

import math

from ...base.arguments import Count, public
from ...base.units import number
from ...errors import DeclarationError
from ..declared_parts import Expression, Link, Outline
from ..mechanism import Mechanism
from ..spatial import SpatialMechanism

_CORNERS = 48


@public
def wheel(
    mechanism: Mechanism,
    name: str,
    *,
    radius: Expression,
    bore: Expression = 0.0,
    width: Expression | None = None,
    mass: Expression | None = None,
    density: Expression = 7850.0,
    teeth: Count | None = None,
    internal: bool = False,
    turned: float | str = 0.0,
) -> Link:
    """Declare a round disc about its base: a gear by its pitch radius, a pulley, a flywheel.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    radius, bore
        Outer and inner radius [m]; a ring has a large bore.
    width, mass, density
        Either the ``mass`` [kg], or the ``width`` [m] and the ``density`` [kg/m^3], by default
        that of steel.
    teeth, internal
        Number of teeth that drawings show, on the radius, or on the bore if ``internal``; these
        are then the radii of pitch circles.
    turned
        Angle of the first tooth [rad], or a text such as ``"5 deg"``.

    Returns
    -------
    Link
        The disc. In space it lies in the plane of its y and z axes, the middle of its width at
        the base. It has no sections: weld it on a shaft that has.

    Raises
    ------
    DeclarationError
        For impossible sizes.
    """
    what, ownership = f"wheel '{name}'", mechanism.ownership
    if (mass is None) == (width is None):
        raise DeclarationError(f"{what}: expected mass=, or width= and density=")
    outer = ownership.expression(f"{what}: radius", radius, "m")
    inner = ownership.expression(f"{what}: bore", bore, "m")
    if isinstance(outer, float) and isinstance(inner, float) and not 0.0 <= inner < outer:
        raise DeclarationError(
            f"{what}: its bore must be smaller than its radius, got {inner:g} m in {outer:g} m"
        )
    thick = 0.0 if width is None else ownership.expression(f"{what}: width", width, "m")
    density = ownership.expression(f"{what}: density", density, "kg/m^3")
    turned = number(turned, "rad")
    whole = (
        density * math.pi * (outer * outer - inner * inner) * thick
        if mass is None
        else ownership.expression(f"{what}: mass", mass, "kg")
    )
    polar = whole * (outer * outer + inner * inner) / 2
    if isinstance(mechanism, SpatialMechanism):
        across = polar / 2 + whole * thick * thick / 12
        return mechanism.link(
            name, length=outer, mass=whole, centre=(0.0, 0.0, 0.0), inertia=(polar, across, across)
        )
    link = mechanism.link(name, length=outer, mass=whole, centre=(0.0, 0.0), inertia=polar)
    outside, hole = (
        _edge(size, teeth if inward == internal else None, turned, inward=inward)
        for size, inward in ((outer, False), (inner, True))
    )
    # Along a line inward, round the hole, and back.
    round_hole = [outside[0], hole[0], *reversed(hole)] if hole else []
    mechanism.outlines[name] = [[*outside, *round_hole]]
    return link


def _edge(radius: Expression, teeth: int | None, turned: float, *, inward: bool) -> Outline:
    """A circle, or a circle with teeth on both its sides; nothing for no radius."""
    if isinstance(radius, float) and radius == 0.0:
        return []
    if teeth is None:
        return [_corner(radius, math.tau * k / _CORNERS) for k in range(_CORNERS)]
    found: Outline = []
    for k in range(teeth):
        # The teeth of a straight profile: a tip, a foot, and half of the pitch on the pitch circle.
        for part, height in ((-0.36, -2.0), (-0.14, 2.0), (0.14, 2.0), (0.36, -2.0)):
            size = 1.0 + (-height if inward else height) / (2.0 * teeth)
            found.append(_corner(radius * size, turned + math.tau * (k + part) / teeth))
    return found


def _corner(radius: Expression, angle: float) -> tuple[Expression, Expression]:
    return radius * math.cos(angle), radius * math.sin(angle)
