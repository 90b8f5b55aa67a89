"""The spatial slider-crank of IFToMM's library of benchmarks: the crank turns about the line along
which the slider goes.
"""

from math import pi

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import polynomial


def scene() -> Scene:
    m = SpatialMechanism("spatial_slider_crank")
    speed = m.parameter("speed", 6.0, "rad/s")
    r = m.parameter("r", 0.08, "m", low=0.02, high=0.1)
    l = m.parameter("l", 0.3, "m", low=0.28, high=0.6)
    crank = m.link(
        "crank", length=r, mass=0.12, centre=(r / 2, 0.0, 0.0), inertia=(1e-5, 1e-4, 1e-4)
    )
    rod = m.link("rod", length=l, mass=0.5)
    slider = m.link(
        "slider", length=0.05, mass=2.0, centre=(0.0, 0.0, 0.0), inertia=(1e-4, 1e-4, 1e-4)
    )
    # The crank points along the ground's z where its angle is zero, and its z axis along the
    # ground's x.
    m.revolute(
        "A",
        m.ground.at(0.0, 0.1, 0.12),
        crank,
        axis=(1.0, 0.0, 0.0),
        turned=((0.0, 0.0, 1.0), (0.0, -1.0, 0.0)),
    )
    m.spherical("B", crank.tip, rod)
    # The cross of the joint at the slider lies along the slide, and across it and the rod.
    m.universal("C", slider, rod.tip, axis=(1.0, 0.0, 0.0), second=(0.0, 1.0, 0.0))
    m.prismatic("guide", m.ground, slider, axis=(1.0, 0.0, 0.0))
    rough = {"guide": 0.2, "C:turn_1": 0.9, "C:turn_2": 0.8}
    return Scene(m, {"A": polynomial(0.0, speed)}, t=(0.0, 2 * pi / 6, 361), posture=rough)
