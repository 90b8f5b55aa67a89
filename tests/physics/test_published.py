"""Numbers from outside: sixty digits of a slider-crank."""

from __future__ import annotations

import numpy as np
import pytest
from balance import instant_at
from conftest import SIXTY_DIGITS

from lagrange_casadi import derive, evaluate

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def instants(slider_crank):
    """Every column at the reference's own instants."""
    program = derive(slider_crank.scene)
    p = list(slider_crank.scene.mechanism.values().values())
    rows = [instant_at(program, float(row["t"]), p).full().ravel() for row in SIXTY_DIGITS["rows"]]
    return dict(zip(program.names, np.array(rows).T, strict=True))


def reference(key, index=None):
    return np.array(
        [row[key] if index is None else row[key][index] for row in SIXTY_DIGITS["rows"]],
        dtype=float,
    )


def assert_within(found, expected, relative=1e-13):
    """Within ``relative`` of the largest value over the cycle."""
    assert np.max(np.abs(found - expected)) <= relative * np.max(np.abs(expected))


def test_torque_and_reactions(instants):
    assert_within(instants["effort:O"], reference("torque_O"))
    assert_within(instants["reaction:guide:fy"], reference("guide_on_slider"))
    for axis in (0, 1):
        assert_within(instants[f"reaction:A:f{'xy'[axis]}"], reference("crank_on_rod_A", axis))
        assert_within(-instants[f"reaction:B:f{'xy'[axis]}"], reference("slider_on_rod_B", axis))


def test_sections_as_a_solution_gives_them(slider_crank):
    """The same by the whole path: compiled, on the grid, at t = 0.03 s and the ratios 0, 1/4, 1/2,
    3/4, 1.
    """
    row = next(row for row in SIXTY_DIGITS["rows"] if float(row["t"]) == 0.03)
    picked = [SIXTY_DIGITS["xi_over_l"].index(x) for x in ("0", "0.25", "0.5", "0.75", "1")]
    solution = evaluate(slider_crank.scene, t=(0.03, 0.03, 1), xi=(0, 1, 5), wanted=["section:rod"])
    for force in ("axial", "shear", "bending"):
        expected = np.array([float(row[f"R_{force}"][i]) for i in picked])
        largest = np.max(np.abs(reference(f"R_{force}")))
        assert (
            np.max(np.abs(solution.array(f"section:rod:{force}")[0] + expected)) <= 1e-13 * largest
        )
