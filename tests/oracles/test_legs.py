"""Legs in space that reach a point: in closed form where the
pattern is there, iterated elsewhere.
"""

import math

import pytest
from mechanisms import links_of, pins_of

from lagrange_casadi import Scene, SpatialMechanism, derive, evaluate
from lagrange_casadi.errors import AssemblyError, PostureError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
SKEW = (math.cos(0.7), 0.0, math.sin(0.7))
UPRIGHT = (Z, Y)


def reaching(leg, posture, height=0.5, carried=False):
    """A hand moves in space, and a leg reaches for it: from the ground, or from a base that rides
    and rolls.
    """
    m = SpatialMechanism("reaching")
    hand = m.link("hand", length=0.1, mass=2.0, centre=(0.0, 0.0, 0.0), inertia=(0.01, 0.02, 0.02))
    m.free("pose", m.ground, hand)
    laws = {f"pose:turn_{k}": harmonic(0.0, 0.2 * k, 0.5, 0.3 * k) for k in (1, 2, 3)}
    laws |= {
        "pose:slide_1": harmonic(0.12, 0.05, 0.5),
        "pose:slide_2": harmonic(-0.1, 0.04, 1.0),
        "pose:slide_3": harmonic(height, 0.03, 0.5, 0.4),
    }
    foot = m.ground.at(0.02, -0.03, 0.01)
    if carried:
        base = m.link(
            "base", length=0.2, mass=1.0, inertia=(0.01, 0.02, 0.02), centre=(0.1, 0.0, 0.0)
        )
        m.revolute("roll", m.ground, base, axis=(0.6, 0.0, 0.8))
        laws["roll"] = harmonic(0.3, 0.1, 0.5)
        foot = base.at(0.02, -0.03, 0.01)
    end = leg(m, foot)
    m.spherical("S", end, hand.at(0.02, 0.03, -0.01))
    return Scene(m, laws, t=(0.0, 1.0, 11), posture=posture)


def telescope(m, foot, reverse=False):
    cylinder, piston = links_of(m, cylinder=(0.3, 1.0), piston=(0.3, 0.5))
    if reverse:
        # The cylinder is the parent: its first turn is the one about its own axis.
        m.universal("U", cylinder, foot, axis=Y, second=X, turned=((0.0, 0.0, -1.0), Y))
    else:
        m.universal("U", foot, cylinder, axis=X, second=Y, turned=UPRIGHT)
    m.prismatic("P", cylinder.at(0.0, 0.02, 0.03), piston, axis=X)
    return piston.tip


def pins(m, foot, first, second, offset=0.0):
    """Two pins whose axes meet, or pass each other at a distance."""
    yoke = m.link("yoke", length=0.1, mass=0.2, inertia=(1e-4, 1e-4, 1e-4), centre=(0.0, 0.0, 0.0))
    arm = m.link("arm", length=0.3, mass=1.0)
    m.revolute("A", foot, yoke, axis=first)
    m.revolute(
        "B", yoke.at(-offset * first[2], 0.0, offset * first[0]), arm, axis=second, turned=UPRIGHT
    )
    return arm


def skew(m, foot, offset=0.0):
    arm, piston = pins(m, foot, SKEW, Y, offset), m.link("piston", length=0.3, mass=0.5)
    m.prismatic("P", arm, piston, axis=X)
    return piston.tip


def elbow(m, foot):
    arm, fore = pins(m, foot, X, Y), m.link("fore", length=0.35, mass=0.5)
    m.revolute("E", arm.tip, fore, axis=Y)
    return fore.tip


def column(m, foot):
    """Cylindrical coordinates: turn, height, radius."""
    lift, ram = m.link("lift", length=0.2, mass=1.0), m.link("ram", length=0.05, mass=0.5)
    m.cylindrical("C", foot, lift, axis=Z)
    m.prismatic("R", lift, ram, axis=X)
    return ram.tip


def scara(m, foot):
    arm, fore, quill = (
        m.link(name, length=length, mass=0.5)
        for name, length in (("arm", 0.15), ("fore", 0.12), ("quill", 0.1))
    )
    pins_of(m, axis=Z, A=(foot, arm), E=(arm.tip, fore))
    m.prismatic("Q", fore.tip, quill, axis=Z)
    return quill.base


LEGS = {
    "universal and slide": (telescope, {"U:turn_1": 0.0, "U:turn_2": 0.0, "P": 0.2}),
    "told the other way round": (
        lambda m, foot: telescope(m, foot, True),
        {"U:turn_1": 0.0, "U:turn_2": 0.0, "P": 0.2},
    ),
    "two pins at a slant and a slide": (skew, {"A": 0.0, "B": 0.0, "P": 0.2}),
    "an elbow": (elbow, {"A": 0.0, "B": -0.5, "E": 0.9}),
    "turn, height and radius": (column, {"C:turn": -0.5, "C:slide": 0.4, "R": 0.1}),
    "two parallel pins and a slide": (scara, {"A": -1.5, "E": 1.2, "Q": 0.4}),
}


@pytest.mark.sampled(7)
@pytest.mark.parametrize(
    "carried", [False, True], ids=["from the ground", "from a base that moves"]
)
@pytest.mark.parametrize("leg", LEGS)
def test_a_leg_is_solved_without_iteration(leg, carried):
    scene = reaching(*LEGS[leg], carried=carried)
    assert derive(scene).newton is None
    solved = evaluate(scene)
    assert solved.certified
    assert max(solved.certificate[name].max() for name in ("closure", "balance", "power")) < 1e-12


def test_axes_that_do_not_meet_are_left_to_iteration():
    scene = reaching(lambda m, foot: skew(m, foot, 0.05), {"A": 0.0, "B": 0.0, "P": 0.2})
    assert derive(scene).newton is not None
    assert evaluate(scene).certified


def test_each_branch_of_an_elbow():
    """Two ways of the elbow, each with two of the shoulder: the hand is the same, the joints are
    not.
    """
    found = set()
    for shoulder, bend in ((-0.5, 0.9), (0.5, -0.9), (math.pi + 0.5, 0.9), (math.pi - 0.5, -0.9)):
        solution = evaluate(
            reaching(elbow, {"A": 0.0 if abs(shoulder) < 1 else math.pi, "B": shoulder, "E": bend})
        )
        assert solution.certified
        found.add(
            tuple(
                round(math.remainder(float(solution.motion(name).value[0]), math.tau), 6)
                for name in "ABE"
            )
        )
    assert len(found) == 4


def passing(count):
    m = SpatialMechanism("passing")
    hand = m.link("hand", length=0.1, mass=2.0, centre=(0.0, 0.0, 0.0), inertia=(0.01, 0.02, 0.02))
    m.prismatic("rail", m.ground.at(0.4, 0.0, 0.0), hand, axis=Z)
    m.spherical("S", telescope(m, m.ground.at(0.0, -0.02, 0.0)), hand.base)
    return Scene(
        m,
        {"rail": polynomial(-0.2, 0.4)},
        t=(0.0, 1.0, count),
        posture={"U:turn_1": 1.0, "U:turn_2": 0.5, "P": 0.2},
    )


@pytest.mark.parametrize(
    ("made", "error", "says"),
    [
        (lambda: reaching(elbow, {"A": 0.0, "B": -0.5}), PostureError, "in two ways"),
        (
            lambda: reaching(elbow, LEGS["an elbow"][1], height=0.9),
            AssemblyError,
            "the loop closed by joint 'S' cannot be closed at the start",
        ),
        # The hand passes the first axis, about which the leg may then have any turn.
        (lambda: passing(40), AssemblyError, r"joint 'S'.* dead centre"),
        (lambda: passing(41), AssemblyError, r"joint 'S'.* dead centre"),
    ],
)
def test_what_does_not_reach_is_told(made, error, says):
    with pytest.raises(error, match=says):
        evaluate(made())
