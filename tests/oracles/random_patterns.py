"""Patterns that are tied by gears, equations of a user's and non-holonomic rows, or grown; and the
list of all patterns.

As in :mod:`random_linkages`, each returns joints that may turn all the way round.
"""

from __future__ import annotations

import math

import random_linkages as linkages
from random_draft import Draft
from random_growth import attempt, dyad, frame, hang
from random_linkages import block, meeting


def planetary(d: Draft) -> list[str]:
    """An arm with planets, a sun that turns or is held, geared by joints' coordinates or by
    directions.
    """
    at, turned = frame(d)
    arm = d.link(d.between(0.1, 0.3))
    d.put(d.base(arm), at(0.0, 0.0), turned(d.angle()))
    main = d.pin(d.ground(at(0.0, 0.0)), d.base(arm))
    sun = block(d, at(0.0, 0.0))
    shaft = d.pin(d.ground(at(0.0, 0.0)), sun)
    for _ in range(d.choose(1, 2)):
        planet = block(d, d.place(d.tip(arm)))
        pin = d.pin(d.tip(arm), planet)
        if d.chance(0.5):
            d.gear(d.choose(shaft, main), pin, d.between(0.5, 3.0) * d.choose(-1, 1))
        else:
            names = {
                **d.measured("direction", planet.body),
                **d.measured("direction", sun.body),
                **d.measured("direction", arm),
            }
            p, s, a = names
            k = d.between(0.5, 2.0)
            d.constraint(d.held(f"({p} - {a}) + {k!r} * ({s} - {a})", names))
    return [main]


def geared_five_bar(d: Draft) -> list[str]:
    """Two cranks geared to each other, and two rods between them."""
    at, _ = frame(d)
    phi, psi, r = d.angle(), d.angle(), d.between(0.06, 0.12)
    elbows = [
        (r * math.cos(phi), r * math.sin(phi)),
        (0.4 + 0.8 * r * math.cos(psi), 0.8 * r * math.sin(psi)),
    ]
    knee = meeting(elbows[0], d.between(0.4, 0.5), elbows[1], d.between(0.4, 0.5), d.choose(-1, 1))
    joints, ends = [], []
    for foot, elbow in zip(((0.0, 0.0), (0.4, 0.0)), elbows, strict=True):
        crank, pin = d.bar(at(*foot), at(*elbow))
        near, far = d.bar(at(*elbow), at(*knee))
        joints.append(d.pin(d.ground(at(*foot)), crank))
        d.pin(pin, near)
        ends.append(far)
    d.pin(*ends)
    d.gear(*joints, d.choose(-1.0, 1.0, -0.5, d.between(-2, 2)))
    return joints[:1]


def led_arm(d: Draft) -> list[str]:
    """An arm of two or three links whose tip, or other points, are led by equations in time."""
    at, _ = frame(d)
    here, near, links = at(0.0, 0.0), d.ground(at(0.0, 0.0)), []
    for _ in range(d.choose(2, 3)):
        l, phi = d.between(0.3, 0.6), d.angle()
        there = (here[0] + l * math.cos(phi), here[1] + l * math.sin(phi))
        a, b = d.bar(here, there)
        d.pin(near, a)
        here, near = there, b
        links.append(a.body)
    for axis in range(2):
        spot = near if d.chance(0.6) else d.spot(d.choose(*links))
        names = d.measured("place", spot)
        x = list(names)[axis if d.chance(0.8) else 1 - axis]
        law = d.choose("0.2 * t", "0.1 * sin(3.0 * t)", "0.3 * t**2", "0.1 * (cos(2.0 * t) - 1.0)")
        held = d.held(f"{x} - {law}", names)
        attempt(d, lambda d, held=held: d.constraint(held), takes=1)
    return []


def rack(d: Draft) -> list[str]:
    """A wheel geared to a slide, and a rod on its rim."""
    at, turned = frame(d)
    wheel, slide = block(d, at(0.0, 0.0)), block(d, at(0.1, 0.3), turned(d.angle()))
    main = d.pin(d.ground(at(0.0, 0.0)), wheel)
    way = d.line("prismatic", "ground", slide, turned(d.choose(0.0, d.angle())))
    d.gear(*d.choose((main, way), (way, main)), d.between(0.2, 1.5) * d.choose(-1, 1))
    d.leads += d.choose([main], [way])
    return []


def cam(d: Draft) -> list[str]:
    """A follower that an equation ties to the angle of a cam."""
    at, turned = frame(d)
    wheel = block(d, at(0.0, 0.0))
    follower = d.mass_point(at(0.0, d.between(0.2, 0.4)), d.between(0.1, 1.0))
    main = d.pin(d.ground(at(0.0, 0.0)), wheel)
    way = d.line("prismatic", "ground", follower, turned(math.pi / 2))
    q, s = d.measured("coordinate", main), d.measured("coordinate", way)
    (a,), (b,) = q, s
    d.constraint(
        d.held(
            f"{b} - {d.between(0.02, 0.1)!r} * sin({a}) - {d.between(0.0, 0.03)!r} * cos(2.0 *"
            f" {a})",
            q | s,
        )
    )
    return [main]


def sleigh(d: Draft) -> list[str]:
    """A body on a skate that takes a curve: its motion is prescribed, the blade bears what one
    drive would.
    """
    at, turned = frame(d)
    cross = block(d, at(0.0, 0.0), turned(d.angle()))
    pivot = block(d, at(0.0, 0.0), turned(d.angle()))
    body = d.link(d.between(0.3, 0.6))
    d.put(d.base(body), at(0.0, 0.0), turned(0.0))
    x = d.line("prismatic", "ground", cross, turned(0.0), d.ground(at(0.0, 0.0)))
    y = d.line("prismatic", cross.body, pivot, turned(math.pi / 2), cross)
    turn = d.joint("revolute", pivot, d.base(body))
    w, r = d.between(0.3, 1.5) * d.choose(-1, 1), d.between(0.3, 2.0)
    t, first = f"{w!r} * (t - {d.start!r})", d.coordinate(turn)
    for joint, law in (
        (x, f"{r!r} * sin({t})"),
        (y, f"{r!r} - {r!r} * cos({t})"),
        (turn, f"{first!r} + {t}"),
    ):
        d.drive(joint, f"motion.expression(lambda t: {law})", law)
    speed, q = d.measured("place", d.base(body), rate=True), d.measured("direction", body)
    (vx, vy), (heading,) = speed, q
    d.row(d.formula(f"-sin({heading}) * {vx} + cos({heading}) * {vy}", speed | q), y)
    return []


def rolling_wheel(d: Draft) -> list[str]:
    """A wheel on the ground and a hub: no slip, in velocities."""
    r, speed, more = d.between(0.1, 0.4), d.between(-2, 2), d.between(-1, 1)
    hub, wheel = block(d, (0.0, r)), block(d, (0.0, r))
    way = d.line("prismatic", "ground", hub, 0.0, d.ground((0.0, r)))
    turn = d.joint("revolute", hub, wheel)
    first, t = d.coordinate(turn), f"(t - {d.start!r})"
    law = f"{speed!r} * {t} + {more!r} * {t}**2"
    d.drive(way, f"motion.expression(lambda t: {law})", law)
    law = f"{first!r} - ({law}) / {r!r}"
    d.drive(turn, f"motion.expression(lambda t: {law})", law)
    velocity, rate = d.measured("place", hub, rate=True), d.measured("coordinate", turn, rate=True)
    d.row(d.formula(f"{next(iter(velocity))} + {r!r} * {next(iter(rate))}", velocity | rate), turn)
    return []


def open_chain(d: Draft) -> list[str]:
    for _ in range(d.choose(1, 2, 4, 6)):
        hang(d)
    return [j for j in d.movable() if d.joints[j].kind == "revolute"]


def dyads(d: Draft) -> list[str]:
    """A crank, and dyads on it and on each other."""
    at, _ = frame(d)
    r, phi = d.between(0.05, 0.2), d.angle()
    crank, _ = d.bar(at(0.0, 0.0), at(r * math.cos(phi), r * math.sin(phi)))
    d.pin(d.ground(at(0.0, 0.0)), crank)
    wanted = d.choose(1, 2, 3, 4)
    for _ in range(4 * wanted):
        wanted -= attempt(d, dyad, takes=0)
        if not wanted:
            break
    return []


PATTERNS = {
    linkages.slider_crank: 3,
    linkages.crank_rocker: 3,
    linkages.inverted: 3,
    linkages.guided_bar: 5,
    linkages.scott_russell: 2,
    linkages.parallel_cranks: 3,
    linkages.two_guides: 1.5,
    linkages.wedges: 2,
    linkages.oldham: 2,
    planetary: 2,
    geared_five_bar: 1.5,
    led_arm: 4,
    linkages.scissor_lift: 1.5,
    linkages.platform: 2,
    linkages.truss: 1.5,
    rack: 1.5,
    cam: 1.5,
    sleigh: 0.7,
    rolling_wheel: 0.5,
    open_chain: 3,
    dyads: 6,
}
