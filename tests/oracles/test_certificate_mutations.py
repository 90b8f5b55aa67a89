"""A result with a wrong sign, or a wrong size, fails its certificate: whatever holds, loads,
couples or rubs, in the plane and in space.
"""

import numpy as np
import pytest
from declarations import declaration
from every_load import every_joint_and_load
from internals import certify
from random_mechanisms import KINDS, draw
from spatial_solutions import scene_of

from lagrange_casadi import evaluate

pytestmark = pytest.mark.usefixtures("interpreted")

FORCES = ("effort", "reaction", "load", "friction", "pose", "multiplier")
GROUPS = (*FORCES, "motion")
FACTORS = (-1.0, 1.0 + 1e-4)


def missed(scene, groups=GROUPS, **keywords):
    """The names of outputs that may be wrong by one factor or the other, by turns, and the
    certificate does not notice.
    """
    solution = evaluate(scene, **keywords)
    declared = declaration(scene, solution)
    assert max(gaps.max() for gaps in certify(solution, declared).values()) < 1e-9
    largest = {}
    for output, values in solution.outputs.items():
        key = output.group, solution.unit(output)
        largest[key] = max(largest.get(key, 0.0), float(np.nanmax(np.abs(values))))
    found, tried = [], 0
    for output, values in solution.outputs.items():
        if output.group not in groups or output.member == "loss" or not solution.determined(output):
            continue
        size = np.nanmax(np.abs(values))
        # Angles of joints that only slide are zeros with rounding.
        if not size > max(0.05 * largest[output.group, solution.unit(output)], 1e-12):
            continue
        # A motion run backwards needs the same forces, where none depends on rates.
        tried += 1
        factor = FACTORS[tried // 2 % 2 if output.member != "rate" else 1]
        residuals = certify(solution, declared, {output: factor * values})
        if not max(gaps.max() for gaps in residuals.values()) > 1e-9:
            found.append(f"{output} times {factor}")
    assert tried
    return found


def test_every_kind_is_noticed():
    assert missed(every_joint_and_load()) == []


@pytest.mark.sampled(4)
@pytest.mark.parametrize("kind", KINDS)
def test_whatever_can_be_declared_is_noticed(kind):
    """Of random mechanisms what is not there whatever moves: motions of what has no mass need no
    force.
    """
    drawn = draw(4, kind)
    start, stop, _ = drawn.grid
    grid = (start, stop, 5 if start < stop else 1)
    keywords = {"t": grid, "parameters": drawn.keywords.get("parameters")}
    assert missed(drawn.scene(), FORCES, **keywords) == []


DRAWN = [("rsur", 0), ("loop", 0), ("anyhow", 1), ("anyhow", 2)]


@pytest.mark.parametrize(("name", "seed"), DRAWN)
def test_whatever_is_in_space_is_noticed(name, seed):
    """Loops closed by balls and joints of two axes; and bodies on any joints, with springs,
    equations, and loads along links.
    """
    _, scene = scene_of(name, seed)
    assert missed(scene, (*GROUPS, "law"), t=(*scene.t[:2], 3)) == []
