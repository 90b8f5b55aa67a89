"""Blocks: runs of design numbers that are evaluated, committed and kept in the file as one; the
plan alone sets them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

Slab = tuple[int, int, tuple[slice, ...]]
"""Designs from and to before, and the places along the designs' axes that are them."""

_NAME = re.compile(r"(\d{12})-(\d{12})")


def chunk_of(dims: Sequence[int], target: int) -> tuple[int, ...]:
    """The shape of chunks of about ``target`` designs that are runs of design numbers, each axis
    cut into equal lengths.
    """
    chunk: list[int] = []
    capacity = max(target, 1)
    for length in reversed(dims):
        here = length if length <= capacity else math.ceil(length / math.ceil(length / capacity))
        capacity = capacity // length if length <= capacity else 1
        chunk.append(here)
    return tuple(chunk[::-1])


def slabs(dims: Sequence[int], chunk: Sequence[int]) -> Iterator[Slab]:
    """The runs of design numbers that chunks hold, in order."""
    cut = next((axis for axis, length in enumerate(chunk) if length != 1), len(dims) - 1)
    inner = math.prod(dims[cut + 1 :])
    whole = [slice(0, length) for length in dims[cut + 1 :]]
    for count, outer in enumerate(np.ndindex(*dims[:cut])):
        for start in range(0, dims[cut], chunk[cut]):
            stop = min(start + chunk[cut], dims[cut])
            before = count * dims[cut]
            yield (
                (before + start) * inner,
                (before + stop) * inner,
                (*(slice(k, k + 1) for k in outer), slice(start, stop), *whole),
            )


def name_of(start: int, stop: int) -> str:
    """Name of the part of a block."""
    return f"{start:012d}-{stop:012d}"


def blocks_in(names: Iterable[str]) -> dict[int, int]:
    """The ends of blocks by their starts, from the names of their parts."""
    found = map(_NAME.fullmatch, names)
    return {int(name[1]): int(name[2]) for name in found if name}


def designs_in(names: Iterable[str]) -> int:
    """Number of designs in parts, by their names."""
    return sum(stop - start for start, stop in blocks_in(names).items())


@dataclass
class Queue:
    """Blocks that are still to be done, handed out one by one until it is ``stopped``."""

    blocks: Iterator[tuple[int, int]]
    stopped: bool = False
