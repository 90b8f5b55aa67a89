"""What a page tells of strength: how far every part is used, and the series that were wanted."""

import math

import pytest
from mechanisms import slider_crank
from strong import slider

from lagrange_casadi import evaluate
from lagrange_casadi.report.contents import contents


@pytest.fixture(scope="module")
def solution():
    scene = slider(200e6)
    return evaluate(scene, wanted=["stress:rod", "safety", "motion", "effort"], certificate=False)


def test_every_way_to_fail_has_a_row(solution):
    rows = contents(solution)["strength"]
    assert [(row["part"], row["against"]) for row in rows] == [
        (part, way) for part in ("crank", "rod") for way in ("yield", "buckling", "fatigue")
    ]
    for row in rows:
        factor = solution.safety(row["part"]).against(row["against"])
        assert row["used"] == 1.0 / factor
        assert row["factor"] == (None if math.isinf(factor) else factor)
    assert [row["against"] for row in rows if row["governs"]] == [
        solution.safety(link).governs.against for link in ("crank", "rod")
    ]


def test_series_of_strength_are_charted(solution):
    told = {series["name"]: series["unit"] for series in contents(solution)["series"]}
    assert told["stress:rod:von_mises"] == "Pa"
    assert told["utilisation:crank:yield"] == "1"


def test_a_page_of_what_has_no_beam_has_no_rows():
    assert contents(evaluate(slider_crank(), certificate=False))["strength"] == []
