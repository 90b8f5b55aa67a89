"""An eccentric press drawn in FreeCAD, as ``new --from press.asmt`` writes it; the force of the
work is added.
"""

from math import pi

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import expression


def scene() -> Scene:
    m = SpatialMechanism("cad_press")
    m.set_gravity(0.0, -9.81, 0.0)
    at_Crank_pin = (0.04, 0.0, 0.0)
    at_Wrist_pin = (0.0, -0.21633307652783937, 0.0)
    at_Guide = (0.0, -0.2663330765278394, 0.0)
    Crank = m.link(
        "Crank",
        between=((0.0, 0.0, 0.0), at_Crank_pin),
        mass=1.6,
        centre=(0.012, 0.0, 0.0),
        inertia=(0.0006, 0.0012, 0.00156),
    )
    Rod = m.link(
        "Rod",
        between=(at_Crank_pin, at_Wrist_pin),
        mass=0.9,
        centre=(0.021818181818181813, -0.09833321660356337, 0.0),
        inertia=(
            (0.004209421487603306, -0.000760294552012096, 0.0),
            (-0.0007602945520120961, 0.00023807851239669402, 0.0),
            (0.0, 0.0, 0.0043875),
        ),
    )
    Ram = m.link(
        "Ram",
        between=(at_Wrist_pin, at_Guide),
        mass=6.5,
        centre=(0.0, -0.2663330765278394, 0.0),
        inertia=(0.006933333333333333, 0.011266666666666666, 0.011266666666666666),
    )
    m.revolute("Bearing", m.ground, Crank, axis=(0.0, 0.0, 1.0), at=(0.0, 0.0, 0.0))
    m.universal(
        "Crank_pin",
        Crank,
        Rod,
        axis=(0.0, 0.0, 1.0),
        second=(0.9833321660356336, -0.18181818181818168, 0.0),
        at=at_Crank_pin,
    )
    m.spherical("Wrist_pin", Rod, Ram, at=at_Wrist_pin)
    m.prismatic("Guide", m.ground, Ram, axis=(0.0, 1.0, 0.0), at=at_Guide)
    m.force("work", m.at(Ram, *at_Guide), y=900.0)
    laws = {
        "Bearing": expression(lambda t: 8.0 * pi * t),
    }
    return Scene(m, laws, t=(0.0, 0.25, 201))
