"""Axes with the rounding of a drawing: an over-constrained loop closes all the same, and says by
how much its axes were moved.
"""

from __future__ import annotations

import numpy as np
import pytest

from lagrange_casadi import Scene, SpatialMechanism, evaluate
from lagrange_casadi.errors import DeclarationError, MobilityError
from lagrange_casadi.motion import harmonic, polynomial


def swinging(noise, **options):
    """A slider-crank on a base that swings, its axes and places off by so much."""
    rng = np.random.default_rng(1)

    def off(*vector):
        return tuple(float(x + noise * rng.uniform(-1, 1)) for x in vector)

    m = SpatialMechanism("swinging")
    base, crank = m.link("base", length=0.5, mass=3.0), m.link("crank", length=0.1, mass=0.4)
    rod, slider = m.link("rod", length=0.35, mass=0.8), m.link("slider", length=0.05, mass=2.0)
    m.revolute("swing", m.ground, base, axis=off(0, 0, 1))
    m.revolute("O", base.at(*off(0.1, 0.02, 0.01)), crank, axis=off(0, 0, 1))
    m.revolute("A", crank.tip, rod, axis=off(0, 0, 1))
    m.revolute("B", rod.tip, slider, axis=off(0, 0, 1))
    m.prismatic("guide", base.at(*off(0.1, 0.04, 0.01)), slider, axis=off(1, 0, 0))
    laws = {"swing": harmonic(0.2, 0.3, 1.0), "O": polynomial(0.3, 10)}
    return Scene(m, laws, t=(0, 0.6, 7), posture={"A": -0.4, "B": 0.3, "guide": 0.44}, **options)


@pytest.mark.parametrize("noise", [1e-13, 1e-9, 1e-7])
def test_forces_are_those_of_exact_axes_but_for_the_rounding(noise):
    exact, told = (
        evaluate(swinging(size), wanted=["effort"], backend="vm") for size in (0.0, noise)
    )
    assert told.certified
    for joint in ("swing", "O"):
        force = exact.effort(joint)
        assert np.max(np.abs(told.effort(joint) - force)) < 20 * noise * np.max(np.abs(force))
    assert any("rounding" in note for note in told.notes) == (noise > 1e-12)
    assert not any("rounding" in note for note in exact.notes)


def test_what_is_off_by_more_than_the_tolerance_is_refused():
    with pytest.raises(MobilityError, match="degree"):
        evaluate(swinging(1e-7, rounding=0.0), wanted=["effort"], backend="vm")


@pytest.mark.parametrize(
    "rounding", [-1e-9, 2e-3, np.nan, np.inf, None, True, "1e-6", "a lot", [1e-6]]
)
def test_a_tolerance_that_is_none_is_refused(rounding):
    with pytest.raises(DeclarationError, match="rounding"):
        swinging(0.0, rounding=rounding)


@pytest.mark.parametrize("off", [1e-13, 1e-8, -9e-7])
def test_a_second_axis_is_made_exact(off):
    """Its part across the first is taken, of a joint and of the child's axes; the first stays."""
    m = SpatialMechanism("cross")
    turned = ((0.0, 0.0, 1.0), (-1.0, 0.0, off))
    joint = m.universal(
        "C",
        m.ground,
        m.link("rod", length=0.3, mass=0.5),
        axis=(1, 0, 0),
        second=(off, 1, 0),
        turned=turned,
    )
    for first, second in (joint.directions[:2], joint.turned):
        assert abs(np.dot(first, second)) < 1e-12
        assert np.linalg.norm(second) == pytest.approx(1.0, abs=1e-15)
    assert joint.directions[0] == (1.0, 0.0, 0.0)


def test_a_second_axis_that_is_off_by_more_is_refused():
    m = SpatialMechanism("cross")
    with pytest.raises(DeclarationError, match="right angles"):
        m.universal(
            "C", m.ground, m.link("rod", length=0.3, mass=0.5), axis=(1, 0, 0), second=(2e-6, 1, 0)
        )
