"""Scales and words of a sweep's figures."""

import numpy as np
import pytest
from matplotlib import colors

from lagrange_casadi.sweep.panels import fitted
from lagrange_casadi.sweep.scale import Scale, edges, logarithmic, number


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (np.linspace(1.0, 2.0, 50), (1.0, 2.0, False, False, False)),
        (np.append(np.linspace(1.0, 2.0, 99), 50.0), (1.0, None, False, False, True)),
        (np.geomspace(1.0, 1e4, 50), (1.0, 1e4, True, False, False)),
        (np.append(np.geomspace(1.0, 1e4, 99), [0.0]), (None, 1e4, True, True, False)),
        (np.append(np.geomspace(1.0, 1e4, 99), [1e12]), (1.0, None, True, False, True)),
        (np.append(np.linspace(1.0, 2.0, 8), 50.0), (1.0, None, False, False, True)),
        (2.0 ** np.arange(5), (1.0, 16.0, False, False, False)),
        (np.array([1.0, 2.0, 1e3]), (1.0, 1e3, True, False, False)),
        (np.array([np.nan, 3.0]), (2.85, 3.15, False, False, False)),
        (np.zeros(3), (-1.0, 1.0, False, False, False)),
        (np.append(np.ones(99), 7.0), (1.0, 7.0, False, False, False)),
    ],
)
def test_limits(values, expected):
    scale = Scale.of(values)
    low, high, *rest = expected
    assert [scale.log, scale.below, scale.above] == rest
    assert scale.low == pytest.approx(low) if low is not None else scale.low > np.nanmin(values)
    assert scale.high == pytest.approx(high) if high is not None else np.sort(values)[-2] <= scale.high < values.max()
    assert isinstance(scale.norm(), colors.LogNorm) == scale.log


def test_signed_limits_keep_zero_in_the_middle():
    for sizes in (np.linspace(1.0, 2.0, 50), np.geomspace(1.0, 1e4, 50)):
        assert Scale.of(sizes, sides=1).norm()(np.array([0.0, sizes.max()])).tolist() == pytest.approx([0.0, 1.0])
        norm = Scale.of(sizes, sides=2).norm()
        assert norm(0.0) == pytest.approx(0.5)
        assert norm(sizes.max()) == pytest.approx(1.0)
        assert norm(-sizes.max()) == pytest.approx(0.0)
    assert norm(100.0) > 0.7, "a hundredth of the largest is seen"


def test_axes_even_in_ratios_are_logarithmic():
    assert logarithmic(np.geomspace(0.01, 1.0, 7))
    assert logarithmic(np.array([0.1, 1.0, 20.0]))
    assert not logarithmic(np.linspace(0.01, 1.0, 7))
    assert not logarithmic(np.array([0.1, 0.2, 0.4]))
    assert not logarithmic(np.array([-1.0, 0.0, 10.0]))
    np.testing.assert_allclose(edges(np.array([1.0, 10.0, 100.0]), True), 10.0 ** np.array([-0.5, 0.5, 1.5, 2.5]))
    np.testing.assert_allclose(edges(np.array([0.1, 0.2, 0.5]), False), [0.05, 0.15, 0.35, 0.65])


def test_words():
    assert [number(x) for x in (0.0, 0.12345, 146.4, 22619.47, 451148.0, 1e5, -1e-4)] == [
        "0", "0.123", "146", "22619", "4.51·10⁵", "10⁵", "\N{MINUS SIGN}10⁻⁴"
    ]  # fmt: skip
    text = fitted(1.0, "effort of_a_bearing, |peak| [N m]", "", "beyond: up to 3")
    assert max(map(len, text.split("\n"))) <= 16
    assert "[N\N{NO-BREAK SPACE}m]" in text
    assert "\n\n" not in text
    assert text.replace("\n", "").replace("\N{NO-BREAK SPACE}", "").replace(" ", "") == "effortof_a_bearing,|peak|[Nm]beyond:upto3"
