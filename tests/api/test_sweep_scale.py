"""Scales and words of a sweep's figures."""

import numpy as np
import pytest
from internals import ScaleScale as Scale
from internals import edges, fitted, logarithmic, tick
from internals import scale_number as number
from matplotlib import colors
from matplotlib.figure import Figure

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (np.linspace(1.0, 2.0, 50), (1.0, 2.0, False, False, False)),
        (np.append(np.linspace(1.0, 2.0, 99), 50.0), (1.0, None, False, False, True)),
        (np.geomspace(1.0, 1e4, 50), (1.0, 1e4, True, False, False)),
        (np.append(np.geomspace(1.0, 1e4, 99), [0.0]), (None, 1e4, True, True, False)),
        (np.append(np.geomspace(1.0, 1e4, 99), [-1.0]), (-1.0, 1e4, False, False, False)),
        (np.append(np.geomspace(1.0, 1e4, 99), [1e12]), (1.0, None, True, False, True)),
        (np.append(np.linspace(1.0, 2.0, 8), 50.0), (1.0, None, False, False, True)),
        (2.0 ** np.arange(5), (1.0, 16.0, False, False, False)),
        (np.array([1.0, 2.0, 1e3]), (1.0, 1e3, True, False, False)),
        (np.array([np.nan, 3.0]), (2.85, 3.15, False, False, False)),
        (np.zeros(3), (-1.0, 1.0, False, False, False)),
        (
            np.append(np.geomspace(10.0, 60.0, 94), np.geomspace(100.0, 900.0, 6)),
            (10.0, 900.0, True, False, False),
        ),
        (np.linspace(0.01, 1.0, 50) ** 2, (1e-4, 1.0, False, False, False)),
        (np.append(np.ones(99), 7.0), (1.0, 7.0, False, False, False)),
    ],
)
def test_limits(values, expected):
    scale = Scale.of(values)
    low, high, *rest = expected
    assert [scale.log, scale.below, scale.above] == rest
    assert scale.low == pytest.approx(low) if low is not None else scale.low > np.nanmin(values)
    assert (
        scale.high == pytest.approx(high)
        if high is not None
        else np.sort(values)[-2] <= scale.high < values.max()
    )
    assert isinstance(scale.norm(), colors.LogNorm) == scale.log


@pytest.mark.parametrize("held", [0.0, -1.0])
def test_an_axis_that_holds_what_is_not_positive_is_linear(held):
    axes = Figure().subplots()
    Scale.of(np.append(np.geomspace(1.0, 1e4, 99), 0.0)).limit(axes, "x", [held, 5.0])
    assert axes.get_xscale() == "linear"
    assert axes.get_xlim()[0] < held < 1e4 <= axes.get_xlim()[1]


def test_signed_limits_keep_zero_in_the_middle():
    for sizes in (np.linspace(1.0, 2.0, 50), np.geomspace(1.0, 1e4, 50)):
        assert Scale.of(sizes, sides=1).norm()(
            np.array([0.0, sizes.max()])
        ).tolist() == pytest.approx([0.0, 1.0])
        norm = Scale.of(sizes, sides=2).norm()
        assert norm(0.0) == pytest.approx(0.5)
        assert norm(sizes.max()) == pytest.approx(1.0)
        assert norm(-sizes.max()) == pytest.approx(0.0)
    assert norm(100.0) > 0.7, "a hundredth of the largest is seen"


@pytest.mark.parametrize("far", [25.0, 1e3, 1e5])
def test_signed_values_are_seen_beside_a_few_far_ones(far):
    """Whether these set the limits or lie beyond them, and though forces
    vanish at a link's ends.
    """
    along = np.sin(np.pi * np.linspace(0.0, 1.0, 11)) * np.sign(np.linspace(-1.0, 1.0, 11))
    values = np.outer([1.0, 1.3, 1.7, 2.2, 3.0, 4.0, 6.0, 10.0, far], along)
    scale = Scale.of(values, sides=2)
    low, middle, high = scale.norm()(np.array([-1.0, 0.0, 1.0]))
    assert (low, middle) == pytest.approx((1.0 - high, 0.5))
    assert high > 0.58
    assert scale.extend == ("both" if scale.high < np.abs(values).max() else "neither")


@pytest.mark.parametrize(
    ("axis", "inches", "shown"),
    [("x", 6.0, "0.05 0.0625 0.1 0.5"), ("x", 1.5, "0.05 0.1 0.5"), ("y", 1.0, "0.05 0.1 0.5")],
)
def test_ticks_at_values(axis, inches, shown):
    """All are ticked, and numbered where there is room."""
    axes = Figure().subplots()
    values = np.array([0.05, 0.0625, 0.1, 0.5])
    axes.set(xscale="log", yscale="log", xlim=(0.04, 0.6), ylim=(0.04, 0.6))
    tick(getattr(axes, f"{axis}axis"), values, inches)
    ticks = getattr(axes, f"{axis}axis")
    np.testing.assert_array_equal(ticks.get_majorticklocs(), values)
    assert ticks.get_minorticklocs().size == 0
    assert [text.get_text() for text in ticks.get_ticklabels() if text.get_text()] == shown.split()


def test_axes_even_in_ratios_are_logarithmic():
    assert logarithmic(np.geomspace(0.01, 1.0, 7))
    assert logarithmic(np.array([0.1, 1.0, 20.0]))
    assert not logarithmic(np.linspace(0.01, 1.0, 7))
    assert not logarithmic(np.array([0.1, 0.2, 0.4]))
    assert not logarithmic(np.array([-1.0, 0.0, 10.0]))
    np.testing.assert_allclose(
        edges(np.array([1.0, 10.0, 100.0]), True), 10.0 ** np.array([-0.5, 0.5, 1.5, 2.5])
    )
    np.testing.assert_allclose(edges(np.array([0.1, 0.2, 0.5]), False), [0.05, 0.15, 0.35, 0.65])


def test_words():
    assert [number(x) for x in (0.0, 0.12345, 146.4, 22619.47, 451148.0, 1e5, -1e-4)] == [
        "0", "0.123", "146", "22619", "4.51·10⁵", "10⁵", "\N{MINUS SIGN}10⁻⁴"
    ]  # fmt: skip
    text = fitted(1.0, "effort of_a_bearing, |peak| [N m]", "", "beyond: up to 3")
    assert max(map(len, text.split("\n"))) <= 16
    assert "[N\N{NO-BREAK SPACE}m]" in text
    assert "\n\n" not in text
    assert (
        text.replace("\n", "").replace("\N{NO-BREAK SPACE}", "").replace(" ", "")
        == "effortof_a_bearing,|peak|[Nm]beyond:upto3"
    )
