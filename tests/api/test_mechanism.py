"""Declarations in the plane and in space: what a part stands for, and what is refused."""

import math

import casadi as ca
import pytest
from mechanisms import pins_of, slider_crank

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, bearings, derive, elements
from lagrange_casadi.errors import (
    AssemblyError,
    DeclarationError,
    LagrangeCasadiError,
    MobilityError,
    ParameterError,
    UnknownNameError,
)
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick

Z = (0.0, 0.0, 1.0)


def arm(kind=SpatialMechanism, **told):
    m = kind("m")
    return m, m.link("a", **{"length": 1.0, "mass": 1.0} | told)


def test_turns_in_sequence_are_carried():
    m, a = arm()
    joint = m.revolute("J", m.ground, a, turned=[("z", "90 deg"), ("x", "90 deg")])
    assert (joint.turned.x, joint.turned.y) == ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def link(m, name="a"):
    return m.link(name, length=1, mass=1)


PLANE = {
    "link name 'a b' must be": lambda m: m.link("a b", length=1, mass=1),
    "link name '' must be": lambda m: m.link("", length=1, mass=1),
    "point mass 'a': the name is taken by a link": lambda m: [
        m.link("a", length=1, mass=1),
        m.point_mass("a", 1),
    ],
    "link 'ground': the name is taken by the ground": lambda m: m.link("ground", length=1, mass=1),
    r"parameter 's' = 5 is out of its range \[.*, 1\]": lambda m: m.parameter("s", 5, high=1),
    "parameter 'r' is declared twice": lambda m: [m.parameter("r", 1), m.parameter("r", 2)],
    "link 'a': length: expected a finite number": lambda m: m.link("a", length="long", mass=1),
    "link 'a': length must be finite": lambda m: m.link("a", length=math.nan, mass=1),
    "link 'a': length depends on 'r', not a parameter of mechanism 'm'": lambda m: m.link(
        "a", length=ca.SX.sym("r"), mass=1
    ),
    "must be a scalar": lambda m: m.link("a", length=ca.SX.ones(2), mass=1),
    "joint 'J' joins 'ground' to itself": lambda m: m.revolute("J", m.ground, m.ground.at(1, 2)),
    "joint 'J': expected a link": lambda m: m.revolute("J", m.ground, "a"),
    "'a' belongs to another mechanism": lambda m: m.revolute(
        "J", m.ground, Mechanism("other").link("a", length=1, mass=1)
    ),
    r"axis must not be of length zero": lambda m: m.prismatic(
        "P", m.ground, m.point_mass("a", 1), axis=(0, 0)
    ),
    "'a' is a point mass, which has no direction": lambda m: m.prismatic(
        "P", m.point_mass("a", 1), m.ground, axis=(1, 0)
    ),
    "mechanism name '1st' must be": lambda m: Mechanism("1st"),
    "has no link and no point mass": lambda m: m.freeze(),
    "contact 'c': friction must be at least 0, got -1": lambda m: m.contact(
        "c", link(m), friction=-1.0, at=(0, 0)
    ),
    "drive 'd': expected a joint of one coordinate, got weld joint 'J'": lambda m: m.drive(
        "d", m.weld("J", m.ground, link(m))
    ),
    "drive 'e': joint 'J' has one already, 'd'": lambda m: [
        pin := m.revolute("J", m.ground, link(m)),
        m.drive("d", pin, effort=1.0),
        m.drive("e", pin, effort=1.0),
    ],
    "drive 'd': ratio must not be 0": lambda m: m.drive(
        "d", m.revolute("J", m.ground, link(m)), ratio=0.0
    ),
    "load 'F': point mass 'p' has no axes; use a link": lambda m: m.force(
        "F", m.point_mass("p", 1), x=1, turning=True
    ),
    "load 'k': joint 'J' has no angle for a torsion spring": lambda m: m.torsion_spring(
        "k", m.prismatic("J", m.ground, link(m), axis=(1, 0)), stiffness=1.0
    ),
    "direction: expected a link, got 'p'": lambda m: m.direction(m.point_mass("p", 1)),
    "place on 'a': a planar mechanism has no z, got 1": lambda m: m.revolute(
        "J", m.ground, link(m).at(0, 0, 1)
    ),
    "non-holonomic constraint 'n' replaces the drive of joint 'J', which has no": lambda m: [
        pin := m.revolute("J", m.ground, link(m)),
        m.nonholonomic("n", m.rate(pin), replaces=pin),
        Scene(m, {}),
    ],
    "cylinder 'c': its rod must be thinner than its bore, got 0.06 m in 0.05": lambda m: (
        elements.cylinder(m, "c", m.ground, link(m), closed=0.3, open=0.5, bore=0.05, rod=0.06)
    ),
    "gears 'g': expected a second gear": lambda m: elements.gears(m, "g", link(m), []),
    r"set 's': teeth must be three whole numbers, .*, got \(1, 2\)": lambda m: elements.planetary(
        m, "s", link(m), link(m, "b"), m.ground, teeth=(1, 2), module=0.002, mass=0.1
    ),
    "joint 'J': the joint already has a rolling part": lambda m: [
        pin := m.revolute("J", m.ground, link(m)),
        *(bearings.fit(m, pin, bearings.Rolling(1e4, hours=1e3)) for _ in range(2)),
    ],
}
SPACE = [
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
    (lambda m, a: m.link("b", between=1.0, mass=1.0), "link 'b': between must be two places"),
    (
        lambda m, a: m.link("b", length=1.0, mass=1.0, beside=Z),
        "link 'b': beside needs between",
    ),
    (
        lambda m, a: m.link("b", length=1.0, mass=1.0, accept_inertia=True),
        "link 'b': accept_inertia needs centre= and inertia=",
    ),
    (
        lambda m, a: m.contact("c", a, friction=0.5),
        "contact 'c': 'a' has no position in the reference posture; expected at=",
    ),
    (
        lambda m, a: m.revolute(
            "J", m.ground, m.link("b", between=((0, 0, 0), Z), mass=1.0), at=Z, turned=[("x", 1)]
        ),
        "joint 'J': turned needs points of bodies; at= already sets the reference posture",
    ),
    (
        lambda m, a: [
            rod := m.cylindrical("J", m.ground, a, axis=Z),
            m.nonholonomic("n", m.rate(rod, "turn"), replaces=rod),
        ],
        "expected a joint of one coordinate, those of joint 'J' are J:slide, J:turn; use",
    ),
    (
        lambda m, a: elements.cylinder(m, "c", m.ground, a, closed=0.3, open=0.5, bore=0.05),
        "cylinder 'c': only a mechanism in a plane has cylinders",
    ),
]
OTHER = [
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
]


@pytest.mark.parametrize(("says", "declare"), PLANE.items())
def test_what_a_part_refuses(declare, says):
    with pytest.raises((DeclarationError, ParameterError), match=says):
        declare(Mechanism("m"))


@pytest.mark.parametrize(
    ("kind", "declare", "says"), [*((SpatialMechanism, *row) for row in SPACE), *OTHER]
)
def test_what_a_part_refuses_in_space_or_as_what_is_for_the_other_kind(kind, declare, says):
    with pytest.raises(DeclarationError, match=says):
        declare(*arm(kind))


def test_a_mechanism_freezes_in_a_scene():
    m, a = arm(Mechanism)
    m.revolute("J", m.ground, a)
    Scene(m, {"J": polynomial(0, 1)})
    for change in (
        lambda: m.point_mass("b", 1),
        lambda: m.parameter("r", 1),
        lambda: m.set_gravity(0, 0),
        lambda: m.output("late", m.time),
    ):
        with pytest.raises(DeclarationError, match="mechanism 'm' is frozen"):
            change()


@pytest.mark.parametrize(
    ("values", "error", "says"),
    [
        ({"R": 1.0}, UnknownNameError, "unknown parameter 'R'; valid: r, l, m1, m2, m3"),
        (
            {"R": 1.0, "ll": 1.0},
            UnknownNameError,
            r"unknown parameters 'R', 'll' \(did you mean 'l'\?\); valid: r, l, m1, m2, m3",
        ),
        (
            {"l": math.nan, "m2": "big"},
            ParameterError,
            (
                r"parameter 'l' must be a finite number, got nan; parameter 'm2': expected a number"
                r" \[kg\], or a text such"
            ),
        ),
        ({"l": math.nan}, ParameterError, "parameter 'l' must be a finite number"),
        ({"l": math.inf}, ParameterError, "parameter 'l' must be a finite number"),
        ({"l": 0.0}, ParameterError, "link 'rod': length must be positive, got 0 m"),
        ({"m3": -1.0}, ParameterError, "point mass 'slider': mass must not be negative, got -1 kg"),
        (
            {"m1": 0.0, "m2": 0.0, "m3": 0.0},
            ParameterError,
            ("mechanism 'slider_crank' has neither mass"),
        ),
        (
            {"m2": 1.7e308, "m3": 1.7e308},
            ParameterError,
            "'slider_crank': its whole mass must be finite and positive, got inf kg",
        ),
    ],
)
def test_what_the_values_of_parameters_refuse(values, error, says):
    with pytest.raises(error, match=says):
        slider_crank().mechanism.values(values)


@pytest.mark.parametrize(
    ("inertia", "possible"),
    [
        ((1.0, 1.0, 2.1), False),
        (((1.0, 0.9, 0.0), (0.9, 1.0, 0.0), (0.0, 0.0, 1.0)), False),
        ((-1.0, 1.0, 1.0), False),
        ((1.0, 2.0, 3.0), True),  # a plate
        ((0.0, 1.0, 1.0), True),  # a needle
        ((0.0, 0.0, 0.0), True),
    ],
)
def test_a_body_has_moments_of_inertia_that_can_be(inertia, possible):
    m, a = arm(centre=(0.0, 0.0, 0.0), inertia=inertia)
    m.revolute("J", m.ground, a)
    if possible:
        Scene(m, {"J": polynomial(0, 1)})
    else:
        with pytest.raises(ParameterError, match="link 'a': impossible moments of inertia"):
            Scene(m, {"J": polynomial(0, 1)})


def islands():
    m, a = arm(Mechanism)
    b, c = (m.link(name, length=1, mass=1) for name in "bc")
    pins_of(m, J=(m.ground, a), K=(b.tip, c))
    return m, {"J": polynomial(0, 1)}, {}


def cylinder(laws):
    m, a = arm()
    m.cylindrical("J", m.ground, a, axis=Z)
    return m, laws, {}


def spatial_crank(far, **rod):
    """A crank and a slider joined by a rod on two balls, which may spin or not reach."""
    m, crank = arm(length=0.1)
    rod = m.link("rod", length=0.3, mass=1.0, **rod)
    m.revolute("O", m.ground, crank, axis=(0, 1, 0))
    m.spherical("A", crank.tip, rod)
    m.spherical("B", rod.tip, slider := m.point_mass("slider", 1.0))
    m.slot("G", m.ground.at(0, far, 0), slider, axis=(1, 0, 0))
    return m, {"O": polynomial(0, 1)}, {"G:slide": 0.3}


@pytest.mark.parametrize(
    ("made", "error", "says"),
    [
        (
            islands,
            DeclarationError,
            "'b', 'c' are not connected to the ground by any chain of joints",
        ),
        (
            lambda: cylinder({"J": polynomial(0, 1)}),
            LagrangeCasadiError,
            "motion of joint 'J': expected 2 laws, of J:slide, J:turn",
        ),
        (
            lambda: cylinder({"J:twist": polynomial(0, 1)}),
            LagrangeCasadiError,
            "unknown joint, path or body in motion 'J:twist'",
        ),
        (
            lambda: cylinder({"a": [polynomial(0)] * 3}),
            LagrangeCasadiError,
            "motion of 'a': in space a point or a pose has no motion of its own",
        ),
        (
            lambda: spatial_crank(0.0, centre=(0, 0, 0), inertia=(1, 1, 1)),
            MobilityError,
            r"has 2 degree\(s\) of freedom",
        ),
        (
            lambda: spatial_crank(2.0),
            AssemblyError,
            "the loop closed by two-force link 'rod' cannot be closed at the start of the motion",
        ),
    ],
)
def test_what_a_mechanism_refuses_as_a_whole(made, error, says):
    m, laws, posture = made()
    with pytest.raises(error, match=says):
        derive(Scene(m, laws, posture=posture))
