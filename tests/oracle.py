"""An independent solution: vector Newton-Euler on free bodies in absolute coordinates.

It imports nothing of the package. Every body has a place (x, y) and a direction; every joint is written as gaps between bodies;
Newton's method finds the postures, and truncated power series in time (:class:`Jet`) give rates and accelerations. The forces
are the unknowns of the balance of force and moment of every body, all solved at once; a section's forces are the balance of
the piece towards the tip. It shares no formula with an energy method.
"""

from __future__ import annotations

import itertools
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
    """A rigid body, or a point mass where ``oriented`` is false.

    ``centre`` is in its axes and ``inertia`` about it; ``density`` (kg per unit of the ratio) and its ``breaks`` are for sections.
    """

    name: str
    mass: float
    length: float = 0.0
    centre: tuple[float, float] = (0.0, 0.0)
    inertia: float = 0.0
    oriented: bool = True
    density: Callable[[float], float] | None = None
    breaks: tuple[float, ...] = (0.0, 1.0)


def from_density(name: str, length: float, density: Callable[[float], float], breaks=(0.0, 1.0)) -> Body:
    """A straight body, its mass, centre and inertia by quadrature."""
    mass, first, second = _moments(density, breaks, 0.0)
    centre = first / mass if mass else 0.0
    inertia = (second - first * centre) * length**2
    return Body(name, mass, length, (centre * length, 0.0), inertia, True, density, tuple(breaks))


def _moments(density, breaks, start):
    """Integrals of density, density u and density u^2 from ``start`` to 1, by Gauss' rule on each smooth piece."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    total = np.zeros(3)
    for a, b in itertools.pairwise(breaks):
        a = max(a, start)
        if b > a:
            u = a + (nodes + 1) / 2 * (b - a)
            w = weights * (b - a) / 2 * np.array([density(x) for x in u])
            total += [np.sum(w), np.sum(w * u), np.sum(w * u * u)]
    return total


@dataclass(frozen=True)
class Joint:
    """``parent`` and ``child`` are (body name, x, y); the ground's name is "ground"."""

    name: str
    kind: str
    parent: tuple[str, float, float]
    child: tuple[str, float, float]
    axis: tuple[float, float] = (1.0, 0.0)
    angle: float = 0.0

    @property
    def slides(self) -> bool:
        return self.kind in ("prismatic", "slot")


@dataclass(frozen=True)
class Extra:
    """Something else that holds: ``gap(place)`` of jets (None for a non-holonomic row), and what a unit of its force does.

    ``effect(place)`` lists (point, fx, fy, mz) of a unit multiplier.
    """

    name: str
    gap: Callable | None
    effect: Callable


@dataclass
class Result:
    """Everything at one instant; ``reactions`` are (fx, fy, mz) of the parent on the child, mz about the child's point."""

    q: dict[str, tuple[Jet, Jet, Jet]]
    efforts: dict[str, float] = field(default_factory=dict)
    reactions: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    multipliers: dict[str, float] = field(default_factory=dict)
    sections: dict[str, Callable[[float], tuple[float, float, float]]] = field(default_factory=dict)


@dataclass(frozen=True)
class Oracle:
    """A mechanism of bodies and joints; ``gravity`` in m/s^2; ``loads`` list (point, fx, fy, mz) from a posture.

    ``unaided`` are driven joints that bear no effort.
    """

    bodies: Sequence[Body]
    joints: Sequence[Joint]
    gravity: tuple[float, float] = (0.0, -9.81)
    loads: Sequence[Callable] = ()
    extras: Sequence[Extra] = ()
    unaided: Sequence[str] = ()

    def solve(self, drives: dict[str, tuple[float, float, float]], guess: dict[str, tuple[float, float, float]]) -> Result:
        """The instant at which the driven joints have the given (coordinate, rate, acceleration), from a rough posture."""
        names = [b.name for b in self.bodies]
        q = np.array([x for n in names for x in guess[n]], dtype=float)
        for _ in range(50):
            gap, slope = self._gaps(q, drives, 0)
            step, *_ = np.linalg.lstsq(slope, -gap, rcond=1e-9)
            q = q + step
            if np.max(np.abs(step)) < 1e-14 * (1 + np.max(np.abs(q))):
                break
        else:
            assert np.max(np.abs(step)) < 1e-11, "the oracle does not close its loops"
        _, slope = self._gaps(q, drives, 0)
        rate = np.linalg.lstsq(slope, -self._gaps(q, drives, 1)[0], rcond=1e-9)[0]
        acceleration = np.linalg.lstsq(slope, -self._gaps(q, drives, 2, rate)[0], rcond=1e-9)[0]
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

    def _oriented(self, name):
        return name == "ground" or next(b.oriented for b in self.bodies if b.name == name)

    def _holds_direction(self, joint):
        return joint.kind in ("prismatic", "weld") and self._oriented(joint.child[0])

    def _joint_gaps(self, q, joint, drives):
        px, py, pphi = self._place(q, joint.parent)
        cx, cy, cphi = self._place(q, joint.child)
        gaps = [cx - px, cy - py]
        if joint.slides:
            c, s = _cos(pphi), _sin(pphi)
            ax, ay = joint.axis[0] * c - joint.axis[1] * s, joint.axis[0] * s + joint.axis[1] * c
            gaps = [ax * (cy - py) - ay * (cx - px)]
        if self._holds_direction(joint):
            gaps.append(cphi - pphi - joint.angle)
        if joint.name in drives:
            coordinate = ax * (cx - px) + ay * (cy - py) if joint.slides else cphi - pphi
            gaps.append(coordinate - Jet(*drives[joint.name]))
        return gaps

    def _gaps(self, q, drives, order, rate=None):
        """Gaps of the given order of derivative with all higher rates of q at zero, and their slope by q."""
        names = [b.name for b in self.bodies]
        rate = np.zeros_like(q) if rate is None else rate

        def gaps(seed, take):
            jets = [Jet(*x) for x in zip(q, seed, np.zeros_like(q), strict=True)]
            at = {n: tuple(jets[3 * i : 3 * i + 3]) for i, n in enumerate(names)}
            still = {k: (v[0], 0.0, 0.0) for k, v in drives.items()} if take == "slope" else drives
            found = [g for j in self.joints for g in self._joint_gaps(at, j, still)]
            found += [extra.gap(lambda point: self._place(at, point)) for extra in self.extras if extra.gap]
            found += [at[b.name][2] for b in self.bodies if not b.oriented]
            return np.array([{"slope": g.d, 0: g.v, 1: g.d, 2: g.a}[take] for g in found])

        still = gaps(np.zeros_like(q), "slope")
        slope = np.column_stack([gaps(e, "slope") - still for e in np.eye(q.size)])
        return gaps(rate, order), slope

    def _balance(self, result, drives):
        """Force and moment balance of every body, for all joint forces, efforts and multipliers together."""
        q = result.q

        def place(point):
            return self._place(q, point)

        labels, unknowns = [], []  # an unknown is what a unit of it does: a list of (point, fx, fy, mz)

        def pair(joint, label, force, moment):
            at = joint.child
            meets = joint.parent
            if meets[0] != "ground":
                meets = (meets[0], *self._local(q, meets[0], place(at)))
            labels.append((joint.name, label, (*force, moment)))
            unknowns.append([(at, *force, moment), (meets, -force[0], -force[1], -moment)])

        for joint in self.joints:
            phi = place(joint.parent)[2].v
            ax = joint.axis[0] * math.cos(phi) - joint.axis[1] * math.sin(phi)
            ay = joint.axis[0] * math.sin(phi) + joint.axis[1] * math.cos(phi)
            for force in [(-ay, ax)] if joint.slides else [(1.0, 0.0), (0.0, 1.0)]:
                pair(joint, "reaction", force, 0.0)
            if self._holds_direction(joint):
                pair(joint, "reaction", (0.0, 0.0), 1.0)
            if joint.name in drives and joint.name not in self.unaided:
                pair(joint, "effort", (ax, ay) if joint.slides else (0.0, 0.0), 0.0 if joint.slides else 1.0)
        for extra in self.extras:
            labels.append((extra.name, "multiplier", (0.0, 0.0, 0.0)))
            unknowns.append(extra.effect(place))
        given = [part for load in self.loads for part in load(place)]
        matrix = np.column_stack([self._on_bodies(q, parts) for parts in unknowns])
        inertia = []
        for b in self.bodies:
            cx, cy, phi = self._place(q, (b.name, *b.centre))
            inertia += [b.mass * (cx.a - self.gravity[0]), b.mass * (cy.a - self.gravity[1]), b.inertia * phi.a]
        right = np.array(inertia) - self._on_bodies(q, given)
        keep = np.array([b.oriented or k < 2 for b in self.bodies for k in range(3)])
        found, *_ = np.linalg.lstsq(matrix[keep], right[keep], rcond=1e-11)
        for (name, label, (fx, fy, mz)), x in zip(labels, found, strict=True):
            if label == "reaction":
                before = result.reactions.get(name, (0.0, 0.0, 0.0))
                result.reactions[name] = (before[0] + x * fx, before[1] + x * fy, before[2] + x * mz)
            else:
                (result.efforts if label == "effort" else result.multipliers)[name] = x
        acting = [(p, x * fx, x * fy, x * mz) for parts, x in zip(unknowns, found, strict=True) for p, fx, fy, mz in parts]
        for b in self.bodies:
            if b.density is not None:
                result.sections[b.name] = self._section(result, b, acting + given)

    def _on_bodies(self, q, parts):
        """Force and moment about each body's centre, stacked."""
        row = {b.name: 3 * i for i, b in enumerate(self.bodies)}
        stacked = np.zeros(3 * len(self.bodies))
        for (name, px, py), fx, fy, mz in parts:
            if name == "ground":
                continue
            body = next(b for b in self.bodies if b.name == name)
            at, centre = self._place(q, (name, px, py)), self._place(q, (name, *body.centre))
            arm = (at[0].v - centre[0].v, at[1].v - centre[1].v)
            stacked[row[name] : row[name] + 3] += [fx, fy, arm[0] * fy - arm[1] * fx + mz]
        return stacked

    def _local(self, q, name, at):
        """A place in a body's axes."""
        bx, by, phi = q[name]
        dx, dy, c, s = at[0].v - bx.v, at[1].v - by.v, math.cos(phi.v), math.sin(phi.v)
        return c * dx + s * dy, c * dy - s * dx

    def _section(self, result, body, acting):
        """Action of the piece towards the tip on the piece towards the base: (axial, shear, bending) at a ratio xi/l."""

        def at(ratio: float) -> tuple[float, float, float]:
            phi = result.q[body.name][2]
            c, s = math.cos(phi.v), math.sin(phi.v)
            l = body.length
            cut = self._place(result.q, (body.name, ratio * l, 0.0))
            fx = fy = mz = 0.0  # what acts on the piece towards the tip
            for (name, px, py), gx, gy, couple in acting:
                # At the very tip of the link what acts there still acts beyond the section.
                if name == body.name and (px > ratio * l + 1e-12 * l or (ratio == 1.0 and abs(px - l) < 1e-12 * l)):
                    point = self._place(result.q, (name, px, py))
                    arm = (point[0].v - cut[0].v, point[1].v - cut[1].v)
                    fx, fy, mz = fx + gx, fy + gy, mz + arm[0] * gy - arm[1] * gx + couple
            mass, first, second = _moments(body.density, body.breaks, ratio)
            if mass:
                middle = first / mass
                centre = self._place(result.q, (body.name, middle * l, 0.0))
                gx, gy = mass * (self.gravity[0] - centre[0].a), mass * (self.gravity[1] - centre[1].a)
                arm = (centre[0].v - cut[0].v, centre[1].v - cut[1].v)
                fx, fy = fx + gx, fy + gy
                mz += arm[0] * gy - arm[1] * gx - (second - first * middle) * l**2 * phi.a
            return fx * c + fy * s, fy * c - fx * s, mz

        return at
