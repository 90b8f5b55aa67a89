"""What is said of curves between equal steps: bounds that hold, and where something may hide."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from internals import (
    SEVEN,
    Kind,
    Watch,
    bounds,
    highest,
    passed,
    passed_or_touched,
    stretch,
    unresolved,
    vertices,
    where,
    window,
)

pytestmark = pytest.mark.quick

numbers = st.floats(-3, 3, allow_nan=False)


@settings(max_examples=200, deadline=None)
@example(1.0, 0.03125, 1.0, 0.0, 0.5)
@given(numbers, numbers, numbers, st.floats(0, 12), st.floats(0.0, 0.6))
def test_no_smooth_curve_is_above_its_bound(a, b, c, start, step):
    """Of waves that turn less than 0.6 rad in a step."""

    def curve(x):
        return a * np.sin(x) + b * np.cos(x / 2) + c * x

    places = start + step * np.arange(12)
    bound = highest(curve(places))
    for k in range(11):
        inside = curve(np.linspace(places[k], places[k + 1], 101))
        assert inside.max() <= bound[k] + 1e-12 * (1 + np.abs(inside).max())


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 10), st.floats(0.01, 0.99), numbers, numbers)
def test_no_kink_is_above_its_bound(step, share, before, after):
    """A polygon with one corner, anywhere."""
    at = step + share

    def curve(x):
        return np.where(x < at, before * (x - at), after * (x - at))

    bound = highest(curve(np.arange(12.0)))
    assert bound[step] >= -1e-12


any_number = st.sampled_from([-np.inf, -1.0, 0.0, 0.5, 1.0, np.inf, np.nan]) | numbers


@given(st.lists(st.sampled_from([-1.0, 0.0, 0.5, 1.0]) | numbers, max_size=6), *[any_number] * 4)
def test_many_numbers_are_passed_and_touched_as_each_alone(at, a, b, low, high):
    passing = [(a > x) != (b > x) for x in at]
    touched = [
        not gone and (low < x if a > x and b > x else high > x)
        for x, gone in zip(at, passing, strict=True)
    ]
    ends = (np.array([end]) for end in (a, b, low, high))
    assert [int(count[0]) for count in passed_or_touched(np.sort(at), *ends)] == [
        sum(passing),
        sum(touched),
    ]


def told(row, watch, step=0.1):
    return np.flatnonzero(unresolved(np.array([row], float), [watch], step)[0]).tolist()


@pytest.mark.parametrize(
    ("row", "watch", "found"),
    [
        (np.full(9, 2.9), Watch(Kind.RATE), []),
        (np.full(9, -3.1), Watch(Kind.RATE), list(range(8))),
        (np.arange(9) * 0.2, Watch(Kind.TURN), []),
        (np.arange(9) * 0.2 + 6.283185307179586 * (np.arange(9) > 4), Watch(Kind.TURN), []),
        (np.arange(9) - 4.5, Watch(Kind.POLE), [4]),
        ((np.arange(9) - 4.5) ** 2 + 1e-3, Watch(Kind.POLE), [4]),
        (np.arange(9) + 20.0, Watch(Kind.POLE), []),
        (np.arange(9.0), Watch(Kind.SWITCH, (4.5,)), []),
        (np.arange(9.0), Watch(Kind.SWITCH, (4.3, 4.6)), [4]),
        (np.arange(9.0), Watch(Kind.SWITCH, (4.5, 5.5)), [4, 5]),
        (np.arange(9.0) * 0.3 + 0.05, Watch(Kind.STEP), []),
        (np.arange(9.0) * 2.1, Watch(Kind.STEP), list(range(8))),
        (1 - 0.1 * (8 - np.arange(9)) - 1e-4 * (8 - np.arange(9)) ** 2, Watch(Kind.STEP), []),
        (1.01 - 0.1 * (7.5 - np.arange(9)) ** 2, Watch(Kind.STEP), [7]),
        (np.arange(9) * 0.1, Watch(Kind.POWER), []),
        (-((np.arange(9) - 4.5) ** 2) * 10, Watch(Kind.POWER), [4]),
    ],
)
def test_where_something_may_hide(row, watch, found):
    assert set(found) <= set(told(row, watch))
    assert bool(found) == bool(told(row, watch))


def test_a_polynomial_of_degree_six_is_found_exactly():
    """Its summit, its curve there, and that it misses nothing."""
    law = np.polynomial.Polynomial([0.3, 0.2, -1.0, 0.04, -0.05, 0.01, -0.002])
    x = next(float(r.real) for r in law.deriv().roots() if abs(r.imag) < 1e-12 and abs(r.real) < 1)
    fit = vertices(law(np.arange(-3.0, 4.0))[:, None], np.zeros(1), -np.ones(1), np.ones(1))
    assert fit.x[0] == pytest.approx(x, abs=1e-9)
    assert fit.size[0] == pytest.approx(law(x), rel=1e-14)
    assert fit.curve[0] == pytest.approx(law.deriv(2)(x), rel=1e-9)


@pytest.mark.parametrize("count", [7, 8, 40])
def test_windows_stay_among_the_values(count):
    for at in range(count):
        first = window(at, count)
        start, low, high = bounds(at, count)
        assert 0 <= first <= count - SEVEN
        assert first + SEVEN // 2 + start == at
        assert (low > start) == (at == 0)
        assert (high < start) == (at == count - 1)


def test_what_passes_just_one_number_is_told_first_by_whole_numbers():
    rows = np.array([np.arange(9.0), np.arange(9) * 0.3 + 0.05])
    watches = [Watch(Kind.SWITCH, (4.5, 7.5)), Watch(Kind.STEP)]
    assert list(passed(rows, watches, 4, 1.0)) == [(0, 4.5)]
    assert list(passed(rows, watches, 3, 1.0)) == [(1, 1.0)]
    assert list(passed(rows, watches, 5, 1.0)) == []
    pole = np.arange(9) - 4.4
    assert list(passed(np.vstack([rows, pole]), [*watches, Watch(Kind.POLE)], 4, 1.0)) == []


@settings(max_examples=100, deadline=None)
@given(st.floats(-0.02, 0.02), st.integers(0, 10), st.floats(0.01, 0.99))
def test_where_a_row_passes_a_number_is_found(curve, step, share):
    def law(x):
        return x + curve * x * x

    places = np.arange(12.0)
    assert where(law(places), step, law(step + share)) == pytest.approx(share, abs=1e-4)


@settings(max_examples=100, deadline=None)
@given(st.lists(numbers, min_size=7, max_size=7))
def test_an_end_step_of_a_polynomial_of_degree_six_is_told_exactly(coefficients):
    law = np.polynomial.Polynomial(coefficients)
    middle, least = stretch(law(np.arange(0.0, 7.0))[:, None])
    slopes = law.deriv()(np.array([0.0, 0.5, 1.0]))
    scale = 1e-9 * (1 + np.abs(law(np.arange(7.0))).max())
    assert middle[0] == pytest.approx(law(0.5), abs=scale)
    straight = abs(np.sign(slopes).sum()) == 3
    assert least[0] == pytest.approx(np.abs(slopes).min() if straight else 0.0, abs=scale)
