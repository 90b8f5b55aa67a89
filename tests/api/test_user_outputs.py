"""Outputs of a user's own: what they are made of, what they cost, and how they are misused."""

import casadi as ca
import numpy as np
import pytest
from mechanisms import links_of, pins_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, derive, elements, evaluate, motion
from lagrange_casadi.errors import DeclarationError, UnknownNameError

pytestmark = pytest.mark.usefixtures("interpreted")


def engine(wanted=("all",), more=lambda m, parts: None):
    """A crank, a rod with a lump beside a station, a piston under a spring of gas; two outputs."""
    m = Mechanism("engine")
    r = m.parameter("r", 0.1, "m")
    crank, rod = links_of(m, crank=(r, 0.8), rod=(0.25, 1.1))
    piston = m.point_mass("piston", 0.6)
    main, *_ = pins_of(m, main=(m.ground, crank), pin=(crank.tip, rod), wrist=(rod.tip, piston))
    bore = m.prismatic("bore", m.ground, piston, axis=(1, 0))
    m.weld("lump", rod.at(0.1, 0.02), m.point_mass("lumped", 0.3))
    m.force("gas", piston, x=-100.0 * m.coordinate(bore))
    found = m.results
    m.output("power", found.effort(main) * m.rate(main), unit="W")
    m.output("vx", m.velocity(rod.at(0.125, 0.02))[0], unit="m/s")
    more(m, {"main": main, "rod": rod, "bore": bore})
    return Scene(
        m,
        {"main": motion.polynomial(0.3, 10, 2.0)},
        wanted,
        posture={"rod": 0.0},
        t=(0, 1, 201),
    )


def test_what_is_wanted_brings_what_it_is_made_of_and_costs_little_more():
    scene = engine()
    another = engine(more=lambda m, parts: m.output("more", m.time))
    assert derive(another, ["effort"]).instructions == derive(scene, ["effort"]).instructions
    for wanted, names in (("power", ["effort:main", "output:power"]), ("vx", ["output:vx"])):
        assert list(evaluate(scene, wanted=[f"output:{wanted}"]).series) == names
    asked = (derive(scene, wanted).instructions for wanted in (["output:power"], ["effort"]))
    power, effort = (sum(instructions.values()) for instructions in asked)
    assert power <= effort + 3


def test_a_point_of_a_bar_between_two_balls_accelerates_as_it_moves():
    """By fourth-order differences of its place."""
    m = SpatialMechanism("bar")
    crank, bar, rocker = links_of(m, crank=(0.1, 0.4), bar=(0.4, 0.8), rocker=(0.25, 0.6))
    m.revolute("O", m.ground, crank, axis=(0, 0, 1))
    m.spherical("A", crank.tip, bar)
    m.spherical("B", bar.tip, rocker.tip)
    axis, along, across = (0.48, 0.8, 0.36), (0.6, 0.0, -0.8), (-0.64, 0.6, -0.48)
    m.revolute("Q", m.ground.at(0.3, -0.1, 0.2), rocker, axis=axis, turned=(along, across))
    point = bar.at(0.13)
    for k, (x, a) in enumerate(zip(m.place(point), m.results.acceleration(point), strict=True)):
        m.output(f"x{k}", x, unit="m")
        m.output(f"a{k}", a, unit="m/s^2")
    laws, (times, step) = {"O": motion.polynomial(0.4, 10.0)}, ((0.0, 0.2, 401), 5e-4)
    found = evaluate(Scene(m, laws, ["output"], t=times, posture={"Q": 2.9}))
    for k in range(3):
        x, weights = found.output(f"x{k}"), np.array([-1, 16, -30, 16, -1]) / (12 * step**2)
        np.testing.assert_allclose(
            found.output(f"a{k}")[2:-2], np.convolve(x, weights, "valid"), atol=1e-4
        )


@pytest.mark.parametrize("size", [1.0, 1e-12, 1e12])
def test_what_equilibrium_leaves_open_leaves_them_open(size):
    """A guide and a constraint share the load of a slider, in units of any size."""
    m = Mechanism("guided_twice")
    crank, rod = m.link("crank", length=0.1, mass=1.0), m.link("rod", length=0.4, mass=1.0)
    slider = m.point_mass("slider", 2.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, slider)
    guide = m.prismatic("guide", m.ground, slider, axis=(1, 0))
    rest = m.constraint("rest", size * m.place(rod.tip)[1])
    guided, borne = m.results.reaction(guide).fy, m.results.multiplier(rest) * size
    m.output("share", size * guided, unit="N m")
    m.output("whole", size * (guided + borne), unit="N m")
    slowly = motion.polynomial(0.3, 1e-9)
    found = evaluate(Scene(m, {"O": slowly}, t=(0, 1, 3), posture={"rod": 0.0}))
    assert {"output:share", "multiplier:rest"} <= {*found.undetermined}
    assert "output:whole" not in found.undetermined
    np.testing.assert_allclose(found.output("whole"), size * 2.5 * 9.81)


@pytest.mark.parametrize(
    ("declare", "error", "told"),
    [
        (
            lambda m, p: m.output("power", 1.0),
            DeclarationError,
            "output 'power' is declared twice in mechanism 'engine'",
        ),
        (lambda m, p: m.output("a b", 1.0), DeclarationError, "output name 'a b' must be a letter"),
        (
            lambda m, p: m.output("x", ca.SX.sym("y")),
            DeclarationError,
            "output 'x' depends on 'y', not a parameter, .* result",
        ),
        (
            lambda m, p: m.output("x", None),
            DeclarationError,
            "output 'x' must be a number or an expression",
        ),
        (
            lambda m, p: m.output("x", ca.vertcat(m.time, m.time)),
            DeclarationError,
            "output 'x' must be a scalar",
        ),
        (lambda m, p: m.output("x", 1.0, unit="a\nb"), DeclarationError, "its unit must be a line"),
        (
            lambda m, p: m.results.section(p["rod"], 1.5),
            DeclarationError,
            "expected a ratio xi/l from 0 to 1, got 1.5",
        ),
        (
            lambda m, p: m.results.section(m.ground, 0.5),
            DeclarationError,
            "section: 'ground' is not a link",
        ),
        (
            lambda m, p: m.results.friction("gas"),
            UnknownNameError,
            "unknown friction of mechanism 'engine' 'gas'",
        ),
        (
            lambda m, p: m.results.load("gas"),
            DeclarationError,
            "expected the load that its declaration returned, got its name 'gas'",
        ),
        (
            lambda m, p: m.results.multiplier(p["rod"]),
            UnknownNameError,
            "unknown constraint of mechanism 'engine' 'rod'",
        ),
        (
            lambda m, p: m.force("f", p["rod"], x=m.results.effort(p["main"])),
            DeclarationError,
            "depends on 'effort:main', not",
        ),
        (
            lambda m, p: m.force("f", p["rod"], x=m.results.acceleration(p["main"])),
            DeclarationError,
            "on 'main_acceleration'",
        ),
    ],
)
def test_misuse_is_told(declare, error, told):
    with pytest.raises(error, match=told):
        engine(more=declare)


def test_an_effort_of_what_is_no_drive_is_refused():
    """That of a cylinder which is none is zero in the cylinder's own outputs alone."""
    m = Mechanism("lift")
    boom = m.link("boom", length=1.0, mass=5.0)
    m.revolute("O", m.ground, boom)
    base = m.ground.at(0.5, -0.3)
    ram = elements.cylinder(m, "ram", base, boom, bore=0.05, rod=0.03, closed=0.1)
    m.output("push", m.results.effort(ram.slide))
    scene = Scene(m, {"O": motion.polynomial(0.3)}, t=(0, 0, 1), posture={"ram_barrel": 2.5})
    with pytest.raises(DeclarationError, match="of effort:ram, but joint 'ram' is not a drive"):
        evaluate(scene)
