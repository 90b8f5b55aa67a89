"""The case of a planetary gear and its element: Willis's equation, closed forms of what pins bear,
and what is refused.
"""

import math

import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate, load_case
from lagrange_casadi.elements import planetary, wheel
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

TAN = math.tan(math.radians(20.0))


@pytest.mark.parametrize("values", [{}, {"module": 0.003, "torque": 200.0, "rpm": 300.0}])
def test_the_case_is_that_of_closed_forms(values):
    """Speeds, torques, the force of the teeth and what a planet's pin bears, at a steady load."""
    solution = evaluate(
        load_case(CASES / "planetary_gear").scene, parameters=values | {"unsteady": 0.0}
    )
    assert solution.certified
    told = {"module": 0.002, "torque": 90.0, "rpm": 1450.0} | values
    slow = told["rpm"] * 2 * math.pi / 60 / 3.5
    sun, planet = told["module"] * 12, told["module"] * 9
    assert solution.motion("output").rate == pytest.approx(np.full(421, slow), rel=1e-13)
    assert solution.effort("input") == pytest.approx(np.full(421, told["torque"] / 3.5), rel=1e-12)
    assert np.abs(solution.reaction("housing").mz) == pytest.approx(
        np.full(421, told["torque"] * 2.5 / 3.5), rel=1e-12
    )
    force = told["torque"] / 3.5 / 3 / sun
    assert np.abs(solution.output("set_sun_tangential")) == pytest.approx(
        np.full(421, force), rel=1e-12
    )
    for k in (1, 2, 3):
        assert np.abs(solution.multiplier(f"set_ring_{k}")) == pytest.approx(
            np.full(421, force), rel=1e-12
        )
        out = np.exp(1j * (solution.motion("output").value + 2 * math.pi * (k - 1) / 3))
        reaction = solution.reaction(f"set_pin_{k}")
        mass = 7850 * math.pi * planet**2 * 0.025
        borne = -2 * force * 1j * out - mass * slow**2 * (sun + planet) * out + 9.81j * mass
        assert reaction.fx + 1j * reaction.fy == pytest.approx(borne, rel=0, abs=1e-11 * force)
    assert solution.output("set_sun_radial") == pytest.approx(np.full(421, force * TAN), rel=1e-12)


def gear(driven, held, planets=1, efficiency=None, load=40.0):
    """A planetary set of which one member is driven, one held, and the third loaded."""
    m = Mechanism("set")
    m.set_gravity(0, 0)
    sun = wheel(m, "sun", radius=0.02, mass=1.0)
    ring = wheel(m, "ring", radius=0.06, bore=0.05, mass=2.0)
    carrier = m.link("carrier", length=0.035, mass=1.0, centre=(0, 0), inertia=1e-3)
    bodies = {"sun": sun, "ring": ring, "carrier": carrier}
    for name, body in bodies.items():
        (m.weld if name == held else m.revolute)(f"{name}_bearing", m.ground, body)
    planetary(
        m,
        "set",
        sun,
        carrier,
        ring,
        teeth=(20, 15, 50),
        module=0.002,
        planets=planets,
        mass=0.3,
        efficiency=efficiency,
    )
    (last,) = set(bodies) - {driven, held}
    m.torque("load", bodies[last], load)
    return evaluate(Scene(m, {f"{driven}_bearing": polynomial(0.0, 10.0)}, t=(0, 1, 3))), last


# Willis: (w_sun - w_carrier)/(w_ring - w_carrier) = -z_ring/z_sun.
RATES = {
    ("sun", "ring"): 1 / 3.5,
    ("sun", "carrier"): -0.4,
    ("carrier", "ring"): 3.5,
    ("carrier", "sun"): 1.4,
    ("ring", "sun"): 1 / 1.4,
    ("ring", "carrier"): -2.5,
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("planets", [1, pytest.param(5, marks=pytest.mark.long), 2])
@pytest.mark.parametrize(("driven", "held"), RATES)
def test_each_member_may_drive_and_each_be_held(driven, held, planets):
    solution, last = gear(driven, held, planets)
    assert solution.certified
    ratio = RATES[driven, held]
    assert solution.motion(f"{last}_bearing").rate == pytest.approx(
        np.full(3, 10.0 * ratio), rel=1e-13
    )
    assert solution.effort(f"{driven}_bearing") == pytest.approx(
        np.full(3, -40.0 * ratio), rel=1e-11
    )
    # All three torques are in balance.
    assert solution.reaction(f"{held}_bearing").mz == pytest.approx(
        np.full(3, -40.0 * (1 - ratio)), rel=1e-11, abs=1e-11
    )
    pins = [solution.reaction(f"set_pin_{k + 1}") for k in range(planets)]
    teeth = np.abs(solution.multiplier("set_sun"))
    turning = (
        0.3 * 0.035 * solution.motion("carrier_bearing").rate ** 2 if held != "carrier" else 0.0
    )
    for pin in pins:
        assert pin.resultant == pytest.approx(np.hypot(2 * teeth, turning), rel=1e-11)


@pytest.mark.parametrize("planets", [1, 2])
@pytest.mark.parametrize("load", [-40.0, 40.0])
def test_its_efficiency_is_that_of_its_meshes_seen_from_the_carrier(planets, load):
    """Niemann and Winter: with i the ring's teeth over the sun's, (1 + i e)/(1 + i), with e of both
    meshes; backward (1 + i/e).
    """
    solution, _ = gear("sun", "ring", planets, 0.97, load)
    assert solution.certified
    given = solution.effort("sun_bearing") * 10.0
    taken = -load * solution.motion("carrier_bearing").rate
    share = (1 + 2.5 * 0.97 ** (2 if load < 0.0 else -2)) / 3.5
    assert taken / given == pytest.approx(np.full(3, share), rel=1e-9)
    lost = solution.output("set_sun_loss") + sum(
        solution.output(f"set_ring_{k + 1}_loss") for k in range(planets)
    )
    assert lost == pytest.approx(given - taken, rel=1e-8)


@pytest.mark.quick
def test_what_does_not_fit_is_refused_by_name():
    def refused(told, **more):
        m = Mechanism("set")
        sun, carrier = (
            m.link(name, length=0.05, mass=1.0, centre=(0, 0), inertia=1e-3)
            for name in ("sun", "carrier")
        )
        m.revolute("A", m.ground, sun)
        m.revolute("B", m.ground, carrier)
        with pytest.raises(DeclarationError) as error:
            planetary(
                m,
                "set",
                sun,
                carrier,
                m.ground,
                **({"teeth": (24, 18, 60), "module": 0.002, "mass": 0.1} | more),
            )
        assert told in str(error.value)
        assert "\n" not in str(error.value)

    refused("its ring has 61 teeth; expected 60", teeth=(24, 18, 61))
    refused("teeth: expected a list, each a whole number", teeth=(24, 18.5, 61))
    refused("5 planets cannot be evenly spaced; expected a number that divides 84", planets=5)
    refused("7 planets of 18 teeth do not fit", planets=7)
    refused("module must be positive, got -0.002 m", module=-0.002)
    m = SpatialMechanism("space")
    with pytest.raises(DeclarationError, match="only a mechanism in a plane has it"):
        planetary(
            m, "set", m.ground, m.ground, m.ground, teeth=(24, 18, 60), module=0.002, mass=0.1
        )
