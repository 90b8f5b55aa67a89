"""Axes and places that are off by rounding: the nearest ones with which the loops of an
over-constrained mechanism close.

A loop that closes because axes are parallel, or meet, closes no more where a CAD program has
rounded them: it has more equations than its mobility leaves room for, and these miss by that
rounding. In any posture the misses are seen along the left null space N of the loops' Jacobian,
whose rank is determined within the tolerance: N'(Phi + Phi_x x) = 0 is linear in small corrections
x of axes and places. The least x is taken for which it holds in many postures, and for other
parameters too where it can, by the method of Gauss and Newton.

Joints that must be moved are first tried without what is beside a coordinate axis, or an end of a
link, by rounding: where loops close so, their graphs are as small as those of exact axes. And a
link between two spherical joints is a bar where rounding alone puts these beside its axis.
"""

from __future__ import annotations

import copy
import functools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.rotation import Rotation
from ..base.vectors import Vector, cross, dot, minus, nil, plus, times
from ..model.density import Density
from ..model.joints import Joint
from ..model.measures import Measures
from ..model.mechanism import Mechanism
from ..model.parts import Body, Expression, Friction, Link, Load, Point
from ..model.scene import Scene
from ..model.spatial import reference_posture
from .assembly import assemble
from .multibody import Multibody
from .released_loops import Posture, ReleasedLoops
from .residuals import extent
from .tree import span

_POSTURES = 24
_STRIDE = 0.25
"""Step from one posture to the next: in radians, or relative to the mechanism's extent."""

_OTHER = 0.05
"""Relative change of a parameter, to test whether loops close for others too."""

_ROUNDS = 8
_CLOSING_STEPS = 30
_APART = 100.0
"""Between a rank that is determined and what rounding within the tolerance leaves: so much lies
between singular values.
"""

_SEEN = 1e-4, 1e-10
"""Largest and least relative singular values for corrections of rounding; less may be made of
residuals of loops.
"""

_LEFT = 1e-14
_FAINT = 1e-17


@functools.lru_cache(maxsize=32)
def nearest(scene: Scene) -> Scene | None:
    """The scene with axes and places of joints moved within its ``rounding``, so that loops close;
    None if that is not enough.
    """
    declared = scene.mechanism
    if not declared.space or not scene.rounding:
        return None
    values = declared.values(scene.assembly)
    size = declared.number(extent(declared), values)
    barred = _barred(declared, scene.rounding * size)
    least = _closed(scene, barred, size)
    if least is None:
        return None
    moved = _moves(barred, least, values)
    plain = _with(
        barred, {name: _plain(declared.joints[name], scene.rounding, size) for name in moved}
    )
    for mechanism in (_closed(scene, plain, size) if moved else None, least):
        moves = {} if mechanism is None else _moves(declared, mechanism, values)
        if (
            mechanism is not None
            and moves
            and max(max(a, d / size) for a, d in moves.values()) <= scene.rounding
        ):
            mechanism.rounded = moves | _moved_loads(declared, mechanism, values)
            return replace(scene, mechanism=mechanism)
    return None


def _closed(scene: Scene, mechanism: Mechanism, size: float) -> Mechanism | None:
    """A mechanism with the least corrections with which its loops close; None
    where there are none.
    """
    symbols = ca.SX.sym("correction", 12 * len(mechanism.joints))
    found = _Search.of(scene, _shared(mechanism, symbols, size), symbols).corrections()
    if found is None:
        return None
    found[np.abs(found) < _FAINT] = 0.0
    return _shared(mechanism, found, size)


def _gaps(
    declared: Mechanism, values: Mapping[str, float], pairs: Iterable[tuple[Vector, Vector]]
) -> list[float]:
    """Distances between vectors, for values of the parameters."""
    residuals = [ca.norm_2(ca.vertcat(*minus(one, other))) for one, other in pairs]
    gaps = ca.Function("gaps", [declared.symbols], [ca.vertcat(*residuals)])
    found: list[float] = np.ravel(gaps([*values.values()]).full()).tolist()
    return found


def _moves(
    declared: Mechanism, mechanism: Mechanism, values: Mapping[str, float]
) -> dict[str, tuple[float, float]]:
    """Displacements of axes [rad] and places [m] of joints, on one body or the other, by joint."""
    found = {}
    for name, joint in mechanism.joints.items():
        before = declared.joints[name]
        if joint is not before:
            pairs = zip(_where(joint), _where(before), strict=True)
            *angles, near, far = _gaps(declared, values, pairs)
            found[name] = max(angles), max(near, far)
    return {name: by for name, by in found.items() if any(by)}


def _moved_loads(
    declared: Mechanism, mechanism: Mechanism, values: Mapping[str, float]
) -> dict[str, tuple[float, float]]:
    """Displacements of points of loads, as for joints."""
    found = {}
    for name, load in mechanism.loads.items():
        before = declared.loads[name]
        if load is not before and not isinstance(load, Friction):
            points = zip(load.points, before.points, strict=True)
            pairs = [(one.place, other.place) for one, other in points]
            found[name] = 0.0, max(_gaps(declared, values, pairs))
    return {name: by for name, by in found.items() if any(by)}


def _where(joint: Joint) -> list[Vector]:
    """Directions of a joint on the parent and on the child, and its points."""
    assert joint.turned is not None
    there = Rotation.of(*joint.turned)
    return [*joint.triad, *map(there.resolve, joint.triad), joint.parent.place, joint.child.place]


def _barred(mechanism: Mechanism, limit: float) -> Mechanism:
    """The mechanism whose links between two spherical joints have these, and loads, on their axis
    if within a limit [m].
    """
    links: set[Body] = set()
    for link in mechanism.links.values():
        joints_of_link = [joint for joint in mechanism.joints.values() if link in joint.bodies]
        if isinstance(link.mass, Density) and [joint.kind for joint in joints_of_link] == [
            "spherical",
            "spherical",
        ]:
            links.add(link)

    def put(point: Point) -> Point:
        off = point.body in links and not (nil(point.y) and nil(point.z))
        return (
            replace(point, y=_nothing(point.y, limit), z=_nothing(point.z, limit)) if off else point
        )

    joints = {
        name: replace(joint, parent=put(joint.parent), child=put(joint.child))
        for name, joint in mechanism.joints.items()
        if put(joint.parent) is not joint.parent or put(joint.child) is not joint.child
    }
    found = _with(mechanism, joints)
    if links:
        found = copy.copy(found)
        found.loads = {name: _loaded(load, put) for name, load in found.loads.items()}
    return found


def _loaded(load: Load, put: Callable[[Point], Point]) -> Load:
    moved: dict[str, Any] = {
        one.name: put(getattr(load, one.name)) for one in fields(load) if one.type == "Point"
    }
    return replace(load, **moved) if moved else load


def _plain(joint: Joint, rounding: float, size: float) -> Joint:
    """A joint whose numbers are zero where rounding may have made them what they are, and whose
    points are at ends of links.
    """
    assert joint.directions is not None
    assert joint.turned is not None
    u, v, w = _squared(*joint.directions[:2], rounding)
    x, y, _ = _squared(*joint.turned, rounding)
    points = [_put(point, rounding * size) for point in (joint.parent, joint.child)]
    return replace(joint, parent=points[0], child=points[1], directions=(u, v, w), turned=(x, y))


def _squared(first: Vector, second: Vector, limit: float) -> tuple[Vector, Vector, Vector]:
    """Two directions without components that are below a limit, at right angles,
    and the third one.
    """
    u, v = (
        (_nothing(x, limit), _nothing(y, limit), _nothing(z, limit)) for x, y, z in (first, second)
    )
    u = times(1 / _size(u), u)
    v = minus(v, times(dot(u, v), u))
    v = times(1 / _size(v), v)
    return u, v, cross(u, v)


def _size(vector: Vector) -> Expression:
    squared = dot(vector, vector)
    return math.sqrt(squared) if isinstance(squared, float) else ca.sqrt(squared)


def _put(point: Point, limit: float) -> Point:
    """A point without what is below a limit [m]: of a link whose length is a number, at its end
    where that is so near.
    """
    if point.end is not None or not point.body.oriented:
        return point
    x, y, z = (_nothing(component, limit) for component in point.place)
    length = point.body.length if isinstance(point.body, Link) else None
    if isinstance(x, float) and isinstance(length, float) and abs(x - length) <= limit:
        x = length
    return replace(point, x=x, y=y, z=z)


def _nothing(number: Expression, limit: float) -> Expression:
    return 0.0 if isinstance(number, float) and abs(number) <= limit else number


@dataclass(frozen=True)
class Share:
    """A joint's share of corrections: turns of its axes on the parent and on the child [rad],
    shifts of its points [m].
    """

    turns: tuple[Any, Any]
    shifts: tuple[Any, Any]

    def of(self, joint: Joint) -> Joint:
        """The joint with its share."""
        directions, turned = joint.directions, joint.turned
        assert directions is not None
        assert turned is not None
        on_parent, on_child = self.turns
        u, v, w = (_turned(on_parent, one) for one in directions)
        x, y = (_turned(on_parent, _turned(on_child, one)) for one in turned)
        parent, child = (
            _shifted(point, shift)
            for point, shift in zip((joint.parent, joint.child), self.shifts, strict=True)
        )
        return replace(joint, parent=parent, child=child, directions=(u, v, w), turned=(x, y))


def _turned(turn: Expression, vector: Vector) -> Vector:
    """A vector after a small turn (Cayley): its length is kept to the last digit."""
    half = times(0.5, (turn[0], turn[1], turn[2]))
    across = cross(half, vector)
    return plus(vector, times(2 / (1 + dot(half, half)), plus(across, cross(half, across))))


def _shifted(point: Point, shift: Expression) -> Point:
    if not _free(point):
        return point
    x, y, z = plus(point.place, (shift[0], shift[1], shift[2]))
    return replace(point, x=x, y=y, z=z, end=None)


def _free(point: Point) -> bool:
    """Return whether a point may be moved on its body: not off the axis of a link that has
    sections.
    """
    sections = isinstance(point.body, Link) and isinstance(point.body.mass, Density)
    return point.body.oriented and not (sections and nil(point.y) and nil(point.z))


def _shared(mechanism: Mechanism, corrections: Expression, size: float) -> Mechanism:
    """The mechanism with corrections, joint by joint: twelve each, in radians and of the
    mechanism's size.
    """
    found = {}
    for k, (name, joint) in enumerate(mechanism.joints.items()):
        each = [corrections[12 * k + 3 * i : 12 * k + 3 * i + 3] for i in range(4)]
        if isinstance(corrections, ca.SX) or np.any(each):
            found[name] = Share((each[0], each[1]), (size * each[2], size * each[3])).of(joint)
    return _with(mechanism, found)


def _with(mechanism: Mechanism, corrected: Mapping[str, Joint]) -> Mechanism:
    """The mechanism with corrected joints, and with the same symbols."""
    if not corrected:
        return mechanism
    found = copy.copy(mechanism)
    found.asked = list(
        mechanism.asked
    )  # what corrected parts ask of parameters is not asked of the declared ones
    joints = {
        joint: corrected[name] for name, joint in mechanism.joints.items() if name in corrected
    }
    found.joints = {name: joints.get(joint, joint) for name, joint in mechanism.joints.items()}
    asked = [
        replace(m, of=joints[m.of], axis=m.axis and found.coordinates[m.axis.coordinate][1])
        if m.of in joints
        else m
        for m in mechanism.measures.asked
    ]
    found.measures = Measures(asked, mechanism.measures.components)
    found.loads = dict(mechanism.loads)
    for name, load in mechanism.loads.items():
        if isinstance(load, Friction) and load.joint in joints:
            direction, beside = load.axis, load.beside
            found.loads[name] = replace(
                load,
                joint=joints[load.joint],
                axis=found.coordinates[direction.coordinate][1],
                beside=beside and found.coordinates[beside.coordinate][1],
            )
    return found


@dataclass(frozen=True, eq=False)
class _Search:
    """Looks for corrections of a mechanism whose joints have symbols of them."""

    body: Multibody
    released: ReleasedLoops
    values: Sequence[Any]
    others: Sequence[Sequence[Any]]
    rounding: float

    @classmethod
    def of(cls, scene: Scene, mechanism: Mechanism, symbols: Expression) -> _Search:
        """Make it from a scene; ``mechanism`` is its own with symbols of corrections."""
        body = assemble(mechanism, span(mechanism, scene.laws), scene.laws, ())
        values, t = list(scene.mechanism.values(scene.assembly).values()), scene.span[0]
        driven = [c for c in body.coordinates if c.driven]
        motion = scene.prescribed.only([c.name for c in driven]).motion
        posture = reference_posture(scene.mechanism) | dict(scene.posture)
        rough = {c: posture[c.posture_key] for c in body.coordinates if c.posture_key in posture}
        rough |= dict(zip(driven, ca.DM(motion(t, values)[0]).full().ravel(), strict=True))
        inputs = [mechanism.time, mechanism.symbols, symbols]
        released = ReleasedLoops.of(
            body, rough, inputs, [t, values, np.zeros(symbols.numel())], [symbols]
        )
        generator = np.random.default_rng(0)
        others = []
        for _ in range(2 if values else 0):
            other = np.array(values) * (1 + _OTHER * generator.uniform(-1, 1, len(values)))
            each = zip(mechanism.parameters.values(), other, strict=True)
            others.append([t, [min(max(float(x), p.low), p.high) for p, x in each]])
        return cls(body, released, [t, values], others, scene.rounding)

    def corrections(self) -> Array | None:
        """The least ones with which loops close, for other parameters too if these can; None where
        there are none.
        """
        for others in (self.others, ()) if self.others else ((),):
            found = self._corrections([self.values, *others])
            if found is not None:
                return found
        return None

    def _corrections(self, cases: Sequence[Sequence[npt.ArrayLike]]) -> Array | None:
        x = np.zeros(self.released.residuals.size1_in(4))
        samples = [(case, posture) for case in cases for posture in self._walk(case, x)]
        for _ in range(_ROUNDS):
            parts = [
                part
                for case, posture in samples
                if (part := self._along_null(case, posture, x)) is not None
            ]
            if not parts:
                return None
            misses, slopes = (np.concatenate(each) for each in zip(*parts, strict=True))
            if np.max(np.abs(misses), initial=0.0) < _LEFT:
                return x
            most, least = _SEEN
            seen_from = min(most, max(least, _APART * float(np.max(np.abs(misses)))))
            x = x - np.linalg.lstsq(slopes, misses, rcond=seen_from)[0]
        return None

    def _walk(self, case: Sequence[npt.ArrayLike], x: Array) -> Iterator[Posture]:
        """Postures of the mechanism with all its freedoms, at random."""
        generator, posture = np.random.default_rng(0), self._closed(self.released.first, case, x)
        for _ in range(_POSTURES):
            if posture is None:
                return
            yield posture
            _, slope, _ = self.released.at(posture, [*case, x])
            null_space = np.linalg.svd(slope)[2][self._rank(slope) :]
            step = generator.normal(size=len(null_space)) @ null_space
            step *= _STRIDE / max(float(np.max(np.abs(step), initial=0.0)), 1e-300)
            posture = self._closed(self.released.moved(posture, step), case, x) or self._closed(
                self.released.first, case, x
            )

    def _closed(self, posture: Posture, case: Sequence[npt.ArrayLike], x: Array) -> Posture | None:
        """Posture in which loops close within rounding."""
        for _ in range(_CLOSING_STEPS):
            residual, slope, _ = self.released.at(posture, [*case, x])
            step = -np.linalg.pinv(slope, rcond=self._singular) @ residual
            posture = self.released.moved(posture, step)
            if np.max(np.abs(step), initial=0.0) < 1e-13:
                return (
                    posture
                    if np.max(np.abs(residual), initial=0.0) < _APART * self.rounding
                    else None
                )
        return None

    def _along_null(
        self, case: Sequence[npt.ArrayLike], posture: Posture, x: Array
    ) -> tuple[Array, Array] | None:
        """Residual of loops in a posture that is closed anew, and the derivatives by corrections;
        None if the rank is unclear.
        """
        closed = self._closed(posture, case, x)
        if closed is None:
            return None
        residual, slope, by = self.released.at(closed, [*case, x])
        left_null_space = np.linalg.svd(slope)[0][:, self._rank(slope) :].T
        return left_null_space @ residual, left_null_space @ by

    @property
    def _singular(self) -> float:
        return _APART * self.rounding

    def _rank(self, slope: Array) -> int:
        return int(np.linalg.matrix_rank(slope, tol=self._singular * np.linalg.norm(slope, 2)))
