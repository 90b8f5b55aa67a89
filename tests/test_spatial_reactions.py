"""Reactions and section forces of open chains in space, however the same chain is told."""

import numpy as np
import pytest
from spatial_bridge import instants

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.motion import harmonic

pytestmark = pytest.mark.quick

TIMES = (0.0, 0.37, 0.9)


def chain(last, end="body"):
    """Three links on a turn, a universal joint and one that ``last`` makes, and an ``end`` that
    hangs there.
    """
    m = SpatialMechanism("chain")
    a, b, c = (
        m.link(name, length=length, mass=mass)
        for name, length, mass in (("a", 0.4, 1.0), ("b", 0.3, 0.8), ("c", 0.5, 0.6))
    )
    m.revolute("A", m.ground, a, axis=(0.2, 0.3, 1.0))
    m.universal("B", a.tip, b, axis=(0, 0, 1), second=(0, 1, 0))
    laws = {
        "A": harmonic(0.1, 0.5, 1.0),
        "B:turn_1": harmonic(0.2, 0.7, 1.2, 0.3),
        "B:turn_2": harmonic(-0.3, 0.4, 0.8),
    }
    laws |= last(m, b, c)
    if end == "body":
        m.weld(
            "held",
            c.at(0.3, 0.05, 0.0),
            m.link("end", length=0.1, mass=2.0, centre=(0, 0, 0), inertia=(0, 0, 0)),
        )
    else:
        m.weld("held", c.at(0.3, 0.05, 0.0), m.point_mass("end", 2.0))
    m.force("pull", c.tip, x=3.0, y=-2.0, z=1.0)
    return instants(Scene(m, laws, t=(0.0, 1.0, 11)), TIMES)


def turn(m, b, c):
    m.revolute("C", b.tip, c, axis=(1, 2, 0.5))
    return {"C": harmonic(0.4, 0.9, 1.0, 0.1)}


def turn_back(m, b, c):
    """The same joint, whose parent is further out than its child."""
    m.revolute("C", c, b.tip, axis=(1, 2, 0.5))
    return {"C": harmonic(-0.4, -0.9, 1.0, 0.1)}


def slide(m, b, c):
    m.cylindrical("C", b.tip, c, axis=(0, 0, 1))
    return {"C:turn": harmonic(0.4, 0.9, 1.0, 0.1), "C:slide": harmonic(0.1, 0.05, 1.0)}


def slide_back(m, b, c):
    m.cylindrical("C", c, b.tip, axis=(0, 0, 1))
    return {"C:turn": harmonic(-0.4, -0.9, 1.0, 0.1), "C:slide": harmonic(-0.1, -0.05, 1.0)}


def near(found, told, keys, sign=1.0):
    size = max(np.abs(row).max() for row in told.values())
    assert keys
    for key in keys:
        np.testing.assert_allclose(
            found[key], sign * told[key], rtol=0, atol=1e-13 * size, err_msg=key
        )


@pytest.mark.parametrize(
    ("one", "other"), [(turn, turn_back), (slide, slide_back)], ids=["turn", "slide"]
)
def test_a_joint_may_be_told_from_either_side(one, other):
    """What its parent does to its child is then the opposite; and nothing else changes."""
    there, back = chain(one), chain(other)
    # Where a slide moves on its parent, that has a station.
    alike = (
        "section:a:" if one is slide else "section:",
        "reaction:A",
        "reaction:B",
        "reaction:held",
        "effort:A",
        "effort:B",
    )
    near(back, there, [key for key in there if key.startswith(alike)])
    turned = [
        key
        for key in there
        if key.startswith(("effort:C", "reaction:C:f")) and key[-1] not in "uvw"
    ]
    # The moment is about the child's point, which a slide leads away.
    near(back, there, turned + [f"reaction:C:m{axis}" for axis in "xyz" if one is turn], sign=-1.0)


def test_a_point_mass_at_the_end_is_a_body_without_inertia():
    """It has no axes of its own."""
    body, point = chain(turn), chain(turn, end="point")
    told = [
        key for key in point if key.startswith(("section:", "reaction:", "effort:")) and key in body
    ]
    near(point, body, told)
    assert {"reaction:held:fx", "reaction:held:fu", "section:c:held:fy", "section:a:law:mx0"} <= {
        *told
    }


def test_a_turn_bears_no_moment_about_its_axis():
    found = chain(turn)
    assert np.abs(found["reaction:C:mu"]).max() < 1e-14
    own, ground = (
        np.array([found[f"reaction:C:m{axis}"] for axis in axes]) for axes in ("uvw", "xyz")
    )
    np.testing.assert_allclose(
        np.linalg.norm(own, axis=0), np.linalg.norm(ground, axis=0), rtol=1e-13
    )
