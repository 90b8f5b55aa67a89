"""Figures of a sweep: each draws what it says, from the file's arrays."""

import numpy as np
import pytest
import sweeps

from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.sweep import Listed, best, plots, sweep
from lagrange_casadi.sweep.plots import Along, Front, Peaks, default_plots, draw_sweep

BENDING, EFFORT = "peak:section:rod:bending", "peak:effort:O"


@pytest.fixture
def swept(monkeypatch, tmp_path):
    sweeps.use(monkeypatch)
    grid = {"l": (0.15, 0.4, 9), "r": [0.05, 0.1, 0.07], "m1": [0.1, 0.2]}
    return sweep(sweeps.scene(), grid, out=tmp_path / "x.h5", xi=(0, 1, 5))


def test_curves_over_a_parameter(swept):
    figure = Peaks("x", (EFFORT, BENDING), ("l",), {"r": 0.07}).draw(swept)
    assert len(figure.axes) == 2
    for axes, name in zip(figure.axes, (EFFORT, BENDING), strict=True):
        (line,) = axes.get_lines()
        np.testing.assert_array_equal(line.get_xdata(), np.linspace(0.15, 0.4, 9))
        np.testing.assert_array_equal(line.get_ydata(), np.abs(swept[name][:, 2, 0]))
    assert figure.axes[1].get_xlabel() == "l [m]"
    assert figure.axes[1].get_ylabel() == "section rod bending [N m]"
    assert figure.get_suptitle() == "slider_crank: peaks, by size at r = 0.07 m, m1 = 0.1 kg"


def test_maps_over_two_parameters_in_either_order(swept):
    """Values that are not in order on the grid are in order on the map."""
    sizes = np.abs(swept[BENDING][:, [0, 2, 1], 1])
    for over, expected in ((("l", "r"), sizes.T), (("r", "l"), sizes)):
        figure = Peaks("x", (BENDING,), over, {"m1": 0.2}).draw(swept)
        np.testing.assert_array_equal(np.ma.filled(figure.axes[0].collections[0].get_array(), np.nan), expected)


def test_section_forces_along_the_link(swept):
    figure = Along("x", "rod", "l", {"r": 0.1, "m1": 0.2}).draw(swept)
    drawn = np.ma.filled(figure.axes[2].collections[0].get_array(), np.nan)
    np.testing.assert_array_equal(drawn, swept["peak_at:section:rod:bending"][:, 1, 1].T)


def test_the_front_and_all_designs(swept):
    figure = Front("x", EFFORT, BENDING).draw(swept)
    dots, front = figure.axes[0].get_lines()
    both = ~np.isnan(swept[EFFORT]).ravel()
    assert np.isfinite(dots.get_xdata()).sum() == both.sum()
    expected = [abs(design.values[BENDING]) for design in best(swept, minimise=[EFFORT, BENDING])]
    np.testing.assert_array_equal(front.get_ydata(), expected)


def test_grids_finer_than_the_picture_are_thinned(swept, monkeypatch):
    monkeypatch.setattr(plots, "_PIXELS", 4)
    monkeypatch.setattr(plots, "_DOTS", 10)
    figure = Peaks("x", (BENDING,), ("l", "r")).draw(swept)
    assert figure.axes[0].collections[0].get_array().shape == (3, 3)
    assert Front("x", EFFORT, BENDING).draw(swept).axes[0].get_lines()[0].get_xdata().size <= 10


def test_the_usual_figures(swept, tmp_path):
    names = [spec.name for spec in default_plots(swept)]
    assert names == [
        "peak_effort",
        "peak_reactions",
        "peak_section_rod",
        "along_rod",
        f"front_{EFFORT}_{BENDING}".replace(":", "-"),
    ]
    paths = list(draw_sweep(swept, default_plots(swept, over=["m1"]), tmp_path))
    assert [path.stem for path in paths] == names
    before = [path.read_bytes() for path in paths]
    assert [path.read_bytes() for path in draw_sweep(swept, default_plots(swept, over=["m1"]), tmp_path)] == before


def test_a_list_is_drawn_over_one_parameter(monkeypatch, tmp_path):
    sweeps.use(monkeypatch)
    rows = np.random.default_rng(3).uniform(0.1, 0.3, (50, 2))
    found = sweep(sweeps.scene(), Listed(("l", "r"), rows), out=tmp_path / "y.h5")
    specs = default_plots(found, over=["r"])
    figure = specs[0].draw(found)
    (line,) = figure.axes[0].get_lines()
    np.testing.assert_array_equal(line.get_xdata(), np.sort(rows[:, 1]))
    assert len(list(draw_sweep(found, specs, tmp_path))) == 4
    with pytest.raises(DeclarationError, match="plots are over one parameter of a list, got l, r"):
        default_plots(found, over=["l", "r"])


def test_what_cannot_be_drawn_is_named(swept):
    with pytest.raises(UnknownNameError, match="unknown swept parameter 'q'; valid: l, r, m1"):
        default_plots(swept, over=["q"])
    with pytest.raises(DeclarationError, match="plots are over one parameter or two, got l, r, m1"):
        default_plots(swept, over=["l", "r", "m1"])
    with pytest.raises(UnknownNameError, match="unknown column 'bending'"):
        default_plots(swept, against=[(EFFORT, "bending")])
    with pytest.raises(DeclarationError, match=r"no design has r = 0\.08; nearest: 0\.07, 0\.1"):
        Peaks("x", (BENDING,), ("l",), {"r": 0.08}).draw(swept)
