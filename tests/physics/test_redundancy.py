"""Mechanisms with more equations than unknowns, and structures that do not move."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mechanisms import parallelogram

from lagrange_casadi import Mechanism, Scene, evaluate, prepare
from lagrange_casadi.errors import AssemblyError, MobilityError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.mark.parametrize("steps", [1, 5])
def test_counted_steps_do_not_hide_a_misfit(steps):
    with pytest.raises(
        (MobilityError, AssemblyError), match=r"0 degree\(s\) of freedom|do not fit"
    ):
        evaluate(parallelogram(third=1.02), newton=steps)


def three_cranks(default=math.pi / 2, **keywords):
    """Three equal cranks side by side carry one bar; what each end of it bears is open, but for the
    postures in which it is not.
    """
    m = Mechanism("three_cranks")
    a, b, c = (m.link(name, length=0.2, mass=0.3) for name in "abc")
    bar = m.link("bar", length=1.0, mass=1.0)
    for k, link in enumerate((a, b, c)):
        m.revolute(f"G{k}", m.ground.at(0.5 * k, 0.0), link)
        m.revolute(f"B{k}", link.tip, (bar.base, bar.at(0.5), bar.tip)[k])
    angle = m.parameter("angle", default, "rad")
    return Scene(
        m,
        {"G0": polynomial(angle)},
        posture={"a": 1.5, "b": 1.5, "c": 1.5, "bar": 0.0},
        t=(0, 0, 1),
        **keywords,
    )


@pytest.mark.parametrize("backend", ["vm", "c", "lanes"])
def test_what_is_open_is_decided_for_the_parameters_that_are_evaluated(backend):
    """Upright cranks share the bar's weight in a way of their own each; leaning ones share its
    thrust too.
    """
    scene = three_cranks()
    upright, leaning = (
        evaluate(scene, parameters={"angle": angle}, backend=backend)
        for angle in (math.pi / 2, 1.0)
    )
    opened = {name for name in leaning.undetermined if name.startswith("reaction")}
    assert opened > {name for name in upright.undetermined if name.startswith("reaction")}
    for joint in ("B0", "B1", "B2"):
        assert f"reaction:{joint}:fx" in opened
        assert np.isnan(leaning.reaction(joint).fx).all()
    assert leaning.determined("effort:G0")
    torque = 9.81 * 0.2 * math.cos(1.0) * (3 * 0.3 / 2 + 1.0)
    np.testing.assert_allclose(leaning.effort("G0"), torque, rtol=1e-13)


@pytest.mark.parametrize("backend", ["lanes", "c"])
def test_what_the_defaults_leave_open_is_told_of_designs_that_determine_it(backend):
    """The defaults lean: alone they would say that nothing is there; upright cranks have it all the
    same.
    """
    scene = three_cranks(default=1.0, wanted=["reaction:B0"])
    upright = evaluate(scene, parameters={"angle": math.pi / 2}).peak("reaction:B0:fx").value
    ready = prepare(scene, backend=backend)
    k = ready.quantities.index("reaction:B0:fx")
    found = ready.designs(np.array([[1.0], [math.pi / 2]])).value[:, k]
    np.testing.assert_allclose(found, [np.nan, upright], atol=1e-13)
    assert np.isnan(ready()["reaction:B0:fx"]).all()
    assert ready(angle=math.pi / 2)["reaction:B0:fx"] == pytest.approx([upright], abs=1e-13)
