"""The table of outputs."""

import pytest

from lagrange_casadi.quantities import QUANTITIES, quantity_of


@pytest.mark.parametrize(
    ("name", "key", "unit"),
    [
        ("motion:O", ("motion", ""), "rad"),
        ("motion:O_rate", ("motion", "rate"), "rad/s"),
        ("motion:O_acceleration", ("motion", "acceleration"), "rad/s^2"),
        ("effort:O", ("effort", ""), "N m"),
        ("reaction:law:fx", ("reaction", "fx"), "N"),
        ("section:rod:axial", ("section", "axial"), "N"),
        ("section:rod:law:m0", ("law", "m0"), "N m"),
        ("section:law:law:n1", ("law", "n1"), "m/s^2"),
        ("section:law:bending", ("section", "bending"), "N m"),
    ],
)
def test_every_name_has_one_row(name, key, unit):
    quantity = quantity_of(name)
    assert (quantity.group, quantity.member) == key
    assert quantity.unit_for("angle") == unit


def test_units_follow_the_coordinate():
    assert quantity_of("effort:P").unit_for("slide") == "N"
    assert quantity_of("motion:P_rate").unit_for("slide") == "m/s"


def test_the_table_is_complete():
    assert len({(q.group, q.member) for q in QUANTITIES}) == len(QUANTITIES)
    assert all(q.long_name and q.unit for q in QUANTITIES)


@pytest.mark.parametrize("name", ["torsion:rod", "section:rod:torsion", "reaction:O:fz"])
def test_other_names_are_refused(name):
    with pytest.raises(KeyError):
        quantity_of(name)
