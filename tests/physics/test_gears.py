"""Gears in a plane: closed forms, efficiencies, planetary sets, and what is refused."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from mechanisms import links_of, pins_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.elements import gears, planetary, wheel
from lagrange_casadi.errors import AssemblyError, DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.mark.quick
def test_wheels_are_discs():
    m, s = Mechanism("plane"), SpatialMechanism("space")
    disc = wheel(m, "disc", radius=0.1, bore=0.04, width=0.02, teeth=30)
    mass = 7850 * math.pi * (0.1**2 - 0.04**2) * 0.02
    assert disc.mass.mass == pytest.approx(mass)
    assert disc.mass.inertia[2][2] == pytest.approx(mass * (0.1**2 + 0.04**2) / 2)
    assert len(m.outlines["disc"][0]) == 4 * 30 + 48 + 2
    solid = wheel(s, "disc", radius=0.1, mass=2.0, width=None)
    assert [float(solid.mass.inertia[k][k]) for k in range(3)] == pytest.approx(
        [0.01, 0.005, 0.005]
    )
    for told in (
        {"radius": 0.1},
        {"radius": 0.1, "bore": 0.2, "mass": 1.0},
        {"radius": 0.1, "mass": 1.0, "teeth": 2.5},
    ):
        with pytest.raises(DeclarationError, match="wheel 'other'"):
            wheel(m, "other", **told)


def planetary_set(driven, held, planets=1, efficiency=None, load=40.0):
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


@pytest.mark.parametrize("planets", [1, 2])
@pytest.mark.parametrize("load", [-40.0, 40.0])
def test_its_efficiency_is_that_of_its_meshes_seen_from_the_carrier(planets, load):
    """Niemann and Winter: with i the ring's teeth over the sun's, (1 + i e)/(1 + i), with e of both
    meshes; backward (1 + i/e).
    """
    solution, _ = planetary_set("sun", "ring", planets, 0.97, load)
    assert solution.certified
    given = solution.effort("sun_bearing") * 10.0
    taken = -load * solution.motion("carrier_bearing").rate
    share = (1 + 2.5 * 0.97 ** (2 if load < 0.0 else -2)) / 3.5
    assert taken / given == pytest.approx(np.full(3, share), rel=1e-9)
    lost = solution.output("set_sun_loss") + sum(
        solution.output(f"set_ring_{k + 1}_loss") for k in range(planets)
    )
    assert lost == pytest.approx(given - taken, rel=1e-8)


TEETH = {"teeth": (20, 40), "module": 0.003}


@pytest.mark.quick
@pytest.mark.parametrize(
    ("where", "more", "says"),
    [
        (
            "ab",
            {"radii": (0.05, 0.06)},
            "centres are 0.1 m apart; expected 0.11 m by the radii, or",
        ),
        ("ab", TEETH, "centres are 0.1 m apart; expected 0.09 m"),
        ("ab", TEETH | {"teeth": (20.5, 40)}, "teeth must be whole, and 1 or more, got 20.5"),
        ("ab", TEETH | {"teeth": (0, 40)}, "teeth must be whole, and 1 or more, got 0"),
        ("ab", TEETH | {"module": 0.0}, "module must be positive"),
        ("ab", {"radii": (-0.1, 0.2)}, "radii must be positive, got -0.1 m"),
        ("ab", {"module": 0.003}, "expected module= and teeth=, or radii="),
        ("ab", {"radii": (0.05, 0.05), "module": 0.003}, "expected module= and teeth=, or radii="),
        ("ab", {"radii": 0.05}, "expected 2 radii, got 1"),
        ("ac", {"radii": (0.05, 0.05)}, "'a' turns on 'ground'; 'c' turns on 'b'"),
        ("ab", {"radii": (0.05, 0.05), "carrier": "c"}, "on 'c'"),
        ("ab", {"pressure_angle": "50 deg"}, "pressure_angle must be from 0 to 45 deg, got 50 deg"),
        ("ab", {"helix_angle": "20 deg"}, "gears in a plane have no helix"),
        ("ab", {"hand": "both"}, "hand must be 'right' or 'left'"),
        ("ab", {"mu": 0.1}, "expected mu= for crossed axes, efficiency= for others"),
        ("ab", {"efficiency": 1.1}, "efficiency must not be above 1, got 1.1"),
        ("ab", {"efficiency": 0.0}, "efficiency must be above 0, got 0"),
        ("ring", {"efficiency": 0.4}, "efficiency is too low for a gear in this ring, got 0.4"),
    ],
)
def test_bad_gears_are_refused_by_name(where, more, says):
    m = Mechanism("bad")
    a, b, c = (wheel(m, name, radius=0.05, mass=1.0) for name in "abc")
    pins_of(
        m, A=(m.ground, a), B=(m.ground.at(0.05 if where == "ring" else 0.1, 0), b), C=(b.tip, c)
    )
    radii = (0.05, 0.1) if where == "ring" else (0.05, 0.05)
    told = more if {"radii", "teeth", "module"} & set(more) else more | {"radii": radii}
    told = told | ({"carrier": c} if "carrier" in more else {})
    with pytest.raises(DeclarationError, match=r"^gears 'mesh': [^\n]*" + re.escape(says)):
        gears(m, "mesh", a, c if where == "ac" else b, **told)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"z": 40.5}, "'mesh'.* teeth must be whole, and 1 or more, got 40.5"),
        ({"r": 0.07}, "'mesh'.*its centres are 0.09 m apart"),
        ({"share": 1.2}, "'mesh': efficiency"),
        ({"share": 0.0}, "'mesh': efficiency"),
    ],
)
def test_values_that_do_not_fit_are_refused(values, says):
    m = Mechanism("swept")
    z, r, share = m.parameter("z", 40.0), m.parameter("r", 0.06, "m"), m.parameter("share", 0.9)
    first, second = wheel(m, "first", radius=0.03, mass=1.0), wheel(m, "second", radius=r, mass=1.0)
    pins_of(m, A=(m.ground, first), B=(m.ground.at(0.09, 0), second))
    gears(m, "mesh", first, second, teeth=(20, z), radii=(0.03, r), efficiency=share)
    scene = Scene(m, {"A": polynomial(0, 1)}, t=(0, 1, 2))
    assert evaluate(scene).certified
    with pytest.raises(ParameterError, match=says):
        evaluate(scene, parameters=values)


def test_a_gear_in_a_ring_that_loses_too_much_jams():
    m = Mechanism("pair")
    m.set_gravity(0, 0)
    first, second = links_of(m, first=(0.03, 0.1), second=(0.3, 0.1))
    pins_of(m, A=(m.ground, first), B=(m.ground.at(-0.02, 0), second))
    m.torque("load", second, -40.0)
    gears(m, "mesh", first, second, radii=(0.05, 0.03), efficiency=0.75)
    with pytest.raises(AssemblyError, match="friction 'mesh:loss': the mechanism jams"):
        evaluate(Scene(m, {"A": polynomial(0.1, 7.0)}, t=(0, 1, 5)))


@pytest.mark.quick
@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"teeth": (24, 18, 61)}, "its ring has 61 teeth; expected 60"),
        ({"teeth": (24, 18.5, 61)}, "teeth: expected a list, each a whole number"),
        ({"planets": 5}, "5 planets cannot be evenly spaced; expected a number that divides 84"),
        ({"planets": 7}, "7 planets of 18 teeth do not fit"),
        ({"module": -0.002}, "module must be positive, got -0.002 m"),
        ({"of": SpatialMechanism}, "only a mechanism in a plane has it"),
    ],
)
def test_planets_that_do_not_fit_are_refused_by_name(more, says):
    m = more.get("of", Mechanism)("set")
    sun, carrier = (wheel(m, name, radius=0.05, mass=1.0) for name in ("sun", "carrier"))
    pins_of(m, A=(m.ground, sun), B=(m.ground, carrier))
    told = {"teeth": (24, 18, 60), "module": 0.002, "mass": 0.1} | more
    with pytest.raises(DeclarationError, match=says):
        planetary(m, "set", sun, carrier, m.ground, **{k: v for k, v in told.items() if k != "of"})
