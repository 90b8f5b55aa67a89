"""How many instructions an instant of each case takes: what all speed begins with."""

import pytest
from conftest import CASES

from lagrange_casadi import derive, load_case

pytestmark = pytest.mark.quick

INSTANT = {
    "slider_crank": 183,
    "engine": 393,
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
    "rssr": 781,
    "spatial_slider_crank": 451,
    "stewart_gough": 5923,
    "arm6": 1888,
    "cardan_shaft": 730,
    "five_link_suspension": 2512,
    "delta": 4440,
    "bricard": 2125,
}
LOOPS = {"rrr3": 239, "beam_pump": 50, "spatial_slider_crank": 53, "cardan_shaft": 62}
LOOPS |= {"five_link_suspension": 772, "delta": 1142, "bricard": 338}


@pytest.mark.parametrize("name", INSTANT)
def test_an_instant_takes_no_more_than_it_did(name):
    """Another CasADi may share other terms, so a hundredth more is none."""
    count = derive(load_case(CASES / name).scene).instructions
    assert count["instant"] <= 1.01 * INSTANT[name]
    assert count.get("loops", 0) <= LOOPS.get(name, 0)


def test_every_case_is_counted():
    assert sorted(INSTANT) == sorted(path.parent.name for path in CASES.glob("*/case.py"))
