"""Bricard's loop: six links of one length on six revolute joints at right angles move, though a
count of degrees of freedom gives none.
"""

from math import acos, cos

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import harmonic

START = 1.3
"""The first joint's angle at the start [rad]."""


def scene() -> Scene:
    m = SpatialMechanism("bricard")
    length = m.parameter("length", 0.5, "m", low=0.1, high=1.0)
    links = [m.link(f"link{k}", length=length, mass=1.5) for k in range(1, 6)]
    axis, right = (0.0, 0.0, 1.0), [1 if k % 2 == 0 else -1 for k in range(6)]
    m.revolute("J0", m.ground, links[0], axis=axis)
    for k in range(1, 5):
        m.revolute(
            f"J{k}",
            links[k - 1].tip,
            links[k],
            axis=(0.0, -right[k - 1], 0.0),
            turned=[("x", f"{90 * right[k - 1]} deg")],
        )
    # The ground is the sixth link: from the last joint it leads back to the first, whose axis is
    # its tip's.
    m.revolute("J5", m.ground.at(-length, 0.0, 0.0), links[4].tip, axis=(0.0, -1.0, 0.0))
    return Scene(m, {"J0": harmonic(START, 0.2, 1.0)}, t=(0.0, 1.0, 201), posture=_posture())


def _posture() -> dict[str, float]:
    """The other angles at the start: of such a loop every second one is the same."""
    other = acos(-cos(START) / (1 + cos(START)))
    return {"J1": other, "J2": START, "J3": other, "J4": START, "J5": -other}
