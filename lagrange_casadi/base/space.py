"""Memory and time of this machine, compared with a task before it is tried: the system ends a
program without a message if memory runs out.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from ..errors import SizeError

MOST_THREADS = 1024
"""More than any machine runs at once."""

_LARGEST, _SMALL = 1e300, 1e7
_SPANS = ((1.0, "s"), (60.0, "min"), (3600.0, "h"), (86_400.0, "days"), (31_557_600.0, "years"))


def require(what: str, shape: tuple[int, ...]) -> None:
    """Raise :class:`SizeError` where this machine has less memory free than an array of doubles
    takes.
    """
    count = math.prod(shape)
    size = 8.0 * count if count < _LARGEST else math.inf
    if size > _SMALL and size > (there := memory()):
        values = " x ".join(f"{length:,}".replace(",", " ") for length in shape)
        free = f"this machine has {there / 1e9:.3g} GB free"
        raise SizeError(
            f"not enough memory for {what}: {values} values are {size / 1e9:.4g} GB, and {free}"
        )


def cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def memory() -> float:
    """Bytes of memory that are free, with what the system can swap out, or what a container leaves
    of them; infinite if unknown.
    """
    return min([_machine(), *_groups()])


def in_words(seconds: float) -> str:
    """A time in one of the units that people say it in."""
    size, unit = next(((s, u) for s, u in reversed(_SPANS) if seconds >= 2.0 * s), _SPANS[0])
    return (
        f"{seconds / size:.2g} {unit}" if seconds < 100.0 * size else f"{seconds / size:.0f} {unit}"
    )


def _machine() -> float:
    with suppress(OSError, ValueError):
        words = dict(
            re.findall(r"^(\w+): +(\d+) kB", Path("/proc/meminfo").read_text(), re.MULTILINE)
        )
        if "MemAvailable" in words:
            return 1024.0 * (int(words["MemAvailable"]) + int(words.get("SwapFree", "0")))
    with suppress(OSError, ValueError, AttributeError):
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    return math.inf


def _groups() -> Iterator[float]:
    """Free memory of each control group of this process; a container is one."""
    root = Path("/sys/fs/cgroup")
    with suppress(OSError, ValueError):
        for line in Path("/proc/self/cgroup").read_text().splitlines():
            _, kinds, path = line.split(":", 2)
            if kinds == "":
                yield from _left(root, path, "memory.max", "memory.current", "inactive_file")
            elif "memory" in kinds.split(","):
                yield from _left(
                    root / "memory",
                    path,
                    "memory.limit_in_bytes",
                    "memory.usage_in_bytes",
                    "total_inactive_file",
                )


def _left(root: Path, path: str, limit: str, used: str, idle: str) -> Iterator[float]:
    """Free memory of a group and of its parents.

    Where the container sees itself as the root, its path is one outside.
    """
    parts = [part for part in path.split("/") if part]
    for folder in (root.joinpath(*parts[:count]) for count in range(len(parts) + 1)):
        with suppress(OSError, ValueError, KeyError):
            most = int((folder / limit).read_text())
            rows = (line.split() for line in (folder / "memory.stat").read_text().splitlines())
            yield float(most - int((folder / used).read_text()) + int(dict(rows)[idle]))
