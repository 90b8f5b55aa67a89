"""Parts of several bodies or of a shape, joined to random mechanisms: planetary sets, bushes,
plates and bent bars; nothing of the package is used.
"""

from __future__ import annotations

import itertools
import math

import oracle
from random_draft import Draft, Place, Spot
from random_elements import PARTS as ELEMENTS
from random_elements import mesh, teeth_between
from random_formula import Measure
from random_geneva import geneva
from random_growth import anything, attempt, dyad


def planetary(d: Draft) -> None:
    """Planets that share the load between a sun and a ring, of which one may be held."""
    z, planets = d.choose(
        ((20, 16, 52), 3), ((24, 18, 60), 2), ((18, 24, 66), 3), ((31, 13, 57), 4)
    )
    module, held, own = d.between(1e-3, 4e-3), d.choose("ring", "sun", ""), d.chance(0.5)
    at, steep, name = (
        (d.between(-0.5, 0.5), d.between(-0.5, 0.5)),
        d.between(15.0, 25.0),
        d.new("e"),
    )
    centre, sizes = d.ground(at, None), [module * n / 2 for n in z]
    carrier = d.link(
        0.2,
        (
            f"mass=1.5, centre=(0.02, {0.01 * own!r}), inertia=0.01",
            {"mass": 1.5, "centre": (0.02, 0.01 * own), "inertia": 0.01},
        ),
        None,
    )
    turn = d.angle()
    # Without slip all of the gears' turns on the carrier follow from the sun's.
    gone = d.between(-1.0, 1.0)
    turns = [gone, -gone * z[0] / z[1], -gone * z[0] / z[2]]
    whole = {"ring": -turns[2], "sun": -turns[0]}.get(held, turn)
    d.put(d.base(carrier), at, whole)
    d.pin(centre, d.base(carrier))
    spots = {}
    for one, by in (("sun", turns[0]), ("ring", turns[2])):
        spots[one] = centre
        if one != held:
            body = d.link(
                0.1,
                (
                    "mass=0.8, centre=(0.0, 0.0), inertia=0.004",
                    {"mass": 0.8, "centre": (0.0, 0.0), "inertia": 0.004},
                ),
                None,
            )
            spots[one] = d.base(body)
            d.put(spots[one], at, whole + by)
            d.joint("revolute", centre, spots[one])
    mass = d.between(0.1, 0.5)
    told = f"{spots['sun'].text}, {carrier}, {spots['ring'].text}, teeth={z}, module={module!r}"
    names = [f"{name}_planet_{k + 1}" for k in range(planets)]
    pins = [f"{name}_pin_{k + 1}" for k in range(planets)]
    d.lines.append(
        f'{name} = planetary(m, "{name}", {told}, planets={planets}, mass={mass!r},'
        f' pressure_angle="{steep!r} deg")  # of {", ".join(d.joints)}'
    )
    d.lines.append(f"({', '.join(names)},), ({', '.join(pins)},) = {name}.planets, {name}.pins")
    reach, meshes = sizes[0] + sizes[1], []
    for k, (body, pin) in enumerate(zip(names, pins, strict=True)):
        way = math.tau * k / planets
        hub = Spot(carrier, "", reach * math.cos(way), reach * math.sin(way))
        d.bodies[body] = oracle.Body(body, mass, sizes[1], inertia=mass * sizes[1] ** 2 / 2)
        d.put(d.base(body), d.place(hub), whole + turns[1])
        d.joints[pin] = oracle.Joint(pin, "revolute", hub.point, (body, 0.0, 0.0))
        planet = d.base(body)
        meshes.append(teeth_between(spots["sun"], planet, sizes[0], 1.0, 1.0))
        _mesh(
            d,
            f"{name}_ring_{k + 1}",
            carrier,
            planet,
            spots["ring"],
            sizes[1:],
            -1.0,
            [teeth_between(planet, spots["ring"], sizes[1], -1.0, 1.0)],
            steep,
        )
    _mesh(d, f"{name}_sun", carrier, spots["sun"], d.base(names[0]), sizes[:2], 1.0, meshes, steep)


def _mesh(d, name, carrier, first: Spot, second: Spot, sizes, sense, meshes, steep) -> None:
    """One multiplier for all meshes, which press apart besides."""
    places = {
        f"{name}_{k}": Measure("angle", (body, 0.0, 0.0))
        for k, body in zip("abc", (first.body, second.body, carrier), strict=True)
    }
    a, b, c = places
    formula = d.formula(f"{sizes[0]!r} * ({a} - {c}) + {sense * sizes[1]!r} * ({b} - {c})", places)

    def all_of(place, along, apart):
        return [part for force in meshes for part in force(place, along, apart)]

    d.contacts[name] = mesh(name, formula, all_of, steep)


def bushes(d: Draft) -> None:
    """A rod that slides in two bushes of another body."""
    body = anything(d)
    if body == "ground":
        x, y, way = d.between(-0.4, 0.4), d.between(-0.4, 0.4), d.angle()
        apart = d.between(0.1, 0.3)
        near = d.ground((x, y))
        far = d.ground((x + apart * math.cos(way), y + apart * math.sin(way)))
    else:
        l, aside = d.bodies[body].length, d.choose(0.0, d.between(-0.1, 0.1))
        near, far = d.at(body, 0.25 * l, 0.0, None), d.at(body, 0.75 * l, aside, None)
    (x, y), (u, v) = d.place(near), d.place(far)
    way, apart = math.atan2(v - y, u - x), math.dist((x, y), (u, v))
    rod, lean = d.link(apart + 0.6), d.choose(0.0, d.between(-0.3, 0.3))
    name, along = d.new("e"), d.between(0.15, 0.3)
    axis = math.cos(lean), math.sin(lean)
    d.put(d.base(rod), (x - along * math.cos(way), y - along * math.sin(way)), way - lean)
    d.lines.append(
        f'{name} = two_bushes(m, "{name}", {rod}, {near.text}, {far.text}, axis={axis!r})'
    )
    pins = [f"{name}_{end}" for end in ("first", "second", "pivot")]
    shoe = f"{name}_shoe"
    d.lines.append(f'{", ".join(pins)} = {name}.first, {name}.second, m.joints["{pins[2]}"]')
    d.lines.append(f'{shoe} = m.links["{shoe}"]  # of {pins[0]}')
    d.bodies[shoe] = oracle.Body(shoe, 0.0, apart / 4)
    d.poses[shoe] = x, y, way - lean
    base = (rod, 0.0, 0.0)
    d.joints[pins[0]] = oracle.Joint(pins[0], "prismatic", base, (shoe, 0.0, 0.0), axis=axis)
    d.joints[pins[2]] = oracle.Joint(pins[2], "revolute", (shoe, 0.0, 0.0), near.point)
    d.joints[pins[1]] = oracle.Joint(pins[1], "slot", base, far.point, axis=axis)


def plate(d: Draft) -> None:
    """A plate of three or four corners on a pin."""
    name, mass, near = d.new("b"), d.between(0.3, 2.0), d.spot(anything(d))
    corners = [
        (d.between(0.1, 0.4) * math.cos(way), d.between(0.1, 0.4) * math.sin(way))
        for way in d.choose((0.2, 2.2, 4.1), (0.1, 1.5, 3.3, 5.0), (6.0, 4.4, 2.9, 1.2))
    ]
    area, first, second = 0.0, [0.0, 0.0], 0.0
    for (ax, ay), (bx, by) in itertools.pairwise([*corners, corners[0]]):
        piece = (ax * by - ay * bx) / 2  # of the triangle with the origin
        area += piece
        first = [first[0] + piece * (ax + bx) / 3, first[1] + piece * (ay + by) / 3]
        second += piece * (ax * ax + ay * ay + bx * bx + by * by + ax * bx + ay * by) / 6
    centre = first[0] / area, first[1] / area
    inertia = mass * (second / area - centre[0] ** 2 - centre[1] ** 2)
    d.lines.append(f'{name}_made = plate(m, "{name}", {corners}, mass={mass!r})')
    d.lines.append(f"{name} = {name}_made.link")
    size = max(math.hypot(*corner) for corner in corners)
    d.bodies[name] = oracle.Body(name, mass, size, centre, inertia)
    k = int(d.rng.integers(len(corners)))
    spot = Spot(name, f"{name}_made.corner({k})", *corners[k])
    d.put(spot, d.place(near), d.angle())
    d.pin(near, spot)


def bent(d: Draft) -> None:
    """A bar of two or three straight pieces on a pin at a corner."""
    name, mass, near = d.new("b"), d.between(0.3, 2.0), d.spot(anything(d))
    corners: list[Place] = [(0.0, 0.0)]
    for _ in range(d.choose(2, 3)):
        way, step = d.between(-2.5, 2.5), d.between(0.1, 0.3)
        corners.append(
            (corners[-1][0] + step * math.cos(way), corners[-1][1] + step * math.sin(way))
        )
    steps = [(b[0] - a[0], b[1] - a[1]) for a, b in itertools.pairwise(corners)]
    ways, whole = [math.atan2(y, x) for x, y in steps], sum(math.hypot(*step) for step in steps)
    pieces = [f"{name}_{k + 1}" for k in range(len(steps))]
    d.lines.append(f'{name}_made = bent_bar(m, "{name}", {corners}, mass={mass!r})')
    d.lines.append(f"({', '.join(pieces)},) = {name}_made.pieces")
    turn, k = d.angle(), int(d.rng.integers(len(corners)))
    x, y = d.place(near)
    at = corners[k]
    for piece, way, step, corner in zip(pieces, ways, steps, corners, strict=False):
        length = math.hypot(*step)
        share = mass * length / whole
        d.bodies[piece] = oracle.from_density(piece, length, lambda u, share=share: share)
        d.limited.add(piece)
        dx, dy, spun = corner[0] - at[0], corner[1] - at[1], turn - ways[0]
        c, s = math.cos(spun), math.sin(spun)
        d.poses[piece] = (
            x + c * dx - s * dy,
            y + s * dx + c * dy,
            math.remainder(way + spun, math.tau),
        )
    bends = [f"{name}_bend_{n + 1}" for n in range(len(pieces) - 1)]
    for bend, (one, two), (before, after) in zip(
        bends, itertools.pairwise(pieces), itertools.pairwise(ways), strict=True
    ):
        d.joints[bend] = oracle.Joint(
            bend,
            "weld",
            (one, d.bodies[one].length, 0.0),
            (two, 0.0, 0.0),
            angle=math.remainder(after - before, math.tau),
        )
        d.lines.append(f'{bend} = m.joints["{bend}"]  # of {pieces[0]}')
    end = d.tip(pieces[k - 1]) if k else d.base(pieces[0])
    d.pin(near, Spot(end.body, f"{name}_made.corner({k})", end.x, end.y))


PARTS = {"planetary": planetary, "bushes": bushes, "plate": plate, "bent": bent}
_NO_FREEDOM = (*ELEMENTS, geneva)
"""Parts that bring a body, and hold it."""

PARTS |= {part.__name__: part for part in _NO_FREEDOM}


def join(d: Draft, kind: str) -> bool:
    """Join a part of a kind, and now and then a dyad; False where there is no place for it."""
    part = PARTS[kind]
    found = any(attempt(d, part, takes=0 if part in _NO_FREEDOM else None) for _ in range(6))
    if found and d.chance(0.5):
        attempt(d, dyad, takes=0)
    return found
