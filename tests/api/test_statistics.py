"""Means, smallest and largest values, and solutions as rows."""

from dataclasses import replace

import numpy as np
import pytest

from lagrange_casadi import evaluate, load_case

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.mark.parametrize("case", ["slider_crank", "quick_return", "engine"])
def test_section_forces_are_never_beyond_their_smallest_and_largest(case):
    """Also beside a pin that slides along its link, on either side of it; and the places have these
    values.
    """
    found = evaluate(load_case(case).scene, wanted=["section"])
    for link in found.links_with_sections:
        law = found.section(link).law
        for force in ("axial", "shear", "bending"):
            told = found.statistics(f"section:{link}:{force}")
            grid = law.on_grid(force, np.linspace(0, 1, 401))
            size = max(abs(told.smallest.value), abs(told.largest.value))
            assert told.smallest.value <= grid.min() + 1e-13 * size
            assert told.largest.value >= grid.max() - 1e-13 * size
            assert np.ptp(grid) >= 0.99 * (told.largest.value - told.smallest.value)
            peak = found.peak(f"section:{link}:{force}")
            assert (told.peak.value, told.peak.t, told.peak.xi) == (peak.value, peak.t, peak.xi)
            assert size == abs(peak.value)
            assert (told.mean, told.rms) == (None, None)
            for extreme in (told.smallest, told.largest):
                i = int(np.flatnonzero(found.t == extreme.t)[0])
                sides = [
                    law.during(slice(i, i + 1)).at(force, np.array([[extreme.xi]]), side)[0, 0]
                    for side in ("base", "tip")
                ]
                assert min(abs(side - extreme.value) for side in sides) <= 1e-12 * size


def test_to_pandas(solution):
    table = replace(solution, xi=np.array([0.0, 0.25])).to_pandas()
    assert table.index.name == "t [s]"
    np.testing.assert_array_equal(table.index, solution.t)
    np.testing.assert_array_equal(table["effort:O [N m]"], solution.effort("O"))
    assert "motion:O_acceleration [rad/s^2]" in table
    bending = solution.section("rod").law.on_grid("bending", np.array([0.25]))[:, 0]
    np.testing.assert_array_equal(table["section:rod:bending xi/l=0.25 [N m]"], bending)
    assert (
        len(table.columns)
        == sum(1 for name in solution.names() if not name.startswith("section")) + 2 * 3 * 2
    )


def test_means_at_one_instant_are_its_value(solution):
    one = solution.during(slice(100, 101)).statistics("effort:O")
    assert one.mean == one.rms == one.smallest.value == one.largest.value > 0.0
