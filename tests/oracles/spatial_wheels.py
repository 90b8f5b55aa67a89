"""Random wheels that roll on a plane: it leans any way, the plane lies any way, and turns where it
is a deck.
"""

from __future__ import annotations

import math

import numpy as np
from spatial_bodies import GROUND, Joint, Mechanism, Row
from spatial_draft import Drawn, Law, Sum, acting, direction, orientation, rigid, rod, swing

_X, _Y, _Z = np.eye(3)
_RATES = (("x", 0), ("y", 0), ("yaw", 0), ("shaft", 0))
_STRAIGHT_UP = np.array([_Z, _Y, np.cross(_Z, _Y)]).T + 0.0
"""A strut's x is up, its y to the left."""


def wheel(seed: int) -> Drawn:
    """Two slides lead to the contact, a yaw and a lean to a strut, and a shaft at its tip to the
    wheel.

    The contact's path has a heading that turns steadily, and a speed that swings about another: so
    path and spin have closed forms. What rolls is told by rates of coordinates, or, on a plane at
    rest, by the velocity of the contact.
    """
    rng = np.random.default_rng(seed)
    radius, by_points = rng.uniform(0.2, 0.5), seed % 3 == 0
    bodies = [rigid(rng, name) for name in ("deck", "stage", "saddle", "fork", "wheel")]
    strut = rod(rng, "strut", radius, slender=True)
    lies = orientation(rng)
    joints = [
        Joint(
            "hinge",
            "weld" if by_points else "revolute",
            GROUND,
            "deck",
            rng.normal(size=3) * 0.3,
            axis=direction(rng),
            orientation=lies,
        ),
        Joint("x", "prismatic", "deck", "stage", (0.0, 0.0, 0.1), axis=_X),
        Joint("y", "prismatic", "stage", "saddle", (0.0, 0.0, 0.0), axis=_Y),
        Joint("yaw", "revolute", "saddle", "fork", axis=_Z),
        Joint("lean", "revolute", "fork", "strut", axis=_X, orientation=_STRAIGHT_UP),
        Joint(
            "shaft",
            "revolute",
            "strut",
            "wheel",
            (radius, 0.0, 0.0),
            axis=_Y,
            orientation=orientation(rng),
        ),
    ]
    heading, turn, speed, more, beat = (
        rng.uniform(a, b) for a, b in ((-0.4, 0.4), (0.3, 0.6), (0.5, 1.5), (0.1, 0.4), (1.0, 3.0))
    )
    shares = ((turn, speed), (turn + beat, more / 2), (turn - beat, more / 2))

    def path(start, behind):
        return Sum(
            (
                Law(start),
                *(Law(0.0, 0.0, size / rate, rate, heading - behind) for rate, size in shares),
            )
        )

    laws = {
        ("x", 0): path(rng.normal(), 0.0),
        ("y", 0): path(rng.normal(), math.pi / 2),
        ("yaw", 0): Law(heading, turn),
        ("lean", 0): swing(rng, rng.uniform(-0.4, 0.4), 0.5),
        ("shaft", 0): Law(rng.uniform(-3, 3), speed / radius, more / beat / radius, beat),
    }
    if not by_points:
        laws["hinge", 0] = swing(rng)

    def along(a, q):
        return (a.cos(q["yaw", 0]), a.sin(q["yaw", 0]))

    def tied(ways, terms):
        if not by_points:
            return terms | {("x", 0): ways[0], ("y", 0): ways[1]}, {}
        return terms, {
            ("saddle", (0.0, 0.0, 0.0)): [
                ways[0] * x + ways[1] * y for x, y in zip(lies[:, 0], lies[:, 1], strict=True)
            ]
        }

    def rolling(a, q):
        return tied(along(a, q), {("shaft", 0): -radius})

    def no_slip(a, q):
        c, s = along(a, q)
        return tied((-s, c), {})

    rows = [
        Row("rolling", _RATES, rolling, ("shaft", 0)),
        Row("no_slip", _RATES, no_slip, ("y", 0)),
    ]
    pushed = [key for key in laws if key not in (("shaft", 0), ("y", 0))]
    mechanism = Mechanism([*bodies, strut], joints, rows=rows, **acting(rng, [*bodies, strut]))
    return Drawn(mechanism, laws, pushed=pushed, span=0.8)
