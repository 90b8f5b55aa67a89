"""Forces that equilibrium leaves open, by least strain energy: against a closed form; and what is
told of them.
"""

from __future__ import annotations

import numpy as np
import pytest
from elastic_mechanisms import (
    STEEL,
    held,
    made,
    three_cranks,
)

from lagrange_casadi import Mechanism, Scene, beams, evaluate
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def test_a_beam_held_at_both_ends():
    """Timoshenko, Strength of Materials I, with the shear of Timoshenko's beam: by the force
    method, by hand.
    """
    solution = evaluate(held(x=500.0, y=-1000.0))
    p, e, g = beams.rectangle(0.05, 0.02).properties(), STEEL.elasticity, STEEL.shear_modulus
    a, l, push = 0.6, 2.0, 1000.0
    # The tip released: its sag and slope under the load, and under a unit force and couple there.
    ei, ga = e * p.iz, g * p.shear_y
    flexible = np.array([[l**3 / (3 * ei) + l / ga, l**2 / (2 * ei)], [l**2 / (2 * ei), l / ei]])
    sagged = -push * np.array(
        [a**3 / (3 * ei) + a**2 / (2 * ei) * (l - a) + a / ga, a**2 / (2 * ei)]
    )
    force, couple = np.linalg.solve(flexible, -sagged)
    assert solution.reaction("B").fy[0] == pytest.approx(force, rel=1e-10)
    assert solution.reaction("B").mz[0] == pytest.approx(couple, rel=1e-10)
    assert solution.reaction("A").fx[0] == pytest.approx(-500.0 * (l - a) / l, rel=1e-12)
    # Without shear, as books have it: P b^2 (3a + b)/l^3.
    assert solution.reaction("A").fy[0] == pytest.approx(
        push * 1.4**2 * (3 * 0.6 + 1.4) / 8, rel=1e-3
    )
    assert solution.certified
    assert not solution.undetermined
    assert solution.certificate["elasticity"].max() < 1e-12
    assert set(map(str, solution.elasticity.completed)) >= {"reaction:A:fy", "section:bar:law:m0"}


UNKNOWN = made(beams.round_bar(0.01), beams.Material("odd", 1e3))


@pytest.mark.parametrize(
    ("bar", "why"),
    [
        ({"mass": 1.0}, "they go through 'bar', which has no beam"),
        (
            {"mass": 1.0, "centre": (0.5, 0.0), "inertia": 0.1},
            "they go through 'bar', which has no beam",
        ),
        (
            {"beam": UNKNOWN},
            "material 'odd' has no elasticity and no shear_modulus, which elastic link 'bar' needs",
        ),
    ],
)
def test_a_link_without_a_beam_leaves_open_what_goes_through_it_and_is_named(bar, why):
    scene = three_cranks(made(beams.round_bar(0.01)), bar)
    solution, plain = evaluate(scene), evaluate(scene, elastic=False)
    assert set(solution.undetermined) == set(plain.undetermined)
    assert np.isnan(solution.reaction("B1").fx).all()
    assert solution.elasticity.reasons == (why,)
    assert f"elasticity does not determine some forces: {why}" in solution.notes
    assert solution.certified


def test_what_bends_no_link_stays_open():
    """Two gears between the same wheels share their couple however stiff the wheels are."""
    m = Mechanism("wheels")
    a, b = (m.link(name, length=0.2, beam=made(beams.round_bar(0.02))) for name in "ab")
    joints = m.revolute("A", m.ground, a), m.revolute("B", m.ground.at(1, 0), b)
    for name in ("left", "right"):
        m.gear(name, *joints, ratio=-2.0)
    solution = evaluate(
        Scene(m, {"A": polynomial(0.1, 2.0)}, posture={"b": -0.2}, t=(0, 1, 5), elastic=True)
    )
    assert set(solution.undetermined) == {"multiplier:left", "multiplier:right"}
    assert solution.elasticity.reasons == ("some do not deform any link",)
    assert solution.certified


@pytest.mark.parametrize(
    ("elastic", "error", "message"),
    [
        (
            "bar",
            DeclarationError,
            "expected True, or a list of the links that are elastic, got 'bar'",
        ),
        (["rod"], UnknownNameError, "unknown link in elastic 'rod'"),
        (
            ["bare"],
            DeclarationError,
            ("elastic: link 'bare' has no beam=; links with a beam: bar, odd"),
        ),
        (
            ["odd"],
            DeclarationError,
            "material 'odd' has no elasticity, which elastic link 'odd' needs",
        ),
    ],
)
def test_what_has_no_meaning_is_one_line(elastic, error, message):
    m = Mechanism("bad")
    bar = m.link("bar", length=2.0, beam=made(beams.round_bar(0.02)))
    odd = m.link("odd", length=2.0, beam=made(beams.round_bar(0.02), beams.Material("odd", 1e3)))
    m.weld("A", m.ground, bar)
    m.weld("B", bar, odd)
    m.weld("C", bar, m.link("bare", length=1.0, mass=1.0))
    with pytest.raises(error, match=message):
        Scene(m, {}, t=(0, 0, 1), elastic=elastic)


def test_a_table_and_friction_are_refused():
    with pytest.raises(
        DeclarationError, match="a table cannot hold statically indeterminate forces"
    ):
        evaluate(held(y=-1.0), table=1e-6)
    m = Mechanism("guides")
    bar = m.link("bar", length=1.0, beam=made(beams.round_bar(0.02)))
    joint = m.prismatic("G1", m.ground, bar, axis=(1, 0))
    m.prismatic("G2", m.ground.at(1, 0), bar.tip, axis=(1, 0))
    m.friction("rub", joint, mu=0.1, length=0.1)
    with pytest.raises(DeclarationError, match="elastic: cannot be combined with friction 'rub'"):
        evaluate(Scene(m, {"G1": polynomial(0.0, 1.0, 0.5)}, t=(0, 1, 3), elastic=True))
