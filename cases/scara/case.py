"""A SCARA arm seen from above: pick and place, as its controller plays it
from a file of S-curves.
"""

from pathlib import Path

import casadi as ca

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import Motion, read_samples

CYCLE = 1.2
"""Seconds from pick to place and back, with the rests to grip and to drop."""
READING = 0.0003
"""What is rounded off the angles in the file, in the root mean square: a thousandth of a degree
over the root of twelve.
"""


def scene() -> Scene:
    m = Mechanism("scara")
    m.set_gravity(0, 0)  # upright axes bear all weights
    payload = m.parameter("payload", 3.0, "kg", low=0.0)
    pace = m.parameter("pace", 1.0, low=0.2, high=3.0)
    inner = m.link("inner", length=0.35, mass=6.0)
    outer = m.link("outer", length=0.3, mass=4.0)
    pulley = m.link("pulley", length=0.05, mass=0.8, centre=(0, 0), inertia=1e-3)
    m.revolute("shoulder", m.ground, inner)
    m.revolute("elbow", inner.tip, outer)
    motor = m.revolute("motor", m.ground, pulley)
    m.weld("grip", outer.tip, m.point_mass("load", payload))
    # A belt inside the inner arm turns the outer one as the second motor turns.
    m.constraint("belt", m.direction(pulley) - m.direction(outer))
    m.path("tool", outer.tip)
    m.output("power", ca.fabs(m.results.effort(motor) * m.rate(motor)), unit="W")
    played = Path(__file__).parent / "moves.csv"

    def axis(column: str) -> Motion:
        return read_samples(
            played,
            value=column,
            unit="deg",
            time_unit="ms",
            smoothing=READING,
            periodic=True,
            stretch=1 / pace,
        )

    return Scene(
        m,
        motion={"shoulder": axis("shoulder"), "motor": axis("motor")},
        t=(0, CYCLE, 201),
        posture={"inner": "10 deg", "elbow": "60 deg"},
    )
