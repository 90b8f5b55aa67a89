"""Geneva drives: a pin on a crank turns a wheel by one of its slots in each turn, and an arc of the
crank locks the wheel in between.

The pin, at r from the crank's axis, enters and leaves along a slot if r = c sin(pi/n), with c the
distance of the axes and n the number of slots. With a the crank's angle from the middle of the
engagement, m = c/r, and s = -1 for slots outside and 1 for slots inside,

    the wheel's angle is s atan2(sin a, m + s cos a),   |a| <= pi/2 + s pi/n.

The pin pushes at right angles to the slot. The arc of the crank, a circle about the crank's axis,
pushes along its radius: on slots outside at the horn of the wheel where the angle h at the crank's
axis from the line of the axes is largest, on slots inside at a right angle to that line. So of the
torque T on the wheel the force is T/(c sin h), and none of it turns the crank.

Source: J. H. Bickford, *Mechanisms for Intermittent Motion*, 1972, chapter 9.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import casadi as ca

from ...base.arguments import public
from ...base.brief import Brief
from ...base.rotation import Rotation
from ...base.units import Within
from ...base.vectors import AXES, ZERO, cross, dot, minus, norm, plus, times
from ...errors import DeclarationError
from ..constraints import Constraint
from ..declared_parts import Expression, Link, Point, Roller, Vector
from ..joints import Joint
from ..mechanism import Mechanism
from ..meshes import Mesh, Transmission, Wrench
from .contact import touching
from .fits import Fits

_LOCK, _PIN = 0.8, 0.4
"""Radius of the locking arc, of the pin's distance; and that of the pin as it is drawn, of the room
that the arc leaves.
"""

_RIGHT = -math.pi / 2.0, math.pi / 2.0


@dataclass(frozen=True, eq=False, repr=False)
class Geneva(Brief):
    """A Geneva drive: its ``constraint``, whose multiplier is the torque on the wheel [N m].

    ``engaged`` is the angle of the crank over which the pin is in a slot, ``dwell`` the rest of a
    turn, which is the angle of the crank's locking arc too [rad]. ``mouth`` is the distance of the
    slots' mouths from the wheel's axis, ``depth`` how far the pin goes into a slot [m].
    """

    constraint: Constraint
    engaged: float
    dwell: float
    mouth: Expression
    depth: Expression


@public
def geneva(
    mechanism: Mechanism,
    name: str,
    crank: Joint,
    wheel: Joint,
    *,
    slots: Annotated[int, Within(3, 12)],
    pin: Point | None = None,
    internal: bool = False,
    lock: Expression | None = None,
) -> Geneva:
    """Declare a Geneva drive in a plane, over whole turns of its crank.

    Parameters
    ----------
    mechanism, name
        The mechanism, and the name of the new part.
    crank, wheel
        The revolute joints of crank and wheel on one body. The wheel's coordinate is zero where the
        pin is in the middle of a slot, at the coordinate of the crank from -180 to 180 deg.
    slots
        Number of slots, 3 to 12.
    pin
        The pin, a point of the crank; by default the tip of the crank. Its distance from the
        crank's axis is that of both axes times the sine of 180 deg over the number of slots.
    internal
        True for slots that open inward, round the crank's axis.
    lock
        Radius of the locking arc [m]; by default 0.8 of the pin's.

    Returns
    -------
    Geneva
        The drive. Outputs are NAME_force, the force of the pin on a slot [N], positive where it
        turns the wheel counter-clockwise, and NAME_lock, the force of the locking arc [N].

    Raises
    ------
    DeclarationError
        In space, for joints of other kinds, another number of slots, and sizes that do not fit.
    """
    what, ownership = f"geneva '{name}'", mechanism.ownership
    for joint in (crank, wheel):
        kind, carrier = ownership.joint(joint).kind, joint.parent.body
        if mechanism.space or kind != "revolute" or carrier is not crank.parent.body:
            raise DeclarationError(
                f"{what}: expected two revolute joints of one parent, in a plane, got"
                f" '{crank.name}' and '{wheel.name}'"
            )
    body = crank.child.body
    assert isinstance(body, Link)
    centre = ownership.point(what, body.tip if pin is None else pin)
    if centre.body is not body:
        raise DeclarationError(
            f"{what}: its pin must be on '{body.name}', got '{centre.body.name}'"
        )
    arm, reach = (
        minus(centre.place, crank.child.place),
        minus(wheel.parent.place, crank.parent.place),
    )
    radius, apart = norm(arm), norm(reach)
    locked = _LOCK * radius if lock is None else ownership.expression(f"{what}: lock", lock, "m")
    fits = Fits(what, ownership.at_defaults)
    fits.positive("the distance of both axes", apart)
    # Of the horn's angle at the crank's axis.
    cosine = (locked * locked + radius * radius) / (2.0 * locked * apart)
    words = (
        "its pin is {got} m from the crank's axis; expected {meant} m, the distance of the axes"
        f" times the sine of {180.0 / slots:.6g} deg"
    )
    fits.same(words, radius, apart * math.sin(math.pi / slots), apart)
    words = (
        "its locking arc of {got} m does not reach the wheel, or reaches the pin; expected less"
        " than the pin's radius, as {meant} m"
    )
    nearest = ca.fmin(ca.fmax(locked, apart * (1.0 - math.cos(math.pi / slots))), radius)
    fits.same(words, locked, nearest, apart)
    way = 1 if internal else -1
    half = math.pi / 2.0 + way * math.pi / slots
    turn, middle = mechanism.coordinate(crank), times(-way, reach)
    angle = turn - ca.atan2(dot(AXES[2], cross(arm, middle)), dot(arm, middle))
    turns = ca.floor(angle / math.tau + 0.5)
    within = angle - math.tau * turns
    seen = ca.fmin(ca.fmax(within, -half), half)
    slewed = ca.atan2(ca.sin(seen), apart / radius + way * ca.cos(seen))
    engaged = ca.fabs(within) < half
    locked_in = 1.0 - engaged
    place = Rotation.by(turn).apply(arm)
    along = minus(place, reach)
    far = dot(along, along)
    # On the crank for a unit of torque on the wheel: at the pin, or along the arc's radius.
    pushed = times(-1.0 / far, cross(AXES[2], along))
    locking = times(1.0 / dot(reach, reach), cross(AXES[2], reach))
    lean = 0.0 if internal else cosine / ca.sqrt(1.0 - cosine * cosine)
    spread = times(-lean / dot(reach, reach), reach)
    axis = crank.parent
    at_pin = Mesh(
        centre,
        wheel.child,
        axis.body,
        plus(axis.place, place),
        minus(reach, place),
        Wrench(times(engaged, pushed)),
    )
    at_arc = Mesh(
        crank.child,
        wheel.child,
        axis.body,
        axis.place,
        reach,
        Wrench(times(locked_in, locking)),
        Wrench(times(locked_in, spread)),
    )
    phi = mechanism.coordinate(wheel) - way * (slewed + math.tau / slots * turns)
    transmission = Transmission(name, (at_pin, at_arc), fits=tuple(fits.found))
    made = touching(mechanism, name, phi, transmission=transmission)
    torque = mechanism.results.multiplier(made)
    force = ca.if_else(engaged, torque / ca.sqrt(far), 0.0)
    held_back = ca.if_else(engaged, 0.0, ca.fabs(torque) * ca.sqrt(1.0 + lean * lean) / apart)
    mechanism.output(f"{name}_force", force, unit="N")
    mechanism.output(f"{name}_lock", held_back, unit="N")
    mouth = apart * math.cos(math.pi / slots)
    depth = apart + radius - mouth if internal else mouth - apart + radius
    thick = _PIN * (radius - locked)
    corners = _wheel(slots, way, apart, radius, locked, ca.acos(cosine), thick)
    bar = [(0.0, -thick, 0.0), *_arc(radius, thick, *_RIGHT, 9), (0.0, thick, 0.0)]
    disc = [ZERO, *_arc(0.0, locked, half, math.tau - half)]
    for axle, along, outlines in (
        (wheel.child, times(-1.0 / apart, reach), [corners]),
        (crank.child, times(1.0 / radius, arm), [disc, bar]),
    ):
        turned = Rotation.of(along, cross(AXES[2], along))
        mechanism.outlines.setdefault(axle.body.name, []).extend(
            [plus(axle.place, turned.apply(corner))[:2] for corner in one] for one in outlines
        )
    mechanism.rollers[name] = Roller(centre.on_body, thick)
    return Geneva(made, 2.0 * half, math.tau - 2.0 * half, mouth, depth)


def _wheel(
    slots: int,
    way: int,
    apart: Expression,
    radius: Expression,
    locked: Expression,
    horn: Expression,
    thick: Expression,
) -> list[Vector]:
    """Corners of a wheel about its axis [m], from the middle of a seat of the locking arc, with the
    x axis along a slot that is ``thick`` on either side.
    """
    half, edge = math.pi / slots, apart * math.cos(math.pi / slots)
    mouth = ca.sqrt(edge * edge - thick * thick)
    end = _arc(apart + way * radius, way * thick, way * _RIGHT[0], way * _RIGHT[1], 9)
    slot = [(mouth, -thick, 0.0), *end, (mouth, thick, 0.0)]
    seat = _arc(apart, -locked, horn, (1 + way) * math.pi - horn)
    before, after = (Rotation.by(angle) for angle in (-half, half))
    pitch = [*map(before.apply, seat[12:]), *slot, *map(after.apply, seat[:12])]
    corners = [Rotation.by(2.0 * half * k).apply(one) for k in range(slots) for one in pitch]
    if way < 0:
        return corners
    # Round the rim, along a line inward, round the slots, and back.
    return [
        *_arc(0.0, apart + 1.2 * radius, -half, math.tau - half, 97),
        *corners[:1],
        *corners[::-1],
    ]


def _arc(
    middle: Expression, radius: Expression, start: Expression, stop: Expression, count: int = 25
) -> list[Vector]:
    """Places on a circle about a place on the x axis, from one angle to another."""
    angles = [start + (stop - start) * (k / (count - 1)) for k in range(count)]
    return [(middle + radius * ca.cos(at), radius * ca.sin(at), 0.0) for at in angles]
