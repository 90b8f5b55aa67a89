"""Blocks of designs: as many as memory allows and as are done in about a second, from what is still to be done."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

_BYTES = 1 << 24
"""What a block may take in memory."""

_SECONDS = 1.0
_FIRST = 64


@dataclass
class Cutter:
    """Cuts gaps into blocks one by one, each as large as the last ones were fast.

    The result does not depend on how it cuts; what a kill loses and how long Ctrl-C waits does.
    """

    gaps: Sequence[tuple[int, int]]
    bytes_per_design: int
    stopped: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        self._length = _FIRST
        self._rest = list(self.gaps)[::-1]
        self._most = max(1, _BYTES // self.bytes_per_design)

    def cut(self) -> tuple[int, int] | None:
        """The next block, from and to before; None where nothing is left."""
        if not self._rest:
            return None
        start, stop = self._rest.pop()
        end = min(stop, start + min(self._length, self._most))
        if end < stop:
            self._rest.append((end, stop))
        return start, end

    def took(self, designs: int, seconds: float) -> None:
        """Say how long a block took."""
        fast = designs / max(seconds, 1e-9) * _SECONDS
        self._length = max(1, int(min(fast, 8.0 * self._length, self._most)))

    def stop(self) -> None:
        """Cut no more."""
        self.stopped = True
        self._rest.clear()
