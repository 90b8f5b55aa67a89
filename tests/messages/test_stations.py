"""Stations along links: those at the ends within rounding, those beyond, which are refused with
lines that make a link of what reaches there, and sections where there are none.
"""

import re
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanisms import pins_of

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def shelf(x, length, parameters=True):
    """A lump on a level arm, without a mass of its own; both are parameters, or numbers."""
    m = Mechanism("shelf")
    if parameters:
        length, x = m.parameter("l", length, "m"), m.parameter("x", x, "m")
    arm = m.link("arm", length=length, mass=0.0)
    m.revolute("O", m.ground, arm)
    place = arm.at(x)
    m.weld("lump", place, m.point_mass("mass", 2.0))
    m.force("push", place, y=-1.0)
    return Scene(m, {"O": polynomial(0.0)}, t=(0.0, 1.0, 3), xi=(0.0, 1.0, 3))


@settings(max_examples=6, deadline=None)
@given(parts=st.lists(st.integers(1, 999), min_size=2, max_size=12))
def test_a_station_that_misses_an_end_by_rounding_is_there(parts):
    """However a length is summed up: the weight is in the section at the very tip, and what is at
    the base loads no section.
    """
    forward, backward = (sum(part / 1000 for part in way) for way in (parts, parts[::-1]))
    weight = 2.0 * 9.81 + 1.0
    ways = ((forward, backward), (backward, forward), (sum(parts) / 1000, forward))
    for (x, length), parameters in product(ways, (True, False)):
        section = evaluate(shelf(x, length, parameters)).section("arm")
        np.testing.assert_allclose(section.shear, -weight, rtol=1e-14)
        moments = -weight * length * np.array([1.0, 0.5, 0.0])
        np.testing.assert_allclose(section.bending[0], moments, rtol=1e-14, atol=1e-13 * length)
    solution = evaluate(shelf(0.0, 0.3), parameters={"x": forward - backward, "l": forward})
    np.testing.assert_array_equal(solution.section("arm").shear, np.zeros((3, 3)))
    assert solution.certified


def test_a_part_in_1e9_beyond_an_end_is_beyond():
    scene = shelf(0.1, 0.3)
    for x in (0.3 + 1e-14, -1e-14):
        evaluate(scene, parameters={"x": x})
    for x in (0.3 + 1e-9, -1e-9):
        with pytest.raises(ParameterError, match=r"point at .* m is outside link 'arm', 0 to 0\.3"):
            evaluate(scene, parameters={"x": x})
    with pytest.raises(ParameterError, match=r"; with the default parameters l = 0\.2"):
        shelf(0.3, 0.2)


LENGTH, MASS, WEIGHT, G = 0.1, 0.6, 4.0, 9.81


def crank(place):
    """A crank with a counterweight where ``place`` says."""
    m = Mechanism("balanced")
    arm, weight = m.link("arm", length=LENGTH, mass=MASS), m.point_mass("weight", WEIGHT)
    m.revolute("O", m.ground, arm)
    m.weld("bolt", place(m, arm), weight)
    return Scene(m, {"O": polynomial(0.3, 2.0, 5.0)}, t=(0, 1, 21))


@pytest.mark.parametrize("station", [-0.05, -0.3, 0.13])
def test_the_lines_of_a_refusal_make_what_was_meant(station):
    """The drive's torque against J alpha + g (sum of m x) cos(angle), for a rod about its end and a
    point mass.
    """
    says = rf"'bolt': its point at {station} m is outside link 'arm', 0 to 0\.1 m; for a"
    with pytest.raises(ParameterError, match=says) as error:
        crank(lambda m, arm: arm.at(station))
    lines = re.search(r"declare another link: (tail = .*); and use tail\.tip as", str(error.value))

    def place(m, arm):
        names = {"m": m}
        exec(lines[1].replace("; ", "\n"), names)
        return names["tail"].tip

    solution = evaluate(crank(place))
    assert solution.certified
    angle, alpha = solution.motion("O").value, 10.0
    inertia = MASS * LENGTH**2 / 3 + WEIGHT * station**2
    torque = inertia * alpha + G * (MASS * LENGTH / 2 + WEIGHT * station) * np.cos(angle)
    limit = 1e-13 * np.abs(torque).max()
    np.testing.assert_allclose(solution.effort("O"), torque, rtol=0, atol=limit)


WHY = {
    "plate": "link 'plate' has sections only if its mass is given along it",
    "lump": "'lump' is not a link and has no sections; links: rod, plate",
    "rod": "the sections of link 'rod' were not evaluated; add section:rod",
}


@pytest.mark.parametrize("part", WHY)
def test_the_same_explanation_wherever_sections_are_asked_for(part):
    m = Mechanism("plated")
    rod = m.link("rod", length=0.5, mass=1.0)
    plate = m.link("plate", length=0.5, mass=1.0, centre=(0.1, 0.0), inertia=0.1)
    pins_of(m, O=(m.ground, rod), A=(rod.tip, plate))
    m.weld("W", plate.tip, m.point_mass("lump", 1.0))
    scene = Scene(m, {"O": polynomial(0, 1), "A": polynomial(0, 1)}, t=(0, 1, 3))
    solution = evaluate(scene, wanted=["effort"])
    for ask in (
        lambda: solution.section(part),
        lambda: solution.peak(f"section:{part}:bending"),
        lambda: solution.array(f"section:{part}:shear"),
        lambda: evaluate(scene, wanted=[f"section:{part}" if part != "rod" else "effort"]).section(
            part
        ),
    ):
        with pytest.raises(DeclarationError, match=WHY[part]):
            ask()
