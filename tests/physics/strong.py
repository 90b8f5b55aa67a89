"""Mechanisms whose links are made of something."""

from mechanisms import pins_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, beams
from lagrange_casadi.motion import harmonic, polynomial

STEEL = beams.material("C45+QT")


def press(
    shape,
    notches=(),
    *,
    material=STEEL,
    push=-300.0,
    columns=None,
    t=(0, 0.2094395, 121),
    sliding=False,
):
    """A slider-crank upright, a load on its rod beside the middle, and where asked a pin that
    slides along the rod.
    """
    m = Mechanism("press")
    beam = beams.Beam(shape, material, notches, columns)
    crank = m.link("crank", length=m.parameter("r", 0.1, "m"), mass=1.2)
    rod = m.link("rod", length=0.4, beam=beam)
    ram = m.point_mass("ram", 15.0)
    pins_of(m, O=(m.ground, crank), A=(crank.tip, rod), B=(rod.tip, ram))
    m.prismatic("guide", m.ground, ram, axis=(0, 1))
    m.force("push", rod.at(0.13), x=push)
    m.line_load("wind", rod, y=lambda x: 200.0 * x, between=(0.1, 0.35))
    if sliding:
        sleeve = m.link("sleeve", length=0.1, mass=0.5, centre=(0.0, 0.0), inertia=1e-3)
        m.prismatic("along", rod, sleeve, axis=(1, 0))
        return Scene(
            m,
            {"O": polynomial(0, 30.0), "along": harmonic(0.2, 0.1, 5.0)},
            t=t,
            posture={"rod": 1.5},
        )
    return Scene(m, {"O": polynomial(0, 30.0)}, t=t, posture={"rod": 1.5})


def robot(shape, material=STEEL):
    """An arm in space whose upper link bends about both axes, is twisted and pulled."""
    m = SpatialMechanism("robot")
    upper = m.link("upper", length=0.5, beam=beams.Beam(shape, material))
    fore = m.link("fore", length=0.4, mass=3.0)
    m.revolute("turn", m.ground, upper, axis=(0.3, 0.5, 1.0))
    m.revolute("elbow", upper.tip, fore, axis=(0.2, 1.0, 0.4))
    m.force("load", fore.tip, x=m.parameter("pull", 120.0, "N"), y=-80.0, z=60.0)
    return Scene(
        m, {"turn": harmonic(0.0, 1.0, 1.0), "elbow": harmonic(0.7, 0.5, 2.0)}, t=(0, 1, 61)
    )


def slider(endurance=None, tip=None):
    """A slider-crank of rectangular bars, whose height may be chosen, with another at the tip."""
    m = Mechanism("slider")
    r = m.parameter("r", 0.1, "m", low=0.0)
    l = m.parameter("l", 0.4, "m", low=0.0)
    h = m.parameter("h", 0.02, "m", low=0.0)
    base, end = beams.rectangle(h, 0.012), beams.rectangle(tip or h, 0.012)
    bar = beams.Beam(beams.tapered(base, end) if tip else base, STEEL.but(endurance=endurance))
    crank = m.link("crank", length=r, beam=bar)
    rod = m.link("rod", length=l, beam=bar)
    ram = m.point_mass("ram", 15.0)
    pins_of(m, O=(m.ground, crank), A=(crank.tip, rod), B=(rod.tip, ram))
    m.prismatic("guide", m.ground, ram, axis=(0, 1))
    return Scene(m, {"O": polynomial(0, 30.0)}, t=(0, 0.2094395, 65), posture={"rod": 1.5})


BARS = [beams.Profile(f"bar {d}", {"diameter": d / 1000}) for d in (14, 8, 12, 10, 18, 16, 22, 20)]


def arms(push=-60.0, shared=False):
    """Two arms, one on the other, fast enough that what they weigh is what loads them."""
    m = Mechanism("arms")
    d1 = m.parameter("d1", 0.03, "m", low=0.001, high=0.1)
    d2 = m.parameter("d2", 0.03, "m", low=0.001, high=0.1)
    upper = m.link("upper", length=0.5, beam=beams.Beam(beams.round_bar(d1), STEEL))
    fore = m.link("fore", length=0.4, beam=beams.Beam(beams.round_bar(d1 if shared else d2), STEEL))
    plate = m.link("plate", length=0.1, beam=beams.Beam(beams.rectangle(0.05, 0.01), STEEL))
    pins_of(m, shoulder=(m.ground, upper), elbow=(upper.tip, fore))
    m.weld("hand", fore.tip, plate)
    m.force("push", plate.tip, y=push)
    return Scene(
        m,
        {"shoulder": harmonic(0.3, 0.5, 1.5), "elbow": harmonic(0.5, 0.7, 1.5)},
        t=(0, 1 / 1.5, 25),
    )
