"""Newton-Euler for every body, laws of loads, the power of all that does work, and sections at the
bases of links.

All are from reported forces. Multipliers act along what stands in their equation.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.description import Description, DriveNumbers
from ...model.stated import Equation
from .closure import Residuals
from .contacts import actions
from .instant_vectors import NIL, constant, cross, dot, resolve, size, turn
from .load_laws import off_laws
from .placing import Placed
from .unplaced import stacked


@dataclass(frozen=True, eq=False)
class Action:
    """A force and a couple on a body at a place, in ground axes; and the opposite there ``against``
    another body, where given.

    ``name`` is that of the output it is reported as: ``reaction:A``, ``effort:O``, ``load:gas``,
    ``multiplier:mesh``. ``works`` says whether they do work.
    """

    name: str
    body: str
    at: Array
    force: Array
    couple: Array
    against: str = "ground"
    works: bool = True

    @property
    def moving(self) -> Iterator[tuple[str, float]]:
        """The bodies but for the ground, with 1, or with -1 where they bear the opposite."""
        ends = (self.body, 1.0), (self.against, -1.0)
        return ((body, sign) for body, sign in ends if body != "ground")

    def sign_on(self, body: str) -> float:
        """Return 1 for the body, -1 for the one that bears the opposite, and 0 for any other."""
        return dict(self.moving).get(body, 0.0)

    @cached_property
    def sizes(self) -> tuple[Array, Array]:
        """The sizes of force and couple."""
        return size(self.force), size(self.couple)


@dataclass(eq=False)
class _Sums:
    """Sums of actions: forces on each body and their moments about its centre, and the power of
    all.

    Beside it sizes, none against another: ``largest`` of one action, ``pushes`` and ``twists`` of
    all, and ``flow`` of powers.
    """

    force: dict[str, Array]
    moment: dict[str, Array]
    power: Array
    largest: Array
    pushes: Array
    twists: Array
    flow: Array

    def bear(self, push: Array, twist: Array, size: float) -> None:
        """Take a force and a couple into the sizes; ``size`` is the mechanism's."""
        self.largest = np.maximum(self.largest, push + twist / size)
        self.pushes, self.twists = self.pushes + push, self.twists + twist


def forces_reported(placed: Placed) -> bool:
    """Return whether every force that acts on the bodies is reported, and the equations along which
    multipliers act are known.
    """
    declared, outputs = placed.declared, placed.reported.outputs
    if len(placed.stated.equations) < len(declared.multipliers):
        return False
    others = (output for output in outputs if output.group in ("reaction", "load"))
    needed = (*forces_needed(declared), *others)
    return all(output in outputs and np.isfinite(outputs[output]).all() for output in needed)


def forces_needed(declared: Description, body: str = "") -> Iterator[Output]:
    """Yield an output of every force that acts on a body; of every force if no body is named."""
    everything, axes = not body, set[str]()
    for name, joint in declared.joints.items():
        if everything or body in (joint.parent.body, joint.child.body):
            axes |= {axis.coordinate for axis in joint.axes}
            yield Output("reaction", name, "fx")
    yield from (Output("effort", name) for name in declared.drives if everything or name in axes)
    for name, load in declared.loads.items():
        if everything or any(point.body == body for point in load.points):
            yield Output("load", name, "fx")
    yield from (Output("multiplier", name) for name in declared.multipliers)


def balance(placed: Placed) -> dict[str, list[Residuals]]:
    """The residuals of forces, each with what it is to be compared with."""
    acting = list(all_actions(placed))
    centres = {
        name: placed.bodies[name].point(body.whole.centre)
        for name, body in placed.declared.bodies.items()
    }
    sums = _sums(placed, acting, centres)
    worst, power = np.zeros_like(placed.reported.t), sums.power
    length, gravity = placed.declared.size, placed.reported.straight(placed.declared.gravity)
    for name, body in placed.declared.bodies.items():
        motion = placed.bodies[name]
        (_, speed, change), (rate, _) = centres[name], motion.spin
        inertial = body.whole.mass * (change - gravity)
        turning = motion.turning(constant(body.whole.inertia))
        weight = _weight(placed, name, math.hypot(*body.whole.centre))
        _, _, rotates, gains = motion.sizes
        sums.bear(weight, np.max(np.abs(body.whole.inertia)) * (gains + rotates**2), length)
        worst = np.maximum(worst, size(sums.force[name] - inertial))
        if placed.declared.oriented(name):
            worst = np.maximum(worst, size(sums.moment[name] - turning) / length)
        power = power - dot(speed, inertial) - dot(rate, turning)
        sums.flow = sums.flow + size(speed) * weight + rotates * size(turning)
    worst = np.maximum(worst, _unlike(placed))
    turned, fastest, _ = placed.rates
    # Reported digits leave open places, which give arms, and the joints' rates, of which the rates
    # of bodies are sums.
    largest = sums.largest * (1.0 + placed.reported.coarseness * placed.declared.extent / length)
    worst = np.maximum(worst, off_laws(placed, float(np.max(largest))))
    scale = max(float(np.max(largest)), placed.reported.least)
    flow = (
        sums.flow
        + placed.reported.least * fastest
        + placed.reported.coarseness * (sums.pushes * fastest + sums.twists * turned)
    )
    found = {
        "balance": [(worst, scale)],
        "power": [(np.abs(power), float(np.max(flow)))],
    }
    return found | ({"ends": [_ends(placed, acting, scale)]} if placed.reported.laws else {})


def all_actions(placed: Placed) -> Iterator[Action]:
    """Yield every force of joints, drives, loads and equations."""
    reported, declared = placed.reported, placed.declared
    for name, joint in declared.joints.items():
        at, child, parent = placed.pin(name)[0], joint.child.body, joint.parent.body
        yield Action(
            f"reaction:{name}",
            child,
            at,
            *reported.acts("reaction", name),
            parent,
            works=False,
        )
        # Near gimbal lock couples along coordinates are large, and all together what the joint
        # needs.
        efforts = [
            placed.along(axis.coordinate, reported.outputs[effort])
            for axis in joint.axes
            if (effort := Output("effort", axis.coordinate)) in reported.outputs
        ]
        if efforts:
            force, couple = (sum(of, NIL) for of in zip(*efforts, strict=True))
            yield Action(f"effort:{name}", child, at, force, couple, parent)
    for name, load in declared.loads.items():
        force, couple = reported.acts("load", name)
        for point, sign in zip(load.points, (1.0, -1.0), strict=False):
            # Friction is where the joint's child is, on both.
            place = load.points[0] if load.friction is not None else point
            at = placed.bodies[place.body].point(place.at)[0]
            yield Action(f"load:{name}", point.body, at, sign * force, sign * couple)
    for name, motor in declared.motors.items():
        yield from _of_rotor(placed, f"drive:{name}", motor)
    for equation in placed.stated.equations:
        yield from _held(placed, equation)


def _of_rotor(placed: Placed, name: str, motor: DriveNumbers) -> Iterator[Action]:
    """Action of a drive's rotor on the bodies of its joint, by its acceleration."""
    joint = placed.declared.joints[motor.coordinate]
    at, near = placed.pin(joint.name)[0], placed.bodies[joint.parent.body]
    _, rate, change = placed.reported.motion(joint.name)
    # In a plane a rotor along a slide has no couple.
    about = turn(near.axes, placed.reported.turning(joint.axes[0].direction))
    taken = motor.reflected * change + motor.spin * dot(about, near.spin[1])
    acts = placed.along(joint.name, -taken)
    yield Action(name, joint.child.body, at, *acts, joint.parent.body)
    turning = change * about + rate * cross(near.spin[0], about)
    yield Action(name, joint.parent.body, at, NIL, -motor.spin * turning)


def _held(placed: Placed, equation: Equation) -> Iterator[Action]:
    """Action of the multiplier of an equation: along its variables, or at the contact of a
    transmission's parts.
    """
    declared, reported = placed.declared, placed.reported
    output = Output("multiplier", equation.name)
    multiplier, name = reported.outputs[output], str(output)
    for touch in equation.touching(partial(stacked, placed, equation)):
        for part in actions(touch, placed, multiplier):
            yield Action(name, *part)
    if equation.touches:
        return
    forces = multiplier * equation.slopes_at(stacked(placed, equation), reported.t)
    for entry, force in zip(equation.entries, forces, strict=True):
        if entry.kind == "coordinate":
            joint = declared.joints[entry.part.partition(":")[0]]
            at, acts = placed.pin(joint.name)[0], placed.along(entry.part, force)
            yield Action(name, joint.child.body, at, *acts, joint.parent.body)
        elif entry.kind == "direction":
            yield Action(name, entry.part, placed.bodies[entry.part].at, NIL, force[None])
        else:
            push = np.array([force if entry.kind == x else 0.0 * force for x in reported.lines])
            at = placed.bodies[entry.part].point(entry.point)[0]
            yield Action(name, entry.part, at, push, NIL)


def _sums(placed: Placed, acting: Sequence[Action], centres: Mapping[str, Array]) -> _Sums:
    """Sums of the actions on the bodies."""
    reported, nothing = placed.reported, np.zeros_like(placed.reported.t)
    force, moment = (
        {name: np.zeros((len(axes), nothing.size)) for name in centres}
        for axes in (reported.lines, reported.turns)
    )
    found = _Sums(force, moment, *[nothing] * 5)
    for act in acting:
        push, twist = act.sizes
        for body, sign in act.moving:
            motion = placed.bodies[body]
            turning = cross(act.at - centres[body][0], act.force) + act.couple
            force[body] += sign * act.force
            moment[body] += sign * turning
            found.bear(push, twist, placed.declared.size)
            if act.works:
                speed, (rate, _) = motion.speed_at(act.at), motion.spin
                power = dot(speed, act.force) + dot(rate, act.couple)
                found.power = found.power + sign * power
                found.flow = found.flow + size(speed) * push + size(rate) * twist
    return found


def _weight(placed: Placed, body: str, reach: float) -> Array:
    """The inertia of a body and its weight [N], none against another: of its origin, of what turns
    about it, and of uniform motion, whose accelerations are rounding of speed^2 / size.
    """
    _, change, rate, acceleration = placed.bodies[body].sizes
    weight = math.hypot(*placed.declared.gravity) + placed.rates[1] ** 2 / placed.declared.size
    inertial = change + (rate**2 + acceleration) * reach + weight
    return np.asarray(placed.declared.bodies[body].whole.mass * inertial)


def _unlike(placed: Placed) -> Array:
    """Difference between reactions on the joints' own axes and those in ground axes: forces, and
    moments over the size.
    """
    reported, worst = placed.reported, np.zeros_like(placed.reported.t)
    for name, joint in placed.declared.joints.items():
        if Output("reaction", name, "fu") in reported.outputs:
            axes = turn(placed.ends(name)[0].axes, constant(joint.triad))
            both = (reported.acts("reaction", name, x) for x in ("xyz", "uvw"))
            for there, own, arm in zip(*both, (1.0, placed.declared.size), strict=True):
                worst = np.maximum(worst, size(there - turn(axes, own)) / arm)
    return worst


def _ends(placed: Placed, acting: Sequence[Action], scale: float) -> Residuals:
    """Return by how much sections at the bases of links differ from the opposite of all that acts
    there [N], and the largest force of the mechanism.

    ``scale`` is the largest force of the balance: links that bear nothing have rounding of that.
    Rounding of places, which turns short links most, is taken off.
    """
    declared, reported = placed.declared, placed.reported
    worst = np.zeros_like(reported.t)
    blurred = placed.reported.coarseness * declared.extent
    for link, law in reported.laws.items():
        inside, twisted = reported.inside(link)
        force, moment, flow = _before(placed, link, acting, law.slack * law.length)
        flow = np.maximum(flow, _weight(placed, link, law.length))
        worst = np.maximum(worst, size(force + inside) / (1.0 + blurred / law.length))
        worst = np.maximum(worst, size(moment + twisted) / (declared.size + blurred))
        scale = max(scale, float(np.max(flow)))
    return worst, scale


def _before(
    placed: Placed, link: str, acting: Sequence[Action], edge: float
) -> tuple[Array, Array, Array]:
    """The force and the moment about a link's base, in its axes, of all that acts at its base or
    before it; and the largest.
    """
    motion, largest = placed.bodies[link], np.zeros_like(placed.reported.t)
    force = moment = NIL
    for act in acting:
        if not (sign := act.sign_on(link)):
            continue
        push, twist = act.sizes
        largest = np.maximum(largest, push + twist / placed.declared.size)
        arm = act.at - motion.at
        here = np.where(dot(motion.axes[0], arm) <= edge, sign, 0.0)
        force = force + here * act.force
        moment = moment + here * (cross(arm, act.force) + act.couple)
    return resolve(motion.axes, force), resolve(motion.axes, moment), largest
