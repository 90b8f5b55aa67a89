"""A planar mechanism with every kind of joint, of load and of friction."""

from mechanisms import pins_of

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import harmonic, polynomial


def every_joint_and_load():
    """Pins, a guide, a slot and a weld, point masses, and every kind of load and of friction."""
    m = Mechanism("all")
    crank, rod, arm = (
        m.link(name, length=length, mass=1.0)
        for name, length in (("crank", 0.1), ("rod", 0.4), ("arm", 0.7))
    )
    slider = m.link("slider", length=0.1, mass=0.7)
    block = m.point_mass("block", 0.5)
    lump = m.point_mass("lump", 0.3)
    o, a, *_ = pins_of(m, O=(m.ground, crank), A=(crank.tip, rod), B=(rod.tip, slider))
    guide = m.prismatic("G", m.ground, slider, axis=(1.0, 0.0))
    c = m.revolute("C", m.ground.at(0.05, -0.4), arm)
    m.slot("S", arm, crank.tip, axis=(1.0, 0.0))
    m.weld("W", arm.tip, lump)
    rail = m.prismatic("R", rod, block, axis=(1.0, 0.2))
    m.force("push", slider.tip, x=-40.0, y=9.0)
    m.force("follow", arm.at(0.5), x=5.0, y=7.0, turning=True)
    m.torque("couple", rod, 2.0, against=arm)
    m.spring(
        "spring", m.ground.at(-0.5, 0.3), rod.at(0.2), stiffness=200.0, length=0.1, damping=4.0
    )
    m.torsion_spring("coil", c, stiffness=6.0, angle=0.2, damping=0.1)
    m.line_load("wind", arm, x=20.0, y=(3.0, -9.0), turning=True)
    m.friction("pin", a, mu=0.2, radius=0.01)
    m.friction("oil", o, viscous=0.05)
    m.friction("shoe", guide, mu=0.1, length=0.1)
    m.friction("grease", rail, viscous=1.5)
    laws = {"O": polynomial(0.3, 7.0), "R": harmonic(0.2, 0.05, 5.0)}
    return Scene(m, laws, t=(0.0, 0.9, 13), posture={"rod": 0.0, "arm": 1.3})
