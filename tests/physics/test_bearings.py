"""Pins and bearings against textbooks, closed forms and the reactions of a mechanism; shafts in
two bearings and rods in two bushes against statics by hand.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    bearing_loads,
    bearings,
    evaluate,
    load,
    prepare,
    save,
)
from lagrange_casadi.elements import two_bearings, two_bushes
from lagrange_casadi.errors import DeclarationError, NoDesignError, UnknownNameError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

STEEL = beams.material("C45+QT")


SPEED = 40.0


def rotor(*parts, scale=1.0):
    """A rotor of 2 kg whose centre is 0.05 m beside its axis, turning evenly: its reaction is m w^2
    r and its weight.
    """
    m = Mechanism("rotor")
    r = m.parameter("r", 0.05 * scale, "m", low=0.0)
    disc = m.link("disc", length=0.2, mass=2.0, centre=(r, 0.0), inertia=0.01)
    bearings.fit(m, m.revolute("O", m.ground, disc), *parts)
    return Scene(m, {"O": polynomial(0.0, SPEED)}, t=(0.0, 2 * math.pi / SPEED, 201))


def reaction(t):
    """Its size, as a vector sum."""
    spun, weight = 2.0 * SPEED**2 * 0.05, 2.0 * 9.81
    return np.hypot(-spun * np.cos(SPEED * t), weight - spun * np.sin(SPEED * t))


def test_loads_one_after_another():
    """By the sum of wear: turns over lives of each load are one over the whole life."""
    loads, turns, c = np.array([2e3, 5e3, 1e3]), np.array([3.0, 1.0, 6.0]), 30e3
    wear = (
        sum(n / (c / load) ** (10 / 3) for n, load in zip(turns, loads, strict=True)) / turns.sum()
    )
    assert (c / bearings.equivalent_load(loads, turns, 10 / 3)) ** (10 / 3) == pytest.approx(
        1 / wear, rel=1e-12
    )


def test_a_pin_bends_as_a_beam_does():
    """The moment in the middle, by sums over small pieces of both loads."""
    eye, cheek, gap, force = 0.03, 0.016, 0.002, 5e3
    half = (np.arange(2000) + 0.5) / 2000
    inner = -np.sum(force / 2 / 2000 * half * eye / 2)
    outer = force / 2 * np.mean(eye / 2 + gap + half * cheek)
    assert bearings.bending_of_pin(force, eye, cheek, gap) == pytest.approx(inner + outer, rel=1e-9)


@pytest.fixture(scope="module")
def solution():
    parts = (
        bearings.Pin(0.012, eye=0.02, cheek=0.01, material=STEEL, pressure=20e6),
        bearings.Plain(0.012, 0.02, pressure=10e6, speed=1.0, heating=2e6),
        bearings.Rolling(5e3, hours=2000.0, static=3e3),
    )
    return evaluate(rotor(*parts), wanted=["safety:O"])


def test_factors_follow_from_the_reaction(solution):
    found, force = solution.safety("O"), reaction(solution.t)
    most = force.max()
    w, area = math.pi * 0.012**3 / 32, math.pi * 0.012**2 / 4
    told = {
        "bending of pin": 490e6 * w / (most * 0.04 / 8),
        "shear of pin": 490e6 / math.sqrt(3) * area * 2 * 3 / 4 / most,
        "pressure in eye": 20e6 * 0.012 * 0.02 / most,
        "pressure in fork": 20e6 * 0.012 * 0.02 / most,
        "pressure": 10e6 * 0.012 * 0.02 / most,
        "speed": 1.0 / (SPEED * 0.006),
        "heating": 2e6 * 0.012 * 0.02 / (force[:-1].mean() * SPEED * 0.006),
        "static load": 3e3 / most,
    }
    cubic = (force[:-1] ** 3).mean() ** (1 / 3)
    hours = (5e3 / cubic) ** 3 * 1e6 / (60 * SPEED * 60 / math.tau)
    told["life of bearing"] = (hours / 2000.0) ** (1 / 3)
    assert {verdict.against: verdict.factor for verdict in found.verdicts} == pytest.approx(
        told, rel=1e-9
    )
    assert found.not_evaluated == ()


def test_in_space_the_force_along_the_pin_is_axial():
    m = SpatialMechanism("rotor")
    disc = m.link("disc", length=0.2, mass=2.0)
    joint = m.revolute("O", m.ground, disc, axis=(0, 0, 1))
    m.force("push", disc.base, z=-100.0)
    bearings.fit(m, joint, bearings.Rolling(5e3, hours=1.0, static=1e3, radial=0.5, axial=1.5))
    solution = evaluate(
        Scene(m, {"O": polynomial(0.0, SPEED)}, t=(0, 0.1, 21)), wanted=["safety:O"]
    )
    radial = 2.0 * SPEED**2 * 0.1
    factor = 1e3 / (0.5 * radial + 1.5 * (100.0 + 2.0 * 9.81))
    assert solution.safety("O").against("static load") == pytest.approx(factor, rel=1e-9)


def test_what_is_open_is_told():
    pin, rolling = bearings.Pin(0.012, 0.02, 0.01, STEEL), bearings.Rolling(5e3, hours=1.0)
    scene = rotor(bearings.Plain(0.012, 0.02, heating=1e6), rolling, pin)
    solution = evaluate(scene, wanted=["reaction:O"])
    assert [told.partition(":")[0] for told in solution.safety("O").not_evaluated] == [
        "plain bearing",
        "rolling bearing",
    ]
    pressed = evaluate(rotor(bearings.Plain(0.012, 0.02, pressure=1e6)), wanted=["reaction:O"])
    assert pressed.safety("O").governs.against == "pressure"
    with pytest.raises(DeclarationError, match="not evaluated; add reaction:O too"):
        evaluate(scene, wanted=["effort"]).safety("O")
    with pytest.raises(DeclarationError, match="'safety:O': prepared scenes have no strength of"):
        prepare(scene, wanted=["safety:O"])


@pytest.fixture(scope="module")
def turning():
    """A rotor that speeds up."""
    m = Mechanism("rotor")
    disc = m.link("disc", length=0.2, mass=2.0, centre=(0.05, 0.0), inertia=0.01)
    m.revolute("O", m.ground, disc)
    return evaluate(Scene(m, {"O": polynomial(0.0, 20.0, 100.0)}, t=(0, 0.5, 401)))


@pytest.mark.quick
def test_the_smallest_bearing_that_lives_long_enough(turning):
    every = bearings.deep_groove()
    best = bearings.select_bearing(turning, "O", every, hours=20e3, bore=0.015)
    force = np.hypot(turning.reaction("O").fx, turning.reaction("O").fy)
    weights = np.r_[0.5, np.ones(399), 0.5]
    turned = weights * turning.motion("O").rate
    cubic = (force**3 @ turned / turned.sum()) ** (1 / 3)
    rpm = float(turned.sum() / 400) * 60 / math.tau
    found = bearing_loads(turning, "O")
    assert (found.radial, found.speed) == pytest.approx((cubic, rpm), rel=1e-9)

    def lives(bearing):
        long = bearings.rated_hours(bearing.dynamic, cubic, rpm) >= 20e3
        return long and bearing.static >= force.max()

    assert {bearings.rated_hours(1e99, load, rpm) for load in (0.0, 1e-99)} == {math.inf}
    assert lives(best)
    assert best.bore >= 0.015
    assert not any(lives(one) for one in every if one.bore >= 0.015 and one.outer < best.outer)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("error", "says", "asked"),
    [
        (
            NoDesignError,
            r"no bearing has a life of 1e\+12 h; the strongest, '6320'",
            {"hours": 1e12},
        ),
        (NoDesignError, "no bearing has a bore of 200 mm or more", {"bore": 0.2}),
        (UnknownNameError, "unknown joint 'main'; valid: O", {"joint": "main"}),
        (
            DeclarationError,
            "select_bearing: bearings: expected at least one",
            {"bearings": []},
        ),
    ],
)
def test_where_no_bearing_serves_it_is_said(turning, error, says, asked):
    told = {"joint": "O", "bearings": bearings.deep_groove(), "hours": 1.0} | asked
    with pytest.raises(error, match=says):
        bearings.select_bearing(turning, **told)


GRAVITY = 9.81


def near(found, told, size):
    """Compare with a number by hand, beside the largest force."""
    assert np.abs(found - told).max() < 1e-11 * size


@pytest.mark.quick
@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("values", [{}, {"d": 0.25}])
def test_a_rod_in_two_bushes(space, values, tmp_path):
    """A rod of 4 kg slides to and fro in bushes that stand, a force at its tip: its weight and the
    force move along between the bushes, whose loads follow by moments about the first.
    """
    m = (SpatialMechanism if space else Mechanism)("rod")
    if space:
        m.set_gravity(0.0, -GRAVITY, 0.0)
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
    weight = 4.0 * GRAVITY
    second = (weight * (0.4 - place) + 120.0 * (0.8 - place)) / values.get("d", 0.2)
    size = np.abs(second).max()
    # The rod presses on the bushes.
    near(solution.reaction("guide_second").fy, -second, size)
    near(solution.reaction("guide_first").fy, second - weight - 120.0, size)
    found = solution.safety("guide_second")
    assert found.against("pressure") == pytest.approx(5e6 * 6e-4 / size, rel=1e-9)
    assert found.against("speed") == pytest.approx(
        2.0 / np.abs(solution.motion("guide_first").rate).max(), rel=1e-9
    )
    save(solution, tmp_path / "rod.h5")
    again = load(tmp_path / "rod.h5")
    assert again.safety("guide_second") == solution.safety("guide_second")


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (
            lambda m, rod, other: two_bearings(m, "a", m.ground, rod.at(0.1), rod.at(0.1)),
            "bearings 'a': expected two places along the shaft",
        ),
        (
            lambda m, rod, other: two_bearings(m, "a", m.ground, rod.at(0.1), other),
            "bearings 'a': .* on two bodies; expected apart=",
        ),
        (
            lambda m, rod, other: two_bearings(m, "a", m.ground, rod.at(0.1), other, apart=-1),
            "bearings 'a': apart must be positive, got",
        ),
        (
            lambda m, rod, other: two_bushes(m, "a", rod, m.ground, other.tip),
            "bushes 'a': expected two places of one body",
        ),
        (
            lambda m, rod, other: two_bushes(m, "a", rod, m.ground, m.ground),
            "bushes 'a': both are at one place of 'ground'",
        ),
        (
            lambda m, rod, other: two_bushes(m, "a", rod, m.ground, m.ground.at(1, 0), turns=True),
            "a rod in a plane cannot turn",
        ),
        (
            lambda m, rod, other: bearings.fit(
                m,
                two_bearings(m, "c", m.ground, other, other.at(0.1)).floating,
                bearings.Rolling(1e3, hours=1.0),
            ),
            "its shaft lies in the plane",
        ),
        (
            lambda m, rod, other: bearings.fit(
                m,
                two_bushes(m, "b", rod, m.ground, m.ground.at(1, 0)).first,
                bearings.Rolling(1e3, hours=1.0),
            ),
            "got a prismatic one; it takes a plain bearing",
        ),
        (
            lambda m, rod, other: rotor(bearings.Pin(-0.01, 0.02, 0.01, STEEL)),
            "joint 'O': pin: diameter must be positive, got -0.01",
        ),
        (
            lambda m, rod, other: rotor(
                bearings.Pin(0.01, 0.02, 0.01, beams.Material("wood", 500.0))
            ),
            "material 'wood' has no yield_strength",
        ),
        (
            lambda m, rod, other: rotor(bearings.Plain(0.01, 0.02, speed=0.0)),
            "speed must be positive, got 0",
        ),
        (
            lambda m, rod, other: bearings.equivalent_load([1.0, 2.0], [1.0]),
            "equivalent_load: expected two rows of one length, finite and not negative",
        ),
        (
            lambda m, rod, other: rotor(3.0),
            "fit: parts: expected a Pin, a Plain or a Rolling, got 3",
        ),
    ],
)
def test_what_cannot_be(make, says):
    m = Mechanism("odd")
    links = [m.link(name, length=0.5, mass=1.0) for name in ("rod", "other")]
    with pytest.raises(DeclarationError, match=says):
        make(m, *links)
