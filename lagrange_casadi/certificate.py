"""Independent checks of a solution, from its own arrays: none shares the graphs that made them.

The reported motions of the joints place every body anew, in plain arithmetic; the reported reactions, efforts and loads must then
balance every body (Newton-Euler), the power of drives and loads must be the change of kinetic energy, loops must close, and the
sections at a link's base must give back what its joints do there. Each residual is relative, (t,).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from .compensated import ROUNDING
from .density import Array
from .description import Description, density_of
from .solution import Solution

Complex = npt.NDArray[np.complexfloating[Any, Any]]

NEAR = 1e3
_EDGE = 1e-9
_BLOCK = 1 << 14
_Matter = tuple[float, complex, float]
_Action = tuple[str, Complex, Any, Any, bool]

_TURNED = 100.0
TOLERANCE, LOOSE = 1e-9, 1e-3
"""A residual above it means that the solution is wrong, not that it is rounded; in doubles, and where less was asked for."""


@dataclass(frozen=True, eq=False)
class _Motion:
    """Place of a body's origin, direction, and both their derivatives: arrays of (t,), complex numbers for vectors."""

    at: Complex
    speed: Complex
    change: Complex
    angle: Array
    rate: Array
    acceleration: Array

    @classmethod
    def holding(
        cls, at: tuple[Complex, Complex, Complex], point: Description, angle: Array, rate: Array, acceleration: Array
    ) -> _Motion:
        """The motion of a body that turns as said and whose ``point`` has the given place, velocity and acceleration."""
        turning = np.exp(1j * angle) * (point["x"] + 1j * point["y"])
        change = at[2] - (1j * acceleration - rate**2) * turning
        return cls(at[0] - turning, at[1] - 1j * rate * turning, change, angle, rate, acceleration)

    def point(self, x: Any, y: Any) -> tuple[Complex, Complex, Complex]:
        """Place, velocity and acceleration of the body's point (x, y)."""
        arm = (x + 1j * y) * np.exp(1j * self.angle)
        return (
            self.at + arm,
            self.speed + 1j * self.rate * arm,
            self.change + (1j * self.acceleration - self.rate**2) * arm,
        )


@dataclass(eq=False)
class _Tally:
    """Forces on the bodies: what they sum to, about each centre, and how large they are."""

    force: dict[str, Complex] = field(default_factory=dict)
    moment: dict[str, Array] = field(default_factory=dict)
    size: Array | float = 0.0
    power: Array | float = 0.0


@dataclass(frozen=True, eq=False)
class Held:
    """What the multiplier of a constraint or row does at a point (x, y) of a body, in its axes: arrays of (t,)."""

    body: str
    x: Array
    y: Array
    fx: Array
    fy: Array
    mz: Array

    def during(self, instants: slice) -> Held:
        """The same at some of the instants."""
        return Held(self.body, *(values[instants] for values in (self.x, self.y, self.fx, self.fy, self.mz)))


def certify(solution: Solution, held: Sequence[Held] | None = None) -> dict[str, Array]:
    """The residuals that the solution's outputs allow: ``balance``, ``power``, ``closure``, ``ends``, each where it can be had.

    Multipliers act by their equations, which a solution does not hold; so with constraints or rows all but ``closure`` needs to be
    told what they do.
    """
    found: dict[str, list[Array]] = {}
    scales: dict[str, float] = {}
    for start in range(0, solution.t.size, _BLOCK):
        block = slice(start, start + _BLOCK)
        there = None if held is None else [part.during(block) for part in held]
        for name, (gaps, scale) in _residuals(solution.during(block), there).items():
            found.setdefault(name, []).append(gaps)
            scales[name] = max(scales.get(name, 0.0), scale)
    return {name: np.concatenate(gaps) / (scales[name] or 1.0) for name, gaps in found.items()}


def _residuals(solution: Solution, held: Sequence[Held] | None) -> dict[str, tuple[Array, float]]:
    """Each residual, and the largest of what it is to be compared with."""
    description = solution.description
    joints = description["joints"]
    if any(joint["coordinate"] and f"motion:{name}" not in solution.series for name, joint in joints.items()):
        return {}
    bodies = _place(solution)
    if len(bodies) < len(description["bodies"]) + 1:
        return {}
    found = {"closure": (_closure(solution, bodies), _size(solution))}
    wanted = [f"reaction:{name}:fx" for name in joints] + [f"load:{name}:fx" for name in description["loads"]]
    wanted += [f"effort:{name}" for name, joint in joints.items() if joint["driven"] and name not in description["rows"].values()]
    told = held is not None or not (description["constraints"] or description["rows"])
    if told and not solution.undetermined and all(name in solution.series for name in wanted):
        matter = {name: _matter(body) for name, body in description["bodies"].items()}
        acting = [*_acting(solution, bodies), *(_push(part, bodies) for part in held or ())]
        tally = _tally(solution, bodies, acting, matter)
        found["balance"], found["power"] = _balance(solution, bodies, tally, matter)
        if solution.links_with_sections:
            found["ends"] = _ends(solution, bodies, acting)
    return found


def tolerance(solution: Solution) -> float:
    """What residuals are held to."""
    exact = solution.provenance.precision == "double" and not any(
        word in solution.provenance.rung for word in ("--newton", "--table")
    )
    return max(TOLERANCE if exact else LOOSE, _TURNED * blur(solution))


def blur(solution: Solution) -> float:
    """What the reported angles leave open of a phase: one rounding of the largest of them [rad]."""
    joints = solution.description["joints"]
    angles = [f"motion:{name}" for name, joint in joints.items() if joint["coordinate"] == "angle"]
    angles += [f"pose:{name}:angle" for name in solution.description["bodies"]]
    reported = (solution.series[name] for name in angles if name in solution.series)
    rounding = ROUNDING["single" if solution.provenance.precision == "single" else "double"]
    return rounding * max((float(np.max(np.abs(values))) for values in reported), default=0.0)


def summary(residuals: Mapping[str, Array]) -> str:
    """The largest residuals, in one line; and how singular the loops are, where it matters."""
    parts = [f"{name} {np.max(values):.1e}" for name, values in residuals.items() if name != "condition"]
    said = "certificate: " + (", ".join(parts) if parts else "nothing to check, for want of outputs")
    worst = float(np.max(residuals.get("condition", np.ones(1))))
    return said + (f"; near a dead centre, where the loops magnify by {worst:.3g}" if worst > NEAR else "")


def _place(solution: Solution) -> dict[str, _Motion]:
    zero = np.zeros_like(solution.t)
    bodies = {"ground": _Motion(zero + 0j, zero + 0j, zero + 0j, zero, zero, zero)}
    waiting = dict(solution.description["joints"])
    moved = True
    while waiting and moved:
        moved = False
        for name, joint in list(waiting.items()):
            near, far = joint["parent"], joint["child"]
            reverse = near["body"] not in bodies
            if reverse:
                near, far = far, near
            if near["body"] not in bodies or far["body"] in bodies:
                continue
            motion = _hang(solution, name, joint, bodies[near["body"]], near, far, reverse)
            if motion is not None:
                bodies[far["body"]] = motion
                del waiting[name]
                moved = True
        if not moved:
            moved = _span(solution, bodies)
    return bodies


def _span(solution: Solution, bodies: dict[str, _Motion]) -> bool:
    """Place a link that is pinned at two points to bodies already placed, from where these move; whether there was one."""
    pins: dict[str, list[tuple[Description, Description]]] = {}
    for joint in solution.description["joints"].values():
        for own, other in ((joint["parent"], joint["child"]), (joint["child"], joint["parent"])):
            if joint["kind"] == "revolute" and own["body"] not in bodies and other["body"] in bodies:
                pins.setdefault(own["body"], []).append((own, other))
    for name, found in pins.items():
        first = found[0]
        second = next((pin for pin in found if (pin[0]["x"], pin[0]["y"]) != (first[0]["x"], first[0]["y"])), None)
        if second is None or not _oriented(solution.description, name):
            continue
        (a, va, ca), (b, vb, cb) = (bodies[other["body"]].point(other["x"], other["y"]) for _, other in (first, second))
        reach = np.abs(b - a) ** 2
        rate, acceleration = (np.conj(b - a) * (vb - va)).imag / reach, (np.conj(b - a) * (cb - ca)).imag / reach
        local = (second[0]["x"] - first[0]["x"]) + 1j * (second[0]["y"] - first[0]["y"])
        angle = np.angle((b - a) / local)
        bodies[name] = _Motion.holding((a, va, ca), first[0], angle, rate, acceleration)
        return True
    return False


def _oriented(description: Description, body: str) -> bool:
    return body == "ground" or description["bodies"][body]["length"] is not None


def _hang(
    solution: Solution, name: str, joint: Description, base: _Motion, near: Description, far: Description, reverse: bool
) -> _Motion | None:
    """The motion of the body at a joint's far side, or None where the joint does not give it."""
    oriented = _oriented(solution.description, far["body"])
    kind, sign = joint["kind"], -1.0 if reverse else 1.0
    zero = np.zeros_like(solution.t)
    slides = kind in ("prismatic", "slot")
    if slides and oriented and kind == "slot":
        return None
    if slides and reverse and not _oriented(solution.description, joint["child"]["body"]):
        return None
    motion = solution.motion(name) if joint["coordinate"] else None
    if oriented and kind == "revolute":
        if motion is None:
            return None
        angle = base.angle + sign * motion.value
        rate, acceleration = base.rate + sign * motion.rate, base.acceleration + sign * motion.acceleration
    elif oriented:
        angle, rate, acceleration = base.angle + sign * joint["angle"], base.rate, base.acceleration
    else:
        angle, rate, acceleration = zero, zero, zero
    at, speed, change = base.point(near["x"], near["y"])
    if slides:
        assert motion is not None
        axis = (joint["axis"][0] + 1j * joint["axis"][1]) * np.exp(1j * (angle if reverse else base.angle))
        turn, spin = (rate, acceleration) if reverse else (base.rate, base.acceleration)
        at = at + sign * axis * motion.value
        speed = speed + sign * axis * (motion.rate + 1j * turn * motion.value)
        along = motion.acceleration - turn**2 * motion.value + 1j * (spin * motion.value + 2 * turn * motion.rate)
        change = change + sign * axis * along
    return _Motion.holding((at, speed, change), far, angle, rate, acceleration)


def _matter(body: Description) -> _Matter:
    """Mass, centre in the body's axes, and inertia about the centre."""
    mass, length = body["mass"], body["length"]
    if length is None or mass == 0.0:
        return mass, 0j, 0.0
    if "centre" in body:
        return mass, body["centre"]["x"] + 1j * body["centre"]["y"], body["centre"]["inertia"]
    _, first, second = (float(tail[0]) for tail in density_of(body).tails(np.zeros(1)))
    return mass, first / mass * length + 0j, (second - first**2 / mass) * length**2


def _size(solution: Solution) -> float:
    return sum(body["length"] or 0.0 for body in solution.description["bodies"].values()) or 1.0


def _closure(solution: Solution, bodies: dict[str, _Motion]) -> Array:
    """Gaps of all joints, and of the reported poses."""
    worst = np.zeros_like(solution.t)
    for joint in solution.description["joints"].values():
        (a, *_), (b, *_) = (bodies[p["body"]].point(p["x"], p["y"]) for p in (joint["parent"], joint["child"]))
        gap = b - a
        if joint["kind"] in ("prismatic", "slot"):
            axis = (joint["axis"][0] + 1j * joint["axis"][1]) * np.exp(1j * bodies[joint["parent"]["body"]].angle)
            gap = (gap * np.conj(axis)).imag
        worst = np.maximum(worst, np.abs(gap))
    for name in solution.description["bodies"]:
        pose = solution.pose(name)
        worst = np.maximum(worst, np.abs(pose.x + 1j * pose.y - bodies[name].at))
    return worst


def _acting(solution: Solution, bodies: dict[str, _Motion]) -> Iterator[_Action]:
    """Every force: the body, the place, the force and couple, and whether it does work."""
    for name, joint in solution.description["joints"].items():
        at = bodies[joint["child"]["body"]].point(joint["child"]["x"], joint["child"]["y"])[0]
        reaction = solution.reaction(name)
        force, couple = reaction.fx + 1j * reaction.fy, 0.0 if reaction.mz is None else reaction.mz
        pushes: list[tuple[Any, Any, bool]] = [(force, couple, False)]
        if f"effort:{name}" in solution.series:
            effort = solution.effort(name)
            axis = (joint["axis"][0] + 1j * joint["axis"][1]) * np.exp(1j * bodies[joint["parent"]["body"]].angle)
            pushes.append((0j, effort, True) if joint["coordinate"] == "angle" else (effort * axis, 0.0, True))
        for push, twist, works in pushes:
            yield joint["child"]["body"], at, push, twist, works
            yield joint["parent"]["body"], at, -push, -twist, works
    for name, load in solution.description["loads"].items():
        fx, fy, mz = (solution.series[f"load:{name}:{k}"] for k in ("fx", "fy", "mz"))
        for point, sign in zip(load["points"], (1.0, -1.0), strict=False):
            at = bodies[point["body"]].point(point["x"], point["y"])[0]
            yield point["body"], at, sign * (fx + 1j * fy), sign * mz, True


def _push(part: Held, bodies: dict[str, _Motion]) -> _Action:
    return part.body, bodies[part.body].point(part.x, part.y)[0], part.fx + 1j * part.fy, part.mz, True


def _tally(solution: Solution, bodies: dict[str, _Motion], acting: Sequence[_Action], matter: Mapping[str, _Matter]) -> _Tally:
    tally = _Tally()
    for body, at, force, couple, works in acting:
        if body == "ground":
            continue
        motion = bodies[body]
        _, centre, _ = matter[body]
        middle = motion.point(centre.real, centre.imag)[0]
        moment = (np.conj(at - middle) * force).imag + couple
        tally.force[body] = tally.force.get(body, 0j) + force
        tally.moment[body] = tally.moment.get(body, 0.0) + moment
        tally.size = np.maximum(tally.size, np.abs(force) + np.abs(couple) / _size(solution))
        if works:
            local = (at - motion.at) * np.exp(-1j * motion.angle)
            tally.power = tally.power + (np.conj(motion.point(local.real, local.imag)[1]) * force).real + couple * motion.rate
    return tally


def _balance(
    solution: Solution, bodies: dict[str, _Motion], tally: _Tally, matter: Mapping[str, _Matter]
) -> tuple[tuple[Array, float], tuple[Array, float]]:
    """Newton-Euler for every body, beside the largest force; and power, beside the largest of force times speed."""
    gravity = complex(*solution.description["gravity"])
    worst, power = np.zeros_like(solution.t), np.zeros_like(solution.t)
    largest = np.zeros_like(solution.t)
    for name, body in solution.description["bodies"].items():
        mass, centre, inertia = matter[name]
        motion = bodies[name]
        _, speed, change = motion.point(centre.real, centre.imag)
        inertial = mass * (change - gravity)
        turning = inertia * motion.acceleration
        tally.size = np.maximum(tally.size, np.abs(inertial))
        worst = np.maximum(worst, np.abs(tally.force.get(name, 0j) - inertial))
        if body["length"] is not None:
            worst = np.maximum(worst, np.abs(tally.moment.get(name, 0.0) - turning) / _size(solution))
        used = (np.conj(speed) * inertial).real + turning * motion.rate
        power = power + used
        largest = np.maximum(largest, np.abs(speed) * np.abs(inertial) + np.abs(turning * motion.rate))
    return (worst, float(np.max(tally.size))), (np.abs(tally.power - power), float(np.max(largest + np.abs(tally.power))))


def _ends(solution: Solution, bodies: dict[str, _Motion], acting: Sequence[_Action]) -> tuple[Array, float]:
    """A link's section at its base is the opposite of all that acts on it there; beside the largest force on a link."""
    worst, scale = np.zeros_like(solution.t), 0.0
    base = np.zeros((solution.t.size, 1))
    for link in solution.links_with_sections:
        law = solution.section(link).law
        # What slides over the base just now counts as at the base, here and there.
        law = replace(law, loads=tuple(replace(x, station=np.where(np.abs(x.station) < _EDGE, 0.0, x.station)) for x in law.loads))
        axial, shear, bending = (law.at(force, base)[:, 0] for force in ("axial", "shear", "bending"))
        own = [part for part in acting if part[0] == link]
        force, moment = _before(bodies[link], own, _EDGE * law.length)
        worst = np.maximum(worst, np.abs(force + axial + 1j * shear))
        worst = np.maximum(worst, np.abs(moment + bending) / _size(solution))
        scale = max(scale, *(float(np.max(np.abs(push) + np.abs(couple) / _size(solution))) for _, _, push, couple, _ in own))
    return worst, scale


def _before(motion: _Motion, acting: Sequence[_Action], edge: float) -> tuple[Complex, Array]:
    """The force in a link's axes, and the moment about its base, of all that acts at its base or beyond it."""
    force, moment = np.zeros_like(motion.at), np.zeros_like(motion.angle)
    for _, at, push, couple, _ in acting:
        arm = (at - motion.at) * np.exp(-1j * motion.angle)
        here = arm.real <= edge
        force = force + np.where(here, push * np.exp(-1j * motion.angle), 0.0)
        moment = moment + np.where(here, (np.conj(at - motion.at) * push).imag + couple, 0.0)
    return force, moment
