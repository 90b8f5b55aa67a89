"""An independent solution: vector Newton-Euler on free bodies in absolute coordinates.

It imports nothing of the package. Every body has a place (x, y) and a direction; every joint is
written as gaps between bodies; Newton's method finds the postures, and truncated power series in
time (:mod:`jets`) give rates and accelerations. The forces are the unknowns of the balance of force
and moment of every body, all solved at once; a section's forces are the balance of the piece
towards the tip. It shares no formula with an energy method.

It also tells where there is no one answer: how far the slope of the gaps is from singular, and, by
the null space of the balance, which forces equilibrium leaves open.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from arithmetic import GAUSS, TOLERANCE
from jets import Jet
from spread import forces

_LEAST = 1e-9
LEAST_STEADY = 1e-7
_SAME_SLOPE = 1e-4
_VAGUE = (1e-11, 1e-5)
_OPEN = 1e-7
_ROUNDS = 60
FORCES, SECTION = ("fx", "fy", "mz"), ("axial", "shear", "bending")


class OpenLoopError(AssertionError):
    """No posture near the guess closes all gaps."""


@dataclass(frozen=True)
class Body:
    """A rigid body, or a point mass where ``oriented`` is false.

    ``centre`` is in its axes and ``inertia`` about it; ``density`` (kg per unit of the ratio) and
    its ``breaks`` are for sections.
    """

    name: str
    mass: float
    length: float = 0.0
    centre: tuple[float, float] = (0.0, 0.0)
    inertia: float = 0.0
    oriented: bool = True
    density: Callable[[float], float] | None = None
    breaks: tuple[float, ...] = (0.0, 1.0)


def from_density(
    name: str,
    length: float,
    density: Callable[[float], float],
    breaks=(0.0, 1.0),
) -> Body:
    """A straight body, its mass, centre and inertia by quadrature."""
    mass, first, second = _moments(density, breaks, 0.0)
    centre = first / mass if mass else 0.0
    inertia = (second - first * centre) * length**2
    return Body(name, mass, length, (centre * length, 0.0), inertia, True, density, tuple(breaks))


def _moments(density, breaks, start):
    """Integrals of density, density u and density u^2 from ``start`` to 1, by Gauss' rule on each
    smooth piece.
    """
    nodes, weights = GAUSS
    total = np.zeros(3)
    for a, b in itertools.pairwise(breaks):
        a = max(a, start)
        if b > a:
            u = a + (nodes + 1) / 2 * (b - a)
            w = weights * (b - a) / 2 * [density(x) for x in u]
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
    """Something else that holds: ``gap(place)`` of jets (None for a non-holonomic row), and what a
    unit of its force does.

    ``effect(place)`` lists (point, fx, fy, mz) of a unit multiplier; None for what only says where
    something goes. ``presses(place, force)`` lists what acts besides, for a multiplier of this
    size: it moves no other multiplier, or one by a part of its own change.
    """

    name: str
    gap: Callable | None
    effect: Callable | None
    presses: Callable | None = None


@dataclass
class Result:
    """Everything at one instant; ``reactions`` are (fx, fy, mz) of the parent on the child, mz
    about the child's point.

    ``steadiness`` is the least singular value of the gaps' slope, its rows of length one: about the
    sine of a transmission angle; ``softest`` is that slope, and its singular vectors there.
    ``open`` names what equilibrium leaves open, ``open_sections`` tells it of a link's forces at a
    ratio; ``vague`` where a singular value of either is neither zero nor clearly another number.
    They are known in doubles only.
    """

    q: dict[str, tuple[Jet, Jet, Jet]]
    steadiness: float = 0.0
    softest: tuple | None = None
    vague: bool = False
    open: set[str] = field(default_factory=set)
    open_sections: dict[str, Callable[[float], tuple[bool, ...]]] = field(default_factory=dict)
    efforts: dict[str, float] = field(default_factory=dict)
    reactions: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    multipliers: dict[str, float] = field(default_factory=dict)
    frictions: dict[str, float] = field(default_factory=dict)
    sections: dict[str, Callable[[float], tuple[float, float, float]]] = field(default_factory=dict)


@dataclass(frozen=True)
class Oracle:
    """A mechanism of bodies and joints; ``gravity`` in m/s^2; ``loads`` list (point, fx, fy, mz)
    from a posture, ``spreads`` those along bodies.

    ``unaided`` are driven joints that bear no effort; ``pushed`` the joints that do, where these
    are not the driven ones. Where more of them push than are needed, the sum of squares of their
    efforts is the least, by the ``weights`` of joints that have one.
    """

    bodies: Sequence[Body]
    joints: Sequence[Joint]
    gravity: tuple[float, float] = (0.0, -9.81)
    loads: Sequence[Callable] = ()
    extras: Sequence[Extra] = ()
    unaided: Sequence[str] = ()
    pushed: Sequence[str] | None = None
    spreads: Sequence[Callable] = ()
    weights: Mapping[str, float] = field(default_factory=dict)

    def solve(
        self,
        drives: dict[str, tuple[float, float, float]],
        guess: dict[str, tuple[float, float, float]],
    ) -> Result:
        """The instant at which the driven joints have the given (coordinate, rate, acceleration),
        from a rough posture.
        """
        result = self.move(drives, guess)
        self.balance(result, drives)
        return result

    def move(
        self,
        drives: dict[str, tuple[float, float, float]],
        guess: dict[str, tuple[float, float, float]],
        steps: int = 50,
    ) -> Result:
        """The motion alone.

        Raises :class:`OpenLoopError` where Newton's method closes nothing in so many steps.
        """
        names = [b.name for b in self.bodies]
        q = np.array([x for n in names for x in guess[n]], float)
        rest, left = np.zeros_like(q), None
        for _ in range(steps):
            # Near the end the slope is as good as before.
            if left is None or left > _SAME_SLOPE:
                slope = self.slope(q, drives)
            step = np.linalg.lstsq(slope, -self.gaps(q, rest, drives)[0], _LEAST)[0]
            q, before = q + step, left
            left, size = np.max(np.abs(step)), 1 + np.max(np.abs(q))
            if left < TOLERANCE * size or (
                before is not None and before / 2 < left < 1000 * TOLERANCE * size
            ):
                break
        gaps, rates, _ = self.gaps(q, rest, drives)
        left = max(left, np.max(np.abs(gaps), initial=0.0))
        if not left < 1000 * TOLERANCE * size:
            raise OpenLoopError("the oracle does not close its loops")
        slope = self.slope(q, drives)
        rate = np.linalg.lstsq(slope, -rates, _LEAST)[0]
        acceleration = np.linalg.lstsq(slope, -self.gaps(q, rate, drives)[2], _LEAST)[0]
        jets = [Jet(*x) for x in zip(q, rate, acceleration, strict=True)]
        result = Result({n: tuple(jets[3 * i : 3 * i + 3]) for i, n in enumerate(names)})
        scaled = self.scaled(slope)
        left, values, right = np.linalg.svd(scaled, full_matrices=False)
        if scaled.shape[0] >= scaled.shape[1]:
            result.steadiness = float(values[-1])
            result.vague = bool(np.any((values > _VAGUE[0]) & (values < _VAGUE[1])))
            result.softest = (scaled, left[:, -1], right[-1])
        return result

    def scaled(self, slope):
        """The gaps' slope by places in units of the mechanism's size and by angles, its rows of
        length one.
        """
        scaled = slope * np.tile([self.size, self.size, 1.0], len(self.bodies))
        return scaled / np.linalg.norm(scaled, axis=1, keepdims=True)

    def places(self, result: Result):
        """The places of bodies' points, and the bodies' directions, as jets."""
        frames = self.frames(result.q)
        return lambda point: place_in(frames, point)

    @property
    def size(self) -> float:
        """The longest body's length, by which places and angles, forces
        and moments are compared.
        """
        return max((float(b.length) for b in self.bodies), default=0.0) or 1.0

    def frames(self, q):
        """Of every body, and the ground, the place of its base, its direction, and the direction's
        cosine and sine.
        """
        frames = {"ground": (Jet(0.0), Jet(0.0), Jet(0.0), Jet(1.0), Jet(0.0))}
        for name, (x, y, phi) in q.items():
            c, s = math.cos(phi.v), math.sin(phi.v)
            frames[name] = (x, y, phi, phi.through(c, -s, -c), phi.through(s, c, -s))
        return frames

    def _oriented(self, name):
        return name == "ground" or next(b.oriented for b in self.bodies if b.name == name)

    def _holds_direction(self, joint):
        return joint.kind in ("prismatic", "weld") and self._oriented(joint.child[0])

    def _joint_gaps(self, frames, joint, drives):
        px, py, pphi = place_in(frames, joint.parent)
        cx, cy, cphi = place_in(frames, joint.child)
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

    def gaps(self, q, rate, drives):
        """Gaps with their first and second derivative, all accelerations of q
        at zero: (3, gaps).
        """
        found = self._gap_jets(
            [Jet(*x) for x in zip(q.tolist(), rate.tolist(), strict=True)], drives
        )
        return np.array([(g.v, g.d, g.a) for g in found]).reshape(-1, 3).T

    def slope(self, q, drives):
        """Slope of the gaps by q: beside a rate of zero, at which a guide's gap changes too."""
        still = {joint: (coordinate, 0, 0) for joint, (coordinate, *_) in drives.items()}
        rows = np.eye(q.size, q.size + 1, dtype=q.dtype)
        along = self._gap_jets(
            [Jet(x, row) for x, row in zip(q.tolist(), rows, strict=True)], still
        )
        rates = np.array([g.d + np.zeros_like(rows[0]) for g in along]).reshape(-1, q.size + 1)
        return rates[:, :-1] - rates[:, -1:]

    def _gap_jets(self, jets, drives):
        frames = self.frames(
            {b.name: tuple(jets[3 * i : 3 * i + 3]) for i, b in enumerate(self.bodies)}
        )
        found = [g for j in self.joints for g in self._joint_gaps(frames, j, drives)]
        found += [
            extra.gap(lambda point: place_in(frames, point)) for extra in self.extras if extra.gap
        ]
        return found + [frames[b.name][2] for b in self.bodies if not b.oriented]

    def balance(self, result, drives):
        """Force and moment balance of every body, for all joint forces, efforts and multipliers
        together.
        """
        frames, place = self.frames(result.q), self.places(result)
        labels = []
        unknowns = []  # an unknown is what a unit of it does: a list of (point, fx, fy, mz)

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
            if (
                joint.name in (drives if self.pushed is None else self.pushed)
                and joint.name not in self.unaided
            ):
                pair(
                    joint,
                    "effort",
                    (ax, ay) if joint.slides else (0.0, 0.0),
                    0.0 if joint.slides else 1.0,
                )
        for extra in (extra for extra in self.extras if extra.effect):
            labels.append((extra.name, "multiplier", (0.0, 0.0, 0.0)))
            unknowns.append(extra.effect(place))
        given, spread = (
            [part for load in loads for part in load(place)] for loads in (self.loads, self.spreads)
        )
        matrix = np.column_stack([self._on_bodies(frames, parts) for parts in unknowns])
        inertia = []
        for b in self.bodies:
            cx, cy, phi = place_in(frames, (b.name, *b.centre))
            inertia += [
                b.mass * (cx.a - self.gravity[0]),
                b.mass * (cy.a - self.gravity[1]),
                b.inertia * phi.a,
            ]
        right = np.array(inertia) - self._on_bodies(frames, given + forces(spread))
        keep = np.array([b.oriented or k < 2 for b in self.bodies for k in range(3)])
        matrix, right = matrix[keep], right[keep]
        scales = np.array([1.0, 1.0, self.size] * len(self.bodies))[keep, None]
        null = self._null(result, matrix / scales)
        least, null = self._least(labels, null) if self.weights else (None, null)

        def solved(parts):
            left = right - self._on_bodies(frames, parts)[keep]
            found = np.linalg.lstsq(matrix, left, 1e-11)[0]
            return found if least is None else found + least @ found

        found, pressed = self._pressed(solved, labels, place)
        right, given = right - self._on_bodies(frames, pressed)[keep], given + pressed
        left = np.max(np.abs(matrix @ found - right))
        size = np.max(np.abs(right)) + np.max(np.abs(found))
        assert left <= 1000 * TOLERANCE * size, "the oracle's forces do not balance its bodies"
        for (name, label, (fx, fy, mz)), x in zip(labels, found, strict=True):
            if label == "reaction":
                before = result.reactions.get(name, (0.0, 0.0, 0.0))
                result.reactions[name] = (
                    before[0] + x * fx,
                    before[1] + x * fy,
                    before[2] + x * mz,
                )
            else:
                (result.efforts if label == "effort" else result.multipliers)[name] = x
        acting = _times(unknowns, found)
        for b in self.bodies:
            if b.density is not None:
                result.sections[b.name] = self._section(frames, b, acting + given, spread)
        self._find_open(result, frames, labels, unknowns, null)

    def _pressed(self, solved, labels, place):
        """Unknowns that balance all bodies, by what acts besides them, and what presses on them for
        the multipliers among these.
        """
        pressing = [extra for extra in self.extras if extra.presses]
        found, pressed = solved([]), []
        for _ in range(_ROUNDS if pressing else 0):
            sizes = {name: x for (name, *_), x in zip(labels, found, strict=True)}
            pressed = [p for extra in pressing for p in extra.presses(place, sizes[extra.name])]
            found, last = solved(pressed), found
            near = 100 * TOLERANCE * np.max(np.abs(found))
            if np.max(np.abs(found - last)) <= near:
                return found, pressed
        assert not pressing, "what presses on the oracle's bodies does not converge"
        return found, pressed

    def _least(self, labels, null):
        """What brings any unknowns to those with the least efforts, and what is open then."""
        weights = np.array(
            [
                math.sqrt(self.weights[name]) if label == "effort" else 0.0
                for name, label, _ in labels
            ]
        )
        pushing = null * weights[:, None]
        _, values, basis = np.linalg.svd(pushing)
        values = np.concatenate([values, np.zeros(basis.shape[0] - values.size)])
        kept = values > _LEAST * max(values, default=0.0)
        ways = null @ basis[kept].T
        back = np.linalg.lstsq(ways * weights[:, None], -np.diag(weights), rcond=None)[0]
        return ways @ back, null @ basis[~kept].T

    def _null(self, result, matrix):
        """The null space of the balance: forces and moments that hold each other, whatever is
        given.
        """
        lengths = np.linalg.norm(matrix, axis=0)
        lengths[lengths == 0.0] = 1.0
        _, values, basis = np.linalg.svd(matrix / lengths)
        values = np.concatenate([values, np.zeros(basis.shape[0] - values.size)])
        result.vague |= bool(np.any((values > _VAGUE[0]) & (values < _VAGUE[1])))
        return (basis[values < _LEAST] / lengths).T

    def _find_open(self, result, frames, labels, unknowns, null):
        """What the null space of the balance changes."""
        own: dict[str, np.ndarray] = {}
        for (name, label, parts), row in zip(labels, null, strict=True):
            for member, part in (
                zip(FORCES, parts, strict=True) if label == "reaction" else [("", 1.0)]
            ):
                full = f"{label}:{name}:{member}".rstrip(":")
                own[full] = own.get(full, 0.0) + row * part / (self.size if member == "mz" else 1.0)
        result.open = {name for name, row in own.items() if np.linalg.norm(row) > _OPEN}
        alone = [_times(unknowns, column) for column in null.T]
        for b in self.bodies:
            if b.density is not None:
                result.open_sections[b.name] = self._open_section(
                    [self._section(frames, b, parts, weight=0) for parts in alone]
                )

    def _open_section(self, laws):
        def at(ratio: float) -> tuple[bool, ...]:
            sizes = np.linalg.norm(np.array([law(ratio) for law in laws]).reshape(-1, 3), axis=0)
            return tuple(sizes / [1.0, 1.0, self.size] > _OPEN)

        return at

    def _on_bodies(self, frames, parts):
        """Force and moment about each body's centre, stacked."""
        row = {b.name: 3 * i for i, b in enumerate(self.bodies)}
        stacked = np.zeros(3 * len(self.bodies))
        for (name, px, py), fx, fy, mz in parts:
            if name == "ground":
                continue
            body = next(b for b in self.bodies if b.name == name)
            at, centre = place_in(frames, (name, px, py)), place_in(frames, (name, *body.centre))
            arm = (at[0].v - centre[0].v, at[1].v - centre[1].v)
            stacked[row[name] : row[name] + 3] += [fx, fy, arm[0] * fy - arm[1] * fx + mz]
        return stacked

    def _section(self, frames, body, acting, spread=(), weight=1):
        """Action of the piece towards the tip on the piece towards the base: (axial, shear,
        bending) at a ratio xi/l.

        With no ``weight`` the piece's own matter is left out.
        """

        def at(ratio: float) -> tuple[float, float, float]:
            l = body.length
            near = 100 * TOLERANCE * body.length
            phi, c, s = frames[body.name][2], frames[body.name][3].v, frames[body.name][4].v
            cut = place_in(frames, (body.name, ratio * l, 0.0))
            fx = fy = mz = 0.0  # what acts on the piece towards the tip
            # At the very tip of the link what acts there still acts beyond the section.
            own = [p for p in acting if p[0][0] == body.name]
            seen = [
                p
                for p in own
                if p[0][1] > ratio * l + near or (ratio == 1 and abs(p[0][1] - l) < near)
            ]
            for place, gx, gy, couple in seen + forces(spread, body.name, ratio * l):
                point = place_in(frames, place)
                arm = (point[0].v - cut[0].v, point[1].v - cut[1].v)
                fx, fy, mz = fx + gx, fy + gy, mz + arm[0] * gy - arm[1] * gx + couple
            mass, first, second = _moments(body.density, body.breaks, ratio)
            if mass and weight:
                middle = first / mass
                centre = place_in(frames, (body.name, middle * l, 0.0))
                gx = mass * (self.gravity[0] - centre[0].a)
                gy = mass * (self.gravity[1] - centre[1].a)
                arm = (centre[0].v - cut[0].v, centre[1].v - cut[1].v)
                fx, fy = fx + gx, fy + gy
                mz += arm[0] * gy - arm[1] * gx - (second - first * middle) * l**2 * phi.a
            return fx * c + fy * s, fy * c - fx * s, mz

        return at


def passed(before: Result, after: Result) -> bool:
    """Whether the least singular value of the gaps' slope, with its sign, went through zero from
    one motion to the next.
    """
    if before.softest is None or after.softest is None:
        return False
    (_, left, right), (slope, *_) = before.softest, after.softest
    return bool(left @ slope @ right <= 0.0)


def _times(unknowns, values):
    """What unknowns do at points, for values of them."""
    return [
        (p, x * fx, x * fy, x * mz)
        for parts, x in zip(unknowns, values, strict=True)
        for p, fx, fy, mz in parts
    ]


def place_in(frames, point):
    """The place of a body's point, and the body's direction."""
    name, x, y = point
    bx, by, phi, c, s = frames[name]
    if not (x or y):
        return bx, by, phi
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
