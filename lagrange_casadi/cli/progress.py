"""Progress of a sweep: a bar on a terminal, a plain line now and then elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from tqdm import tqdm

from ..studies.sweep.axes import counted, grouped
from .echo import echo

_SECONDS = 10.0


@dataclass
class Silent:
    """Shows nothing, and knows whether there was anything to do.

    Where others show it, a terminal that is gone stops nothing.
    """

    begun: bool = field(default=False, init=False)

    def __call__(self, what: str, done: float, total: float) -> None:
        """Hear of progress."""
        self.begun = True
        with suppress(OSError):
            self.show(what, done, total)

    def show(self, what: str, done: float, total: float) -> None:
        """Show progress."""

    def close(self) -> None:
        """Leave nothing behind."""


@dataclass
class Lines(Silent):
    """A line on standard error every ten seconds, with designs a second and the time left."""

    _began: float = field(default=0.0, init=False)
    _last: float = field(default=0.0, init=False)
    _first: float = field(default=0.0, init=False)

    def show(self, what: str, done: float, total: float) -> None:
        """Say where it goes on, and then a line now and then."""
        now = time.monotonic()
        if what != "designs":
            return
        if not self._began:
            self._began, self._last, self._first = now, now, done
            if done:
                echo(f"going on after {grouped(int(done))} of {counted(int(total))}", err=True)
        elif now - self._last >= _SECONDS:
            self._last = now
            rate = (done - self._first) / (now - self._began)
            remaining = tqdm.format_interval((total - done) / rate) if rate else "?"
            echo(
                f"{grouped(int(done))} of {counted(int(total))}, {100 * done / total:.3g} %,"
                f" {rate:.4g} a second, {remaining} left",
                err=True,
            )


@dataclass
class Bar(Silent):
    """A bar of designs, and then one of the file."""

    _bar: Any = field(default=None, init=False)
    _what: str = field(default="", init=False)

    def show(self, what: str, done: float, total: float) -> None:
        """Move the bar."""
        if what == "stopping":
            tqdm.write("stopping: finishing the designs in progress", file=sys.stderr)
            return
        if what != self._what:
            self.close()
            unit = {"designs": " designs"}.get(what, "")
            bars = (
                "{l_bar}{bar}| {n_fmt}/{total_fmt} [{elapsed}<{remaining}, {rate_fmt}]"
                if unit
                else "{l_bar}{bar}| [{elapsed}]"
            )
            sys.stderr.flush()  # fails where a bar would, half made
            self._bar = tqdm(
                total=total,
                initial=done,
                desc=what,
                unit=unit,
                unit_scale=bool(unit),
                leave=False,
                bar_format=bars,
            )
            self._what = what
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            with suppress(OSError):
                self._bar.close()


def bar_of(what: str, steps: Iterable[Any] = (), total: int | None = None) -> tqdm[Any]:
    """Show a bar of ``what`` is done on a terminal, which is gone at the end."""
    return tqdm(steps, total=total, desc=what, leave=False, disable=None)


def shown(quiet: bool) -> Silent:
    """Show progress: a bar on a terminal, lines elsewhere, nothing if it is to be quiet."""
    if quiet:
        return Silent()
    return Bar() if sys.stderr.isatty() else Lines()
