"""Maps of stresses and deflections in a page: their numbers and peaks are the solution's, and a
browser tells them.
"""

import json

import alive
import numpy as np
import pytest
import strong
from internals import Live, contents, maps
from internals import report_page as page
from reports import held, press

from lagrange_casadi import evaluate

chromium = alive.chromium

WANTED = ["all", "stress:rod"]


@pytest.fixture(scope="module")
def scene():
    return strong.slider()


@pytest.fixture(scope="module")
def solution(scene):
    return evaluate(scene, wanted=WANTED, backend="vm", certificate=False)


def test_a_map_is_the_solutions_grid_and_peak(solution):
    text = page(solution)
    found, array = held(text)
    kinds = [f"{kind}:{link}" for kind in ("stress", "deflection") for link in ("crank", "rod")]
    assert [one["name"] for one in found["maps"]] == kinds
    stress, bent = (one for one in found["maps"] if one["link"] == "rod")
    exact = solution.stress("rod").peak("von_mises")
    assert (stress["peak"]["value"], stress["peak"]["t"], stress["peak"]["xi"]) == (
        exact.value,
        exact.t,
        exact.xi,
    )
    assert stress["where"] == exact.fibre
    largest = solution.deflection("rod").peak()
    assert bent["peak"]["t"] == largest.t
    assert [bent["peak"]["value"], bent["peak"]["xi"]] == pytest.approx(
        [largest.value, largest.xi], rel=1e-9
    )
    xi = np.linspace(0, 1, maps.RATIOS)
    grids = [
        solution.stress("rod").grid("von_mises", xi),
        solution.deflection("rod").grid("across", xi),
    ]
    for one, grid in zip((stress, bent), grids, strict=True):
        np.testing.assert_array_equal(array(one["t"]), solution.t)
        np.testing.assert_array_equal(array(one["xi"]), xi)
        values = array(one["values"]).reshape(grid.shape)
        np.testing.assert_allclose(values, grid, rtol=0, atol=1e-12 * np.abs(grid).max())


def test_more_instants_than_a_map_shows_are_thinned_and_its_peak_kept(solution, monkeypatch):
    monkeypatch.setattr(maps, "INSTANTS", 7)
    found, array = held(page(solution))
    for one in found["maps"]:
        assert len(array(one["t"])) in (7, 8)
        assert one["peak"]["t"] in array(one["t"])
        assert np.abs(array(one["values"])).max() <= abs(one["peak"]["value"]) * (1 + 1e-12)
    exact = solution.stress("rod").peak("von_mises")
    assert [one["peak"]["value"] for one in found["maps"] if one["name"] == "stress:rod"] == [
        exact.value
    ]


def test_a_row_tells_the_largest_stress(solution):
    (row,) = [row for row in contents(solution)["rows"] if row["group"] == "stress"]
    assert row["name"] == "stress:rod:von_mises"
    assert row["peak"]["value"] == solution.peak("stress:rod:von_mises").value
    assert row["peak"]["value"] == pytest.approx(
        solution.stress("rod").peak("von_mises").value, rel=1e-9
    )


def test_what_has_no_beam_has_no_map():
    assert contents(press())["maps"] == []


@pytest.mark.long
@alive.NEEDS_BROWSER
@alive.NEEDS_ENGINE
def test_of_another_design_stress_is_evaluated_and_what_is_not_says_so(chromium, scene, tmp_path):
    wanted = [*WANTED, "sensitivity:r"]
    solution = evaluate(scene, wanted=wanted, backend="vm", certificate=False)
    text = page(solution, Live.of(scene, scene.timing(), wanted, "run"))
    alive.opened(chromium, tmp_path / "live.html", text)
    rows = chromium.run(
        f"(() => {{ window.page.live.engine.show({json.dumps([0.09, 0.4, 0.02])}); return"
        " window.page.contents.rows; })()"
    )
    (row,) = [row for row in rows if row["group"] == "stress"]
    slopes = (
        "page.contents.series.filter((one) => one.group === 'sensitivity').map((one) =>"
        " [...page.array(one.values)])"
    )
    unknown = chromium.run(slopes)
    assert unknown
    assert {value for values in unknown for value in values} == {None}
    true = evaluate(scene, parameters={"r": 0.09}, wanted=WANTED, backend="vm", certificate=False)
    assert row["peak"]["value"] == pytest.approx(true.peak("stress:rod:von_mises").value, rel=1e-12)
    chromium.run(
        "{ const field = document.querySelector('.sliders [type=number]'); field.value = 0.09;"
        " for (const kind of ['input', 'change']) field.dispatchEvent(new Event(kind)); }"
    )
    alive.wait(
        chromium,
        "document.querySelector('.cards').textContent.includes(\"This map is of the file's design"
        ' alone")',
    )
    assert chromium.complaints == []
