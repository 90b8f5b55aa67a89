"""Random mechanisms in space, each by a seed: open trees and arms, and loops of known families,
with their motions and guesses.

A loop is drawn again until it moves well over its whole span; what it is then is always the same
for a seed.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from collections.abc import Callable, Sequence

import numpy as np
from spatial_algebra import turn
from spatial_bodies import AXES, GROUND, KINDS, Joint, Load, Mechanism, Rigid
from spatial_draft import (
    Drawn,
    Law,
    across,
    acting,
    body,
    direction,
    frame,
    joint,
    orientation,
    point_on,
    rigid,
    rod,
    swing,
)
from spatial_motion import OpenLoopError

STEADY = 0.02
_X, _Y, _Z = np.eye(3)


def steady(draw: Callable[..., Drawn], name: str = "", *told) -> Callable[[int], Drawn]:
    """The first of a seed's draws that closes, is well away from singular all along, and has no
    idle spin but its own; ``told`` goes to the draw beside its generator.
    """

    @functools.cache
    def of(seed: int) -> Drawn:
        for attempt in range(100):
            try:
                drawn = draw(np.random.default_rng([seed, attempt]), *told)
                slopes = [slope for _, slope in drawn.path]
            except OpenLoopError:
                continue
            if all(
                slope.least > STEADY and not slope.vague and slope.null.shape[1] == drawn.idle
                for slope in slopes
            ):
                return drawn
        raise AssertionError(f"no draw of seed {seed} moves well")

    of.__name__, of.__doc__ = name or draw.__name__, draw.__doc__
    return of


def tree(seed: int, links: int | None = None, kinds: Sequence[str] = KINDS) -> Drawn:
    """An open tree of one to six bodies, all of its coordinates driven."""
    rng = np.random.default_rng(seed)
    bodies = [body(rng, f"b{i}") for i in range(links or rng.integers(1, 7))]
    joints, laws = [], {}
    for i, one in enumerate(bodies):
        parent = bodies[rng.integers(0, i)] if i and rng.random() < 0.85 else None
        at_parent = point_on(rng, parent) if parent else rng.normal(size=3) * 0.5
        at_child = rng.normal(size=3) * 0.1 if rng.random() < 0.2 else (0, 0, 0)
        kind = str(rng.choice(kinds))
        joints.append(
            joint(
                rng, f"j{i}", kind, parent.name if parent else GROUND, one.name, at_parent, at_child
            )
        )
        turning = joints[-1].turning
        for k in range(joints[-1].count):
            # The second of three turns stays away from a right angle, where the two others meet.
            middle = len(turning) == 3 and k == turning[1]
            around = (
                0.0
                if middle
                else rng.uniform(-0.3, 0.3)
                if k not in turning
                else rng.uniform(-3, 3)
            )
            laws[f"j{i}", k] = swing(
                rng, around, 0.8 if middle else 0.3 if k not in turning else 1.0
            )
    return Drawn(Mechanism(bodies, joints, **acting(rng, bodies)), laws)


def arm(seed: int, joints: int = 6, slender: bool = False) -> Drawn:
    """A chain of rods by revolute joints, and a payload welded to its tip."""
    rng = np.random.default_rng(seed)
    links = [rod(rng, f"l{i}", slender=slender) for i in range(joints)]
    pins = []
    for i, one in enumerate(links):
        parent, at = (links[i - 1].name, (links[i - 1].length, 0, 0)) if i else (GROUND, (0, 0, 0))
        pins.append(joint(rng, f"j{i}", "revolute", parent, one.name, at))
    payload = rigid(rng, "payload", 0.1)
    weld = joint(
        rng, "grip", "weld", links[-1].name, "payload", (links[-1].length, 0, 0), (0.02, 0.01, 0.0)
    )
    mechanism = Mechanism([*links, payload], [*pins, weld], gravity=(0, 0, -9.81))
    return Drawn(mechanism, {(f"j{i}", 0): swing(rng, rng.uniform(-3, 3)) for i in range(joints)})


def _pivot(rng, name, one, at, length):
    """A body that turns about a fixed axis, with the place of its tip at coordinate zero, and its
    axes there.
    """
    R, n = orientation(rng), direction(rng)
    return (
        Joint(name, "revolute", GROUND, one.name, at, axis=n, orientation=R),
        at + R @ [length, 0.0, 0.0],
        R,
    )


def _coupler(rng, ends, a, b, first, second, universal):
    """A rod from ``a`` to ``b`` between a spherical joint and a spherical or universal one; every
    coordinate is zero there.
    """
    length = float(np.linalg.norm(b - a))
    one, R = rod(rng, "coupler", length, slender=not universal), frame(b - a, rng)
    axis = direction(rng) if rng.random() < 0.5 else across(rng, [1.0, 0.0, 0.0])
    kind = "universal" if universal else "spherical"
    A = Joint("A", "spherical", first, "coupler", ends[0])
    B = Joint(
        "B",
        kind,
        "coupler",
        second,
        (length, 0, 0),
        ends[1],
        axis,
        across(rng, axis),
        orientation=R.T @ ends[2] if universal else AXES,
    )
    return one, A, B, {"coupler": (a, R)}


def _loop(rng, universal, slides):
    crank, far = rod(rng, "crank", rng.uniform(0.1, 0.2)), rng.normal(size=3) * 0.25
    O, a, _ = _pivot(rng, "O", crank, rng.normal(size=3) * 0.1, crank.length)
    if slides:
        last, at_last, R = rigid(rng, "slider", 0.1), (0, 0, 0), orientation(rng)
        Q = Joint("Q", "prismatic", GROUND, "slider", far, axis=direction(rng), orientation=R)
        b = far
    else:
        last = rod(rng, "rocker", rng.uniform(0.25, 0.4))
        at_last = (last.length, 0, 0)
        Q, b, R = _pivot(rng, "Q", last, far, last.length)
    coupler, A, B, guess = _coupler(
        rng, ((crank.length, 0, 0), at_last, R), a, b, "crank", last.name, universal
    )
    bodies = [crank, coupler, last]
    law = Law(0.0, rng.uniform(2, 6), rng.uniform(0.0, 0.2), rng.uniform(1, 4), 0.0)
    return Drawn(
        Mechanism(bodies, [O, A, B, Q], **acting(rng, [crank, last])),
        {("O", 0): law},
        guess | {("Q", 0): 0.0},
        span=0.25,
        idle=int(not universal),
    )


# Four-bars and slider-cranks of skew axes, the coupler between two spherical joints, where it may
# spin, or held by a universal joint at the end.
rssr, rsur = (steady(_loop, name, name == "rsur", False) for name in ("rssr", "rsur"))
rssp, rsup = (steady(_loop, name, name == "rsup", True) for name in ("rssp", "rsup"))


@steady
def stewart(rng) -> Drawn:
    """A Stewart-Gough platform of six legs, its pose prescribed, the efforts in its legs."""
    at, tilt = np.array([0.0, 0.0, rng.uniform(0.5, 0.7)]), rng.uniform(-0.2, 0.2, 3)
    bodies = [rigid(rng, "platform", 0.3)]
    joints = [Joint("pose", "free", GROUND, "platform")]
    guess = {}
    places = [swing(rng, x, 0.04) for x in at]
    turns = [swing(rng, x, 0.1) for x in tilt]
    laws = {("pose", k): law for k, law in enumerate([*places, *turns])}
    x, y, z, a, b, c = (law.at(0.0)[0] for law in laws.values())
    R = turn(_X, a) @ turn(_Y, b) @ turn(_Z, c)
    for i in range(6):
        base, top = (_corner(rng, i, *ring) for ring in ((0.5, 0.2), (0.3, 0.8)))
        way = np.array([x, y, z]) + R @ top - base
        cylinder = body(rng, f"cylinder{i}", rng.uniform(0.3, 0.45))
        piston = body(rng, f"piston{i}", rng.uniform(0.35, 0.5))
        reach = rng.uniform(0.35, 0.5) if isinstance(piston, Rigid) else piston.length
        axes = frame(way, rng)
        bodies += [cylinder, piston]
        joints += [
            Joint(
                f"U{i}",
                "universal",
                GROUND,
                cylinder.name,
                base,
                axis=axes[:, 1],
                axis2=axes[:, 2],
                orientation=axes,
            ),
            Joint(f"P{i}", "prismatic", cylinder.name, piston.name, axis=(1, 0, 0)),
            Joint(f"S{i}", "spherical", piston.name, "platform", (reach, 0, 0), top),
        ]
        guess[f"P{i}", 0] = float(np.linalg.norm(way)) - reach
    acts = acting(rng, bodies[:1])
    return Drawn(
        Mechanism(bodies, joints, **acts), laws, guess, [(f"P{i}", 0) for i in range(6)], steps=1
    )


def _corner(rng, i, radius, spread):
    angle = 2 * math.pi * (i // 2) / 3 + (spread if i % 2 else -spread) + rng.uniform(-0.05, 0.05)
    return np.array([radius * math.cos(angle), radius * math.sin(angle), rng.uniform(-0.02, 0.02)])


def _planar(rng, slides):
    R, at = orientation(rng), rng.normal(size=3)
    r, l, s = (x * rng.uniform(0.9, 1.1) for x in (0.1, 0.35, 0.25))
    x, y = (0.3 * rng.uniform(0.9, 1.1), 0.05 if slides else 0.0)
    crank, coupler = rod(rng, "crank", r, slender=True), rod(rng, "coupler", l, slender=True)
    law = Law(rng.uniform(0, 6), rng.uniform(2, 8), 0.1, 3.0, 0.0)
    angle = law.at(0.0)[0]
    a = r * np.array([math.cos(angle), math.sin(angle)])
    if slides:
        last = rigid(rng, "slider", 0.05)
        lean = math.asin((y - a[1]) / l)
        guess = {("Q", 0): a[0] + l * math.cos(lean)}
        far, Q = R @ [0, y, 0], {"kind": "prismatic", "axis": R[:, 0]}
    else:
        last = rod(rng, "rocker", s, slender=True)
        way = np.array([x, 0.0]) - a
        d = float(np.linalg.norm(way))
        lean = math.atan2(way[1], way[0]) + math.acos((d * d + l * l - s * s) / (2 * d * l))
        b = a + l * np.array([math.cos(lean), math.sin(lean)])
        guess = {("Q", 0): math.atan2(b[1], b[0] - x)}
        far, Q = R @ [x, 0, 0], {"kind": "revolute", "axis": R[:, 2]}
    joints = [
        Joint("O", "revolute", GROUND, "crank", at, axis=R[:, 2], orientation=R),
        Joint("A", "revolute", "crank", "coupler", (r, 0, 0), axis=_Z),
        Joint(
            "B",
            "revolute",
            "coupler",
            last.name,
            (l, 0, 0),
            (0, 0, 0) if slides else (last.length, 0, 0),
            axis=_Z,
        ),
        Joint("Q", parent=GROUND, child=last.name, at_parent=at + far, orientation=R, **Q),
    ]
    guess |= {("A", 0): lean - angle}
    mechanism = Mechanism([crank, coupler, last], joints, gravity=direction(rng) * 9.81)
    return Drawn(mechanism, {("O", 0): law}, guess, span=0.5)


# Of spatial pins, somewhere in space: three reactions are open.
planar_four_bar = steady(_planar, "planar_four_bar", False)
planar_slider_crank = steady(_planar, "planar_slider_crank", True)


def _ring(rng, lengths, twists, angles, law):
    """A ring of links, each with its axes about z at its base and turned by its twist about x at
    its tip; the last is fixed.
    """
    turned = [turn(_X, twist) for twist in twists]
    R, at, last = orientation(rng), rng.normal(size=3), len(lengths) - 1
    names = [f"l{i}" for i in range(last)]
    joints = [Joint("j0", "revolute", GROUND, names[0], at, axis=R[:, 2], orientation=R)]
    for i, (one, other) in enumerate(itertools.pairwise(names)):
        joints.append(
            Joint(
                f"j{i + 1}",
                "revolute",
                one,
                other,
                (lengths[i], 0, 0),
                axis=turned[i][:, 2],
                orientation=turned[i],
            )
        )
    # The ground's own end of the ring is where a link of its length and twist leads back to the
    # first joint.
    back, tip = R @ turned[last].T, (lengths[last - 1], 0, 0)
    fixed = {"axis": back[:, 2], "orientation": back @ turned[last - 1].T}
    joints.append(
        Joint(
            f"j{last}",
            "revolute",
            GROUND,
            names[-1],
            at + back @ [-lengths[last], 0, 0],
            tip,
            **fixed,
        )
    )
    guess = {(f"j{i}", 0): angles[i] * (-1 if i == last else 1) for i in range(1, last + 1)}
    bodies = [rod(rng, name, lengths[i]) for i, name in enumerate(names)]
    return Drawn(
        Mechanism(bodies, joints, gravity=direction(rng) * 9.81), {("j0", 0): law}, guess, span=0.3
    )


@steady
def bennett(rng) -> Drawn:
    """Bennett's loop of four revolute joints: three reactions are open."""
    a, twist, other = (rng.uniform(*ends) for ends in ((0.3, 0.6), (0.5, 0.9), (1.1, 1.5)))
    b = a * math.sin(other) / math.sin(twist)
    law = Law(rng.uniform(0.6, 2.0), rng.uniform(1, 3), 0.05, 5.0, 0.0)
    first = law.at(0.0)[0]
    second = 2 * math.atan(
        math.sin((other + twist) / 2) / math.sin((other - twist) / 2) / math.tan(first / 2)
    )
    return _ring(
        rng, [a, b, a, b], [twist, other, twist, other], [first, second, -first, -second], law
    )


@steady
def bricard(rng) -> Drawn:
    """Bricard's loop of six revolute joints at right angles, links of one length: one reaction is
    open.
    """
    length, right = rng.uniform(0.4, 1.0), math.pi / 2
    law = Law(rng.uniform(1.3, 1.7), rng.uniform(-1, 1), 0.02, 5.0, 0.0)
    first = law.at(0.0)[0]
    second = -math.acos(-math.cos(first) / (1 + math.cos(first)))
    return _ring(rng, [length] * 6, [right, -right] * 3, [first, -second] * 3, law)


_FREEDOMS = {
    "revolute": 1,
    "prismatic": 1,
    "screw": 1,
    "cylindrical": 2,
    "universal": 2,
    "planar": 3,
    "spherical": 3,
    "slot": 4,
}


def _kinds(rng):
    """Kinds of joints that have seven freedoms, at most one with three turns, the first a single
    one.
    """
    while True:
        kinds = [
            str(rng.choice(["revolute", "prismatic", "screw"])),
            *rng.choice([*_FREEDOMS], rng.integers(2, 6)),
        ]
        if (
            sum(_FREEDOMS[kind] for kind in kinds) == 7
            and sum(kind in ("spherical", "slot") for kind in kinds) < 2
        ):
            return [str(kind) for kind in kinds]


@steady
def loop(rng) -> Drawn:
    """One loop of any joints with seven freedoms in all, the first driven; all coordinates are zero
    at the start.
    """
    kinds = _kinds(rng)
    points = [rng.normal(size=3) * 0.4 for _ in kinds]
    bodies, poses = [], {GROUND: (np.zeros(3), np.eye(3))}
    for i, (start, end) in enumerate(itertools.pairwise(points)):
        bodies.append(body(rng, f"b{i}", float(np.linalg.norm(end - start))))
        poses[f"b{i}"] = (
            start,
            orientation(rng) if isinstance(bodies[-1], Rigid) else frame(end - start, rng),
        )
    names, joints = [GROUND, *(b.name for b in bodies), GROUND], []
    for i, (kind, at) in enumerate(zip(kinds, points, strict=True)):
        parent, child = (names[i], names[i + 1]) if i + 1 < len(kinds) else (GROUND, names[i])
        (r, R), (s, S) = poses[parent], poses[child]
        drawn = joint(rng, f"j{i}", kind, parent, child, R.T @ (at - r), S.T @ (at - s))
        joints.append(dataclasses.replace(drawn, orientation=R.T @ S))
    law = Law(0.0, rng.uniform(0.2, 2.0), rng.uniform(0.0, 0.05), 3.0, 0.0)
    guess = {name: pose for name, pose in poses.items() if name != GROUND}
    return Drawn(
        Mechanism(bodies, joints, **acting(rng, bodies)), {("j0", 0): law}, guess, span=0.2
    )


@steady
def suspension(rng) -> Drawn:
    """A wheel's hub on five bars between spherical joints: its height is driven, and a load acts
    where the tyre stands.
    """
    hub, at = rigid(rng, "hub", 0.15), np.array([0.0, 0.7, 0.3]) + rng.normal(size=3) * 0.02
    ends = [
        (0.15, -0.05, 0.12),
        (-0.15, -0.05, 0.1),
        (0.12, -0.05, -0.12),
        (-0.12, -0.05, -0.1),
        (0.05, -0.08, -0.02),
    ]
    inner = [
        (0.25, 0.35, 0.4),
        (-0.25, 0.35, 0.38),
        (0.3, 0.25, 0.2),
        (-0.3, 0.25, 0.22),
        (0.15, 0.3, 0.29),
    ]
    bodies = [hub]
    joints = [Joint("travel", "free", GROUND, "hub")]
    guess = {"hub": (at, np.eye(3))}
    for i, (end, base) in enumerate(zip(ends, inner, strict=True)):
        end, base = (np.array(x) + rng.normal(size=3) * 0.02 for x in (end, base))
        way = at + end - base
        bodies.append(rod(rng, f"bar{i}", float(np.linalg.norm(way)), slender=True))
        guess[f"bar{i}"] = base, frame(way, rng)
        joints += [
            Joint(f"C{i}", "spherical", GROUND, f"bar{i}", base),
            Joint(f"H{i}", "spherical", f"bar{i}", "hub", (bodies[-1].length, 0, 0), end),
        ]
    tyre = Load("hub", (0, 0.05, -0.3), rng.normal(size=3) * 300, (0, 0, 0))
    law = Law(at[2], 0.0, rng.uniform(0.02, 0.06), rng.uniform(2, 6), 0.0)
    return Drawn(
        Mechanism(bodies, joints, loads=[tyre], gravity=(0, 0, -9.81)),
        {("travel", 2): law},
        guess,
        span=0.5,
        idle=5,
    )


FAMILIES = {
    f.__name__: f
    for f in (
        *(tree, arm, rssr, rsur, rssp, rsup, loop, stewart, suspension),
        *(planar_four_bar, planar_slider_crank, bennett, bricard),
    )
}
