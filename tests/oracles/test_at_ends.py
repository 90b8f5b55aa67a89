"""What moves along a link and stays at its tip, or at its base, misses that by rounding: sections
must not see it by chance.
"""

import numpy as np
import pytest
from mechanisms import links_of, pins_of

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

LENGTH = 0.37
PIVOT = (0.3, 0.05)
SHIFT = {"vm": 1e-12, "c": 1e-12, "lanes": 1e-12, "single": 2e-5}


def rail(end):
    """A crank moves a pin in the slot of a rail; an arm beside the rail holds the pin at the rail's
    tip, or at its base.
    """
    m = Mechanism("rail")
    l = m.parameter("l", LENGTH, "m")
    crank, coupler, arm, bar = links_of(
        m, crank=(0.1, 0.3), coupler=(0.35, 0.5), arm=(l, 0.0), bar=(l, 0.7)
    )
    pins_of(
        m,
        O=(m.ground, crank),
        A=(crank.tip, coupler),
        C=(m.ground.at(*PIVOT), arm),
        B=(arm.tip, coupler.tip),
        R=(m.ground.at(*PIVOT), bar if end == "tip" else bar.tip),
    )
    m.slot("S", bar, coupler.tip, axis=(1, 0))
    at = 1.0 if end == "tip" else 0.0
    m.output("felt", m.results.section(bar, at).shear, unit="N")
    lean = 1.5 if end == "tip" else 1.5 - np.pi
    return Scene(
        m,
        {"O": polynomial(0.3, 5.0)},
        t=(0, 1.2, 13),
        posture={"arm": 1.5, "bar": lean},
        xi=(0, 1, 5),
    ), at


@pytest.mark.sampled(5)
@pytest.mark.parametrize("end", ["tip", "base"])
@pytest.mark.parametrize("way", SHIFT)
def test_sections_see_it_at_the_tip_and_never_at_the_base(way, end):
    """The section at either end bears what the pin does to the bar: nothing else is between."""
    scene, at = rail(end)
    method = {"precision": "single"} if way == "single" else {"backend": way}
    solution = evaluate(scene, **method)
    off = solution.series["section:bar:S:station"] - at
    assert 0.0 < np.abs(off).max() < (1e-6 if way == "single" else 1e-14)
    assert solution.certified
    angle, slot = solution.pose("bar").angle, solution.reaction("S")
    pushed = -(slot.fy * np.cos(angle) - slot.fx * np.sin(angle))  # on the bar, along its n
    borne = pushed if end == "tip" else -pushed
    within = SHIFT[way] * np.abs(pushed).max()
    column = -1 if end == "tip" else 0
    law = solution.section("bar").law
    for side in ("tip", "base"):
        assert np.abs(law.at("shear", np.full((13, 1), at), side)[:, 0] - borne).max() < within
    assert np.abs(solution.section("bar").shear[:, column] - borne).max() < within
    assert np.abs(solution.section("bar").bending[:, column]).max() < within
    assert np.abs(solution.output("felt") - borne).max() < within
