"""Figures of a sweep: each draws what it says, from the file's arrays, and
says what it leaves out.
"""

import numpy as np
import plotted
import pytest
from internals import Front, Peaks, Scatter, best, cut, plots
from internals import PlotsAlong as Along
from internals import scale_number as number
from plotted import BENDING, CLOSED, EFFORT, REACH, legend, lines, plain, rewritten


@pytest.fixture
def swept(monkeypatch, tmp_path):
    return plotted.grid_of(monkeypatch, tmp_path)


@pytest.fixture
def listed(monkeypatch, tmp_path):
    return plotted.list_of(monkeypatch, tmp_path)


def test_curves_over_a_parameter(swept):
    figure = Peaks("x", (EFFORT, BENDING), ("l",), at={"r": 0.1}).draw(swept)
    assert len(figure.axes) == 2
    for axes, name in zip(figure.axes, (EFFORT, BENDING), strict=True):
        values = np.abs(swept[name][:, 1, 0])
        (line,), (star,), (crosses,) = (lines(axes, marker) for marker in (".", "*", "x"))
        np.testing.assert_array_equal(line.get_xdata(), np.linspace(0.15, 0.4, 9))
        np.testing.assert_array_equal(line.get_ydata(), values)
        k = np.nanargmin(values)
        assert (star.get_xdata()[0], star.get_ydata()[0]) == (swept["l"][k], values[k])
        np.testing.assert_array_equal(crosses.get_xdata(), swept["l"][np.isnan(values)])
        assert (
            plain(axes.get_title(loc="left")) == f"★ {number(values[k])} at l = {swept['l'][k]:.4g}"
        )
    assert figure.axes[1].get_xlabel() == "l [m]"
    assert plain(figure.axes[1].get_ylabel()) == "rod bending, |peak| [N m]"
    assert (
        plain(figure.get_suptitle())
        == "slider_crank: peak over time of each design at r = 0.1 m, m1 = 0.1 kg"
    )
    assert legend(figure) == [REACH, "smallest of those drawn"]


def test_a_family_of_curves_in_the_order_of_its_values(swept):
    figure = Peaks("x", (BENDING,), ("l",), "r").draw(swept)
    assert [text for text in legend(figure) if "=" in text] == [
        f"r = {value} m" for value in (0.05, 0.07, 0.1)
    ]
    for line, crosses, k in zip(
        lines(figure.axes[0], "."), lines(figure.axes[0], "x"), (0, 2, 1), strict=True
    ):
        values = np.abs(swept[BENDING][:, k, 0])
        np.testing.assert_array_equal(line.get_ydata(), values)
        np.testing.assert_array_equal(crosses.get_xdata(), swept["l"][np.isnan(values)])


def test_maps_over_two_parameters_in_either_order(swept):
    """Values that are not in order on the grid are in order on the map; what has no result is
    masked, and shaded instead.
    """
    sizes = np.abs(swept[BENDING][:, [0, 2, 1], 1])
    assert 0 < np.isnan(sizes).sum() < sizes.size
    l, r = np.unravel_index(np.nanargmin(sizes), sizes.shape)
    for over, expected in ((("l", "r"), sizes.T), (("r", "l"), sizes)):
        figure = Peaks("x", (BENDING,), over, at={"m1": 0.2}).draw(swept)
        axes, bar = figure.axes
        cells, shade = axes.collections
        np.testing.assert_array_equal(np.ma.filled(cells.get_array(), np.nan), expected)
        np.testing.assert_array_equal(np.ma.getmaskarray(shade.get_array()), ~np.isnan(expected))
        (star,) = lines(axes, "*")
        place = {"l": swept["l"][l], "r": np.sort(swept["r"])[r]}
        assert (star.get_xdata()[0], star.get_ydata()[0]) == tuple(place[name] for name in over)
        assert legend(figure) == [REACH, "smallest of those drawn"]
        assert plain(bar.get_xlabel()) == "rod bending, |peak| [N m]"


@pytest.mark.parametrize(
    ("kinds", "last"),
    [([4, 1], CLOSED), ([4, 1, 2, 3], "converge slowly"), ([4, 1, 2, 3, 5], "other reasons")],
)
def test_reasons_are_told_apart_as_far_as_they_are_few(swept, kinds, last):
    """Each has a shade of its own, the most frequent one the first; cells in it are those of its
    status.
    """

    def several(values):
        values[:, :, 0] = np.resize([kinds[0], *kinds, 0, 0], 27).reshape(9, 3)
        return values

    found = rewritten(swept, "status", several)
    figure = Peaks("x", (BENDING,), ("l", "r")).draw(found)
    status = found["status"][:, [0, 2, 1], 0].T
    shade = np.ma.filled(figure.axes[0].collections[1].get_array(), 0)
    texts = [text for text in legend(figure) if text.startswith("no result")]
    assert texts[0] == "no result: a loop cannot be closed"
    assert last in texts[-1]
    assert len(texts) == min(len(kinds), 4)
    np.testing.assert_array_equal(shade == 1, status == 4)
    np.testing.assert_array_equal(shade == 0, status == 0)
    colours = [tuple(patch.get_facecolor()) for patch in figure.legends[0].get_patches()]
    assert len(set(colours)) == len(texts)


def test_a_few_far_values_do_not_set_the_colours(swept):
    """One near-singular design gets the arrow's colour, and the label says how far it goes; smaller
    ones keep theirs.
    """
    first = tuple(np.argwhere(np.isfinite(swept[BENDING][:, :, 0]))[0])

    def far(values):
        values[(*first, 0)] = 1e4
        return values

    found = rewritten(swept, BENDING, far)
    figure = Peaks("x", (BENDING,), ("l", "r")).draw(found)
    cells = figure.axes[0].collections[0]
    assert cells.norm.vmax < 1e4
    assert figure.axes[1].get_xlabel().endswith("\nbeyond: up to 10000")
    assert cells.cmap(cells.norm(1e4)) != cells.cmap(1.0), (
        "the arrow's colour is not that of the scale's end"
    )
    curve = Peaks("x", (BENDING,), ("l",), at={"r": found["r"][first[1]]}).draw(found).axes[0]
    assert curve.get_ylim()[1] < 1e4
    assert curve.get_ylabel().endswith("beyond: up to 10000")


@pytest.mark.parametrize("sized", [False, True])
def test_section_forces_along_the_link(swept, sized):
    """With their sign, unless it alternates from cell to cell, where it is that of rounding."""

    def signed(values):
        steady = np.where(np.arange(5) < 2, -1.0, 1.0)
        alternating = np.where((np.arange(9)[:, None] + np.arange(5)) % 2, -1.0, 1.0)[:, None, None]
        return np.abs(values) * (alternating if sized else steady)

    found = rewritten(swept, "peak_at:section:rod:bending", signed)
    figure = Along("x", "rod", "l", {"r": 0.1, "m1": 0.2}).draw(found)
    values = found["peak_at:section:rod:bending"][:, 1, 1].T
    assert np.nanmin(values) < 0.0 < np.nanmax(values)
    cells, shade = figure.axes[2].collections
    np.testing.assert_array_equal(
        np.ma.filled(cells.get_array(), np.nan), np.abs(values) if sized else values
    )
    np.testing.assert_array_equal(np.ma.getmaskarray(shade.get_array()), ~np.isnan(values))
    assert cells.norm.vmin == (0.0 if sized else -cells.norm.vmax)
    assert (
        plain(cells.colorbar.ax.get_xlabel())
        == f"rod bending, {'|peak|' if sized else 'peak'} [N m]"
    )


def test_a_few_designs_are_curves_along_the_link(swept):
    """A jump to the other sign is no line, but rounding is no jump; a design without a result is
    named with the reason.
    """

    def jumping(values):
        values[-1, 1, 0], values[-1, 2, 0] = np.nan, [-1e-20, 1.0, 2.0, -2.0, -1.0]
        return values

    found = rewritten(swept, "peak_at:section:rod:bending", jumping)
    figure = Along("x", "rod", "r", {"l": 0.4}).draw(
        rewritten(found, "status", lambda values: np.where(values, 4, values))
    )
    solid = [line for line in lines(figure.axes[2], "None") if line.get_linestyle() == "-"]
    drawn = solid[:3]
    values = found["peak_at:section:rod:bending"][-1, [0, 2, 1], 0]
    for line, row in zip(drawn, values, strict=True):
        y = line.get_ydata()
        np.testing.assert_array_equal(y[~np.isnan(y)], row[~np.isnan(row)])
    np.testing.assert_array_equal(drawn[1].get_ydata(), [-1e-20, 1.0, 2.0, np.nan, -2.0, -1.0])
    jumps = [
        line.get_ydata().tolist()
        for line in lines(figure.axes[2], "None")
        if line.get_linestyle() == ":"
    ]
    assert [2.0, -2.0] in jumps
    assert plain(figure.axes[2].get_ylabel()) == "rod bending, peak [N m]"
    status = found["status"][-1, [0, 2, 1], 0]
    assert status.any()
    reasons = ["" if not kind else ", no result: a loop cannot be closed" for kind in status]
    keys = [f"r = {r} m{why}" for r, why in zip((0.05, 0.07, 0.1), reasons, strict=True)]
    assert legend(figure) == [*keys, "where the largest in size changes its sign"]
    positive = rewritten(found, "peak_at:section:rod:bending", np.abs)
    for force in ("axial", "shear"):
        positive = rewritten(positive, f"peak_at:section:rod:{force}", np.abs)
    assert legend(Along("x", "rod", "r", {"l": 0.4}).draw(positive)) == keys


def test_the_front_and_all_designs(swept):
    figure = Front("x", EFFORT, BENDING).draw(swept)
    dots, _, front = (
        lines(figure.axes[0], "o")[0],
        *lines(figure.axes[0], "None"),
        lines(figure.axes[0], "o")[1],
    )
    both = ~np.isnan(swept[EFFORT]).ravel()
    assert np.isfinite(dots.get_xdata()).sum() == both.sum()
    designs = best(swept, minimise=[EFFORT, BENDING])
    np.testing.assert_array_equal(
        front.get_ydata(), [abs(design.values[BENDING]) for design in designs]
    )
    (low, high), axes = figure.axes[0].get_xlim(), figure.axes[0]
    assert low < front.get_xdata().min()
    assert front.get_xdata().max() < high
    assert plain(figure.get_suptitle()) == "slider_crank: designs and their front"
    keys = list(legend(figure)[2:])
    named = [
        ", ".join(
            f"{name} = {design.values[name]:.4g} {unit}" for name, unit in swept.parameters.items()
        )
        for design in designs
    ]
    assert keys
    assert keys[0] == named[0]
    assert keys[-1] == named[-1]
    assert set(keys) <= set(named)
    for k, words in enumerate(keys, 1):
        ((x, y),) = lines(axes, f"${k}$")[0].get_xydata()
        design = designs[named.index(words)]
        assert (x, y) == (abs(design.values[EFFORT]), abs(design.values[BENDING]))
        assert any((ring.get_xydata() == [x, y]).all() for ring in lines(axes, "o")[2:])
    some = Front("x", EFFORT, "l", {"m1": 0.2}).draw(swept)
    assert (
        np.isfinite(lines(some.axes[0], "o")[0].get_xdata()).sum()
        == (~np.isnan(swept[EFFORT][:, :, 1])).sum()
    )
    assert some.axes[0].get_ylabel() == "l [m]"
    assert plain(some.get_suptitle()).endswith("at m1 = 0.2 kg")
    assert all(words.startswith("l = ") and "m1" not in words for words in legend(some)[2:])


def test_numbered_designs_of_a_front_lie_apart(swept):
    """Of a front that is short beside the other designs, as many are numbered as there is room for,
    the ends first.
    """
    order = np.arange(54.0).reshape(9, 3, 2)
    effort = np.where(order < 6, 100.0 + order, 100.0 + 20 * order)
    bending = np.where(order < 6, 10.0 - 0.1 * order, 10.0 + order)
    found = rewritten(rewritten(swept, "status", np.zeros_like), EFFORT, lambda _: effort)
    figure = Front("x", EFFORT, BENDING).draw(rewritten(found, BENDING, lambda _: bending))
    assert "front: no other is less in both (6)" in legend(figure)
    figure.draw_without_rendering()
    rings = [line for line in lines(figure.axes[0], "o") if line.get_markerfacecolor() == "white"]
    places = np.array([figure.axes[0].transData.transform(ring.get_xydata()[0]) for ring in rings])
    gaps = np.hypot(*(places[:, None] - places[None]).T)[~np.eye(len(rings), dtype=bool)]
    assert len(rings) < 5
    assert rings[0].get_xdata()[0] == 100.0
    assert (gaps > rings[0].get_markersize() / 72 * figure.dpi).all()


def test_a_front_of_all_designs(swept):
    """There are no others to say anything of."""
    ranks = np.arange(1.0, 55.0).reshape(9, 3, 2)
    found = rewritten(rewritten(swept, "status", np.zeros_like), EFFORT, lambda _: ranks)
    figure = Front("x", EFFORT, BENDING).draw(rewritten(found, BENDING, lambda _: 100.0 - ranks))
    assert legend(figure)[0] == "front: no other is less in both (54)"
    assert not any("with a result" in text for text in legend(figure))


def test_grids_finer_than_the_picture_are_thinned(swept, monkeypatch):
    monkeypatch.setattr(cut, "PIXELS", 4)
    monkeypatch.setattr(plots, "DOTS", 10)
    figure = Peaks("x", (BENDING,), ("l", "r")).draw(swept)
    assert figure.axes[0].collections[0].get_array().shape == (3, 3)
    assert "1 in 3 values of l drawn" in plain(figure.get_suptitle())
    figure = Front("x", EFFORT, BENDING).draw(swept)
    dots, front = lines(figure.axes[0], "o")[:2]
    assert 0 < dots.get_xdata().size <= 10
    assert front.get_xdata().size == len(best(swept, minimise=[EFFORT, BENDING]))
    assert legend(figure)[0] == "designs with a result, 1 in 6 drawn"
    monkeypatch.setattr(plots, "DOTS", 20)
    some = Front("x", EFFORT, BENDING, {"m1": 0.2}).draw(swept)
    assert lines(some.axes[0], "o")[0].get_xdata().size > 3, (
        "of each second design, all that are odd are drawn or none"
    )


def test_a_few_values_are_ticks(swept, listed):
    axes = Peaks("x", (BENDING,), ("l", "r")).draw(swept).axes[0]
    np.testing.assert_array_equal(axes.get_yticks(), [0.05, 0.07, 0.1])
    assert len(axes.get_xticks()) != 9
    np.testing.assert_array_equal(
        Peaks("x", (BENDING,), ("r",), "l").draw(swept).axes[0].get_xticks(), [0.05, 0.07, 0.1]
    )
    for over in ("l", "r"):
        axes = Along("x", "rod", over).draw(swept).axes[0]
        np.testing.assert_array_equal(
            axes.get_yticks() if over == "l" else axes.get_xticks(), [0.0, 0.25, 0.5, 0.75, 1.0]
        )
    np.testing.assert_array_equal(
        Scatter("x", (BENDING,), ("l", "m1")).draw(listed).axes[1].get_xticks(), [0.1, 0.2]
    )


def test_the_star_says_that_others_are_as_small(swept, listed):
    """What differs by rounding is as small."""
    title = (
        Scatter("x", (BENDING,), ("l",))
        .draw(rewritten(listed, BENDING, lambda v: np.resize([0.25, 0.5], 50)))
        .axes[0]
    )
    assert plain(title.get_title(loc="left")) == "★ 0.25, design 0 and 24 more"
    sizes = np.resize([0.5, 0.25, 0.25 * (1 - 1e-12)], 9)[:, None, None]
    found = rewritten(
        rewritten(swept, "status", np.zeros_like),
        BENDING,
        lambda values: np.broadcast_to(sizes, values.shape),
    )
    title = Peaks("x", (BENDING,), ("l",)).draw(found).axes[0].get_title(loc="left")
    assert plain(title) == "★ 0.25 at l = 0.2125 and 5 more"
