"""A punch press: a crank drives a punch through a sheet, and a flywheel gives the energy."""

from math import pi

from lagrange_casadi import Mechanism, Scene, table
from lagrange_casadi.motion import polynomial

# The force of the sheet over the largest one, over the punch's height above its lowest place [mm].
HEIGHTS = (7.0, 9.5, 10.0)
SHARES = (0.0, 1.0, 0.0)


def scene() -> Scene:
    m = Mechanism("punch_press")
    strokes = m.parameter("strokes", 60.0, "1/min", low=0.0)
    punching = m.parameter("punching", 180e3, "N", low=0.0)
    r = m.parameter("r", 0.04, "m", low=0.0)
    l = m.parameter("l", 0.3, "m", low=0.0)
    mass = m.parameter("mass", 60.0, "kg", low=0.0)
    crank = m.link("crank", length=r, mass=25.0, centre=(0.01, 0.0), inertia=0.4)
    rod = m.link("rod", length=l, mass=15.0)
    ram = m.point_mass("ram", mass)
    m.revolute("main", m.ground, crank)
    m.revolute("crankpin", crank.tip, rod)
    m.revolute("wrist", rod.tip, ram)
    guide = m.prismatic("guide", m.ground, ram, axis=(0, -1))
    height = 1000 * (r + l - m.coordinate(guide))
    share = table(height, HEIGHTS, SHARES, beyond="hold")
    m.force("sheet", ram, y=punching * share * (m.rate(guide) > 0))
    m.output("height", height / 1000, unit="m")
    # From the top, evenly, as a flywheel without end would turn it.
    return Scene(
        m,
        {"main": polynomial(pi / 2, 2 * pi / 60 * strokes)},
        t=(0, 1, 721),
        over=("main", "90 deg", "450 deg", 721),
        posture={"rod": -pi / 2},
    )
