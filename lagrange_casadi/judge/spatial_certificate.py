"""The residuals of a spatial solution, by the same meaning as those of a planar one (:mod:`.certificate`), in plain vectors.

What acts along a joint's coordinate does no work along the others: along a slide a force at the joint's point on the child, about
one of several axes a couple at right angles to the other axes. Multipliers act along what stands in their equation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output, force_members
from ..declare.description import Description, density_of, measured_of, oriented, slices_of
from ..instants.solution import Solution
from . import digits
from .friction import law_gaps
from .locked import without_locked
from .spatial_placing import Moving, Reported, cross, measured, relative, resolve, spot, told, turn
from .spatial_rest import axes_of, gaps_of, place_all
from .tally import Tally, forces_told, law_at_base
from .touching import Placed, actions, idle
from .written import Written

_FORCES, _MOMENTS = ("axial", "shear_y", "shear_z"), ("torsion", "bending_y", "bending_z")
_Matter = tuple[float, Array, Array]


@dataclass(frozen=True, eq=False)
class _Action:
    """A force and a couple on a body at a place, each (t, 3), and whether they do work."""

    body: str
    at: Array
    force: Array
    couple: Array
    works: bool

    @property
    def pushes(self) -> tuple[Array, Array]:
        """The sizes of both."""
        return _size(self.force), _size(self.couple)


def residuals(solution: Solution, turned: Solution, equations: Sequence[Written] | None) -> dict[str, tuple[Array, float]]:
    """Each residual, and the largest of what it is to be compared with; ``turned`` has angles without their turns."""
    description = solution.description
    if any(Output("motion", name) not in solution.outputs for name in measured_of(description)):
        return {}
    if any(Output("pose", name, "z") not in solution.outputs for name in description["bodies"]):
        return {}
    solution, turned = without_locked(solution), without_locked(turned)
    reported = Reported(solution, turned)
    bodies = place_all(reported, equations or ())
    if len(bodies) < len(description["bodies"]) + 1:
        return {}
    found = {"closure": (_closure(reported, bodies, equations or ()), digits.size(solution))}
    balls = {name: joint for name, joint in description["joints"].items() if joint["kind"] == "spherical"}
    spins = {name: bodies[j["child"]["body"]].rate - bodies[j["parent"]["body"]].rate for name, j in balls.items()}
    if (rubbed := law_gaps(solution, spins=spins)) is not None:
        found["friction"] = rubbed
    if forces_told(solution, equations):
        matter = {name: _matter(body) for name, body in description["bodies"].items()}
        acting = [*_acting(reported, bodies)]
        acting += [push for equation in equations or () for push in _held(reported, bodies, equation)]
        tally = _tally(solution, bodies, acting, matter)
        found["balance"], found["power"] = _balance(solution, bodies, tally, matter)
        if solution.links_with_sections:
            found["ends"] = _ends(solution, bodies, acting, matter)
    return found


def _size(vectors: Array) -> Array:
    return np.asarray(np.sqrt(np.sum(vectors * vectors, axis=-1)))


def _matter(body: Description) -> _Matter:
    """Mass, centre in the body's axes, and inertia about the centre."""
    mass, length = body["mass"], body["length"]
    if length is None or (mass == 0.0 and "centre" not in body):
        return mass, np.zeros(3), np.zeros((3, 3))
    if "centre" in body:
        return mass, spot(body["centre"]), np.array(body["centre"]["inertia"])
    _, first, second = (float(tail[0]) for tail in density_of(body).tails(np.zeros(1)))
    middle = first / mass
    across = (second - first * middle) * length**2
    yy, zz, yz = slices_of(body)
    inertia = np.array([[yy + zz, 0.0, 0.0], [0.0, across + zz, -yz], [0.0, -yz, across + yy]])
    return mass, np.array([middle * length, 0.0, 0.0]), inertia


def _closure(reported: Reported, bodies: Mapping[str, Moving], equations: Sequence[Written]) -> Array:
    """Gaps of all joints, of the reported poses, and of the users' equations: over their slopes, times the length of all links.

    A joint's gap is how far its child is from where, and from how, its reported motion puts it; so too of rates and accelerations,
    over the largest that there are. A bar's y axis must be in the plane of the bar and the direction that was declared for it.
    """
    solution, turned = reported.solution, reported.turned
    worst, size = np.zeros_like(solution.t), digits.size(solution)
    _, fastest, most = _rates(solution, bodies)
    for joint in solution.description["joints"].values():
        near, far, motion = bodies[joint["parent"]["body"]], bodies[joint["child"]["body"]], relative(reported, joint)
        apart = near.under(far.point(spot(joint["child"]))[0]) - spot(joint["parent"]) - motion.slide[0]
        worst = np.maximum(worst, _size(apart))
        if told(solution.description, joint):
            off = np.swapaxes(near.axes, 1, 2) @ far.axes - motion.turned
            worst = np.maximum(worst, np.abs(off).max(axis=(1, 2)) * size)
        for gap, scale in zip(gaps_of(reported, joint, bodies), (fastest, fastest / size, most, most / size), strict=True):
            largest = float(np.max(scale))
            worst = np.maximum(worst, _size(gap) * (size / largest if largest > 0.0 else 0.0))
    for name in measured_of(solution.description):
        # An angle of many turns is reported to so many digits only.
        told_as, meant = solution.motion(name).value, turned.motion(name).value
        if told_as is not meant:
            known = digits.ROUNDINGS * digits.rounding(solution) * np.abs(told_as)
            worst = np.maximum(worst, (np.abs(np.exp(1j * (told_as - meant)) - 1.0) - known) * size)
    aims = {name: np.array(way) for name, way in solution.description.get("beside", {}).items()}
    for name in solution.description["bodies"]:
        pose, body = solution.pose(name), bodies[name]
        place = np.stack([pose.x, pose.y, pose.z], axis=1)  # type: ignore[list-item]
        worst = np.maximum(worst, _size(place - body.at))
        if oriented(solution.description, name):
            axes = axes_of(solution, name)
            crooked = np.swapaxes(axes, 1, 2) @ axes - np.eye(3), axes - body.axes
            worst = np.maximum(worst, np.abs(crooked).max(axis=(0, 2, 3)) * size)
            worst = np.maximum(worst, _size(cross(axes[:, :, 0], axes[:, :, 1]) - axes[:, :, 2]) * size)
            if name in solution.description["bars"] and name in aims:
                _, along, off = np.moveaxis(aims[name] @ axes, 1, 0)
                worst = np.maximum(worst, np.where(along >= 0.0, np.abs(off), 1.0) * size)
    for equation in equations:
        entries = [measured(solution, bodies, entry) for entry in equation.entries]
        units = [1.0 if entry.kind == "coordinate" else size for entry in equation.entries]
        moving = [unit + np.abs(entry[1 if equation.row else 0]) for unit, entry in zip(units, entries, strict=True)]
        scale = np.sum(np.abs(equation.slopes_at(entries, solution.t)) * moving, axis=0)
        missed = np.abs(equation.at(entries, solution.t)[0])
        worst = np.maximum(worst, np.divide(missed, scale, out=missed.copy(), where=scale > 0.0) * size)
        for touch in equation.touches:
            worst = np.maximum(worst, idle(touch, {name: _placed(body) for name, body in bodies.items()}) * size)
    return worst


def _placed(body: Moving) -> Placed:
    return Placed(body.at, body.axes, body.speed, body.rate)


def _along(reported: Reported, joint: Description, bodies: Mapping[str, Moving], name: str, effort: Array) -> Iterator[_Action]:
    """What an effort along a joint's coordinate does to its child, and the opposite to its parent, at the point on the child."""
    near, child = bodies[joint["parent"]["body"]], joint["child"]
    at, nil = bodies[child["body"]].point(spot(child))[0], np.zeros((effort.size, 3))
    names = [*joint["coordinates"]]
    if joint["coordinates"][name] == "slide":
        force, couple = effort[:, None] * turn(near.axes, joint["axes"][names.index(name)]), nil
    else:
        number = [one for one in names if joint["coordinates"][one] == "angle"].index(name)
        about = [turn(near.axes, axis) for axis in relative(reported, joint).about]
        force, couple = nil, effort[:, None] * _reciprocal(about, number)
    yield _Action(child["body"], at, force, couple, True)
    yield _Action(joint["parent"]["body"], at, -force, -couple, True)


def _reciprocal(axes: Sequence[Array], number: int) -> Array:
    """The couple that does a unit of work for a turn about one of axes, and none for turns about the others."""
    if len(axes) < 3:
        return axes[number]
    first, second, third = (axes[(number + k) % 3] for k in range(3))
    across = cross(second, third)
    with np.errstate(all="ignore"):
        return np.asarray(across / np.sum(first * across, axis=1)[:, None])


def _acting(reported: Reported, bodies: Mapping[str, Moving]) -> Iterator[_Action]:
    """Every force of joints, drives and loads."""
    solution = reported.solution

    def vectors(group: str, name: str) -> tuple[Array, Array]:
        members = force_members(True)
        return _vector(solution, group, name, members[:3]), _vector(solution, group, name, members[3:])

    for name, joint in solution.description["joints"].items():
        at = bodies[joint["child"]["body"]].point(spot(joint["child"]))[0]
        force, couple = vectors("reaction", name)
        yield _Action(joint["child"]["body"], at, force, couple, False)
        yield _Action(joint["parent"]["body"], at, -force, -couple, False)
        efforts = [Output("effort", coordinate) for coordinate in joint["coordinates"]]
        found = [_along(reported, joint, bodies, one.part, solution.outputs[one]) for one in efforts if one in solution.outputs]
        for together in zip(*found, strict=True):
            # Near gimbal lock couples along coordinates are large, and all together what the joint needs.
            force, couple = sum(one.force for one in together), sum(one.couple for one in together)
            yield replace(together[0], force=np.asarray(force), couple=np.asarray(couple))
    for name, load in solution.description["loads"].items():
        force, couple = vectors("load", name)
        for point, sign in zip(load["points"], (1.0, -1.0), strict=False):
            # Friction is where the joint's child is, on both.
            place = load["points"][0] if "friction" in load else point
            yield _Action(point["body"], bodies[place["body"]].point(spot(place))[0], sign * force, sign * couple, True)


def _vector(solution: Solution, group: str, name: str, members: Sequence[str]) -> Array:
    """Three outputs of a part as vectors (t, 3); those that it has none of are zero."""
    nil = np.zeros_like(solution.t)
    return np.stack([solution.outputs.get(Output(group, name, member), nil) for member in members], axis=1)


def _held(reported: Reported, bodies: Mapping[str, Moving], equation: Written) -> Iterator[_Action]:
    """What the multiplier of an equation does: along whatever stands in it, or where the parts of a transmission touch."""
    solution = reported.solution
    for touch in equation.touches:
        told = solution.multiplier(equation.name), touch.sense(solution)
        for part in actions(touch, _placed(bodies[touch.carrier]), *told):
            yield _Action(*part, True)
    if equation.touches:
        return
    motion = [measured(solution, bodies, entry) for entry in equation.entries]
    forces = solution.multiplier(equation.name) * equation.slopes_at(motion, solution.t)
    joints = {name: joint for joint in solution.description["joints"].values() for name in joint["coordinates"]}
    for entry, force in zip(equation.entries, forces, strict=True):
        if entry.kind == "coordinate":
            yield from _along(reported, joints[entry.part], bodies, entry.part, force)
        else:
            push = force[:, None] * np.eye(3)["xyz".index(entry.kind)]
            yield _Action(entry.part, bodies[entry.part].point(np.array(entry.point))[0], push, np.zeros_like(push), True)


def _tally(solution: Solution, bodies: Mapping[str, Moving], acting: Sequence[_Action], matter: Mapping[str, _Matter]) -> Tally:
    tally = Tally()
    for act in acting:
        if act.body == "ground":
            continue
        motion = bodies[act.body]
        middle = motion.point(matter[act.body][1])[0]
        moment = cross(act.at - middle, act.force) + act.couple
        tally.force[act.body] = tally.force.get(act.body, 0.0) + act.force
        tally.moment[act.body] = tally.moment.get(act.body, 0.0) + moment
        push, twist = act.pushes
        tally.bear(push, twist, digits.size(solution))
        if act.works:
            speed = motion.speed + cross(motion.rate, act.at - motion.at)
            tally.power = tally.power + np.sum(speed * act.force + motion.rate * act.couple, axis=1)
            tally.flow = tally.flow + _size(speed) * push + _size(motion.rate) * twist
    return tally


def _weight(solution: Solution, motion: Moving, mass: float, reach: float) -> Array:
    """The inertia of a body and its weight [N], none against another: of its origin, and of what turns about it."""
    turning = _size(motion.rate) ** 2 + _size(motion.acceleration)
    return np.asarray(mass * (_size(motion.change) + turning * reach + float(_size(np.array(solution.description["gravity"])))))


def _balance(
    solution: Solution, bodies: Mapping[str, Moving], tally: Tally, matter: Mapping[str, _Matter]
) -> tuple[tuple[Array, float], tuple[Array, float]]:
    """Newton-Euler for every body, beside the largest force; and power, beside all that flows."""
    gravity, size = np.array(solution.description["gravity"]), digits.size(solution)
    worst, power = np.zeros_like(solution.t), np.zeros_like(solution.t)
    for name in solution.description["bodies"]:
        mass, centre, inertia = matter[name]
        motion = bodies[name]
        _, speed, change = motion.point(centre)
        inertial = mass * (change - gravity)
        spin = turn(motion.axes, turn(inertia, resolve(motion.axes, motion.rate)))
        gains = turn(motion.axes, turn(inertia, resolve(motion.axes, motion.acceleration)))
        turning = gains + cross(motion.rate, spin)
        weight = _weight(solution, motion, mass, float(_size(centre)))
        tally.bear(weight, _size(gains) + _size(motion.rate) * _size(spin), size)
        worst = np.maximum(worst, _size(tally.force.get(name, 0.0) - inertial))
        if oriented(solution.description, name):
            worst = np.maximum(worst, _size(tally.moment.get(name, 0.0) - turning) / size)
        power = power + np.sum(speed * inertial + motion.rate * turning, axis=1)
        tally.flow = tally.flow + _size(speed) * weight + _size(motion.rate) * _size(turning)
    worst = np.maximum(worst, _unlike(solution, bodies))
    turned, fastest, _ = _rates(solution, bodies)
    largest, flow = tally.scales(solution, turned, fastest)
    return (worst, largest), (np.abs(tally.power - power), flow)


def _unlike(solution: Solution, bodies: Mapping[str, Moving]) -> Array:
    """By how much reactions on the joints' own axes are other than those in ground axes: forces, and moments over the size."""
    worst = np.zeros_like(solution.t)
    for name, joint in solution.description["joints"].items():
        if Output("reaction", name, "fu") in solution.outputs:
            axes = bodies[joint["parent"]["body"]].axes @ np.array(joint["triad"]).T
            for kind, arm in (("f", 1.0), ("m", digits.size(solution))):
                there, own = (_vector(solution, "reaction", name, [kind + x for x in names]) for names in ("xyz", "uvw"))
                worst = np.maximum(worst, _size(there - turn(axes, own)) / arm)
    return worst


def _rates(solution: Solution, bodies: Mapping[str, Moving]) -> tuple[Array, Array, Array]:
    """The largest rate of turning at each instant, of joints too; and a speed and an acceleration that none exceeds."""
    turning = [_size(motion.rate) for motion in bodies.values()]
    gaining = [_size(motion.acceleration) for motion in bodies.values()]
    for joint in solution.description["joints"].values():
        for name, kind in joint["coordinates"].items():
            if kind == "angle" and name not in solution.description["unmeasured"]:
                motion = solution.motion(name)
                turning.append(np.abs(motion.rate))
                gaining.append(np.abs(motion.acceleration))
    turned, extent = np.max(turning, axis=0), digits.extent(solution)
    fastest = np.max([_size(motion.speed) for motion in bodies.values()], axis=0) + turned * extent
    changes = np.max([_size(motion.change) for motion in bodies.values()], axis=0)
    return turned, fastest, changes + (np.max(gaining, axis=0) + turned**2) * extent


def _ends(
    solution: Solution, bodies: Mapping[str, Moving], acting: Sequence[_Action], matter: Mapping[str, _Matter]
) -> tuple[Array, float]:
    """A link's section at its base is the opposite of all that acts on it there; beside the largest force on a link.

    And beside what the rounding of places leaves open, which turns short links most.
    """
    worst, scale = np.zeros_like(solution.t), digits.least(solution)
    size, blurred = digits.size(solution), digits.coarseness(solution) * digits.extent(solution)
    base = np.zeros((solution.t.size, 1))
    for link in solution.links_with_sections:
        law = law_at_base(solution, link)
        inside, twisted = (np.concatenate([law.at(name, base) for name in names], axis=1) for names in (_FORCES, _MOMENTS))
        own = [act for act in acting if act.body == link]
        force, moment = _before(bodies[link], own, law.slack * law.length)
        flow = _weight(solution, bodies[link], matter[link][0], law.length)
        for act in own:
            push, twist = act.pushes
            flow = np.maximum(flow, push + twist / size)
        worst = np.maximum(worst, _size(force + inside) / (1.0 + blurred / law.length))
        worst = np.maximum(worst, _size(moment + twisted) / (size + blurred))
        scale = max(scale, float(np.max(flow)))
    return worst, scale


def _before(motion: Moving, acting: Sequence[_Action], edge: float) -> tuple[Array, Array]:
    """The force in a link's axes, and the moment about its base, of all that acts at its base or before it."""
    force, moment = np.zeros_like(motion.at), np.zeros_like(motion.at)
    for act in acting:
        arm, push = motion.under(act.at), resolve(motion.axes, act.force)
        here = arm[:, :1] <= edge
        force = force + np.where(here, push, 0.0)
        moment = moment + np.where(here, cross(arm, push) + resolve(motion.axes, act.couple), 0.0)
    return force, moment
