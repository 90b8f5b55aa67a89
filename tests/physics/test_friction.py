"""Friction that follows reactions: against closed forms, and over cycles; random mechanisms that
rub are held against Newton-Euler in tests of their own.
"""

import math

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def sled(slope, mu, speed):
    m = Mechanism("sled")
    way = m.prismatic(
        "way", m.ground, m.point_mass("sled", 3.0), axis=(math.cos(slope), math.sin(slope))
    )
    m.friction("rub", way, mu=mu)
    return evaluate(Scene(m, {"way": polynomial(0.0, speed)}, t=(0, 1, 3)))


@pytest.mark.parametrize("slope", [0.0, 0.1, 0.6])
@pytest.mark.parametrize("mu", [0.0, 0.2, 0.9])
def test_a_sled_on_a_slope(slope, mu):
    """Up: m g (sin + mu cos).

    Down: m g (sin - mu cos), which is a push where the slope holds it by itself (mu > tan).
    """
    for speed in (0.5, -0.5):
        solution = sled(slope, mu, speed)
        weight = 3.0 * 9.81 * (math.sin(slope) + math.copysign(mu, speed) * math.cos(slope))
        assert solution.effort("way") == pytest.approx(weight, abs=1e-13)
        assert solution.series["friction:rub:loss"] == pytest.approx(
            0.5 * mu * 3.0 * 9.81 * math.cos(slope), abs=1e-13
        )
        assert solution.certified


def test_the_friction_circle_of_a_journal_bearing():
    """A light arm with a weight: the reaction passes beside the journal's middle, touching a circle
    of radius mu r.
    """
    m = Mechanism("hoist")
    arm = m.link("arm", length=0.5, mass=0.0)
    O = m.revolute("O", m.ground, arm)
    m.weld("hook", arm.tip, m.point_mass("weight", 20.0))
    m.friction("rub", O, mu=0.12, radius=0.03)
    solution = evaluate(Scene(m, {"O": polynomial(0.0, 0.01)}, t=(0, 1, 5)))
    reaction, angle = solution.reaction("O"), solution.motion("O").value
    load = np.hypot(reaction.fx, reaction.fy)
    # The weight's arm about the point where a plumb line touches the circle on the far side.
    weight = 20.0 * 9.81
    assert load == pytest.approx(weight, rel=1e-4)
    assert solution.effort("O") == pytest.approx(
        weight * 0.5 * np.cos(angle) + 0.12 * 0.03 * load, rel=1e-12
    )


def slider_crank():
    """Pins and a guide that rub, of parameters; one friction is smoothed about rest."""
    m = Mechanism("slider_crank")
    mu_A, r_O = m.parameter("mu_A", 0.25), m.parameter("r_O", 0.02, "m")
    crank, rod = m.link("crank", length=0.1, mass=0.7), m.link("rod", length=0.45, mass=1.3)
    block = m.link("block", length=0.05, mass=0.8, centre=(0.01, 0.02), inertia=0.001)
    O = m.revolute("O", m.ground, crank)
    A, B = m.revolute("A", crank.tip, rod), m.revolute("B", rod.tip, block)
    G = m.prismatic("G", m.ground, block, axis=(1, 0))
    m.force("gas", block.at(0.0, 0.01), x=200.0)
    m.friction("rub_O", O, mu=0.25, radius=r_O)
    m.friction("rub_A", A, mu=mu_A, radius=0.02)
    m.friction("rub_B", B, mu=0.25, radius=0.02, smooth=10.0)
    m.friction("rub_G", G, mu=0.25, length=0.12, static=0.25, stribeck=1.0)
    turn = (0.0, 2 * math.pi / 25.0, 721)
    return Scene(m, {"O": polynomial(0.0, 25.0)}, t=turn, posture={"rod": 0.0})


def test_over_a_turn_the_drive_gives_what_friction_takes():
    """A slider-crank at an even speed, with a constant push: over a whole turn nothing else takes
    or gives work.

    The powers jump where the slide turns back, their sum with the change of energy does not: by
    trapezia it is exact to rounding.
    """
    solution = evaluate(slider_crank())
    assert solution.certified
    work = {"drive": solution.effort("O") * solution.motion("O").rate}
    work["push"] = 200.0 * solution.motion("G").rate
    losses = [values for name, values in solution.series.items() if name.endswith(":loss")]
    assert len(losses) == 4
    assert all((values >= 0.0).all() for values in losses)
    work["friction"] = -np.sum(losses, axis=0)
    turn = {name: np.sum(values[:-1]) * solution.t[1] for name, values in work.items()}
    assert turn["friction"] < -0.1
    assert sum(turn.values()) == pytest.approx(0.0, abs=1e-10 * abs(turn["friction"]))


def test_what_no_friction_moves_costs_what_it_did():
    """Frictions that nothing wanted depends on are not solved, and none is
    where none is declared.
    """
    scene = slider_crank()
    assert derive(scene, ["motion", "load:gas"]).checks("rest") == {}
    assert len(derive(scene, ["effort"]).checks("rest")) == 3  # the smoothed one is never at rest
    program = derive(scene, ["load:rub_O"])
    assert {str(output) for output in program.outputs} >= {
        "load:rub_O:mz",
        "friction:rub_O:along",
        "friction:rub_O:loss",
    }


def declared(**told):
    m = Mechanism("wrong")
    link = m.link("link", length=0.2, mass=1.0)
    sled, ball = m.link("sled", length=0.1, mass=1.0), m.point_mass("ball", 1.0)
    joints = {
        "pin": m.revolute("pin", m.ground, link),
        "guide": m.prismatic("guide", link, sled, axis=(1, 0)),
        "ball_pin": m.revolute("ball_pin", link.tip, ball),
        "slot": m.slot("slot", m.ground, sled.tip),
        "weld": m.weld("weld", sled, m.point_mass("lump", 1.0)),
    }
    return m.friction("rub", joints[told.pop("joint")], **told)


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"joint": "pin", "mu": 0.1}, "joint 'pin' turns; expected radius"),
        (
            {"joint": "pin", "mu": 0.1, "radius": 0.01, "length": 0.1},
            "turns and has no guide length; expected radius=",
        ),
        ({"joint": "pin", "mu": -0.1, "radius": 0.01}, "mu must be at least 0, got -0.1"),
        ({"joint": "pin", "mu": 0.1, "radius": 0.0}, "radius must be positive, got 0"),
        ({"joint": "pin"}, "expected mu=, a friction coefficient, or viscous="),
        ({"joint": "pin", "viscous": 0.1, "radius": 0.1}, "radius needs mu="),
        ({"joint": "pin", "mu": 0.1, "radius": 0.01, "static": 0.2}, "static needs stribeck"),
        ({"joint": "pin", "mu": 0.1, "radius": 0.01, "stribeck": 0.2}, "stribeck needs static="),
        ({"joint": "guide", "mu": 0.1}, "transmits a moment; expected length="),
        (
            {"joint": "guide", "mu": 0.1, "radius": 0.1, "length": 0.1},
            "slides and has no radius; expected length=",
        ),
        ({"joint": "slot", "mu": 0.1, "length": 0.1}, "transmits no moment; leave length= out"),
        (
            {"joint": "ball_pin", "mu": 0.1, "radius": 0.01},
            "has no angle: 'ball' is a point mass",
        ),
        (
            {"joint": "weld", "mu": 0.1},
            (
                "joint 'weld' is weld; in a plane friction is possible in these joints: revolute,"
                " prismatic, slot"
            ),
        ),
    ],
)
def test_mistakes_are_told(told, words):
    with pytest.raises(
        DeclarationError, match=f"friction 'rub': .*{words}|friction 'rub': {words}"
    ):
        declared(**told)


def test_its_name_is_one_of_a_load():
    m = Mechanism("twice")
    joint = m.revolute("pin", m.ground, m.link("link", length=0.2, mass=1.0))
    m.friction("rub", joint, viscous=0.1)
    with pytest.raises(DeclarationError, match="load 'rub' is declared twice"):
        m.friction("rub", joint, viscous=0.1)


def test_numbers_that_parameters_make_impossible_are_told():
    for name, value, words in (
        ("r_O", 0.0, "radius must be positive, got 0"),
        ("mu_A", -0.1, "mu must be at least 0, got -0.1"),
    ):
        with pytest.raises(ParameterError, match=f"friction 'rub_{name[-1]}': {words}"):
            evaluate(slider_crank(), parameters={name: value})
