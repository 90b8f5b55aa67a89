"""A scene in lines: what moves it, what acts on it, and how it is assembled."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np

from ..base.arrays import Expression
from ..base.lookups import PREFIX
from ..base.vectors import nil
from ..errors import listed
from ..model.constraints import Constraint
from ..model.loads import Force, Friction, LineLoad, Load, Torque
from ..model.motion_inverse import MotionInverse
from ..model.motion_laws import Motion
from ..model.scene import Scene
from .kinematics import describe_coordinate

_LONG, _SAMPLES, _JUMPS = 200, 1001, 250


def scene_lines(scene: Scene) -> Iterator[str]:
    """Freedoms, drives with their laws, loads, constraints, the posture,
    each with its expressions.
    """
    mechanism = scene.mechanism
    drives = scene.laws if scene.weights is None else scene.weights
    yield f"degrees of freedom: {len(scene.laws)}, driven at {', '.join(drives) or 'nothing'}"
    symbol, word = ca.SX.sym("t"), "drive" if scene.weights is None else "motion"
    for joint, law in scene.laws.items():
        yield f"  {word} {joint}: {_law(law, symbol)}; {_course(scene, joint)}"
        yield from _moves(scene, joint) if law.stretches else ()
    yield from (
        f"load {name}: {_load(load, space=mechanism.space)}"
        for name, load in mechanism.loads.items()
    )
    yield from (
        f"constraint {name}: 0 = {_constraint(constraint)}"
        for name, constraint in mechanism.constraints.items()
    )
    for name, row in mechanism.rows.items():
        yield (
            f"non-holonomic constraint {name}: 0 = {_short(row.expression)}; it moves joint"
            f" {row.replaces}, without an effort"
        )
    yield from (
        f"output {name} [{output.unit}]: {_short(output.expression)}"
        for name, output in mechanism.outputs.items()
    )
    slides = [name for name, (_, axis) in mechanism.coordinates.items() if axis.kind == "slide"]
    postures = [
        describe_coordinate(name, "slide" if name in slides else "angle", rough)
        for name, rough in scene.posture.items()
    ]
    if any(name not in scene.posture for name in mechanism.rough):
        postures.append(
            f"{'else ' if postures else ''}the reference posture, in which the parts are declared"
        )
    yield f"posture: {', '.join(postures) or 'none'}"
    if scene.elastic:
        yield (
            "elastic:"
            f" {'links that have a beam' if scene.elastic is True else ', '.join(scene.elastic)}"
        )
    if scene.assembly:
        yield (
            "assembled first with:"
            f" {', '.join(f'{name} = {value:g}' for name, value in scene.assembly.items())}"
        )


def _constraint(constraint: Constraint) -> str:
    text = _short(constraint.phi)
    if constraint.transmission is None:
        return text
    pairs = ", ".join(
        f"{mesh.first.body.name} and {mesh.second.body.name}"
        for mesh in constraint.transmission.meshes
    )
    return f"{text}; it acts at the contacts: {pairs}"


def _law(law: Motion, symbol: ca.SX) -> str:
    if law.knots:
        return (
            f"a spline through {len(law.knots)} samples from {law.span[0]:g} to {law.span[1]:g} s"
        )
    if law.description:
        return law.description
    if law.stretches:
        return (
            f"{len(law.stretches)} moves and dwells{', repeated' if law.period is not None else ''}"
        )
    return f"{_short(law.graph(symbol))} of the time t"


def _moves(scene: Scene, joint: str) -> Iterator[str]:
    """Describe each move and dwell of a drive with the default parameters, and the jumps of
    accelerations and jerks.
    """
    table = scene.timetable(joint, scene.assembly)
    unit = "m" if scene.guided.coordinates[joint][1].kind == "slide" else "rad"
    for stretch in table.stretches:
        when = f"    {stretch.name}: from {stretch.start:.6g} to {stretch.stop:.6g} s"
        if not stretch.by:
            yield f"{when}, rests at {stretch.at:.6g} {unit}"
            continue
        jerk = "" if math.isinf(stretch.jerk) else f", {stretch.jerk:.6g} {unit}/s^3"
        yield (
            f"{when}, from {stretch.at:.6g} by {stretch.by:.6g} {unit} ({stretch.law}), at most"
            f" {stretch.speed:.6g} {unit}/s, {stretch.acceleration:.6g} {unit}/s^2{jerk}"
        )
    for what in ("acceleration", "jerk"):
        places = [f"{jump.t:.6g} s {jump.where}" for jump in table.jumps if jump.what == what]
        if places:
            yield f"    the {what} jumps at {listed(places, room=_JUMPS)}"


def _course(scene: Scene, joint: str) -> str:
    """Start, end and limits of a drive with the default parameters."""
    values = [*scene.mechanism.values(scene.assembly).values()]
    law, t = MotionInverse.of(scene.prescribed, joint), np.linspace(*scene.span, _SAMPLES)
    direction = law.at(t[None], np.array([values], float))[0, 0]
    kind = scene.guided.coordinates[joint][1].kind
    words = (
        f"from {describe_coordinate(joint, kind, direction[0])} to"
        f" {describe_coordinate(joint, kind, direction[-1])}"
    )
    inside = min(direction[0], direction[-1]) <= direction.min() and direction.max() <= max(
        direction[0], direction[-1]
    )
    ends = (
        describe_coordinate(joint, kind, x).partition(" = ")[2]
        for x in (direction.min(), direction.max())
    )
    return words.replace(f"{joint} = ", "") + ("" if inside else f", within {' and '.join(ends)}")


def _load(load: Load, *, space: bool) -> str:
    first = load.points[0].body.name
    if isinstance(load, Force):
        return f"force on {first}, {_components(load, 'N', space)}"
    if isinstance(load, LineLoad):
        axes = f"in the axes of {first}" if load.turning else "in ground axes"
        parts = [f"{x} = {_along(getattr(load, x))}" for x in ("xyz" if space else "xy")]
        part = (
            ""
            if load.whole
            else f" between {_short(load.between[0])} and {_short(load.between[1])} m"
        )
        return f"line load on {first}{part}, {', '.join(parts)}, {axes}"
    second = load.points[1].body.name
    if isinstance(load, Friction):
        words = ", ".join(f"{word} {_short(number)}" for word, number in load.numbers.items())
        return f"friction in joint {load.joint.name}, on {first} against {second}, {words}"
    if isinstance(load, Torque):
        if space:
            return f"torque on {first} against {second}, {_components(load, 'N m', space)}"
        return f"torque on {first} against {second}, {_short(load.components[2])} N m"
    words = (
        f"stiffness {_short(load.stiffness)} N/m, free length {_short(load.length)} m, damping"
        f" {_short(load.damping)} N s/m"
    )
    return f"spring between {first} and {second}, {words}"


def _along(powers: Sequence[Expression]) -> str:
    """A load along a link: what it is where it begins and where it ends, and its degree where it is
    not straight between.
    """
    first, last = sum(powers[1:], powers[0]), powers[0]
    words = " to ".join(dict.fromkeys((_short(first), _short(last))))
    degree = max((j for j, power in enumerate(powers) if not nil(power)), default=0)
    return f"{words} N/m" if degree < 2 else f"{words} N/m by a polynomial of degree {degree}"


def _components(load: Force | Torque, unit: str, space: bool) -> str:
    """The components of a load, and in which axes they are."""
    parts = [
        f"{x} = {_short(value)} {unit}"
        for x, value in zip("xyz" if space else "xy", load.components, strict=False)
    ]
    return (
        f"{', '.join(parts)}, in"
        f" {f'the axes of {load.point.body.name}' if load.turning else 'ground axes'}"
    )


def _short(expression: Expression) -> str:
    """An expression in words, cut where it is long."""
    if not isinstance(expression, ca.SX):
        return f"{expression:g}"
    text = " ".join(str(expression).split())
    if PREFIX in text:
        return f"a curve of {', '.join(map(str, ca.symvar(expression)))}"
    return text if len(text) <= _LONG else f"{text[:_LONG]}..."
