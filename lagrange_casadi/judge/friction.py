"""Frictions of a solution held to their laws, from its own arrays: what is reported to press, and how fast it slides."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output
from ..declare.description import Description, coordinates_of
from ..instants.solution import Solution
from . import digits
from .placing import Moving, axis_of

_SLOW = 1e-9
"""Of a joint's fastest rate, or of one that its accelerations lead to: below, either sign may be that of its rate."""

Pressing = Callable[[Array], Array]
"""What mu is multiplied by, for signs of the rate."""


def law_gaps(
    solution: Solution, bodies: Mapping[str, Moving] | None = None, spins: Mapping[str, Array] | None = None
) -> tuple[Array, float] | None:
    """How far frictions are from what their laws say (t,), over what they would be under the largest reaction of the cycle.

    ``bodies`` are those of a planar mechanism; ``spins`` in space the angular velocities (t, 3) of the children of spherical joints
    beside their parents, in ground axes. None where there is no friction, or what it takes is not among the outputs. What is
    open at rest is no gap.
    """
    worst, found = np.zeros_like(solution.t), False
    for name, load in solution.description["loads"].items():
        if "friction" not in load:
            continue
        joint, numbers = load["friction"]["coordinate"], load["friction"]["numbers"]
        holder = joint.partition(":")[0]
        outputs = (Output("friction", name, "along"), Output("motion", joint, "rate"))
        value, rate = (solution.outputs.get(output) for output in outputs)
        spin = (spins or {}).get(holder)
        if spin is not None:
            rate = np.linalg.norm(spin, axis=1)
        if value is None or rate is None or Output("reaction", holder, "fx") not in solution.outputs:
            continue
        found = True
        turns = coordinates_of(solution.description)[joint] == "angle"
        pressing = _in_space(solution, holder, numbers, turns) if bodies is None else _in_plane(solution, joint, numbers, bodies)
        lever = numbers.get("radius", 1.0) if turns else 1.0
        speed, share = np.abs(rate) * lever, None
        if (other := _beside(solution, joint)) is not None:
            beside = solution.outputs.get(Output("motion", other, "rate"))
            if beside is None:
                continue
            across = beside * (1.0 if turns else numbers.get("radius", 1.0))
            speed = np.hypot(speed, across)
            share = np.divide(rate * lever, speed, out=np.zeros_like(rate), where=speed > 0.0)
        mu = np.full_like(rate, numbers.get("mu", 0.0))
        if "static" in numbers:
            mu += (numbers["static"] - mu) * np.exp(-((speed / numbers["stribeck"]) ** 2))
        steady = -numbers.get("viscous", 0.0) * rate
        sign = np.tanh(rate / numbers["smooth"]) if "smooth" in numbers else np.sign(rate) if share is None else share
        gap = np.abs(value - steady + mu * sign * pressing(sign))
        if "smooth" not in numbers:
            ends = [np.abs(value - steady + one * mu * pressing(one * np.ones_like(rate))) for one in (1.0, -1.0)]
            # Where it slides and turns, and both turn back at once, some share of it is along this coordinate.
            slow = np.minimum(*ends) if share is None else np.maximum(np.abs(value - steady) - mu * pressing(np.sign(rate)), 0.0)
            moves = speed > _SLOW * max(float(np.max(speed)), lever * _quick(solution, joint, turns))
            gap = np.where(moves, gap if spin is None else np.maximum(gap, _aside(solution, name, value, spin)), slow)
        scale = float(np.max(mu)) * lever * _most(solution, numbers) + float(np.max(np.abs(steady)))
        worst = np.fmax(worst, np.divide(gap, scale, out=gap.copy(), where=scale > 0.0))
    return (worst, 1.0) if found else None


def _aside(solution: Solution, name: str, value: Array, spin: Array) -> Array:
    """How far the couple of a spherical joint's friction is from one of that size about the axis of turning."""
    outputs = [Output("load", name, member) for member in ("mx", "my", "mz")]
    if not all(output in solution.outputs for output in outputs):
        return np.zeros_like(value)
    couple = np.stack([solution.outputs[output] for output in outputs], axis=1)
    size = np.linalg.norm(spin, axis=1)[:, None]
    way = np.divide(spin, size, out=np.zeros_like(spin), where=size > 0.0)
    return np.asarray(np.linalg.norm(couple - value[:, None] * way, axis=1))


def _quick(solution: Solution, joint: str, turns: bool) -> float:
    """A rate that the accelerations of a coordinate lead to: where all instants are ends of strokes, the rates are rounding."""
    change = solution.outputs.get(Output("motion", joint, "acceleration"), np.zeros(1))
    return float(np.sqrt(np.max(np.abs(change)) * (1.0 if turns else digits.size(solution))))


def _beside(solution: Solution, coordinate: str) -> str | None:
    """The other coordinate of a joint that slides and turns; None where there is none."""
    name, _, axis = coordinate.partition(":")
    others = {"slide": "turn", "turn": "slide"}
    return f"{name}:{others[axis]}" if axis in others else None


def _most(solution: Solution, numbers: Mapping[str, float]) -> float:
    """The largest reaction of all joints [N], its moment by its arm."""
    arm = numbers.get("length", np.inf)
    sizes = {"f": 0.0, "m": 0.0}
    for output, values in solution.outputs.items():
        if output.group == "reaction":
            sizes[output.member[0]] = max(sizes[output.member[0]], float(np.fmax.reduce(np.abs(values))))
    return sizes["f"] + 2.0 * sizes["m"] / arm


def _in_plane(solution: Solution, name: str, numbers: Mapping[str, float], bodies: Mapping[str, Moving]) -> Pressing:
    reaction, joint = solution.reaction(name), solution.description["joints"][name]
    force = reaction.fx + 1j * reaction.fy
    if joint["coordinate"] == "angle":
        return lambda _: numbers.get("radius", 0.0) * np.abs(force)
    normal = (np.conj(1j * axis_of(joint, bodies[joint["parent"]["body"]])) * force).real
    if "length" not in numbers or reaction.mz is None:
        return lambda _: np.abs(normal)
    tilt = reaction.mz / numbers["length"]
    return lambda _: np.abs(normal / 2 + tilt) + np.abs(normal / 2 - tilt)


def _in_space(solution: Solution, name: str, numbers: Mapping[str, float], turns: bool) -> Pressing:
    joint: Description = solution.description["joints"][name]
    nothing = np.zeros_like(solution.t)
    members = ("fu", "fv", "fw", "mu", "mv", "mw")
    u, v, w, mu, mv, mw = (solution.outputs.get(Output("reaction", name, member), nothing) for member in members)
    radius = numbers.get("radius", 0.0)
    if joint["kind"] == "screw" and "mu" in numbers:
        # By the angles of the thread and of friction: the couple of a force is radius tan(angle + phi) of it, and that without
        # friction radius tan(angle).
        angle, phi = np.arctan(joint["pitch"] / radius), np.arctan(numbers["mu"])

        def pressing(sign: Array) -> Array:
            way = np.sign(sign) * np.sign(u)
            whole = radius * np.abs(u) * (np.tan(way * angle + phi) - np.tan(way * angle))
            half = radius * np.abs(u) * (np.tan(phi - way * angle) + np.tan(way * angle))
            return np.asarray(((1 + np.abs(sign)) * whole + (1 - np.abs(sign)) * half) / (2.0 * numbers["mu"] or 1.0))

        return pressing
    if joint["kind"] == "spherical":
        force = radius * np.sqrt(sum((solution.outputs[Output("reaction", name, f"f{x}")] ** 2 for x in "xyz"), nothing))
        return lambda _: force
    arm = numbers.get("length", np.inf)
    sides = (np.hypot(v / 2 + k * mw / arm, w / 2 - k * mv / arm) for k in (1, -1))
    size = sum(sides, nothing)
    if joint["kind"] == "revolute":
        size = size + np.abs(u)
    elif joint["kind"] == "prismatic" and radius:
        size = size + np.abs(mu) / radius
    size = size * (radius if turns else 1.0)
    return lambda _: size
