"""Names beside their points: apart from each other, within the picture, near."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import apart
from internals import labels_placed as placed

pytestmark = pytest.mark.quick

BOX = (0.0, 0.0, 400.0, 300.0)


def overlaps(corners, sizes):
    low = np.maximum(corners[:, None], corners[None])
    high = np.minimum((corners + sizes)[:, None], (corners + sizes)[None])
    both = np.prod(np.maximum(high - low, 0.0), axis=2)
    return both[~np.eye(len(corners), dtype=bool)].max(initial=0.0)


@settings(deadline=None)
@given(
    anchors=st.lists(st.tuples(st.floats(10, 390), st.floats(10, 290)), min_size=1, max_size=9),
    width=st.floats(5, 60),
)
def test_names_are_apart_and_inside(anchors, width):
    anchors, sizes = np.array(anchors), np.tile([width, 10.0], (len(anchors), 1))
    corners = placed(anchors, sizes, anchors, BOX)
    assert overlaps(corners, sizes) == 0.0
    assert (corners >= 0.0).all()
    assert (corners + sizes <= [400.0, 300.0]).all()
    assert max(apart(*one) for one in zip(corners, sizes, anchors, strict=True)) <= 70.0


def test_names_of_points_that_all_are_one_are_apart():
    anchors, sizes = np.tile([200.0, 150.0], (12, 1)), np.tile([40.0, 10.0], (12, 1))
    assert overlaps(placed(anchors, sizes, anchors, BOX), sizes) == 0.0


def test_a_name_goes_where_nothing_is():
    """All around a point but below it is full."""
    x, y = np.meshgrid(np.arange(100.0, 300.0, 4.0), np.arange(150.0, 250.0, 4.0))
    things = np.column_stack([x.ravel(), y.ravel()])
    (corner,) = placed([[200.0, 150.0]], [[30.0, 10.0]], things, BOX)
    assert corner[1] + 10.0 < 150.0


def test_one_name_is_beside_its_point():
    (corner,) = placed([[200.0, 150.0]], [[30.0, 10.0]], np.zeros((0, 2)), BOX)
    assert corner[1] > 150.0
    assert 0.0 < apart(corner, np.array([30.0, 10.0]), np.array([200.0, 150.0])) < 10.0
