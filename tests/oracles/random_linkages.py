"""Linkages that are known by name, each with numbers of its own: of pins, guides and slots.

Their structure is what chance alone would not draw: right angles, equal lengths, pins on one line,
more equations than unknowns. Each returns joints that may turn all the way round.
"""

from __future__ import annotations

import functools
import math

from random_draft import Draft, Place, Spot
from random_growth import frame


def exactly(pattern):
    """A pattern whose lengths and places fit at no other numbers: they are written as they are."""

    @functools.wraps(pattern)
    def drawn(d: Draft) -> list[str]:
        d.exact = True
        leads = pattern(d)
        d.exact = False
        return leads

    return drawn


def block(d: Draft, at: Place, phi: float | None = None) -> Spot:
    """A short link, its base at a place."""
    body = d.link(d.between(0.04, 0.1))
    d.put(d.base(body), at, d.angle() if phi is None else phi)
    return d.base(body)


def meeting(a, l, b, m, side):
    """Where two circles meet."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    p = math.hypot(dx, dy)
    along = (l * l - m * m + p * p) / (2 * p)
    across = side * math.sqrt(l * l - along * along)
    return a[0] + (along * dx - across * dy) / p, a[1] + (along * dy + across * dx) / p


def slider_crank(d: Draft) -> list[str]:
    """An offset slider-crank; the slider is a mass on a line, a pin in a slot, or a block."""
    at, turned = frame(d)
    r, offset, phi = d.between(0.05, 0.15), d.choose(0.0, d.between(-0.05, 0.05)), d.between(-3, 3)
    l = d.between(0.35, 0.6)
    elbow = (r * math.cos(phi), r * math.sin(phi))
    end = (elbow[0] + d.choose(-1, 1) * math.sqrt(l * l - (elbow[1] - offset) ** 2), offset)
    crank, pin = d.bar(at(0.0, 0.0), at(*elbow))
    near, far = d.bar(at(*elbow), at(*end))
    main = d.pin(d.ground(at(0.0, 0.0)), crank)
    d.pin(pin, near)
    kind = d.choose("mass", "slot", "block")
    if kind == "slot":
        d.line("slot", "ground", far, turned(0.0))
    else:
        slider = d.mass_point(at(*end)) if kind == "mass" else block(d, at(*end))
        d.pin(far, slider)
        d.line("prismatic", "ground", slider, turned(0.0))
    return [main]


def crank_rocker(d: Draft) -> list[str]:
    """A four-bar whose crank goes round."""
    at, _ = frame(d)
    a, phi, ground = d.between(0.05, 0.12), d.between(-3, 3), d.between(0.4, 0.5)
    b, c = d.between(0.4, 0.5), d.between(0.25, 0.35)
    elbow = (a * math.cos(phi), a * math.sin(phi))
    knee = meeting(elbow, b, (ground, 0.0), c, d.choose(-1, 1))
    crank, pin = d.bar(at(0.0, 0.0), at(*elbow))
    near, far = d.bar(at(*elbow), at(*knee))
    foot, top = d.bar(at(ground, 0.0), at(*knee))
    main = d.pin(d.ground(at(0.0, 0.0)), crank)
    d.pin(pin, near)
    d.pin(far, top)
    d.pin(d.ground(at(ground, 0.0)), foot)
    return [main]


def inverted(d: Draft) -> list[str]:
    """A crank's pin in a slot of a rocker; or a block between them, carried by either."""
    at, _ = frame(d)
    r, phi, depth = d.between(0.05, 0.12), d.between(-3, 3), d.between(0.2, 0.35)
    elbow = (r * math.cos(phi), r * math.sin(phi))
    pivot = (d.choose(0.0, d.between(-0.1, 0.1)), -depth)
    reach = math.dist(elbow, pivot)
    crank, pin = d.bar(at(0.0, 0.0), at(*elbow))
    main = d.pin(d.ground(at(0.0, 0.0)), crank)
    rocker = d.link(depth + r + 0.2)
    (x, y), (u, v) = at(*pivot), at(*elbow)
    direction = math.atan2(v - y, u - x)
    d.put(d.base(rocker), (x, y), direction)
    d.pin(d.ground((x, y)), d.base(rocker))
    kind = d.choose("slot", "rocker carries", "block carries")
    if kind == "slot":
        d.line("slot", rocker, pin, direction, d.base(rocker))
        return [main]
    slide = block(d, (u, v))
    d.pin(pin, slide)
    if kind == "rocker carries":
        d.line("prismatic", rocker, slide, direction, d.base(rocker))
    else:
        d.line("prismatic", slide.body, d.at(rocker, reach), direction, slide)
    return [main]


def guided_bar(d: Draft) -> list[str]:
    """A bar with pins on two lines, or both on one; guided by masses, by slots, or held by
    equations of a user.
    """
    at, turned = frame(d)
    l, phi = d.between(0.3, 0.8), d.between(0.3, 1.2)
    across = d.choose(math.pi / 2, d.between(1.0, 2.0))
    # The bar leans between the x axis and a line through the origin.
    x = l * math.sin(across - phi) / math.sin(across)
    y = l * math.sin(phi) / math.sin(across)
    foot, head = (x, 0.0), (y * math.cos(across), y * math.sin(across))
    lines = (0.0, across)
    if d.chance(0.25):
        head, lines = (x - l * d.choose(-1, 1), 0.0), (0.0, 0.0)
    near, far = d.bar(at(*foot), at(*head))
    hung = d.chance(0.5)
    for spot, way in ((near, lines[0]), (far, lines[1])):
        if not hung or d.chance(0.6):
            mass = d.mass_point(d.place(spot))
            d.pin(spot, mass)
            d.line(d.choose("prismatic", "slot"), "ground", mass, turned(way))
            hung = True
        else:
            d.line("slot", "ground", spot, turned(way))
    if d.chance(
        0.5
    ):  # driven by the middle: a pin of a crank in a slot of the bar, or of the crank in the bar's
        share = d.choose(0.5, d.between(0.2, 0.8))
        middle = d.at(near.body, near.x + share * (far.x - near.x))
        place = d.place(middle)
        crank = d.link(
            math.dist(place, at(0.0, 0.0)) + 0.1,
            ("mass=0.0", {"density": lambda u: 0.0}) if d.chance(0.6) else None,
        )
        home = at(0.0, 0.0)
        way = math.atan2(place[1] - home[1], place[0] - home[0])
        d.put(d.base(crank), home, way)
        d.leads.append(d.pin(d.ground(home), d.base(crank)))
        if lines[1]:
            d.line("slot", crank, middle, way, d.base(crank))
    return []


@exactly
def scott_russell(d: Draft) -> list[str]:
    """A crank of half a bar's length at its middle, the bar's foot on a line; perhaps its head too,
    which repeats it.
    """
    at, turned = frame(d)
    a, phi = d.between(0.15, 0.3), d.between(0.4, 1.1)
    foot, head = (2 * a * math.cos(phi), 0.0), (0.0, 2 * a * math.sin(phi))
    bar = d.link(2 * a)
    d.put(d.base(bar), at(*foot), turned(math.pi - phi))
    centre = d.at(bar, a, 0.0)
    crank = d.link(a)
    d.put(d.base(crank), at(0.0, 0.0), turned(phi))
    main = d.pin(d.ground(at(0.0, 0.0)), d.base(crank))
    d.pin(d.tip(crank), centre)
    guides = [(d.base(bar), 0.0, foot), (d.tip(bar), math.pi / 2, head)]
    for spot, way, place in guides if d.chance(0.4) else guides[:1]:
        mass = d.mass_point(at(*place))
        d.pin(spot, mass)
        d.line("prismatic", "ground", mass, turned(way), d.ground(at(*place)))
    d.leads += d.choose([main], [])
    return []


@exactly
def parallel_cranks(d: Draft) -> list[str]:
    """Two or three equal cranks on one bar."""
    at, turned = frame(d)
    r = d.number(d.between(0.1, 0.3), 0.2)
    phi = d.choose(math.pi / 2, d.between(0.4, 2.7), d.between(-2.7, -0.4))
    feet = [
        (0.0, 0.0),
        (d.between(0.3, 0.5), 0.0),
        (d.between(0.7, 0.9), d.choose(0.0, d.between(0.1, 0.3))),
    ]
    arm = (r.value * math.cos(phi), r.value * math.sin(phi))
    bar = d.link(1.0)
    d.put(d.base(bar), at(*arm), turned(0.0))
    joints = []
    for foot in feet[: d.choose(2, 3, weights=[1, 3])]:
        crank = d.link(r)
        d.put(d.base(crank), at(*foot), turned(phi))
        joints.append(d.pin(d.ground(at(*foot)), d.base(crank)))
        d.pin(d.tip(crank), d.at(bar, foot[0], foot[1]) if foot != (0.0, 0.0) else d.base(bar))
    if d.chance(0.4):  # written by parameters, and where less is open than elsewhere
        d.parametric, d.far, d.defaults[joints[0]] = 0.7, 1.0, math.pi / 2
    return joints[:1]


@exactly
def two_guides(d: Draft) -> list[str]:
    """A bar in two guides of one line, or of parallel lines."""
    at, turned = frame(d)
    bar = d.link(d.between(0.5, 1.0))
    way = d.choose(0.0, d.angle())
    d.put(d.base(bar), at(0.1, 0.2), turned(d.choose(way, d.angle())))
    for _ in range(2):
        d.line(
            "prismatic",
            *d.choose(("ground", d.spot(bar)), (bar, d.ground(at(d.between(-0.3, 0.3), 0.1)))),
            turned(way),
        )
    return []


@exactly
def wedges(d: Draft) -> list[str]:
    """A loop of slides alone."""
    at, turned = frame(d)
    first, second = (
        block(d, at(d.between(-0.3, 0.3), d.between(-0.3, 0.3)), turned(d.angle()))
        for _ in range(2)
    )
    ways = [d.choose(0.0, d.angle()), d.choose(math.pi / 2, d.angle()), d.angle()]
    for (carrier, spot), way in zip(
        (("ground", first), (first.body, second), ("ground", second)), ways, strict=True
    ):
        if carrier != "ground" and d.chance(0.5):
            carrier, spot = spot.body, d.base(carrier)
        d.line("prismatic", carrier, spot, turned(way))
    return []


@exactly
def oldham(d: Draft) -> list[str]:
    """Two shafts that are out of line, coupled by a cross in slots of both."""
    at, turned = frame(d)
    phi, off, e = d.angle(), d.choose(math.pi / 2, d.between(1.0, 2.0)), d.between(0.03, 0.1)
    first, second, cross = (block(d, at(x, 0.0), turned(phi)) for x in (0.0, e, 0.0))
    # The middle lies where a line through the first shaft meets one through the second.
    c, s = math.cos(phi), math.sin(phi)
    u, v = math.cos(phi + off), math.sin(phi + off)
    k = (e * v) / (c * v - s * u)
    d.put(cross, at(k * c, k * s), turned(phi + d.choose(0.0, d.between(-1, 1))))
    main = d.pin(d.ground(at(0.0, 0.0)), first)
    d.pin(d.ground(at(e, 0.0)), second)
    d.line("prismatic", *d.choose((first.body, cross), (cross.body, first)), turned(phi))
    d.line("prismatic", *d.choose((second.body, cross), (cross.body, second)), turned(phi + off))
    return [main]


@exactly
def scissor_lift(d: Draft) -> list[str]:
    """Crossed bars, stage upon stage, on a fixed pin and a slide."""
    at, turned = frame(d)
    l, phi, stages = d.between(0.4, 0.8), d.between(0.3, 1.0), d.choose(1, 2, 3)
    w, h = l * math.cos(phi), l * math.sin(phi)
    left, right = d.ground(at(0.0, 0.0)), d.mass_point(at(w, 0.0))
    d.line("prismatic", "ground", right, turned(0.0))
    for _ in range(stages):
        bars = []
        for foot, lean in ((left, phi), (right, math.pi - phi)):
            bar = d.link(l)
            d.put(d.base(bar), d.place(foot), turned(lean))
            d.pin(foot, d.base(bar))
            bars.append(bar)
        d.pin(d.at(bars[0], l / 2, 0.0), d.at(bars[1], l / 2, 0.0))
        left, right = d.tip(bars[1]), d.tip(bars[0])
    if d.chance(0.5):
        top = d.link(1.3 * w)
        d.put(d.base(top), at(0.0, stages * h), turned(0.0))
        d.pin(left, d.base(top))
        d.line("slot", top, right, turned(0.0), d.base(top))
    return []


def platform(d: Draft) -> list[str]:
    """A platform on three legs of two links each, the first of them driven; or on telescopes."""
    at, _ = frame(d)
    corners = [
        (d.between(-0.1, 0.1) + 0.25 * math.cos(k), d.between(-0.1, 0.1) + 0.25 * math.sin(k))
        for k in (0.3, 2.4, 4.5)
    ]
    plate = d.link(
        0.3,
        (
            "mass=1.0, centre=(0.0, 0.0), inertia=0.02",
            {"mass": 1.0, "centre": (0.0, 0.0), "inertia": 0.02},
        ),
    )
    d.put(d.base(plate), at(0.0, 0.0), d.angle())
    for k, corner in enumerate(corners):
        foot = (
            0.9 * math.cos(0.3 + 2.1 * k) + d.between(-0.1, 0.1),
            0.9 * math.sin(0.3 + 2.1 * k) + d.between(-0.1, 0.1),
        )
        spot = d.meet(plate, at(*corner))
        assert spot is not None
        if d.chance(0.3):
            (x, y), (u, v) = at(*foot), at(*corner)
            way = math.atan2(v - y, u - x)
            lower = d.link(0.6 * math.dist(foot, corner))
            upper = d.link(0.6 * math.dist(foot, corner))
            d.put(d.base(lower), (x, y), way)
            d.put(d.tip(upper), (u, v), way)
            d.pin(d.ground((x, y)), d.base(lower))
            d.pin(d.tip(upper), spot)
            d.line("prismatic", *d.choose((lower, d.base(upper)), (upper, d.tip(lower))), way)
            continue
        knee = meeting(
            foot,
            math.dist(foot, corner) * 0.6,
            corner,
            math.dist(foot, corner) * 0.65,
            d.choose(-1, 1),
        )
        lower, top = d.bar(at(*foot), at(*knee))
        near, far = d.bar(at(*knee), at(*corner))
        d.pin(d.ground(at(*foot)), lower)
        d.pin(top, near)
        d.pin(far, spot)
    return []


def truss(d: Draft) -> list[str]:
    """A structure of pinned bars, perhaps with one too many."""
    at, _ = frame(d)
    places = [(0.0, 0.0), (0.5, 0.0), (d.between(0.2, 0.3), d.between(0.3, 0.5))]
    d.exact = more = d.chance(0.5)
    spots = [d.ground(at(*places[0])), d.ground(at(*places[1]))]
    for k in range(d.choose(1, 2, 3)):
        a, b = k, k + 1
        top = (
            places[2]
            if k == 0
            else (places[k + 1][0] + 0.3, places[k + 1][1] + d.choose(-0.35, 0.3))
        )
        if k:
            places.append(top)
        (n1, f1), (n2, f2) = (d.bar(at(*places[i]), at(*top)) for i in (a, b))
        d.pin(spots[a], n1)
        d.pin(spots[b], n2)
        d.pin(f1, f2)
        spots.append(f1)
    if more:
        near, far = d.bar(at(-0.4, 0.3), at(*places[-1]))
        d.pin(d.ground(at(-0.4, 0.3)), near)
        d.pin(far, spots[-1])
    d.exact = False
    return []
