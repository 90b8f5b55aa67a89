"""A four-stroke engine: an offset slider-crank with a tapered rod and the pressure of its gas, two
turns of the crank.
"""

from math import pi

import casadi as ca

from lagrange_casadi import Mechanism, Scene, table
from lagrange_casadi.density import polynomial as taper
from lagrange_casadi.motion import polynomial

# Gauge pressure [bar] over the crank's angle [deg] from the top dead centre at the start of the
# intake.
ANGLES = (
    0,
    20,
    180,
    220,
    260,
    300,
    320,
    335,
    350,
    360,
    368,
    375,
    390,
    410,
    440,
    480,
    520,
    540,
    560,
    600,
    700,
    720,
)
PRESSURES = (
    0.3,
    -0.2,
    -0.2,
    0.1,
    0.9,
    3.4,
    6.5,
    10.5,
    18,
    27,
    42,
    45,
    30,
    15,
    6.5,
    3.2,
    2.0,
    1.4,
    0.6,
    0.3,
    0.3,
    0.3,
)


def scene() -> Scene:
    m = Mechanism("engine")
    stroke = m.parameter("stroke", 0.08, "m", low=0.0)
    offset = m.parameter("offset", 0.005, "m")
    bore = m.parameter("bore", 0.08, "m", low=0.0)
    crank = m.link("crank", length=stroke / 2, mass=1.2, centre=(0.006, 0.0), inertia=6e-4)
    rod = m.link("rod", length=0.14, density=taper(6.0, -6.5, 4.5))
    piston = m.point_mass("piston", 0.45)
    main = m.revolute("main", m.ground, crank)
    m.revolute("big_end", crank.tip, rod)
    m.weld("bolts", rod.at(0.012, 0.02), m.point_mass("bolt", 0.05))
    m.revolute("small_end", rod.tip, piston)
    m.prismatic("bore_wall", m.ground.at(offset, 0), piston, axis=(0, 1))
    turned = ca.fmod(m.coordinate(main) - pi / 2, 4 * pi) * 180 / pi
    pressure = 1e5 * table(turned, ANGLES, PRESSURES, beyond="hold")
    m.force("gas", piston, y=-pressure * pi / 4 * bore**2)
    speed = 3000 * 2 * pi / 60
    return Scene(
        m, motion={"main": polynomial(pi / 2, speed)}, t=(0, 0.04, 1441), posture={"rod": pi / 2}
    )
