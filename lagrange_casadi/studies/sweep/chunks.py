"""Chunks as HDF5 keeps them, made here: shuffled, deflated and summed by several threads, where the
library has one.

The low bytes of measured numbers are noise, on which a compressor spends its time in vain. So the
bytes of a chunk, the lowest ones of all numbers first, are deflated where a sample shrinks, and
stored as they are elsewhere; any zlib reads both.
"""

from __future__ import annotations

import struct
import zlib
from itertools import groupby
from typing import Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Operand

FILTERS = {"shuffle": True, "compression": "gzip", "compression_opts": 1, "fletcher32": True}
"""Options of HDF5 for such chunks."""

_NEIGHBOURS, _SAMPLE = 1 << 9, 1 << 8
_ROW = 1 << 8
_REPEATS, _OFTEN = 0.1, 4.0
_HEAD, _LAST = b"\x78\x01", b"\x03\x00"


def encoded(values: Operand) -> bytes:
    """A chunk's numbers shuffled, deflated, and with a Fletcher-32 after them, as :data:`FILTERS`
    say.
    """
    content = deflated(np.ascontiguousarray(values.view(np.uint8).reshape(values.size, -1).T))
    return content + struct.pack("<I", fletcher32(content))


def deflated(planes: npt.NDArray[np.uint8]) -> bytes:
    """A zlib stream of the rows of an array of bytes, one after another."""
    pieces: list[Any] = [_HEAD]
    first = 0
    for shrinks, rows in groupby(_shrink(planes)):
        count = len(list(rows))
        content = planes[first : first + count].reshape(-1).data
        first += count
        compressor = zlib.compressobj(int(shrinks), zlib.DEFLATED, -zlib.MAX_WBITS)
        # It ends on a whole byte; what follows is another compressor's, which looks back to
        # nothing.
        pieces += [compressor.compress(content), compressor.flush(zlib.Z_SYNC_FLUSH)]
    return b"".join([*pieces, _LAST, struct.pack(">I", zlib.adler32(planes.data))])


def fletcher32(content: bytes) -> int:
    """HDF5's checksum: over 16-bit words, most significant byte first, their sum and the sum of
    their running sums, modulo 65535.

    A sum that is not zero is one of 1 to 65535, as repeated folding leaves it.
    """
    words = np.frombuffer(content + b"\0" * (-len(content) % (2 * _ROW)), "<u2").reshape(-1, _ROW)
    rows, places = (words.sum(axis=axis, dtype=np.uint64) for axis in (1, 0))
    numbers, total = np.arange(len(words), dtype=np.uint64), int(rows.sum())
    before = _ROW * int(numbers @ (rows % 0xFFFF)) + int(np.arange(_ROW, dtype=np.uint64) @ places)
    running = -(-len(content) // 2) * total - before
    # Modulo 65535 the bytes of a word change places when it is multiplied by 256.
    return _folded(256 * running) << 16 | _folded(256 * total)


def _folded(total: int) -> int:
    return (total - 1) % 0xFFFF + 1 if total else 0


def _shrink(planes: npt.NDArray[np.uint8]) -> list[bool]:
    """Rows in which neighbours repeat, or some bytes come much more often than others; to ask zlib
    takes as long as to deflate.
    """
    some = planes[:, :_NEIGHBOURS]
    repeats = np.count_nonzero(some[:, 1:] == some[:, :-1], axis=1)
    some = planes[:, :: max(1, planes.shape[1] // _SAMPLE)]
    count, size = some.shape
    often = (
        np.bincount((some + (np.arange(count) << 8)[:, None]).ravel(), minlength=count << 8)
        .reshape(count, -1)
        .max(axis=1)
    )
    worth: list[bool] = (
        (repeats > _REPEATS * _NEIGHBOURS) | (often > _OFTEN * (1.0 + size / 256))
    ).tolist()
    return worth
