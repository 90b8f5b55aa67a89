"""Friction that follows reactions: against Newton-Euler with its law iterated, against closed
forms, and over cycles.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracle import Body, Joint, Oracle, from_density
from rubbing import Rub, solve_rubbing

from lagrange_casadi import Mechanism, Scene, derive, evaluate
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

RATIOS = (0.25, 0.75, 2)


def drawn(low, high):
    return st.floats(low, high)


def uniform(mass):
    return lambda _: mass


class Twin:
    """A mechanism with parameters for all its numbers, told to the package once and to the oracle
    for each draw.
    """

    def __init__(self, name, ranges):
        self.m, self.ranges = Mechanism(name), dict(ranges)
        self.p = {
            key: self.m.parameter(key, (low + high) / 2) for key, (low, high) in self.ranges.items()
        }

    def values(self):
        return st.fixed_dictionaries({key: drawn(*bounds) for key, bounds in self.ranges.items()})


def four_bar():
    ranges = {
        "a": (0.05, 0.12),
        "ground": (0.4, 0.5),
        "b": (0.4, 0.5),
        "c": (0.25, 0.35),
        "angle": (-3.0, 3.0),
        "speed": (-30.0, 30.0),
        "spin": (-50.0, 50.0),
        "load": (-40.0, 40.0),
        **{f"mu_{k}": (0.0, 0.6) for k in "OABC"},
        **{f"r_{k}": (0.002, 0.04) for k in "OABC"},
        "viscous": (0.0, 0.2),
        "static": (0.0, 0.8),
        "stribeck": (0.1, 1.0),
    }
    twin = Twin("four_bar", ranges)
    m, p = twin.m, twin.p
    crank, bar, arm = (m.link(name, length=p[key], mass=mass) for name, key, mass in BARS)
    joints = {
        "O": m.revolute("O", m.ground, crank),
        "A": m.revolute("A", crank.tip, bar),
        "B": m.revolute("B", bar.tip, arm.tip),
        "C": m.revolute("C", m.ground.at(p["ground"], 0.0), arm),
    }
    m.torque("load", arm, p["load"])
    for k, joint in joints.items():
        more = (
            {"viscous": p["viscous"]}
            if k == "B"
            else {"static": p["static"], "stribeck": p["stribeck"]}
            if k == "C"
            else {}
        )
        m.friction(f"rub_{k}", joint, mu=p[f"mu_{k}"], radius=p[f"r_{k}"], **more)
    law = polynomial(p["angle"], p["speed"], p["spin"] / 2)
    return twin, Scene(m, {"O": law}, t=(0, 0.01, 3), xi=RATIOS, posture={"bar": 0.6, "arm": 1.6})


BARS = (("crank", "a", 0.7), ("bar", "b", 1.3), ("arm", "c", 0.9))
FOUR_BAR, FOUR_BAR_SCENE = four_bar()


def drives(p, t):
    return (
        p["angle"] + p["speed"] * t + p["spin"] / 2 * t * t,
        p["speed"] + p["spin"] * t,
        p["spin"],
    )


def compare(result, solution, i, rubs, links):
    """All forces of the package's instant beside the oracle's."""
    size = max(abs(x) for reaction in result.reactions.values() for x in reaction[:2])
    size = max(size, *(abs(x) for x in result.efforts.values()))
    for joint, effort in result.efforts.items():
        assert solution.effort(joint)[i] == pytest.approx(effort, abs=1e-10 * size)
    for joint, (fx, fy, mz) in result.reactions.items():
        found = solution.reaction(joint)
        assert found.fx[i] == pytest.approx(fx, abs=1e-10 * size)
        assert found.fy[i] == pytest.approx(fy, abs=1e-10 * size)
        assert (0.0 if found.mz is None else found.mz[i]) == pytest.approx(mz, abs=1e-10 * size)
    for rub in rubs:
        assert solution.series[f"friction:rub_{rub.joint.name}:along"][i] == pytest.approx(
            rub.force, abs=1e-10 * size
        )
    for link in links:
        section = solution.section(link)
        for k, ratio in enumerate(RATIOS[:2]):
            told = (section.axial[i, k], section.shear[i, k], section.bending[i, k])
            assert told == pytest.approx(result.sections[link](ratio), abs=1e-10 * size)


@settings(max_examples=15)
@given(FOUR_BAR.values())
def test_a_four_bar_whose_pins_rub(p):
    assume(abs(p["speed"]) > 1.0)
    solution = evaluate(FOUR_BAR_SCENE, parameters=p)
    bodies = [from_density(name, p[key], uniform(mass)) for name, key, mass in BARS]
    joints = [
        Joint("O", "revolute", ("ground", 0.0, 0.0), ("crank", 0.0, 0.0)),
        Joint("A", "revolute", ("crank", p["a"], 0.0), ("bar", 0.0, 0.0)),
        Joint("B", "revolute", ("bar", p["b"], 0.0), ("arm", p["c"], 0.0)),
        Joint("C", "revolute", ("ground", p["ground"], 0.0), ("arm", 0.0, 0.0)),
    ]
    oracle = Oracle(bodies, joints, loads=[lambda _: [(("arm", 0.0, 0.0), 0.0, 0.0, p["load"])]])
    more = {"B": {"viscous": p["viscous"]}, "C": {"static": p["static"], "stribeck": p["stribeck"]}}
    rubs = [
        Rub(joint, p[f"mu_{joint.name}"], p[f"r_{joint.name}"], **more.get(joint.name, {}))
        for joint in joints
    ]
    for i in (0, 2):
        guess = {
            name: (solution.pose(name).x[i], solution.pose(name).y[i], solution.pose(name).angle[i])
            for name, *_ in BARS
        }
        result = solve_rubbing(oracle, rubs, {"O": drives(p, solution.t[i])}, guess)
        place = oracle.places(result)
        assume(min(abs(rub.rate(place)) for rub in rubs) > 1e-6)
        compare(result, solution, i, rubs, [name for name, *_ in BARS])


def slider_crank():
    ranges = {
        "r": (0.05, 0.15),
        "l": (0.35, 0.6),
        "offset": (-0.05, 0.05),
        "angle": (-3.0, 3.0),
        "speed": (-30.0, 30.0),
        "spin": (-50.0, 50.0),
        "gas": (-300.0, 300.0),
        "beside": (-0.03, 0.03),
        **{f"mu_{k}": (0.0, 0.5) for k in "OABG"},
        **{f"r_{k}": (0.002, 0.04) for k in "OAB"},
        "length": (0.05, 0.2),
        "static": (0.0, 0.5),
        "stribeck": (0.1, 2.0),
        "smooth": (0.5, 20.0),
    }
    twin = Twin("slider_crank", ranges)
    m, p = twin.m, twin.p
    crank, rod = m.link("crank", length=p["r"], mass=0.7), m.link("rod", length=p["l"], mass=1.3)
    block = m.link("block", length=0.05, mass=0.8, centre=(0.01, 0.02), inertia=0.001)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, block)
    m.prismatic("G", m.ground.at(0.0, p["offset"]), block, axis=(1, 0))
    m.force("gas", block.at(0.0, p["beside"]), x=p["gas"])
    more = {
        "B": {"smooth": p["smooth"]},
        "G": {"static": p["static"], "stribeck": p["stribeck"], "length": p["length"]},
    }
    for k, joint in m.joints.items():
        radius = {} if k == "G" else {"radius": p[f"r_{k}"]}
        m.friction(f"rub_{k}", joint, mu=p[f"mu_{k}"], **radius, **more.get(k, {}))
    law = polynomial(p["angle"], p["speed"], p["spin"] / 2)
    return twin, Scene(m, {"O": law}, t=(0, 0.01, 3), xi=RATIOS, posture={"rod": 0.0})


SLIDER_CRANK, SLIDER_CRANK_SCENE = slider_crank()


@settings(max_examples=15)
@given(SLIDER_CRANK.values())
def test_a_slider_crank_whose_pins_and_guide_rub(p):
    assume(abs(p["speed"]) > 1.0)
    solution = evaluate(SLIDER_CRANK_SCENE, parameters=p)
    bodies = [
        from_density("crank", p["r"], uniform(0.7)),
        from_density("rod", p["l"], uniform(1.3)),
    ]
    bodies.append(Body("block", 0.8, 0.05, (0.01, 0.02), 0.001))
    joints = [
        Joint("O", "revolute", ("ground", 0.0, 0.0), ("crank", 0.0, 0.0)),
        Joint("A", "revolute", ("crank", p["r"], 0.0), ("rod", 0.0, 0.0)),
        Joint("B", "revolute", ("rod", p["l"], 0.0), ("block", 0.0, 0.0)),
        Joint("G", "prismatic", ("ground", 0.0, p["offset"]), ("block", 0.0, 0.0)),
    ]
    oracle = Oracle(
        bodies, joints, loads=[lambda _: [(("block", 0.0, p["beside"]), p["gas"], 0.0, 0.0)]]
    )
    more = {
        "B": {"smooth": p["smooth"]},
        "G": {"static": p["static"], "stribeck": p["stribeck"], "length": p["length"]},
    }
    rubs = [Rub(j, p[f"mu_{j.name}"], p.get(f"r_{j.name}"), **more.get(j.name, {})) for j in joints]
    for i in (0, 2):
        names = ("crank", "rod", "block")
        guess = {
            name: (solution.pose(name).x[i], solution.pose(name).y[i], solution.pose(name).angle[i])
            for name in names
        }
        result = solve_rubbing(oracle, rubs, {"O": drives(p, solution.t[i])}, guess)
        assume(min(abs(rub.rate(oracle.places(result))) for rub in rubs) > 1e-6)
        compare(result, solution, i, rubs, ("crank", "rod"))


def inverted():
    """A block on a crank's pin that slides along a rocker; the rocker carries the line, so friction
    travels along it.
    """
    ranges = {
        "r": (0.05, 0.12),
        "depth": (0.2, 0.35),
        "angle": (-3.0, 3.0),
        "speed": (-20.0, 20.0),
        "load": (-30.0, 30.0),
        "mu_S": (0.0, 0.3),
        "length": (0.05, 0.1),
        "mu_P": (0.0, 0.4),
        "r_P": (0.005, 0.03),
    }
    twin = Twin("inverted", ranges)
    m, p = twin.m, twin.p
    crank, rocker = m.link("crank", length=p["r"], mass=0.6), m.link("rocker", length=0.7, mass=1.5)
    block = m.link("block", length=0.04, mass=0.3, centre=(0.0, 0.0), inertia=1e-4)
    m.revolute("O", m.ground, crank)
    m.revolute("P", crank.tip, block)
    m.revolute("C", m.ground.at(0.0, -p["depth"]), rocker)
    m.prismatic("S", rocker, block, axis=(1, 0))
    m.torque("load", rocker, p["load"])
    m.friction("rub_S", m.joints["S"], mu=p["mu_S"], length=p["length"])
    m.friction("rub_P", m.joints["P"], mu=p["mu_P"], radius=p["r_P"])
    posture = {"rocker": math.pi / 2, "block": math.pi / 2}
    return twin, Scene(
        m, {"O": polynomial(p["angle"], p["speed"])}, t=(0, 0.01, 3), xi=RATIOS, posture=posture
    )


INVERTED, INVERTED_SCENE = inverted()


@settings(max_examples=10)
@given(INVERTED.values())
def test_friction_travels_along_a_moving_guide(p):
    assume(abs(p["speed"]) > 1.0)
    solution = evaluate(INVERTED_SCENE, parameters=p)
    assert solution.certified
    bodies = [
        from_density("crank", p["r"], uniform(0.6)),
        from_density("rocker", 0.7, uniform(1.5)),
        Body("block", 0.3, 0.04, (0.0, 0.0), 1e-4),
    ]
    joints = [
        Joint("O", "revolute", ("ground", 0.0, 0.0), ("crank", 0.0, 0.0)),
        Joint("P", "revolute", ("crank", p["r"], 0.0), ("block", 0.0, 0.0)),
        Joint("C", "revolute", ("ground", 0.0, -p["depth"]), ("rocker", 0.0, 0.0)),
        Joint("S", "prismatic", ("rocker", 0.0, 0.0), ("block", 0.0, 0.0)),
    ]
    oracle = Oracle(bodies, joints, loads=[lambda _: [(("rocker", 0.0, 0.0), 0.0, 0.0, p["load"])]])
    rubs = [Rub(joints[3], p["mu_S"], length=p["length"]), Rub(joints[1], p["mu_P"], p["r_P"])]
    for i in (0, 2):
        names = ("crank", "rocker", "block")
        guess = {
            name: (solution.pose(name).x[i], solution.pose(name).y[i], solution.pose(name).angle[i])
            for name in names
        }
        result = solve_rubbing(
            oracle, rubs, {"O": (p["angle"] + p["speed"] * solution.t[i], p["speed"], 0.0)}, guess
        )
        assume(min(abs(rub.rate(oracle.places(result))) for rub in rubs) > 1e-6)
        compare(result, solution, i, rubs, ("crank", "rocker"))


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


def test_over_a_turn_the_drive_gives_what_friction_takes():
    """A slider-crank at an even speed, with a constant push: over a whole turn nothing else takes
    or gives work.

    The powers jump where the slide turns back, their sum with the change of energy does not: by
    trapezia it is exact to rounding.
    """
    p = {name: parameter.default for name, parameter in SLIDER_CRANK.m.parameters.items()} | {
        "speed": 25.0,
        "spin": 0.0,
        "gas": 200.0,
    }
    solution = evaluate(SLIDER_CRANK_SCENE, parameters=p, t=(0.0, 2 * math.pi / 25.0, 721))
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
    scene = SLIDER_CRANK_SCENE
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
            evaluate(SLIDER_CRANK_SCENE, parameters={name: value})
