"""Loads of random mechanisms: how they are declared, and what they do to the oracle's bodies."""

from __future__ import annotations

import functools
import math
import re

import numpy as np
import oracle
from random_draft import Draft, Spot
from random_formula import Formula, Measure, joint_coordinate
from random_growth import anything
from random_path import Path
from spread import Spread


def load(d: Draft, kind: str | None = None) -> None:
    """A force, a torque, a spring or a damper, somewhere."""
    kind = kind or d.choose(
        "force", "torque", "spring", "damper", "torsion", weights=[4, 3, 2, 1, 1]
    )
    size = 10.0 ** d.choose(0, 1, 2, 4, 6, weights=[3, 3, 3, 1, 1])
    turning = [name for name in d.bodies if d.bodies[name].oriented]
    if kind == "force":
        spot = d.spot(d.choose(*d.bodies))
        turns = d.bodies[spot.body].oriented and d.chance(0.3)
        x, y = _amount(d, size), _amount(d, size)
        name = d.new("f")
        d.lines.append(
            f'm.force("{name}", {spot.text}, x={x.text},'
            f" y={y.text}{', turning=True' if turns else ''})"
        )
        d.loads[name] = functools.partial(_force, spot=spot, x=x, y=y, turns=turns)
    elif kind == "torque" and turning:
        spot, other = d.spot(d.choose(*turning)), d.spot(d.choose("ground", *turning))
        value, name = _amount(d, size), d.new("f")
        if other.body == spot.body:
            return
        against = "" if other.body == "ground" else f", against={other.text}"
        d.lines.append(f'm.torque("{name}", {spot.text}, {value.text}{against})')
        d.loads[name] = functools.partial(_torque, spot=spot, other=other, value=value)
    elif kind in ("spring", "damper"):
        first, second = d.spot(anything(d)), d.spot(d.choose(*d.bodies))
        if first.body == second.body or math.dist(d.place(first), d.place(second)) < 0.1:
            return
        stiffness, length = (
            (0.0, 0.0) if kind == "damper" else (d.between(1, 50) * size, d.between(0.0, 0.5))
        )
        damping = d.choose(0.0, d.between(0.1, 5.0)) if kind == "spring" else d.between(0.1, 5.0)
        numbers = (
            f"stiffness={stiffness!r}, length={length!r}, damping={damping!r}"
            if kind == "spring"
            else f"damping={damping!r}"
        )
        name = d.new("f")
        d.lines.append(f'm.{kind}("{name}", {first.text}, {second.text}, {numbers})')
        numbers = {"stiffness": stiffness, "length": length, "damping": damping}
        d.loads[name] = functools.partial(_spring, first=first, second=second, **numbers)
    elif kind == "torsion":
        joints = [j for j in d.movable() if not d.joints[j].slides and abs(d.coordinate(j)) < 2.0]
        if not joints:
            return
        joint = d.choose(*joints)
        stiffness = d.between(0.1, 5)
        angle = d.between(-1, 1)
        damping = d.choose(0.0, d.between(0.01, 1))
        numbers = f"stiffness={stiffness!r}, angle={angle!r}, damping={damping!r}"
        name = d.new("f")
        d.lines.append(f'm.torsion_spring("{name}", {joint}, {numbers})')
        numbers = {"stiffness": stiffness, "angle": angle, "damping": damping}
        d.loads[name] = functools.partial(_coil, joint=d.joints[joint], **numbers)


def line_load(d: Draft, rng: np.random.Generator, often: float) -> None:
    """A load along a link, or a part of it: even, linear, or a polynomial of the distance; by a
    generator of its own.
    """
    links = [name for name, body in d.bodies.items() if body.length]
    drawn, d.rng = d.rng, rng
    if links and d.chance(often):
        link, size = d.choose(*links), 10.0 ** d.choose(0, 1, 2, 4)
        length, turns, name = d.bodies[link].length, d.chance(0.4), d.new("f")
        start, end = (
            (0.0, length)
            if d.chance(0.4)
            else (d.between(0.0, 0.4) * length, d.between(0.5, 0.95) * length)
        )
        part = "" if end == length else f", between=({start!r}, {end!r})"
        shapes = [_shape(d, size / length, start, end) for _ in "xy"]
        texts = [text.format(amount.text) for text, amount, _ in shapes]
        d.lines.append(
            f'm.line_load("{name}", {link}, x={texts[0]},'
            f" y={texts[1]}{part}{', turning=True' if turns else ''})"
        )
        parts = [(amount, powers) for _, amount, powers in shapes]
        d.spreads[name] = functools.partial(
            _spread, link=link, start=start, end=end, parts=parts, turns=turns
        )
    d.rng = drawn


def one_way(d: Draft, rng: np.random.Generator, motions: list[oracle.Result]) -> None:
    """Up to two forces that are there on one side of a rate or a place, which the motion passes."""
    drawn, d.rng = d.rng, rng
    for _ in range(d.choose(1, 2)):
        for joint in map(str, d.rng.permutation(d.movable())):
            rate = d.chance(0.6)
            jets = [
                joint_coordinate(d.joints[joint], d.oracle(d.start).places(motion))
                for motion in motions
            ]
            turns = not rate and not d.joints[joint].slides
            seen = [jet.d if rate else math.sin(jet.v) if turns else jet.v for jet in jets]
            if max(map(abs, seen)) < 1e-3 or (not rate and max(seen) - min(seen) < 1e-3):
                continue
            if rate and min(map(abs, seen)) < 1e-9:
                continue  # at rest rounding decides the oracle's side
            (name,) = names = d.measured("coordinate", joint, rate=rate)
            told = f"sin({name})" if turns else name
            level = 0.0 if rate else d.between(*sorted((min(seen), max(seen))))
            size = repr(d.between(-1.0, 1.0) * 10.0 ** d.choose(0, 1, 2, 4))
            form = d.choose("{0} * ({1} > {2})", "{0} * ({1} < {2})", "{0} * {1} * ({1} > {2})")
            force = d.formula(form.format(size, told, level), names)
            spot, load = d.spot(d.choose(*d.bodies)), d.new("f")
            d.lines.append(f'm.force("{load}", {spot.text}, x={force.text}, y={force.text})')
            d.loads[load] = functools.partial(_force, spot=spot, x=force, y=force, turns=False)
            break
    d.rng = drawn


def strokes(d: Draft, rng: np.random.Generator, path: Path, often: float) -> None:
    """Give springs, dampers and cylinders ends that the motion does not reach, and make gas springs
    of some.
    """
    drawn, d.rng = d.rng, rng
    places = [d.oracle(d.start).places(motion) for motion in path.motions]
    held = {name: load.keywords for name, load in d.loads.items() if load.func is _spring}
    points = {name: (given["first"].point, given["second"].point) for name, given in held.items()}
    for name in (name for name in d.joints if f"{name}_barrel" in d.bodies):
        rod = d.bodies[f"{name}_rod"]
        points[name] = d.joints[name].parent, (rod.name, rod.length, 0.0)
    for name, ends in points.items():
        reach = [math.dist(*([x.v for x in place(end)[:2]] for end in ends)) for place in places]
        closed = 0.98 * min(reach) if name in held else d.bodies[f"{name}_rod"].length
        if 0.05 < closed < min(reach) and d.chance(often):
            d.strokes[name] = *ends, (float(closed), float(1.1 * max(reach)))
            i = next(i for i, line in enumerate(d.lines) if f'"{name}"' in line)
            head, *numbers = re.split(r", (?=stiffness|damping|closed|bore)", d.lines[i])
            told = [f"closed={closed!r}", f"open={1.1 * max(reach)!r}"]
            if name in held and d.chance(0.6):
                numbers, d.loads[name] = _gas_spring(d, name)
            elif name in held:
                numbers[-1] = numbers[-1].removesuffix(")")
                head = re.sub(r"m\.(spring|damper)\(", "strut(m, ", head)
            else:
                told, numbers[-1] = told[1:], numbers[-1].removesuffix(")")
            head = re.sub(r"m\.(spring|damper)\(", "gas_spring(m, ", head)
            d.lines[i] = f"{', '.join([head, *told, *numbers])})"
    d.rng = drawn


def _gas_spring(d: Draft, name: str):
    """Numbers of a gas spring as they are written, and what it does."""
    force, brake = d.between(1.0, 500.0), d.choose(0.0, d.between(1.0, 50.0))
    numbers = {
        "force": (force, force * d.choose(1.0, d.between(1.1, 3.0))),
        "exponent": d.choose(1.0, d.between(1.0, 1.7)),
        "damping": d.choose(0.0, d.between(0.1, 20.0)),
        "end_damping": brake,
        "end": d.between(0.02, 0.4),
    }
    acts = functools.partial(_gas, stroke=d.strokes[name], **numbers)
    return [f"{word}={x!r}" for word, x in numbers.items()], acts


def rotor(d: Draft, rng: np.random.Generator, often: float) -> None:
    """Rotors that joints turn, in housings on the joints' parents."""
    drawn, d.rng = d.rng, rng
    for joint in map(str, d.rng.permutation(d.movable())[:3]):
        if d.joints[joint].kind == "slot" or not d.chance(often):
            continue
        inertia, ratio = d.between(1e-5, 1e-3), d.choose(1.0, d.between(-60.0, 60.0))
        numbers = {
            "inertia": inertia,
            "ratio": ratio,
            "armature": d.choose(0.0, d.between(0.0, 0.5)),
        }
        name = d.new("f")
        told = ", ".join(f"{word}={x!r}" for word, x in numbers.items())
        more = ", effort=20.0, speed=3.0" if d.chance(0.3) else ""
        d.lines.append(f'm.drive("{name}", {joint}, rotor_{told}{more})')
        d.loads[name] = functools.partial(_rotor, joint=d.joints[joint], **numbers)
    d.rng = drawn


def _shape(d: Draft, size: float, start: float, end: float):
    """How a component is written around its amount, the amount, and coefficients of what it is
    times, by powers of the distance.
    """
    kind, amount = d.choose("even", "linear", "power"), _amount(d, size)
    if kind == "even":
        return "{0}", amount, [1.0]
    if kind == "linear":
        first, last = d.between(-1, 1), d.between(-1, 1)
        slope = (last - first) / (end - start)
        return f"({first!r} * ({{0}}), {last!r} * ({{0}}))", amount, [first - slope * start, slope]
    powers = [d.between(-1, 1) / end**k for k in range(d.choose(3, 4, 6))]
    return (
        f"lambda x: ({{0}}) * ({' + '.join(f'{c!r} * x**{k}' for k, c in enumerate(powers))})",
        amount,
        powers,
    )


def _spread(place, t, link, start, end, parts, turns):
    (ax, px), (ay, py) = parts
    sizes, phi = (ax.jet(place, t).v, ay.jet(place, t).v), place((link, 0.0, 0.0))[2].v
    c, s = (math.cos(phi), math.sin(phi)) if turns else (1.0, 0.0)

    def at(x):
        fx, fy = (
            size * sum(p * x**k for k, p in enumerate(powers))
            for size, powers in zip(sizes, (px, py), strict=True)
        )
        return c * fx - s * fy, s * fx + c * fy

    return [Spread(link, start, end, at)]


def _amount(d: Draft, size: float) -> Formula:
    """A load by numbers, time, places, rates, coordinates or parameters."""
    value = repr(d.between(-1.0, 1.0) * size)
    kinds = (
        "number",
        "time",
        "velocity",
        "place",
        "rate",
        "coordinate",
        "direction",
        "table",
        "parameter",
    )
    kind = d.choose(*kinds, weights=[5, 2, 1, 1, 1, 1, 1, 1, 1])
    joints = d.movable()
    if kind == "time":
        return d.formula(f"{value} * {d.choose('sin(5.0 * t)', 't', 'cos(t) * t')}", {})
    if kind in ("velocity", "place"):
        names = d.measured("place", d.spot(d.choose(*d.bodies)), rate=kind == "velocity")
        return d.formula(f"{value} * {d.choose(*names)}", names)
    if kind in ("rate", "coordinate") and joints:
        joint = d.choose(*joints)
        names = d.measured("coordinate", joint, rate=kind == "rate")
        (name,) = names
        turns = kind == "coordinate" and not d.joints[joint].slides
        return d.formula(f"{value} * sin({name})" if turns else f"{value} * {name}", names)
    turning = [name for name in d.bodies if d.bodies[name].oriented]
    if kind == "direction" and turning:
        (name,) = names = d.measured("direction", d.choose(*turning))
        return d.formula(f"{value} * cos({name})", names)
    if kind == "table":
        names = d.measured("place", d.spot(d.choose(*d.bodies)))
        low = d.between(-0.6, 0.2)
        places, values = [low, low + 0.237, low + 0.551], [d.between(-1, 1) for _ in range(3)]
        if values[0] > 0.0:
            places, values = [*places, low + 0.8], [*values, values[0]]
            return d.formula(
                f"{value} * curve({places}, {values}, periodic=True)({d.choose(*names)})", names
            )
        beyond = "hold" if values[1] > 0.0 else "line"
        return d.formula(
            f"{value} * table({d.choose(*names)}, {places}, {values}, beyond={beyond!r})", names
        )
    if kind == "parameter" and d.parametric:
        number = d.number(float(value), 0.5)
        return d.formula(number.text, {})
    return d.formula(value, {})


def _force(place, t, spot: Spot, x: Formula, y: Formula, turns: bool):
    fx, fy = x.jet(place, t).v, y.jet(place, t).v
    if turns:
        c, s = (f(place((spot.body, 0.0, 0.0))[2].v) for f in (math.cos, math.sin))
        fx, fy = c * fx - s * fy, s * fx + c * fy
    return [(spot.point, fx, fy, 0.0)]


def _torque(place, t, spot: Spot, other: Spot, value: Formula):
    couple = value.jet(place, t).v
    return [(spot.point, 0.0, 0.0, couple), (other.point, 0.0, 0.0, -couple)]


def _spring(place, _, first: Spot, second: Spot, stiffness: float, length: float, damping: float):
    (ax, ay, _), (bx, by, _) = place(first.point), place(second.point)
    dx, dy = bx - ax, by - ay
    reach = math.hypot(dx.v, dy.v)
    tension = stiffness * (reach - length) + damping * (dx.v * dx.d + dy.v * dy.d) / reach
    fx, fy = tension * dx.v / reach, tension * dy.v / reach
    return [(first.point, fx, fy, 0.0), (second.point, -fx, -fy, 0.0)]


def _gas(place, _, stroke, force, exponent, damping, end_damping, end):
    """Gas that is shut in keeps p V^n; its volume grows as the rod comes out, by that when open."""
    first, second, (closed, out) = stroke
    (ax, ay, _), (bx, by, _) = place(first), place(second)
    dx, dy, reach = bx - ax, by - ay, math.hypot(bx.v - ax.v, by.v - ay.v)
    least = (force[0] / force[1]) ** (1.0 / exponent)
    push = force[0] / (least + (1.0 - least) * (reach - closed) / (out - closed)) ** exponent
    damping += end_damping * min(max((reach - (out - end)) / end, 0.0), 1.0)
    pull = damping * (dx.v * dx.d + dy.v * dy.d) / reach - push
    fx, fy = pull * dx.v / reach, pull * dy.v / reach
    return [(first, fx, fy, 0.0), (second, -fx, -fy, 0.0)]


def _rotor(place, _, joint: oracle.Joint, inertia: float, ratio: float, armature: float):
    """What a rotor's inertia does against its housing and its joint, by a gear that loses nothing.

    A rotor along a slide turns about a line in the plane: its couples do not act there.
    """
    change = joint_coordinate(joint, place).a
    carried = 0.0 if joint.slides else place((joint.parent[0], 0.0, 0.0))[2].a
    couple = inertia * (carried + ratio * change)  # on the rotor
    on_housing = inertia * carried - couple  # what turns with the housing is the body's own
    housed = [] if joint.slides else [(joint.parent, 0.0, 0.0, on_housing)]
    return housed + Measure("coordinate", joint).does(place, -ratio * couple - armature * change)


def _coil(place, _, joint: oracle.Joint, stiffness: float, angle: float, damping: float):
    bend = joint_coordinate(joint, place)
    couple = -stiffness * (bend.v - angle) - damping * bend.d
    return Measure("coordinate", joint).does(place, couple)
