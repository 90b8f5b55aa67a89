"""Grids of section forces: compiled or not, in one piece or in many, the same bits, and the law."""

import numpy as np
import pytest
from every_way import DECLARED
from internals import grids

from lagrange_casadi import evaluate

pytestmark = pytest.mark.quick

WAYS = [
    {"WORTH_COMPILING": 10**12},
    {"_SHARE": 1000},
    {"_STREAMING": 0},
    {"_STREAMING": 0, "_SHARE": 1000},
]
"""All by NumPy; by many threads; past the caches; both."""


@pytest.mark.parametrize("name", ["plane", "space", "sampled_cam"])
def test_grids_are_those_of_the_law_to_the_last_bit(name, monkeypatch):
    """Links with loads along them have more terms than others, and of resultants twice as many."""
    solution = evaluate(DECLARED[name](), backend="vm", xi=(0, 1, 37), certificate=False)
    for link in solution.links_with_sections:
        law = solution.section(link).law
        for force in solution.table.forces:
            usual = law.on_grid(force, solution.xi)
            places = np.tile(solution.xi, (solution.t.size, 1))
            size = 1e-13 * np.abs(usual).max()
            np.testing.assert_allclose(usual, law.at(force, places), rtol=0, atol=size)
            for way in WAYS:
                with monkeypatch.context() as patch:
                    for constant, value in way.items():
                        patch.setattr(grids, constant, value)
                    assert law.on_grid(force, solution.xi).tobytes() == usual.tobytes()
