"""An independent solution: vector Newton-Euler on free bodies in absolute coordinates.

It imports nothing of the package. Every body has a place (x, y) and a direction; every joint is written as gaps between bodies;
Newton's method finds the postures, and truncated power series in time (:class:`Jet`) give rates and accelerations. The forces
are the unknowns of the balance of force and moment of every body, all solved at once; a section's forces are the balance of
the piece towards the tip. It shares no formula with an energy method. The numbers are those of an :mod:`arithmetic`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from arithmetic import DOUBLE, Digits, Double


@dataclass(frozen=True)
class Jet:
    """A number with its first and second derivative by time."""

    v: float
    d: float = 0.0
    a: float = 0.0

    def __add__(self, o):
        return Jet(self.v + o.v, self.d + o.d, self.a + o.a) if isinstance(o, Jet) else Jet(self.v + o, self.d, self.a)

    def __sub__(self, o):
        return Jet(self.v - o.v, self.d - o.d, self.a - o.a) if isinstance(o, Jet) else Jet(self.v - o, self.d, self.a)

    def __mul__(self, o):
        if not isinstance(o, Jet):
            return Jet(self.v * o, self.d * o, self.a * o)
        return Jet(self.v * o.v, self.d * o.v + self.v * o.d, self.a * o.v + 2 * self.d * o.d + self.v * o.a)

    __radd__ = __add__
    __rmul__ = __mul__


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


def from_density(name: str, length: float, density: Callable[[float], float], breaks=(0.0, 1.0), arithmetic=DOUBLE) -> Body:
    """A straight body, its mass, centre and inertia by quadrature."""
    mass, first, second = _moments(arithmetic, density, breaks, 0.0)
    centre = first / mass if mass else 0.0
    inertia = (second - first * centre) * length**2
    return Body(name, mass, length, (centre * length, 0.0), inertia, True, density, tuple(breaks))


def _moments(arithmetic, density, breaks, start):
    """Integrals of density, density u and density u^2 from ``start`` to 1, by Gauss' rule on each smooth piece."""
    nodes, weights = arithmetic.gauss
    total = arithmetic.zeros(3)
    for a, b in itertools.pairwise(breaks):
        a = max(a, start)
        if b > a:
            u = a + (nodes + 1) / 2 * (b - a)
            w = weights * (b - a) / 2 * arithmetic.array([density(x) for x in u])
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
    arithmetic: Double | Digits = DOUBLE

    def solve(self, drives: dict[str, tuple[float, float, float]], guess: dict[str, tuple[float, float, float]]) -> Result:
        """The instant at which the driven joints have the given (coordinate, rate, acceleration), from a rough posture."""
        names, a = [b.name for b in self.bodies], self.arithmetic
        drives = {joint: tuple(map(a.number, drive)) for joint, drive in drives.items()}
        q = a.array([a.number(x) for n in names for x in guess[n]])
        rest = np.zeros_like(q)
        for _ in range(50):
            step = a.solve(self._slope(q, drives), -self._gaps(q, rest, drives)[0], 1e-9)
            q = q + step
            left, size = np.max(np.abs(step)), 1 + np.max(np.abs(q))
            if left < a.tolerance * size:
                break
        left = max(left, np.max(np.abs(self._gaps(q, rest, drives)[0])))
        assert left < 1000 * a.tolerance * size, "the oracle does not close its loops"
        slope = self._slope(q, drives)
        rate = a.solve(slope, -self._gaps(q, rest, drives)[1], 1e-9)
        acceleration = a.solve(slope, -self._gaps(q, rate, drives)[2], 1e-9)
        jets = [Jet(*x) for x in zip(q, rate, acceleration, strict=True)]
        result = Result({n: tuple(jets[3 * i : 3 * i + 3]) for i, n in enumerate(names)})
        self._balance(result, drives)
        return result

    def _frames(self, q):
        """Of every body, and the ground, the place of its base, its direction, and the direction's cosine and sine."""
        zero, one = self.arithmetic.number(0), self.arithmetic.number(1)
        frames = {"ground": (Jet(zero), Jet(zero), Jet(zero), Jet(one), Jet(zero))}
        for name, (x, y, phi) in q.items():
            c, s = self.arithmetic.cos(phi.v), self.arithmetic.sin(phi.v)
            cosine = Jet(c, -s * phi.d, -s * phi.a - c * phi.d * phi.d)
            frames[name] = (x, y, phi, cosine, Jet(s, c * phi.d, c * phi.a - s * phi.d * phi.d))
        return frames

    def _oriented(self, name):
        return name == "ground" or next(b.oriented for b in self.bodies if b.name == name)

    def _holds_direction(self, joint):
        return joint.kind in ("prismatic", "weld") and self._oriented(joint.child[0])

    def _joint_gaps(self, frames, joint, drives):
        px, py, pphi = _place(frames, joint.parent)
        cx, cy, cphi = _place(frames, joint.child)
        gaps = [cx - px, cy - py]
        if joint.slides:
            ax, ay = _along(frames, joint)
            gaps = [ax * (cy - py) - ay * (cx - px)]
        if self._holds_direction(joint):
            gaps.append(cphi - pphi - joint.angle)
        if joint.name in drives:
            coordinate = ax * (cx - px) + ay * (cy - py) if joint.slides else cphi - pphi
            gaps.append(coordinate - Jet(*drives[joint.name]))
        return gaps

    def _gaps(self, q, rate, drives):
        """Gaps with their first and second derivative, all accelerations of q at zero: (3, gaps)."""
        jets = [Jet(*x) for x in zip(q, rate, np.zeros_like(q), strict=True)]
        frames = self._frames({b.name: tuple(jets[3 * i : 3 * i + 3]) for i, b in enumerate(self.bodies)})
        found = [g for j in self.joints for g in self._joint_gaps(frames, j, drives)]
        found += [extra.gap(lambda point: _place(frames, point)) for extra in self.extras if extra.gap]
        found += [frames[b.name][2] for b in self.bodies if not b.oriented]
        return self.arithmetic.array([(g.v, g.d, g.a) for g in found]).T

    def _slope(self, q, drives):
        """Slope of the gaps by q."""
        still = {joint: (coordinate, 0, 0) for joint, (coordinate, *_) in drives.items()}
        rest = self._gaps(q, np.zeros_like(q), still)[1]
        return np.column_stack([self._gaps(q, e, still)[1] - rest for e in np.eye(q.size, dtype=q.dtype)])

    def _balance(self, result, drives):
        """Force and moment balance of every body, for all joint forces, efforts and multipliers together."""
        frames = self._frames(result.q)

        def place(point):
            return _place(frames, point)

        labels, unknowns = [], []  # an unknown is what a unit of it does: a list of (point, fx, fy, mz)

        def pair(joint, label, force, moment):
            at = joint.child
            meets = joint.parent
            if meets[0] != "ground":
                meets = (meets[0], *_local(frames, meets[0], place(at)))
            labels.append((joint.name, label, (*force, moment)))
            unknowns.append([(at, *force, moment), (meets, -force[0], -force[1], -moment)])

        for joint in self.joints:
            ax, ay = (component.v for component in _along(frames, joint))
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
        matrix = np.column_stack([self._on_bodies(frames, parts) for parts in unknowns])
        inertia = []
        for b in self.bodies:
            cx, cy, phi = _place(frames, (b.name, *b.centre))
            inertia += [b.mass * (cx.a - self.gravity[0]), b.mass * (cy.a - self.gravity[1]), b.inertia * phi.a]
        right = self.arithmetic.array(inertia) - self._on_bodies(frames, given)
        keep = np.array([b.oriented or k < 2 for b in self.bodies for k in range(3)])
        matrix, right = matrix[keep], right[keep]
        found = self.arithmetic.solve(matrix, right, 1e-11)
        left, size = np.max(np.abs(matrix @ found - right)), np.max(np.abs(right)) + np.max(np.abs(found))
        assert left <= 1000 * self.arithmetic.tolerance * size, "the oracle's forces do not balance its bodies"
        for (name, label, (fx, fy, mz)), x in zip(labels, found, strict=True):
            if label == "reaction":
                before = result.reactions.get(name, (0.0, 0.0, 0.0))
                result.reactions[name] = (before[0] + x * fx, before[1] + x * fy, before[2] + x * mz)
            else:
                (result.efforts if label == "effort" else result.multipliers)[name] = x
        acting = [(p, x * fx, x * fy, x * mz) for parts, x in zip(unknowns, found, strict=True) for p, fx, fy, mz in parts]
        for b in self.bodies:
            if b.density is not None:
                result.sections[b.name] = self._section(frames, b, acting + given)

    def _on_bodies(self, frames, parts):
        """Force and moment about each body's centre, stacked."""
        row = {b.name: 3 * i for i, b in enumerate(self.bodies)}
        stacked = self.arithmetic.zeros(3 * len(self.bodies))
        for (name, px, py), fx, fy, mz in parts:
            if name == "ground":
                continue
            body = next(b for b in self.bodies if b.name == name)
            at, centre = _place(frames, (name, px, py)), _place(frames, (name, *body.centre))
            arm = (at[0].v - centre[0].v, at[1].v - centre[1].v)
            stacked[row[name] : row[name] + 3] += [fx, fy, arm[0] * fy - arm[1] * fx + mz]
        return stacked

    def _section(self, frames, body, acting):
        """Action of the piece towards the tip on the piece towards the base: (axial, shear, bending) at a ratio xi/l."""

        def at(ratio: float) -> tuple[float, float, float]:
            ratio, l, near = self.arithmetic.number(ratio), body.length, 100 * self.arithmetic.tolerance * body.length
            phi, c, s = frames[body.name][2], frames[body.name][3].v, frames[body.name][4].v
            cut = _place(frames, (body.name, ratio * l, 0.0))
            fx = fy = mz = 0.0  # what acts on the piece towards the tip
            for (name, px, py), gx, gy, couple in acting:
                # At the very tip of the link what acts there still acts beyond the section.
                if name == body.name and (px > ratio * l + near or (ratio == 1 and abs(px - l) < near)):
                    point = _place(frames, (name, px, py))
                    arm = (point[0].v - cut[0].v, point[1].v - cut[1].v)
                    fx, fy, mz = fx + gx, fy + gy, mz + arm[0] * gy - arm[1] * gx + couple
            mass, first, second = _moments(self.arithmetic, body.density, body.breaks, ratio)
            if mass:
                middle = first / mass
                centre = _place(frames, (body.name, middle * l, 0.0))
                gx, gy = mass * (self.gravity[0] - centre[0].a), mass * (self.gravity[1] - centre[1].a)
                arm = (centre[0].v - cut[0].v, centre[1].v - cut[1].v)
                fx, fy = fx + gx, fy + gy
                mz += arm[0] * gy - arm[1] * gx - (second - first * middle) * l**2 * phi.a
            return fx * c + fy * s, fy * c - fx * s, mz

        return at


def _place(frames, point):
    """The place of a body's point, and the body's direction."""
    name, x, y = point
    bx, by, phi, c, s = frames[name]
    # The jets first: mpmath would try to read one as a number.
    return bx + c * x - s * y, by + s * x + c * y, phi


def _along(frames, joint):
    """The axis that a joint's parent carries, in ground axes."""
    (x, y), (_, _, _, c, s) = joint.axis, frames[joint.parent[0]]
    return c * x - s * y, s * x + c * y


def _local(frames, name, at):
    """A place in a body's axes."""
    bx, by, _, c, s = frames[name]
    dx, dy = at[0].v - bx.v, at[1].v - by.v
    return c.v * dx + s.v * dy, c.v * dy - s.v * dx
