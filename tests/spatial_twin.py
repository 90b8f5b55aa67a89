"""A planar mechanism told once more in space, its plane turned anyhow, as it is at one instant:
same motion, same forces.
"""

from __future__ import annotations

import dataclasses

import casadi as ca
import numpy as np
from internals import Joint, Link, Mesh, Point, RigidMass, Solution, Transmission, Wrench

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion
from lagrange_casadi.density import Density

NORMAL = (0.0, 0.0, 1.0)


def planar(scene: Scene, t: float, **options) -> Solution:
    """The planar mechanism as far as an instant."""
    found = dataclasses.replace(scene, t=(scene.span[0], t, 9), over=None)
    return evaluate(found, wanted=["all"], backend="vm", **options)


def twin(scene: Scene, flat: Solution, R: np.ndarray) -> Scene:
    """The same in space, where the plane's axes are the first two columns of a rotation matrix;
    loads are those of the instant.
    """
    return _Twin(scene, flat, R).scene()


class _Twin:
    """The planar mechanism with its numbers at the instant, and what has been
    told of it in space.
    """

    def __init__(self, scene: Scene, flat: Solution, R: np.ndarray) -> None:
        self.planar, self.t, self.R = scene, float(flat.t[-1]), R
        self.found = {name: float(values[-1]) for name, values in flat.series.items()}
        self.flat, self.values = scene.mechanism, scene.mechanism.values(scene.assembly)
        self.space = SpatialMechanism(f"{self.flat.name}_in_space")
        self.parts = {self.flat.ground.name: self.space.ground}

    def scene(self) -> Scene:
        """All of it."""
        flat, space, found = self.flat, self.space, self.found
        space.set_gravity(*self._ground([*map(self._number, flat.gravity[:2]), 0.0]))
        for body in flat.moving:
            self.parts[body.name] = self._body(body)
        for joint in flat.joints.values():
            self._join(joint)
        for name, load in flat.loads.items():
            self._load(name, load)
        for constraint in flat.constraints.values():
            # A cam's may have kinks off the contact, so it is not declared anew.
            parts = constraint.transmission and self._transmission(constraint.transmission)
            told = dataclasses.replace(
                constraint, phi=self._seen(constraint.phi), transmission=parts
            )
            space.constraints[constraint.name] = told
        for row in flat.rows.values():
            space.nonholonomic(
                row.name, self._seen(row.expression), replaces=space.joints[row.replaces]
            )
        laws = {name: self._law(name) for name in self.planar.motion if name in flat.joints}
        guided = self.planar.motion.keys() - laws.keys()
        for name in guided:
            laws |= self._guided(name)
        posture = {
            name: found[f"motion:{name}"]
            for name in space.coordinates
            if f"motion:{name}" in found and name not in laws
        }
        posture |= {
            f"{name}:slide": found[f"motion:{name}"]
            for name in flat.joints
            if f"{name}:slide" in space.coordinates
        }
        posture |= {
            f"{name}_pose:{out}": 0.0 for name in guided for out in ("slide_3", "turn_1", "turn_2")
        }
        return Scene(space, laws, t=(self.t, self.t, 1), posture=posture, drives=self.planar.drives)

    def _number(self, expression) -> float:
        return self.flat.number(expression, self.values)

    def _ground(self, vector) -> tuple[float, ...]:
        """A vector of the plane in ground axes."""
        return tuple(map(float, self.R @ vector))

    def _at(self, point: Point) -> Point:
        x, y = (self._number(number) for number in (point.x, point.y))
        if point.body is self.flat.ground:
            return self.space.ground.at(*self._ground([x, y, 0.0]))
        own = self.parts[point.body.name]
        if not isinstance(point.body, Link):
            return self.space.ownership.point("point", own)
        return getattr(own, point.end) if point.end is not None else own.at(x, y)

    def _body(self, body):
        if not isinstance(body, Link):
            return self.space.point_mass(body.name, self._number(body.mass))
        length = self._number(body.length)
        if isinstance(body.mass, RigidMass):
            centre, inertia = (
                (self._number(c) for c in body.mass.centre),
                self._number(body.mass.inertia),
            )
            tensor, mass = (inertia / 2, inertia / 2, inertia), self._number(body.mass.mass)
            return self.space.link(
                body.name, length=length, mass=mass, centre=(*centre, 0.0), inertia=tensor
            )
        assert isinstance(body.mass, Density)
        numbers = body.mass.at(self._number, length)
        return self.space.link(
            body.name,
            length=length,
            density=Density(numbers.breaks, numbers.cells, per_length=False),
        )

    def _join(self, joint: Joint) -> None:
        frame = self.R if joint.parent.body is self.flat.ground else np.eye(3)
        angle = self._number(joint.angle)
        turn = np.array(
            [
                [np.cos(angle), -np.sin(angle), 0.0],
                [np.sin(angle), np.cos(angle), 0.0],
                [0.0, 0.0, 1.0],
            ]
        )
        x, y, _ = (tuple(map(float, column)) for column in (frame @ turn).T)
        axis = {"revolute": NORMAL, "weld": None}.get(
            joint.kind, [*(self._number(a) for a in joint.axis), 0.0]
        )
        told = {} if axis is None else {"axis": tuple(map(float, frame @ axis))}
        getattr(self.space, joint.kind)(
            joint.name, self._at(joint.parent), self._at(joint.child), **told, turned=(x, y)
        )

    def _load(self, name, load) -> None:
        force = np.array(
            self._ground([self.found[f"load:{name}:fx"], self.found[f"load:{name}:fy"], 0.0])
        )
        couple = np.array(self._ground([0.0, 0.0, self.found[f"load:{name}:mz"]]))
        for k, (point, sign) in enumerate(zip(load.points, (1.0, -1.0), strict=False)):
            if point.body is not self.flat.ground:
                self.space.force(
                    f"{name}_{k}",
                    self._at(point),
                    **dict(zip("xyz", map(float, sign * force), strict=True)),
                )
                if isinstance(point.body, Link):
                    told = dict(zip("xyz", map(float, sign * couple), strict=True))
                    self.space.torque(f"{name}_{k}_couple", self._at(point), **told)

    def _transmission(self, one: Transmission) -> Transmission:
        """What its parts bear where they touch; what friction takes in it is not told."""
        assert one.loss is None
        return Transmission(one.name, tuple(map(self._mesh, one.meshes)), self._number(one.slack))

    def _mesh(self, mesh: Mesh) -> Mesh:
        carrier = self.parts[mesh.carrier.name]

        def own(vector):
            x, y, z = map(self._seen, vector)
            rows = ca.DM(self.R if carrier is self.space.ground else np.eye(3)) @ ca.vertcat(
                x, y, z
            )
            return tuple(float(e) if e.is_constant() else e for e in ca.vertsplit(ca.SX(rows)))

        def wrench(one: Wrench | None) -> Wrench | None:
            return one and Wrench(own(one.force), own(one.couple))

        ends = self._at(mesh.first), self._at(mesh.second)
        return Mesh(
            *ends,
            carrier,
            own(mesh.centre),
            own(mesh.reach),
            *map(wrench, (mesh.along, mesh.apart, mesh.braking)),
        )

    def _law(self, name) -> motion.Motion:
        q, rate, acceleration = (
            self.found[f"motion:{name}{end}"] for end in ("", "_rate", "_acceleration")
        )
        return motion.expression(
            lambda time: q + rate * (time - self.t) + acceleration / 2 * (time - self.t) ** 2
        )

    def _guided(self, name) -> dict[str, motion.Motion]:
        """The laws of a body's pose: those of a joint that bears nothing."""
        x, y, _ = (tuple(map(float, column)) for column in self.R.T)
        self.space.free(
            f"{name}_pose", self.space.ground, self.parts[name], axis=x, second=y, turned=(x, y)
        )
        ends = ("slide_1", "slide_2", "turn_3")
        return {
            f"{name}_pose:{end}": law
            for end, law in zip(ends, self.planar.motion[name], strict=True)
        }

    def _seen(self, expression):
        """An expression of the planar mechanism in the symbols of the one in space."""
        flat = self.flat
        old, new = (
            [flat.time, flat.symbols],
            [self.space.time, ca.DM([self.values[name] for name in flat.parameters])],
        )
        for measure in flat.measures.asked:
            symbols = ca.vertcat(*measure.places, *measure.rates)
            if ca.depends_on(ca.SX(expression), symbols):
                old.append(symbols)
                new.append(self._measured(measure.of))
        return ca.substitute(
            ca.SX(expression), ca.vertcat(ca.SX(0, 1), *old), ca.vertcat(ca.SX(0, 1), *new)
        )

    def _measured(self, of: Joint | Point | Link):
        """What a measure sees, then its rates."""
        space = self.space
        if isinstance(of, Joint):
            joint = space.joints[of.name]
            name = "" if len(joint.axes) == 1 else "slide"
            return ca.vertcat(space.coordinate(joint, name), space.rate(joint, name))
        if isinstance(of, Point):
            place, speed = (
                ca.vertcat(*vector)
                for vector in (space.place(self._at(of)), space.velocity(self._at(of)))
            )
            return ca.vertcat(self.R[:, :2].T @ place, self.R[:, :2].T @ speed)
        return self._angle(of)

    def _angle(self, link: Link):
        """The direction of a link and its rate: of a body by two points of it, which bear its
        couple; else a sum along joints.
        """
        if isinstance(link.mass, RigidMass):
            base, tip = self._measured(link.base), self._measured(link.tip)
            along, speed = ca.vertsplit(tip - base, 2)
            now = self.found[f"pose:{link.name}:angle"]
            c, s = np.cos(now), np.sin(now)
            turn = ca.atan2(c * along[1] - s * along[0], c * along[0] + s * along[1])
            return ca.vertcat(
                now + turn, (along[0] * speed[1] - along[1] * speed[0]) / ca.sumsqr(along)
            )
        known = {self.flat.ground: ca.SX(2, 1)}
        while link not in known:
            for joint in self.flat.joints.values():
                parent, child = joint.bodies
                if (
                    joint.kind == "slot"
                    or not child.oriented
                    or (parent in known) == (child in known)
                ):
                    continue
                turn = (
                    self._measured(joint)
                    if joint.kind == "revolute"
                    else ca.vertcat(ca.SX(self._number(joint.angle)), 0)
                )
                if parent in known:
                    known[child] = known[parent] + turn
                else:
                    known[parent] = known[child] - turn
        return known[link]
