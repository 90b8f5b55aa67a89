"""Heavy masses beside light links: what a guide bears of a slider is in no force of the rod."""

import numpy as np
import pytest
from arithmetic import ROUNDING
from truth import truth

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.motion import polynomial

MASSES = [1.0, 1e10]
PINS = ("effort:O", *(f"reaction:{pin}:{member}" for pin in "OAB" for member in ("fx", "fy")))
ROUNDINGS = 16.0
"""Of its own peak, that a force may be off."""


def held(mass, kind=Mechanism, *, turns=False):
    """A slider-crank at rest, whose guide bears the weight of its slider: a point, or in space a
    link that ``turns`` about the guide.
    """
    m = kind("held")
    crank, rod = m.link("crank", length=0.1, mass=0.1), m.link("rod", length=0.25, mass=0.1)
    space = kind is SpatialMechanism
    slider = m.link("slider", length=0.1, mass=mass) if turns else m.point_mass("slider", mass)
    turn = {"axis": (0, 1, 0)} if space else {}
    m.revolute("O", m.ground, crank, **turn)
    m.revolute("A", crank.tip, rod, **turn)
    if space and not turns:
        m.spherical("B", rod.tip, slider)
    else:
        m.revolute("B", rod.tip, slider, **turn)
    guide = m.cylindrical if turns else m.prismatic
    guide("guide", m.ground, slider, axis=(1, 0, 0) if space else (1, 0))
    sign = -1.0 if space else 1.0
    slides = {"guide:slide": 0.3, "guide:turn": 0.0, "B": -0.3} if turns else {"guide": 0.3}
    rough = {"A": 1.2, **slides} if space else {"rod": -0.3}
    return Scene(m, {"O": polynomial(0.9 * sign)}, t=(0.0, 0.0, 1), posture=rough)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("mass", MASSES)
def test_a_light_rod_before_a_heavy_slider_loses_no_digits(mass, precision):
    solution = evaluate(held(mass), precision=precision, backend="c")
    ((exact,),) = truth(held(mass), solution.t).sides
    for name in PINS:
        off = abs(float(solution.array(name)[0] - exact[name]))
        assert off <= ROUNDINGS * ROUNDING[precision] * abs(float(exact[name])), name
    bars = solution.section("rod")
    light = evaluate(held(0.0)).section("rod")
    for force in ("axial", "shear", "bending"):
        one, other = getattr(bars, force), getattr(light, force)
        size = ROUNDINGS * ROUNDING[precision] * np.max(np.abs(other))
        np.testing.assert_allclose(one, other, rtol=0, atol=size)


@pytest.mark.parametrize("turns", [False, True])
@pytest.mark.parametrize("mass", MASSES)
def test_nor_does_one_in_space(mass, turns):
    light, heavy = (
        evaluate(held(one, SpatialMechanism, turns=turns), backend="vm") for one in (0.0, mass)
    )
    for name in light.names():
        if name.startswith(("effort", "reaction:O", "reaction:A", "reaction:B")):
            one, other = heavy.array(name), light.array(name)
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-15, err_msg=name)
