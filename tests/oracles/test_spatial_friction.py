"""Friction in space: random trees and loops whose pins, guides, sleeves and threads rub, and what a
cycle takes.
"""

import math

import numpy as np
import pytest
from spatial_bridge import declared, named
from spatial_friction import CASES, rubbing
from spatial_oracle import SECTION
from spatial_rubbing import solve_rubbing

from lagrange_casadi import Scene, SpatialMechanism, evaluate
from lagrange_casadi.errors import AssemblyError, DeclarationError, MobilityError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

RATIOS = (0.1371, 0.7713, 2)


def compare(case):
    """The largest gap of forces over the largest of them; None where nothing rubs, or what rubs
    jams.
    """
    drawn, t, rubs = rubbing(case)
    if not rubs:
        return None
    scene = declared(drawn, t, rubs=rubs, xi=RATIOS)
    try:
        solution = evaluate(scene, t=(t, t, 1))
    except AssemblyError as error:
        if "jams" not in str(error):
            raise
        return None
    assert solution.certified
    true, frictions = solve_rubbing(drawn, rubs, t)
    force = max(1.0, *(np.abs(r[:3]).max() for r in true.reactions.values()))
    moment = max(force * true.size, *(np.abs(r[3:]).max() for r in true.reactions.values()))
    gaps = [
        abs(solution.series[f"friction:{name}:along"][0] - found) / moment
        for name, found in frictions.items()
    ]
    for name, (value, key) in named(drawn, true).items():
        if key not in true.open and name in solution.series:
            size = force if name.startswith("reaction") and ":f" in name else moment
            gaps.append(abs(solution.series[name][0] - value) / size)
    for rod in (name for name in drawn.rods if not (drawn.idle and name == "coupler")):
        for k, xi in enumerate(RATIOS[:2]):
            shut, own = true.open_section(rod, xi), solution.section(rod)
            for value, member, is_open in zip(
                true.sections[rod].at(xi), SECTION, shut, strict=True
            ):
                size = force if member in ("axial", "shear_y", "shear_z") else moment
                gaps.append(0.0 if is_open else abs(getattr(own, member)[0, k] - value) / size)
    for rub in rubs:
        taken = -frictions[rub.name] * rub.rate(true)
        assert solution.series[f"friction:{rub.name}:loss"][0] == pytest.approx(
            taken, rel=1e-9, abs=1e-10 * moment
        )
    return max(gaps)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join(map(str, case)))
def test_right_or_refused(case):
    worst = compare(case)
    assert worst is None or worst < 1e-10


def on_a_ball(law):
    """A wheel upright on a ball, which turns about the vertical line alone, loaded aside."""
    m = SpatialMechanism("upright")
    wheel = m.link("wheel", length=0.1, mass=7.0, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.1))
    ball = m.spherical("ball", m.ground, wheel, axis=(0, 0, 1), second=(0, 1, 0))
    m.force("aside", wheel, x=30.0)
    m.friction("rub", ball, mu=0.2, radius=0.03)
    return Scene(
        m,
        {"ball:turn_1": law, "ball:turn_2": polynomial(0.0), "ball:turn_3": polynomial(0.0)},
        t=(0, 1, 5),
    )


def test_a_ball_at_rest_is_open_and_where_it_turns_back_it_goes_on():
    still = evaluate(on_a_ball(polynomial(0.1)))
    assert still.resting.all()
    assert np.isnan(still.effort("ball:turn_1")).all()
    assert "rub" in still.notes[0]
    back = [(0.25 - 0.4 / math.tau + k / 2) for k in range(4)]
    for k, top in enumerate(back):
        solution = evaluate(on_a_ball(harmonic(0.1, 1.0, 1.0, 0.4)), t=(top, top, 1))
        assert solution.certified
        assert not solution.resting.any()
        inertia = 0.1 * solution.motion("ball:turn_1").acceleration[0]
        rubs = solution.effort("ball:turn_1")[0] - inertia
        assert rubs == pytest.approx(
            (-1) ** (k + 1) * 0.2 * 0.03 * math.hypot(7.0 * 9.81, 30.0), rel=1e-9
        )


def test_what_a_ball_cannot_have_is_told():
    m = SpatialMechanism("wrong")
    m.spherical(
        "ball",
        m.ground,
        m.link("wheel", length=0.1, mass=7.0, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.1)),
    )
    told = {"mu": 0.1, "radius": 0.02}
    for more, words in (
        (
            {"along": "turn_1"},
            "joint 'ball' has its friction along its rotation, not along 'turn_1'",
        ),
        (
            {"length": 0.1},
            "joint 'ball' turns and has no guide length; expected radius=",
        ),
        ({"radius": None}, "joint 'ball' turns; expected radius"),
    ):
        with pytest.raises(DeclarationError, match=f"friction 'more': {words}"):
            m.friction("more", m.joints["ball"], **told | more)
    two = SpatialMechanism("bar")
    crank, rod, end = (two.link(name, length=0.2, mass=1.0) for name in ("crank", "rod", "end"))
    two.revolute("O", two.ground, crank, axis=(0, 0, 1))
    two.friction("rub", two.spherical("A", crank.tip, rod), mu=0.1, radius=0.01)
    two.spherical("B", rod.tip, end.tip)
    two.revolute("C", two.ground.at(0.2, 0.1, 0.0), end, axis=(0, 1, 0))
    with pytest.raises(
        MobilityError, match="if one of them has friction, make the other one universal"
    ):
        evaluate(Scene(two, {"O": polynomial(0.3, 1.0)}, t=(0, 1, 3), posture={"C": 0.4}))
