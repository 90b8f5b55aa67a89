"""Five-bars: two cranks and two rods that meet at a tool, and one whose rods are geared."""

from mechanisms import links_of, pins_of

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.elements import gears
from lagrange_casadi.motion import polynomial


def five_bar(drives=None, wanted=("all",), path=False, power=False, **keywords):
    """Two cranks and two rods that meet at a tool, which is pushed; a weight hangs beside a station
    of a rod.
    """
    m = Mechanism("five_bar")
    heavier = m.parameter("heavier", 2.0)
    a, b, c, d = links_of(m, a=(0.3, 1.0), b=(0.5, 1.5), c=(0.5, 1.2), d=(0.3, 0.8))
    pins_of(
        m,
        O=(m.ground.at(-0.1, 0), a),
        C=(m.ground.at(0.2, 0), d),
        A=(a.tip, b),
        D=(d.tip, c),
        P=(b.tip, c.tip),
    )
    m.weld("hung", b.at(0.2, 0.05), m.point_mass("weight", 0.4))
    m.force("cut", c.tip, x=-20.0, y=5.0)
    if path:
        m.path("tool", b.tip)
    if power:
        # The tool keeps its height: nothing but rounding.
        vy = m.velocity(b.tip)[1]
        m.output("still", vy * m.results.effort(m.joints["O"]), unit="W")
    motion = {"O": polynomial(2.0, 0.5, -0.2), "C": polynomial(1.0, -0.3, 0.4)}
    drives = drives(heavier) if callable(drives) else drives
    return Scene(
        m,
        motion,
        wanted,
        drives=drives,
        **({"posture": {"b": 1.0, "c": 2.0}, "t": (0, 1, 41)} | keywords),
    )


def geared_five_bar(order, rubs=False):
    """A five-bar with gears over its coupler, whose pin at B closes the loop in some orders of
    declaration.
    """
    m = Mechanism("five")
    first, coupler, third, fourth = links_of(
        m, first=(0.1, 1.0), coupler=(0.25, 0.6), third=(0.2, 0.8), fourth=(0.22, 0.8)
    )
    pins = {
        "O": (m.ground, first),
        "A": (first.tip, coupler),
        "B": (coupler.tip, third),
        "C": (third.tip, fourth.tip),
        "D": (m.ground.at(0.35, 0), fourth),
    }
    joints = {name: m.revolute(name, *pins[name]) for name in order}
    if rubs:
        m.friction("rub_A", joints["A"], mu=0.1, radius=0.02)
        m.friction("rub_B", joints["B"], mu=0.1, radius=0.02)
    gears(m, "mesh", first.tip, third, radii=(0.1, 0.15))
    m.force("cut", fourth.at(0.1), x=-30.0)
    posture = {"coupler": 0.8, "third": -0.5, "fourth": 1.5}
    return Scene(m, {"O": polynomial(0.3, 20)}, t=(0, 0.05, 11), posture=posture)
