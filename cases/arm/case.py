"""A three-link arm with a payload: every joint driven, the last two drives between moving links."""

from math import pi

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.density import polynomial as taper
from lagrange_casadi.motion import harmonic


def scene() -> Scene:
    m = Mechanism("arm")
    payload = m.parameter("payload", 5.0, "kg", low=0.0)
    upper = m.link("upper", length=0.6, density=taper(20.0, -8.0))
    fore = m.link("fore", length=0.5, density=taper(10.0, -5.0))
    hand = m.link("hand", length=0.2, mass=0.8)
    load = m.point_mass("load", payload)
    m.revolute("shoulder", m.ground, upper)
    m.revolute("elbow", upper.tip, fore)
    m.revolute("wrist", fore.tip, hand)
    m.weld("grip", hand.tip, load)
    return Scene(
        m,
        motion={
            "shoulder": harmonic(pi / 4, pi / 6, 0.5),
            "elbow": harmonic(pi / 6, pi / 5, 1.0),
            "wrist": harmonic(-pi / 8, pi / 4, 1.0, pi / 2),
        },
        t=(0, 2, 401),
    )
