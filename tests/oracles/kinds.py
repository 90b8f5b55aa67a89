"""Random mechanisms of many kinds, drawn from what can be declared: each a function of a generator
that gives a scene.

Linkages are drawn by the places of their pins at the first instant, so they close there; whether
they go on, an evaluation tells.
"""

from __future__ import annotations

import math

import casadi as ca
import numpy as np

from lagrange_casadi import Mechanism, Scene, density, evaluate, table
from lagrange_casadi.errors import LagrangeCasadiError
from lagrange_casadi.motion import harmonic, polynomial

COUNT = 61
"""Instants of a scene: more than estimates look at by themselves."""


def _mass(rng, decades=(-2, 1)):
    return float(10 ** rng.uniform(*decades))


def _law(rng, start, swing=None):
    """A motion from an angle or place: a swing, a start and an end at rest, or a steady turn."""
    swing = float(10 ** rng.uniform(-1.0, 0.1)) if swing is None else swing
    if rng.random() < 0.5:
        return harmonic(start - swing * math.sin(0.3), swing, float(rng.uniform(0.3, 1.5)), 0.3)
    return polynomial(start, swing, float(swing * rng.uniform(-0.5, 0.5)))


def _pins(rng, links):
    """Places of pins, those beside a link's ends beside the link."""
    pins = {}
    for own in sorted(links, key=lambda own: -len(own)):
        for pin in own:
            if pin in own[:2]:
                pins.setdefault(pin, rng.uniform(-0.3, 0.3, 2))
            elif pin not in pins:
                (x, y), (dx, dy) = pins[own[0]], pins[own[1]] - pins[own[0]]
                u, v = rng.uniform(0.05, 0.95), rng.normal(0.0, 0.3)
                pins[pin] = np.array([x + u * dx - v * dy, y + u * dy + v * dx])
    return pins


def linkage(rng, name, links, grounded, drives, *, decorate=None, swing=None, masses=(-2, 1)):
    """Links between random places: ``links`` names the pins of each, the first its base, the second
    its tip.

    ``grounded`` are the pins on the ground, ``drives`` the links driven from there. ``decorate(m,
    links, pins, rng)`` adds to it, and gives the posture of what it adds.
    """
    pins = _pins(rng, links)
    m, made, posture, motion, known = Mechanism(name), {}, {}, {}, {}
    for pin in grounded:
        known[pin] = m.ground.at(*map(float, pins[pin]))
    for own in links:
        (x0, y0), (x1, y1) = pins[own[0]], pins[own[1]]
        length, angle = math.hypot(x1 - x0, y1 - y0), math.atan2(y1 - y0, x1 - x0)
        link = made[own] = m.link(own, length=length, mass=_mass(rng, masses))
        posture[own] = angle
        for pin in own:
            dx, dy = pins[pin] - pins[own[0]]
            along = dx * math.cos(angle) + dy * math.sin(angle)
            across = dy * math.cos(angle) - dx * math.sin(angle)
            point = {own[0]: link.base, own[1]: link.tip}.get(pin) or link.at(
                float(along), float(across)
            )
            if pin in known:
                m.revolute(f"{pin}{own}", known[pin], point)
            else:
                known[pin] = point
        if own in drives:
            motion[f"{own[0]}{own}"] = _law(rng, angle, swing)
    if decorate is not None:
        posture |= decorate(m, made, pins, rng) or {}
    return Scene(
        m,
        motion,
        posture={k: v for k, v in posture.items() if k not in drives},
        t=(0.0, 1.0, COUNT),
    )


def _named(name, *told, **more):
    def drawn(rng):
        return linkage(rng, name, *told, **more)

    drawn.__name__ = name
    return drawn


four_bar, watt_one, watt_two, stephenson_one, stephenson_two = LINKAGES = (
    _named("four_bar", ["OA", "AB", "CB"], "OC", ["OA"]),
    _named("watt_one", ["OA", "ABD", "CBE", "DF", "EF"], "OC", ["OA"]),
    _named("watt_two", ["OA", "AB", "CBD", "DF", "GF"], "OCG", ["OA"]),
    _named("stephenson_one", ["OAD", "AB", "CBE", "DF", "EF"], "OC", ["OAD"]),
    # No dyad: four directions at once.
    _named("stephenson_two", ["OA", "ABD", "CEF", "BE", "DF"], "OC", ["OA"]),
)
stephenson_three, stephenson_driven_last, platform = MORE = (
    _named("stephenson_three", ["OA", "ABD", "CB", "DF", "GF"], "OCG", ["OA"]),
    # Driven where its dyads end: none is left.
    _named("stephenson_driven_last", ["GF", "FD", "CB", "OA", "ABD"], "OCG", ["GF"]),
    # 3-RRR: three drives.
    _named(
        "platform",
        ["OA", "CB", "GF", "PQR", "AP", "BQ", "FR"],
        "OCG",
        ["OA", "CB", "GF"],
        swing=0.2,
    ),
)
LINKAGES += MORE


def _crank(rng, name):
    """An offset slider-crank that turns all the way round."""
    m = Mechanism(name)
    r = float(rng.uniform(0.05, 0.2))
    l = r * float(rng.uniform(1.3, 5.0))
    a = m.link("a", length=r, mass=_mass(rng))
    b = m.link("b", length=l, mass=_mass(rng))
    s = m.point_mass("s", _mass(rng))
    main = m.revolute("O", m.ground, a)
    m.revolute("A", a.tip, b)
    m.revolute("B", b.tip, s)
    guide = m.prismatic(
        "P", m.ground.at(0, r * float(rng.choice([0.0, 0.1, 0.25]))), s, axis=(1, 0)
    )
    return m, {"a": a, "b": b, "s": s}, main, guide


def slider_crank(rng):
    m, *_ = _crank(rng, "slider_crank")
    return Scene(m, {"O": _law(rng, 0.3, 6.0)}, posture={"b": 0.0}, t=(0.0, 1.0, COUNT))


def chain(rng):
    m, near, motion = Mechanism("chain"), None, {}
    for i in range(int(rng.integers(1, 6))):
        matter = (
            {"mass": _mass(rng)}
            if rng.random() < 0.6
            else {"density": density.polynomial(_mass(rng), 0.5, _mass(rng))}
        )
        link = m.link(f"l{i}", length=float(rng.uniform(0.05, 0.5)), **matter)
        if i and rng.random() < 0.3:
            m.prismatic(
                f"J{i}",
                near,
                link,
                axis=(1.0, float(rng.choice([0.0, 0.3]))),
                angle=float(rng.choice([0.0, 0.5])),
            )
        else:
            m.revolute(f"J{i}", m.ground if near is None else near, link)
        motion[f"J{i}"] = _law(rng, float(rng.uniform(-0.3, 0.3)))
        near = link.tip
    m.revolute("P", near, m.point_mass("payload", _mass(rng)))
    return Scene(m, motion, t=(0.0, 1.0, COUNT))


def _station(rng, l, length):
    """A station of a link as an expression of its length that is a round ratio, its base or its
    tip, but for rounding, or none.
    """
    n, d = int(rng.integers(1, 9)), int(rng.integers(1, 11))
    ratio = min(n, d) / max(n, d)
    return (
        l * (0.1 * n) / (0.1 * max(n, d)),
        l - length,
        (l / 3) * 3,
        l * ratio,
        l * 0.1 + l * 0.2 - 0.05 * l,
        l * float(rng.uniform(0, 1)),
        ca.sqrt(l) ** 2,
        l * ca.cos(math.pi / 3),
    )[int(rng.integers(8))]


def stations(rng):
    """Large loads, lumps and links at places of a chain that are expressions."""
    m, near, motion = Mechanism("stations"), None, {}
    for i in range(int(rng.integers(1, 4))):
        length = float(rng.choice([0.3, 0.6, 1.0, rng.uniform(0.1, 2.0)]))
        l = m.parameter(f"l{i}", length, "m")
        link = m.link(f"l{i}", length=l, mass=_mass(rng))
        m.revolute(f"J{i}", m.ground if near is None else near, link)
        motion[f"J{i}"] = _law(rng, float(rng.uniform(-1, 1)))
        for k in range(int(rng.integers(1, 4))):
            place = link.at(_station(rng, l, length), float(rng.choice([0.0, 0.02])))
            size = float(10 ** rng.uniform(0, 6))
            kind = int(rng.integers(4))
            if kind == 0:
                m.weld(f"w{i}{k}", place, m.point_mass(f"lump{i}{k}", size / 1e3))
            elif kind == 1:
                m.torque(f"m{i}{k}", place, size)
            else:
                m.force(f"f{i}{k}", place, x=size * float(rng.normal()), y=-size, turning=kind == 2)
        near = link.tip
    return Scene(m, motion, t=(0.0, 1.0, COUNT))


def _jumping(rng, x, span):
    """A load that jumps with what it is given, which runs through ``span``; now and then at an
    instant of the grid.
    """
    size = float(10 ** rng.uniform(0, 5))
    at = span[0] + (span[1] - span[0]) * float(rng.integers(0, COUNT)) / (COUNT - 1)
    width = span[1] - span[0]
    return (
        lambda: -size * ca.sign(x - at),
        lambda: size * (x > at),
        lambda: ca.if_else(x >= at, size, -0.3 * size),
        lambda: size * ca.floor((x - at) / (width / 6)),
        lambda: size * ca.fmod(x - at + 2 * width, width / 5),
        lambda: size * ca.remainder(x - at, width / 5),
        lambda: size * table((x - at) / width, [-1.0, 0.0, 1e-9, 1.0], [0.1, 0.2, 1.0, 0.7]),
        lambda: size * ca.logic_and(x > at, x < at + width / 4),
        lambda: -size * ca.sign(x - at) * (x - at) ** 2,
    )[int(rng.integers(9))]()


def jumps(rng):
    """Loads that jump with time, with places and with rates, that are zero at instants or turn
    round there.
    """
    if rng.random() < 0.5:
        m, parts, main, guide = _crank(rng, "jumps")
        steady = rng.random() < 0.7
        law = polynomial(0.0, 2 * math.pi) if steady else harmonic(0.4, 1.0, 1.0)
        turned, bodies, posture = (0.0, 2 * math.pi), ["b", "s"], {"b": 0.0}
    else:
        m = Mechanism("jumps")
        l = m.parameter("l", 0.4, "m")
        parts = {
            "a": m.link("a", length=l, mass=_mass(rng)),
            "b": m.link("b", length=0.3, mass=_mass(rng)),
        }
        main = guide = m.revolute("O", m.ground, parts["a"])
        m.weld("W", parts["a"].tip, parts["b"], angle=0.5)
        law, turned, bodies, posture = harmonic(0.0, 1.0, 1.0), (-1.0, 1.0), ["a", "b"], {}
    for k in range(int(rng.integers(1, 4))):
        x, span = (
            (m.time, (0.0, 1.0)),
            (m.coordinate(main), turned),
            (m.rate(main), (-4.0, 4.0)),
            (m.rate(guide), (-0.5, 0.5)),
            (m.coordinate(guide), (-0.3, 0.3)),
            (m.place(parts["b"].tip)[1], (-0.2, 0.2)),
            (m.velocity(parts["b"].tip)[0], (-0.2, 0.2)),
        )[int(rng.integers(7))]
        body = parts[bodies[int(rng.integers(len(bodies)))]]
        load = _jumping(rng, x, span)
        if rng.random() < 0.4 and body.name != "s":
            m.torque(f"load{k}", body.at(0.1), load)
        else:
            m.force(f"load{k}", body, x=load)
    return Scene(m, {"O": law}, posture=posture, t=(0.0, 1.0, COUNT))


def quick_return(rng):
    """A crank's pin in the slot of a rocker, over ratios of its length; a ram that cuts one way."""
    m = Mechanism("quick_return")
    crank = m.link("crank", length=0.1, mass=_mass(rng))
    rocker = m.link("rocker", length=0.6, mass=_mass(rng))
    connecting = m.link("connecting", length=0.25, mass=_mass(rng))
    ram = m.point_mass("ram", _mass(rng))
    m.revolute("O", m.ground, crank)
    m.revolute(
        "C", m.ground.at(0, -float(rng.choice([0.2, 0.3, 0.25, rng.uniform(0.15, 0.3)]))), rocker
    )
    m.slot("slot", rocker, crank.tip)
    m.revolute("D", rocker.tip, connecting)
    m.revolute("E", connecting.tip, ram)
    way = m.prismatic("way", m.ground.at(0, 0.36), ram, axis=(1, 0))
    m.force("cut", ram, x=-float(10 ** rng.uniform(0, 6)) * (m.rate(way) > 0))
    start = float(rng.choice([0.0, math.pi / 2, rng.uniform(0, 6)]))
    return Scene(
        m,
        {"O": polynomial(start, -2 * math.pi)},
        posture={"rocker": 1.5, "connecting": 0.0},
        t=(0.0, 1.0, COUNT),
    )


def slots(rng):
    """An arm whose pin slides in a slot of a coupler, and a load on it."""

    def slotted(m, made, pins, rng):
        x, y = pins["A"] + (pins["B"] - pins["A"]) * rng.uniform(0.3, 0.7)
        foot = rng.uniform(-0.3, 0.3, 2)
        arm = m.link("arm", length=float(math.hypot(x - foot[0], y - foot[1])), mass=_mass(rng))
        m.revolute("F", m.ground.at(*map(float, foot)), arm)
        m.slot("S", made["AB"], arm.tip)
        m.force("push", arm.at(arm.length * 0.5), x=float(10 ** rng.uniform(0, 5)), turning=True)
        return {"arm": math.atan2(y - foot[1], x - foot[0])}

    return linkage(rng, "slots", ["OA", "AB", "CB"], "OC", ["OA"], decorate=slotted, swing=0.3)


def stiff_springs(rng):
    """Springs up to 1e10 N/m between places that nearly coincide, on a linkage."""

    def sprung(m, made, pins, rng):
        for k, link in enumerate(made.values()):
            (x0, y0), (x1, y1) = pins[link.name[0]], pins[link.name[1]]
            u = float(rng.choice([0.25, 0.5, 0.64, 1.0]))
            stiffness = float(10 ** rng.uniform(3, 10))
            gap = float(10 ** rng.uniform(-9, -1)) * rng.normal(size=2)
            at = m.ground.at(
                *(
                    float(a + u * (b - a) + g)
                    for a, b, g in zip((x0, y0), (x1, y1), gap, strict=True)
                )
            )
            length = float(rng.choice([0.0, 0.0, 1e-3]))
            m.spring(
                f"k{k}",
                at,
                link.tip if u == 1.0 else link.at(u * link.length),
                stiffness=stiffness,
                length=length,
            )

    swing = float(10 ** rng.uniform(-7, -0.5))
    return linkage(
        rng, "stiff_springs", ["OA", "AB", "CB"], "OC", ["OA"], decorate=sprung, swing=swing
    )


def lift(stages, mass, l, forces, count=COUNT):
    """A lift of crossed links, with forces down on its left and its right."""
    m = Mechanism("scissors")
    foot = m.point_mass("foot", mass)
    m.prismatic("slide", m.ground, foot, axis=(1, 0))
    left, right, posture = m.ground, foot, {}
    for i in range(stages):
        a, b = m.link(f"a{i}", length=l, mass=mass), m.link(f"b{i}", length=l, mass=mass)
        m.revolute(f"L{i}", left, a)
        m.revolute(f"R{i}", right, b)
        m.revolute(f"M{i}", a.at(l / 2), b.at(l / 2))
        posture |= {a.name: 0.6, b.name: math.pi - 0.6}
        left, right = b.tip, a.tip
    m.force("left", left, y=-forces[0])
    m.force("right", right, y=-forces[1])
    return Scene(
        m, {"slide": harmonic(l * 0.8, l * 0.15, 0.5)}, posture=posture, t=(0.0, 1.0, count)
    )


def scissors(rng):
    """A lift of light links under a large load."""
    stages = int(rng.integers(1, 6))
    mass = float(10 ** rng.uniform(-9, 1))
    l = float(rng.uniform(0.4, 1.5))
    load = float(10 ** rng.uniform(1, 6))
    return lift(stages, mass, l, (load, load * float(rng.uniform(0, 2))))


def light_links(rng):
    """A linkage of links of next to no mass under large loads."""

    def loaded(m, made, pins, rng):
        for k, link in enumerate(made.values()):
            m.force(
                f"f{k}",
                link.at(float(rng.uniform(0, 1)) * link.length),
                x=float(10 ** rng.uniform(3, 7)),
                turning=bool(k % 2),
            )

    return linkage(
        rng, "light_links", ["OA", "AB", "CB"], "OC", ["OA"], decorate=loaded, masses=(-12, -3)
    )


def gears(rng):
    """A planet wheel on an arm that meshes with one that turns about the ground, and a slider-crank
    behind it.
    """
    m, parts, main, guide = _crank(rng, "gears")
    wheel = m.link("wheel", length=0.05, mass=_mass(rng), centre=(0.01, 0.0), inertia=0.002)
    turn = m.revolute("wheel_pin", m.ground.at(-0.2, 0.0), wheel)
    m.gear("mesh", main, turn, ratio=-float(rng.choice([0.5, 2.0, 17 / 31])))
    m.torque("brake", wheel, -float(_mass(rng)) * m.rate(turn))
    m.torsion_spring("coil", main, stiffness=_mass(rng), angle=0.2)
    m.force(
        "gas", parts["s"], x=-900.0 * table(m.coordinate(guide), [0.0, 0.1, 0.45], [4.0, 2.0, 1.0])
    )
    return Scene(m, {"O": polynomial(0.2, 6.0)}, posture={"b": 0.0}, t=(0.0, 1.0, COUNT))


KINDS = (
    *LINKAGES,
    slider_crank,
    chain,
    stations,
    jumps,
    quick_return,
    slots,
    stiff_springs,
    scissors,
    light_links,
    gears,
)


def closing(kind, seed):
    """The first scene of a kind, drawn one after the other, whose loops close all the way."""
    rng = np.random.default_rng(seed)
    while True:
        scene = kind(rng)
        try:
            evaluate(scene, backend="vm", certificate=False)
        except LagrangeCasadiError:
            continue
        return scene
