"""Figures that a sweep suggests by itself, on pages and in files; what shows nothing is said and
not drawn.
"""

import numpy as np
import plotted
import pytest
import sweeps
from internals import Front, Peaks, Scatter, default_plots, draw_sweep, sweep
from internals import ListingListed as Listed
from internals import PlotsAlong as Along
from plotted import BENDING, CLOSED, EFFORT, lines, plain, rewritten

from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, NoDesignError, UnknownNameError


@pytest.fixture
def swept(monkeypatch, tmp_path):
    return plotted.grid_of(monkeypatch, tmp_path)


@pytest.fixture
def listed(monkeypatch, tmp_path):
    return plotted.list_of(monkeypatch, tmp_path)


@pytest.mark.sampled(2)
def test_the_usual_figures(swept, tmp_path):
    names = [spec.name for spec in default_plots(swept)]
    assert names == [
        "peak_effort",
        "peak_reactions",
        "peak_section_rod",
        "along_rod",
        f"front_{EFFORT}_{BENDING}".replace(":", "-"),
    ]
    assert (default_plots(swept)[0].over, default_plots(swept, over=["m1"])[0].family) == (
        ("l", "r"),
        "l",
    )
    assert default_plots(swept, over=["m1"], at={"l": 0.4})[0].family == "r"
    drawn = list(draw_sweep(swept, default_plots(swept, over=["m1"]), tmp_path))
    assert [(path.stem, why) for path, why in drawn] == [(name, "") for name in names]
    before = [path.read_bytes() for path, _ in drawn[-2:]]
    assert [
        path.read_bytes()
        for path, _ in draw_sweep(swept, default_plots(swept, over=["m1"])[-2:], tmp_path)
    ] == before


@pytest.mark.long
def test_a_list_is_drawn_over_each_parameter(listed, tmp_path):
    specs = default_plots(listed)
    assert [spec.name for spec in specs if isinstance(spec, Scatter)] == [
        "peak_effort",
        "peak_reactions",
        "peak_section_rod",
    ]
    figure = specs[2].draw(listed)
    assert len(figure.axes) == 9
    for k, axes in enumerate(figure.axes):
        (dots,), (crosses,), (star,) = (lines(axes, marker) for marker in "ox*")
        values = np.abs(listed[specs[2].columns[k // 3]])
        x = listed[("l", "r", "m1")[k % 3]]
        np.testing.assert_array_equal(dots.get_xdata(), x)
        np.testing.assert_array_equal(dots.get_ydata(), values)
        np.testing.assert_array_equal(crosses.get_xdata(), x[np.isnan(values)])
        assert star.get_xdata()[0] == x[np.nanargmin(values)]
    assert (
        figure.axes[0]
        .get_title(loc="left")
        .endswith(f", design {np.nanargmin(np.abs(listed[specs[2].columns[0]]))}")
    )
    assert default_plots(listed, over=["r"])[0].over == ("r",)
    at = default_plots(listed, at={"m1": 0.2})[0]
    assert at.over == ("l", "r")
    np.testing.assert_array_equal(
        lines(at.draw(listed).axes[0], "o")[0].get_xdata(), listed["l"][25:]
    )
    assert (
        at.draw(listed)
        .axes[0]
        .get_title(loc="left")
        .endswith(f"design {25 + np.nanargmin(np.abs(listed[EFFORT][25:]))}")
    )
    assert [why for _, why in draw_sweep(listed, specs, tmp_path)] == [""] * 4


def test_many_columns_and_parameters_come_on_pages(monkeypatch, tmp_path):
    engine = sweeps.use(monkeypatch)
    engine.quantities = tuple(f"reaction:J{k}:resultant" for k in range(10))
    grid = sweep(
        sweeps.scene(),
        {"l": (0.15, 0.4, 3), "r": [0.05, 0.1]},
        out=tmp_path / "x.h5",
        wanted=["effort"],
    )
    specs = [spec for spec in default_plots(grid) if isinstance(spec, Peaks)]
    assert [(spec.name, len(spec.columns)) for spec in specs] == [
        ("peak_reactions_1", 5),
        ("peak_reactions_2", 5),
    ]
    rows = np.random.default_rng(3).uniform(0.1, 0.3, (9, 4))
    found = sweep(
        sweeps.scene(),
        Listed(("l", "r", "m1", "m2"), rows),
        out=tmp_path / "y.h5",
        wanted=["effort"],
    )
    specs = [spec for spec in default_plots(found) if isinstance(spec, Scatter)]
    assert [spec.name for spec in specs] == [f"peak_reactions_{k}" for k in range(1, 7)]
    assert [len(spec.columns) * len(spec.over) for spec in specs] == [8, 8, 6, 6, 6, 6]
    assert {(c, n) for spec in specs for c in spec.columns for n in spec.over} == {
        (f"peak:reaction:J{k}:resultant", name) for k in range(10) for name in found.parameters
    }


def test_what_is_the_same_for_all_is_said_and_not_drawn(swept, tmp_path):
    found = rewritten(swept, EFFORT, lambda values: np.where(np.isnan(values), np.nan, [3.0, 4.0]))
    figure = Peaks("x", (EFFORT, BENDING), ("l", "r")).draw(found)
    assert len(figure.axes) == 2, "a map and its bar"
    assert "at m1 = 0.1 kg; the same for all drawn: effort O, |peak| [N m] = 3" in plain(
        figure.get_suptitle()
    )
    ((path, why),) = draw_sweep(found, [Peaks("x", (EFFORT,), ("l", "r"))], tmp_path)
    assert why == "the same for all drawn, at m1 = 0.1 kg: effort O, |peak| [N m] = 3"
    assert not path.exists()


def test_no_empty_axes(swept, tmp_path):
    """Of designs that have no result there is no figure, and of a sweep without any there is an
    error.
    """

    def without(values):
        values[0] = np.nan if values.dtype.kind == "f" else 1
        return values

    found = swept
    for name in ("status", BENDING, "peak_at:section:rod:axial"):
        found = rewritten(found, name, without)
    specs = [
        Peaks("a", (BENDING,), ("r", "m1"), at={"l": 0.15}),
        Along("b", "rod", "r", {"l": 0.15}),
    ]
    drawn = list(draw_sweep(found, [*specs, Front("c", BENDING, BENDING, {"l": 0.15})], tmp_path))
    assert [why for _, why in drawn] == [
        "no design at l = 0.15 m has a result",
        "no design at l = 0.15 m, m1 = 0.1 kg has a result",
        "no design at l = 0.15 m has a result",
    ]
    assert not any(path.exists() for path, _ in drawn)
    found = rewritten(found, "status", lambda values: np.where(values, values, 4))
    with pytest.raises(
        NoDesignError,
        match=rf"no design has a result \(\d+ x {CLOSED}; \d+ x a loop cannot be closed",
    ):
        default_plots(found)


def test_what_cannot_be_drawn_is_named(swept, listed, monkeypatch, tmp_path):
    cases = [
        ({"over": ["q"]}, UnknownNameError, "unknown swept parameter 'q'; valid: l, r, m1"),
        ({"at": {"q": 1.0}}, UnknownNameError, "unknown swept parameter 'q'; valid: l, r, m1"),
        (
            {"over": ["l", "r", "m1"]},
            DeclarationError,
            "a grid is drawn over one parameter or two, got 3: l, r, m1",
        ),
        ({"over": ["l", "l"]}, DeclarationError, "over: parameter 'l' is listed twice"),
        (
            {"over": ["l"], "at": {"l": 0.4}},
            DeclarationError,
            r"parameter 'l' cannot be drawn over and stay at 0\.4 as well",
        ),
        ({"at": {"r": 0.08}}, DeclarationError, r"no design has r = 0\.08; nearest: 0\.07, 0\.1"),
        ({"against": [(EFFORT, "bending")]}, UnknownNameError, "unknown column 'bending'"),
        (
            {"against": [(EFFORT, EFFORT)]},
            DeclarationError,
            f"expected two columns to draw against each other, got '{EFFORT}' twice",
        ),
        (
            {"against": [(EFFORT, "peak_at:section:rod:axial")]},
            DeclarationError,
            "has no single value of a design",
        ),
    ]
    for asked, kind, words in cases:
        with pytest.raises(kind, match=words):
            default_plots(swept, **asked)
    assert len(default_plots(listed, over=["l", "r", "m1"])[0].over) == 3
    one = sweep(sweeps.scene(), {"l": (0.2, 0.3, 5), "r": [0.1]}, out=tmp_path / "z.h5")
    with pytest.raises(
        DeclarationError,
        match=r"'r' cannot be drawn over: it is 0\.1 in all designs; those that vary: l",
    ):
        default_plots(one, over=["r"])
    with pytest.raises(DeclarationError, match="there is nothing to draw: it has only one design"):
        default_plots(one, at={"l": 0.2})
    engine = sweeps.use(monkeypatch)
    engine.quantities, engine.efforts = ("pose:rod:x",), ()
    poses = sweep(sweeps.scene(), {"l": (0.2, 0.3, 5)}, out=tmp_path / "p.h5")
    with pytest.raises(
        DeclarationError, match="there is nothing to draw: it keeps no peak of an effort"
    ):
        default_plots(poses)


def test_the_command_writes_figures_or_nothing(swept, tmp_path, capsys):
    """What shows nothing is a note beside the others, and an error where there is no other."""
    found = rewritten(swept, EFFORT, lambda values: np.where(np.isnan(values), np.nan, 3.0))
    file, out = str(found.path), tmp_path / "figures"
    assert main(["plot", file, "--over", "l", "--at", "m1=0.2", "--out", str(out)]) == 0
    names = sorted(path.stem for path in out.glob("*.png"))
    front = f"front_{EFFORT}_{BENDING}".replace(":", "-")
    assert names == ["along_rod", front, "peak_reactions", "peak_section_rod"]
    err = capsys.readouterr().err
    assert (
        err == "note: not drawn: peak_effort.png: the same for all drawn, at m1 = 0.2 kg: effort O,"
        " |peak| [N m] = 3\n"
    )
    for asked, words in (
        (
            ["--over", "l", "--over", "r", "--over", "m1"],
            "a grid is drawn over one parameter or two, got 3: l, r, m1",
        ),
        (
            ["--at", "l=0.4", "--at", "l=0.15"],
            "--at: a parameter stays at one value, got two for 'l'",
        ),
        (["--at", "l=0.2"], "no design has l = 0.2; nearest: 0.2125, 0.18125"),
    ):
        assert main(["plot", file, *asked, "--out", str(tmp_path / "none")]) == 2
        assert capsys.readouterr().err == f"error: {words}\n"
    rewritten(found, "status", lambda values: np.full_like(values, 4))
    assert main(["plot", file, "--out", str(tmp_path / "none")]) == 1
    assert capsys.readouterr().err.endswith(
        "(54 x a loop cannot be closed: its links do not reach): there is nothing to draw\n"
    )
    assert not (tmp_path / "none").exists()


def test_a_command_whose_figures_all_show_nothing_writes_none(monkeypatch, tmp_path, capsys):
    engine = sweeps.use(monkeypatch)
    engine.quantities, engine.efforts = ("load:gas:fx",), ()
    found = sweep(sweeps.scene(), {"l": (0.2, 0.3, 5)}, out=tmp_path / "x.h5")
    rewritten(found, "peak:load:gas:fx", lambda values: np.zeros_like(values))
    assert main(["plot", str(found.path), "--out", str(tmp_path / "none")]) == 1
    words = (
        "error: there is nothing to draw: peak_loads.png: the same for all drawn: load gas fx,"
        " |peak| [N] = 0\n"
    )
    assert capsys.readouterr().err == words
    assert not (tmp_path / "none").exists()
