"""A four-stroke engine of six cylinders in two banks on three pins of one crankshaft, over a
working cycle.
"""

from math import pi

import casadi as ca

from lagrange_casadi import Scene, SpatialMechanism, table
from lagrange_casadi.elements import bent_bar, two_bearings
from lagrange_casadi.motion import polynomial

# Gauge pressure [bar] over the crank's angle [deg] from the top dead centre at the start of the
# intake; it fires at 360.
ANGLES = (
    *(0, 20, 180, 220, 260, 300, 320, 335, 350, 360, 368),
    *(375, 390, 410, 440, 480, 520, 540, 560, 600, 700, 720),
)
PRESSURES = (
    *(0.3, -0.2, -0.2, 0.1, 0.9, 3.4, 6.5, 10.5, 18, 27, 42),
    *(45, 30, 15, 6.5, 3.2, 2.0, 1.4, 0.6, 0.3, 0.3, 0.3),
)

CYLINDERS = {  # the number of its throw, the side of its bank, and the turn in which it fires
    "left_1": (0, 1, 0),
    "left_2": (1, 1, 0),
    "left_3": (2, 1, 1),
    "right_1": (0, -1, 1),
    "right_2": (1, -1, 0),
    "right_3": (2, -1, 1),
}
JOURNAL, PIN = 0.05, 0.06
"""Lengths along the crankshaft of a journal with its half cheeks, and of a pin [m]."""


def scene() -> Scene:
    m = SpatialMechanism("v6")
    stroke = m.parameter("stroke", 0.08, "m", low=0.0)
    bore = m.parameter("bore", 0.08, "m", low=0.0)
    bank = m.parameter("bank", "120 deg", "rad", low=0.0, high=pi)
    rpm = m.parameter("rpm", 3000.0, "1/min", low=0.0)
    load = m.parameter("load", 1.0, low=0.0)
    corners, throws = [(0.0, 0.0, 0.0)], (0.0, 2 * pi / 3, 4 * pi / 3)
    for angle in throws:
        x, _, _ = corners[-1]
        y, z = stroke / 2 * ca.cos(angle), stroke / 2 * ca.sin(angle)
        begin, end = x + JOURNAL, x + JOURNAL + PIN
        corners += [(begin, 0.0, 0.0), (begin, y, z), (end, y, z), (end, 0.0, 0.0)]
    corners.append((corners[-1][0] + JOURNAL, 0.0, 0.0))
    shaft = bent_bar(m, "shaft", corners, per_length=12.0)
    length = corners[-1][0]
    main = two_bearings(m, "main", m.ground, shaft.base, shaft.tip, apart=length)
    wheel = m.link("flywheel", length=0.12, mass=8.0, centre=(0, 0, 0), inertia=(0.06, 0.03, 0.03))
    m.weld("flange", shaft.tip, wheel)
    posture = {}
    for name, (throw, side, late) in CYLINDERS.items():
        lean = side * bank / 2
        axis = (0.0, ca.cos(lean), ca.sin(lean))
        rod = m.link(f"{name}_rod", length=0.14, mass=0.55)
        piston = m.point_mass(f"{name}_piston", 0.4)
        pin = shaft.pieces[4 * throw + 2]
        along = PIN / 4 if side > 0 else 3 * PIN / 4
        m.spherical(f"{name}_big_end", pin.at(along), rod)
        m.spherical(f"{name}_wrist", rod.tip, piston)
        place = corners[4 * throw + 1][0] + along
        wall = m.prismatic(f"{name}_wall", m.ground.at(place, 0, 0), piston, axis=axis)
        posture[wall.name] = 0.15
        fires = m.parameter(f"{name}_turn", late, low=0.0, high=1.0)
        turned = m.coordinate(main.fixed, "turn_1") + throws[throw] - lean + 2 * pi * (1 - fires)
        angle = ca.fmod(turned + 8 * pi, 4 * pi) * 180 / pi
        push = -load * 1e5 * table(angle, ANGLES, PRESSURES) * pi / 4 * bore**2
        m.force(f"{name}_gas", piston, y=push * axis[1], z=push * axis[2])
    turning = {main.coordinate: polynomial(0.0, rpm * 2 * pi / 60)}
    return Scene(
        m, turning, over=(main.coordinate, 0, "720 deg", 361), xi=(0, 1, 21), posture=posture
    )
