"""Friction that follows reactions: against Newton-Euler with its law iterated, against closed forms, and over cycles."""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracle import Body, Joint, Oracle, from_density
from rubbing import Rub, solve_rubbing

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

RATIOS = (0.25, 0.75, 2)


def drawn(low, high):
    return st.floats(low, high)


def uniform(mass):
    return lambda _: mass


class Twin:
    """A mechanism with parameters for all its numbers, told to the package once and to the oracle for each draw."""

    def __init__(self, name, ranges):
        self.m, self.ranges = Mechanism(name), dict(ranges)
        self.p = {key: self.m.parameter(key, (low + high) / 2) for key, (low, high) in self.ranges.items()}

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
        more = {"viscous": p["viscous"]} if k == "B" else {"static": p["static"], "stribeck": p["stribeck"]} if k == "C" else {}
        m.friction(f"rub_{k}", joint, mu=p[f"mu_{k}"], radius=p[f"r_{k}"], **more)
    law = polynomial(p["angle"], p["speed"], p["spin"] / 2)
    return twin, Scene(m, {"O": law}, t=(0, 0.01, 3), xi=RATIOS, posture={"bar": 0.6, "arm": 1.6})


BARS = (("crank", "a", 0.7), ("bar", "b", 1.3), ("arm", "c", 0.9))
FOUR_BAR, FOUR_BAR_SCENE = four_bar()


def drives(p, t):
    return (p["angle"] + p["speed"] * t + p["spin"] / 2 * t * t, p["speed"] + p["spin"] * t, p["spin"])


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
        assert solution.series[f"friction:rub_{rub.joint.name}"][i] == pytest.approx(rub.force, abs=1e-10 * size)
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
    rubs = [Rub(joint, p[f"mu_{joint.name}"], p[f"r_{joint.name}"], **more.get(joint.name, {})) for joint in joints]
    for i in (0, 2):
        guess = {name: (solution.pose(name).x[i], solution.pose(name).y[i], solution.pose(name).angle[i]) for name, *_ in BARS}
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
    more = {"B": {"smooth": p["smooth"]}, "G": {"static": p["static"], "stribeck": p["stribeck"], "length": p["length"]}}
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
    bodies = [from_density("crank", p["r"], uniform(0.7)), from_density("rod", p["l"], uniform(1.3))]
    bodies.append(Body("block", 0.8, 0.05, (0.01, 0.02), 0.001))
    joints = [
        Joint("O", "revolute", ("ground", 0.0, 0.0), ("crank", 0.0, 0.0)),
        Joint("A", "revolute", ("crank", p["r"], 0.0), ("rod", 0.0, 0.0)),
        Joint("B", "revolute", ("rod", p["l"], 0.0), ("block", 0.0, 0.0)),
        Joint("G", "prismatic", ("ground", 0.0, p["offset"]), ("block", 0.0, 0.0)),
    ]
    oracle = Oracle(bodies, joints, loads=[lambda _: [(("block", 0.0, p["beside"]), p["gas"], 0.0, 0.0)]])
    more = {"B": {"smooth": p["smooth"]}, "G": {"static": p["static"], "stribeck": p["stribeck"], "length": p["length"]}}
    rubs = [Rub(j, p[f"mu_{j.name}"], p.get(f"r_{j.name}"), **more.get(j.name, {})) for j in joints]
    for i in (0, 2):
        names = ("crank", "rod", "block")
        guess = {name: (solution.pose(name).x[i], solution.pose(name).y[i], solution.pose(name).angle[i]) for name in names}
        result = solve_rubbing(oracle, rubs, {"O": drives(p, solution.t[i])}, guess)
        assume(min(abs(rub.rate(oracle.places(result))) for rub in rubs) > 1e-6)
        compare(result, solution, i, rubs, ("crank", "rod"))
