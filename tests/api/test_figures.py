"""Figures: each draws what it says, from the arrays of the solution; mechanisms are where their
poses put them, in the plane and in space.
"""

import math

import numpy as np
import pytest
from drawn_scenes import CASES, every_kind, moved
from reports import solved

from lagrange_casadi import evaluate
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.figures import (
    MechanismDrawing,
    PolarPlots,
    SectionDiagrams,
    SectionMaps,
    SpanPlot,
    TimePlot,
    default_figures,
    draw,
)


def curves(figure):
    return [line.get_xydata() for line in figure.axes[0].get_lines() if len(line.get_xydata()) > 2]


def test_time_plot_applies_the_factor(solution):
    spec = TimePlot("guide", ("reaction:guide:fy",), "guide", factor=-1, note="sign of the paper")
    figure = spec.draw(solution)
    (curve,) = curves(figure)
    np.testing.assert_array_equal(
        curve, np.column_stack([solution.t, -solution.reaction("guide").fy])
    )
    assert figure.axes[0].get_ylabel().endswith("[N]")
    assert figure.get_supxlabel() == "sign of the paper"


def test_time_plot_of_sections(solution):
    figure = TimePlot("axial", ("section:rod:axial",), xi=(0.25, 0.5)).draw(solution)
    quarter, half = curves(figure)
    np.testing.assert_allclose(quarter[:, 1], solution.section("rod").axial[:, 25], rtol=1e-12)
    np.testing.assert_allclose(half[:, 1], solution.section("rod").axial[:, 50], rtol=1e-12)


def test_each_unit_has_axes_of_its_own(solution):
    """A torque and forces share no scale: two panels over one time, each named by its own
    quantities.
    """
    names = ("effort:O", "reaction:guide:fy", "reaction:guide:resultant", "motion:O")
    figure = TimePlot("both", names, "both", note="a note").draw(solution)
    assert [axes.get_ylabel().replace("\n", " ") for axes in figure.axes] == [
        "effort of the drive [N m]",
        "reaction of the joint, resultant of the joint's reaction [N]",
        "coordinate of the joint [rad]",
    ]
    lines = [
        [line.get_ydata() for line in axes.get_lines() if len(line.get_ydata()) > 2]
        for axes in figure.axes
    ]
    assert [len(panel) for panel in lines] == [1, 2, 1]
    np.testing.assert_array_equal(lines[0][0], solution.effort("O"))
    np.testing.assert_array_equal(lines[1][1], solution.reaction("guide").resultant)
    assert [axes.get_title() for axes in figure.axes] == ["both", "", ""]
    assert [axes.get_xlabel() for axes in figure.axes] == ["", "", "t [s]"]
    assert figure.get_supxlabel() == "a note"
    assert len(TimePlot("one", ("reaction:guide:fx", "reaction:guide:fy")).draw(solution).axes) == 1


def test_span_plot_takes_the_nearest_instant(solution):
    figure = SpanPlot("bending", "section:rod:bending", 0.03004, "bending").draw(solution)
    np.testing.assert_array_equal(curves(figure)[0][:, 1], solution.section("rod").bending[300])
    assert "t = 0.03 s" in figure.axes[0].get_title()


def test_maps_mark_the_peaks(solution):
    figure = SectionMaps("maps", "rod").draw(solution)
    marks = [axes.get_lines()[0].get_xydata()[0] for axes in figure.axes if axes.get_lines()]
    peaks = [solution.peak(f"section:rod:{force}") for force in ("axial", "shear", "bending")]
    np.testing.assert_array_equal(marks, [(peak.t, peak.xi) for peak in peaks])


def test_drawing_puts_the_links_where_they_are(solution):
    figure = MechanismDrawing(count=4).draw(solution)
    assert len(figure.axes) == 4
    lines = {line.get_label(): line.get_xydata() for line in figure.axes[1].get_lines()}
    np.testing.assert_allclose(lines["crank"], [(0, 0), (0, 0.1)], atol=1e-5)
    np.testing.assert_allclose(lines["rod"], [(0, 0.1), (np.sqrt(0.03), 0)], atol=1e-5)
    np.testing.assert_allclose(lines["slider"], [(np.sqrt(0.03), 0)], atol=1e-5)


def test_axes_have_units_that_people_read_and_si_where_asked():
    """Of the same curve: only the numbers beside it change."""
    solution = solved("excavator")
    spec = TimePlot("effort", ("effort:boom_cylinder",))
    (axes,), (plain,) = spec.draw(solution).axes, spec.draw(solution, si=True).axes
    assert axes.get_ylabel().endswith("[kN]")
    assert plain.get_ylabel().endswith("[N]")
    np.testing.assert_array_equal(axes.get_lines()[0].get_ydata(), plain.get_lines()[0].get_ydata())
    tick = axes.get_yticks()[2]
    assert float(axes.yaxis.get_major_formatter()(tick, 2)) == pytest.approx(1e-3 * tick)
    maps = SectionMaps("maps", "boom")
    peak = solution.peak("section:boom:bending")
    assert f"peak {peak.value / 1e3:.4g} kN m" in maps.draw(solution).axes[2].get_title()
    assert f"peak {peak.value:.4g} N m" in maps.draw(solution, si=True).axes[2].get_title()
    small = MechanismDrawing(count=1)
    assert small.draw(solved("engine")).axes[0].get_xlabel() == "x [mm]"
    assert small.draw(solved("engine"), si=True).axes[0].get_xlabel() == "x [m]"
    assert small.draw(solution).axes[0].get_xlabel() == "x [m]"


def test_what_is_not_there_is_not_drawn(slider_crank, tmp_path):
    solution = evaluate(slider_crank.scene, wanted=["effort"], t=(0, 0.08, 21))
    drawn = list(draw(solution, slider_crank.figures, tmp_path))
    assert [spec.name for spec, path in drawn if path] == ["fig07_torque"]
    assert [path.name for path in tmp_path.iterdir()] == ["fig07_torque.png"]


def test_default_figures_cover_the_solution(solution):
    names = {spec.name for spec in default_figures(solution)}
    assert {
        "motion_O",
        "motion_guide",
        "effort_O",
        "reaction_guide",
        "section_rod",
        "section_crank",
        "mechanism",
    } <= names


def test_what_is_no_spec_is_named(solution, tmp_path):
    with pytest.raises(DeclarationError, match="draw: specs: expected a list, each a TimePlot"):
        list(draw(solution, ["fig"], tmp_path))
    with pytest.raises(UnknownNameError, match=r"unknown part in figure 'x' 'Q'; valid: crank"):
        list(draw(solution, [TimePlot("x", ("effort:Q",))], tmp_path))
    for specs in ([TimePlot("../x", ("effort:O",))], [TimePlot("x", ("effort:O",))] * 2):
        with pytest.raises(
            DeclarationError, match="expected letters, digits, underscores and hyphens"
        ):
            list(draw(solution, specs, tmp_path))
    assert not list(tmp_path.iterdir())


def texts(figure):
    return [text.get_text().replace("\N{MINUS SIGN}", "-") for text in figure.axes[0].texts]


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


def lines(axes, label):
    return [line for line in axes.get_lines() if line.get_label() == label]


@pytest.mark.parametrize("case", ["connecting_rod", "excavator", "v_twin"])
def test_diagrams_have_the_values_of_the_law(case):
    """Both ends, and what is largest along the link, at the instant of the largest stress or
    bending moment; each is a number of the picture.
    """
    solution = solved(case)
    link = {"connecting_rod": "rod", "excavator": "boom", "v_twin": "left_rod"}[case]
    names = f"stress:{link}:von_mises", f"section:{link}:bending"
    peak = solution.peak(next(name for name in names if name in solution.names()))
    i = int(np.flatnonzero(solution.t == peak.t)[0])
    written = texts(SectionDiagrams("d", (link,)).draw(solution, si=True))
    law = solution.section(link).law
    for force in ("axial", "shear", "bending"):
        size = law.bound(force, np.linspace(0.0, 1.0, 4001))
        largest = solution.extremes(f"section:{link}:{force}")[0][i]
        for value in (*law.on_grid(force, np.array([0.0, 1.0]))[i], largest):
            assert f"{0.0 if abs(value) < 1e-9 * size else value:.4g}" in written


def test_rounding_is_drawn_as_zero():
    """Nothing twists a rod between a ball and a universal joint; a balanced flywheel does not load
    its flange across, and bearings hold a shaft straight.
    """
    solution, torsion = solved("spatial_slider_crank"), "section:rod:torsion"
    assert 0.0 < abs(solution.peak(torsion).value) < 1e-12
    maps = SectionMaps("maps", "rod").draw(solution)
    drawn = [np.abs(axes.collections[0].get_array()).max() for axes in maps.axes[:4]]
    assert drawn[0] > 1.0
    assert drawn[3] == 0.0
    assert maps.axes[3].get_title() == "torsional moment: zero everywhere"
    written = texts(SectionDiagrams("d", ("rod",)).draw(solution))
    assert written[written.index("$T$ [N m]") + 1] == "0"
    v6 = solved("v6")
    for name in ("reaction:flange:fy", "motion:main_fixed:turn_2"):
        assert np.any(v6.array(name))
        (curve,) = curves(TimePlot("p", (name,)).draw(v6))
        assert not curve[:, 1].any()


def test_two_turns_of_an_engine_are_drawn_once():
    """The second turn is the first again."""
    figure = MechanismDrawing(count=4).draw(solved("engine", 81))
    ends = [lines(axes, "crank")[0].get_xydata()[1] for axes in figure.axes]
    angles = np.arctan2([end[1] for end in ends], [end[0] for end in ends])
    np.testing.assert_allclose(np.exp(1j * angles), [1j, -1, -1j, 1], atol=1e-9)


def axes_of_views(azimuth, elevation):
    """Directions to the right and upward on the page, where y is up, of the four views."""
    a, e = np.radians([azimuth, elevation])
    x, y, z = np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), np.array([0, 0, 1.0])
    level = np.cos(a) * x - np.sin(a) * z
    toward = np.cos(e) * level + np.sin(e) * y
    right = np.cross(y, toward) / np.cos(e)
    return (x, -z), (right, np.cross(toward, right)), (x, y), (-z, y)


def test_links_are_where_their_poses_put_them_in_every_view():
    solution = moved("rssr")
    pose = solution.pose("coupler")
    base = np.array([pose.x[0], pose.y[0], pose.z[0]])
    ends = np.array([base, base + 0.4 * pose.axes[0, 0]])
    figure = MechanismDrawing().draw(solution)
    for axes, page in zip(figure.axes, axes_of_views(-60, 25), strict=True):
        found = lines(axes, "coupler")[0].get_xydata()
        np.testing.assert_allclose(found, ends @ np.array(page).T, atol=1e-12)
    assert [axes.get_title() for axes in figure.axes] == [
        "from above (+y)",
        "azimuth -60°, elevation 25°, y up",
        "from the front (+z)",
        "from the right (+x)",
    ]
    at_once = MechanismDrawing(count=1).draw(solution)
    assert "faint" in figure.get_suptitle()
    assert "faint" not in at_once.get_suptitle()


@pytest.mark.sampled(7)
@pytest.mark.parametrize("name", [*CASES, "every kind"])
def test_all_joints_and_paths_of_a_drawing_in_space_are_named(name):
    solution = every_kind() if name == "every kind" else moved(name)
    figure = MechanismDrawing().draw(solution)
    written = [text.get_text().replace("\n", " ") for text in figure.axes[1].texts]
    told = {name for text in written for name in text.split(", ")}
    assert told >= {*solution.description["joints"], *solution.description.get("paths", {})}
    bodies = {text.get_text() for text in figure.legends[0].get_texts()}
    assert bodies >= {*solution.description["bodies"]} - {"ground"}


def test_the_same_solution_gives_the_same_bytes(solution, tmp_path):
    """Of PNG and SVG: neither clocks nor programs nor chance."""
    specs = [SpanPlot("x", "section:rod:bending", 0.03), MechanismDrawing()]
    for svg in (False, True):
        for name in ("one", "two"):
            (tmp_path / name).mkdir(exist_ok=True)
            list(draw(solution, specs, tmp_path / name, svg=svg))
    for path in (tmp_path / "one").iterdir():
        content = path.read_bytes()
        assert content == (tmp_path / "two" / path.name).read_bytes()
        words = (b"Date", b"<dc:date>", b"Matplotlib", b"Software")
        assert not any(word in content for word in words)


def test_what_was_wanted_is_what_is_drawn(solution, tmp_path):
    """A pose that is not there is not drawn; run and plot draw the same."""
    specs = {spec.name: spec for spec in default_figures(solved("v6"))}
    assert specs["bearings"] == PolarPlots("bearings", ("main_fixed", "main_floating"))
    assert set(specs["diagrams"].links) == set(solved("v6").links_with_sections)
    few = [specs["bearings"], specs["diagrams"], MechanismDrawing()]
    assert all(path for _, path in draw(solved("v6"), few, tmp_path))
