"""Newton-Euler for every body, the power of all that does work, and sections at the bases of links, from reported forces.

What acts along a joint's coordinate does no work along the others: along a slide a force at the joint's point on the child, about
one of several axes a couple at right angles to the other axes. Multipliers act along what stands in their equation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output
from ..declare.declared import Equation
from .digits import Digits
from .placing import Moving, Placed
from .touching import actions, sense
from .unplaced import stacked
from .vectors import NIL, Axes, Scalar, Vector


@dataclass(frozen=True, eq=False)
class Action:
    """A force and a couple on a body at a place, in ground axes, and whether they do work."""

    body: str
    at: Vector
    force: Vector
    couple: Vector
    works: bool = True

    @cached_property
    def sizes(self) -> tuple[Scalar, Scalar]:
        """The sizes of both."""
        return self.force.size, self.couple.size


@dataclass(eq=False)
class _Sums:
    """Forces on a body and their moments about its centre, added up."""

    force: Vector = NIL
    moment: Vector = NIL


@dataclass(eq=False)
class _Sizes:
    """How large forces, couples, and powers are, none against another: the largest of a body, and all added up."""

    largest: Scalar = 0.0
    pushes: Scalar = 0.0
    twists: Scalar = 0.0
    power: Scalar = 0.0
    flow: Scalar = 0.0
    bodies: dict[str, _Sums] = field(default_factory=dict)

    def bear(self, push: Scalar, twist: Scalar, size: float) -> None:
        """Take a force and a couple into the sizes; ``size`` is the mechanism's."""
        self.largest = np.maximum(self.largest, push + twist / size)
        self.pushes, self.twists = self.pushes + push, self.twists + twist


def forces_reported(placed: Placed) -> bool:
    """Whether every force that acts on the bodies is reported, and the equations along which multipliers act are known."""
    declared, outputs = placed.declared, placed.reported.outputs
    if len(declared.equations) < len(declared.multipliers):
        return False
    needed = [Output("reaction", name, "fx") for name in declared.joints]
    needed += [Output("load", name, "fx") for name in declared.loads]
    needed += [output for output in outputs if output.group in ("reaction", "load")]
    needed += [Output("effort", name) for name in declared.drives]
    needed += [Output("multiplier", name) for name in declared.multipliers]
    return all(output in outputs and np.isfinite(outputs[output]).all() for output in needed)


def balance(placed: Placed, digits: Digits) -> dict[str, tuple[Array, float]]:
    """The residuals of forces, each with what it is to be compared with."""
    acting = list(_acting(placed))
    sizes = _sums(placed, acting)
    worst, power = np.zeros_like(placed.reported.t), sizes.power
    gravity, size = Vector(*placed.declared.gravity), placed.declared.size
    for name, body in placed.declared.bodies.items():
        motion, sums = placed.bodies[name], sizes.bodies.get(name, _Sums())
        centre, inertia = Vector(*body.centre), Axes.of(body.inertia)
        _, speed, change = motion.point(centre)
        inertial = body.mass * (change - gravity)
        spin = motion.axes.turn(inertia.turn(motion.axes.resolve(motion.rate)))
        gains = motion.axes.turn(inertia.turn(motion.axes.resolve(motion.acceleration)))
        turning = gains + motion.rate.cross(spin)
        weight = _weight(placed, name, centre.size)
        sizes.bear(weight, gains.size + motion.rate.size * spin.size, size)
        worst = np.maximum(worst, (sums.force - inertial).size)
        if placed.declared.oriented(name):
            worst = np.maximum(worst, (sums.moment - turning).size / size)
        power = power - speed.dot(inertial) - motion.rate.dot(turning)
        sizes.flow = sizes.flow + speed.size * weight + motion.rate.size * turning.size
    worst = np.maximum(worst, _unlike(placed))
    turned, fastest, _ = placed.rates
    # Reported digits leave open places, which give arms, and the joints' rates, of which the rates of bodies are sums.
    largest = sizes.largest * (1.0 + digits.coarseness * placed.declared.extent / size)
    flow = sizes.flow + digits.least * fastest + digits.coarseness * (sizes.pushes * fastest + sizes.twists * turned)
    found = {
        "balance": (worst, max(float(np.max(largest)), digits.least)),
        "power": (np.abs(power), float(np.max(flow))),
    }
    return found | ({"ends": _ends(placed, acting, digits)} if placed.reported.laws else {})


def _acting(placed: Placed) -> Iterator[Action]:
    """Every force of joints, drives, loads and equations."""
    reported, declared = placed.reported, placed.declared
    for name, joint in declared.joints.items():
        child = placed.ends(name)[1]
        at = child.point(Vector(*joint.child.at))[0]
        reaction = Action(joint.child.body, at, reported.force("reaction", name), reported.force("reaction", name, "m"), False)
        yield from (reaction, reaction.back(joint.parent.body))
        # Near gimbal lock couples along coordinates are large, and all together what the joint needs.
        force, couple = NIL, NIL
        for axis in joint.axes:
            if (effort := reported.outputs.get(Output("effort", axis.coordinate))) is not None:
                along = _along(placed, name, axis.coordinate, effort)
                force, couple = force + along[0], couple + along[1]
        if force is not NIL or couple is not NIL:
            effort_of_all = Action(joint.child.body, at, force, couple)
            yield from (effort_of_all, effort_of_all.back(joint.parent.body))
    for name, load in declared.loads.items():
        force, couple = reported.force("load", name), reported.force("load", name, "m")
        for point, sign in zip(load.points, (1.0, -1.0), strict=False):
            # Friction is where the joint's child is, on both.
            place = load.points[0] if load.friction is not None else point
            at = placed.bodies[place.body].point(Vector(*place.at))[0]
            yield Action(point.body, at, sign * force, sign * couple)
    for equation in declared.equations:
        yield from _held(placed, equation)


def _along(placed: Placed, joint: str, coordinate: str, effort: Array) -> tuple[Vector, Vector]:
    """The force and the couple of an effort along a coordinate, on the joint's child at its point."""
    near, numbers = placed.ends(joint)[0], placed.declared.joints[joint]
    axis = next(axis for axis in numbers.axes if axis.coordinate == coordinate)
    if axis.kind == "slide":
        return effort * near.axes.turn(Vector(*axis.direction)), NIL
    about = placed.relatives[joint].about
    turns = [near.axes.turn(direction) for direction in about.values()]
    return NIL, effort * _reciprocal(turns, [*about].index(coordinate))


def _reciprocal(axes: Sequence[Vector], number: int) -> Vector:
    """The couple that does a unit of work for a turn about one of axes, and none for turns about the others."""
    if len(axes) < 3:
        return axes[number]
    first, second, third = (axes[(number + k) % 3] for k in range(3))
    across = second.cross(third)
    with np.errstate(all="ignore"):
        return (1.0 / np.asarray(first.dot(across))) * across


def _held(placed: Placed, equation: Equation) -> Iterator[Action]:
    """What the multiplier of an equation does: along whatever stands in it, or where the parts of a transmission touch."""
    declared, reported = placed.declared, placed.reported
    multiplier = reported.outputs[Output("multiplier", equation.name)]
    for touch in equation.touches:
        for part in actions(touch, placed.bodies[touch.carrier], multiplier, sense(touch, declared, reported)):
            yield Action(*part)
    if equation.touches:
        return
    places, moving, _ = stacked(placed, equation)
    forces = multiplier * equation.slopes_at(places, moving, reported.t)
    joints = {axis.coordinate: name for name, joint in declared.joints.items() for axis in joint.axes}
    for entry, force in zip(equation.entries, forces, strict=True):
        if entry.kind == "coordinate":
            joint = declared.joints[joints[entry.part]]
            at = placed.bodies[joint.child.body].point(Vector(*joint.child.at))[0]
            action = Action(joint.child.body, at, *_along(placed, joints[entry.part], entry.part, force))
            yield from (action, action.back(joint.parent.body))
        elif entry.kind == "direction":
            yield Action(entry.part, placed.bodies[entry.part].at, NIL, Vector(0.0, 0.0, force))
        else:
            push = Vector(*(force if entry.kind == x else 0.0 for x in "xyz"))
            yield Action(entry.part, placed.bodies[entry.part].point(Vector(*entry.point))[0], push, NIL)


def _sums(placed: Placed, acting: Sequence[Action]) -> _Sizes:
    """What acts on the bodies, added up."""
    found, size = _Sizes(), placed.declared.size
    middles = {name: placed.bodies[name].point(Vector(*body.centre))[0] for name, body in placed.declared.bodies.items()}
    for act in acting:
        if act.body == "ground":
            continue
        motion, sums = placed.bodies[act.body], found.bodies.setdefault(act.body, _Sums())
        sums.force = sums.force + act.force
        sums.moment = sums.moment + (act.at - middles[act.body]).cross(act.force) + act.couple
        push, twist = act.sizes
        found.bear(push, twist, size)
        if act.works:
            speed = motion.speed_at(act.at)
            found.power = found.power + speed.dot(act.force) + motion.rate.dot(act.couple)
            found.flow = found.flow + speed.size * push + motion.rate.size * twist
    return found


def _weight(placed: Placed, body: str, reach: float) -> Scalar:
    """The inertia of a body and its weight [N], none against another: of its origin, and of what turns about it."""
    motion = placed.bodies[body]
    turning = motion.rate.size**2 + motion.acceleration.size
    return placed.declared.bodies[body].mass * (motion.change.size + turning * reach + Vector(*placed.declared.gravity).size)


def _unlike(placed: Placed) -> Scalar:
    """By how much reactions on the joints' own axes are other than those in ground axes: forces, and moments over the size."""
    reported, worst = placed.reported, 0.0
    for name, joint in placed.declared.joints.items():
        if Output("reaction", name, "fu") in reported.outputs:
            axes = placed.ends(name)[0].axes.carry(Axes.of(joint.triad))
            for letter, arm in (("f", 1.0), ("m", placed.declared.size)):
                there, own = (reported.force("reaction", name, letter, components) for components in ("xyz", "uvw"))
                worst = np.maximum(worst, (there - axes.turn(own)).size / arm)
    return worst


def _ends(placed: Placed, acting: Sequence[Action], digits: Digits) -> tuple[Array, float]:
    """A link's section at its base is the opposite of all that acts on it there; beside the largest force on a link.

    And beside what the rounding of places leaves open, which turns short links most.
    """
    declared, reported = placed.declared, placed.reported
    worst, scale, blurred = np.zeros_like(reported.t), digits.least, digits.coarseness * declared.extent
    for link, law in reported.laws.items():
        inside, twisted = reported.inside(link)
        own = [act for act in acting if act.body == link]
        force, moment = _before(placed.bodies[link], own, law.slack * law.length)
        flow = _weight(placed, link, law.length)
        for act in own:
            push, twist = act.sizes
            flow = np.maximum(flow, push + twist / declared.size)
        worst = np.maximum(worst, (force + inside).size / (1.0 + blurred / law.length))
        worst = np.maximum(worst, (moment + twisted).size / (declared.size + blurred))
        scale = max(scale, float(np.max(flow)))
    return worst, scale


def _before(motion: Moving, acting: Sequence[Action], edge: float) -> tuple[Vector, Vector]:
    """The force in a link's axes, and the moment about its base, of all that acts at its base or before it."""
    force, moment = NIL, NIL
    for act in acting:
        arm, push = motion.under(act.at), motion.axes.resolve(act.force)
        here = np.where(arm.x <= edge, 1.0, 0.0)
        force = force + here * push
        moment = moment + here * (arm.cross(push) + motion.axes.resolve(act.couple))
    return force, moment
