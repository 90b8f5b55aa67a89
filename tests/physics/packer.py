"""A packaging machine as a case's text, and its ``scene``: it dwells, its guide rubs and its rod
has a beam.
"""

CASE = """
from lagrange_casadi import Mechanism, Scene, beams
from lagrange_casadi.motion import dwell, move, moves


def scene(rest=0.2, way=1.5, count=61):
    m = Mechanism("packer")
    crank = m.link("crank", length=m.parameter("r", 0.08, "m"), mass=0.8)
    steel = beams.material("C45+QT").but(endurance=220e6)
    rod = m.link("rod", length=0.25, beam=beams.Beam(beams.rectangle(0.02, 0.01), steel))
    ram = m.link("ram", length=0.05, mass=2.0, centre=(0.0, 0.0), inertia=1e-3)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, ram)
    m.friction("rub", m.prismatic("bore", m.ground, ram, axis=(1, 0)), mu=m.parameter("mu", 0.15), length=0.06)
    m.force("product", ram, x=-200.0)
    steps = [move(by=way, time=0.3), dwell(rest), move(by=-way, time=0.3), dwell(rest)]
    wanted = ["effort", "motion", "reaction", "friction", "load", "safety:rod", "life:rod", "stress:rod"]
    law = moves(steps, start=0.4, cyclic=True)
    return Scene(m, {"O": law}, wanted, t=(0, 0.6 + 2 * rest, count), xi=(0, 1, 5), posture={"rod": 0.0})
"""  # noqa: E501
space: dict = {}
exec(CASE, space)
scene = space["scene"]
