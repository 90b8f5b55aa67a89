"""Solutions: names, peaks, xarray."""

from dataclasses import replace

import numpy as np
import pytest
from internals import Output

from lagrange_casadi import Mechanism, evaluate
from lagrange_casadi.errors import UnknownNameError

pytestmark = pytest.mark.quick


def test_names_lead_to_arrays(solution):
    for name in solution.names():
        array = solution.array(name)
        shape = {"t": solution.t.size, "xi": solution.xi.size}
        assert array.shape == tuple(shape[axis] for axis in Output.of(name).quantity.axes), name
        assert np.isfinite(array).all()
    assert solution.reaction("guide").fy is solution.array("reaction:guide:fy")
    assert solution.reaction("guide").mz is None
    assert solution.section("rod").bending is solution.array("section:rod:bending")
    assert solution.effort("O") is solution.array("effort:O")
    assert solution.pose("slider").angle is None


def test_units(solution):
    units = {
        name: solution.unit(name)
        for name in (
            "effort:O",
            "motion:guide_rate",
            "motion:O_acceleration",
            "section:rod:bending",
        )
    }
    assert units == {
        "effort:O": "N m", "motion:guide_rate": "m/s", "motion:O_acceleration": "rad/s^2",
            "section:rod:bending": "N m",
    }  # fmt: skip


def test_peaks_are_those_of_a_fine_grid(solution, slider_crank):
    fine = evaluate(slider_crank.scene, xi=(0, 1, 4001), wanted=["section:rod"])
    for force in ("axial", "shear", "bending"):
        peak = solution.peak(f"section:rod:{force}")
        grid = fine.array(f"section:rod:{force}")
        i, j = np.unravel_index(np.argmax(np.abs(grid)), grid.shape)
        assert peak.value == pytest.approx(grid[i, j], rel=1e-7)
        assert abs(peak.value) >= abs(grid[i, j]) * (1 - 1e-14)
        assert (peak.t, peak.xi) == pytest.approx((fine.t[i], fine.xi[j]), abs=3e-4)


def test_peak_of_a_series(solution):
    peak = solution.peak("effort:O")
    assert abs(peak.value) == np.max(np.abs(solution.effort("O")))
    assert solution.effort("O")[np.searchsorted(solution.t, peak.t)] == peak.value
    assert peak.unit == "N m"
    assert peak.xi is None


def test_extremes_are_the_largest_along_the_link(solution):
    values, places = solution.extremes("section:rod:bending")
    grid = solution.section("rod").bending
    assert places.shape == values.shape == solution.t.shape
    assert np.all(np.abs(values) >= np.abs(grid).max(axis=1) * (1 - 1e-14))
    at = solution.section("rod").law.at("bending", places[:, None])[:, 0]
    np.testing.assert_allclose(values, at, rtol=1e-14)
    values, places = solution.extremes("effort:O")
    assert (values is solution.effort("O"), places) == (True, None)


def test_angles_are_continuous(slider_crank):
    turns = evaluate(slider_crank.scene, t=(0, 0.8, 2001), wanted=["motion"])
    crank = turns.pose("crank").angle
    assert np.max(np.abs(np.diff(crank))) < 0.1
    np.testing.assert_allclose(crank, turns.motion("O").value, atol=1e-12)
    np.testing.assert_allclose(turns.motion("A").value, turns.pose("rod").angle - crank, atol=1e-12)


def test_unknown_names_list_the_valid(solution, slider_crank):
    with pytest.raises(
        UnknownNameError, match="unknown link with sections 'sider'; valid: crank, rod"
    ):
        solution.section("sider")
    with pytest.raises(
        UnknownNameError, match=r"unknown joint with a reaction 'gide' \(did you mean 'guide'\?\)"
    ):
        solution.reaction("gide")
    with pytest.raises(UnknownNameError, match="unknown drive 'A'; valid: O"):
        solution.effort("A")
    with pytest.raises(UnknownNameError, match="unknown quantity 'section:rod:torsion'"):
        solution.peak("section:rod:torsion")
    with pytest.raises(UnknownNameError, match="valid: none are declared"):
        evaluate(slider_crank.scene, wanted=["effort"]).motion("O")


def test_a_section_is_made_when_asked_for(slider_crank):
    """The law is seven numbers an instant; a grid of xi costs nothing
    until somebody looks at it.
    """
    solution = evaluate(
        slider_crank.scene, t=(0, 0.08, 11), xi=(0, 1, 100_000), wanted=["section:rod"]
    )
    assert sum(values.size for values in solution.series.values()) == 7 * 11
    assert solution.section("rod").bending.shape == (11, 100_000)


def test_to_xarray(solution):
    dataset = solution.to_xarray()
    assert dataset["section:rod:bending"].dims == ("t", "xi")
    assert dataset["section:rod:bending"].attrs["units"] == "N m"
    assert "tension" in dataset["section:rod:axial"].attrs["sign"]
    assert float(dataset["effort:O"].sel(t=0.03, method="nearest")) == solution.effort("O")[300]


def test_repr_is_short(solution):
    assert (
        repr(solution)
        == "<Solution of slider_crank: 801 instants, 101 ratios, 32 quantities, certified>"
    )
    assert repr(solution.section("rod")) == "<Section of a link of 0.2 m: 801 instants, 101 ratios>"
    assert "no certificate" in repr(replace(solution, certificate={}))
    assert "its certificate fails" in repr(replace(solution, certificate={"balance": np.ones(801)}))


def test_what_is_declared_is_shown_in_a_line(slider_crank):
    scene = "<Scene of slider_crank: drives O, wants all, 801 instants from 0 to 0.08 s>"
    assert (
        repr(slider_crank.scene.mechanism)
        == "<Mechanism slider_crank: crank, rod, slider; joints: O, A, B, guide>"
    )
    assert repr(slider_crank.scene) == scene
    assert repr(slider_crank) == f"<Case slider_crank: {scene}>"
    assert repr(Mechanism("new")) == "<Mechanism new: no body yet; joints: none yet>"
