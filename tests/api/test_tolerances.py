"""Tolerances: the spread of peaks beside closed forms, to first order and drawn; what the command
says, and its mistakes.
"""

import math

import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import Mechanism, Scene, load_case, tolerances
from lagrange_casadi.errors import DeclarationError, ParameterError, UnknownNameError
from lagrange_casadi.motion import polynomial


def rotor():
    """The axial force at the base of a link that turns steadily is m w^2 l/2."""
    m = Mechanism("rotor")
    m.set_gravity(0, 0)
    l = m.parameter("l", 0.4, "m", low=0.0)
    mass = m.parameter("mass", 2.0, "kg")
    speed = m.parameter("speed", 30.0, "rad/s")
    tilt = m.parameter("tilt", 0.2, "rad")
    m.revolute("O", m.ground, m.link("arm", length=l, mass=mass))
    return Scene(m, {"O": polynomial(tilt, speed)}, t=(0, 0.2, 11), wanted=["section"])


def test_spreads_are_those_of_the_closed_form():
    found = tolerances(
        rotor(), {"l": "2mm", "mass": "1%", "speed": 0.15, "tilt": "1deg"}, samples=20_000
    )
    spread = found.peaks["section:arm:axial"]
    force = 2.0 * 30.0**2 * 0.4 / 2
    relative = {"l": 0.005, "mass": 0.01, "speed": 2 * 0.005, "tilt": 0.0}
    assert found.tolerances == pytest.approx(
        {"l": 0.002, "mass": 0.02, "speed": 0.15, "tilt": math.radians(1.0)}
    )
    assert spread.nominal == pytest.approx(force, rel=1e-12)
    assert spread.worst == pytest.approx(force * sum(relative.values()), rel=1e-12)
    sigma = force * math.sqrt(sum(x**2 for x in relative.values()) / 3)
    assert spread.sigma == pytest.approx(sigma, rel=1e-12)
    # Of so many that are drawn the deviation is known to about 1%.
    assert spread.deviation == pytest.approx(sigma, rel=0.02)
    assert spread.mean == pytest.approx(force, rel=3 * sigma / force / math.sqrt(20_000))
    assert force - 1.02 * spread.worst < spread.low < spread.high < force + 1.02 * spread.worst
    assert list(spread.shares.values()) == sorted(spread.shares.values(), reverse=True)
    assert spread.shares == pytest.approx({"mass": 4 / 9, "speed": 4 / 9, "l": 1 / 9, "tilt": 0.0})
    assert found.failed == 0


def test_designs_without_a_result_are_counted():
    scene = load_case(CASES / "slider_crank").scene
    found = tolerances(scene, {"l": 0.02}, parameters={"l": 0.11}, wanted=["effort"], samples=200)
    assert 20 < found.failed < 100  # those shorter than the crank, of 0.1 m
    assert np.isfinite(found.peaks["effort:O"].deviation)


@pytest.mark.parametrize(
    ("name", "value", "found"),
    [
        ("l", 0.001, 0.001),
        ("l", "50um", 5e-5),
        ("l", "0.1 cm", 1e-3),
        ("l", " 1e-3 m ", 1e-3),
        ("l", "1%", 0.004),
        ("mass", "2g", 2e-3),
        ("tilt", "0.5deg", math.radians(0.5)),
    ],
)
def test_tolerances_are_read_with_their_units(name, value, found):
    told = tolerances(rotor(), {name: value}, samples=2).tolerances
    assert told == pytest.approx({name: found}, rel=1e-14)


@pytest.mark.parametrize(
    ("given", "words", "error", "says"),
    [
        ({"k": 0.1}, {}, UnknownNameError, "unknown parameter 'k'"),
        ({"l": 0.5}, {}, ParameterError, "out of its range"),
        ({}, {}, DeclarationError, "expected tolerances by parameter"),
        ({"l": 0.001}, {"samples": 1}, DeclarationError, "samples: expected a whole number"),
        ({"l": 0.001}, {"scene": None}, DeclarationError, "expected a Scene"),
        *(
            ({"l": value}, {}, DeclarationError, "'l': expected a number above 0 in m, or a text")
            for value in (
                *("0.1deg", "x", "", "-1mm", "1 furlong", "mm", "%"),
                *(0.0, math.nan, math.inf, True, None),
            )
        ),
    ],
)
def test_mistakes(given, words, error, says):
    with pytest.raises(error, match=says):
        tolerances(**{"scene": rotor(), "within": given, **words})
