"""Geneva drives beside a published table, and their misuse. Random mechanisms hold their motion and
forces against free bodies.

Source of the table: J. H. Bickford, *Mechanisms for Intermittent Motion*, 1972, chapter 9.
"""

import math

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.elements import geneva
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

AXLE = 0.1 * np.array([math.cos(0.3), math.sin(0.3)])


def drive(slots, omega=5.0, t=(0, 4.0, 401)):
    """A wheel 0.1 m from a crank, which begins 0.9 rad behind the middle of the engagement."""
    m = Mechanism("geneva")
    m.set_gravity(0, 0)
    r = m.parameter("r", 0.1 * math.sin(math.pi / slots), "m")
    crank = m.link("crank", length=r, mass=0.3, centre=(0, 0), inertia=1e-4)
    wheel = m.link("wheel", length=0.1, mass=1.0, centre=(0, 0), inertia=1.5e-3)
    main = m.revolute("main", m.ground, crank)
    axle = m.revolute("axle", m.ground.at(*AXLE), wheel)
    made = geneva(m, "g", main, axle, slots=slots)
    return made, Scene(m, {"main": polynomial(0.3 - 0.9, omega)}, t=t)


@pytest.mark.parametrize(
    ("slots", "speed", "acceleration"),
    [(3, 6.46, 31.4), (4, 2.41, 5.41), (5, 1.43, 2.30), (6, 1.0, 1.35), (8, 0.620, 0.700)],
)
def test_the_largest_speed_and_acceleration_are_those_of_the_table(slots, speed, acceleration):
    made, scene = drive(slots, omega=1.0, t=(0, 2.0, 201))
    assert made.engaged == pytest.approx(math.pi - math.tau / slots)
    assert made.engaged + made.dwell == pytest.approx(math.tau)
    wheel = evaluate(scene).motion("axle")
    assert np.abs(wheel.rate).max() == pytest.approx(speed, rel=3e-3)
    assert np.abs(wheel.acceleration).max() == pytest.approx(acceleration, rel=3e-3)


def test_a_parameter_that_does_not_fit_is_refused():
    _, scene = drive(4)
    words = "'g': its pin is 0.08 m from the crank's axis; expected 0.0707107 m, the distance of"
    with pytest.raises(ParameterError, match=words):
        evaluate(scene, parameters={"r": 0.08})


def joined(space=False, length=0.05, apart=0.0707106781186548):
    m = SpatialMechanism("m") if space else Mechanism("m")
    axis = {"axis": (0, 0, 1)} if space else {}
    crank, wheel = (m.link(name, length=length, mass=1.0) for name in ("crank", "wheel"))
    far = m.ground.at(apart, 0.0)
    joints = m.revolute("main", m.ground, crank, **axis), m.revolute("axle", far, wheel, **axis)
    return m, *joints


@pytest.mark.parametrize(
    ("says", "made", "given"),
    [
        ("slots: expected a whole number from 3 to 12, got 2", {}, {"slots": 2}),
        ("expected two revolute joints of one parent, in a plane", {"space": True}, {}),
        ("its pin is 0.06 m from the crank's axis; expected 0.05 m", {"length": 0.06}, {}),
        ("its locking arc of 0.055 m .* expected less .*, as 0.05 m", {}, {"lock": 0.055}),
        ("its pin must be on 'crank', got 'wheel'", {}, {"pin": "wheel"}),
        ("the distance of both axes must be positive, got 0 m", {"apart": 0.0}, {}),
    ],
)  # fmt: skip
def test_misuse_is_named(says, made, given):
    m, main, axle = joined(**made)
    given = {key: m.links[it].tip if key == "pin" else it for key, it in given.items()}
    with pytest.raises(DeclarationError, match=f"geneva 'g': {says}"):
        geneva(m, "g", main, axle, **{"slots": 4} | given)
