"""Chunks as HDF5 keeps them, made here: shuffled, deflated and summed by several threads, where the library has one.

The low bytes of measured numbers are noise, on which a compressor spends its time in vain. So the bytes of a chunk, the lowest ones
of all numbers first, are deflated where a sample shrinks, and stored as they are elsewhere; any zlib reads both.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from itertools import groupby
from typing import Any

import numpy as np

FILTERS = {"shuffle": True, "compression": "gzip", "compression_opts": 1, "fletcher32": True}
"""What tells HDF5 how such chunks are read."""

_SAMPLE = 1 << 12
_REPEATS, _OFTEN = 0.1, 4.0
_STORED = 0xFFFF
_HEAD, _LAST = b"\x78\x01", b"\x03\x00"


def encoded(values: Any, size: int) -> bytes:
    """A chunk of ``size`` numbers, the first of which are ``values``: shuffle, deflate and Fletcher-32, as :data:`FILTERS` say."""
    whole = np.zeros(size, values.dtype)
    whole[: values.size] = values.ravel()
    content = deflated(np.ascontiguousarray(whole.view(np.uint8).reshape(size, -1).T))
    return content + struct.pack("<I", fletcher32(content))


def deflated(planes: Any) -> bytes:
    """A zlib stream of the rows of an array of bytes, one after another."""
    pieces = [_HEAD]
    for worth, rows in groupby(planes, _shrinks):
        content = np.concatenate(list(rows)).tobytes()
        if worth:
            compressor = zlib.compressobj(1, zlib.DEFLATED, -zlib.MAX_WBITS)
            # A full flush ends on a whole byte, with nothing that a later block would look back to.
            pieces += [compressor.compress(content), compressor.flush(zlib.Z_FULL_FLUSH)]
        else:
            pieces += _stored(content)
    return b"".join([*pieces, _LAST, struct.pack(">I", zlib.adler32(planes))])


def fletcher32(content: bytes) -> int:
    """HDF5's checksum: over 16-bit words, most significant byte first, their sum and the sum of their running sums, modulo 65535.

    A sum that is not zero is one of 1 to 65535, as repeated folding leaves it.
    """
    words = np.frombuffer(content + b"\0" * (len(content) % 2), ">u2").astype(np.int64)
    first, second = int(words.sum()), int(words @ np.arange(words.size, 0, -1))
    return _folded(second) << 16 | _folded(first)


def _folded(total: int) -> int:
    return (total - 1) % 0xFFFF + 1 if total else 0


def _shrinks(row: Any) -> bool:
    """Whether neighbours repeat, or some bytes come much more often than others; to ask zlib itself takes as long as to deflate."""
    sample = row[:_SAMPLE]
    if np.count_nonzero(sample[1:] == sample[:-1]) > _REPEATS * sample.size:
        return True
    return bool(np.bincount(sample).max() > _OFTEN * (1.0 + sample.size / 256))


def _stored(content: bytes) -> Iterator[bytes]:
    for start in range(0, len(content), _STORED):
        piece = content[start : start + _STORED]
        yield struct.pack("<BHH", 0, len(piece), len(piece) ^ 0xFFFF)
        yield piece
