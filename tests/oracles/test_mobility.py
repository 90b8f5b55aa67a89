"""Internal forces of many mechanisms against vector Newton-Euler on free bodies, which shares
nothing with the package.
"""

import pytest
from balance import compare
from mechanisms import PATTERNS, truss_platform

from lagrange_casadi import derive

TOLERANCE = 1e-12


@pytest.mark.parametrize("name", PATTERNS)
def test_every_force_against_newton_euler(name):
    worst, gap = compare(PATTERNS[name]())
    assert gap < TOLERANCE, worst


def test_loops_without_closed_form_against_newton_euler():
    scene = truss_platform()
    assert derive(scene).newton is not None
    worst, gap = compare(scene, t=0.0, nudge=0.003)
    assert gap < TOLERANCE, worst
