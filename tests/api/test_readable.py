"""Units that a person reads, in figures as in the pages of reports."""

import re
from importlib import resources

import pytest
from internals import PREFIXED, STEPS, scale_for
from internals import ReadableScale as Scale

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    ("unit", "size", "factor", "told"),
    [
        ("N", 999.0, 1.0, "N"),
        ("N", 1000.0, 1e-3, "kN"),
        ("N m", 2.5e6, 1e-6, "MN m"),
        ("Pa", 3e8, 1e-6, "MPa"),
        ("N m", 0.02, 1e3, "mN m"),
        ("N", 3e-7, 1e6, "µN"),
        ("m", 0.5, 1e3, "mm"),
        ("m", 1.0, 1.0, "m"),
        ("m", 2e-5, 1e6, "µm"),
        ("rad", 4.0, 1.0, "rad"),
        ("m/s^2", 4e5, 1.0, "m/s^2"),
        ("N", 0.0, 1.0, "N"),
        ("N", float("nan"), 1.0, "N"),
    ],
)
def test_a_unit_goes_with_the_largest_value(unit, size, factor, told):
    assert scale_for(unit, size) == Scale(factor, told)
    assert scale_for(unit, size, si=True) == Scale(1.0, unit)


def test_pages_take_the_same_steps():
    text = (
        resources.files("lagrange_casadi.report")
        .joinpath("assets/units.js")
        .read_text(encoding="utf-8")
    )
    steps = re.findall(r'^  \[([\d.e-]+), "(.*)", ([\d.e-]+)\],$', text, re.MULTILINE)
    assert tuple((float(least), prefix, float(factor)) for least, prefix, factor in steps) == STEPS
    assert (
        tuple(re.findall(r'"([^"]+)"', re.search(r"PREFIXED = new Set\(\[(.*)\]\)", text)[1]))
        == PREFIXED
    )


def test_numbers_are_told_without_what_rounding_leaves():
    assert Scale(1e3, "mm").label(0.15000000000000002) == "150"
    assert Scale(1e3, "mm").label(-0.05) == "\N{MINUS SIGN}50"
    assert Scale(1e-3, "kN").label(-0.0) == "0"
    assert Scale(1e-3, "kN").said(-1234.56) == "-1.235 kN"
