"""Units as users write them, in base units."""

import math

import pytest
from internals import BASE, QUANTITIES, base_unit

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    ("text", "factor", "powers"),
    [
        ("1", 1.0, {}),
        ("N m", 1.0, {"kg": 1, "m": 2, "s": -2}),
        ("N*m", 1.0, {"kg": 1, "m": 2, "s": -2}),
        ("N.m", 1.0, {"kg": 1, "m": 2, "s": -2}),
        ("N m/rad", 1.0, {"kg": 1, "m": 2, "s": -2, "rad": -1}),
        ("kg m^2", 1.0, {"kg": 1, "m": 2}),
        ("kg m²", 1.0, {"kg": 1, "m": 2}),
        ("1/s^2", 1.0, {"s": -2}),
        ("m s^-2", 1.0, {"m": 1, "s": -2}),
        ("m/s/s", 1.0, {"m": 1, "s": -2}),
        ("rad/s", 1.0, {"rad": 1, "s": -1}),
        ("mm", 1e-3, {"m": 1}),
        ("mm**2", 1e-6, {"m": 2}),
        ("kN/mm", 1e6, {"kg": 1, "s": -2}),
        ("g/cm^3", 1e3, {"kg": 1, "m": -3}),
        ("bar", 1e5, {"kg": 1, "m": -1, "s": -2}),
        ("MPa", 1e6, {"kg": 1, "m": -1, "s": -2}),
        ("deg", math.pi / 180, {"rad": 1}),
        ("rpm", math.pi / 30, {"rad": 1, "s": -1}),
        ("min", 60.0, {"s": 1}),
        ("cd", 1.0, {"cd": 1}),
    ],
)
def test_units_are_read(text, factor, powers):
    unit = base_unit(text)
    assert unit.factor == pytest.approx(factor, rel=1e-15)
    assert {name: n for name, n in zip(BASE, unit.exponents, strict=True) if n} == powers


@pytest.mark.parametrize(
    "text",
    [
        "",
        "furlong",
        "N/m s",
        "degC",
        "m^",
        "m^0.5",
        "2 m",
        "m/",
        "/s",
        "kkg",
        "N-m",
        "(m)",
        "m^1^2",
    ],
)
def test_what_is_not_known_is_left_alone(text):
    assert base_unit(text) is None


@pytest.mark.parametrize("kind", ["angle", "slide"])
def test_every_unit_of_ours_is_known(kind):
    assert all(base_unit(quantity.unit_for(kind)) for quantity in QUANTITIES)
