"""Newton-Euler for every body, laws of loads, the power of all that does work, and sections at the
bases of links.

All are from reported forces. Multipliers act along what stands in their equation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np

from ...base.quantities import Output
from ...model.description import Description, DriveNumbers
from ...model.stated import Equation
from .closure import Residuals
from .contacts import actions, sense
from .instant_vectors import NIL, Axes, Scalar, Vector, less, product, total
from .load_laws import off_laws
from .placing import Motion, Placed
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
    at: Vector
    force: Vector
    couple: Vector
    against: str = "ground"
    works: bool = True

    @property
    def moving(self) -> Iterator[tuple[str, bool]]:
        """The bodies but for the ground, and whether they bear the opposite."""
        return (
            (body, opposite)
            for body, opposite in ((self.body, False), (self.against, True))
            if body != "ground"
        )

    def sign_on(self, body: str) -> float:
        """Return 1 for the body, -1 for the one that bears the opposite, and 0 for any other."""
        return 1.0 if body == self.body else -1.0 if body == self.against else 0.0

    @cached_property
    def sizes(self) -> tuple[Scalar, Scalar]:
        """The sizes of force and couple."""
        return self.force.size, self.couple.size


@dataclass(eq=False)
class _Sums:
    """Sums of actions: forces on each body and their moments about its centre, and the power of
    all.

    Beside it sizes, none against another: ``largest`` of one action, ``pushes`` and ``twists`` of
    all, and ``flow`` of powers.
    """

    force: dict[str, Vector] = field(default_factory=dict)
    moment: dict[str, Vector] = field(default_factory=dict)
    power: Scalar = 0.0
    largest: Scalar = 0.0
    pushes: Scalar = 0.0
    twists: Scalar = 0.0
    flow: Scalar = 0.0

    def bear(self, push: Scalar, twist: Scalar, size: float) -> None:
        """Take a force and a couple into the sizes; ``size`` is the mechanism's."""
        self.largest = np.maximum(self.largest, total(push, twist / size))
        self.pushes, self.twists = total(self.pushes, push), total(self.twists, twist)


def forces_reported(placed: Placed) -> bool:
    """Return whether every force that acts on the bodies is reported, and the equations along which
    multipliers act are known.
    """
    declared, outputs = placed.declared, placed.reported.outputs
    if len(placed.stated.equations) < len(declared.multipliers):
        return False
    needed = [*forces_needed(declared)]
    needed += [output for output in outputs if output.group in ("reaction", "load")]
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
        name: placed.bodies[name].point(Vector(*body.whole.centre))
        for name, body in placed.declared.bodies.items()
    }
    sums = _sums(placed, acting, centres)
    worst, power = np.zeros_like(placed.reported.t), sums.power
    gravity, size = Vector(*placed.declared.gravity), placed.declared.size
    for name, body in placed.declared.bodies.items():
        motion = placed.bodies[name]
        (_, speed, change) = centres[name]
        inertia = Axes.of(body.whole.inertia)
        inertial = body.whole.mass * (change - gravity)
        spin = motion.axes.turn(inertia.turn(motion.axes.resolve(motion.rate)))
        gains = motion.axes.turn(inertia.turn(motion.axes.resolve(motion.acceleration)))
        turning, rate = gains + motion.rate.cross(spin), motion.sizes[2]
        weight = _weight(placed, name, Vector(*body.whole.centre).size)
        sums.bear(weight, gains.size + rate * spin.size, size)
        worst = np.maximum(worst, (sums.force.get(name, NIL) - inertial).size)
        if placed.declared.oriented(name):
            worst = np.maximum(worst, (sums.moment.get(name, NIL) - turning).size / size)
        power = power - speed.dot(inertial) - motion.rate.dot(turning)
        sums.flow = sums.flow + speed.size * weight + rate * turning.size
    worst = np.maximum(worst, _unlike(placed))
    turned, fastest, _ = placed.rates
    # Reported digits leave open places, which give arms, and the joints' rates, of which the rates
    # of bodies are sums.
    largest = sums.largest * (1.0 + placed.reported.coarseness * placed.declared.extent / size)
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
        at, child, parent = placed.pins[name][0], joint.child.body, joint.parent.body
        yield Action(
            f"reaction:{name}",
            child,
            at,
            reported.force("reaction", name),
            reported.force("reaction", name, "m"),
            parent,
            works=False,
        )
        # Near gimbal lock couples along coordinates are large, and all together what the joint
        # needs.
        force, couple, driven = NIL, NIL, False
        for axis in joint.axes:
            if (effort := reported.outputs.get(Output("effort", axis.coordinate))) is not None:
                along, driven = placed.along(name, axis, effort), True
                force, couple = force + along[0], couple + along[1]
        if driven:
            yield Action(f"effort:{name}", child, at, force, couple, parent)
    for name, load in declared.loads.items():
        force, couple = reported.force("load", name), reported.force("load", name, "m")
        for point, sign in zip(load.points, (1.0, -1.0), strict=False):
            # Friction is where the joint's child is, on both.
            place = load.points[0] if load.friction is not None else point
            at = placed.bodies[place.body].point(Vector(*place.at))[0]
            yield Action(f"load:{name}", point.body, at, sign * force, sign * couple)
    for name, motor in declared.motors.items():
        yield from _of_rotor(placed, f"drive:{name}", motor)
    for equation in placed.stated.equations:
        yield from _held(placed, equation)


def _of_rotor(placed: Placed, name: str, motor: DriveNumbers) -> Iterator[Action]:
    """Action of a drive's rotor on the bodies of its joint, by its acceleration."""
    joint = placed.declared.joints[motor.coordinate]
    at, near = placed.pins[joint.name][0], placed.bodies[joint.parent.body]
    rate, change = (f(joint.name) for f in (placed.reported.rate, placed.reported.acceleration))
    about = near.axes.turn(Vector(*joint.axes[0].direction))
    taken = motor.reflected * change + motor.spin * about.dot(near.acceleration)
    acts = placed.along(joint.name, joint.axes[0], -taken)
    yield Action(name, joint.child.body, at, *acts, joint.parent.body)
    turning = change * about + rate * near.rate.cross(about)
    yield Action(name, joint.parent.body, at, NIL, -motor.spin * turning)


def _held(placed: Placed, equation: Equation) -> Iterator[Action]:
    """Action of the multiplier of an equation: along its variables, or at the contact of a
    transmission's parts.
    """
    declared, reported = placed.declared, placed.reported
    output = Output("multiplier", equation.name)
    multiplier, name = reported.outputs[output], str(output)
    for touch in equation.touching(partial(stacked, placed, equation)):
        for part in actions(
            touch, placed.bodies[touch.carrier], multiplier, sense(touch, declared, reported)
        ):
            yield Action(name, *part)
    if equation.touches:
        return
    places, moving, _ = stacked(placed, equation)
    forces = multiplier * equation.slopes_at(places, moving, reported.t)
    axes = {
        axis.coordinate: (joint_name, axis)
        for joint_name, joint in declared.joints.items()
        for axis in joint.axes
    }
    for entry, force in zip(equation.entries, forces, strict=True):
        if entry.kind == "coordinate":
            joint_name, axis = axes[entry.part]
            joint = declared.joints[joint_name]
            yield Action(
                name,
                joint.child.body,
                placed.pins[joint_name][0],
                *placed.along(joint_name, axis, force),
                joint.parent.body,
            )
        elif entry.kind == "direction":
            couple = Vector(0.0, 0.0, force)
            yield Action(name, entry.part, placed.bodies[entry.part].at, NIL, couple)
        else:
            push = Vector(*(force if entry.kind == x else 0.0 for x in "xyz"))
            at = placed.bodies[entry.part].point(Vector(*entry.point))[0]
            yield Action(name, entry.part, at, push, NIL)


def _sums(placed: Placed, acting: Sequence[Action], centres: Mapping[str, Motion]) -> _Sums:
    """Sums of the actions on the bodies."""
    found, size = _Sums(), placed.declared.size
    for act in acting:
        push, twist = act.sizes
        for body, opposite in act.moving:
            motion = placed.bodies[body]
            force, moment = found.force.get(body, NIL), found.moment.get(body, NIL)
            turning = (act.at - centres[body][0]).cross(act.force) + act.couple
            found.force[body] = force - act.force if opposite else force + act.force
            found.moment[body] = moment - turning if opposite else moment + turning
            found.bear(push, twist, size)
            if act.works:
                speed = motion.speed_at(act.at)
                power = total(speed.dot(act.force), motion.rate.dot(act.couple))
                found.power = less(found.power, power) if opposite else total(found.power, power)
                found.flow = total(
                    found.flow, total(product(speed.size, push), product(motion.sizes[2], twist))
                )
    return found


def _weight(placed: Placed, body: str, reach: float) -> Scalar:
    """The inertia of a body and its weight [N], none against another: of its origin, of what turns
    about it, and of uniform motion, whose accelerations are rounding of speed^2 / size.
    """
    _, change, rate, acceleration = placed.bodies[body].sizes
    weight = Vector(*placed.declared.gravity).size + placed.rates[1] ** 2 / placed.declared.size
    return placed.declared.bodies[body].whole.mass * (
        change + (rate**2 + acceleration) * reach + weight
    )


def _unlike(placed: Placed) -> Scalar:
    """Difference between reactions on the joints' own axes and those in ground axes: forces, and
    moments over the size.
    """
    reported, worst = placed.reported, 0.0
    for name, joint in placed.declared.joints.items():
        if Output("reaction", name, "fu") in reported.outputs:
            axes = placed.ends(name)[0].axes.carry(Axes.of(joint.triad))
            for letter, arm in (("f", 1.0), ("m", placed.declared.size)):
                there, anchor = (
                    reported.force("reaction", name, letter, components)
                    for components in ("xyz", "uvw")
                )
                worst = np.maximum(worst, (there - axes.turn(anchor)).size / arm)
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
        worst = np.maximum(worst, (force + inside).size / (1.0 + blurred / law.length))
        worst = np.maximum(worst, (moment + twisted).size / (declared.size + blurred))
        scale = max(scale, float(np.max(flow)))
    return worst, scale


def _before(
    placed: Placed, link: str, acting: Sequence[Action], edge: float
) -> tuple[Vector, Vector, Scalar]:
    """The force and the moment about a link's base, in its axes, of all that acts at its base or
    before it; and the largest.
    """
    motion, force, moment, largest = placed.bodies[link], NIL, NIL, 0.0
    for act in acting:
        if not (sign := act.sign_on(link)):
            continue
        push, twist = act.sizes
        largest = np.maximum(largest, total(push, twist / placed.declared.size))
        arm = act.at - motion.at
        there = motion.axes.x.dot(arm)
        if not np.any(there <= edge):
            continue
        here = np.where(there <= edge, sign, 0.0)
        force = force + here * act.force
        moment = moment + here * (arm.cross(act.force) + act.couple)
    return motion.axes.resolve(force), motion.axes.resolve(moment), largest
