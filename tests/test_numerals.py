"""What is a number, and what only Python takes for one."""

import math

import pytest

from lagrange_casadi.system.numerals import real, whole

pytestmark = pytest.mark.quick


def test_numbers_are_read():
    assert [real(text) for text in ("0.1", " 3e-1 ", "-inf", "+2")] == [0.1, 0.3, -math.inf, 2.0]
    assert math.isnan(real("nan"))
    assert [whole(text) for text in ("12", " -3 ")] == [12, -3]


@pytest.mark.parametrize("text", ["1_0", "0.1_5", "1e1_0", "x", "", "0x10"])
def test_what_is_no_number_is_refused(text):
    for read in (real, whole):
        with pytest.raises(ValueError, match=r"expected a number|could not convert|invalid literal"):
            read(text)
