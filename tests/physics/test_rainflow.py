"""Rainflow counting: the standard's own example, two public libraries, and identities."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from internals import rainflow, reversals

from lagrange_casadi.errors import DeclarationError

pytestmark = pytest.mark.quick

FIGURE_6 = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]
"""ASTM E1049-85, figure 6: the history of its rainflow example."""

# rainflow 3.2.0 of PyPI, extract_cycles of figure 6: range, mean, count, indices; counts by range
# are the standard's.
PUBLISHED = [(3, -0.5, 0.5, 0, 1), (4, -1.0, 0.5, 1, 2), (4, 1.0, 1.0, 4, 5), (8, 1.0, 0.5, 2, 3),
    (9, 0.5, 0.5, 3, 6),
             (8, 0.0, 0.5, 6, 7), (6, 1.0, 0.5, 7, 8)]  # fmt: skip

HISTORIES = st.lists(st.integers(-9, 9), min_size=1, max_size=40)


def test_the_example_of_the_standard():
    assert [tuple(swing) for swing in rainflow(FIGURE_6)] == PUBLISHED


@given(HISTORIES, st.integers(0, 40))
def test_where_a_repeating_history_begins_is_the_same(history, shift):
    turned = history[shift % len(history) :] + history[: shift % len(history)]
    first, second = (
        sorted((s.size, s.mean) for s in rainflow(h, repeating=True)) for h in (history, turned)
    )
    assert [size for size, _ in first] == [size for size, _ in second]


@given(HISTORIES)
def test_swings_are_where_they_are_said_to_be(history):
    for repeating in (False, True):
        for swing in rainflow(history, repeating=repeating):
            a, b = history[swing.first], history[swing.last]
            assert (swing.size, swing.mean) == (abs(a - b), (a + b) / 2)


@given(HISTORIES)
def test_every_reversal_is_used_once(history):
    """The sizes of all swings add up to half of the way that the history goes up and down."""
    way = float(np.abs(np.diff(history)).sum())
    assert sum(s.size * s.times for s in rainflow(history)) == pytest.approx(way / 2)
    closed = way + abs(history[0] - history[-1])
    assert sum(s.size * s.times for s in rainflow(history, repeating=True)) == pytest.approx(
        closed / 2
    )


def test_a_public_library_counts_the_same():
    library = pytest.importorskip("rainflow")
    draw = np.random.default_rng(3)
    for _ in range(50):
        history = draw.normal(size=200)
        expected = [tuple(map(float, cycle)) for cycle in library.extract_cycles(history)]
        np.testing.assert_allclose(
            np.array([tuple(s) for s in rainflow(history)]), np.array(expected), rtol=0, atol=1e-12
        )


def test_another_library_counts_the_same_of_what_repeats():
    library = pytest.importorskip("fatpack")
    draw = np.random.default_rng(4)
    for _ in range(50):
        history = draw.normal(size=200)
        start = int(np.argmax(history))
        closed = np.append(np.roll(history, -start), history[start])
        cycles, residue = library.find_rainflow_cycles(closed[reversals(closed)])
        expected = sorted(
            [*np.abs(np.diff(cycles, axis=1)).ravel().tolist(), float(np.ptp(residue))]
        )
        np.testing.assert_allclose(
            sorted(s.size for s in rainflow(history, repeating=True)), expected, rtol=0, atol=1e-12
        )


@pytest.mark.parametrize("history", [[], [[1, 2]], [1.0, math.nan], [1.0, math.inf]])
def test_what_is_no_history(history):
    with pytest.raises(DeclarationError, match="expected a row of finite numbers"):
        rainflow(history)


def test_a_constant_has_no_swing():
    assert rainflow([2.0, 2.0, 2.0]) == rainflow([2.0], repeating=True) == []
