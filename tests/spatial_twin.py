"""A planar mechanism told once more in space, its plane turned anyhow, as it is at one instant: same motion, same forces."""

from __future__ import annotations

import numpy as np
from spatial_bridge import instants

from lagrange_casadi import Scene, SpatialMechanism, density, motion
from lagrange_casadi.declare.density import Density
from lagrange_casadi.declare.parts import Link, RigidMass

NORMAL = (0.0, 0.0, 1.0)


def planar(scene: Scene, t: float) -> dict[str, float]:
    """The planar mechanism's columns at an instant."""
    return {name: float(row[0]) for name, row in instants(scene, [t], ["all"]).items()}


def twin(scene: Scene, t: float, found: dict[str, float], R: np.ndarray) -> Scene:
    """The same in space, where the plane's axes are the first two columns of a rotation matrix; loads are those of the instant."""
    m, values = scene.mechanism, scene.mechanism.values(scene.assembly)
    space = SpatialMechanism(f"{m.name}_in_space")
    gx, gy, _ = (m.number(component, values) for component in m.gravity)
    space.set_gravity(*map(float, R @ [gx, gy, 0.0]))
    parts = {m.ground.name: space.ground}
    for body in m.moving:
        parts[body.name] = _body(space, m, body, values)

    def at(point):
        x, y = (m.number(number, values) for number in (point.x, point.y))
        if point.body is m.ground:
            return space.ground.at(*map(float, R @ [x, y, 0.0]))
        if isinstance(point.body, Link) and point.end is not None:
            return getattr(parts[point.body.name], point.end)
        return parts[point.body.name].at(x, y) if isinstance(point.body, Link) else parts[point.body.name]

    for joint in m.joints.values():
        on_ground = joint.parent.body is m.ground
        frame = R if on_ground else np.eye(3)
        angle = m.number(joint.angle, values)
        turn = np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
        x, y, _ = (tuple(map(float, column)) for column in (frame @ turn).T)
        axis = tuple(map(float, frame @ [*(m.number(a, values) for a in joint.axis), 0.0]))
        start, end = at(joint.parent), at(joint.child)
        if joint.kind == "revolute":
            space.revolute(joint.name, start, end, axis=tuple(map(float, frame @ NORMAL)), turned=(x, y))
        elif joint.kind == "weld":
            space.weld(joint.name, start, end, turned=(x, y))
        else:
            getattr(space, joint.kind)(joint.name, start, end, axis=axis, turned=(x, y))
    for name, load in m.loads.items():
        force = R @ [found[f"load:{name}:fx"], found[f"load:{name}:fy"], 0.0]
        couple = R @ [0.0, 0.0, found[f"load:{name}:mz"]]
        for k, (point, sign) in enumerate(zip(load.points, (1.0, -1.0), strict=False)):
            if point.body is not m.ground:
                x, y, z = map(float, sign * force)
                space.force(f"{name}_{k}", at(point), x=x, y=y, z=z)
                if isinstance(point.body, Link):
                    x, y, z = map(float, sign * couple)
                    space.torque(f"{name}_{k}_couple", at(point), x=x, y=y, z=z)
    laws = {name: _law(found, name, t) for name in scene.motion}
    posture = {name: found[f"motion:{name}"] for name in space.coordinates if f"motion:{name}" in found and name not in laws}
    slides = {f"{name}:slide": found[f"motion:{name}"] for name in m.joints if f"{name}:slide" in space.coordinates}
    return Scene(space, laws, t=(t, t + 1.0, 2), posture=posture | slides)


def _body(space, m, body, values):
    if not isinstance(body, Link):
        return space.point_mass(body.name, m.number(body.mass, values))
    length = m.number(body.length, values)
    if isinstance(body.mass, RigidMass):
        centre, inertia = (m.number(c, values) for c in body.mass.centre), m.number(body.mass.inertia, values)
        tensor = (inertia / 2, inertia / 2, inertia)
        return space.link(body.name, length=length, mass=m.number(body.mass.mass, values), centre=(*centre, 0.0), inertia=tensor)
    assert isinstance(body.mass, Density)
    numbers = body.mass.at(lambda e: m.number(e, values), length)
    if len(numbers.cells) > 1:
        return space.link(body.name, length=length, density=body.mass)
    return space.link(body.name, length=length, density=density.polynomial(*(float(c) / length for c in numbers.cells[0])))


def _law(found, name, t):
    q, rate, acceleration = (found[f"motion:{name}{end}"] for end in ("", "_rate", "_acceleration"))
    return motion.expression(lambda time: q + rate * (time - t) + acceleration / 2 * (time - t) ** 2)
