"""Shafts in a fixed and a floating bearing, and rods in two bushes: two places whose loads follow
from statics.

If both bearings fixed the direction of a shaft, equilibrium would not determine their loads. Here
each transmits a force and no moment across the axis, as a bearing does if it is short compared with
the distance to the other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ...base.arguments import public
from ...base.brief import Brief
from ...base.vectors import AXES, cross, minus, norm, plus, times
from ...errors import DeclarationError
from ..declared_parts import Body, Expression, Point, Vector
from ..directions import directed, triad_of
from ..expressions import plain
from ..joints import Joint, Triad
from ..mechanism import Mechanism
from ..spatial import SpatialMechanism


@dataclass(frozen=True, eq=False, repr=False)
class Bearings(Brief):
    """A fixed and a floating bearing: their joints, whose reactions are the loads of the bearings,
    and the ``coordinate`` by which the shaft turns.

    In a plane the shaft is seen from the side, and ``coordinate`` is empty.
    """

    fixed: Joint
    floating: Joint
    coordinate: str


@dataclass(frozen=True, eq=False, repr=False)
class Bushes(Brief):
    """Two bushes on a rod: their joints, whose reactions are the loads of the rod on the bushes,
    and the ``coordinate`` by which they slide.
    """

    first: Joint
    second: Joint
    coordinate: str


@public
def two_bearings(
    mechanism: Mechanism,
    name: str,
    housing: Body | Point,
    fixed: Body | Point,
    floating: Body | Point,
    *,
    axis: Vector | None = None,
    apart: Expression = None,
) -> Bearings:
    """Declare a shaft in a fixed and a floating bearing: joints NAME_fixed and NAME_floating.

    The fixed bearing bears forces in every direction, the floating one across the axis alone. In
    space the coordinate NAME_fixed:turn_1 is the angle of the shaft about its axis. In a plane the
    shaft is seen from the side and does not turn: the two are a pin and a slot.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism.
    name : str
        Prefix of the joints' names.
    housing : Body or Point
        The place of the fixed bearing on the body that carries both.
    fixed, floating : Body or Point
        Places of the bearings on the shaft, whose x axis is the axis of the shaft. The floating one
        may be on another body that turns with it, as at the other end of a crankshaft.
    axis : vector, optional
        Direction of the shaft's x axis in the axes of the housing; by default x. In space the
        shaft's y axis is across it, along the housing's y if that is at right angles.
    apart : float or expression, optional
        How far the floating bearing is from the fixed one along the axis [m], positive; needed if
        they are on two bodies.

    Returns
    -------
    Bearings
        The two joints, for :func:`.bearings.fit` and for reactions.

    Raises
    ------
    DeclarationError
        If both places are one, ``apart`` is not positive, and as declaring joints does.
    """
    what, ownership = f"bearings '{name}'", mechanism.ownership
    near, *ends = (ownership.point(what, place) for place in (housing, fixed, floating))
    if apart is None and ends[0].body is not ends[1].body:
        raise DeclarationError(
            f"{what}: the places are on two bodies; expected apart=, their distance"
        )
    gap = (
        minus(ends[1].place, ends[0].place)[0]
        if apart is None
        else ownership.expression(f"{what}: apart", apart, "m")
    )
    if apart is not None and not (distance := ownership.at_defaults(gap)) > 0.0:
        raise DeclarationError(f"{what}: apart must be positive, got {distance:g} m")
    if not isinstance(gap, ca.SX) and gap == 0.0:
        raise DeclarationError(f"{what}: expected two places along the shaft, got one")
    u, v, _ = _triad(mechanism, what, axis)
    x, y, z = plus(near.place, times(gap, u))
    far = Point(near.body, x, y, z=z)
    names = f"{name}_fixed", f"{name}_floating"
    if isinstance(mechanism, SpatialMechanism):
        pin = mechanism.spherical(names[0], near, ends[0], axis=u, second=v, turned=(u, v))
        slot = mechanism.slot(names[1], far, ends[1], axis=u, turned=(u, v))
        rotations = [one.coordinate for one in pin.axes]
        mechanism.rough |= dict.fromkeys(rotations, 0.0)
        mechanism.turning |= dict.fromkeys(names, rotations[0])
        return Bearings(pin, slot, rotations[0])
    pin = mechanism.revolute(names[0], near, ends[0])
    slot = mechanism.slot(names[1], far, ends[1], axis=u[:2])
    mechanism.rough[names[0]] = _angle(mechanism, u)
    mechanism.turning |= dict.fromkeys(names, "")
    return Bearings(pin, slot, "")


@public
def two_bushes(
    mechanism: Mechanism,
    name: str,
    rod: Body | Point,
    first: Body | Point,
    second: Body | Point,
    *,
    axis: Vector | None = None,
    turns: bool = False,
) -> Bushes:
    """Declare a rod in two bushes of another body: joints NAME_first and NAME_second.

    Either the rod slides in bushes that stand, or a carriage slides on a rod by the bushes in it.
    The coordinate NAME_first, in space of a rod that turns NAME_first:slide, is how far the first
    bush is along the rod's axis from the given point of the rod. A bush loads the rod where it is
    at the moment.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism.
    name : str
        Prefix of the joints' names.
    rod : Body or Point
        What runs through the bushes, by a point of its axis; a link stands for its base.
    first, second : Body or Point
        Places of the bushes on the other body, the second further along the rod's axis.
    axis : vector, optional
        Direction of the rod in its own axes; by default x.
    turns : bool
        If the rod, in space, is free to turn about its axis: NAME_first:turn is a coordinate then.
        Otherwise the first bush holds it by a couple about the axis.

    Returns
    -------
    Bushes
        The two joints, for :func:`.bearings.fit` and for reactions: of the rod on the bushes.

    Raises
    ------
    DeclarationError
        If the bushes are on two bodies or at one place, and as declaring joints does.
    """
    what, ownership = f"bushes '{name}'", mechanism.ownership
    start, near, far = (ownership.point(what, place) for place in (rod, first, second))
    if near.body is not far.body:
        raise DeclarationError(
            f"{what}: expected two places of one body, got '{near.body.name}' and '{far.body.name}'"
        )
    if turns and not mechanism.space:
        raise DeclarationError(f"{what}: turns= is for space only; a rod in a plane cannot turn")
    between = minus(far.place, near.place)
    length = plain(norm(between))
    if isinstance(length, float) and length == 0.0:
        raise DeclarationError(f"{what}: both are at one place of '{near.body.name}'")
    u, v, _ = _triad(mechanism, what, axis)
    # A shoe without mass slides on the rod, and is pinned to the first bush: so the bush bears no
    # moment across the axis, and no effort of the slide.
    centre: Any = (0.0,) * (3 if mechanism.space else 2)
    inertia = (0.0, 0.0, 0.0) if mechanism.space else 0.0
    shoe = mechanism.link(
        f"{name}_shoe", length=length / 4, mass=0.0, centre=centre, inertia=inertia
    )
    names, pivot = (f"{name}_first", f"{name}_second"), f"{name}_pivot"
    if isinstance(mechanism, SpatialMechanism):
        kind = mechanism.cylindrical if turns else mechanism.prismatic
        slide = kind(names[0], start, shoe, axis=u, turned=(u, v))
        x, y, z = triad_of(what, between, None, ownership)
        turned = (x[0], y[0], z[0]), (x[1], y[1], z[1])
        pin = mechanism.universal(
            pivot, shoe, near, axis=(0.0, 1.0, 0.0), second=(0.0, 0.0, 1.0), turned=turned
        )
        mechanism.rough |= dict.fromkeys([one.coordinate for one in pin.axes], 0.0)
        slot = mechanism.slot(names[1], start, far, axis=u)
    else:
        slide = mechanism.prismatic(names[0], start, shoe, axis=u[:2])
        mechanism.revolute(pivot, shoe, near)
        mechanism.rough[pivot] = _angle(mechanism, u) - _angle(mechanism, between)
        slot = mechanism.slot(names[1], start, far, axis=u[:2])
    return Bushes(slide, slot, slide.axes[0].coordinate)


def _triad(mechanism: Mechanism, what: str, axis: Vector | None) -> Triad:
    """Directions along an axis, by default x, and across it."""
    if mechanism.space:
        return triad_of(what, (1.0, 0.0, 0.0) if axis is None else axis, None, mechanism.ownership)
    u = directed(f"{what}: axis", (1.0, 0.0) if axis is None else axis, mechanism.ownership)
    return u, cross(AXES[2], u), AXES[2]


def _angle(mechanism: Mechanism, direction: Vector) -> float:
    """Angle of a direction in a plane [rad], with the defaults of parameters."""
    x, y = (mechanism.ownership.at_defaults(component) for component in direction[:2])
    return math.atan2(y, x)
