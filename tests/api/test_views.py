"""Views of space: what is right and up on the page, and how four of them share it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import upright, view, views
from internals import views_page as page

pytestmark = pytest.mark.quick

ANGLES = st.floats(-720.0, 720.0)


@pytest.mark.parametrize(
    ("gravity", "up"),
    [
        ((0, 0, -9.81), (0, 0, 1)),
        ((0, -9.81, 0), (0, 1, 0)),
        ((-9.81, 0, 0), (1, 0, 0)),
        ((0, 0, 9.81), (0, 0, -1)),
        ((1.0, -5.0, -8.0), (0, 0, 1)),
        ((0, 0, 0), (0, 0, 1)),
    ],
)
def test_up_is_against_gravity(gravity, up):
    axes = upright(gravity)
    np.testing.assert_array_equal(axes[2], up)
    np.testing.assert_array_equal(np.cross(axes[0], axes[1]), axes[2])
    np.testing.assert_array_equal(axes @ axes.T, np.eye(3))


@settings(deadline=None)
@given(
    azimuth=ANGLES,
    elevation=ANGLES,
    gravity=st.sampled_from([(0, 0, -1), (0, -1, 0), (-1, 0, 0), (0, 0, 1)]),
)
def test_a_view_is_from_where_it_says(azimuth, elevation, gravity):
    """Whoever looks sees the direction from which he does as a point, and lengths across it as they
    are.
    """
    axes = upright(gravity)
    a, e = math.radians(azimuth), math.radians(elevation)
    toward = math.cos(e) * (math.cos(a) * axes[0] + math.sin(a) * axes[1]) + math.sin(e) * axes[2]
    one = view(axes, azimuth, elevation)
    np.testing.assert_allclose(one.on_page(toward), 0.0, atol=1e-14)
    np.testing.assert_allclose(np.cross(one.right, one.up), toward, atol=1e-14)
    np.testing.assert_allclose(one.on_page(np.array([one.right, one.up])), np.eye(2), atol=1e-14)
    assert one.right @ axes[2] == pytest.approx(0.0, abs=1e-14)


def test_views_along_axes_have_their_coordinates_to_the_last_digit():
    seen = [one.coordinates for one in views((0, 0, -9.81), -60, 25)]
    assert seen == [("x", "y"), None, ("x", "z"), ("y", "z")]
    assert [one.coordinates for one in views((0, -9.81, 0), -60, 25)] == [
        ("x", "-z"),
        None,
        ("x", "y"),
        ("-z", "y"),
    ]
    point = np.array([0.1, 0.2, 0.3])
    np.testing.assert_array_equal(views((0, -9.81, 0), -60, 25)[3].on_page(point), [-0.3, 0.2])


def test_titles_say_from_where():
    titles = [one.title for one in views((0, -9.81, 0), 30, -10)]
    assert titles == [
        "from above (+y)",
        "azimuth 30°, elevation -10°, y up",
        "from the front (+z)",
        "from the right (+x)",
    ]


@settings(deadline=None)
@given(
    seed=st.integers(0, 10**6),
    flat=st.sampled_from([(1, 1, 1), (1, 1e-3, 1), (1e3, 1, 1), (1, 1, 0), (0, 0, 1)]),
)
def test_a_page_has_one_scale_and_holds_all(seed, flat):
    points = np.random.default_rng(seed).normal(size=(9, 3)) * flat
    size = np.ptp(points, axis=0).max()
    four = views((0, 0, -9.81), -60, 25)
    sheet = page(four, points, (0.1 * size,) * 4, 0.3, 0.4)
    for one, (left, bottom, wide, high), (x0, x1, y0, y1) in zip(
        four, sheet.places, sheet.boxes, strict=True
    ):
        assert wide / (x1 - x0) == pytest.approx(sheet.scale, rel=1e-9)
        assert high / (y1 - y0) == pytest.approx(sheet.scale, rel=1e-9)
        assert 0.0 < left < left + wide < sheet.size[0]
        assert 0.4 < bottom < bottom + high < sheet.size[1] - 0.3
        room = np.array([x1, y1]) - one.on_page(points), one.on_page(points) - [x0, y0]
        assert min(side.min() for side in room) >= 0.0999 * size
    assert max(sheet.size) < 12.0
    above, _, front, right = sheet.boxes
    assert above[:2] == pytest.approx(front[:2])
    assert front[2:] == pytest.approx(right[2:])
    (l0, b0, w0, _), (l1, *_), (_, b2, _, h2), _ = sheet.places
    assert l0 + w0 < l1
    assert b2 + h2 < b0
