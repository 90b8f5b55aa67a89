"""The case of a connecting rod, number by number against its textbook. R. S. Khurmi and J. K.
Gupta, A Textbook of Machine Design, chapter 32, sections 32.14 and 32.15 and example 32.3.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from lagrange_casadi import evaluate, load_case

pytestmark = pytest.mark.usefixtures("interpreted")

T, LENGTH, RADIUS = 7e-3, 0.38, 0.095


EVEN = {"big": 1.0, "small": 1.0}


@pytest.fixture(scope="module")
def scene():
    return load_case("connecting_rod").scene


@pytest.fixture(scope="module")
def even(scene):
    """The section of the middle throughout, as the textbook has it, so slow that gas alone acts."""
    return evaluate(scene, parameters={**EVEN, "rpm": 2.0}, certificate=False)


def test_the_cross_section_of_11_t_t(even):
    p = even.stress("rod").member.cross.properties(0, 0.5)
    assert p.area == pytest.approx(11 * T**2, rel=1e-12)
    assert p.iz == pytest.approx(419 / 12 * T**4, rel=1e-12)
    assert p.iy == pytest.approx(131 / 12 * T**4, rel=1e-12)
    assert 3.0 < p.iz / p.iy < 3.5
    assert even.description.bodies["rod"].mass == pytest.approx(11 * T**2 * 8000 * LENGTH)


def test_the_gas_force(even):
    """pi/4 100^2 3.15 = 24 740 N on the piston, 15 degrees behind the dead centre; the rod leans a
    little.
    """
    lean = math.asin(RADIUS * math.sin(math.radians(15)) / LENGTH)
    least = even.section("rod").law.reached("axial")[1][0].min()
    assert -least == pytest.approx(24_740 / math.cos(lean), rel=5e-3)


def test_bending_by_its_own_inertia(scene):
    """m r w^2 l^2 / (9 sqrt 3) supposes a rod at right angles to the crank, and that its motion is
    a pure turning there.
    """
    whipped = evaluate(scene, parameters={**EVEN, "pressure": 0.0}, certificate=False)
    formula = (
        11 * T**2 * 8000 * RADIUS * (1800 * 2 * math.pi / 60) ** 2 * LENGTH**2 / (9 * math.sqrt(3))
    )
    peak = whipped.peak("section:rod:bending")
    assert abs(peak.value) == pytest.approx(formula, rel=0.04)
    # From the piston's pin it is 1/sqrt 3 of the length away.
    assert 1 - peak.xi == pytest.approx(1 / math.sqrt(3), abs=0.02)
    stress = whipped.stress("rod")
    upper, lower = (
        stress.at(peak.xi)[0, stress.fibres(peak.xi).index(f"corner {side}y +z")] for side in "+-"
    )
    bending = (upper - lower)[int(np.argmin(abs(whipped.t - peak.t)))] / 2
    assert abs(bending) == pytest.approx(abs(peak.value) / (419 / 30 * T**3), rel=1e-9)


def test_the_bearings_bear_the_gas_force(scene):
    """24 740 N over 1.3 d^2 and 2 d^2 at 10 and 15 N/mm^2: 43.6 and 28.7 mm, rounded upward to 44
    and 29 mm, 58 mm wide.
    """
    for joint, ratio, pressure in (("crankpin", 1.3, 10.0), ("piston_pin", 2.0, 15.0)):
        bearing = scene.mechanism.fitted[joint].plain
        assert bearing.pressure == pressure * 1e6
        assert 1e3 * bearing.bore == math.ceil(math.sqrt(24_740 / (ratio * pressure)))
        assert 1e3 * bearing.width == math.ceil(1e3 * ratio * bearing.bore)
