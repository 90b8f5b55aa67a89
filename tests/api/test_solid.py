"""What of a mechanism in space is drawn: points where joints hold them, axes about which they turn,
marks and lines.
"""

import math

import numpy as np
import pytest
from drawn_scenes import CASES, every_kind, moved
from internals import BLOCK, MARKS, cloud_of, direction_of, grounds_of, lines_of, marks_of, place_of
from internals import solid_axes_of as axes_of


@pytest.mark.sampled(7)
@pytest.mark.parametrize("name", CASES)
def test_points_are_where_joints_hold_them(name):
    """A joint that does not slide holds two points together; one that does, on its line, and where
    its motion says.
    """
    solution = moved(name)
    size = np.ptp(cloud_of(solution), axis=0).max()
    for joint in solution.description["joints"].values():
        away = place_of(solution, joint["child"]) - place_of(solution, joint["parent"])
        for (coordinate, kind), axis in zip(
            joint["coordinates"].items(), joint["axes"], strict=True
        ):
            if kind == "slide":
                along = direction_of(solution, joint["parent"]["body"], axis)
                away = away - solution.motion(coordinate).value[:, None] * along
        np.testing.assert_allclose(away, 0.0, atol=1e-9 * size)


@pytest.mark.parametrize("instant", [0, 1, 3])
def test_the_cross_of_a_universal_joint_is_square(instant):
    """One pair of pins is on the parent, the other on the child: they turn with these, and stay at
    right angles.
    """
    solution = moved("cardan_shaft")
    now = solution.during(slice(instant, instant + 1))
    lines = [line.points[1] - line.points[0] for line in axes_of(now, solution, 1.0)]
    bearing, first, second, *others = (line / np.linalg.norm(line) for line in lines)
    tube = (
        place_of(now, {"body": "tube", "x": 0.5, "y": 0, "z": 0})[0]
        - place_of(now, {"body": "tube", "x": 0, "y": 0, "z": 0})[0]
    )
    assert bearing == pytest.approx([1, 0, 0])
    for one, other in (
        (first, bearing),
        (first, second),
        (second, tube),
        (others[0], bearing),
        (others[0], others[1]),
        (others[1], tube),
    ):
        assert one @ other == pytest.approx(0.0, abs=1e-9)


def test_the_cross_of_a_leg_that_stands_upright_at_zero():
    """The first axis stays on the ground; the second is that of the leg that is level."""
    solution = moved("stewart_gough").during(slice(1, 2))
    crosses = [
        line.points[1] - line.points[0]
        for line in axes_of(solution, solution, 1.0)
        if line.style == "-"
    ]
    for k in range(6):
        first, second = crosses[2 * k : 2 * k + 2]
        assert first / np.linalg.norm(first) == pytest.approx([1, 0, 0])
        np.testing.assert_allclose(
            second / np.linalg.norm(second), solution.pose(f"cylinder{k}").axes[0, 1], atol=1e-9
        )


def test_the_second_axis_of_a_cross_is_where_the_turn_about_the_first_puts_it():
    """By Rodrigues' formula from the reported turn, where the child is turned at zero."""
    solution = every_kind().during(slice(3, 4))
    parent, angle = solution.pose("arm").axes[0], solution.motion("universal:turn_1").value[0]
    first, second = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
    expected = (np.cos(angle) * second + np.sin(angle) * np.cross(first, second)) @ parent
    tip = place_of(solution, {"body": "arm", "x": 0.3, "y": 0.0, "z": 0.0})[0]
    found = [
        line.points
        for line in axes_of(solution, solution, 1.0)
        if np.allclose(line.points.mean(axis=0), tip)
    ]
    assert len(found) == 2
    for points, direction in zip(found, (first @ parent, expected), strict=True):
        np.testing.assert_allclose(
            np.diff(points, axis=0)[0] / np.linalg.norm(points[1] - points[0]),
            direction,
            atol=1e-12,
        )


def test_a_line_of_a_slide_reaches_as_far_as_it_goes():
    solution = moved("spatial_slider_crank")
    (guide,) = (
        line for line in axes_of(solution.during(slice(0, 1)), solution, 1.0) if line.style != "-"
    )
    way = solution.motion("guide").value
    assert guide.points[:, 0].min() < min(way.min(), 0.0)
    assert guide.points[:, 0].max() > way.max()
    np.testing.assert_array_equal(guide.points[:, 1:], 0.0)


def test_every_kind_of_joint_has_its_mark():
    solution = every_kind()
    kinds = [joint["kind"] for joint in solution.description["joints"].values()]
    assert set(kinds) == set(MARKS)
    now = solution.during(slice(0, 1))
    marks = [(mark.shape, mark.fill) for mark in marks_of(now)]
    assert all(marks.count(MARKS[kind][:2]) >= kinds.count(kind) for kind in kinds)
    assert len({MARKS[kind][:2] for kind in MARKS}) == len(MARKS)
    assert all(
        np.isfinite(line.points).all() for line in (*lines_of(now), *axes_of(now, solution, 1.0))
    )
    assert sum(1 for _ in grounds_of(now)) == sum(
        "ground" in (joint["parent"]["body"], joint["child"]["body"]) and joint["kind"] != "free"
        for joint in solution.description["joints"].values()
    )


def test_bodies_are_lines_and_what_has_none_is_a_block():
    solution = moved("spatial_slider_crank").during(slice(1, 2))
    lines = {line.body: line for line in lines_of(solution)}
    rod = solution.pose("rod")
    np.testing.assert_allclose(lines["rod"].points[0], [rod.x[0], rod.y[0], rod.z[0]])
    np.testing.assert_allclose(
        np.linalg.norm(np.diff(lines["rod"].points, axis=0)), 0.3, rtol=1e-12
    )
    assert "slider" not in lines
    assert [mark.body for mark in marks_of(solution) if mark.size == BLOCK] == ["slider"]
    point = every_kind().during(slice(0, 1))
    assert "bob" in [mark.body for mark in marks_of(point) if mark.size == BLOCK]


def test_a_plate_spans_the_joints_beside_a_link():
    delta = moved("delta").during(slice(0, 1))
    arms = [line for line in lines_of(delta) if line.body == "arm0"]
    lengths = sorted(float(np.linalg.norm(line.points[1] - line.points[0])) for line in arms)
    assert lengths == pytest.approx([0.08, 0.3, math.hypot(0.3, 0.04), math.hypot(0.3, 0.04)])
