"""What a message says of a name that nothing bears, in no more words than can be read."""

import pytest

from lagrange_casadi.errors import UnknownNameError

pytestmark = pytest.mark.quick

MANY = [f"reaction:joint_{k}" for k in range(100)]


@pytest.mark.parametrize(
    ("name", "valid", "says"),
    [
        (
            "crnk",
            ["crank", "rod"],
            "unknown link 'crnk' (did you mean 'crank'?); valid: crank, rod",
        ),
        ("q", ["crank", "rod"], "unknown link 'q'; valid: crank, rod"),
        ("q", [], "unknown link 'q'; valid: none are declared"),
    ],
)
def test_a_few_names_are_listed(name, valid, says):
    assert str(UnknownNameError("link", name, valid)) == says
    assert str(UnknownNameError("link", name, valid, "`info`")) == says


def test_several_names_are_told_at_once():
    told = str(UnknownNameError("link", ["crnk", "q"], ["crank", "rod"], place="a.csv, line 1"))
    assert (
        told
        == "a.csv, line 1: unknown links 'crnk' (did you mean 'crank'?), 'q'; valid: crank, rod"
    )
    told = str(UnknownNameError("output", ["joint_4", "q", "joint_4"], MANY, "`info`"))
    assert (
        told
        == "unknown outputs 'joint_4' (did you mean 'reaction:joint_4'?), 'q'; `info` lists the 100"
        " there are"
    )


def test_of_many_names_the_nearest_is_told():
    told = str(UnknownNameError("output", "reaction:joint_999", MANY))
    assert told.startswith(
        "unknown output 'reaction:joint_999' (did you mean 'reaction:joint_99'?); valid:"
        " reaction:joint_0, "
    )
    assert told.endswith(", reaction:joint_14 and 85 more")
    told = str(UnknownNameError("output", "joint_4", MANY, "`info`"))
    assert (
        told == "unknown output 'joint_4' (did you mean 'reaction:joint_4'?); `info` lists the 100"
        " there are"
    )
    assert (
        str(UnknownNameError("output", "", MANY, "`info`"))
        == "unknown output ''; `info` lists the 100 there are"
    )
