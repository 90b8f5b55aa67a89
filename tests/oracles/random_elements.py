"""Machine elements of random mechanisms: gears, racks, belts, cams, cylinders and bearings, joined
to what is there, and what their contacts do to the oracle's bodies.

Each takes no freedom: it brings a body, and holds it. Forces at a pitch point, of strands and of
contacts are written here from how the parts lie, by vectors between places; nothing of the package
is used.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import oracle
from random_draft import Draft, Place, Spot
from random_formula import Formula, Measure, axis_of, seen
from random_growth import MisfitError, anything, attempt, lead

_AT_REST = 1e-3
"""Rates below are those of parts at rest, of which losses tell nothing [rad/s]."""


@dataclass(frozen=True)
class Contact:
    """What ties two bodies by a force: its equation, what a unit of the force does, and what
    presses besides.

    ``presses(place, force)`` lists forces that a multiplier of this size brings with it;
    ``outputs(force)`` are those that the package tells. ``turning`` are the ends of the axes about
    which both turn, and ``lost`` the share of power that is.
    """

    formula: Formula
    acts: Callable
    presses: Callable | None = None
    outputs: Callable = lambda force: {}
    ends: tuple[Spot, ...] = ()
    carrier: str = ""
    radii: tuple[float, float] = (0.0, 0.0)
    efficiency: float = 1.0

    def extra(self, name: str, t: float) -> oracle.Extra:
        """For the oracle."""
        return oracle.Extra(
            name,
            lambda place: self.formula.jet(place, t),
            self.acts,
            self.pressing if self.presses or self.ends else None,
        )

    def pressing(self, place, force: float):
        """What acts besides a multiplier of this size."""
        parts = self.presses(place, force) if self.presses else []
        return parts + (self.losses(place, force) if self.efficiency < 1.0 else [])

    def rates(self, place) -> tuple[float, ...]:
        """How fast both turn on the carrier."""
        own = place((self.carrier, 0.0, 0.0))[2].d
        return tuple(place(end.point)[2].d - own for end in self.ends)

    def losses(self, place, force: float):
        """The couple between two gears that takes the share of the power that goes in: of the power
        of the one that drives, what comes out at the other is the rest.
        """
        first, second = self.rates(place)
        power, keeps = force * self.radii[0] * first, self.efficiency
        couple = (
            -power * (1 - keeps) / (second - keeps * first)
            if power < 0.0
            else power * (1 - keeps) / (keeps * second - first)
        )
        points = [end.point for end in self.ends]
        return [(points[0], 0.0, 0.0, couple), (points[1], 0.0, 0.0, -couple)]


def add(d: Draft, rng: np.random.Generator) -> None:
    """Join up to three elements, by a generator of their own, so that the rest is drawn as
    without.
    """
    drawn, d.rng = d.rng, rng
    parametric, d.parametric = d.parametric, 0.0  # what is placed beside others fits one value
    if d.chance(0.4):
        for _ in range(d.choose(1, 2, 3)):
            attempt(d, d.choose(*PARTS, weights=list(PARTS.values())), takes=0)
    d.rng, d.parametric = drawn, parametric


def lose(d: Draft, rng: np.random.Generator, motion: oracle.Result) -> None:
    """Let gears that turn lose some of their power."""
    place = d.oracle(d.start).places(motion)
    for name, contact in d.contacts.items():
        if not contact.ends or rng.random() < 0.6:
            continue
        first, second = contact.rates(place)
        if min(abs(first), abs(second), abs(first - second)) > _AT_REST:
            share = float(f"{rng.uniform(0.8, 0.99):.4g}")
            d.contacts[name] = replace(contact, efficiency=share)
            i = next(i for i, line in enumerate(d.lines) if f'"{name}"' in line)
            before, _, after = d.lines[i].rpartition(")")
            d.lines[i] = f"{before}, efficiency={share!r}){after}"


# Parts


def _axis(d: Draft, *, grounded: bool = False) -> tuple[str, Spot, str]:
    """A pin about which a body turns on another: the pin, its point of the body, and the carrier.

    Of those alone that no parameter moves: what is placed beside one would not fit other values.
    """
    found = []
    fixed = {
        name
        for name in [*d.bodies, *d.joints]
        for line in d.lines
        if f'("{name}"' in line and not re.search(r"\bp\d+\b", line)
    }
    for name, joint in d.joints.items():
        ends = joint.parent, joint.child
        if name not in fixed or name not in d.movable() or joint.slides:
            continue
        for (body, x, y), (carrier, *_) in (ends, ends[::-1]):
            if body != "ground" and {body, carrier} <= {*fixed, "ground"}:
                found.append((name, Spot(body, _written(d, body, x, y), x, y), carrier))
    found = [one for one in found if not grounded or d.joints[one[0]].parent[0] == "ground"]
    if not found:
        raise MisfitError
    return found[int(d.rng.integers(len(found)))]


def _written(d: Draft, body: str, x: float, y: float) -> str:
    if not y and x in (0.0, d.bodies[body].length):
        return f"{body}.tip" if x else body
    return f"{body}.at({x!r}, {y!r})"


def _turned(d: Draft, pin: str, body: str) -> str:
    """The angle of a pin's body on the other, by the pin's coordinate ``{0}``."""
    return "{0}" if d.joints[pin].child[0] == body else "-{0}"


def _wheel(d: Draft, radius: float) -> str:
    """A body that turns about its base: a disc, or any link."""
    if d.chance(0.5):
        return d.link(d.between(0.05, 0.2))
    name, mass = d.new("b"), d.between(0.1, 2.0)
    d.lines.append(f'{name} = wheel(m, "{name}", radius={radius!r}, mass={mass!r})')
    d.bodies[name] = oracle.Body(name, mass, radius, inertia=mass * radius**2 / 2)
    return name


def _beside(d: Draft, carrier: str, centre: Place, distance: float) -> Spot:
    """A point of a carrier so far from a place."""
    ways = [d.angle() for _ in range(3)]
    along = d.pose(carrier)[2]
    for way in [*ways, along, along + math.pi]:
        at = centre[0] + distance * math.cos(way), centre[1] + distance * math.sin(way)
        if (spot := d.meet(carrier, at)) is not None:
            return spot
    raise MisfitError


def _second_wheel(d: Draft, distance: float, radius: float):
    """An axis that is there, and a wheel that turns on its carrier so far beside it: (pin, centre,
    pin, centre, carrier).
    """
    pin, first, carrier = _axis(d)
    hub = _beside(d, carrier, d.place(first), distance)
    body = _wheel(d, radius)
    second = d.base(body)
    d.put(second, d.place(hub), d.angle())
    return pin, first, d.pin(hub, second), second, carrier


def _couple(d: Draft, name: str, pins, bodies, factors) -> tuple[Formula, float]:
    """The equation that sums both turns, each times its factor, and its value in the posture."""
    names, terms = {}, []
    for pin, body, factor in zip(pins, bodies, factors, strict=True):
        q = f"{name}_{len(names)}"
        names[q] = Measure("coordinate", d.joints[pin])
        turn = _turned(d, pin, body).format(q) if not d.joints[pin].slides else q
        terms.append(f"{factor!r} * ({turn})")
    text = " + ".join(terms)
    offset = float(d.formula(text, names).jet(d.posture_place(), d.start).v)
    return d.formula(f"{text} - ({offset!r})", names), offset


def _after(d: Draft, *joints: str) -> str:
    """A remark that keeps a line behind those that declare what it needs."""
    return f"  # of {', '.join(joints)}"


def _centres(place, first: Spot, second: Spot):
    """Unit vector from one centre to the other, and the one left of it."""
    (ax, ay, _), (bx, by, _) = place(first.point), place(second.point)
    dx, dy = bx.v - ax.v, by.v - ay.v
    length = math.hypot(dx, dy)
    return (dx / length, dy / length), (-dy / length, dx / length), length


def gear(d: Draft) -> None:
    """A wheel with teeth in those of a body that turns, outside or in a ring."""
    inside, r1 = d.chance(0.3), d.between(0.03, 0.1)
    r2 = d.between(0.03, 0.1) if not inside else r1 * d.choose(2.5, 0.4)
    distance = abs(r1 - r2) if inside else r1 + r2
    pin, first, other, second, carrier = _second_wheel(d, distance, r2)
    name, angle = d.new("e"), d.between(10.0, 28.0)
    formula, offset = _couple(
        d, name, (pin, other), (first.body, second.body), (r1, -r2 if inside else r2)
    )
    d.lines.append(
        f'gears(m, "{name}", {first.text}, {second.text}, radii=({r1!r}, {r2!r}),'
        f' pressure_angle="{angle!r} deg", offset={offset!r}, carrier={_named(carrier)})'
        + _after(d, pin, other)
    )
    arm = -r1 if inside and r1 < r2 else r1
    off = -1.0 if not inside or r1 < r2 else 1.0  # off the teeth: a pinion inward, a ring outward
    force = teeth_between(first, second, abs(arm), math.copysign(1.0, arm), -off)
    d.contacts[name] = mesh(name, formula, force, angle, (first, second), carrier, (r1, r2))


def teeth_between(first: Spot, second: Spot, radius: float, sense: float, press: float) -> Callable:
    """What the force on a gear's teeth does, ``along`` the pitch circle forward and ``apart``: the
    pitch point lies from the first centre toward the second one, or off it where ``sense`` is
    negative. Teeth press the first gear off the pitch point, or toward it where ``press`` is
    negative.
    """

    def force(place, along: float, apart: float):
        e, n, length = _centres(place, first, second)
        e, n = (sense * e[0], sense * e[1]), (sense * n[0], sense * n[1])
        f = n[0] * along - press * apart * e[0], n[1] * along - press * apart * e[1]
        reach = radius * e[0] - sense * length * e[0], radius * e[1] - sense * length * e[1]
        return [
            (first.point, *f, radius * along),
            (second.point, -f[0], -f[1], -(reach[0] * f[1] - reach[1] * f[0])),
        ]

    return force


def mesh(name: str, formula: Formula, force: Callable, angle: float, *axes) -> Contact:
    """Teeth whose flanks lean by an angle [deg]: ``force(place, along, apart)`` lists what the
    force along the common tangent and the one that presses apart do.
    """
    steep = math.tan(math.radians(angle))
    return Contact(
        formula,
        lambda place: force(place, 1.0, 0.0),
        lambda place, size: force(place, 0.0, abs(size) * steep),
        lambda size: {f"{name}_tangential": size, f"{name}_radial": abs(size) * steep},
        *axes,
    )


def rack(d: Draft) -> None:
    """A bar that slides, with teeth in those of a body that turns."""
    pin, first, carrier = _axis(d)
    r, way, side = d.between(0.03, 0.1), d.angle(), d.choose(-1, 1)
    u = math.cos(way), math.sin(way)
    n = -side * u[1], side * u[0]
    x, y = d.place(first)
    ahead = d.between(-0.1, 0.1)
    at = x + r * n[0] + ahead * u[0], y + r * n[1] + ahead * u[1]
    bar = d.link(d.between(0.3, 0.5))
    on = d.at(bar, d.between(0.15, 0.25))
    d.put(on, at, math.remainder(way + d.choose(0.0, math.pi), math.tau))
    slide = lead(d, "prismatic", carrier, on, way)
    name, angle = d.new("e"), d.between(10.0, 28.0)
    # Of the pitch circle's way at the pitch point along the axis of sliding.
    formula, offset = _couple(d, name, (pin, slide), (first.body, bar), (r, float(side)))
    d.lines.append(
        f'gears(m, "{name}", {first.text}, {on.text}, radii={r!r},'
        f' pressure_angle="{angle!r} deg", offset={offset!r}, carrier={_named(carrier)})'
        + _after(d, pin, slide)
    )
    joint = d.joints[slide]

    def force(place, along: float, apart: float):
        ax, ay = (along.v for along in axis_of(joint, place))
        e = -side * ay, side * ax
        f = -e[1] * along - e[0] * apart, e[0] * along - e[1] * apart
        x, y, _ = place(first.point)
        body = (bar, *seen(place, bar, (x.v + r * e[0], y.v + r * e[1])))
        return [(first.point, *f, r * along), (body, -f[0], -f[1], 0.0)]

    d.contacts[name] = mesh(name, formula, force, angle)


def belt(d: Draft) -> None:
    """A wheel driven by a belt or a chain, open or crossed."""
    r1, r2, crossed = d.between(0.03, 0.1), d.between(0.03, 0.1), d.chance(0.4)
    distance = r1 + r2 + d.between(0.05, 0.2)
    pin, first, other, second, carrier = _second_wheel(d, distance, r2)
    preload = d.choose(0.0, d.between(0.1, 100.0))
    name, pins, bodies = d.new("e"), (pin, other), (first.body, second.body)
    formula, offset = _couple(d, name, pins, bodies, (r1, r2 if crossed else -r2))
    d.lines.append(
        f'belt(m, "{name}", {first.text}, {second.text}, radii=({r1!r}, {r2!r}),'
        f" preload={preload!r}, offset={offset!r}, crossed={crossed}, carrier={_named(carrier)})"
        + _after(d, pin, other)
    )

    def strands(place, tensions):
        """Pulls of the strand right of the line of centres, which turns the first wheel forward,
        and of the one left of it.
        """
        e, n, length = _centres(place, first, second)
        parts = []
        for side, tension in zip((-1, 1), tensions, strict=True):
            lean = (r1 + r2 if crossed else r1 - r2) / length
            up = math.sqrt(1 - lean * lean) * side
            out = lean * e[0] + up * n[0], lean * e[1] + up * n[1]
            far = -r2 if crossed else r2
            dx = length * e[0] + (far - r1) * out[0]
            dy = length * e[1] + (far - r1) * out[1]
            size = math.hypot(dx, dy)
            fx, fy = tension * dx / size, tension * dy / size
            parts += [
                (first.point, fx, fy, r1 * (out[0] * fy - out[1] * fx)),
                (second.point, -fx, -fy, -far * (out[0] * fy - out[1] * fx)),
            ]
        return parts

    def both(size):
        whole = max(2 * preload, abs(size))
        return {f"{name}_tight": (whole + abs(size)) / 2, f"{name}_slack": (whole - abs(size)) / 2}

    d.contacts[name] = Contact(
        formula,
        lambda place: strands(place, (0.5, -0.5)),
        lambda place, size: strands(place, [max(2 * preload, abs(size)) / 2] * 2),
        both,
    )


def cam(d: Draft) -> None:
    """A disc cam on a body that turns on the ground, and its follower: a roller or a knife edge
    that slides or swings.
    """
    pin, disc, _ = _axis(d, grounded=True)
    base, h = d.between(0.05, 0.1), d.between(0.002, 0.01)
    roller = d.choose(0.0, d.between(0.005, 0.02))
    first = d.coordinate(pin)
    phase, waves = d.between(-3.0, 3.0), d.choose(1, 2)
    law = f"{h!r} * (1.0 - cos({waves} * ({{0}} - ({phase!r}))))"
    rise = h * (1.0 - math.cos(waves * (first - phase)))
    slope = lambda q: h * waves * math.sin(waves * (q - phase))  # noqa: E731
    centre, q = d.place(disc), d.measured("coordinate", pin)
    (turn,) = q
    if d.chance(0.5):
        swings, held, lead, gap, posture = _slides(d, centre, base + roller, rise)
    else:
        swings, held, lead, gap, posture = _swings(d, centre, base + roller, rise)
    side = int(math.copysign(1, swings or 1.0))
    name = d.new("e")
    told = f", roller={roller!r}" if roller else ""
    d.lines.append(
        f'disc_cam(m, "{name}", {pin}, {lead}, lambda x: {law.format("x")},'
        f" base_radius={base!r}, point={held.text}{told}, side={side})"
    )
    names = q | posture
    formula = d.formula(f"{gap} - {side if swings else 1} * {law.format(turn)}", names)
    off = float(formula.jet(d.posture_place(), d.start).v)
    formula = d.formula(f"{formula.text} - ({off!r})", names)
    pivot = d.joints[lead].child

    def acts(place):
        """Along the normal of the curve that the roller's centre makes on the cam."""
        (cx, cy, _), (x, y, _) = place(disc.point), place(held.point)
        dx, dy = x.v - cx.v, y.v - cy.v
        change = slope(float(q[turn].jet(place).v))
        if swings:
            px, py, _ = place(pivot)
            mx, my = -(y.v - py.v) * side * change, (x.v - px.v) * side * change
        else:
            ax, ay = d.joints[lead].axis
            mx, my = ax * change, ay * change
        tx, ty = mx + dy, my - dx  # how the centre moves on the cam, by the cam's angle
        nx, ny = -ty, tx
        size = math.copysign(math.hypot(nx, ny), nx * dx + ny * dy)
        nx, ny = nx / size, ny / size
        return [
            (held.point, nx, ny, 0.0),
            (disc.point, -nx, -ny, -(dx * ny - dy * nx)),
        ]

    d.contacts[name] = Contact(formula, acts, None, lambda size: {f"{name}_force": size})


def _slides(d: Draft, centre: Place, prime: float, rise: float):
    """A follower on a line away from the cam: (0, its point, its joint, its height, measures)."""
    way, aside = d.angle(), d.choose(0.0, d.between(-0.02, 0.02))
    u = math.cos(way), math.sin(way)
    height = math.sqrt(prime**2 - aside**2) + rise
    at = centre[0] + height * u[0] - aside * u[1], centre[1] + height * u[1] + aside * u[0]
    if d.chance(0.4):
        held = d.mass_point(at, d.between(0.1, 1.0))
    else:
        body = d.link(d.between(0.1, 0.2))
        held = d.base(body)
        d.put(held, at, math.remainder(way, math.tau))
    origin = d.ground((centre[0] - aside * u[1], centre[1] + aside * u[0]))
    lead = d.line("prismatic", "ground", held, way, origin)
    names = d.measured("place", held)
    x, y = names
    return 0, held, lead, f"{u[0]!r} * {x} + {u[1]!r} * {y}", names


def _swings(d: Draft, centre: Place, prime: float, rise: float):
    """A follower about a pin of its own: (the sense of its swing, ...) as :func:`_slides`."""
    way, far, length = d.angle(), d.between(0.25, 0.35), d.between(0.2, 0.3)
    side, length = d.choose(-1, 1), max(length, far - 0.8 * prime)
    foot = centre[0] + far * math.cos(way), centre[1] + far * math.sin(way)
    least = math.acos((length**2 + far**2 - prime**2) / (2 * length * far))
    phi = way + math.pi + side * (least + rise)
    arm = d.link(length)
    d.put(d.base(arm), foot, math.remainder(phi, math.tau))
    lead = d.joint("revolute", d.ground(foot), d.base(arm))
    names = d.measured("direction", arm)
    (q,) = names
    return side, d.tip(arm), lead, q, names


def cylinder(d: Draft) -> None:
    """A cylinder between points of two bodies."""
    rear, front = d.spot(anything(d, points=True)), d.spot(anything(d, points=True))
    (x, y), (u, v) = d.place(rear), d.place(front)
    reach, way = math.dist((x, y), (u, v)), math.atan2(v - y, u - x)
    if rear.body == front.body or reach < 0.15:
        raise MisfitError
    name, closed = d.new("e"), float(f"{reach * d.rng.uniform(0.55, 0.9):.4g}")
    masses = [d.choose(0.0, d.between(0.1, 1.0)) for _ in range(2)]
    parts = [f"{name}_barrel", f"{name}_rod"]
    pins = [f"{name}_rear", f"{name}_front"]
    d.lines.append(
        f'{name}_made = cylinder(m, "{name}", {rear.text}, {front.text}, closed={closed!r},'
        f" bore=0.05, rod=0.02, barrel_mass={masses[0]!r}, rod_mass={masses[1]!r})"
    )
    d.lines.append(
        f"{', '.join(parts)}, {name} = {name}_made.barrel, {name}_made.rod, {name}_made.slide"
    )
    joints = (f'm.joints["{pin}"]' for pin in pins)
    d.lines.append(f"{', '.join(pins)} = {', '.join(joints)}  # of {name}_made")
    for body, mass, along in zip(parts, masses, (0.0, reach - closed), strict=True):
        d.bodies[body] = oracle.from_density(body, closed, lambda u, mass=mass: mass)
        d.limited.add(body)
        d.poses[body] = x + along * math.cos(way), y + along * math.sin(way), way
    barrel, rod = parts
    d.joints[pins[0]] = oracle.Joint(pins[0], "revolute", rear.point, (barrel, 0.0, 0.0))
    d.joints[name] = oracle.Joint(name, "prismatic", (barrel, 0.0, 0.0), (rod, 0.0, 0.0))
    d.joints[pins[1]] = oracle.Joint(pins[1], "revolute", (rod, closed, 0.0), front.point)


def bearings(d: Draft) -> None:
    """A shaft from the side, in a fixed and a floating bearing."""
    near = d.spot(anything(d))
    shaft, way = d.link(d.between(0.2, 0.5)), d.angle()
    length = d.bodies[shaft].length
    apart = float(f"{length * d.rng.uniform(0.4, 0.9):.4g}")
    own = d.pose(near.body)[2]
    axis = math.cos(way), math.sin(way)
    d.put(d.base(shaft), d.place(near), math.remainder(own + way, math.tau))
    far = (near.body, near.x + apart * axis[0], near.y + apart * axis[1])
    name = d.new("e")
    names = [f"{name}_fixed", f"{name}_floating"]
    d.lines.append(
        f'{name} = two_bearings(m, "{name}", {near.text}, {shaft}, {shaft}.at({apart!r}),'
        f" axis={axis!r})"
    )
    d.lines.append(f"{', '.join(names)} = {name}.fixed, {name}.floating")
    d.joints[names[0]] = oracle.Joint(names[0], "revolute", near.point, (shaft, 0.0, 0.0))
    d.joints[names[1]] = oracle.Joint(names[1], "slot", far, (shaft, apart, 0.0), axis=axis)
    d.stations.setdefault(shaft, []).append(apart)
    if near.body != "ground":
        d.stations.setdefault(near.body, []).append(far[1])


PARTS = {gear: 4, rack: 2, belt: 3, cam: 3, cylinder: 3, bearings: 1}


def _named(body: str) -> str:
    return "m.ground" if body == "ground" else body
