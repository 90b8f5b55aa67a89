"""An independent solution: vector Newton-Euler on free bodies in absolute coordinates.

It imports nothing of the package. Every body has a place (x, y) and a direction; every joint is written as gaps between bodies;
Newton's method finds the postures, and truncated power series in time (:class:`Jet`) give rates and accelerations. The forces
are the unknowns of the balance of force and moment of every body, all solved at once; a section's forces are the balance of
the piece towards the tip. It shares no formula with an energy method.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Jet:
    """A number with its first and second derivative by time."""

    v: float
    d: float = 0.0
    a: float = 0.0

    def __add__(self, o):
        o = _jet(o)
        return Jet(self.v + o.v, self.d + o.d, self.a + o.a)

    def __sub__(self, o):
        o = _jet(o)
        return Jet(self.v - o.v, self.d - o.d, self.a - o.a)

    def __mul__(self, o):
        o = _jet(o)
        return Jet(self.v * o.v, self.d * o.v + self.v * o.d, self.a * o.v + 2 * self.d * o.d + self.v * o.a)

    __radd__ = __add__
    __rmul__ = __mul__


def _jet(x):
    return x if isinstance(x, Jet) else Jet(x)


def _cos(q: Jet) -> Jet:
    c, s = math.cos(q.v), math.sin(q.v)
    return Jet(c, -s * q.d, -s * q.a - c * q.d * q.d)


def _sin(q: Jet) -> Jet:
    c, s = math.cos(q.v), math.sin(q.v)
    return Jet(s, c * q.d, c * q.a - s * q.d * q.d)


@dataclass(frozen=True)
class Body:
    """A uniform rod of a length, or a point mass where the length is None."""

    name: str
    mass: float
    length: float | None = None


@dataclass(frozen=True)
class Joint:
    """``parent`` and ``child`` are (body name, x, y); the ground's name is "ground"."""

    name: str
    kind: str
    parent: tuple[str, float, float]
    child: tuple[str, float, float]
    axis: tuple[float, float] = (1.0, 0.0)
    angle: float = 0.0


@dataclass
class Result:
    """Everything at one instant; ``reactions`` are (fx, fy, mz) of the parent on the child, mz about the child's point."""

    q: dict[str, tuple[Jet, Jet, Jet]]
    efforts: dict[str, float] = field(default_factory=dict)
    reactions: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    sections: dict[str, Callable[[float], tuple[float, float, float]]] = field(default_factory=dict)


@dataclass(frozen=True)
class Oracle:
    """A mechanism of bodies and joints; ``gravity`` in m/s^2."""

    bodies: Sequence[Body]
    joints: Sequence[Joint]
    gravity: tuple[float, float] = (0.0, -9.81)

    def solve(self, drives: dict[str, tuple[float, float, float]], guess: dict[str, tuple[float, float, float]]) -> Result:
        """The instant at which the driven joints have the given (coordinate, rate, acceleration), from a rough posture."""
        names = [b.name for b in self.bodies]
        q = np.array([x for n in names for x in guess[n]], dtype=float)
        for _ in range(50):
            gap, slope = self._gaps(q, drives, 0)
            step, *_ = np.linalg.lstsq(slope, -gap, rcond=None)
            q = q + step
            if np.max(np.abs(step)) < 1e-14 * (1 + np.max(np.abs(q))):
                break
        else:
            assert np.max(np.abs(step)) < 1e-11, "the oracle does not close its loops"
        _, slope = self._gaps(q, drives, 0)
        rate = np.linalg.lstsq(slope, -self._gaps(q, drives, 1)[0], rcond=None)[0]
        acceleration = np.linalg.lstsq(slope, -self._gaps(q, drives, 2, rate)[0], rcond=None)[0]
        jets = [Jet(*x) for x in zip(q, rate, acceleration, strict=True)]
        result = Result({n: tuple(jets[3 * i : 3 * i + 3]) for i, n in enumerate(names)})
        self._balance(result, drives)
        return result

    def _place(self, q, point):
        name, x, y = point
        if name == "ground":
            return Jet(x), Jet(y), Jet(0.0)
        bx, by, phi = q[name]
        c, s = _cos(phi), _sin(phi)
        return bx + x * c - y * s, by + x * s + y * c, phi

    def _joint_gaps(self, q, joint, drives):
        px, py, pphi = self._place(q, joint.parent)
        cx, cy, cphi = self._place(q, joint.child)
        gaps = []
        if joint.kind == "revolute":
            gaps = [cx - px, cy - py]
            if joint.name in drives:
                gaps.append(cphi - pphi - Jet(*drives[joint.name]))
            return gaps
        c, s = _cos(pphi), _sin(pphi)
        ax, ay = joint.axis[0] * c - joint.axis[1] * s, joint.axis[0] * s + joint.axis[1] * c
        gaps = [ax * (cy - py) - ay * (cx - px)]
        if self._length(joint.child[0]) is not None:
            gaps.append(cphi - pphi - joint.angle)
        if joint.name in drives:
            gaps.append(ax * (cx - px) + ay * (cy - py) - Jet(*drives[joint.name]))
        return gaps

    def _length(self, name):
        return 0.0 if name == "ground" else next(b.length for b in self.bodies if b.name == name)

    def _gaps(self, q, drives, order, rate=None):
        """Gaps of the given order of derivative with all higher rates of q at zero, and their slope by q."""
        names = [b.name for b in self.bodies]
        rate = np.zeros_like(q) if rate is None else rate

        def gaps(seed, take):
            jets = [Jet(*x) for x in zip(q, seed, np.zeros_like(q), strict=True)]
            at = {n: tuple(jets[3 * i : 3 * i + 3]) for i, n in enumerate(names)}
            still = {k: (v[0], 0.0, 0.0) for k, v in drives.items()} if take == "slope" else drives
            found = [g for j in self.joints for g in self._joint_gaps(at, j, still)]
            found += [at[b.name][2] for b in self.bodies if b.length is None]
            return np.array([{"slope": g.d, 0: g.v, 1: g.d, 2: g.a}[take] for g in found])

        slope = np.column_stack([gaps(e, "slope") for e in np.eye(q.size)])
        return gaps(rate, order), slope

    def _balance(self, result, drives):
        """Force and moment balance of every body, for all joint forces and efforts together."""
        row = {b.name: 3 * i for i, b in enumerate(self.bodies)}
        columns, labels = [], []

        def unknown(joint, label, force, moment):
            column = np.zeros(3 * len(self.bodies))
            point = self._place(result.q, joint.child)
            for (name, *_), sign in ((joint.child, 1.0), (joint.parent, -1.0)):
                if name == "ground":
                    continue
                cx, cy = (z.v for z in self._centre(result.q, name))
                arm = (point[0].v - cx, point[1].v - cy)
                turn = arm[0] * force[1] - arm[1] * force[0] + moment
                column[row[name] : row[name] + 3] += sign * np.array([force[0], force[1], turn])
            columns.append(column)
            labels.append((joint, label, force))

        for joint in self.joints:
            if joint.kind == "revolute":
                unknown(joint, "f", (1.0, 0.0), 0.0)
                unknown(joint, "f", (0.0, 1.0), 0.0)
                if joint.name in drives:
                    unknown(joint, "effort", (0.0, 0.0), 1.0)
                continue
            phi = self._place(result.q, joint.parent)[2].v
            ax = joint.axis[0] * math.cos(phi) - joint.axis[1] * math.sin(phi)
            ay = joint.axis[0] * math.sin(phi) + joint.axis[1] * math.cos(phi)
            unknown(joint, "f", (-ay, ax), 0.0)
            if self._length(joint.child[0]) is not None:
                unknown(joint, "m", (0.0, 0.0), 1.0)
            if joint.name in drives:
                unknown(joint, "effort", (ax, ay), 0.0)
        inertia = []
        for b in self.bodies:
            cx, cy = self._centre(result.q, b.name)
            alpha = result.q[b.name][2].a
            about = 0.0 if b.length is None else b.mass * b.length**2 / 12
            inertia += [b.mass * (cx.a - self.gravity[0]), b.mass * (cy.a - self.gravity[1]), about * alpha]
        matrix = np.column_stack(columns)
        keep = np.array([not (b.length is None and k == 2) for b in self.bodies for k in range(3)])
        found, *_ = np.linalg.lstsq(matrix[keep], np.array(inertia)[keep], rcond=None)
        for joint in self.joints:
            mine = [(label, force, x) for (j, label, force), x in zip(labels, found, strict=True) if j is joint]
            fx = sum(f[0] * x for label, f, x in mine if label == "f")
            fy = sum(f[1] * x for label, f, x in mine if label == "f")
            mz = sum(x for label, _, x in mine if label == "m")
            result.reactions[joint.name] = (fx, fy, mz)
            for label, _, x in mine:
                if label == "effort":
                    result.efforts[joint.name] = x
        applied = [
            (j, f, x, 1.0 if label != "f" and f == (0.0, 0.0) else 0.0) for (j, label, f), x in zip(labels, found, strict=True)
        ]
        for b in self.bodies:
            if b.length is not None:
                result.sections[b.name] = self._section(result, b, applied)

    def _centre(self, q, name):
        length = self._length(name)
        return self._place(q, (name, 0.0 if length is None else length / 2, 0.0))[:2]

    def _section(self, result, body, applied):
        """Action of the piece towards the tip on the piece towards the base: (axial, shear, bending) at a ratio xi/l."""

        def at(ratio: float) -> tuple[float, float, float]:
            phi = result.q[body.name][2]
            c, s = math.cos(phi.v), math.sin(phi.v)
            xi, l, rho = ratio * body.length, body.length, body.mass / body.length
            cut = self._place(result.q, (body.name, xi, 0.0))
            fx = fy = mz = 0.0  # what acts on the piece towards the tip, joints at the tip first
            for joint, force, x, couple in applied:
                for (name, px, _), sign in ((joint.child, 1.0), (joint.parent, -1.0)):
                    if name != body.name or px < 0.5 * l:
                        continue
                    point = self._place(result.q, joint.child)
                    arm = (point[0].v - cut[0].v, point[1].v - cut[1].v)
                    fx += sign * x * force[0]
                    fy += sign * x * force[1]
                    mz += sign * x * (arm[0] * force[1] - arm[1] * force[0] + couple)
            mass, centre = rho * (l - xi), self._place(result.q, (body.name, (xi + l) / 2, 0.0))
            gx, gy = mass * (self.gravity[0] - centre[0].a), mass * (self.gravity[1] - centre[1].a)
            arm = (centre[0].v - cut[0].v, centre[1].v - cut[1].v)
            fx, fy = fx + gx, fy + gy
            mz += arm[0] * gy - arm[1] * gx - mass * (l - xi) ** 2 / 12 * phi.a
            return fx * c + fy * s, fy * c - fx * s, mz

        return at
