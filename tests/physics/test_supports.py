"""Shafts in two bearings and rods in two bushes, against statics by hand."""

import math

import numpy as np
import pytest

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    bearings,
    evaluate,
    load,
    save,
)
from lagrange_casadi.elements import two_bearings, two_bushes
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

G = 9.81


def near(found, told, size):
    """Compare with a number by hand, beside the largest force."""
    assert np.abs(found - told).max() < 1e-11 * size


@pytest.mark.parametrize("values", [{}, {"b": 0.31, "L": 0.55}])
def test_a_shaft_with_a_pulley_out_of_balance(values):
    """A pulley of 3 kg, its centre e off the axis, speeds up beyond the floating bearing; a belt
    pulls, and a thrust acts. Moments about the fixed bearing give the load of the floating one.
    """
    m = SpatialMechanism("shaft")
    b, length = m.parameter("b", 0.3, "m", low=0.1), m.parameter("L", 0.4, "m", low=0.2)
    beam = beams.Beam(beams.round_bar(0.03), beams.material("C45+QT"))
    shaft = m.link("shaft", length=length, beam=beam)
    e, mass = 0.004, 3.0
    pulley = m.link("pulley", length=0.05, mass=mass, centre=(0, e, 0), inertia=(6e-3, 3e-3, 3e-3))
    m.weld("key", shaft.tip, pulley)
    m.force("belt", pulley, y=500.0)
    m.force("thrust", pulley, x=-80.0)
    pair = two_bearings(m, "main", m.ground, shaft.at(0.05), shaft.at(b))
    assert pair.coordinate == "main_fixed:turn_1"
    speeding = {pair.coordinate: polynomial(0.3, 100.0, 400.0)}
    parts = bearings.Rolling(2e4, hours=1e3), bearings.Rolling(3e4, hours=1e3)
    for joint, part in zip((pair.fixed, pair.floating), parts, strict=True):
        bearings.fit(m, joint, part)
    solution = evaluate(Scene(m, speeding, t=(0, 0.1, 41)), parameters=values)
    assert solution.certified
    assert not solution.undetermined
    at, far = values.get("b", 0.3), values.get("L", 0.4)
    t, density = solution.t, 7850.0 * math.pi / 4 * 0.03**2
    angle, rate, gain = 0.3 + 100 * t + 400 * t**2, 100.0 + 800.0 * t, 800.0
    # What acts on shaft and pulley but for the bearings, less what accelerates them.
    out_y = 500.0 - mass * e * (-(rate**2) * np.cos(angle) - gain * np.sin(angle))
    out_z = -mass * G - mass * e * (-(rate**2) * np.sin(angle) + gain * np.cos(angle))
    weight = -density * far * G
    d = at - 0.05
    second = (
        -out_y * (far - 0.05) / d,
        -(out_z * (far - 0.05) + weight * (far / 2 - 0.05)) / d,
    )
    first = (-out_y - second[0], -out_z - weight - second[1])
    size = max(np.abs(x).max() for x in (*first, *second))
    for name, (y, z) in {"main_fixed": first, "main_floating": second}.items():
        near(solution.reaction(name).fy, y, size)
        near(solution.reaction(name).fz, z, size)
    near(solution.reaction("main_fixed").fx, 80.0, size)
    near(solution.reaction("main_floating").fx, 0.0, size)
    # Between the bearings the shaft bends as a beam on two supports does.
    found = solution.section("shaft")
    beyond = far - at
    bent_y = out_y * beyond
    bent_z = out_z * beyond - density * G * beyond**2 / 2
    told = np.hypot(bent_y, bent_z).max()
    assert found.bending.max() <= told * (1 + 1e-12)
    assert solution.peak("section:shaft:bending").value == pytest.approx(told, rel=1e-9)
    # The floating bearing turns as the fixed one does.
    weights = np.r_[0.5, np.ones(39), 0.5] * rate
    cubic = (np.hypot(*second) ** 3 @ weights / weights.sum()) ** (1 / 3)
    mean = float(weights.sum() / 40) * 60 / math.tau
    hours = bearings.rated_hours(3e4, cubic, mean)
    assert solution.safety("main_floating").against("life of bearing") == pytest.approx(
        (hours / 1e3) ** (1 / 3), rel=1e-9
    )


def test_a_shaft_seen_from_the_side_on_an_arm_that_swings():
    """In the axes of the arm, whose rotation the shaft shares: force and moment of its weight and
    inertia about the fixed bearing.
    """
    m = Mechanism("side")
    arm = m.link("arm", length=0.6, mass=2.0)
    m.revolute("O", m.ground, arm)
    shaft = m.link("shaft", length=0.4, mass=1.5)
    pair = two_bearings(m, "main", arm.at(0.5, 0.1), shaft.at(0.1), shaft.at(0.3), axis=(-1, 0))
    m.force("pull", shaft.tip, x=30.0, y=-50.0)
    solution = evaluate(Scene(m, {"O": harmonic(0.2, 0.8, 6.0)}, t=(0, 1, 41)))
    assert solution.certified
    motion = solution.motion("O")
    x, y = np.cos(motion.value), np.sin(motion.value)
    along, across = np.array([x, y]), np.array([-y, x])
    # The centre of the shaft is 0.1 beyond the fixed bearing, towards the arm's base.
    centre, tip, fixed, floating = (here * along + 0.1 * across for here in (0.4, 0.2, 0.5, 0.3))

    def cross(a, b):
        return a[0] * b[1] - a[1] * b[0]

    def change(r):
        return motion.acceleration * np.array([-r[1], r[0]]) - motion.rate**2 * r

    load = np.array([0.0 * x, -1.5 * G + 0.0 * x]) - 1.5 * change(centre)
    pull = np.array([30.0 + 0.0 * x, -50.0 + 0.0 * x])
    moment = cross(centre - fixed, load) + cross(tip - fixed, pull)
    moment -= 1.5 * 0.4**2 / 12 * motion.acceleration
    second = -moment / cross(floating - fixed, across)
    size = np.abs(second).max()
    near(solution.reaction("main_floating").fx, second * across[0], size)
    near(solution.reaction("main_floating").fy, second * across[1], size)
    first = -load - pull - second * across
    near(solution.reaction("main_fixed").fx, first[0], size)
    near(solution.reaction("main_fixed").fy, first[1], size)
    assert pair.coordinate == ""


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("values", [{}, {"d": 0.25}])
def test_a_rod_in_two_bushes(space, values, tmp_path):
    """A rod of 4 kg slides to and fro in bushes that stand, a force at its tip: its weight and the
    force move along between the bushes, whose loads follow by moments about the first.
    """
    m = (SpatialMechanism if space else Mechanism)("rod")
    if space:
        m.set_gravity(0.0, -G, 0.0)
    d = m.parameter("d", 0.2, "m", low=0.1)
    rod = m.link("rod", length=0.8, mass=4.0)
    first = (0.1, 0.05, 0.0)[: 3 if space else 2]
    bushes = m.ground.at(*first), m.ground.at(first[0] + d, *first[1:])
    pair = two_bushes(m, "guide", rod, *bushes)
    m.force("tool", rod.tip, x=-70.0, y=-120.0)
    bush = bearings.Plain(0.02, 0.03, pressure=5e6, speed=2.0)
    for joint in (pair.first, pair.second):
        bearings.fit(m, joint, bush)
    sliding = {pair.coordinate: harmonic(0.25, 0.1, 9.0)}
    solution = evaluate(Scene(m, sliding, t=(0, 1, 41)), parameters=values)
    assert solution.certified
    assert not solution.undetermined
    place = solution.motion("guide_first").value
    gap, weight = values.get("d", 0.2), 4.0 * G
    second = (weight * (0.4 - place) + 120.0 * (0.8 - place)) / gap
    size = np.abs(second).max()
    # The rod presses on the bushes.
    near(solution.reaction("guide_second").fy, -second, size)
    near(solution.reaction("guide_first").fy, second - weight - 120.0, size)
    assert np.abs(solution.reaction("guide_first").fx).max() < 1e-11 * size
    # The effort acts along the coordinate, which counts from the rod to the bush.
    near(
        solution.effort("guide_first"),
        4.0 * solution.motion("guide_first").acceleration - 70.0,
        size,
    )
    free = 0.8 - place - gap
    told = 120.0 * free + weight / 0.8 * free**2 / 2
    assert abs(solution.peak("section:rod:bending").value) == pytest.approx(told.max(), rel=1e-4)
    for name, push in (("guide_first", second - weight - 120.0), ("guide_second", second)):
        found = solution.safety(name)
        assert found.against("pressure") == pytest.approx(5e6 * 6e-4 / np.abs(push).max(), rel=1e-9)
        assert found.against("speed") == pytest.approx(
            2.0 / np.abs(solution.motion("guide_first").rate).max(), rel=1e-9
        )
    save(solution, tmp_path / "rod.h5")
    again = load(tmp_path / "rod.h5")
    assert again.safety("guide_second") == solution.safety("guide_second")


@pytest.mark.parametrize("turns", [False, True])
def test_a_carriage_on_a_slanting_rail(turns):
    """Bushes that move with a carriage whose centre is beside the rail: the couple of its weight
    across the rail is that of the bushes' loads, and that about it is held, or driven.
    """
    m = SpatialMechanism("carriage")
    carriage = m.link(
        "carriage", length=0.3, mass=5.0, centre=(0.1, 0.06, 0.02), inertia=(0.1,) * 3
    )
    slant = (0.0, 0.8, 0.6)
    pair = two_bushes(
        m, "way", m.ground.at(1, 2, 3), carriage, carriage.at(0.25), axis=slant, turns=turns
    )
    motion = {pair.coordinate: harmonic(0.5, 0.2, 4.0)}
    if turns:
        assert pair.coordinate == "way_first:slide"
        motion["way_first:turn"] = polynomial(0.0)
    solution = evaluate(Scene(m, motion, t=(0, 1, 21)))
    assert solution.certified
    u = np.array(slant)
    axes = np.array([[solution.series[f"pose:carriage:{a}{c}"] for c in "xyz"] for a in "xyz"])
    near(axes[0], u[:, None], 1.0)
    arm = np.einsum("act,a->ct", axes, [0.1, 0.06, 0.02])
    gain = solution.motion(pair.coordinate).acceleration
    load = 5.0 * (np.array([0.0, 0.0, -G])[:, None] - gain * u[:, None])
    moment = np.cross(arm, load, axis=0)
    across = moment - u[:, None] * (u @ moment)
    # F at 0.25 u has the moment 0.25 u x F, so that F = -(moment x u) / 0.25.
    second = -np.cross(across, u[:, None], axis=0) / 0.25
    first = -(load - u[:, None] * (u @ load)) - second
    size = np.abs(load).max()
    for name, told in (("way_first", first), ("way_second", second)):
        found = solution.reaction(name)
        near(np.array([found.fx, found.fy, found.fz]), told, size)
    near(solution.effort(pair.coordinate), -(u @ load), size)
    if turns:
        near(solution.effort("way_first:turn"), -(u @ moment), size)
    else:
        near(solution.series["reaction:way_first:mu"], -(u @ moment), size)


def test_what_cannot_be():
    m = Mechanism("odd")
    rod, other = m.link("rod", length=0.5, mass=1.0), m.link("other", length=0.5, mass=1.0)
    with pytest.raises(
        DeclarationError, match=r"bearings 'a': expected two places along the shaft"
    ):
        two_bearings(m, "a", m.ground, rod.at(0.1), rod.at(0.1))
    with pytest.raises(DeclarationError, match=r"bearings 'a': .* on two bodies; expected apart="):
        two_bearings(m, "a", m.ground, rod.at(0.1), other)
    for apart in (-1, 0.0, m.parameter("span", -1.0, "m")):
        with pytest.raises(DeclarationError, match=r"bearings 'a': apart must be positive, got"):
            two_bearings(m, "a", m.ground, rod.at(0.1), other, apart=apart)
    with pytest.raises(DeclarationError, match=r"bushes 'a': expected two places of one body"):
        two_bushes(m, "a", rod, m.ground, other.tip)
    with pytest.raises(DeclarationError, match=r"bushes 'a': both are at one place of 'ground'"):
        two_bushes(m, "a", rod, m.ground, m.ground)
    side = two_bearings(m, "c", m.ground, other, other.at(0.1))
    with pytest.raises(DeclarationError, match="its shaft lies in the plane"):
        bearings.fit(m, side.floating, bearings.Rolling(1e3, hours=1.0))
    with pytest.raises(DeclarationError, match="a rod in a plane cannot turn"):
        two_bushes(m, "a", rod, m.ground, m.ground.at(1, 0), turns=True)
    pair = two_bushes(m, "b", rod, m.ground, m.ground.at(1, 0))
    with pytest.raises(DeclarationError, match="got a prismatic one; it takes a plain bearing"):
        bearings.fit(m, pair.first, bearings.Rolling(1e3, hours=1.0))
