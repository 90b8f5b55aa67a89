"""Grids and lists: a design is a number."""

import itertools
from decimal import Decimal

import numpy as np
import pytest
import sweeps
from hypothesis import given
from hypothesis import strategies as st
from internals import Grid, Range, Values, check_designs, counted, size_of
from internals import ListingListed as Listed

from lagrange_casadi.errors import DeclarationError, ParameterError, UnknownNameError

pytestmark = pytest.mark.quick

numbers = st.floats(-1e6, 1e6)


@given(numbers, st.floats(1e-3, 1e6), st.integers(2, 300))
def test_a_range_is_that_of_numpy_but_for_rounding(start, width, count):
    values = Range(start, start + width, count).at(np.arange(count))
    scale = max(abs(start), abs(start + width))
    np.testing.assert_allclose(
        values, np.linspace(start, start + width, count), rtol=0, atol=4e-16 * scale
    )
    assert values[0] == start
    assert values[-1] == start + width


@given(st.integers(-(10**6), 10**6), st.integers(1, 10**6), st.integers(2, 300), st.integers(0, 6))
def test_decimals_are_rounded_once(first, step, count, digits):
    """Against the decimals themselves, read one by one."""
    texts = [str(Decimal(first + k * step).scaleb(-digits)) for k in range(count)]
    found = Range(float(texts[0]), float(texts[-1]), count).at(np.arange(count))
    assert found.tolist() == [float(text) for text in texts]


def test_what_is_written_is_what_there_is():
    assert Range(0.2, 0.4, 3).at(np.arange(3)).tolist() == [0.2, 0.3, 0.4]
    assert Range(0.1, 0.7, 7).at(np.array([2, 5])).tolist() == [0.3, 0.6]
    assert Range(0, 1, 10**7).at(np.array([3, 10**7 - 1])).tolist() == [3 / (10**7 - 1), 1.0]


def test_equal_values_are_one_sweep_however_they_are_written():
    assert (
        Grid({"l": (0.2, 0.4, 3)}).describe()
        == Grid({"l": [0.2, 0.3, 0.4]}).describe()
        == {"l": "0.2:0.4:3"}
    )
    assert Grid({"l": [0.2, 0.4]}).describe() == {"l": "0.2:0.4:2"}
    for other in ([0.2, 0.31, 0.4], [0.4, 0.3, 0.2], [0.2, 0.30000000000000004, 0.4], [0.2]):
        assert Grid({"l": other}).describe() == {"l": ",".join(map(repr, other))}


@pytest.mark.parametrize(
    "designs",
    [
        Grid(
            {
                "l": (0.1, 0.4, 31),
                "r": [1.0, 2.0, 4.0],
                "m": np.arange(50.0) ** 2,
                "n": (1.0, 9.0, 7, True),
                "o": [2.0],
            }
        ),
        Listed(("l", "r"), np.zeros((12345, 2))),
        Listed(("l",), np.zeros((1, 1))),
    ],
)
def test_the_words_tell_how_many(designs):
    assert size_of(designs.describe()) == designs.size


def test_counts_in_words():
    assert [counted(n) for n in (0, 1, 2, 12345)] == [
        "0 designs",
        "1 design",
        "2 designs",
        "12 345 designs",
    ]


@given(st.floats(1e-6, 1e3), st.floats(1.5, 1e6), st.integers(2, 300))
def test_a_log_range_goes_in_equal_ratios(start, ratio, count):
    values = Range(start, start * ratio, count, log=True).at(np.arange(count))
    assert values[0] == start
    assert values[-1] == start * ratio
    np.testing.assert_allclose(values[1:] / values[:-1], ratio ** (1 / (count - 1)), rtol=1e-12)


@given(st.lists(st.integers(1, 5), min_size=1, max_size=4), st.data())
def test_any_block_is_that_part_of_the_product(lengths, data):
    axes = [Values(tuple(float(10**k * i) for i in range(n))) for k, n in enumerate(lengths, 1)]
    grid = Grid({f"p{k}": axis for k, axis in enumerate(axes)})
    product = np.array(list(itertools.product(*(axis.values for axis in axes))))
    start = data.draw(st.integers(0, grid.size - 1))
    stop = data.draw(st.integers(start + 1, grid.size))
    assert grid.size == len(product)
    np.testing.assert_array_equal(grid.block(start, stop), product[start:stop])


def test_a_grid_too_large_to_hold_is_no_matter():
    grid = Grid({"a": (0.0, 1.0, 10**9), "b": (0.0, 1.0, 10**9)})
    np.testing.assert_array_equal(grid.block(10**18 - 2, 10**18)[:, 0], [1.0, 1.0])
    np.testing.assert_allclose(grid.block(10**9 + 1, 10**9 + 2), [[1e-9, 1e-9]], rtol=1e-8)


def test_what_python_gives_becomes_axes():
    grid = Grid(
        {
            "a": (0.0, 1.0, 3),
            "b": [1.0, 2.0, 4.0],
            "c": np.array([3.0]),
            "d": 4.0,
            "e": (1.0, 2.0),
            "f": (1.0, 100.0, 3, True),
        }
    )
    assert grid.describe() == {
        "a": "0.0:1.0:3",
        "b": "1.0,2.0,4.0",
        "c": "3.0",
        "d": "4.0",
        "e": "1.0:2.0:2",
        "f": "1.0:100.0:3:log",
    }


def test_long_lists_are_told_apart_by_their_digest():
    one, two = (Values(tuple(np.arange(100.0) ** 2 + shift)) for shift in (0.0, 1e-12))
    assert str(one) != str(two)
    assert str(one) == str(Values(tuple(np.arange(100.0) ** 2)))
    assert str(one).startswith("100 values, SHA-256 ")


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (
            (0.4, 0.1, 5),
            "grid of l: STOP must be after START, got 0.4:0.1:5: the range is reversed",
        ),
        ((0.1, 0.4, 0), "grid of l: COUNT must be at least 1, got 0.1:0.4:0: the range is empty"),
        ((0.1, np.nan, 5), "grid of l: START and STOP must be finite, got 0.1:nan:5"),
        ((0.1, np.inf, 5), "START and STOP must be finite"),
        ((0.1, 0.4, 1), "COUNT be 2 or more"),
        ((0.1, 0.1, 2), "START and STOP must differ"),
        ((0.0, 0.4, 5, True), "a log range must begin above 0"),
        ((None, 0.4, 5), "expected numbers for START and STOP"),
        ([], "expected at least one value"),
        ([0.1, np.nan], "grid of l: expected finite values, got nan"),
        ([0.1, 0.2, 0.1], "the value 0.1 is listed twice"),
        ("abc", "grid of l: expected (start, stop, count) or numbers, got 'abc'"),
        ("1_0", "expected (start, stop, count) or numbers, got '1_0'"),
        (["0.1", "abc"], "expected (start, stop, count) or numbers, got ['0.1', 'abc']"),
        ([0.1, None, [2]], "expected (start, stop, count) or numbers, got [0.1, None, [2]]"),
        ((0.1, 0.4, 5, "lin"), "Range: log: expected True or False, got 'lin'"),
        ((0.1, 0.4, 5, 0.7), "Range: log: expected True or False, got 0.7"),
    ],
)
def test_what_is_no_axis_is_named(given, says):
    with pytest.raises(DeclarationError, match="grid of l: ") as caught:
        Grid({"l": given})
    assert says in str(caught.value)


def test_a_grid_needs_an_axis():
    with pytest.raises(DeclarationError, match="grid: expected at least one axis"):
        Grid({})
    for nothing in (None, 3):
        with pytest.raises(DeclarationError, match="Grid: axes: expected a mapping by name"):
            Grid(nothing)


def test_a_list_is_its_rows():
    listed = Listed(("l", "r"), [[0.2, 0.1], [0.3, 0.1], [0.4, 0.05]])
    np.testing.assert_array_equal(listed.block(1, 3), [[0.3, 0.1], [0.4, 0.05]])
    assert listed.dimensions == {"design": 3}
    assert listed.describe()["design"].startswith("3 designs of l, r, SHA-256 ")


@pytest.mark.parametrize(
    ("names", "rows", "says"),
    [
        (("l",), [[1.0, 2.0]], "expected values of shape"),
        (("l",), np.zeros((0, 1)), "expected values of shape"),
        (("l", "l"), [[1.0, 2.0]], "named twice"),
        (("l", "r"), [[1.0, 2.0], [1.0, np.nan]], "design 1: r must be finite, got nan"),
    ],
)
def test_what_is_no_list_is_named(names, rows, says):
    with pytest.raises(DeclarationError, match=says):
        Listed(names, rows)


def test_all_values_out_of_range_are_named_at_once():
    from conftest import CASES

    from lagrange_casadi import load_case

    mechanism = load_case(CASES / "slider_crank").scene.mechanism
    with pytest.raises(ParameterError) as caught:
        check_designs(
            Grid({"l": (-0.1, 0.4, 6), "r": [0.1, 0.2], "m1": [0.1, -1.0, -2.0]}),
            mechanism.parameters,
            {},
        )
    assert (
        str(caught.value)
        == "l = -0.1 to 0.4, out of its range [0, inf]; m1 = -1, -2, out of its range [0, inf]"
    )
    with pytest.raises(ParameterError) as caught:
        check_designs(
            Listed(("l", "r"), [[-1, 1], [1, 1], [1, -3]], np.array([2, 3, 5])),
            mechanism.parameters,
            {"m1": -4.0, "m2": 0.1},
        )
    told = (
        "l = -1 in line 2, out of its range [0, inf]; r = -3 in line 5, out of its range [0, inf];"
        " parameter 'm1' = -4 kg is "
    )
    assert str(caught.value) == f"{told}out of its range [0, inf]"
    with pytest.raises(ParameterError) as caught:
        check_designs(Grid({"l": [0.2]}), mechanism.parameters, {"r": -1.0, "m1": np.nan})
    told = (
        "parameter 'r' = -1 m is out of its range [0, inf]; parameter 'm1' must be a finite number,"
        " got nan"
    )
    assert str(caught.value) == told


def test_many_values_out_of_range_are_counted():
    assert Values(tuple(-np.arange(1.0, 31.0))).outside(0.0, 1.0).endswith("-20 and 10 more")


def test_names_are_checked():
    mechanism = sweeps.scene().mechanism
    with pytest.raises(UnknownNameError, match=r"unknown parameter 'q'; valid: r, l, m1, m2, m3"):
        check_designs(Grid({"q": [1.0]}), mechanism.parameters, {})
    with pytest.raises(
        UnknownNameError, match=r"unknown parameters 'q', 'k', 'x'; valid: r, l, m1, m2, m3"
    ):
        check_designs(
            Grid({"q": [1.0], "l": [1.0], "k": [1.0]}), mechanism.parameters, {"x": 1.0, "r": 0.1}
        )
    with pytest.raises(DeclarationError, match=r"parameter 'l' is swept and set to 0\.3 as well"):
        check_designs(Grid({"l": [1.0]}), mechanism.parameters, {"l": 0.3})
    with pytest.raises(
        DeclarationError,
        match=r"'design' is a result of a sweep, not a parameter: take the results out",
    ):
        check_designs(Listed(("design", "l"), [[0.0, 1.0]]), mechanism.parameters, {})
