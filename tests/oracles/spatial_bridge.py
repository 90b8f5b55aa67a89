"""Mechanisms of the spatial oracle declared to the package."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np
from spatial_bodies import GROUND, Rigid, Rod
from spatial_draft import Drawn
from spatial_motion import Motion, coordinates
from spatial_oracle import REACTION
from spatial_rubbing import Rub

from lagrange_casadi import Scene, SpatialMechanism, density, motion

_SIZE = 0.3
NO_TURN = np.eye(3)
BESIDE = (0.3, 3.0, 0.0)
"""In a body's own axes, the direction by which its y axis is told."""
NAMES = {
    "cylindrical": ("turn", "slide"),
    "universal": ("turn_1", "turn_2"),
    "spherical": ("turn_1", "turn_2", "turn_3"),
    "planar": ("slide_1", "slide_2", "turn"),
    "slot": ("slide", "turn_1", "turn_2", "turn_3"),
    "free": ("slide_1", "slide_2", "slide_3", "turn_1", "turn_2", "turn_3"),
}


def coordinate(joint, index: int) -> str:
    """What the package calls a coordinate that the oracle knows by its joint and number."""
    return f"{joint.name}:{NAMES[joint.kind][index]}" if joint.kind in NAMES else joint.name


def plain(drawn: Drawn) -> Drawn:
    """The same with rods joined between their ends, and with turns of slots about the axes that the
    package has there.
    """
    rods = {b.name for b in drawn.mechanism.bodies if isinstance(b, Rod)}
    joints = []
    for joint in drawn.mechanism.joints:
        x, y, z = map(float, joint.at_child)
        at_child = (abs(x) if joint.child in rods else x, y, z)
        frame = (
            across_axis(joint.axis)
            if joint.kind == "slot" and not drawn.is_hard(joint)
            else joint.frame
        )
        joints.append(dataclasses.replace(joint, at_child=at_child, frame=frame))
    return dataclasses.replace(drawn, mechanism=dataclasses.replace(drawn.mechanism, joints=joints))


def declared(
    drawn: Drawn,
    t: float = 0.0,
    rubs: Sequence[Rub] = (),
    beside: bool = False,
    **options,
) -> Scene:
    """A scene of what was drawn, with friction where it rubs, its loops assembled as the oracle has
    them at an instant.

    Bars are told by places, and so are their y axes, where these are told by what is ``beside``.
    """
    one = drawn.mechanism
    m = SpatialMechanism("drawn")
    m.set_gravity(*map(float, one.gravity))
    placed = {
        body for joint in one.joints if drawn.is_hard(joint) for body in (joint.parent, joint.child)
    }
    placed |= find_two_force_links(drawn) if beside else set()
    parts = {GROUND: m.ground}
    for b in one.bodies:
        parts[b.name] = _body(m, b, drawn.guess[b.name] if b.name in placed else None)

    def at(body, point):
        return parts[body].at(*map(float, point))

    for joint in one.joints:
        if drawn.is_hard(joint):
            # By its place and directions in ground axes, which are not of length one.
            r, R = drawn.guess.get(joint.parent, (np.zeros(3), NO_TURN))
            ends = parts[joint.parent], parts[joint.child]
            told = {"at": tuple(map(float, r + R @ np.array(joint.at_parent, float)))}
            told |= _directions(joint, R, 7.0)
        else:
            ends = at(joint.parent, joint.at_parent), at(joint.child, joint.at_child)
            told = _directions(joint) | {"turned": _turns(np.array(joint.orientation, float))}
        getattr(m, joint.kind)(joint.name, *ends, **told)
    for k, load in enumerate(one.loads):
        for kind, vector in (("force", load.force), ("torque", load.torque)):
            given = dict(zip("xyz", map(float, vector), strict=True))
            getattr(m, kind)(f"{kind}{k}", at(load.body, load.point), **given, turning=load.turning)
    for k, spread in enumerate(one.spreads):
        given = dict(
            zip(
                "xyz",
                (
                    (lambda x, row=row: sum(c * x**j for j, c in enumerate(row)))
                    for row in spread.powers
                ),
                strict=True,
            )
        )
        m.line_load(
            f"spread{k}",
            parts[spread.body],
            **given,
            between=(spread.start, spread.end),
            turning=spread.turning,
        )
    for k, spring in enumerate(one.springs):
        ends = (at(body, point) for body, point in spring.ends)
        m.spring(
            f"spring{k}",
            *ends,
            stiffness=spring.stiffness,
            length=spring.free,
            damping=spring.damping,
        )
    for rub in rubs:
        m.friction(rub.name, m.joints[rub.joint.name], along=rub.along, **rub.numbers)
    for k, rotor in enumerate(drawn.rotors):
        numbers = {"rotor_inertia": rotor.inertia, "ratio": rotor.ratio}
        m.drive(f"motor{k}", m.joints[rotor.joint], **numbers, armature=rotor.armature)
    for coupling in one.couplings:
        m.constraint(coupling.name, _total(m, one, coupling, parts))
    for row in one.rows:
        m.nonholonomic(row.name, _rates(m, one, row, parts), replaces=m.joints[row.replaces[0]])
    laws = {coordinate(one.joint(name), k): _law(law) for (name, k), law in drawn.laws.items()}
    drives = (
        None
        if drawn.pushed is None or one.rows
        else [coordinate(one.joint(name), k) for name, k in drawn.pushed]
    )
    posture = postures(drawn, drawn.move(t)[0])
    rough = {name: posture[name] for name in m.coordinates if name in posture and name not in laws}
    if drawn.hard:
        rough = {
            name: value
            for name, value in rough.items()
            if not drawn.is_hard(one.joint(name.partition(":")[0]))
        }
    return Scene(
        m, laws, **{"t": (t, t + drawn.span, 9), "posture": rough, "drives": drives, **options}
    )


def find_two_force_links(drawn: Drawn) -> set[str]:
    """The rods that may spin about their line."""
    if not drawn.idle:
        return set()
    ends = {
        b.name: [j.kind for j in drawn.mechanism.joints if b.name in (j.parent, j.child)]
        for b in drawn.mechanism.bodies
    }
    return {name for name in drawn.rods if ends[name] == ["spherical"] * 2}


def declared_axes(drawn: Drawn, body: str, pose) -> np.ndarray:
    """The axes of a body as columns: of a bar y is the part across it of the direction beside,
    which the ground carries.
    """
    if body not in find_two_force_links(drawn):
        return pose.R
    x, beside = pose.R[:, 0], drawn.guess[body][1] @ BESIDE
    y = beside - x * (x @ beside)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def postures(drawn: Drawn, poses) -> dict[str, float]:
    """The coordinates by the package's names, as they follow from the oracle's poses."""
    motion = Motion(drawn.mechanism, drawn.laws)
    poses = poses | {GROUND: motion.ground}
    return {
        coordinate(joint, k): float(value)
        for joint in drawn.mechanism.joints
        for k, value in enumerate(coordinates(joint, motion, poses))
    }


def named(drawn, one):
    """Efforts, multipliers and reactions by full name, and how the oracle calls each."""
    found = {
        f"effort:{coordinate(drawn.mechanism.joint(key[0]), key[1])}": (float(x), key)
        for key, x in one.efforts.items()
    }
    for name, x in one.multipliers.items():
        found[f"multiplier:{name}"] = float(x), (name, "multiplier")
    for joint, reaction in one.reactions.items():
        for member, x in zip(REACTION, reaction, strict=True):
            found[f"reaction:{joint}:{member}"] = float(x), (joint, member)
    return found


def _body(m, body, pose=None):
    if isinstance(body, Rigid):
        rows = np.array(body.inertia, float)
        centre = np.array(body.centre, float)
        told = {"length": _SIZE}
        if pose is not None:
            rows = pose[1] @ rows @ pose[1].T
            centre = pose[0] + pose[1] @ centre
            told = _lying(*pose, _SIZE)
        told |= {
            "centre": tuple(map(float, centre)),
            "inertia": tuple(tuple(map(float, row)) for row in rows),
        }
        return m.link(body.name, mass=float(body.mass), **told)
    length, law = float(body.length), body.density
    matter = (
        density.polynomial(float(law(0.5)))
        if callable(law)
        else density.polynomial(*map(float, law))
    )
    if body.polar:
        # Second moments are linear along a rod, see spatial_draft.rod.
        told = {"yy": body.lateral_z, "zz": body.lateral_y, "yz": lambda xi: -body.product(xi)}
        ends = {
            name: [
                float(of(xi) if callable(of) else sum(c * xi**k for k, c in enumerate(of)))
                for xi in (0, 1)
            ]
            for name, of in told.items()
        }
        matter = density.thick(
            matter, **{name: density.polynomial(a, b - a) for name, (a, b) in ends.items()}
        )
    lies = {"length": length} if pose is None else _lying(*pose, length)
    return m.link(body.name, density=matter, **lies)


def _lying(r, R, length):
    """Where a link lies whose axes are the columns of a matrix; what tells its y axis is neither a
    unit nor at a right angle.
    """
    base, tip, aside = (
        tuple(map(float, place)) for place in (r, r + R @ [length, 0.0, 0.0], R @ BESIDE)
    )
    return {"between": (base, tip), "beside": aside}


def _directions(joint, R=NO_TURN, scale=1.0) -> dict[str, Any]:
    """What tells a joint's axes, which ``R`` turns, and its lead."""
    axis, second = (
        None if x is None else scale * (R @ np.array(x, float)) for x in (joint.axis, joint.axis2)
    )
    told = {"axis": axis}
    match joint.kind:
        case "weld":
            told = {}
        case "spherical" | "free":
            told = {
                "axis": R @ np.array(joint.frame[0], float),
                "second": R @ np.array(joint.frame[1], float),
            }
        case "universal":
            told |= {"second": second}
        case "planar":
            told = {"axis": np.cross(axis, second), "second": axis}
    lead = {"lead": float(joint.lead)} if joint.kind == "screw" else {}
    return {name: tuple(map(float, way)) for name, way in told.items()} | lead


def across_axis(axis):
    """The triad that the package completes an axis to."""
    u = np.array(axis, float) / np.linalg.norm(np.array(axis, float))
    v = np.eye(3)[np.argmin(np.abs(u))]
    v = v - u * (v @ u)
    v /= np.linalg.norm(v)
    return u, v, np.cross(u, v)


def _turns(R):
    """A rotation as turns in sequence; as directions where the second would be a right angle."""
    if math.hypot(R[0, 0], R[1, 0]) < 1e-3:
        return tuple(map(float, R[:, 0])), tuple(map(float, R[:, 1]))
    yaw = math.atan2(R[1, 0], R[0, 0])
    pitch = math.atan2(-R[2, 0], math.hypot(R[0, 0], R[1, 0]))
    roll = math.atan2(R[2, 1], R[2, 2])
    return [("z", yaw), ("y", pitch), ("x", roll)]


def _rates(m, mechanism, row, parts):
    """What a row says is nothing, in the package's symbols."""
    q = {key: _of(m, mechanism, key, m.coordinate) for key in row.keys}
    terms, directions = row.of(ca, q)
    found = sum(x * _of(m, mechanism, key, m.rate) for key, x in terms.items())
    return found + _along(m.velocity, directions, parts)


def _total(m, mechanism, coupling, parts):
    """What a coupling says is nothing, in the package's symbols."""
    terms = coupling.terms.items()
    found = sum(float(x) * _of(m, mechanism, key, m.coordinate) for key, x in terms)
    return found + _along(m.place, coupling.points, parts) - float(coupling.offset)


def _of(m, mechanism, key, measure):
    """The coordinate of a key, or its rate."""
    joint = mechanism.joint(key[0])
    axes = NAMES[joint.kind][key[1] : key[1] + 1] if joint.kind in NAMES else ()
    return measure(m.joints[joint.name], *axes)


def _along(measure, directions, parts):
    """Places or velocities of points, along their directions."""
    return sum(
        x * component
        for (body, point), way in directions.items()
        for x, component in zip(way, measure(parts[body].at(*map(float, point))), strict=True)
    )


def _law(law):
    parts = getattr(law, "parts", (law,))

    def at(t):
        return sum(
            one.offset + one.speed * t + one.amplitude * ca.sin(one.frequency * t + one.phase)
            for one in parts
        )

    return motion.expression(at)
