"""A slender link that slides across its own axis, of which nothing was said: a note says so, and
of no other link.
"""

from __future__ import annotations

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate, load, save
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

SLIDE = polynomial(0.1, 0.2)


def drawn(seed):
    """A link that slides on the ground or on a link that stands still, along an axis or anyhow, and
    whether something was said of how it lies.
    """
    rng = np.random.default_rng(seed)
    space, given, motion = (
        bool(seed % 2),
        rng.choice(["nothing", "turn", "inertia"]),
        {"way": SLIDE},
    )
    m = SpatialMechanism("sliding") if space else Mechanism("sliding")
    size, parent, matter = 3 if space else 2, m.ground, {}
    if rng.random() < 0.5:
        parent, motion["shoulder"] = m.link("arm", length=0.5, mass=1.0), polynomial(0.7)
        m.revolute("shoulder", m.ground, parent, **({"axis": (0.3, 0.4, 1.0)} if space else {}))
    along = rng.choice([-1.0, 1.0]) * np.eye(size)[rng.integers(size)]
    axis = rng.choice([along, along + 1e-9, rng.normal(size=size)])
    words = {"axis": tuple(map(float, axis))}
    if given == "inertia":
        matter = {"centre": (0.1, 0, 0)[:size], "inertia": (0.1, 0.2, 0.2) if space else 0.2}
    if given == "turn":
        angle = float(rng.choice([0.0, rng.normal()]))
        words |= {"turned": [("z", angle)]} if space else {"angle": angle}
    m.prismatic("way", parent, m.link("bar", length=0.3, mass=0.3, **matter), **words)
    return Scene(m, motion, t=(0.0, 1.0, 3), xi=(0, 1, 3)), given


def slides_across(solution):
    """Whether the link's point goes in another direction than that of its
    axis, as its pose tells.
    """
    pose = solution.pose("bar")
    z = np.zeros_like(pose.x) if pose.z is None else pose.z
    way = np.array([(values[-1] - values[0]) for values in (pose.x, pose.y, z)])
    axis = (
        [np.cos(pose.angle[0]), np.sin(pose.angle[0]), 0.0]
        if pose.axes is None
        else pose.axes[0][0]
    )
    return np.linalg.norm(np.cross(way / np.linalg.norm(way), axis)) > 1e-6


def across(solution):
    """Its notes of links that slide across their axes."""
    return [note for note in solution.notes if "does not turn it" in note]


@pytest.mark.parametrize(
    "seed", [*range(20), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(20, 1000))]
)
def test_a_note_says_so_where_nothing_was_said_of_it_and_only_there(seed):
    scene, given = drawn(seed)
    solution = evaluate(scene)
    assert bool(across(solution)) == (given == "nothing" and slides_across(solution))


def needle_bar(**words):
    """A bar that goes up and down."""
    m = Mechanism("sewing")
    m.prismatic(
        "guide", m.ground, m.link("needle_bar", length=0.2, mass=0.1), axis=(0, -1), **words
    )
    return Scene(m, {"guide": SLIDE}, t=(0.0, 1.0, 3), xi=(0, 1, 3))


def test_the_note_says_what_to_do_and_doing_it_helps(tmp_path):
    """Sideways it bends by its weight; along its way it does not."""
    sideways = evaluate(needle_bar())
    (note,) = sideways.notes
    assert (
        note
        == "link 'needle_bar' slides along joint 'guide' at 90 deg to its axis, because the joint's"
        ' axis does not turn it: angle="-90 deg" lays it along, angle=0 says that it is meant'
    )
    assert abs(sideways.section("needle_bar").bending).max() == pytest.approx(0.1 * 9.81 * 0.1)
    along = evaluate(needle_bar(angle="-90 deg"))
    assert along.notes == ()
    assert abs(along.section("needle_bar").bending).max() < 1e-15
    assert evaluate(needle_bar(angle=0)).notes == ()
    save(sideways, tmp_path / "x.h5")
    assert load(tmp_path / "x.h5").notes == (note,)
