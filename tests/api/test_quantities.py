"""The table of outputs."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import PLANE, QUANTITIES, SPACE, SPATIAL_QUANTITIES, Output

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
    quantity = Output.of(name).meant(PLANE)
    assert (quantity.group, quantity.member) == key
    assert quantity.unit_for("angle") == unit


def test_units_follow_the_coordinate():
    assert Output.of("effort:P").meant(PLANE).unit_for("slide") == "N"
    assert Output.of("motion:P_rate").meant(PLANE).unit_for("slide") == "m/s"


def test_the_table_is_complete():
    assert len({(q.group, q.member) for q in QUANTITIES}) == len(QUANTITIES)
    assert all(q.long_name and q.unit for q in QUANTITIES)


@pytest.mark.parametrize(
    "name", ["torsion:rod", "section:rod:torsion", "reaction:O:fz", "reaction:O"]
)
def test_other_names_are_refused(name):
    with pytest.raises(KeyError):
        Output.of(name).meant(PLANE)


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


NAMES = st.from_regex(
    r"[A-Za-z]\w{0,3}(_rate|_acceleration|_coordinate)?",
    fullmatch=True,
    alphabet=st.characters(codec="ascii"),
)


def drawn(part, station, power, quantity):
    """An output of a quantity; what acts at a place, or along a link, has a name of its own, and
    the latter has powers.
    """
    spread = quantity.group == "spread"
    return Output(
        quantity.group,
        part if quantity.group != "certificate" else "",
        quantity.member,
        station if spread or quantity.group == "station" else "",
        power if spread and quantity.member not in ("width", "end") else None,
    )


@given(
    NAMES | st.just("law"), NAMES | st.just("law"), st.integers(0, 12), st.sampled_from(QUANTITIES)
)
def test_no_two_outputs_have_one_name(part, station, power, quantity):
    output = drawn(part, station, power, quantity)
    assert Output.of(str(output)) == output
    assert output.quantity is quantity


@given(
    NAMES | st.just("law"),
    NAMES | st.just("law"),
    st.integers(0, 12),
    st.sampled_from(SPATIAL_QUANTITIES),
)
def test_no_two_outputs_have_one_name_in_space(part, station, power, quantity):
    output = drawn(part, station, power, quantity)
    assert Output.of(str(output)) == output
    assert output.meant(SPACE) is quantity


def test_axes_and_units_are_the_same_in_the_plane_and_in_space():
    """What differs is what a name means."""
    keys = [(q.group, q.member) for q in SPATIAL_QUANTITIES]
    assert len(set(keys)) == len(keys)
    shared = [q for q in QUANTITIES if (q.group, q.member) in keys]
    assert len(shared) > 20
    for q in shared:
        other = SPACE.row(q.group, q.member)
        assert (other.axes, other.unit) == (q.axes, q.unit)
    assert (
        SPACE.row("section", "shear").sign == "never negative" != PLANE.row("section", "shear").sign
    )


@pytest.mark.parametrize("table", [PLANE, SPACE])
def test_every_section_force_is_made_of_members_that_there_are(table):
    components = [force for force in table.forces if table.parts("section", force) == (force,)]
    assert set(components) == set(table.sections)
    for force in table.forces:
        assert set(table.parts("section", force)) <= set(table.sections)
    used = {name for terms in table.sections.values() for name in terms.coefficients}
    assert used == set(table.law)
    assert {terms.acting for terms in table.sections.values()} == {*table.load_point} - {"station"}
    for terms in table.sections.values():
        if terms.arm:
            assert table.sections[terms.shear].coefficients == terms.coefficients[1:]
    assert set(table.place_first) == set(table.load_point)


@pytest.mark.parametrize(
    ("output", "table", "components"),
    [
        (Output("reaction", "A", "resultant"), PLANE, ("fx", "fy")),
        (Output("reaction", "A", "resultant"), SPACE, ("fx", "fy", "fz")),
        (Output("reaction", "A", "moment"), SPACE, ("mx", "my", "mz")),
        (Output("section", "rod", "bending"), SPACE, ("bending_y", "bending_z")),
        (Output("section", "rod", "bending"), PLANE, ("bending",)),
        (Output("section", "rod", "torsion"), SPACE, ("torsion",)),
    ],
)
def test_of_what_resultants_are_the_size(output, table, components):
    assert tuple(component.member for component in output.components(table)) == components
    assert {component.part for component in output.components(table)} == {output.part}


@pytest.mark.parametrize(
    "name",
    ["section:rod:law:mx0", "section:law:law:fz2", "section:rod:A:mz", "section:rod:bending_y"],
)
def test_names_of_space_are_none_of_the_plane(name):
    assert str(Output.of(name)) == name
    assert Output.of(name).meant(SPACE).unit
    with pytest.raises(KeyError):
        Output.of(name).meant(PLANE)
