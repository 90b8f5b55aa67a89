"""A scene in space whose links bend most between their ends, with densities of several kinds,
loads, and a bead that slides.
"""

import casadi as ca

from lagrange_casadi import Scene, SpatialMechanism, density, motion


def beams(t=(0.0, 2.0, 61), wanted=("effort", "reaction", "section")):
    """Two beams that turn about skew axes, nearly carried at their tips; a bead slides along the
    second one.
    """
    m = SpatialMechanism("beams")
    mass = m.parameter("mass", 6.0, "kg", low=0.0)
    beam = m.link("beam", length=0.8, mass=mass)
    taper = m.link(
        "taper", length=0.6, density=density.tabulated((0.0, 0.35, 1.0), (9.0, 3.0, 7.0))
    )
    bead = m.link("bead", length=0.05, mass=0.9)
    m.revolute("A", m.ground, beam, axis=(0.6, 0.2, 1.0))
    m.revolute("B", m.ground.at(0, 0, 1.0), taper, axis=(0.3, 1.0, 0.1))
    m.prismatic("S", taper, bead, axis=(1, 0, 0), turned=[("z", "70 deg")])
    half, time = 9.81 * mass / 2, m.time
    m.force(
        "lift",
        beam.tip,
        x=0.08 * half * ca.sin(3 * time),
        y=0.1 * half * ca.cos(5 * time),
        z=half * (1 + 0.1 * ca.sin(4 * time)),
    )
    m.force(
        "hold",
        taper.tip,
        x=10 * ca.cos(4 * time),
        y=14 * ca.sin(3 * time),
        z=19.0 + 3.0 * ca.sin(time),
    )
    laws = {
        "A": motion.polynomial(0.2, 0.5, 0.1),
        "B": motion.polynomial(-0.4, 0.4, -0.1),
        "S": motion.harmonic(0.3, 0.2, 0.5),
    }
    return Scene(m, motion=laws, t=t, wanted=wanted)
