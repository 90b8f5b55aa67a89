"""What least strain energy tells, in part, and within sweeps, prepared scenes and exported C."""

import numpy as np
import pytest
from elastic_mechanisms import STEEL, made

from lagrange_casadi import Mechanism, Scene, beams, evaluate, sweep


def shared():
    """A welded beam with a pin at a place that may be moved along it, and beside it a beam of which
    the stiffness is not known.
    """
    m = Mechanism("shared")
    m.set_gravity(0.0, 0.0)
    d = m.parameter("d", 1.5, "m", low=0.0)
    for name, made_of in (
        ("known", {"beam": made(beams.rectangle(0.05, 0.02))}),
        ("bare", {"mass": 3.0}),
    ):
        bar = m.link(name, length=2.0, **made_of)
        m.weld(f"A_{name}", m.ground, bar)
        m.revolute(f"B_{name}", m.ground.at(d, 0.0), bar.at(d))
        m.force(f"push_{name}", bar.tip, y=-1000.0)
    return Scene(m, {}, t=(0, 0, 1), elastic=True)


def test_it_is_told_in_part():
    """What one beam shares is told, and where its pin is at its weld it bends nothing and is open;
    in sweeps too.
    """
    scene = shared()
    apart, together = (evaluate(scene, parameters={"d": d}, backend="vm") for d in (1.5, 0.0))
    for solution, open_ in (
        (apart, {"A_bare", "B_bare", "bare"}),
        (together, {"A_bare", "B_bare", "A_known", "B_known"}),
    ):
        assert {name.split(":")[1] for name in solution.undetermined} == open_
        assert solution.certified
    # A propped cantilever whose load is beyond the prop: P (1 + 3c/2a), with the shear of
    # Timoshenko's beam.
    p, a, c = beams.rectangle(0.05, 0.02).properties(), 1.5, 0.5
    ei, ga = STEEL.elasticity * p.iz, STEEL.shear_modulus * p.shear_y
    prop = 1000.0 * (a**3 / (3 * ei) + c * a**2 / (2 * ei) + a / ga) / (a**3 / (3 * ei) + a / ga)
    assert apart.reaction("B_known").fy[0] == pytest.approx(prop, rel=1e-9)
    assert apart.elasticity.reasons == ("they go through 'bare', which has no beam",)
    assert together.elasticity.reasons == ("some do not deform any link",)
    found = sweep(scene, {"d": [1.5, 0.0]}, wanted=["reaction", "section:known"], backend="vm")
    assert found["peak:reaction:A_known:fy"] == pytest.approx(
        [1000.0 - prop, np.nan], rel=1e-9, nan_ok=True
    )
    assert found["peak:section:known:bending"] == pytest.approx([-500.0, -2000.0], rel=1e-9)
