"""Figures: each draws what it says, from the arrays of the solution; mechanisms are where their
poses put them, in the plane and in space.
"""

import math

import numpy as np
import pytest
from drawn_scenes import CASES, every_kind, moved
from hypothesis import given, settings
from hypothesis import strategies as st
from reports import solved

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.errors import DeclarationError
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


def test_maps_mark_the_peaks(solution):
    figure = SectionMaps("maps", "rod").draw(solution)
    marks = [axes.get_lines()[0].get_xydata()[0] for axes in figure.axes if axes.get_lines()]
    peaks = [solution.peak(f"section:rod:{force}") for force in ("axial", "shear", "bending")]
    np.testing.assert_array_equal(marks, [(peak.t, peak.xi) for peak in peaks])


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
    (curve,) = curves(TimePlot("p", ("reaction:flange:fy",)).draw(solved("v6")))
    assert not curve[:, 1].any()


def test_each_unit_has_axes_of_its_own(solution):
    """A torque and forces share no scale: two panels over one time, each named by its own
    quantities; a factor is that of the curve, and a section is drawn at ratios.
    """
    names = ("effort:O", "reaction:guide:fy", "reaction:guide:resultant", "motion:O")
    figure = TimePlot("both", names, "both", note="a note").draw(solution)
    assert [axes.get_ylabel().replace("\n", " ") for axes in figure.axes] == [
        "effort of the drive [N m]",
        "reaction of the joint, resultant of the joint's reaction [N]",
        "coordinate of the joint [rad]",
    ]
    assert [axes.get_title() for axes in figure.axes] == ["both", "", ""]
    assert [axes.get_xlabel() for axes in figure.axes] == ["", "", "t [s]"]
    assert figure.get_supxlabel() == "a note"
    (curve,) = curves(TimePlot("x", ("reaction:guide:fy",), factor=-1).draw(solution))
    np.testing.assert_array_equal(curve.T, [solution.t, -solution.reaction("guide").fy])
    section, spec = solution.section("rod"), TimePlot("x", ("section:rod:axial",), xi=(0.25, 0.5))
    _, half = curves(spec.draw(solution))
    np.testing.assert_allclose(half[:, 1], section.axial[:, 50], rtol=1e-12)
    figure = SpanPlot("bending", "section:rod:bending", 0.03004, "bending").draw(solution)
    np.testing.assert_array_equal(curves(figure)[0][:, 1], section.bending[300])
    assert "t = 0.03 s" in figure.axes[0].get_title()


def test_axes_have_units_that_people_read_and_si_where_asked():
    """Of the same curve: only the numbers beside it change."""
    solution = solved("excavator")
    spec = TimePlot("effort", ("effort:boom_cylinder",))
    (axes,), (plain,) = spec.draw(solution).axes, spec.draw(solution, si=True).axes
    assert (axes.get_ylabel()[-4:], plain.get_ylabel()[-3:]) == ("[kN]", "[N]")
    np.testing.assert_array_equal(axes.get_lines()[0].get_ydata(), plain.get_lines()[0].get_ydata())
    tick = axes.get_yticks()[2]
    assert float(axes.yaxis.get_major_formatter()(tick, 2)) == pytest.approx(1e-3 * tick)
    maps, peak = SectionMaps("maps", "boom"), solution.peak("section:boom:bending").value
    for si, words in ((False, f"{peak / 1e3:.4g} kN m"), (True, f"{peak:.4g} N m")):
        title = maps.draw(solution, si=si).axes[2].get_title().replace("\N{MINUS SIGN}", "-")
        assert f"peak {words}" in title


def test_what_was_wanted_is_what_is_drawn(solution, slider_crank, tmp_path):
    """By default all that there is; what was not evaluated is left out; twice the same bytes, which
    tell neither clocks nor programs.
    """
    names = {spec.name for spec in default_figures(solution)}
    assert {"motion_O", "effort_O", "reaction_guide", "section_rod", "mechanism"} <= names
    bearings = PolarPlots("bearings", ("main_fixed", "main_floating"))
    assert bearings in default_figures(solved("v6"))
    for name in ("few", "one", "other"):
        (tmp_path / name).mkdir()
    few = evaluate(slider_crank.scene, wanted=["effort"], t=(0, 0.08, 21))
    drawn = list(draw(few, slider_crank.figures, tmp_path / "few"))
    assert [path.name for _, path in drawn if path] == ["fig07_torque.png"]
    for spec, svg in (
        (SpanPlot("x", "section:rod:bending", 0.03), True),
        (MechanismDrawing(), False),
    ):
        one, other = (
            [path.read_bytes() for _, path in draw(solution, [spec], tmp_path / name, svg=svg)]
            for name in ("one", "other")
        )
        assert one == other
        words = (b"Date", b"<dc:date>", b"Matplotlib", b"Software")
        assert not any(word in content for content in one for word in words)


NOT_SPECS = [
    (["fig"], "draw: specs: expected a list, each a TimePlot"),
    ([TimePlot("x", ("effort:Q",))], "unknown part in figure 'x' 'Q'; valid: crank"),
    ([TimePlot("../x", ("effort:O",))], "expected letters, digits, underscores and hyphens"),
    ([TimePlot("x", ("effort:O",))] * 2, "expected letters, digits, underscores and hyphens"),
]


def test_what_is_no_spec_is_named(solution, tmp_path):
    for specs, says in NOT_SPECS:
        with pytest.raises(DeclarationError, match=says):
            list(draw(solution, specs, tmp_path))
    assert not list(tmp_path.iterdir())


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


@settings(max_examples=8)
@given(
    st.floats(0.35, 0.65),
    st.lists(st.integers(20, 90), min_size=4, max_size=4, unique=True),
    st.sampled_from([1, -1]),
)
def test_marks_stand_at_both_sides_of_a_load_point(place, pushes, sign):
    """Of a cantilever without weight: N, V and M jump by the force and its moment, beside their
    sums by hand; the one of the base's side stands to the left.
    """
    h, v, h2, v2 = (sign * push for push in pushes)
    m = Mechanism("shelf")
    arm = m.link("arm", length=1.0, mass=0.0)
    m.weld("wall", m.ground, arm)
    m.force("middle", arm.at(place, 0.25), x=h, y=v)
    m.force("end", arm.tip, x=h2, y=v2)
    solution = evaluate(Scene(m, {}, t=(0, 0, 1)), backend="vm")
    (axes,) = SectionDiagrams("d", ("arm",)).draw(solution, si=True).axes
    shown = {(text.get_text().replace("\N{MINUS SIGN}", "-"), text.get_ha()) for text in axes.texts}
    moment = v2 * (1.0 - place)
    for base, tip in ((h + h2, h2), (v + v2, v2), (moment - 0.25 * h, moment)):
        assert {(f"{base:.4g}", "right"), (f"{tip:.4g}", "left")} <= shown


def test_two_turns_of_an_engine_are_drawn_once():
    """The second turn is the first again."""
    figure = MechanismDrawing(count=4).draw(solved("engine", 81))
    ends = [lines(axes, "crank")[0].get_xydata()[1] for axes in figure.axes]
    turns = [complex(*end) / abs(complex(*end)) for end in ends]
    np.testing.assert_allclose(turns, [1j, -1, -1j, 1], atol=1e-9)


def views(azimuth, elevation):
    """Directions to the right and upward on the page, where y is up, of the four views."""
    a, e = np.radians([azimuth, elevation])
    x, y, z = np.eye(3)
    toward = np.cos(e) * (np.cos(a) * x - np.sin(a) * z) + np.sin(e) * y
    right = np.cross(y, toward) / np.cos(e)
    return (x, -z), (right, np.cross(toward, right)), (x, y), (-z, y)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("name", [*CASES, "every kind"])
def test_drawings_in_space_have_links_where_their_poses_put_them_and_name_all(name):
    solution = every_kind() if name == "every kind" else moved(name)
    figure = MechanismDrawing().draw(solution)
    written = [text.get_text().replace("\n", " ") for text in figure.axes[1].texts]
    told = {name for text in written for name in text.split(", ")}
    assert told >= {*solution.description.joints, *solution.description.paths}
    bodies = {text.get_text() for text in figure.legends[0].get_texts()}
    assert bodies >= {*solution.description.bodies} - {"ground"}
    if name == "rssr":
        pose = solution.pose("coupler")
        base = np.array([pose.x[0], pose.y[0], pose.z[0]])
        ends = np.array([base, base + 0.4 * pose.axes[0, 0]])
        for axes, page in zip(figure.axes, views(-60, 25), strict=True):
            found = lines(axes, "coupler")[0].get_xydata()
            np.testing.assert_allclose(found, ends @ np.array(page).T, atol=1e-12)
        assert figure.axes[1].get_title() == "azimuth -60°, elevation 25°, y up"
