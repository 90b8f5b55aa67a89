"""N, V and M diagrams at the instant that governs, and bearing loads as polar plots."""

import math

import numpy as np
import pytest
from internals import PolarPlots, SectionDiagrams, figures, governing, marks, vanishes
from reports import snowed, solved

FORCES = ("axial", "shear", "bending")


def texts(figure):
    return [text.get_text().replace("\N{MINUS SIGN}", "-") for text in figure.axes[0].texts]


@pytest.mark.parametrize(
    ("case", "link"), [("connecting_rod", "rod"), ("excavator", "boom"), ("v_twin", "left_rod")]
)
def test_diagrams_have_the_values_of_the_law(case, link):
    """Both ends, and what is largest along the link, at the instant of the largest stress or
    bending moment; each is a number of the picture.
    """
    solution = solved(case)
    peak = governing(solution, link)
    stress = f"stress:{link}:von_mises"
    name = stress if stress in solution.series else f"section:{link}:bending"
    assert (peak.name, peak.t) == (name, solution.peak(name).t)
    i = int(np.flatnonzero(solution.t == peak.t)[0])
    law = solution.section(link).law
    written = texts(SectionDiagrams("d", (link,)).draw(solution, si=True))
    for force in FORCES:
        if vanishes(solution, f"section:{link}:{force}"):
            assert "0" in written
            continue
        found = marks(law.during(slice(i, i + 1)), force)
        grid = law.on_grid(force, np.linspace(0.0, 1.0, 4001))[i]
        size = np.abs(grid).max()
        assert found[0].xi == 0.0
        assert found[-1].xi == 1.0
        assert found[0].value == pytest.approx(grid[0], abs=1e-12 * size)
        assert found[-1].value == pytest.approx(grid[-1], abs=1e-12 * size)
        largest = max(found, key=lambda mark: abs(mark.value))
        assert size <= abs(largest.value) * (1 + 1e-12)
        assert abs(largest.value) == pytest.approx(size, rel=2e-2 if law.loads else 1e-6)
        for mark in (found[0], found[-1], largest):
            at = law.at(force, np.full((solution.t.size, 1), mark.xi), mark.side)[i, 0]
            assert mark.value == pytest.approx(at, abs=1e-12 * size)
            assert f"{0.0 if abs(mark.value) < 1e-9 * size else mark.value:.4g}" in written


def test_signs_have_the_colours_of_the_maps():
    """Red is positive: tension drawn upwards, as in the maps of section forces."""
    sheet = SectionDiagrams("d", ("rod",)).draw(solved("connecting_rod")).axes[0]
    maps = figures.SectionMaps("m", "rod").draw(solved("connecting_rod")).axes[0].collections[0]
    for area in sheet.collections:
        heights = area.get_paths()[0].vertices[:, 1]
        base = min(heights, key=lambda height: np.abs(heights - height).sum())
        up = np.abs(heights.max() - base) > np.abs(heights.min() - base)
        red, _, blue, _ = area.get_facecolor()[0]
        most = maps.cmap(1.0 if up else 0.0)
        assert (red > blue) == (most[0] > most[2])


def test_both_sides_of_a_load_are_marked():
    """A bar with a point load: the shear force jumps by its share across the bar."""
    solution = snowed()
    i = int(np.flatnonzero(solution.t == governing(solution, "bar").t)[0])
    law = solution.section("bar").law.during(slice(i, i + 1))
    base, tip = (mark for mark in marks(law, "shear") if mark.xi == pytest.approx(0.35))
    angle = 3.0 * solution.t[i]
    across = 20.0 * math.cos(angle) - math.sin(angle)
    assert (base.side, tip.side) == ("base", "tip")
    assert base.value - tip.value == pytest.approx(across, rel=1e-9)


def test_in_space_there_are_six():
    figure = SectionDiagrams("d", ("bar",)).draw(snowed(space=True))
    written = texts(figure)
    for symbol in ("$N$", "$V_{y}$", "$V_{z}$", "$T$", "$M_{y}$", "$M_{z}$"):
        assert any(text.startswith(symbol) for text in written)


def test_rounding_is_drawn_as_zero():
    """Nothing twists a rod between a ball and a universal joint: what is left of its torsion is
    rounding, and no figure shows it at full scale.
    """
    solution = solved("spatial_slider_crank")
    torsion = "section:rod:torsion"
    assert 0.0 < abs(solution.peak(torsion).value) < 1e-12
    assert vanishes(solution, torsion)
    assert not vanishes(solution, "section:rod:axial")
    maps = figures.SectionMaps("maps", "rod").draw(solution)
    drawn = [np.abs(axes.collections[0].get_array()).max() for axes in maps.axes[:4]]
    assert drawn[0] > 1.0
    assert drawn[3] == 0.0
    assert maps.axes[3].get_title() == "torsional moment: zero everywhere"
    span = figures.SpanPlot("span", torsion, 0.1).draw(solution)
    assert not span.axes[0].get_lines()[0].get_ydata().any()
    over = figures.TimePlot("time", (torsion,), xi=(0.0, 0.5)).draw(solution)
    assert not any(np.any(line.get_ydata()) for line in over.axes[0].get_lines())
    written = texts(SectionDiagrams("d", ("rod",)).draw(solution))
    assert written[written.index("$T$ [N m]") + 1] == "0"


def test_polar_plots_show_the_largest_load():
    solution = solved("four_bar")
    figure = PolarPlots("p", ("O", "C")).draw(solution, si=True)
    written = texts(figure)
    for joint in ("O", "C"):
        reaction = solution.reaction(joint)
        i = int(np.argmax(reaction.resultant))
        angle = math.degrees(math.atan2(reaction.fy[i], reaction.fx[i]))
        assert joint in written
        assert f"{reaction.resultant[i]:.4g} N at {angle:.3g}°" in written
    curves = [line for line in figure.axes[0].get_lines() if len(line.get_xdata()) == 41]
    assert len(curves) == 2


def test_both_are_among_the_usual_figures(tmp_path):
    cases = {
        "slider_crank": ("O", "A", "B"),
        "rssr": ("O", "Q"),
        "v6": ("main_fixed", "main_floating"),
    }
    for name, joints in cases.items():
        specs = {spec.name: spec for spec in figures.default_figures(solved(name))}
        assert specs["bearings"] == PolarPlots("bearings", joints)
        assert set(specs["diagrams"].links) == set(solved(name).links_with_sections)
        drawn = figures.draw(solved(name), [specs["bearings"], specs["diagrams"]], tmp_path)
        assert all(path for _, path in drawn)
