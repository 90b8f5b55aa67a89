"""A beam pump: a crank rocks a walking beam, whose head lifts the rods of
an oil well on a bridle.
"""

from math import pi

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import polynomial

REAR, FRONT, SADDLE = 2.8, 3.3, 3.5
"""From the saddle's bearing to the equalizer and to the bridle, and its height above the crankshaft
[m].
"""


def scene() -> Scene:
    m = Mechanism("beam_pump")
    spm = m.parameter("spm", 10.0, "1/min")  # strokes a minute
    r = m.parameter("r", 1.0, "m", low=0.0)
    counterweight = m.parameter("counterweight", 2500.0, "kg", low=0.0)
    fluid = m.parameter("fluid", 14e3, "N", low=0.0)
    crank = m.link("crank", length=r, mass=600.0)
    tail = m.link(
        "tail", length=0.8, mass=400.0
    )  # the crank beyond its wrist pin, which carries the counterweight
    pitman = m.link("pitman", length=3.6, mass=300.0)
    beam = m.link("beam", length=REAR + FRONT - 0.5, mass=1800.0)  # from the equalizer to the head
    head = m.link("head", length=0.5, mass=400.0, centre=(0.3, -0.2), inertia=130.0)
    rods = m.point_mass("rods", 3000.0)
    shaft = m.revolute("shaft", m.ground, crank)
    m.weld("rest", crank.tip, tail)
    m.weld("weights", tail.tip, m.point_mass("weight", counterweight))
    m.revolute("wrist", crank.tip, pitman)
    m.revolute("equalizer", pitman.tip, beam)
    m.revolute("saddle", m.ground.at(REAR, SADDLE), beam.at(REAR))
    m.weld("neck", beam.tip, head)
    m.prismatic("well", m.ground.at(REAR + FRONT, 0), rods, axis=(0, 1))
    # The bridle leaves the head's arc about the saddle upright: it pays out the arc's radius times
    # the beam's angle.
    axle = head.at(0.5 - FRONT, 0.0)
    bridle = m.constraint(
        "bridle", m.place(rods)[1] - m.place(axle)[1] - FRONT * m.direction(head) + 3.0
    )
    # The plunger lifts the fluid upward, and nothing downward.
    rising = m.velocity(rods)[1] > 0
    m.force("lift", rods, y=-fluid * rising)
    m.output("rod_load", m.results.multiplier(bridle), unit="N")
    m.output("power", m.results.effort(shaft) * m.rate(shaft), unit="W")
    return Scene(
        m,
        {"shaft": polynomial(0, 2 * pi / 60 * spm)},
        t=(0, 6, 361),
        posture={"beam": 0.0, "pitman": 1.6},
    )
