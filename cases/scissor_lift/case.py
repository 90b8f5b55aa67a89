"""A scissor lift of two stages: a cylinder and a gas spring under the lowest stage raise a
platform with a load.
"""

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.elements import cylinder, gas_spring
from lagrange_casadi.motion import move, moves

ARM, STAGES = 1.2, 2
MOUNT = 0.9
"""The cylinder is pinned so far along the arm whose foot is fixed [m]."""


def scene() -> Scene:
    m = Mechanism("scissor_lift")
    load = m.parameter("load", 500.0, "kg", low=0.0)
    aside = m.parameter("aside", 0.5, "m", low=0.0, high=0.9)
    time = m.parameter("time", 8.0, "s", low=0.0)
    foot = m.link("foot", length=0.1, mass=8.0, centre=(0.0, 0.0), inertia=0.02)
    m.prismatic("rail", m.ground, foot, axis=(1, 0))
    left, right, rough = m.ground.at(0.0, 0.0), foot.base, {"platform": 0.0}
    for k in range(STAGES):
        rising, falling = (
            m.link(f"{way}{k}", length=ARM, mass=14.0) for way in ("rising", "falling")
        )
        m.revolute(f"left{k}", left, rising)
        m.revolute(f"right{k}", right, falling)
        m.revolute(f"middle{k}", rising.at(ARM / 2), falling.at(ARM / 2))
        left, right = falling.tip, rising.tip
        rough |= {rising.name: 0.25, falling.name: 2.9}
    platform = m.link("platform", length=1.3, mass=60.0)
    m.revolute("hinge", left, platform)
    m.slot("slot", platform, right)
    m.weld("cargo", platform.at(aside), m.point_mass("box", load))
    mounts = m.ground.at(0.25, -0.12), m.links["rising0"].at(MOUNT)
    cylinder(
        m, "ram", *mounts, closed=0.6, open=1.05, bore=0.1, rod=0.06, barrel_mass=16.0, rod_mass=9.0
    )
    gas_spring(m, "gas", *mounts, closed=0.6, open=1.05, force=(2500.0, 4000.0), damping=200.0)
    m.output("height", m.place(platform)[1], unit="m")
    m.output("rise", m.velocity(platform)[1], unit="m/s")
    lifting = moves([move(0.4, time=time, law="modified_sine")], start=0.08)
    return Scene(m, {"ram": lifting}, t=(0, 8, 161), posture=rough)
