"""A connecting rod of a textbook: an I-section, higher at the big end than at the small one, in a
four-stroke engine.
"""

from math import pi

import casadi as ca

from lagrange_casadi import Mechanism, Scene, beams, bearings, table
from lagrange_casadi.motion import polynomial

# Gauge pressure, over the largest one, over the crank's angle [deg] from the top dead centre at the
# start of the intake.
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

STEEL = beams.Material(
    "forged steel", 8000.0, 210e9, yield_strength=320e6, ultimate=540e6, endurance=180e6
)


def scene() -> Scene:
    m = Mechanism("connecting_rod")
    rpm = m.parameter("rpm", 1800.0, "1/min", low=0.0)
    pressure = m.parameter("pressure", 3.15e6, "Pa", low=0.0)
    bore = m.parameter("bore", 0.1, "m", low=0.0)
    t = m.parameter("t", 0.007, "m", low=0.001, high=0.02)  # of web and flanges
    height = m.parameter("height", 0.035, "m", low=0.0)  # in the middle of the rod
    width = m.parameter("width", 0.028, "m", low=0.0)
    big, small = (
        m.parameter("big", 1.2, low=0.5),
        m.parameter("small", 0.9, low=0.5),
    )  # heights at the ends, over that
    middle, big_end, small_end = (
        beams.i_section(k * height, width, t, t) for k in (1.0, big, small)
    )
    shank = beams.along([0.0, 0.5, 1.0], [big_end, middle, small_end])
    rod = m.link("rod", length=0.38, beam=beams.Beam(shank, STEEL))
    web = beams.rectangle(
        m.parameter("crank_height", 0.09, "m", low=0.0),
        m.parameter("crank_width", 0.03, "m", low=0.0),
    )
    crank = m.link("crank", length=0.095, beam=beams.Beam(web, STEEL))
    piston = m.point_mass("piston", 2.25)
    main = m.revolute("main", m.ground, crank)
    crankpin, piston_pin = (
        m.revolute("crankpin", crank.tip, rod),
        m.revolute("piston_pin", rod.tip, piston),
    )
    bearings.fit(m, crankpin, bearings.Plain(bore=0.044, width=0.058, pressure=10e6))
    bearings.fit(m, piston_pin, bearings.Plain(bore=0.029, width=0.058, pressure=15e6))
    m.prismatic("bore", m.ground, piston, axis=(0, 1))
    turned = ca.fmod(m.coordinate(main) - pi / 2, 4 * pi) * 180 / pi
    share = table(turned, ANGLES, PRESSURES, beyond="hold") / max(PRESSURES)
    m.force("gas", piston, y=-pressure * share * pi / 4 * bore**2)
    motion = {"main": polynomial(pi / 2, 2 * pi / 60 * rpm)}
    return Scene(
        m,
        motion,
        t=(0, 0.07, 141),
        over=("main", "90 deg", "810 deg", 721),
        posture={"rod": pi / 2},
    )
