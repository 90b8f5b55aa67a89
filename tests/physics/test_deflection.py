"""Deflections of links, and of the tool that they carry: closed forms of Euler and Bernoulli with
Timoshenko's shear, and fine sums.
"""

from __future__ import annotations

import numpy as np
import pytest
import strong

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, beams, evaluate, tool_deflection
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

STEEL = beams.material("S235")


E, G = STEEL.elasticity, STEEL.shear_modulus


LENGTH = 2.0


SHAPES = [
    beams.rectangle(0.05, 0.02),
    beams.i_section(0.1, 0.055, 0.004, 0.006),
    beams.tube(0.04, 0.003),
]


WANTED = ["section", "deflection"]


def cantilever(shape, material=STEEL, wanted=("section",), **forces):
    m = Mechanism("cantilever")
    m.set_gravity(0.0, 0.0)
    arm = m.link("arm", length=LENGTH, beam=beams.Beam(shape, material))
    m.weld("wall", m.ground, arm)
    m.force("push", arm.tip, **forces)
    return evaluate(Scene(m, {}, wanted, t=(0, 0, 1), xi=(0, 1, 9)))


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.kind)
def test_a_cantilever_with_a_load_at_its_tip(shape):
    """F l^3/3EI + F l/GAs, F l^2/2EI, and all along F (3 l x^2 - x^3)/6EI + F x/GAs."""
    solution = cantilever(shape, wanted=WANTED, x=3e3, y=-100.0)
    found = solution.deflection("arm")
    p, force = shape.properties(), -100.0
    ei, ga, x = E * p.iz, G * p.shear_y, LENGTH * np.linspace(0, 1, 9)
    assert found.against == "base"
    assert found.tip["across"] == pytest.approx(
        force * LENGTH**3 / (3 * ei) + force * LENGTH / ga, rel=1e-13
    )
    assert found.tip["turn"] == pytest.approx(force * LENGTH**2 / (2 * ei), rel=1e-13)
    assert found.tip["along"] == pytest.approx(3e3 * LENGTH / (E * p.area), rel=1e-13)
    curve = force * (3 * LENGTH * x**2 - x**3) / (6 * ei) + force * x / ga
    np.testing.assert_allclose(found.grid("across")[0], curve, rtol=1e-12, atol=1e-18)
    assert found.peak().value == pytest.approx(found.tip["across"][0], rel=1e-13)
    assert found.peak().xi == pytest.approx(1.0)
    series = solution.series["deflection:arm:across"]
    assert series == pytest.approx(abs(found.tip["across"]), rel=1e-12)


def test_a_tip_that_lags_behind_an_arm_that_starts():
    """11 w l^4/120EI + w l^2/3GAs, for loads that grow from none at the hub to w at the tip."""
    m, shape = Mechanism("starting"), SHAPES[0]
    m.set_gravity(0.0, 0.0)
    arm = m.link("arm", length=LENGTH, beam=beams.Beam(shape, STEEL))
    m.revolute("O", m.ground, arm)
    found = tool_deflection(Scene(m, {"O": polynomial(0.0, 0.0, 15.0)}, t=(0, 0, 1)), arm.tip)
    p = shape.properties()
    w = 30.0 * LENGTH * STEEL.density * p.area
    lag = 11 * w * LENGTH**4 / (120 * E * p.iz) + w * LENGTH**2 / (3 * G * p.shear_y)
    np.testing.assert_allclose(found.moved, [[0.0, -lag]], rtol=1e-10, atol=1e-10 * lag)


def test_a_cantilever_in_space():
    """Bent both ways, pulled and twisted: F l^3/3EI + F l/GAs + M l^2/2EI across in either plane,
    F l/EA along, T l/GJ about the axis.
    """
    m, shape, l = SpatialMechanism("arm"), beams.rectangle(0.03, 0.05), LENGTH
    m.set_gravity(0.0, 0.0, 0.0)
    arm = m.link("arm", length=l, beam=beams.Beam(shape, STEEL))
    m.weld("wall", m.ground, arm, turned=[("z", "30 deg"), ("y", "-20 deg")])
    m.force("push", arm.tip, x=50.0, y=-100.0, z=30.0)
    m.torque("twist", arm.tip, x=5.0, y=2.0, z=-3.0)
    solution, p = evaluate(Scene(m, {}, ["all", "deflection"], t=(0, 0, 1))), shape.properties()
    axes = solution.pose("arm").axes[0]
    (fx, fy, fz), (mx, my, mz) = axes @ [50.0, -100.0, 30.0], axes @ [5.0, 2.0, -3.0]
    told = {
        "along": fx * l / (E * p.area),
        "across_y": fy * (l**3 / (3 * E * p.iz) + l / (G * p.shear_y)) + mz * l**2 / (2 * E * p.iz),
        "across_z": fz * (l**3 / (3 * E * p.iy) + l / (G * p.shear_z)) - my * l**2 / (2 * E * p.iy),
        "twist": mx * l / (G * p.torsion),
        "turn_y": (my * l - fz * l**2 / 2) / (E * p.iy),
        "turn_z": (mz * l + fy * l**2 / 2) / (E * p.iz),
    }
    found = solution.deflection("arm")
    assert {name: found.tip[name][0] for name in told} == pytest.approx(told, rel=1e-9)
    assert {name: found.base[name][0] for name in told} == dict.fromkeys(told, 0.0)
    for largest in (found.largest()[0], solution.series["deflection:arm:across"]):
        assert largest[0] == pytest.approx(np.hypot(told["across_y"], told["across_z"]), rel=1e-9)


def test_a_beam_in_space_held_at_both_ends():
    """Its middle under a load there: F l^3/192EI + F l/4GAs across in either plane, F l/4EA
    along.
    """
    m, shape, l = SpatialMechanism("held"), beams.rectangle(0.03, 0.05), LENGTH
    m.set_gravity(0.0, 0.0, 0.0)
    bar = m.link("bar", length=l, beam=beams.Beam(shape, STEEL))
    m.weld("A", m.ground, bar, turned=[("z", "90 deg")])
    m.weld("B", m.ground.at(0, l, 0), bar.tip, turned=[("z", "90 deg")])
    m.force("push", bar.at(l / 2), x=50.0, y=-1e4, z=30.0)
    p, scene = shape.properties(), Scene(m, {}, t=(0, 0, 1), elastic=True)
    told = [
        50.0 * (l**3 / (192 * E * p.iz) + l / (4 * G * p.shear_y)),
        -1e4 * l / (4 * E * p.area),
        30.0 * (l**3 / (192 * E * p.iy) + l / (4 * G * p.shear_z)),
    ]
    found = tool_deflection(scene, bar.at(l / 2))
    assert found.moved[0] == pytest.approx(told, rel=1e-9)
    assert found.largest == pytest.approx(np.linalg.norm(told), rel=1e-9)


def test_a_rod_that_moves_by_fine_sums():
    """Stations that slide, a load along it, a taper: the curve from moments on a fine grid, at
    every instant.
    """
    scene = strong.press(
        beams.tapered(beams.rectangle(0.02, 0.01), beams.rectangle(0.012, 0.01)),
        sliding=True,
        t=(0, 0.2, 7),
    )
    found = evaluate(scene, certificate=False).deflection("rod")
    n, member = 20_000, found.member
    s = (np.arange(n) + 0.5) / n
    u = np.broadcast_to(s, (7, n))
    h, ds, e = 0.02 - 0.008 * s, 0.4 / n, strong.STEEL.elasticity
    bent = member.law.at("bending", u) / (e * 0.01 * h**3 / 12)
    sheared = member.law.at("shear", u) / (
        strong.STEEL.shear_modulus * 0.01 * h * 10 * 1.3 / (12 + 11 * 0.3)
    )
    turned = np.cumsum(bent, axis=1) * ds - bent * ds / 2
    across = np.cumsum(turned + sheared, axis=1) * ds - (turned + sheared) * ds / 2
    tip = np.sum(turned + sheared, axis=1) * ds
    expected = across - s * tip[:, None]
    size = np.abs(expected).max()
    np.testing.assert_allclose(found.at("across", u), expected, atol=1e-6 * size)
    values, places = found.largest()
    np.testing.assert_allclose(np.abs(values), np.abs(found.at("across", u)).max(axis=1), rtol=1e-7)
    np.testing.assert_allclose(found.at("across", places[:, None])[:, 0], values, rtol=1e-12)


PAPER = beams.Material("paper", 700.0)


def twisted():
    m = SpatialMechanism("odd")
    odd = beams.polygon([(0, 0), (0.02, 0), (0, 0.03)])
    arm = m.link("arm", length=1.0, beam=beams.Beam(odd, STEEL))
    m.revolute("O", m.ground, arm, axis=(0, 0, 1))
    return evaluate(Scene(m, {"O": polynomial(0.0)}, t=(0, 0, 1)))


def held(**matter):
    m = Mechanism("held")
    m.weld("A", m.ground, m.link("bar", length=1.0, **matter))
    return Scene(m, {}, wanted=["deflection:bar"], t=(0, 0, 1))


def pressed(place):
    scene = strong.press(beams.rectangle(0.012, 0.006))
    return tool_deflection(scene, scene.mechanism.ground.at(0.0, 0.0) if place is None else place)


@pytest.mark.parametrize(
    ("ask", "error", "says"),
    [
        (
            lambda: cantilever(SHAPES[0], y=-1.0).deflection("arm").grid("bending"),
            UnknownNameError,
            "unknown deflection 'bending'",
        ),
        (
            lambda: cantilever(SHAPES[0], y=-1.0).deflection("arm", "middle"),
            DeclarationError,
            "expected against='ends' or 'base', got 'middle'",
        ),
        (
            lambda: cantilever(SHAPES[0], PAPER, y=-1.0).deflection("arm"),
            DeclarationError,
            "material 'paper' has no elasticity and no shear_modulus, which",
        ),
        (
            lambda: twisted().deflection("arm"),
            DeclarationError,
            "deflection of 'arm': there is no formula for torsion of a polygon",
        ),
        (
            lambda: held(mass=1.0),
            DeclarationError,
            "output 'deflection:bar': link 'bar' has no beam",
        ),
        (
            lambda: held(beam=beams.Beam(SHAPES[0], PAPER)),
            DeclarationError,
            "material 'paper' has no elasticity, which output 'deflection:bar' needs",
        ),
        (
            lambda: (
                evaluate(strong.press(SHAPES[0]), t=(0, 0.2, 3)).deflection("rod").at("across", 2)
            ),
            DeclarationError,
            "deflection: expected ratios xi/l from 0 to 1, a row for each of",
        ),
        (
            lambda: pressed("ram"),
            DeclarationError,
            "tool_deflection: expected a point of the mechanism, got 'ram'",
        ),
        (
            lambda: pressed(None),
            DeclarationError,
            "the point is on 'ground', expected a moving body of 'press'",
        ),
    ],
)
def test_what_has_no_meaning_is_one_line(ask, error, says):
    with pytest.raises(error, match=says):
        ask()
