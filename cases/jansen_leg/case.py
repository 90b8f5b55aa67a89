"""A leg of Theo Jansen's walking beasts: a crank moves a knee and a shin so that the foot goes
straight on the ground.
"""

from math import pi, sqrt

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.model.declared_parts import Link
from lagrange_casadi.motion import polynomial

PER_LENGTH = 0.4
"""The mass of a tube [kg/m]."""


def scene() -> Scene:
    m = Mechanism("jansen_leg")
    rpm = m.parameter("rpm", 40.0, "1/min")
    push = m.parameter("push", 60.0, "N", low=0.0)
    # Jansen's numbers, in centimetres, from a to l; the crank is his m.
    numbers = (38, 41.5, 39.3, 40.1, 55.8, 39.4, 36.7, 65.7, 49, 50, 61.9, 7.8, 15)
    a, b, c, d, e, f, g, h, i, j, k, l, radius = (x / 100 for x in numbers)

    def tube(name: str, length: float) -> Link:
        return m.link(name, length=length, mass=PER_LENGTH * length)

    crank, rocker, coupler = tube("crank", radius), tube("rocker", c), tube("coupler", f)
    upper_rod, lower_rod = tube("upper_rod", j), tube("lower_rod", k)
    # Triangles of three tubes each, by their centres of mass and inertias.
    knee = _triangle(m, "knee", b, d, e)
    shin = _triangle(m, "shin", g, i, h)
    pivot = m.ground.at(-a, -l)
    m.revolute("O", m.ground, crank)
    m.revolute("hip", pivot, knee)
    m.revolute("back", pivot, rocker)
    m.revolute("upper", crank.tip, upper_rod)
    m.revolute("lower", crank.tip, lower_rod)
    m.revolute("top", upper_rod.tip, knee.tip)
    m.revolute("heel", lower_rod.tip, rocker.tip)
    m.revolute("ankle", rocker.tip, shin)
    m.revolute("outer", knee.at(*_apex(b, d, e)), coupler)
    m.revolute("joint", coupler.tip, shin.tip)
    foot = shin.at(*_apex(g, i, h))
    m.path("foot", foot)
    m.force("stand", foot, y=push)
    posture = {"knee": 1.6, "rocker": -1.9, "shin": 2.9}
    return Scene(m, {"O": polynomial(0, -2 * pi / 60 * rpm)}, t=(0, 1.5, 361), posture=posture)


def _apex(base: float, near: float, far: float) -> tuple[float, float]:
    """The third corner of a triangle on a link, by its distances from the link's base and tip; on
    the left.
    """
    x = (base**2 + near**2 - far**2) / (2 * base)
    return x, sqrt(near**2 - x**2)


def _triangle(m: Mechanism, name: str, base: float, near: float, far: float) -> Link:
    """A link with two more tubes to a third corner."""
    x, y = _apex(base, near, far)
    corners = ((0.0, 0.0), (base, 0.0)), ((0.0, 0.0), (x, y)), ((base, 0.0), (x, y))
    masses = [PER_LENGTH * length for length in (base, near, far)]
    middles = [((p[0] + q[0]) / 2, (p[1] + q[1]) / 2) for p, q in corners]
    mass = sum(masses)
    cx, cy = (
        sum(w * middle[n] for w, middle in zip(masses, middles, strict=True)) / mass
        for n in range(2)
    )
    inertia = sum(
        w * (length**2 / 12 + (u - cx) ** 2 + (v - cy) ** 2)
        for w, length, (u, v) in zip(masses, (base, near, far), middles, strict=True)
    )
    return m.link(name, length=base, mass=mass, centre=(cx, cy), inertia=inertia)
