"""What can be declared in space, and what cannot is named."""

import math

import pytest
from internals import reference_posture

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, derive
from lagrange_casadi.errors import (
    AssemblyError,
    DeclarationError,
    LagrangeCasadiError,
    MobilityError,
    ParameterError,
)
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick
Z = (0.0, 0.0, 1.0)


def arm(**kwargs):
    m = SpatialMechanism("m")
    return m, m.link("a", **{"length": 1.0, "mass": 1.0, **kwargs})


@pytest.mark.parametrize(
    ("declare", "says"),
    [
        (
            lambda m, a: m.revolute("J", m.ground, a, axis=(0, 0, 0)),
            "joint 'J': axis must not be of length zero",
        ),
        (
            lambda m, a: m.revolute("J", m.ground, a, axis=(0, 1)),
            r"joint 'J': axis must be three components \(x, y, z\)",
        ),
        (
            lambda m, a: m.revolute("J", m.ground, a, turned=[("w", 1.0)]),
            "joint 'J': turned= expected rotations about 'x', 'y' or 'z'",
        ),
        (
            lambda m, a: m.revolute("J", m.ground, a, turned=((1, 0, 0), (1, 1, 0))),
            "turned: its axes must be at right angles",
        ),
        (
            lambda m, a: m.revolute("J", m.ground, a, turned=[("x", "30 grad")]),
            "or a text such as '350 deg'",
        ),
        (
            lambda m, a: m.universal("J", m.ground, a, axis=(1, 0, 0), second=(1, 1, 0)),
            "joint 'J': its axes must be at right angles, and are at 45 deg",
        ),
        (
            lambda m, a: m.revolute("J", m.ground, a, at=(0, 0, 0)),
            "joint 'J': 'a' has no position in the reference posture",
        ),
        (lambda m, a: m.revolute("J", a, a.tip), "joint 'J' joins 'a' to itself"),
        (
            lambda m, a: m.prismatic("J", m.point_mass("p", 1.0), a, axis=Z),
            "joint 'J': its parent 'p' is a point mass",
        ),
        (
            lambda m, a: m.link("b", mass=1.0),
            "link 'b': expected its length, or between=, its two ends",
        ),
        (
            lambda m, a: m.link("b", between=((0, 0, 0), (0, 0, 0)), mass=1.0),
            "link 'b': expected two different places in between=",
        ),
        (
            lambda m, a: m.link("b", between=((0, 0, 0), (1, 1, 0)), beside=(2, 2, 0), mass=1.0),
            "link 'b': beside lies along the link",
        ),
        (
            lambda m, a: m.spherical("J", m.ground, a, second=Z),
            "joint 'J': second= needs axis=, and must be at right angles to it",
        ),
        (
            lambda m, a: m.free("J", m.ground, a, second=Z),
            "joint 'J': second= needs axis=, and must be at right angles to it",
        ),
        (
            lambda m, a: m.link("b", length=1.0, mass=1.0, centre=(0, 0, 0)),
            "link 'b': expected mass=, centre= and inertia= together",
        ),
        (
            lambda m, a: m.link(
                "b",
                length=1.0,
                mass=1.0,
                centre=(0, 0, 0),
                inertia=((1, 0.1, 0), (0, 1, 0), (0, 0, 1)),
            ),
            r"link 'b': inertia must be symmetric, and entries \(2, 1\) and \(1, 2\) differ",
        ),
        (
            lambda m, a: m.link("b", length=1.0, mass=1.0, centre=(0, 0, 0), inertia=1.0),
            "link 'b': inertia must be three moments",
        ),
        (lambda m, a: m.direction(a), "a link in space has no single angle"),
        (
            lambda m, a: m.coordinate(m.cylindrical("J", m.ground, a, axis=Z)),
            "joint 'J' has no coordinate ''; valid: slide, turn",
        ),
        (
            lambda m, a: m.coordinate(m.revolute("J", m.ground, a), "turn"),
            "joint 'J' has no coordinate 'turn'",
        ),
    ],
)
def test_misuse_is_named(declare, says):
    with pytest.raises(DeclarationError, match=says):
        declare(*arm())


@pytest.mark.parametrize(
    ("of", "declare", "says"),
    [
        (
            SpatialMechanism,
            lambda m, a: m.prismatic("J", m.ground, a, axis=Z, angle=1.0),
            "prismatic 'J': .*'angle'; in space it takes",
        ),
        (
            SpatialMechanism,
            lambda m, a: m.torque("T", a, 5.0),
            "torque 'T': .*; in space it takes name, point, x, y, z, against",
        ),
        (
            SpatialMechanism,
            lambda m, a: m.set_gravity((0, 0, -9.81)),
            "set_gravity: .*; in space it takes x, y, z",
        ),
        (
            Mechanism,
            lambda m, a: m.revolute("J", m.ground, a, axis=Z),
            "revolute 'J': .*'axis'; in a plane it takes name, parent, child$",
        ),
        (
            Mechanism,
            lambda m, a: m.force("F", a, z=1.0),
            "force 'F': .*'z'; in a plane it takes name, point, x, y, turning",
        ),
        (
            Mechanism,
            lambda m, a: m.set_gravity(0, 0, -9.81),
            "set_gravity: .*; in a plane it takes x, y",
        ),
        (
            Mechanism,
            lambda m, a: m.prismatic("J", m.ground, a, axis=Z),
            "joint 'J': axis must be two components",
        ),
        (
            Mechanism,
            lambda m, a: m.link("b", length=1.0, mass=1.0, centre=(0, 0, 0), inertia=1.0),
            r"link 'b': centre must be two components \(x, y\)",
        ),
    ],
)
def test_what_is_for_the_other_kind_of_mechanism_is_named(of, declare, says):
    m = of("m")
    with pytest.raises(DeclarationError, match=says):
        declare(m, m.link("a", length=1.0, mass=1.0))


def test_a_hard_point_may_be_rounded():
    """A bar is one though its ends are worked out twice; and moments of inertia are symmetric but
    for rounding.
    """
    m, up = SpatialMechanism("m"), (0.1, 0.2, 0.1 + 0.2)
    crank = m.link("crank", between=((0, 0, 0), up), mass=1.0)
    rod = m.link("rod", between=(up, (1.0, 0.1, 0.6)), mass=1.0)
    slider = m.link("slider", between=((1.0, 0.1, 0.6), (1.1, 0.1, 0.6)), mass=1.0)
    m.revolute("O", m.ground, crank, at=(0, 0, 0), axis=Z)
    first = m.spherical("A", crank, rod, at=(0.1, 0.2, 0.3))
    last = m.spherical("B", rod, slider, at=(1.0, 0.1, 0.2 * 3))
    m.prismatic("G", m.ground, slider, at=(1.0, 0.1, 0.6), axis=(1, 0, 0))
    assert up[2] != 0.3
    assert 0.2 * 3 != 0.6
    assert (first.parent.end, first.child.end, last.parent.end, last.child.end) == (
        "tip",
        "base",
        "tip",
        "base",
    )
    weight = m.at(rod, 0.1 + 0.3 * 0.9, 0.2 - 0.3 * 0.1, 0.3 + 0.3 * 0.3)
    assert (weight.y, weight.z) == (0.0, 0.0)
    body = m.link(
        "b",
        length=1.0,
        mass=1.0,
        centre=(0, 0, 0),
        inertia=((1, 0.1, 0), (0.1 + 1e-17, 1, 0), (0, 1e-17, 1)),
    )
    assert body.mass.inertia[1] == (0.1, 1.0, 0.0)


def test_a_plane_has_no_z():
    m = Mechanism("m")
    with pytest.raises(
        DeclarationError,
        match=r"a planar mechanism has no z, got 1\.0; use SpatialMechanism",
    ):
        m.revolute("J", m.ground.at(0.0, 0.0, 1.0), m.link("a", length=1.0, mass=1.0))


@pytest.mark.parametrize(
    "inertia",
    [(1.0, 1.0, 2.1), ((1.0, 0.9, 0.0), (0.9, 1.0, 0.0), (0.0, 0.0, 1.0)), (-1.0, 1.0, 1.0)],
)
def test_a_body_has_moments_of_inertia_that_can_be(inertia):
    m, a = arm(centre=(0.0, 0.0, 0.0), inertia=inertia)
    m.revolute("J", m.ground, a)
    with pytest.raises(ParameterError, match="link 'a': impossible moments of inertia"):
        Scene(m, {"J": polynomial(0, 1)})


def test_a_plate_and_a_needle_are_bodies():
    for inertia in ((1.0, 2.0, 3.0), (0.0, 1.0, 1.0), (0.0, 0.0, 0.0)):
        m, a = arm(centre=(0.0, 0.0, 0.0), inertia=inertia)
        m.revolute("J", m.ground, a)
        Scene(m, {"J": polynomial(0, 1)})


def test_hard_points_know_their_posture():
    m = SpatialMechanism("m")
    a = m.link("a", between=((0, 0, 0), (1, 0, 0)), mass=1.0)
    b = m.link("b", between=((1, 0, 0), (1, 1, 0)), mass=1.0)
    m.revolute("O", m.ground, a, at=(0, 0, 0), axis=Z)
    joint = m.spherical("A", a, b, at=(1, 0, 0))
    assert joint.parent.end == "tip"
    assert joint.child.end == "base"
    assert reference_posture(m) == {"O": 0.0, "A:turn_1": 0.0, "A:turn_2": 0.0, "A:turn_3": 0.0}


@pytest.mark.parametrize(
    ("motion", "says"),
    [
        ({"J": polynomial(0, 1)}, "motion of joint 'J': expected 2 laws, of J:slide, J:turn"),
        ({"J:twist": polynomial(0, 1)}, "unknown joint, path or body in motion 'J:twist'"),
        (
            {"a": (polynomial(0), polynomial(0), polynomial(0))},
            "motion of 'a': in space a point or a pose has no motion of its own",
        ),
    ],
)
def test_motions_are_of_coordinates(motion, says):
    m, a = arm()
    m.cylindrical("J", m.ground, a, axis=Z)
    with pytest.raises(LagrangeCasadiError, match=says):
        Scene(m, motion)


def test_a_body_that_hangs_on_bars_alone_is_named():
    m = SpatialMechanism("m")
    plate = m.link("plate", length=0.2, mass=1.0, centre=(0, 0, 0), inertia=(1, 1, 1))
    crank = m.link("crank", length=0.1, mass=1.0)
    m.revolute("O", m.ground, crank)
    for k in range(3):
        bar = m.link(f"bar{k}", length=0.5, mass=0.1)
        m.spherical(f"A{k}", crank.tip if k == 0 else m.ground.at(k, 0, 0), bar)
        m.spherical(f"B{k}", bar.tip, plate.at(0.1 * k, 0.0))
    with pytest.raises(
        DeclarationError,
        match=r"'plate' is connected by two-force links only; declare a free\(\)"
        r" joint",
    ):
        derive(Scene(m, {"O": polynomial(0, 1)}))


def test_a_loop_that_drives_leave_nothing_to_close_is_named():
    m = SpatialMechanism("m")
    a, b = m.link("a", length=1.0, mass=1.0), m.link("b", length=1.0, mass=1.0)
    m.cylindrical("A", m.ground, a, axis=Z)
    m.cylindrical("B", a.tip, b, axis=(1, 0, 0))
    m.planar("C", m.ground.at(1, 1, 1), b, axis=(0, 1, 0))
    says = (
        "joint 'B': every joint of its loop has a given motion, so A:turn, C:slide_2, C:turn,"
        " B:turn cannot follow"
    )
    with pytest.raises(DeclarationError, match=says):
        derive(
            Scene(
                m,
                {
                    "A:slide": polynomial(0, 1),
                    "B:slide": polynomial(0, 1),
                    "C:slide_1": polynomial(0),
                },
            )
        )


def test_what_an_idle_spin_makes_of_the_freedoms_is_said():
    m = SpatialMechanism("m")
    crank = m.link("crank", length=0.1, mass=1.0)
    rod = m.link("rod", length=0.3, mass=1.0, centre=(0, 0, 0), inertia=(1, 1, 1))
    slider = m.link("slider", length=0.1, mass=1.0)
    m.revolute("O", m.ground, crank, axis=(0, 1, 0))
    m.spherical("A", crank.tip, rod)
    m.spherical("B", rod.tip, slider)
    m.prismatic("G", m.ground, slider, axis=(1, 0, 0))
    with pytest.raises(MobilityError, match=r"has 2 degree\(s\) of freedom"):
        derive(Scene(m, {"O": polynomial(0, 1)}, posture={"G": 0.3}))


def test_a_bar_that_does_not_reach_is_named():
    m = SpatialMechanism("m")
    crank = m.link("crank", length=0.1, mass=1.0)
    rod = m.link("rod", length=0.3, mass=1.0)
    slider = m.point_mass("slider", 1.0)
    m.revolute("O", m.ground, crank, axis=(0, 1, 0))
    m.spherical("A", crank.tip, rod)
    m.spherical("B", rod.tip, slider)
    m.slot("G", m.ground.at(0, 2.0, 0), slider, axis=(1, 0, 0))
    with pytest.raises(
        AssemblyError,
        match="the loop closed by two-force link 'rod' cannot be closed at the start of the motion",
    ):
        derive(Scene(m, {"O": polynomial(0, 1)}, posture={"G:slide": 0.3}))


def test_turns_in_sequence_are_carried():
    m, a = arm()
    joint = m.revolute("J", m.ground, a, turned=[("z", "90 deg"), ("x", "90 deg")])
    assert joint.turned == ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    assert joint.axes[0].kind == "angle"
    screw = m.screw("S", a.tip, m.link("b", length=1.0, mass=1.0), axis=(1, 0, 0), lead=0.01)
    assert screw.pitch == 0.01 / math.tau
