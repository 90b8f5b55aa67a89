"""A slender link that slides across its own axis, of which nothing was said: a note says so, and
of no other link.
"""

from __future__ import annotations

import pytest

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate, load, save
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

SLIDE = polynomial(0.1, 0.2)


WAYS = {
    Mechanism: [
        ((1, 0), {}, {}, False),
        ((-1, 1e-9), {}, {}, False),
        ((0, 1), {}, {}, True),
        ((0.6, 0.8), {}, {}, True),
        ((0, 1), {"angle": 0.0}, {}, False),
        ((0, 1), {}, {"centre": (0.1, 0.0), "inertia": 0.2}, False),
    ],
    SpatialMechanism: [
        ((1, 0, 0), {}, {}, False),
        ((0, 0, -1), {}, {}, True),
        ((0.6, 0.0, 0.8), {}, {}, True),
        ((0, 0, -1), {"turned": [("z", 0.0)]}, {}, False),
        ((0, 0, -1), {}, {"centre": (0.1, 0, 0), "inertia": (0.1, 0.2, 0.2)}, False),
    ],
}


@pytest.mark.parametrize("kind", WAYS)
def test_a_note_says_so_where_nothing_was_said_of_it_and_only_there(kind):
    """On the ground, or on a link that stands askew."""
    m, told = kind("sliding"), set()
    arm, motion = m.link("arm", length=0.5, mass=1.0), {"shoulder": polynomial(0.7)}
    askew = {"axis": (0.3, 0.4, 1.0)} if m.space else {}
    m.revolute("shoulder", m.ground, arm, **askew)
    for name, parent in (("still", m.ground), ("askew", arm)):
        for k, (axis, words, matter, noted) in enumerate(WAYS[kind]):
            bar = m.link(f"{name}_{k}", length=0.3, mass=0.3, **matter)
            m.prismatic(f"to_{bar.name}", parent, bar, axis=axis, **words)
            motion[f"to_{bar.name}"] = SLIDE
            told |= {bar.name} if noted else set()
    notes = evaluate(Scene(m, motion, t=(0.0, 1.0, 3), xi=(0, 1, 3))).notes
    assert {note.split("'")[1] for note in notes if "does not turn it" in note} == told


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
