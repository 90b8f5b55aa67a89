"""What notebooks show of a solution: a drawing where the poses put it, its peaks, and the page of
its report in a frame.
"""

import html
import re

import numpy as np
import pytest
from drawn_scenes import every_kind
from internals import place_of, still, upright, view
from internals import report_page as page
from reports import CASES, HOSTILE, hostile, press, solved

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.case import load_case
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import polynomial


def circles(text):
    return np.array(
        [
            [float(x), float(y)]
            for x, y in re.findall(r'<circle cx="([-\d.]+)" cy="([-\d.]+)"', text)
        ]
    )


def matched(drawn, places):
    """How far drawn points are from places on the sheet, after the best scale and shift: the
    drawing's y runs downward.
    """
    drawn = drawn * [1.0, -1.0]
    a, b = drawn - drawn.mean(axis=0), places - places.mean(axis=0)
    return np.abs(a - b * (np.sum(a * b) / np.sum(b * b))).max()


def test_joints_are_drawn_where_they_are_in_the_plane():
    solution = solved("four_bar")
    joints = solution.description["joints"].values()
    poses = [
        (solution.pose(j["child"]["body"]), complex(j["child"]["x"], j["child"]["y"]))
        for j in joints
    ]
    places = [
        pose.x[0] + 1j * pose.y[0] + local * np.exp(1j * pose.angle[0]) for pose, local in poses
    ]
    assert (
        matched(circles(still(solution)), np.array([[place.real, place.imag] for place in places]))
        < 0.1
    )


def test_joints_are_drawn_where_they_are_in_space():
    solution = every_kind()
    one = view(upright(solution.description["gravity"]), -60, 25)
    places = [
        one.on_page(place_of(solution, joint["child"])[0])
        for joint in solution.description["joints"].values()
    ]
    assert matched(circles(still(solution)), np.array(places)) < 0.1


def test_all_of_a_drawing_is_on_its_sheet():
    for solution in (solved("excavator"), every_kind(), press()):
        x, y = circles(still(solution)).T
        assert 0 < x.min() <= x.max() < 460
        assert 0 < y.min() <= y.max() < 300


def test_a_solution_is_shown_with_its_largest_peaks():
    text = solved("excavator")._repr_html_()
    assert text.count("<svg") == 1
    assert text.count("<tr>") == 13
    largest = max(
        (solved("excavator").peak(f"section:{link}:bending") for link in ("boom", "stick")),
        key=lambda p: abs(p.value),
    )
    assert f"{largest.value:.5g} N m" in text
    assert "certified" in text
    assert text == solved("excavator")._repr_html_()


def test_without_motion_the_peaks_are_shown_alone():
    text = press(wanted=("effort",))._repr_html_()
    assert "<svg" not in text
    assert "effort" in text


def test_a_view_is_the_report_in_a_frame_that_reaches_nothing_else():
    solution = press()
    found = solution.view(500)
    (srcdoc,) = re.findall(r'srcdoc="([^"]*)"', found._repr_html_())
    assert html.unescape(srcdoc) == page(solution)
    assert 'sandbox="allow-scripts allow-modals"' in found._repr_html_()
    assert 'height="500"' in found._repr_html_()
    assert (
        repr(found)
        == "<View of press: a notebook shows it; solution.report('press.html') writes it>"
    )
    for height in (0, -1, 2.5, True, "tall"):
        with pytest.raises(DeclarationError, match=r"expected a (whole number|height in points)"):
            solution.view(height)
    with pytest.raises(DeclarationError, match="want motion too"):
        press(wanted=("effort",)).view()


@pytest.mark.parametrize("name", ["quick_return", "rssr"])
def test_a_scene_is_drawn_as_its_solution_begins(name):
    scene = load_case(CASES / name).scene
    text = scene._repr_html_()
    assert matched(circles(text), circles(still(solved(name))) * [1.0, -1.0]) < 0.2
    for joint in scene.mechanism.joints.values():
        assert f"{joint.name} ({joint.kind})" in text


def test_a_scene_that_cannot_be_assembled_is_told_without_a_drawing():
    m = Mechanism("open")
    crank, rod = m.link("crank", length=0.1, mass=1.0), m.link("rod", length=0.5, mass=1.0)
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.slot("guide", m.ground.at(0, 2), rod.tip, axis=(1, 0))
    text = Scene(m, motion={"O": polynomial(0, 1)}, posture={"rod": 0.0})._repr_html_()
    assert "<svg" not in text
    assert "guide (slot)" in text


def test_no_name_is_markup_in_a_notebook():
    text = hostile()._repr_html_()
    for markup in ("<script", "<img", "<!--"):
        assert markup not in text
    assert html.escape(HOSTILE[0]) in text
