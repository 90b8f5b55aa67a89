"""Figures of a sweep: each draws what it says, from the file's arrays, and says what it omits."""

from pathlib import Path

import numpy as np
import pytest
import sweeps
from forging import forging
from matplotlib import figure

from lagrange_casadi import Sweep, best, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.studies.sweep import Listed

BENDING, EFFORT = "peak:section:rod:bending", "peak:effort:O"

FRONT = f"front_{EFFORT}_{BENDING}".replace(":", "-")
USUAL = ["peak_effort", "peak_reactions", "peak_section_rod", "along_rod", FRONT]
REACH = "no result: the iterated loops did not converge"


def rewritten(found, name, change):
    """The sweep with a column that is changed in its file."""
    with forging(found.path) as file:
        file[name.replace(":", "/")][...] = change(file[name.replace(":", "/")][()])
    return Sweep.open(found.path)


def plain(text):
    """Words without what keeps or breaks their lines."""
    return text.replace("\N{NO-BREAK SPACE}", " ").replace("\n", " ")


def lines(axes, marker):
    return [line for line in axes.get_lines() if line.get_marker() == marker]


@pytest.fixture
def plot(monkeypatch, tmp_path):
    """A function of a sweep and of options gives the figures that the command draws, by name. Their
    pixels, which take most of the time, are another test's.
    """

    def plotted(found, *asked, status=0):
        drawn = {}
        with monkeypatch.context() as patch:
            patch.setattr(
                figure.Figure, "savefig", lambda one, file, **_: drawn.update({file.name: one})
            )
            assert (
                main(["plot", str(found.path), *asked, "--out", str(tmp_path / "drawn")]) == status
            )
        return {Path(name).stem: one for name, one in drawn.items()}

    return plotted


def legend(figure):
    return [plain(text.get_text()) for text in figure.legends[0].get_texts()]


@pytest.fixture
def swept(monkeypatch, tmp_path):
    """A grid of three parameters, swept by plain formulas."""
    sweeps.use(monkeypatch)
    grid = {"l": (0.15, 0.4, 9), "r": [0.05, 0.1, 0.07], "m1": [0.1, 0.2]}
    return sweep(sweeps.scene(), grid, out=tmp_path / "x.h5", xi=(0, 1, 5))


@pytest.fixture
def listed(monkeypatch, tmp_path):
    """A list of fifty designs, swept likewise."""
    sweeps.use(monkeypatch)
    rows = np.column_stack(
        [np.random.default_rng(3).uniform(0.1, 0.3, (50, 2)), np.repeat([0.1, 0.2], 25)]
    )
    return sweep(sweeps.scene(), Listed(("l", "r", "m1"), rows), out=tmp_path / "y.h5")


def test_maps_over_two_parameters_in_either_order(swept, plot):
    """Values that are not in order on the grid are in order on the map; what has no result is
    masked, above what is hatched.
    """
    sizes = np.abs(swept[BENDING][:, [0, 2, 1], 1])
    assert 0 < np.isnan(sizes).sum() < sizes.size
    l, r = np.unravel_index(np.nanargmin(sizes), sizes.shape)
    for over, expected in ((("l", "r"), sizes.T), (("r", "l"), sizes)):
        asked = ["--over", over[0], "--over", over[1], "--at", "m1=0.2"]
        shown = plot(swept, *asked)["peak_section_rod"]
        bar = next(bar for bar in shown.axes if "rod bending" in plain(bar.get_xlabel()))
        axes = shown.axes[shown.axes.index(bar) - 3]
        (cells,) = axes.collections
        np.testing.assert_array_equal(np.ma.filled(cells.get_array(), np.nan), expected)
        assert axes.patch.get_hatch()
        (star,) = lines(axes, "*")
        place = {"l": swept["l"][l], "r": np.sort(swept["r"])[r]}
        assert (star.get_xdata()[0], star.get_ydata()[0]) == tuple(place[name] for name in over)
        assert legend(shown) == [REACH, "smallest of those drawn"]
        assert plain(bar.get_xlabel()) == "rod bending, |peak| [N m]"


def test_section_forces_at_one_ratio_are_a_map_of_one_row(monkeypatch, plot, tmp_path):
    sweeps.use(monkeypatch)
    grid = {"l": (0.15, 0.4, 9)}
    found = sweep(sweeps.scene(), grid, out=tmp_path / "one.h5", xi=(0.5, 0.5, 1))
    (cells,) = plot(found)["along_rod"].axes[0].collections
    np.testing.assert_array_equal(cells.get_array().shape, (1, 9))


@pytest.mark.parametrize("sized", [False, True])
def test_section_forces_along_the_link(swept, plot, sized):
    """With their sign, unless it alternates from cell to cell, where it is that of rounding."""

    def signed(values):
        steady = np.where(np.arange(5) < 2, -1.0, 1.0)
        alternating = np.where((np.arange(9)[:, None] + np.arange(5)) % 2, -1.0, 1.0)[:, None, None]
        return np.abs(values) * (alternating if sized else steady)

    found = rewritten(swept, "peak_at:section:rod:bending", signed)
    shown = plot(found, "--over", "l", "--at", "r=0.1", "--at", "m1=0.2")["along_rod"]
    values = found["peak_at:section:rod:bending"][:, 1, 1].T
    assert np.nanmin(values) < 0.0 < np.nanmax(values)
    (cells,) = shown.axes[2].collections
    np.testing.assert_array_equal(
        np.ma.filled(cells.get_array(), np.nan), np.abs(values) if sized else values
    )
    least = np.nanmin(np.abs(values)) if sized else -cells.norm.vmax
    assert cells.norm.vmin == least
    assert (
        plain(cells.colorbar.ax.get_xlabel())
        == f"rod bending, {'|peak|' if sized else 'peak'} [N m]"
    )


def test_one_design_near_a_dead_centre_does_not_set_the_scale(swept, plot):
    """It is beyond the scale of a map and of a curve, whose labels say how large it is."""

    def raised(values):
        values[4, 2, 1] = 1e6
        return values

    asked, found = ["--over", "l", "--at", "m1=0.2"], rewritten(swept, EFFORT, raised)
    usual = plot(swept, *asked, "--over", "r")["peak_effort"].axes[0].collections[0].norm
    shown = plot(found, *asked, "--over", "r")["peak_effort"]
    assert shown.axes[0].collections[0].norm.vmax < 2.0 * usual.vmax
    assert plain(shown.axes[1].get_xlabel()).endswith("beyond: up to 1e+06")
    curve = plot(found, *asked, "--at", "r=0.07")["peak_effort"].axes[0]
    assert curve.get_ylim()[1] < 2.0 * usual.vmax
    assert plain(curve.get_ylabel()).endswith("beyond: up to 1e+06")


REFUSED = {
    "--over q": "unknown swept parameter 'q'; valid: l, r, m1",
    "--at q=1": "unknown swept parameter 'q'; valid: l, r, m1",
    "--over l --over r --over m1": "a grid is drawn over one parameter or two, got 3: l, r, m1",
    "--over l --over l": "over: parameter 'l' is listed twice",
    "--over l --at l=0.4": "parameter 'l' cannot be drawn over and stay at 0.4 as well",
    "--at r=0.08": "no design has r = 0.08; nearest: 0.07, 0.1",
    "--at l=0.2": "no design has l = 0.2; nearest: 0.2125, 0.18125",
    "--at l=0.4 --at l=0.15": "--at: a parameter stays at one value, got two for 'l'",
    f"--against {EFFORT} bending": "unknown column 'bending'",
    f"--against {EFFORT} {EFFORT}": f"to draw against each other, got '{EFFORT}' twice",
    f"--against {EFFORT} peak_at:section:rod:axial": "has no single value of a design",
}


def test_what_cannot_be_drawn_is_named(swept, plot, monkeypatch, tmp_path, capsys):
    one = sweep(sweeps.scene(), {"l": (0.2, 0.3, 5), "r": [0.1]}, out=tmp_path / "z.h5")
    engine = sweeps.use(monkeypatch)
    engine.quantities, engine.efforts = ("pose:rod:x",), ()
    poses = sweep(sweeps.scene(), {"l": (0.2, 0.3, 5)}, out=tmp_path / "p.h5")
    cases = [(swept, asked, words) for asked, words in REFUSED.items()]
    cases += [
        (one, "--over r", "'r' cannot be drawn over: it is 0.1 in all designs; those that vary: l"),
        (one, "--at l=0.2", "there is nothing to draw: it has only one design"),
        (poses, "", "there is nothing to draw: it keeps no peak of an effort"),
    ]
    for found, asked, words in cases:
        assert not plot(found, *asked.split(), status=2), asked
        assert words in capsys.readouterr().err, asked
    assert not [*tmp_path.glob("drawn/*.png")]


def test_the_command_writes_figures_or_nothing(swept, plot, tmp_path, capsys):
    """What shows nothing is a note beside the others, and an error where there is no other."""
    found = rewritten(swept, EFFORT, lambda values: np.where(np.isnan(values), np.nan, 3.0))
    asked = ["plot", str(found.path), "--over", "l", "--at", "m1=0.2"]
    assert main([*asked, "--out", str(tmp_path / "drawn")]) == 0
    assert {path.stem for path in tmp_path.glob("drawn/*.png")} == {*USUAL} - {"peak_effort"}
    err = capsys.readouterr().err
    assert (
        err == "note: not drawn: peak_effort.png: the same for all drawn, at m1 = 0.2 kg: effort O,"
        " |peak| [N m] = 3\n"
    )
    rewritten(found, "status", lambda values: np.full_like(values, 4))
    assert not plot(found, status=1)
    assert capsys.readouterr().err.endswith(
        "(54 x a loop cannot be closed: its links do not reach): there is nothing to draw\n"
    )


def test_curves_over_a_parameter(swept, plot):
    """The smallest has a star, what has no result a cross."""
    drawn = plot(swept, "--over", "l", "--at", "r=0.1", "--at", "m1=0.1")
    for name, page in ((EFFORT, "peak_effort"), (BENDING, "peak_section_rod")):
        (axes,) = (one for one in drawn[page].axes if name.split(":")[-1][-7:] in one.get_ylabel())
        values = np.abs(swept[name][:, 1, 0])
        (line,), (star,), (crosses,) = (lines(axes, marker) for marker in (".", "*", "x"))
        np.testing.assert_array_equal(line.get_xydata().T, [swept["l"], values])
        k = np.nanargmin(values)
        assert star.get_xydata().tolist() == [[swept["l"][k], values[k]]]
        np.testing.assert_array_equal(crosses.get_xdata(), swept["l"][np.isnan(values)])
        told = f"★ {values[k]:.4g} at l = {swept['l'][k]:.4g}"
        assert plain(axes.get_title(loc="left")) == told
    assert axes.get_xlabel() == "l [m]"
    assert plain(axes.get_ylabel()) == "rod bending, |peak| [N m]"
    told = "slider_crank: peak over time of each design at r = 0.1 m, m1 = 0.1 kg"
    assert plain(drawn[page].get_suptitle()) == told
    assert legend(drawn[page]) == [REACH, "smallest of those drawn"]


def test_the_front_and_all_designs(swept, plot):
    shown = plot(swept)[FRONT]
    dots, front, *_ = lines(shown.axes[0], ".")
    assert np.isfinite(dots.get_xdata()).sum() == np.isfinite(swept[EFFORT]).sum()
    designs = best(swept, minimise=[EFFORT, BENDING])
    expected = [[abs(design.values[name]) for name in (EFFORT, BENDING)] for design in designs]
    np.testing.assert_array_equal(front.get_xydata(), expected)
    keys = legend(shown)[2:]
    for design, words in ((designs[0], keys[0]), (designs[-1], keys[-1])):
        values = (f"{name} = {design.values[name]:.4g} {u}" for name, u in swept.parameters.items())
        assert words == ", ".join(values)
    asked = ["--against", EFFORT, "l", "--at", "m1=0.2"]
    some = plot(swept, *asked)[FRONT.replace(BENDING.replace(":", "-"), "l")]
    shown = np.isfinite(lines(some.axes[0], ".")[0].get_xdata()).sum()
    assert shown == np.isfinite(swept[EFFORT][:, :, 1]).sum()
    assert plain(some.get_suptitle()).endswith("at m1 = 0.2 kg")


def test_the_usual_figures_of_a_grid_and_of_a_list(swept, listed, plot):
    assert [*plot(swept)] == [*plot(swept, "--over", "m1")] == USUAL
    assert len(plot(listed, "--over", "l", "--over", "r", "--over", "m1")["peak_effort"].axes) == 3
    drawn = plot(listed, "--at", "m1=0.2")
    assert [*drawn] == [*USUAL[:3], FRONT]
    axes = drawn["peak_effort"].axes[0]
    np.testing.assert_array_equal(lines(axes, ".")[0].get_xdata(), listed["l"][25:])
    least = 25 + np.nanargmin(np.abs(listed[EFFORT][25:]))
    assert axes.get_title(loc="left").endswith(f"design {least}")
