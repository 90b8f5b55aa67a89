"""Independent checks of a solution, from its own arrays: none shares the graphs that made them.

The reported motions of the joints place every body anew, in plain arithmetic (:mod:`.placing`). The reported reactions, efforts,
loads and multipliers must then balance every body (Newton-Euler), the power of drives and loads must be the change of kinetic
energy, loops must close and the users' equations hold, and the sections at a link's base must give back what its joints do there.
Each residual is relative, (t,).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..base.arrays import Array
from ..base.quantities import FORCES, Output
from ..base.tables import SPACE
from ..declare.description import Description, density_of, oriented
from ..instants.solution import Solution
from . import digits
from .digits import LOOSE as LOOSE
from .digits import TOLERANCE as TOLERANCE
from .digits import blur as blur
from .friction import law_gaps
from .placing import Complex, Moving, axis_of, measured, place
from .spatial_certificate import residuals as spatial_residuals
from .tally import Tally, forces_told, law_at_base
from .touching import Placed, actions, idle
from .written import Written

NEAR = 1e3
_BLOCK = 1 << 14
_Matter = tuple[float, complex, float]
_Action = tuple[str, Complex, Any, Any, bool]

_TURNED = 100.0


def certify(
    solution: Solution,
    equations: Sequence[Written] | None = None,
    hidden: Mapping[Output, Array] | None = None,
    phases: Mapping[Output, Array] | None = None,
) -> dict[str, Array]:
    """The residuals that the solution's outputs allow: ``balance``, ``power``, ``closure``, ``ends``, ``friction``, each where it
    can be had; where a joint that rubs is at rest, ``closure``, and ``friction`` of others.

    ``equations`` are the constraints and rows of its mechanism, which a solution does not hold: without them, a solution of a
    mechanism that has some is looked at for ``closure`` alone. ``hidden`` are forces that it does not give: multipliers that were
    not wanted, and what is open, which takes some value all the same. ``phases`` are angles that are known up to whole turns more
    closely than they are reported.
    """
    resting = solution.resting
    if resting.any() and not resting.all():
        merged: dict[str, Array] = {}
        for some in (~resting, resting):
            pick = ({output: values[some] for output, values in (more or {}).items()} for more in (hidden, phases))
            for name, gaps in certify(solution.during(some), equations, *pick).items():
                merged.setdefault(name, np.zeros_like(solution.t))[some] = gaps
        return merged
    whole = replace(solution, outputs={**solution.outputs, **(hidden or {})}, left_open=())
    turned = replace(whole, outputs={**whole.outputs, **(phases or {})})
    found: dict[str, list[Array]] = {}
    scales: dict[str, float] = {}
    for start in range(0, whole.t.size, _BLOCK):
        block = slice(start, start + _BLOCK)
        for name, (gaps, scale) in _residuals(whole.during(block), turned.during(block), equations).items():
            found.setdefault(name, []).append(gaps)
            scales[name] = max(scales.get(name, 0.0), scale)
    return {name: np.concatenate(gaps) / (scales[name] or 1.0) for name, gaps in found.items()}


def _residuals(solution: Solution, turned: Solution, equations: Sequence[Written] | None) -> dict[str, tuple[Array, float]]:
    """Each residual, and the largest of what it is to be compared with; ``turned`` has angles without their turns."""
    if solution.table is SPACE:
        return spatial_residuals(solution, turned, equations)
    description = solution.description
    joints = description["joints"]
    if any(joint["coordinate"] and Output("motion", name) not in solution.outputs for name, joint in joints.items()):
        return {}
    if any(Output("pose", name, "x") not in solution.outputs for name in description["bodies"]):
        return {}
    bodies = place(turned, equations or ())
    if len(bodies) < len(description["bodies"]) + 1:
        return {}
    found = {"closure": (_closure(solution, bodies, equations or ()), digits.size(solution))}
    if (rubbed := law_gaps(solution, bodies)) is not None:
        found["friction"] = rubbed
    if forces_told(solution, equations):
        matter = {name: _matter(body) for name, body in description["bodies"].items()}
        acting = [*_acting(solution, bodies), *(push for e in equations or () for push in _held(solution, bodies, e))]
        tally = _tally(solution, bodies, acting, matter)
        found["balance"], found["power"] = _balance(solution, bodies, tally, matter)
        if solution.links_with_sections:
            found["ends"] = _ends(solution, bodies, acting, matter)
    return found


def tolerance(solution: Solution) -> float:
    """What residuals are held to."""
    exact = solution.provenance.precision == "double" and not any(
        word in solution.provenance.rung for word in ("--newton", "--table")
    )
    return min(LOOSE, max(TOLERANCE, _TURNED * blur(solution))) if exact else LOOSE


def failure(solution: Solution) -> str:
    """Which residuals of a solution fail, in words."""
    worse = ", ".join(f"{name} {value:.2g}" for name, value in solution.failed.items())
    return f"the certificate fails: {worse}, and no more than {solution.tolerance:.2g} is rounding"


def summary(residuals: Mapping[str, Array]) -> str:
    """The largest residuals, in one line; and how singular the loops are, where it matters."""
    parts = [f"{name} {np.max(values):.1e}" for name, values in residuals.items() if name != "condition"]
    said = "certificate: " + (", ".join(parts) if parts else "nothing to check, for want of outputs")
    worst = float(np.max(residuals.get("condition", np.ones(1))))
    return said + (f"; near a dead centre, where the loops magnify errors by {worst:.3g}" if worst > NEAR else "")


def _matter(body: Description) -> _Matter:
    """Mass, centre in the body's axes, and inertia about the centre."""
    mass, length = body["mass"], body["length"]
    if length is None or mass == 0.0:
        return mass, 0j, 0.0
    if "centre" in body:
        return mass, body["centre"]["x"] + 1j * body["centre"]["y"], body["centre"]["inertia"]
    _, first, second = (float(tail[0]) for tail in density_of(body).tails(np.zeros(1)))
    middle = first / mass
    return mass, middle * length + 0j, (second - first * middle) * length**2


def _closure(solution: Solution, bodies: dict[str, Moving], equations: Sequence[Written]) -> Array:
    """Gaps of all joints, of the reported poses, and of the users' equations: over their slopes, times the length of all links."""
    worst = np.zeros_like(solution.t)
    for joint in solution.description["joints"].values():
        (a, *_), (b, *_) = (bodies[p["body"]].point(p["x"], p["y"]) for p in (joint["parent"], joint["child"]))
        slides = joint["kind"] in ("prismatic", "slot")
        across = ((b - a) * np.conj(axis_of(joint, bodies[joint["parent"]["body"]]))).imag
        worst = np.maximum(worst, np.abs(across if slides else b - a))
        if joint["kind"] in ("prismatic", "weld") and oriented(solution.description, joint["child"]["body"]):
            turned = bodies[joint["child"]["body"]].angle - bodies[joint["parent"]["body"]].angle - joint["angle"]
            worst = np.maximum(worst, np.abs(np.exp(1j * turned) - 1.0) * digits.size(solution))
    for name in solution.description["bodies"]:
        pose = solution.pose(name)
        worst = np.maximum(worst, np.abs(pose.x + 1j * pose.y - bodies[name].at))
        if pose.angle is not None:
            # An angle of many turns is reported to so many digits only.
            known = digits.ROUNDINGS * digits.rounding(solution) * np.abs(pose.angle)
            off = np.abs(np.exp(1j * (pose.angle - bodies[name].angle)) - 1.0) - known
            worst = np.maximum(worst, off * digits.size(solution))
    for equation in equations:
        motion = [measured(solution, bodies, entry) for entry in equation.entries]
        units = [1.0 if entry.kind in ("direction", "coordinate") else digits.size(solution) for entry in equation.entries]
        moving = [unit + np.abs(entry[1 if equation.row else 0]) for unit, entry in zip(units, motion, strict=True)]
        scale = np.sum(np.abs(equation.slopes_at(motion, solution.t)) * moving, axis=0)
        missed = np.abs(equation.at(motion, solution.t)[0])
        worst = np.maximum(worst, np.divide(missed, scale, out=missed.copy(), where=scale > 0.0) * digits.size(solution))
        for touch in equation.touches:
            worst = np.maximum(worst, idle(touch, {name: _placed(body) for name, body in bodies.items()}) * digits.size(solution))
    return worst


def _placed(body: Moving) -> Placed:
    """A body of the plane in vectors of three."""
    nil = np.zeros_like(body.angle)
    c, s = np.cos(body.angle), np.sin(body.angle)
    axes = np.moveaxis(np.array([[c, -s, nil], [s, c, nil], [nil, nil, nil + 1.0]]), 2, 0)
    at, speed = (np.stack([one.real, one.imag, nil], axis=1) for one in (body.at, body.speed))
    return Placed(at, axes, speed, np.stack([nil, nil, body.rate], axis=1))


def _acting(solution: Solution, bodies: dict[str, Moving]) -> Iterator[_Action]:
    """Every force: the body, the place, the force and couple, and whether it does work."""
    for name, joint in solution.description["joints"].items():
        at = bodies[joint["child"]["body"]].point(joint["child"]["x"], joint["child"]["y"])[0]
        reaction = solution.reaction(name)
        force, couple = reaction.fx + 1j * reaction.fy, 0.0 if reaction.mz is None else reaction.mz
        pushes: list[tuple[Any, Any, bool]] = [(force, couple, False)]
        if Output("effort", name) in solution.outputs:
            effort = solution.effort(name)
            axis = axis_of(joint, bodies[joint["parent"]["body"]])
            pushes.append((0j, effort, True) if joint["coordinate"] == "angle" else (effort * axis, 0.0, True))
        for push, twist, works in pushes:
            yield joint["child"]["body"], at, push, twist, works
            yield joint["parent"]["body"], at, -push, -twist, works
    for name, load in solution.description["loads"].items():
        fx, fy, mz = (solution.outputs[Output("load", name, k)] for k in ("fx", "fy", "mz"))
        for point, sign in zip(load["points"], (1.0, -1.0), strict=False):
            # What a joint's parent does to its child comes back where the child is.
            place = load["points"][0] if "friction" in load else point
            at = bodies[place["body"]].point(place["x"], place["y"])[0]
            yield point["body"], at, sign * (fx + 1j * fy), sign * mz, True


def _held(solution: Solution, bodies: dict[str, Moving], equation: Written) -> Iterator[_Action]:
    """What the multiplier of an equation does: along whatever stands in it, or where the parts of a transmission touch."""
    for touch in equation.touches:
        told = solution.multiplier(equation.name), touch.sense(solution)
        for body, spot, borne, couple in actions(touch, _placed(bodies[touch.carrier]), *told):
            yield body, spot[:, 0] + 1j * spot[:, 1], borne[:, 0] + 1j * borne[:, 1], couple[:, 2], True
    if equation.touches:
        return
    motion = [measured(solution, bodies, entry) for entry in equation.entries]
    forces = solution.multiplier(equation.name) * equation.slopes_at(motion, solution.t)
    push: Any
    for entry, force in zip(equation.entries, forces, strict=True):
        if entry.kind == "direction":
            yield entry.part, bodies[entry.part].at, 0j, force, True
        elif entry.kind != "coordinate":
            yield entry.part, bodies[entry.part].point(*entry.point)[0], force * (1.0 if entry.kind == "x" else 1j), 0.0, True
        else:
            joint = solution.description["joints"][entry.part]
            child, parent = joint["child"]["body"], joint["parent"]["body"]
            at = bodies[child].point(joint["child"]["x"], joint["child"]["y"])[0]
            turns = joint["coordinate"] == "angle"
            push, twist = (0j, force) if turns else (force * axis_of(joint, bodies[parent]), 0.0)
            yield child, at, push, twist, True
            yield parent, at, -push, -twist, True


def _tally(solution: Solution, bodies: dict[str, Moving], acting: Sequence[_Action], matter: Mapping[str, _Matter]) -> Tally:
    tally = Tally()
    for body, at, force, couple, works in acting:
        if body == "ground":
            continue
        motion = bodies[body]
        _, centre, _ = matter[body]
        middle = motion.point(centre.real, centre.imag)[0]
        moment = (np.conj(at - middle) * force).imag + couple
        tally.force[body] = tally.force.get(body, 0j) + force
        tally.moment[body] = tally.moment.get(body, 0.0) + moment
        tally.bear(np.abs(force), np.abs(couple), digits.size(solution))
        if works:
            local = (at - motion.at) * np.exp(-1j * motion.angle)
            speed = motion.point(local.real, local.imag)[1]
            tally.power = tally.power + (np.conj(speed) * force).real + couple * motion.rate
            tally.flow = tally.flow + np.abs(speed) * np.abs(force) + np.abs(couple * motion.rate)
    return tally


def _weight(solution: Solution, motion: Moving, mass: float, reach: float) -> Array:
    """The inertia of a body and its weight [N], none against another: of its origin, and of what turns about it."""
    turning = motion.rate**2 + np.abs(motion.acceleration)
    return np.asarray(mass * (np.abs(motion.change) + turning * reach + abs(complex(*solution.description["gravity"]))))


def _balance(
    solution: Solution, bodies: dict[str, Moving], tally: Tally, matter: Mapping[str, _Matter]
) -> tuple[tuple[Array, float], tuple[Array, float]]:
    """Newton-Euler for every body, beside the largest force; and power, beside all that flows."""
    gravity, size = complex(*solution.description["gravity"]), digits.size(solution)
    worst, power = np.zeros_like(solution.t), np.zeros_like(solution.t)
    for name, body in solution.description["bodies"].items():
        mass, centre, inertia = matter[name]
        motion = bodies[name]
        _, speed, change = motion.point(centre.real, centre.imag)
        inertial = mass * (change - gravity)
        turning = inertia * motion.acceleration
        weight = _weight(solution, motion, mass, abs(centre))
        tally.bear(weight, np.abs(turning), size)
        worst = np.maximum(worst, np.abs(tally.force.get(name, 0j) - inertial))
        if body["length"] is not None:
            worst = np.maximum(worst, np.abs(tally.moment.get(name, 0.0) - turning) / size)
        power = power + (np.conj(speed) * inertial).real + turning * motion.rate
        tally.flow = tally.flow + np.abs(speed) * weight + np.abs(turning * motion.rate)
    turned, fastest = _rates(solution, bodies)
    largest, flow = tally.scales(solution, turned, fastest)
    return (worst, largest), (np.abs(tally.power - power), flow)


def _rates(solution: Solution, bodies: dict[str, Moving]) -> tuple[Array, Array]:
    """The largest rate of turning at each instant, of joints too, and a speed that none exceeds."""
    turning = [np.abs(motion.rate) for motion in bodies.values()]
    for name, joint in solution.description["joints"].items():
        if joint["coordinate"] == "angle":
            turning.append(np.abs(solution.motion(name).rate))
    turned = np.max(turning, axis=0)
    return turned, np.max([np.abs(motion.speed) for motion in bodies.values()], axis=0) + turned * digits.extent(solution)


def _ends(
    solution: Solution, bodies: dict[str, Moving], acting: Sequence[_Action], matter: Mapping[str, _Matter]
) -> tuple[Array, float]:
    """A link's section at its base is the opposite of all that acts on it there; beside the largest force on a link.

    And beside what the rounding of places leaves open, which turns short links most.
    """
    worst, scale = np.zeros_like(solution.t), digits.least(solution)
    size, blurred = digits.size(solution), digits.coarseness(solution) * digits.extent(solution)
    base = np.zeros((solution.t.size, 1))
    for link in solution.links_with_sections:
        law = law_at_base(solution, link)
        axial, shear, bending = (law.at(force, base)[:, 0] for force in FORCES)
        own = [part for part in acting if part[0] == link]
        force, moment = _before(bodies[link], own, law.slack * law.length)
        flow = _weight(solution, bodies[link], matter[link][0], law.length)
        for _, _, push, couple, _ in own:
            flow = np.maximum(flow, np.abs(push) + np.abs(couple) / size)
        worst = np.maximum(worst, np.abs(force + axial + 1j * shear) / (1.0 + blurred / law.length))
        worst = np.maximum(worst, np.abs(moment + bending) / (size + blurred))
        scale = max(scale, float(np.max(flow)))
    return worst, scale


def _before(motion: Moving, acting: Sequence[_Action], edge: float) -> tuple[Complex, Array]:
    """The force in a link's axes, and the moment about its base, of all that acts at its base or beyond it."""
    force, moment = np.zeros_like(motion.at), np.zeros_like(motion.angle)
    for _, at, push, couple, _ in acting:
        arm = (at - motion.at) * np.exp(-1j * motion.angle)
        here = arm.real <= edge
        force = force + np.where(here, push * np.exp(-1j * motion.angle), 0.0)
        moment = moment + np.where(here, (np.conj(at - motion.at) * push).imag + couple, 0.0)
    return force, moment
