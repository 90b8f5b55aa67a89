"""The table of outputs."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lagrange_casadi.quantities import QUANTITIES, Output, quantity_of

pytestmark = pytest.mark.quick


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


@pytest.mark.parametrize("name", ["torsion:rod", "section:rod:torsion", "reaction:O:fz", "reaction:O"])
def test_other_names_are_refused(name):
    with pytest.raises(KeyError):
        quantity_of(name)


@pytest.mark.parametrize(
    ("output", "name"),
    [
        (Output("motion", "O"), "motion:O"),
        (Output("motion", "O", "rate"), "motion:O_rate"),
        (Output("motion", "O_rate"), "motion:O_rate.coordinate"),
        (Output("motion", "O_rate", "rate"), "motion:O_rate_rate"),
        (Output("motion", "O_acceleration"), "motion:O_acceleration.coordinate"),
        (Output("effort", "O_rate"), "effort:O_rate"),
        (Output("section", "law", "bending"), "section:law:bending"),
        (Output("law", "rod", "n0"), "section:rod:law:n0"),
        (Output("station", "rod", "n", "law"), "section:rod:law:n"),
        (Output("station", "rod", "station", "A"), "section:rod:A:station"),
        (Output("reaction", "A", "resultant"), "reaction:A:resultant"),
        (Output("certificate", "", "balance"), "certificate:balance"),
    ],
)
def test_an_output_and_its_name_are_one(output, name):
    assert str(output) == name
    assert Output.of(name) == output


NAMES = st.from_regex(r"[A-Za-z]\w{0,3}(_rate|_acceleration|_coordinate)?", fullmatch=True, alphabet=st.characters(codec="ascii"))


@given(part=NAMES | st.just("law"), station=NAMES | st.just("law"), quantity=st.sampled_from(QUANTITIES))
def test_no_two_outputs_have_one_name(part, station, quantity):
    of_station, of_part = quantity.group == "station", quantity.group != "certificate"
    output = Output(quantity.group, part if of_part else "", quantity.member, station if of_station else "")
    assert Output.of(str(output)) == output
    assert output.quantity is quantity
