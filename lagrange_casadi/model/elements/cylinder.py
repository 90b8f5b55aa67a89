"""Hydraulic and pneumatic cylinders: a barrel and a rod between two pins, with pressures, flows and
power as outputs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from ...base.arguments import public
from ...base.brief import Brief
from ...errors import DeclarationError
from ..declared_parts import Body, Expression, Link, Outline, Point
from ..joints import Joint
from ..mechanism import Mechanism
from .strut import stroke


@dataclass(frozen=True, eq=False, repr=False)
class Cylinder(Brief):
    """A cylinder: its links ``barrel`` and ``rod``, its ``slide``, which is what a scene drives,
    and its areas [m^2].

    The coordinate of the slide is how far it is out. The cap side pushes, the rod side pulls.
    """

    barrel: Link
    rod: Link
    slide: Joint
    cap_area: Expression
    rod_area: Expression


@public
def cylinder(
    mechanism: Mechanism,
    name: str,
    rear: Body | Point,
    front: Body | Point,
    *,
    closed: Expression,
    open: Expression | None = None,  # noqa: A002
    bore: Expression,
    rod: Expression = 0.0,
    back_pressure: Expression = 0.0,
    barrel_mass: Expression = 0.0,
    rod_mass: Expression = 0.0,
) -> Cylinder:
    """Declare a hydraulic or pneumatic cylinder between two pins, in a plane.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    rear, front
        Points at which the barrel and the rod are pinned.
    closed
        Distance of the pins when the cylinder is retracted [m].
    open
        Distance of the pins when the cylinder is extended [m]. Instants at which the cylinder is
        shorter than closed or longer than open have no result. By default there is no such limit.
    bore, rod
        Diameters of the piston and of the rod [m].
    back_pressure
        Gauge pressure of the side that does not work [Pa].
    barrel_mass, rod_mass
        Masses of barrel and rod [kg].

    Returns
    -------
    Cylinder
        The links NAME_barrel and NAME_rod, the pins NAME_rear and NAME_front, and the slide NAME,
        whose coordinate is the stroke. Outputs are NAME_cap_pressure and NAME_rod_pressure [Pa],
        the lower of which is the back pressure; NAME_flow [m^3/s], positive into the cap side; and
        NAME_power [W]; and with ``open`` NAME_stroke, the share of the stroke that is out, from 0
        to 1. If the slide is not a drive of the scene, the cylinder bears no force.

    Raises
    ------
    DeclarationError
        For impossible sizes, in space, and as for links and joints.
    """
    what, ownership = f"cylinder '{name}'", mechanism.ownership
    if mechanism.space:
        raise DeclarationError(
            f"{what}: only a mechanism in a plane has cylinders; in space declare two links and a"
            " prismatic joint"
        )
    bore = ownership.expression(f"{what}: bore", bore, "m")
    rod = ownership.expression(f"{what}: rod", rod, "m")
    back = ownership.expression(f"{what}: back_pressure", back_pressure, "Pa")
    if not isinstance(bore, ca.SX) and not isinstance(rod, ca.SX) and not 0.0 <= rod < bore:
        raise DeclarationError(
            f"{what}: its rod must be thinner than its bore, got {rod:g} m in {bore:g} m"
        )
    cap_area = math.pi / 4.0 * bore * bore
    rod_area = cap_area - math.pi / 4.0 * rod * rod
    barrel = mechanism.link(f"{name}_barrel", length=closed, mass=barrel_mass)
    closed = barrel.length
    piston = mechanism.link(f"{name}_rod", length=closed, mass=rod_mass)
    mechanism.outlines[barrel.name] = [_box(0.1 * closed, 0.95 * closed, bore)]
    thick = 0.4 * bore if isinstance(rod, float) and rod == 0.0 else rod
    # Retracted the piston is just inside the barrel.
    head, shaft = _box(0.1 * closed, 0.16 * closed, 0.9 * bore), _box(0.16 * closed, closed, thick)
    mechanism.outlines[piston.name] = [head, shaft]
    mechanism.revolute(f"{name}_rear", rear, barrel)
    slide = mechanism.prismatic(name, barrel, piston.base, axis=(1.0, 0.0))
    mechanism.revolute(f"{name}_front", piston.tip, front)
    push, rate = mechanism.results.effort(slide, passive=True), mechanism.rate(slide)
    mechanism.output(
        f"{name}_cap_pressure", ca.fmax((push + back * rod_area) / cap_area, back), unit="Pa"
    )
    mechanism.output(
        f"{name}_rod_pressure", ca.fmax((back * cap_area - push) / rod_area, back), unit="Pa"
    )
    mechanism.output(f"{name}_flow", cap_area * rate, unit="m^3/s")
    mechanism.output(f"{name}_power", push * rate, unit="W")
    # Of two ways to assemble it, that with the rod on the front's side of the barrel.
    mechanism.rough[name] = ownership.at_defaults(closed) / 2
    if open is not None:
        reach = closed + mechanism.coordinate(slide)
        stroke(mechanism, "cylinder", name, reach, closed, open)
    return Cylinder(barrel, piston, slide, cap_area, rod_area)


def _box(start: Expression, stop: Expression, high: Expression) -> Outline:
    """The outline of a part of a cylinder, between two places on its axis [m]."""
    return [(start, -high / 2), (stop, -high / 2), (stop, high / 2), (start, high / 2)]
