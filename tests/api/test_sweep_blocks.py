"""Blocks: runs of designs that are chunks of the file."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import Queue, chunk_of, slabs

pytestmark = pytest.mark.quick


@settings(deadline=None)
@given(st.lists(st.integers(1, 7), min_size=1, max_size=4), st.integers(1, 200))
def test_slabs_are_chunks_and_runs_of_designs(dims, target):
    chunk = chunk_of(dims, target)
    assert math.prod(chunk) <= target
    numbers = np.arange(math.prod(dims)).reshape(dims)
    after, places = 0, set()
    for start, stop, where in slabs(dims, chunk):
        assert start == after
        np.testing.assert_array_equal(numbers[where].ravel(), np.arange(start, stop))
        corners = np.stack(np.unravel_index([start, stop - 1], dims)) // np.array(chunk)[:, None]
        assert (corners[:, 0] == corners[:, 1]).all(), "a slab crosses chunks"
        places.add(tuple(corners[:, 0]))
        after = stop
    assert after == numbers.size
    assert len(places) == sum(1 for _ in slabs(dims, chunk))


@given(st.integers(1, 10**7), st.integers(1, 10**5))
def test_the_last_chunk_is_hardly_empty(length, target):
    (chunk,) = chunk_of([length], target)
    assert -(-length // chunk) * chunk < length + -(-length // chunk)


def test_a_queue_that_was_stopped_hands_out_no_more():
    queue = Queue((k, k + 1) for k in range(3))
    assert queue.take() == (0, 1)
    queue.stop()
    assert queue.take() is None
    assert queue.stopped


def test_a_queue_ends():
    queue = Queue([(0, 1)])
    assert [queue.take(), queue.take()] == [(0, 1), None]
    assert not queue.stopped
