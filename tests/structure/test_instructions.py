"""How many instructions an instant of each case takes: what all speed begins with."""

from itertools import pairwise

import pytest
from conftest import CASES

from lagrange_casadi import Scene, SpatialMechanism, derive, load_case
from lagrange_casadi.motion import harmonic

pytestmark = pytest.mark.quick

INSTANT = {
    "slider_crank": 183,
    "engine": 393,
    "connecting_rod": 474,
    "four_bar": 296,
    "quick_return": 303,
    "six_bar": 522,
    "andrews_squeezer": 591,
    "rrr3": 795,
    "arm": 222,
    "sleigh": 220,
    "jansen_leg": 740,
    "excavator": 1494,
    "beam_pump": 480,
    "parallelogram_arm": 418,
    "scara": 158,
    "roller_cam": 304,
    "v_twin": 1524,
    "servo_press": 223,
    "punch_press": 187,
    "planetary_gear": 628,
    "geneva": 218,
    "toggle_clamp": 478,
    "scissor_lift": 973,
    "screw_lift": 246,
    "rssr": 779,
    "spatial_slider_crank": 430,
    "stewart_gough": 5322,
    "arm6": 1434,
    "cardan_shaft": 771,
    "cad_press": 366,
    "parallel_leg": 5334,
    "five_link_suspension": 2601,
    "delta": 4560,
    "bricard": 2044,
    "v6": 8042,
    "quadruped": 10133,
}
LOOPS = {"rrr3": 239, "beam_pump": 50, "cardan_shaft": 62}
LOOPS |= {
    "parallel_leg": 1267,
    "five_link_suspension": 783,
    "delta": 1002,
    "bricard": 338,
    "v6": 1357,
}


@pytest.mark.parametrize("name", INSTANT)
def test_an_instant_takes_no_more_than_it_did(name):
    """Another CasADi may share other terms, so a hundredth more is none."""
    count = derive(load_case(CASES / name).scene).instructions
    assert count["instant"] <= 1.01 * INSTANT[name]
    assert count.get("loops", 0) <= LOOPS.get(name, 0)


def test_every_case_is_counted():
    assert sorted(INSTANT) == sorted(path.parent.name for path in CASES.glob("*/case.py"))


EFFORTS = {
    "slider_crank": 81,
    "engine": 288,
    "four_bar": 157,
    "quick_return": 149,
    "six_bar": 280,
    "andrews_squeezer": 376,
    "rrr3": 545,
    "arm": 113,
    "sleigh": 100,
    "rssr": 361,
    "spatial_slider_crank": 213,
    "stewart_gough": 3482,
    "arm6": 423,
    "cardan_shaft": 379,
    "five_link_suspension": 1581,
    "delta": 2872,
    "bricard": 1060,
}
"""Instructions of an instant if only the efforts are wanted."""


@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", EFFORTS)
def test_efforts_alone_take_fewer(name):
    count = derive(load_case(CASES / name).scene, ["effort"]).instructions
    assert count["instant"] == pytest.approx(EFFORTS[name], rel=0.01)


def chain(links):
    """An open chain of slender links, with axes across and along them by turns."""
    m = SpatialMechanism("chain")
    end, laws = m.ground, {}
    for k in range(links):
        link = m.link(f"link{k}", length=0.3, mass=1.0)
        m.revolute(
            f"J{k}", end, link, axis=((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))[k % 3]
        )
        end, laws[f"J{k}"] = link.tip, harmonic(0.1 * k, 0.5, 1.0)
    return Scene(m, laws, t=(0.0, 1.0, 11))


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "wanted", [["effort"], ["effort", "section"]], ids=["efforts", "sections too"]
)
def test_instructions_grow_with_the_links_of_an_open_chain(wanted):
    """Three more links take as many instructions more, however many there are."""
    counts = [derive(chain(links), wanted).instructions["instant"] for links in (6, 9, 12, 15)]
    steps = {later - earlier for earlier, later in pairwise(counts)}
    assert len(steps) == 1
