"""Planetary gear sets: planets on a carrier between a sun and a ring,
which share the load evenly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...base.arguments import public
from ...base.brief import Brief
from ...errors import DeclarationError
from ..declared_parts import Body, Expression, Link, Point
from ..joints import Joint
from ..mechanism import Mechanism
from .fits import Fits
from .gears import Gears, gears
from .wheel import wheel


@dataclass(frozen=True, eq=False, repr=False)
class Planetary(Brief):
    """A planetary set: its ``planets``, which ``pins`` hold on the carrier, and how they mesh with
    ``sun`` and ``ring``.

    ``centres`` is the distance from the sun's axis to the pins [m]. The multiplier of the one mesh
    with the sun is the force on each planet.
    """

    planets: tuple[Link, ...]
    pins: tuple[Joint, ...]
    sun: Gears
    ring: tuple[Gears, ...]
    centres: Expression


@public
def planetary(
    mechanism: Mechanism,
    name: str,
    sun: Body | Point,
    carrier: Body | Point,
    ring: Body | Point,
    *,
    teeth: Sequence[int],
    module: Expression,
    planets: int = 3,
    mass: Expression | None = None,
    width: Expression | None = None,
    pressure_angle: Expression = "20 deg",
    efficiency: Expression | None = None,
) -> Planetary:
    """Declare the planets of a planetary set in a plane: links NAME_planet_1 and so on, pins
    NAME_pin_1, and how they mesh.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    sun, carrier, ring
        The points in the middle of the three, each a body that a revolute joint lets turn about it;
        one of them may be the ground, or welded to it. A link stands for its base. A carrier has
        with mass, centre and inertia, because pins are all round it.
    teeth
        Numbers of teeth of sun, planets and ring. The ring has as many as the sun and twice a
        planet.
    module
        The module [m].
    planets
        How many there are, evenly round: their number divides the teeth of sun and ring together.
    mass, width
        The mass of a planet [kg], or its width [m], of steel.
    pressure_angle, efficiency
        As of :func:`.gears`; the efficiency is that of each mesh.

    Returns
    -------
    Planetary
        The planets, their pins and meshes. The mesh with the sun is NAME_sun, those with the ring
        NAME_ring_1 and so on, with the outputs of :func:`.gears`, all of one planet. The planets
        share the load evenly.

    Raises
    ------
    DeclarationError
        For numbers of teeth that do not fit, and as :func:`.gears`.
    """
    what, ownership = f"planetary set '{name}'", mechanism.ownership
    if mechanism.space:
        raise DeclarationError(
            f"{what}: only a mechanism in a plane has it; in space declare planets, pins and gears"
        )
    if len(teeth) != 3 or min(teeth) < 1:
        raise DeclarationError(
            f"{what}: teeth must be three whole numbers, of sun, planets and ring, got {teeth!r}"
        )
    of_sun, of_planet, of_ring = teeth
    if of_ring != of_sun + 2 * of_planet:
        raise DeclarationError(
            f"{what}: its ring has {of_ring} teeth; expected {of_sun + 2 * of_planet}, those of the"
            " sun and twice those of a planet"
        )
    if planets < 1 or (of_sun + of_ring) % planets:
        raise DeclarationError(
            f"{what}: {planets!r} planets cannot be evenly spaced; expected a number that divides"
            f" {of_sun + of_ring}, the teeth of sun and ring together"
        )
    apart = of_planet + 2
    if planets > 1 and apart > (of_sun + of_planet) * math.sin(math.pi / planets):
        raise DeclarationError(
            f"{what}: {planets} planets of {of_planet} teeth do not fit around a sun of {of_sun}"
        )
    size = ownership.expression(f"{what}: module", module, "m")
    Fits(what, ownership.at_defaults).positive("module", size)
    middle, centres = ownership.point(what, carrier), size * (of_sun + of_planet) / 2
    made: dict[str, Any] = {"mass": mass, "width": width, "teeth": of_planet}
    found, pins = [], []
    for k in range(planets):
        angle = math.tau * k / planets
        # So turned that teeth are drawn in gaps where sun and carrier are at zero.
        turned = angle + math.pi - (math.pi - of_sun * angle) / of_planet
        radius = size * of_planet / 2
        planet = wheel(mechanism, f"{name}_planet_{k + 1}", radius=radius, turned=turned, **made)
        spot = Point(
            middle.body, middle.x + centres * math.cos(angle), middle.y + centres * math.sin(angle)
        )
        found.append(planet)
        pins.append(mechanism.revolute(f"{name}_pin_{k + 1}", spot, planet))
    options = {
        "module": size,
        "pressure_angle": pressure_angle,
        "efficiency": efficiency,
        "carrier": middle.body,
    }
    inner = gears(mechanism, f"{name}_sun", sun, found, teeth=(of_sun, of_planet), **options)
    meshing = {"teeth": (of_planet, of_ring), **options}
    outer = tuple(
        gears(mechanism, f"{name}_ring_{k}", planet, ring, **meshing)
        for k, planet in enumerate(found, 1)
    )
    return Planetary(tuple(found), tuple(pins), inner, outer, centres)
