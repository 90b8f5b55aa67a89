"""Columns against Euler's and Johnson's closed forms, the interaction with bending, and how joints
hold the ends of links.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import strong
from mechanisms import pins_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, beams, evaluate
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

E, YIELD, LENGTH = 210e9, 490e6, 0.4

PUSH = 2e3


def buckles(shape, moment=0.0, push=PUSH, columns=None):
    """Return the factor against buckling of a bar on a pin and a slide, pressed along its axis and
    bent evenly.
    """
    m = Mechanism("strut")
    m.set_gravity(0.0, 0.0)
    bar = m.link("bar", length=LENGTH, beam=beams.Beam(shape, strong.STEEL, columns=columns))
    foot = m.point_mass("foot", 0.0)
    m.revolute("A", m.ground, bar)
    m.prismatic("slide", m.ground.at(LENGTH, 0.0), foot, axis=(1, 0))
    m.revolute("B", bar.tip, foot)
    m.force("push", foot, x=-push)
    m.torque("one", bar.base, moment)
    m.torque("other", bar.tip, -moment)
    scene = Scene(m, {}, t=(0.0, 0.0, 1), posture={"bar": 0.0, "slide": 0.0})
    return evaluate(scene, certificate=False).safety("bar").against("buckling")


def critical(height, width, effective=1.0):
    """Return the critical and Euler's load, by the slenderness in the plane."""
    area, slender = height * width, effective * LENGTH / (height / math.sqrt(12))
    euler = math.pi**2 * E / slender**2
    johnson = YIELD * (1 - YIELD * slender**2 / (4 * math.pi**2 * E))
    return area * (euler if euler < YIELD / 2 else johnson), area * euler


@pytest.mark.parametrize("moment", [0.0, 5.0, -40.0])
@pytest.mark.parametrize("sizes", [(0.006, 0.02), (0.008, 0.02), (0.02, 0.05)])
def test_a_strut_bears_the_root_of_the_interaction(sizes, moment):
    """Slender ones bear Euler's load, stout ones Johnson's; with bending the factor n is a root of
    a e n^2 - (a + m + e) n + 1 = 0.
    """
    (load, euler), (height, width) = critical(*sizes), sizes
    a, e, m = PUSH / load, PUSH / euler, abs(moment) / (YIELD * width * height**2 / 6)
    b = a + m + e
    told = 2.0 / (b + math.sqrt(b * b - 4 * a * e))
    assert buckles(beams.rectangle(*sizes), moment) == pytest.approx(told, rel=1e-9)
    assert buckles(beams.rectangle(*sizes), moment, -PUSH) == math.inf


def test_the_weakest_axis_and_the_thinnest_place_count():
    """Of a flat bar that is turned in its cross-section by 30 degrees: its least second moment."""
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    corners = np.array([(0.015, 0.003), (-0.015, 0.003), (-0.015, -0.003), (0.015, -0.003)])
    turned = [tuple(map(float, corner)) for corner in corners @ np.array([[c, s], [-s, c]])]
    least = math.pi**2 * E * (0.03 * 0.006**3 / 12) / LENGTH**2
    found = buckles(beams.polygon(turned), columns=(1.0, 1.0))
    assert found == pytest.approx(least / PUSH, rel=1e-9)
    taper = beams.tapered(beams.rectangle(0.02, 0.01), beams.rectangle(0.01, 0.01))
    assert buckles(taper) == pytest.approx(buckles(beams.rectangle(0.01, 0.01)), rel=1e-9)


def driven(m, arm, axis):
    """A crank whose rod ends on a slide."""
    rod, foot = m.link("rod", length=0.5, mass=1.0), m.point_mass("foot", 1.0)
    pins_of(m, O=(m.ground, arm), A=(arm.tip, rod), B=(rod.tip, foot))
    m.prismatic("guide", m.ground.at(0.0, -0.3), foot, axis=(1, 0))
    return ["O"]


def free(m, arm, axis):
    m.revolute("O", m.ground, arm, **axis)
    m.weld("lump", arm.tip, m.point_mass("mass", 1.0))
    return ["O"]


def clamped(m, arm, axis):
    m.prismatic("O", m.ground, arm, axis=(1, 0))
    m.weld("A", arm.tip, m.link("other", length=0.3, mass=1.0))
    return ["O"]


def swung(m, arm, axis):
    m.revolute("O", m.ground, arm, **axis)
    m.spherical("A", arm.tip, m.link("other", length=0.3, mass=1.0))
    return ["O", "A:turn_1", "A:turn_2", "A:turn_3"]


@pytest.mark.parametrize("sizes", [(0.006, 0.02), (0.02, 0.006)])
@pytest.mark.parametrize(
    ("kind", "build", "columns"),
    [
        (Mechanism, driven, (2.0, 0.5)),
        (Mechanism, free, (2.0, 2.0)),
        (Mechanism, clamped, (1.0, 0.5)),
        (SpatialMechanism, swung, (1.0, 1.0)),
        (SpatialMechanism, free, (2.0, 2.0)),
    ],
)
def test_joints_tell_how_ends_are_held(kind, build, columns, sizes):
    """A link without effective lengths of its own has the factor of one that is given them."""

    def told(given):
        m = kind("held")
        beam = beams.Beam(beams.rectangle(*sizes), strong.STEEL, columns=given)
        arm = m.link("arm", length=LENGTH, beam=beam)
        drives = build(m, arm, {} if kind is Mechanism else {"axis": (0, 0, 1)})
        m.force("push", arm.tip, x=-PUSH)
        scene = Scene(
            m,
            {name: polynomial(0.0) for name in drives},
            t=(0.0, 0.0, 1),
            posture={"rod": -0.6} if build is driven else {},
        )
        return evaluate(scene, certificate=False).safety("arm").against("buckling")

    shorter = tuple(0.7 * length for length in columns)
    assert math.inf > told(columns) == told(None) != told(shorter)


def test_what_slides_along_a_link_holds_none_of_its_ends():
    """Its place on the link is told as the base, and is not there."""
    sliding, still = (
        evaluate(strong.press(beams.rectangle(0.02, 0.01), columns=columns, sliding=True))
        for columns in (None, (1, 0.5))
    )
    assert sliding.safety("rod") == still.safety("rod")


def test_what_lacks_is_named():
    plain = beams.Material("plain", 7850.0, yield_strength=1e8)
    m = Mechanism("m")
    beam = beams.Beam(beams.round_bar(0.02), plain)
    m.revolute("O", m.ground, m.link("arm", length=0.4, beam=beam))
    motion, t = {"O": polynomial(0.3, 2.0)}, (0, 1, 11)
    for wanted, lacks in (
        ("section", "elasticity, which buckling needs"),
        ("safety:arm", "elasticity, which output 'safety:arm' needs"),
        ("life:arm", "ultimate and no endurance, which output 'life:arm' needs"),
    ):
        with pytest.raises(DeclarationError, match=f"material 'plain' has no {lacks}"):
            evaluate(Scene(m, motion, t=t, wanted=[wanted]), certificate=False).safety("arm")
