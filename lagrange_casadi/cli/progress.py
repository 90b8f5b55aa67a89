"""Progress of a sweep: a bar on a terminal, a plain line now and then elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from contextlib import suppress
from typing import Any

from tqdm import tqdm

from ..studies.sweep.axes import counted, grouped
from .echo import echo

_SECONDS = 10.0
"""Seconds between two lines."""


class _Lines(tqdm):  # type: ignore[misc]
    """Plain lines on standard error, with designs a second and the time left."""

    def display(self, msg: str | None = None, pos: int | None = None) -> None:
        """Write a line, where some designs are done."""
        if msg is None and self.n:
            rate = (self.n - self.initial) / max(self.format_dict["elapsed"], 1e-9)
            remaining = tqdm.format_interval((self.total - self.n) / rate) if rate else "?"
            echo(
                f"{grouped(int(self.n))} of {counted(int(self.total))},"
                f" {100 * self.n / self.total:.3g} %, {rate:.4g} a second, {remaining} left",
                err=True,
            )


class Progress:
    """Progress of a sweep, ``begun`` if there was anything to do: nothing is shown if it is to be
    ``quiet``. A terminal that is gone stops nothing.
    """

    def __init__(self, quiet: bool) -> None:
        self.begun, self.quiet, self.what = False, quiet, ""
        self.bar: tqdm[Any] | None = None

    def __call__(self, what: str, done: float, total: float) -> None:
        """Show progress: of designs, and then of the file."""
        self.begun = True
        with suppress(OSError):
            if not self.quiet and (what == "designs" or sys.stderr.isatty()):
                self._show(what, done, total)

    def _show(self, what: str, done: float, total: float) -> None:
        if what == "stopping":
            tqdm.write("stopping: finishing the designs in progress", file=sys.stderr)
            return
        if what != self.what:
            self.close()
            sys.stderr.flush()  # fails where a bar would, half made
            self.what, self.bar = what, _shown(what, done, total)
        if self.bar is not None:
            self.bar.update(done - self.bar.n)

    def close(self) -> None:
        """Take the bar away."""
        if self.bar is not None:
            with suppress(OSError):
                self.bar.close()


def _shown(what: str, done: float, total: float) -> tqdm[Any]:
    """Return what shows progress of designs, or of the file."""
    words: dict[str, Any] = {"total": total, "initial": done, "desc": what, "leave": False}
    if not sys.stderr.isatty():
        return _Lines(mininterval=_SECONDS, **words)
    if what == "designs":
        return tqdm(unit=" designs", unit_scale=True, **words)
    return tqdm(bar_format="{l_bar}{bar}| [{elapsed}]", **words)


def bar_of(what: str, steps: Iterable[Any] = (), total: int | None = None) -> tqdm[Any]:
    """Show a bar of ``what`` is done on a terminal, which is gone at the end."""
    return tqdm(steps, total=total, desc=what, leave=False, disable=None)
