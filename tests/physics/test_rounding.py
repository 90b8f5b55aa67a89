"""Axes with the rounding of a drawing: how far they may be off, and second axes."""

from __future__ import annotations

import numpy as np
import pytest

from lagrange_casadi import Scene, SpatialMechanism
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import harmonic


def swinging(rounding):
    m = SpatialMechanism("swinging")
    m.revolute("swing", m.ground, m.link("base", length=0.5, mass=3.0))
    return Scene(m, {"swing": harmonic(0.2, 0.3, 1.0)}, t=(0, 0.6, 7), rounding=rounding)


@pytest.mark.parametrize(
    "rounding", [-1e-9, 2e-3, np.nan, np.inf, None, True, "1e-6", "a lot", [1e-6]]
)
def test_a_tolerance_that_is_none_is_refused(rounding):
    with pytest.raises(DeclarationError, match="rounding"):
        swinging(rounding)


def test_a_second_axis_that_is_off_by_more_is_refused():
    m = SpatialMechanism("cross")
    with pytest.raises(DeclarationError, match="right angles"):
        m.universal(
            "C", m.ground, m.link("rod", length=0.3, mass=0.5), axis=(1, 0, 0), second=(2e-6, 1, 0)
        )
