"""What is a number, and what only Python takes for one."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import numerals_readable as readable
from internals import real, whole

pytestmark = pytest.mark.quick


def test_numbers_are_read():
    assert [real(text) for text in ("0.1", " 3e-1 ", "-inf", "+2")] == [0.1, 0.3, -math.inf, 2.0]
    assert math.isnan(real("nan"))
    assert [whole(text) for text in ("12", " -3 ")] == [12, -3]


@pytest.mark.parametrize(
    "text", ["1_0", "0.1_5", "1e1_0", "x", "", "0x10", "\u0663", "\uff11", "1\u0662"]
)
def test_what_is_no_number_is_refused(text):
    for read in (real, whole):
        with pytest.raises(
            ValueError, match=r"expected a number|could not convert|invalid literal"
        ):
            read(text)


@given(
    st.floats(allow_nan=False, allow_infinity=False),
    st.floats(allow_nan=False, allow_infinity=False),
)
def test_two_numbers_are_told_apart(one, other):
    """As few digits as tell them apart: a number out of its range does not read as its end."""
    if one != other:
        assert readable(one, other) != readable(other, one)
    assert readable(one) == f"{one + 0.0:.6g}"


@pytest.mark.parametrize(
    ("value", "others", "text"),
    [
        (0.1, (), "0.1"),
        (1 / 3, (), "0.333333"),
        (-0.0, (), "0"),
        (0.3 + 1e-9, (0.3,), "0.300000001"),
        (0.5, (0.5,), "0.5"),
    ],
)
def test_numbers_are_written_for_readers(value, others, text):
    assert readable(value, *others) == text
