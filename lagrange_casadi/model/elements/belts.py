"""Belts and chains between two pulleys or sprockets, with the tensions of both strands on their
bearings.

Half of the strands' sum of tensions is the preload, until the slack strand is slack: then the other
bears all. So the sum is the larger of twice the preload and of the force that is passed on, and a
chain is a belt without preload. Strands are straight and have no mass, they do not stretch and do
not slip.

Links of a chain, and a toothed or a V-belt, resist where they bend on to a wheel and off it. What
this takes is a force f along the pitch circle of each wheel against its turning. The strands then
pull a little beside their tangents: across the line of the centres the wheels bear (f r1 +- f
r2)/distance. Of the power W + f that goes in W - f comes out, whichever drives, so f = W (1 -
efficiency)/(1 + efficiency), with W the difference of the tensions.

Source: J. E. Shigley, C. R. Mischke, *Mechanical Engineering Design*, chapter 17: the initial
tension is half of the sum of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

from ...base.arguments import public
from ...base.brief import Brief
from ...base.vectors import cross, dot, minus, norm, times
from ...errors import DeclarationError
from ..constraints import Constraint
from ..declared_parts import Body, Expression, PitchCircles, Point
from ..mechanism import Mechanism
from ..meshes import FITTING, Loss, Mesh, Transmission, Wrench
from .contact import output_loss, touching
from .courses import along, courses_on, keep_on_axis
from .fits import Fits


@dataclass(frozen=True, eq=False, repr=False)
class Belt(Brief):
    """A belt: its ``constraint``, whose multiplier is the difference of its tensions [N], and the
    ``ratio`` of the rates.
    """

    constraint: Constraint
    ratio: Expression


@public
def belt(
    mechanism: Mechanism,
    name: str,
    first: Body | Point,
    second: Body | Point,
    *,
    radii: Sequence[Expression],
    preload: Expression = 0.0,
    crossed: bool = False,
    carrier: Body | None = None,
    offset: Expression = 0.0,
    efficiency: Expression | None = None,
) -> Belt:
    """Declare a belt or a chain around two pulleys.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    first, second
        Centres of the pulleys: points on the axes about which revolute joints let their bodies
        turn. The axes are parallel.
    radii
        Radii of the two pitch circles [m].
    preload
        Tension of both strands without load [N]; 0 for a chain.
    crossed
        True for a crossed belt, which turns the second pulley in the opposite direction.
    carrier
        Body on which both pulleys turn; by default it follows from the joints.
    offset
        Distance along the belt by which the first pitch circle is ahead where both coordinates
        are zero [m].
    efficiency
        Share of the input power that reaches the other pulley, whichever drives; by default 1.

    Returns
    -------
    Belt
        The belt. Its multiplier is the force along the first pulley's pitch circle, positive
        where it turns this pulley forward. Outputs are NAME_tight and NAME_slack, the tensions of
        the strands [N]. If the preload is too small for the transmitted force, the slack strand
        has zero tension: a chain or a toothed belt still works, a flat belt slips. With an
        efficiency, NAME_loss is the lost power [W], indeterminate where the belt is at rest, as
        friction in joints is.

    Raises
    ------
    DeclarationError
        For bodies that do not turn about parallel axes through these points, radii for which the
        pulleys touch, a negative preload, and an efficiency outside 0 to 1.
    """
    what, ownership = f"belt '{name}'", mechanism.ownership
    ends = ownership.point(what, first), ownership.point(what, second)
    one, two = courses_on(mechanism, what, *ends, carrier, rack=False)
    if not isinstance(radii, (list, tuple)) or len(radii) != 2:
        raise DeclarationError(f"{what}: expected 2 radii, got {radii!r}")
    r1, r2 = (ownership.expression(f"{what}: radii", radius, "m") for radius in radii)
    number = ownership.at_defaults
    fits = Fits(what, number)
    fits.positive("radii", r1)
    fits.positive("radii", r2)
    tension = ownership.expression(f"{what}: preload", preload, "N")
    fits.at_least("preload [N] must not be negative", tension, 0.0, tension)
    u, v, away = one.axis, two.axis, minus(two.place, one.place)
    beside, scale = dot(away, u), r1 + r2
    if number(norm(cross(u, v))) > FITTING:
        raise DeclarationError(
            f"{what}: expected pulleys in one plane, which turn about parallel axes"
        )
    words = "its pulleys are offset by {got} m along their axes; expected {meant} m"
    fits.same(words, beside, 0.0, scale)
    distance = norm(away)
    which, reach = ("sum", scale) if crossed else ("difference", ca.fabs(r1 - r2))
    words = (
        f"its centres are {{got}} m apart; expected more than the {which} of its radii, {{meant}} m"
    )
    fits.same(words, distance, ca.fmax(distance, reach + 2 * FITTING * scale), scale)
    e = along(away, distance)
    # The sine of the angle between a strand and the line of the centres, where the strands lead
    # apart.
    lean = (-(r1 + r2) if crossed else r2 - r1) / distance
    across = times(-lean, cross(u, e))
    both = times(ca.sqrt(1 - lean * lean), e)
    mesh = Mesh(*ends, one.carrier, one.place, away, Wrench(across, times(r1, u)), Wrench(both))
    sense = 1 if (number(dot(u, v)) > 0.0) != crossed else -1
    other = -sense * r2
    ahead = ownership.expression(f"{what}: offset", offset, "m")
    loss = None
    if efficiency is not None:
        value = ownership.expression(f"{what}: efficiency", efficiency)
        fits.share(value)
        sideways = times((r1 - r2 if crossed else r1 + r2) / distance, cross(u, e))
        mesh = replace(mesh, braking=Wrench(sideways, times(r1, u)))
        loss = Loss(f"{name}:loss", (1 - value) / (1 + value), 0.0, one.rotations)
    phi = r1 * one.displacement(mechanism) + other * two.displacement(mechanism) - ahead
    keep_on_axis(fits, one, two)
    transmission = Transmission(name, (mesh,), 2 * tension, tuple(fits.found), loss)
    constraint = touching(mechanism, name, phi, transmission=transmission)
    mechanism.pitch_circles[name] = PitchCircles(
        one.carrier.name, (one.place, two.place), (u, v), (r1, r2), belt=True, crossed=crossed
    )
    force = ca.fabs(mechanism.results.multiplier(constraint))
    whole = ca.fmax(2 * tension, force)
    mechanism.output(f"{name}_tight", (whole + force) / 2, unit="N")
    mechanism.output(f"{name}_slack", (whole - force) / 2, unit="N")
    if loss is not None:
        output_loss(mechanism, constraint, loss, 2 * r1)
    return Belt(constraint, -(r1 / other))
