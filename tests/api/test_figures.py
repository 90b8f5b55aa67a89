"""Figures: each spec draws what it says, from the arrays of the solution."""

import numpy as np
import pytest
from internals import (
    PATH,
    MechanismDrawing,
    SectionMaps,
    SpanPlot,
    TimePlot,
    draw_mechanism,
    dump_specs,
    figures,
    parse_specs,
)
from matplotlib.colors import to_rgb
from matplotlib.text import Text
from reports import solved, to_polygon

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.quick


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


def test_series_that_are_rounding_are_drawn_as_zero():
    """A balanced flywheel does not load its flange across, and bearings hold a shaft straight."""
    solution = solved("v6")
    for name in ("reaction:flange:fy", "motion:main_fixed:turn_2"):
        assert np.any(solution.array(name))
        (curve,) = curves(TimePlot("p", (name,)).draw(solution))
        assert not curve[:, 1].any()


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


def test_resultants_are_drawn_where_their_reactions_are(solution, slider_crank, tmp_path):
    spec = TimePlot("size", ("reaction:guide:resultant",))
    assert [path.name for _, path in figures.draw(solution, [spec], tmp_path) if path] == [
        "size.png"
    ]
    without = evaluate(slider_crank.scene, wanted=["effort"], t=(0, 0.08, 21))
    assert [path for _, path in figures.draw(without, [spec], tmp_path)] == [None]


def test_sections_of_two_links_are_told_apart(solution):
    figure = TimePlot("two", ("section:rod:axial", "section:crank:axial"), xi=(0.5,)).draw(solution)
    texts = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert texts == [r"rod axial, $\xi/l$ = 0.5", r"crank axial, $\xi/l$ = 0.5"]


def test_span_plot_takes_the_nearest_instant(solution):
    figure = SpanPlot("bending", "section:rod:bending", 0.03004, "bending").draw(solution)
    np.testing.assert_array_equal(curves(figure)[0][:, 1], solution.section("rod").bending[300])
    assert "t = 0.03 s" in figure.axes[0].get_title()


def test_maps_mark_the_peaks(solution):
    figure = SectionMaps("maps", "rod").draw(solution)
    marks = [axes.get_lines()[0].get_xydata()[0] for axes in figure.axes if axes.get_lines()]
    peaks = [solution.peak(f"section:rod:{force}") for force in ("axial", "shear", "bending")]
    np.testing.assert_array_equal(marks, [(peak.t, peak.xi) for peak in peaks])


def test_maps_of_a_grid_finer_than_the_picture_are_thinned(slider_crank):
    solution = evaluate(
        slider_crank.scene, t=(0, 0.08, 4001), xi=(0, 1, 1700), wanted=["section:rod"]
    )
    figure = SectionMaps("maps", "rod").draw(solution)
    assert figure.axes[0].collections[0].get_array().shape == (850, 1334)


def test_drawing_puts_the_links_where_they_are(solution):
    figure = MechanismDrawing(count=4).draw(solution)
    assert len(figure.axes) == 4
    lines = {line.get_label(): line.get_xydata() for line in figure.axes[1].get_lines()}
    np.testing.assert_allclose(lines["crank"], [(0, 0), (0, 0.1)], atol=1e-5)
    np.testing.assert_allclose(lines["rod"], [(0, 0.1), (np.sqrt(0.03), 0)], atol=1e-5)
    np.testing.assert_allclose(lines["slider"], [(np.sqrt(0.03), 0)], atol=1e-5)


def test_names_of_a_drawing_hide_neither_each_other_nor_leave_it():
    """Many joints, of which some are near each other; ten bodies, each of a colour of its own."""
    described = solved("excavator").description
    figure = draw_mechanism(solved("excavator"), 4)
    figure.draw_without_rendering()
    for axes in figure.axes:
        # A name alone: the extent of an annotation has its line too, all around it.
        frame = axes.get_window_extent()
        boxes = [Text.get_window_extent(text) for text in axes.texts]
        told = {name for text in axes.texts for name in text.get_text().split(", ")}
        assert told == {*described["joints"], *described["paths"]}
        for k, box in enumerate(boxes):
            assert frame.x0 <= box.x0 <= box.x1 <= frame.x1
            assert frame.y0 <= box.y0 <= box.y1 <= frame.y1
            assert not [other for other in boxes[:k] if box.overlaps(other)]
    assert (
        len({handle.get_color() for handle in figure.axes[0].get_legend_handles_labels()[0]}) == 10
    )


def strong(axes, label):
    return next(line for line in axes.get_lines() if line.get_label() == label)


def test_postures_of_two_turns_are_drawn_once_and_one_over_the_other():
    """Two turns of an engine: the second one is the first again.

    The first posture is strong, the others are faint.
    """
    solution = solved("engine", 81)
    figure = draw_mechanism(solution, 4)
    angles = [np.arctan2(*strong(axes, "crank").get_xydata()[1][::-1]) for axes in figure.axes]
    np.testing.assert_allclose(np.exp(1j * np.array(angles)), [1j, -1, -1j, 1], atol=1e-9)
    (axes,) = draw_mechanism(solution, 8, overlay=True).axes
    cranks = [
        line for line in axes.get_lines() if line.get_color() == strong(axes, "crank").get_color()
    ]
    assert len(cranks) == 8
    ends = [line.get_xydata()[1] for line in cranks]
    assert min(np.hypot(*(a - b)) for k, a in enumerate(ends) for b in ends[:k]) > 0.02
    assert sorted(line.get_alpha() for line in cranks)[-2:] == [pytest.approx(0.2), 1.0]
    assert axes.get_title().startswith("8 positions from t = 0 s")


def test_bodies_with_three_joints_are_plates_and_rotors_are_discs():
    axes = draw_mechanism(solved("excavator"), 1).axes[0]
    bucket = next(
        patch
        for patch in axes.patches
        if patch.get_facecolor()[:3] == to_rgb(strong(axes, "bucket").get_color())
    )
    assert len(bucket.get_xy()) - 1 == 4  # the teeth are a corner too
    cam = draw_mechanism(solved("roller_cam"), 1).axes[0]
    profile, roller = (patch.get_xy()[:-1] for patch in cam.patches)
    centre = roller.mean(axis=0)
    assert np.hypot(*(roller - centre).T) == pytest.approx(0.012)
    assert to_polygon(centre, profile) == pytest.approx(0.012, rel=1e-3)


def test_only_declared_points_leave_their_ways():
    solution = solved("scara")
    (axes,) = draw_mechanism(solution, 1).axes
    ways = [line for line in axes.get_lines() if len(line.get_xdata()) == solution.t.size]
    assert [line.get_color() for line in ways] == [PATH]


@pytest.mark.sampled(5)
@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("name", ["connecting_rod", "engine"])
def test_titles_are_whole(name, count):
    figure = draw_mechanism(solved(name), count)
    figure.draw_without_rendering()
    boxes = [axes.title.get_window_extent() for axes in figure.axes]
    for k, box in enumerate(boxes):
        assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1
        assert box.y1 <= figure.bbox.y1
        assert not any(box.overlaps(other) for other in boxes[:k])


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


def test_springs_are_whole_on_a_drawing():
    """One whose end on the ground is far from everything else."""
    m = Mechanism("far")
    bar = m.link("bar", length=1.0, mass=1.0)
    m.revolute("O", m.ground, bar)
    m.spring("coil", m.ground.at(-4.0, 3.0), bar.tip, stiffness=1.0, length=1.0)
    figure = draw_mechanism(
        evaluate(Scene(m, {"O": polynomial(0, 1)}, t=(0, 1, 5)), backend="vm"), 2
    )
    for axes in figure.axes:
        assert axes.get_xlim()[0] < -4.0
        assert axes.get_ylim()[1] > 3.0


def test_specs_survive_the_file(slider_crank):
    assert parse_specs(dump_specs(slider_crank.figures)) == slider_crank.figures
    assert parse_specs("") == ()


def test_what_is_not_there_is_not_drawn(slider_crank, tmp_path):
    solution = evaluate(slider_crank.scene, wanted=["effort"], t=(0, 0.08, 21))
    drawn = list(figures.draw(solution, slider_crank.figures, tmp_path))
    assert [spec.name for spec, path in drawn if path] == ["fig07_torque"]
    assert [path.name for path in tmp_path.iterdir()] == ["fig07_torque.png"]


def test_default_figures_cover_the_solution(solution):
    names = {spec.name for spec in figures.default_figures(solution)}
    assert {
        "motion_O",
        "motion_guide",
        "effort_O",
        "reaction_guide",
        "section_rod",
        "section_crank",
        "mechanism",
    } <= names


def test_the_same_solution_gives_the_same_bytes(solution, tmp_path):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        list(figures.draw(solution, [SpanPlot("x", "section:rod:bending", 0.03)], tmp_path / name))
    assert (tmp_path / "one" / "x.png").read_bytes() == (tmp_path / "two" / "x.png").read_bytes()


def test_what_is_no_spec_is_named(solution, tmp_path):
    with pytest.raises(DeclarationError, match="draw: specs: expected a list, each a TimePlot"):
        list(figures.draw(solution, ["fig"], tmp_path))
    with pytest.raises(UnknownNameError, match=r"unknown part in figure 'x' 'Q'; valid: crank"):
        list(figures.draw(solution, [TimePlot("x", ("effort:Q",))], tmp_path))
    for specs in ([TimePlot("../x", ("effort:O",))], [TimePlot("x", ("effort:O",))] * 2):
        with pytest.raises(
            DeclarationError, match="expected letters, digits, underscores and hyphens"
        ):
            list(figures.draw(solution, specs, tmp_path))
    assert not list(tmp_path.iterdir())
