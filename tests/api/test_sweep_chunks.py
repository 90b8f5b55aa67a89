"""Chunks made here are what HDF5 and zlib read."""

import zlib

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import FILTERS, deflated, encoded, fletcher32

pytestmark = pytest.mark.quick

RANDOM = np.random.default_rng(8)
KINDS = {
    "smooth": np.sin(np.linspace(0, 3, 70_000)),
    "noise": RANDOM.random(70_000),
    "zeros": np.zeros(70_000),
    "missing": np.where(RANDOM.random(70_000) < 0.5, np.nan, 1.0),
    "bytes": RANDOM.integers(-2, 3, 70_000).astype(np.int8),
    "one": np.array([3.0]),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("chunk", [1, 1000, 32_768, 100_000])
def test_hdf5_reads_them_and_trusts_their_checksums(tmp_path, kind, chunk):
    values = KINDS[kind][: 40 * chunk]
    chunk = min(chunk, values.size)
    with h5py.File(tmp_path / "x.h5", "w") as h:
        dataset = h.create_dataset("x", values.shape, values.dtype, chunks=(chunk,), **FILTERS)
        for start in range(0, values.size, chunk):
            piece = values[start : start + chunk]
            dataset.id.write_direct_chunk((start,), encoded(np.pad(piece, (0, chunk - piece.size))))
    with h5py.File(tmp_path / "x.h5") as h:
        assert h["x"].fletcher32
        np.testing.assert_array_equal(h["x"][()], values)


@pytest.mark.parametrize("kind", KINDS)
def test_the_checksum_is_that_of_hdf5(tmp_path, kind):
    """HDF5's own chunk, checksum and all, where there is no other filter."""
    values = KINDS[kind]
    with h5py.File(tmp_path / "x.h5", "w") as h:
        h.create_dataset("x", data=values, chunks=values.shape, fletcher32=True)
        stored = h["x"].id.read_direct_chunk((0,))[1]
    assert stored[:-4] == values.tobytes()
    assert int.from_bytes(stored[-4:], "little") == fletcher32(values.tobytes())


@given(st.binary(min_size=1, max_size=300))
def test_the_checksum_of_any_bytes(content):
    """As HDF5 writes it down: word by word, folded as it goes."""
    first = second = 0
    padded = content + b"\0" * (len(content) % 2)
    for k in range(0, len(padded), 2):
        first += padded[k] << 8 | padded[k + 1]
        second += first
        first, second = ((total & 0xFFFF) + (total >> 16) for total in (first, second))
        first, second = ((total & 0xFFFF) + (total >> 16) for total in (first, second))
    assert fletcher32(content) == second << 16 | first


def test_the_checksum_of_many_bytes():
    """Where sums of words of 16 bits would not fit into 32: there a word counts as often as words
    follow it.
    """
    count = 1 << 25
    assert fletcher32(b"\xff" * count + b"\0\1") == 1 << 16 | 1
    assert fletcher32(b"\0\1" + bytes(2 * count)) == (count + 1) % 0xFFFF << 16 | 1


@settings(deadline=None)
@given(st.integers(1, 8), st.integers(1, 200_000), st.integers(0, 255))
def test_zlib_reads_what_is_partly_stored(rows, size, value):
    planes = RANDOM.integers(0, 256, (rows, size), np.uint8)
    planes[::2] = value
    assert zlib.decompress(deflated(planes)) == planes.tobytes()


def test_noise_is_stored_and_the_rest_is_small():
    planes = np.vstack(
        [RANDOM.integers(0, 256, (5, 30_000), np.uint8), np.zeros((3, 30_000), np.uint8)]
    )
    assert 5 * 30_000 < len(deflated(planes)) < 5 * 30_000 + 1000
