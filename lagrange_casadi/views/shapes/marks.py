"""Marks of what is declared of a mechanism beside its bodies and joints, at one instant: what is
driven, loads with their expressions, names of bodies, the ground's axes, and gaps of loops.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Collection, Iterable, Iterator, Sequence

import casadi as ca
import numpy as np

from ...base.arrays import Array, Expression
from ...base.templates import Template
from ...engine.gaps import Gap
from ...model.description import Place
from ...model.loads import Force, Friction, LineLoad, Spring, Torque
from ...model.mechanism import Mechanism
from ...model.stated import Entry, LoadLaw
from .curves import around
from .orthographic import View
from .poses import Poses, frame_along
from .readable import scale_for
from .shapes import shapes
from .symbols import AXES, PINS, Arrow, Line, Name, Primitive

DRIVEN, LOAD, GAP, GROUND_AXES = "#6d3fc0", "#c0168f", "#d00000", "#777777"

_PUSH, _TURN, _COMB, _DRIVE, _TRIAD, _HEAD = 0.16, 0.075, 0.09, 0.055, 0.1, 0.028
"""Over the mechanism's size: the length of a force, the radius of a torque, the height of a load
along a link, the radius of a drive's arc, the length of an axis of the ground, an arrow's head.
"""

_ARC = np.exp(1j * np.pi * np.linspace(0.1, 0.6, 31))
"""The arc of a drive, of radius 1; that of a torque is three times as long."""

_TEETH, _LONGEST = 9, 32
"""Arrows of a load along a link, and letters of an expression that is written out."""


def driven_marks(poses: Poses, driven: Collection[str], size: float) -> Iterator[Primitive]:
    """Arrows at what moves as given: arcs about axes, arrows along slides, and at points of paths
    and of bodies.
    """
    for joint in poses.description.joints.values():
        for axis in joint.axes:
            if axis.coordinate in driven:
                way = poses.direction(joint.parent.body, axis.direction)
                yield _drive(poses.place(joint.child), way, axis.kind == "angle", size)
    for name, kind in poses.description.driven.items():
        guided, _, which = name.rpartition(".")
        if guided and name not in poses.description.coordinates:
            spot = poses.description.paths.get(guided, Place(guided, (0.0, 0.0, 0.0)))
            way = np.eye(3)[["x", "y", "angle"].index(which)]
            yield _drive(poses.place(spot), way[None], kind == "angle", size)


def load_marks(
    mechanism: Mechanism, poses: Poses, t: float, p: Sequence[float], size: float
) -> Iterator[Primitive]:
    """Arrows of loads, in the direction that they have at an instant and at rest, with their
    expressions; of a load that is zero then, in its positive direction.
    """
    for name, load in mechanism.loads.items():
        if isinstance(load, Friction):
            continue
        ends = [poses.place(point) for point in poses.description.loads[name].points]
        if isinstance(load, Spring):
            parts = ((load.stiffness, "N/m"), (load.damping, "N s/m"))
            there = [f"{_text(x)} {unit}" for x, unit in parts if not ca.SX(x).is_zero()]
            words = ", ".join(there) if load.closed is None else "gas spring"
            yield Name(np.mean(ends, axis=0)[:, None], f"{name}: {words}", colour=LOAD)
            continue
        law = Template.of(LoadLaw.of(mechanism, load), mechanism.symbols).at(p)
        places = [_measured(entry, poses) for entry in law.entries]
        numbers = law.values(places, [0.0] * len(places), t, list(law.p)).full().ravel()
        if isinstance(load, LineLoad):
            yield from _comb(load, poses, numbers, size)
            continue
        vector = _signed(load.components, numbers)
        if load.turning:
            vector = vector @ poses.axes[load.point.body.name][0]
        way = vector / (np.linalg.norm(vector) or 1.0)
        words = _components(load.components, "N" if isinstance(load, Force) else "N m")
        if isinstance(load, Torque) and load.coiled:
            tail = ends[0]
        elif isinstance(load, Torque):
            ring = around(ends[0], way[None], _TURN * size * _ARC**3)
            yield Arrow(ring, LOAD, _HEAD * size)
            tail = ring[:, 15]
        else:
            tail = ends[0] - _PUSH * size * way
            yield Arrow(np.stack([tail, ends[0]], axis=1), LOAD, _HEAD * size)
        yield Name(tail[:, None], f"{name}: {words}", colour=LOAD)


def body_names(poses: Poses) -> Iterator[Name]:
    """The names of bodies beside their middles, in their colours."""
    for shape in shapes(poses.description):
        middle = Place(shape.name, shape.centre or ((shape.length or 0.0) / 2, 0.0, 0.0))
        yield Name(poses.place(middle)[:, None], shape.name, colour=poses.colours[shape.name])


def ground_axes(view: View, points: Array, size: float) -> Iterator[Primitive]:
    """The directions of the ground's axes, below and to the left of ``points`` (n, 2) on a page."""
    low = points.min(axis=0) - _TRIAD * size * np.array([1.2, 0.3])
    start = low[0] * view.right + low[1] * view.up
    for name, way in zip("xyz", _TRIAD * size * np.eye(3), strict=True):
        yield Arrow(np.array([[start, start + way]]), GROUND_AXES, _HEAD * size)
        yield Name((start + 1.05 * way)[None, None], name, colour=GROUND_AXES)


def gap_marks(gaps: Iterable[Gap]) -> Iterator[Primitive]:
    """Gaps between their ends, each with its size."""
    for gap in (one for one in gaps if one.unit):
        yield Line(gap.ends[None], GAP, 2.4, dashed=True, level=PINS)
        wide = scale_for("m", gap.size).said(gap.size, 3)
        words = wide if gap.unit == "m" else f"{np.degrees(gap.size):.3g}°"
        yield Name(np.mean(gap.ends, axis=0)[None, None], words, colour=GAP)


def _drive(middle: Array, way: Array, turns: bool, size: float) -> Arrow:
    if turns:
        points = around(middle, way, _DRIVE * size * _ARC)
    else:
        aside = middle + 0.5 * _DRIVE * size * frame_along(way)[:, 1]
        half = _DRIVE * size * way
        points = np.stack([aside - half, aside + half], axis=1)
    return Arrow(points, DRIVEN, 0.7 * _HEAD * size, level=AXES)


def _comb(load: LineLoad, poses: Poses, numbers: Array, size: float) -> Iterator[Primitive]:
    """A load along a link: arrows that end on its axis, and the line of their tails."""
    link, powers = load.link.name, numbers[1:].reshape(-1, 3)
    (middle, *_), reach = poses.description.loads[load.name].points[0].at, float(numbers[0])
    components = list(zip(load.x, load.y, load.z, strict=True))
    if not np.isfinite(powers).all() or not powers.any():
        powers = np.array([_signed(power, np.zeros(3)) for power in components])
    share = np.linspace(0.0, 1.0, _TEETH)
    acts = (1.0 - share[:, None]) ** np.arange(len(powers)) @ powers
    if load.turning:
        acts = acts @ poses.axes[link][0]
    largest = float(np.linalg.norm(acts, axis=1).max()) or 1.0
    heads = poses.along(link, [(middle + (x - 0.5) * reach, 0.0, 0.0) for x in share.tolist()])
    tails = heads - _COMB * size / largest * acts
    for tail, head in zip(tails[0], heads[0], strict=True):
        yield Arrow(np.stack([tail, head])[None], LOAD, 0.6 * _HEAD * size, width=1.4)
    yield Line(tails, LOAD, 1.4, level=AXES)
    expressions = [x for power in components for x in power if not ca.SX(x).is_zero()]
    if all(ca.SX(x).is_constant() for x in expressions):
        words = " to ".join(dict.fromkeys(f"{np.linalg.norm(acts[k]):.4g}" for k in (0, -1)))
    else:
        words = _text(ca.vertcat(*expressions))
    yield Name(tails[:, _TEETH // 2, None], f"{load.name}: {words} N/m", colour=LOAD)


def _measured(entry: Entry, poses: Poses) -> float:
    """Value that a load sees: the component of a place, the direction of a link, or the coordinate
    of a joint of one coordinate.
    """
    if entry.kind == "direction":
        x, y, _ = poses.axes[entry.part][0, 0]
        return math.atan2(y, x)
    if entry.kind != "coordinate":
        return float(poses.place(Place(entry.part, entry.point))[0]["xyz".index(entry.kind)])
    joints = poses.description.joints.values()
    joint, axis = {one.coordinate: (j, one) for j in joints for one in j.axes}[entry.part]
    if axis.kind == "slide":
        way = poses.place(joint.child) - poses.place(joint.parent)
        return float(np.sum(way * poses.direction(joint.parent.body, axis.direction)))
    _, first, second = frame_along(np.array(axis.direction))
    seen = np.array(joint.turned) @ first @ poses.axes[joint.child.body][0]
    cosine, sine = np.array([first, second]) @ poses.axes[joint.parent.body][0] @ seen
    return math.atan2(sine, cosine)


def _signed(components: Iterable[Expression], numbers: Array) -> Array:
    """A vector, or of one that is zero or unknown the positive direction of its components."""
    if np.isfinite(numbers).all() and numbers.any():
        return numbers
    return np.array([0.0 if ca.SX(x).is_zero() else 1.0 for x in components])


def _components(components: Sequence[Expression], unit: str) -> str:
    """The components of a load in words, one after the other or as a function of their symbols."""
    parts = {k: x for k, x in zip("xyz", components, strict=True) if not ca.SX(x).is_zero()}
    words = ", ".join(f"{name} = {_text(x)}" for name, x in parts.items())
    if len(words) > _LONGEST:
        words = _text(ca.vertcat(*parts.values()))
    return f"{words or '0'} {unit}"


def _text(expression: Expression) -> str:
    """An expression as it was declared; a long one, or several, as a function of its symbols."""
    x = ca.SX(expression)
    if x.is_scalar() and x.is_constant():
        return f"{float(x):.4g}"
    text = str(x)
    if x.is_scalar() and "@" not in text and len(text) <= _LONGEST:
        return text[1:-1] if text.startswith("(") and text.endswith(")") else text
    names = list(dict.fromkeys(symbol.name() for symbol in ca.symvar(x)))
    return f"f({textwrap.shorten(', '.join(names), _LONGEST, placeholder=' ...')})"
