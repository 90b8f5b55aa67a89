"""Grows any mechanism: bodies hung on others, loops closed where they meet, and what is free given
a motion.
"""

from __future__ import annotations

import contextlib
import copy
import math
from dataclasses import replace

import numpy as np
from random_draft import Draft, Place, Spot

_STEADY = 0.02
"""Of the gaps' slope: the least singular value that a part may leave."""

LEAST = 1e-9


class MisfitError(Exception):
    """A part has no place here."""


def frame(d: Draft):
    """Axes to lay a pattern in, those of the ground or others: places and directions there."""
    x, y, turn = (
        (0.0, 0.0, 0.0) if d.chance(0.5) else (d.between(-1, 1), d.between(-1, 1), d.angle())
    )
    c, s = math.cos(turn), math.sin(turn)

    def at(u: float, v: float) -> Place:
        return (x + c * u - s * v, y + s * u + c * v) if turn or x or y else (u, v)

    return at, lambda direction: math.remainder(turn + direction, math.tau)


def values(d: Draft, drives=()) -> np.ndarray:
    """Singular values of the slope of all gaps in the posture, with some joints driven."""
    found = d.oracle(d.start)
    q = np.array([x for name in d.bodies for x in d.poses[name]])
    slope, values = found.slope(q, dict.fromkeys(drives, (0.0, 0.0, 0.0))), np.zeros(q.size)
    if len(slope):
        values[: min(slope.shape)] = np.linalg.svd(found.scaled(slope), compute_uv=False)
    return values


def freedom(d: Draft) -> int:
    return int(np.sum(values(d) < LEAST))


def attempt(d: Draft, part, *, takes: int | None = None) -> bool:
    """Let ``part(d)`` add something, and undo it where it does not fit, or does not take so many
    freedoms as its equations say.
    """
    kept = {
        name: copy.copy(value) for name, value in vars(d).items() if name not in ("rng", "_counts")
    }
    before = freedom(d) if takes is not None else 0
    with contextlib.suppress(MisfitError):
        part(d)
        found = values(d)
        steady = found[found >= LEAST]
        taken = before - int(np.sum(found < LEAST))
        if (steady.size == 0 or steady[-1] > _STEADY) and takes in (None, taken):
            return True
    vars(d).update(kept)
    return False


def anything(d: Draft, points: bool = False) -> str:
    """A body to build on, rather a late one, or the ground; a point mass only where ``points``."""
    bodies = ["ground", *(name for name in d.bodies if points or d.bodies[name].oriented)]
    return d.choose(*bodies, weights=[1.0 + k for k in range(len(bodies))])


def hang(d: Draft) -> None:
    """A body on a body that is there, by any joint, anywhere, either of them the parent."""
    kind = d.choose("pin", "line", "weld", "mass", "lump", "slide", weights=[10, 3, 1.5, 0.5, 1, 1])
    near = d.spot(anything(d, points=kind in ("pin", "mass")))
    at = d.place(near)
    if kind in ("mass", "lump", "slide"):
        point = d.mass_point(at, d.between(0.05, 1.0))
        if kind == "slide":
            d.line(d.choose("prismatic", "slot"), near.body, point, d.angle(), near)
        else:
            (d.pin if kind == "mass" else d.weld)(near, point)
        return
    body = d.link(d.between(0.1, 0.7))
    d.put(d.base(body), (0.0, 0.0), 0.0)
    far = d.spot(body)
    if kind == "line":
        direction, away = d.angle(), d.between(-0.3, 0.3)
        d.put(
            far, (at[0] + away * math.cos(direction), at[1] + away * math.sin(direction)), d.angle()
        )
        carrier, guided = (near, far) if d.chance(0.6) else (far, near)
        d.line("prismatic", carrier.body, guided, direction, carrier)
        return
    d.put(far, at, d.angle())
    (d.pin if kind == "pin" else d.weld)(near, far)


def dyad(d: Draft) -> None:
    """Two links, or a link and a slide, between two points that are there:
    no freedom more or less.
    """
    a, b = (d.spot(anything(d)) for _ in range(2))
    if a.body == b.body:
        raise MisfitError
    at, to = d.place(a), d.place(b)
    middle = (at[0] + d.between(-0.6, 0.6), at[1] + d.between(-0.6, 0.6))
    if math.dist(at, middle) < 0.08 or math.dist(to, middle) < 0.08:
        raise MisfitError
    kind = d.choose("pins", "slider", "slot", "block", weights=[4, 3, 2, 2])
    if kind == "pins":
        ends = [d.bar(p, middle) for p in (at, to)]
        for spot, (near, _) in zip((a, b), ends, strict=True):
            d.pin(spot, near)
        d.pin(ends[0][1], ends[1][1])
    elif kind in ("slider", "slot"):
        near, far = d.bar(at, middle)
        d.pin(a, near)
        _guide(d, b.body, far, d.angle(), direct=kind == "slot")
    else:
        (near, far), (other, _) = d.bar(at, middle), d.bar(to, middle)
        d.pin(a, near)
        d.pin(b, other)
        direction = d.choose(d.pose(near.body)[2], d.angle())
        lead(d, "prismatic", *d.choose((near.body, other), (other.body, far)), direction)


def lead(d: Draft, *told) -> str:
    """A line of :meth:`Draft.line`, which has a place."""
    joint = d.line(*told)
    if joint is None:
        raise MisfitError
    return joint


def _guide(d: Draft, carrier: str, pin: Spot, direction: float, direct: bool) -> None:
    """A pin in a slot, itself or by a point mass, or by a link that does not turn."""
    kind, at, spot = "slot", d.place(pin), pin
    if not direct and d.chance(0.6):
        spot = d.mass_point(at)
        d.pin(pin, spot)
        kind = d.choose("prismatic", "slot")
    elif not direct:
        kind, spot = "prismatic", d.base(d.link(d.between(0.05, 0.1)))
        d.put(spot, at, d.angle())
        d.pin(pin, spot)
    lead(d, kind, carrier, spot, direction)


def twice(d: Draft) -> None:
    """A joint or an equation once more, as a second bearing: the two share what one would bear."""
    joint = d.choose(*d.joints, *d.constraints)
    name = d.new("j" if joint in d.joints else "c")
    line = next(line for line in d.lines if f'("{joint}"' in line)
    d.lines.append(line.replace(f'"{joint}"', f'"{name}"').replace(f"{joint} = ", f"{name} = "))
    if joint in d.joints:
        d.joints[name] = replace(d.joints[joint], name=name)
    else:
        d.constraints[name] = d.constraints[joint]


def close(d: Draft) -> bool:
    """Tie two bodies that are there to each other, by any joint or equation; False where nothing
    fits.
    """
    kinds = {"pin": 2, "slot": 1, "guide": 1, "line": 2, "weld": 3, "gear": 1, "users": 1}
    kind = d.choose(*kinds, weights=[5, 4, 2, 2, 0.3, 2, 4])
    if kinds[kind] > freedom(d):
        return False
    return attempt(d, lambda d: _tie(d, kind), takes=kinds[kind])


def _tie(d: Draft, kind: str) -> None:
    if kind == "gear":
        joints = d.movable()
        if len(joints) < 2:
            raise MisfitError
        first, second = d.rng.choice(joints, 2, replace=False)
        d.gear(str(first), str(second), d.between(0.3, 2.0) * d.choose(-1, 1))
        return
    turning = [name for name in d.bodies if d.bodies[name].oriented]
    if not turning:
        raise MisfitError
    if kind == "users":
        users(d, turning)
        return
    spot, other = d.spot(d.choose(*turning)), anything(d)
    if other == spot.body:
        raise MisfitError
    if kind in ("pin", "weld"):
        meets = d.meet(other, d.place(spot))
        if meets is None:
            raise MisfitError
        (d.pin if kind == "pin" else d.weld)(spot, meets)
    elif kind == "line":
        lead(d, "prismatic", other, spot, d.angle())
    else:
        _guide(d, other, spot, d.choose(d.angle(), d.pose(other)[2]), direct=kind == "slot")


def users(d: Draft, turning: list[str]) -> None:
    """An equation of a user's own, in places, directions, coordinates and time."""
    kind = d.choose(
        "distance",
        "root",
        "line",
        "curve",
        "direction",
        "directions",
        "coordinates",
        "middle",
        "timed",
    )
    spot = d.spot(d.choose(*d.bodies))
    if kind in ("distance", "root", "middle"):
        other = d.spot(anything(d))
        if other.body == spot.body or math.dist(d.place(spot), d.place(other)) < 0.05:
            raise MisfitError
        names = d.measured("place", spot)
        x, y = names
        if other.body == "ground":
            ox, oy = (repr(value) for value in d.place(other))
        else:
            more = d.measured("place", other)
            (ox, oy), names = more, names | more
        text = f"({x} - {ox})**2 + ({y} - {oy})**2"
        if kind == "middle":
            text = f"({x} + {ox}) / 2 + {d.between(-1, 1)!r} * ({y} + {oy})"
        d.constraint(d.held(f"sqrt({text})" if kind == "root" else text, names))
    elif kind in ("line", "curve", "timed"):
        names = d.measured("place", spot)
        x, y = names
        direction = d.angle()
        text = f"{math.cos(direction)!r} * {x} + {math.sin(direction)!r} * {y}"
        if kind == "curve":
            text = f"{y} - {d.between(-2, 2)!r} * {x}**2 - {d.between(-1, 1)!r} * {x}"
        if kind == "timed":
            text = (
                f"{d.choose(x, y, text)} - {d.between(-0.2, 0.2)!r} *"
                f" {d.choose('t', 'sin(3.0 * t)', 't**2')}"
            )
        d.constraint(d.held(text, names))
    elif kind in ("direction", "directions"):
        names = d.measured("direction", d.choose(*turning))
        (q,) = names
        text = f"{q} - {d.between(-1, 1)!r} * t"
        if kind == "directions":
            others = [name for name in turning if name != names[q].of[0]]
            if not others:
                raise MisfitError
            more = d.measured("direction", d.choose(*others))
            text, names = f"{q} + {d.between(-1.5, 1.5)!r} * {next(iter(more))}", names | more
        d.constraint(d.held(text, names))
    else:
        joints = [
            *d.movable(),
            *(name for name, joint in d.joints.items() if joint.kind == "slot" and d.chance(0.5)),
        ]
        joints = list(dict.fromkeys(joints))
        if len(joints) < 2:
            raise MisfitError
        pair = [str(j) for j in d.rng.choice(joints, 2, replace=False)]
        if (
            min(abs(d.coordinate(j)) for j in pair) < 0.05
        ):  # where their product is none, it may stay so in two ways
            raise MisfitError
        first, second = (d.measured("coordinate", j) for j in pair)
        (q,), (r,) = first, second
        text = d.choose(
            f"{q} * {r}",
            f"{q} + {d.between(-1, 1)!r} * {r}**2",
            f"sin({q}) - {d.between(0.2, 1)!r} * {r}",
        )
        d.constraint(d.held(text, first | second))
