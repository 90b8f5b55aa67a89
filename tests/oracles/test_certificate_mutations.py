"""A result of the plane with a wrong sign, or a wrong size, fails its certificate: whatever holds,
loads, couples or rubs.
"""

import math
import pickle

import numpy as np
import pytest
from declarations import declaration
from every_load import every_joint_and_load
from internals import certify
from random_mechanisms import draw

from lagrange_casadi import Mechanism, Scene, compile_scene, evaluate, motion
from lagrange_casadi.elements import gears

pytestmark = pytest.mark.usefixtures("interpreted")

FORCES = ("effort", "reaction", "load", "friction", "pose")
GROUPS = (*FORCES, "multiplier", "motion")
FACTORS = (-1.0, 1.0 + 1e-4)


def coupled():
    """Wheels whose teeth rub, a constraint on a place, a direction and a coordinate, and a row in
    place of an effort.
    """
    m = Mechanism("coupled")
    first, second = (
        m.link(name, length=0.1, mass=1.0, centre=(0.01, 0.0), inertia=0.02)
        for name in ("first", "second")
    )
    m.revolute("A", m.ground, first)
    m.revolute("B", m.ground.at(0.3, 0.0), second)
    gears(m, "teeth", first, second, teeth=(20, 40), module=0.01, efficiency=0.97)
    m.torque("brake", second, -30.0)
    pole = m.link("pole", length=0.5, mass=0.8)
    cart = m.point_mass("cart", 1.0)
    m.prismatic("P", m.ground.at(0.0, -1.0), cart, axis=(1.0, 0.0))
    m.revolute("Q", cart, pole)
    x, _ = m.place(pole.tip)
    m.constraint("tied", m.direction(pole) - 1.2 - 0.3 * x)
    m.force("wind", pole.at(0.3), x=11.0, y=3.0)
    return Scene(
        m,
        {"A": motion.polynomial(0.2, 6.0), "P": motion.harmonic(0.1, 0.2, 3.0)},
        t=(0.0, 1.0, 13),
        posture={"pole": 1.2},
    )


def missed(scene, groups=GROUPS, **keywords):
    """The names of outputs that may be wrong by a factor, and the certificate does not notice."""
    solution = evaluate(scene, **keywords)
    declared = declaration(
        scene, {name: one["value"] for name, one in solution.description["parameters"].items()}
    )
    assert max(gaps.max() for gaps in certify(solution, declared).values()) < 1e-9
    largest = {}
    for output, values in solution.outputs.items():
        key = output.group, solution.unit(output)
        largest[key] = max(largest.get(key, 0.0), float(np.nanmax(np.abs(values))))
    found, tried = [], 0
    for output, values in solution.outputs.items():
        if output.group not in groups or output.member == "loss" or not solution.determined(output):
            continue
        if not np.nanmax(np.abs(values)) > 0.05 * largest[output.group, solution.unit(output)]:
            continue
        # A motion run backwards needs the same forces, where none depends on rates.
        for factor in (
            FACTORS[1:] if output.group == "motion" and output.member == "rate" else FACTORS
        ):
            tried += 1
            residuals = certify(solution, declared, {output: factor * values})
            if not max(gaps.max() for gaps in residuals.values()) > 1e-9:
                found.append(f"{output} times {factor}")
    assert tried
    return found


@pytest.mark.parametrize("made", [every_joint_and_load, coupled])
def test_every_kind_is_noticed(made):
    assert missed(made()) == []


@pytest.mark.sampled(4)
@pytest.mark.parametrize("seed", [0, 3, 4, 5, 7, 8, 9])
def test_whatever_can_be_declared_is_noticed(seed):
    """Of random mechanisms what is not there whatever moves: motions of what has no mass need no
    force.
    """
    drawn = draw(seed)
    keywords = {"t": (*drawn.grid[:2], 5), "parameters": drawn.keywords.get("parameters")}
    assert missed(drawn.scene(), FORCES, **keywords) == []


@pytest.mark.parametrize("made", [every_joint_and_load, coupled])
def test_the_table_of_the_declaration_travels(made):
    """What is pickled says the same of a solution."""
    scene = made()
    solution, data = evaluate(scene), compile_scene(scene).data
    there = pickle.loads(pickle.dumps(data)).declared([])
    for name, gaps in certify(solution, data.declared([])).items():
        assert np.array_equal(certify(solution, there)[name], gaps)
    assert math.isclose(there.size, sum(body.length or 0.0 for body in there.bodies.values()))
