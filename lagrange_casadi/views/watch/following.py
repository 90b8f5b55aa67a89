"""A case's file is followed: each time it is saved, a new process runs the case, and the one
before is ended.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import threading
import time
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from queue import Empty, Queue
from signal import strsignal
from typing import Any, NoReturn, TypeAlias

from ...base import programs
from ...studies.case import case_file
from .child import main
from .news import News

_MOMENT = 0.05
"""Seconds between two looks at the files, at least; a file is saved if two find the same."""
_DRAWING, _WHOLE = 20.0, 600.0
"""Seconds in which a case is drawn, and in which all is done, where no limit is given."""

_PROGRAM = f"import sys; sys.path[:] = sys.argv[1:]; from {main.__module__} import main; main()"

Stamps: TypeAlias = dict[str, tuple[int, int, int]]
"""When files were changed, how large they are and which they are, by their paths."""
Said: TypeAlias = "Queue[tuple[_Run, str, Any]]"


def follow(case: Path, given: Mapping[str, Any], news: News, limit: float | None) -> NoReturn:
    """Put what there is of a case into ``news``: now, and each time that a file of it is saved.

    ``given`` is how the case is run. Each run may take ``limit`` seconds; without a limit 20 s to
    draw the case, and 10 minutes in all. No process is left when this is interrupted.

    Raises :class:`.CaseError` where there is no such file.
    """
    order, file = json.dumps({"case": str(case), **given}), case_file(case).resolve()
    said: Said = Queue()
    runs = [_Run(said)]  # the last waits for its turn, for to import the program takes long
    files: set[str] = set()
    before: Stamps = {}
    shown: Stamps = {}
    looked = -math.inf
    try:
        while True:
            if (now := time.monotonic()) >= looked + _MOMENT:
                stamps, looked = _stamps(file, files), now
                if stamps == before != shown:
                    runs.append(_Run(said))
                    for run in runs[:-2]:
                        programs.end(run.process)
                    runs, shown = runs[-2:], stamps
                    news.begin()
                    runs[0].begin(order)
                before = stamps
            try:
                run, kind, value = said.get(timeout=_MOMENT)
            except Empty:
                pass
            else:
                if run is runs[0] and not run.done:
                    run.hear(kind)
                    if kind == "files":
                        files |= set(value)
                        shown = _stamps(file, files) | shown
                    else:
                        news.put(kind, value)
            if words := runs[0].late(limit):
                programs.end(runs[0].process)
                news.put("error", words)
    finally:
        for run in runs:
            programs.end(run.process)


def _stamps(file: Path, files: Collection[str]) -> Stamps:
    """Stamps of a case's file, the modules beside it, and other files that it has read."""
    found: Stamps = {}
    for path in {str(file), *map(str, file.parent.glob("*.py")), *files}:
        with suppress(OSError):
            there = os.stat(path)
            found[path] = (there.st_mtime_ns, there.st_size, there.st_ino)
    return found


@dataclass(eq=False)
class _Run:
    """A process that runs a case once it is asked to begin; what it says goes to ``said``."""

    said: Said
    drawn: bool = False
    done: bool = True
    began: float = math.inf
    process: subprocess.Popen[str] = field(init=False)

    def __post_init__(self) -> None:
        self.process = programs.start([sys.executable, "-c", _PROGRAM, *sys.path])
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        """Hand over what the process says, and at its end how that came."""
        assert self.process.stdout
        with suppress(ValueError):  # it was ended in the midst of a line
            for line in self.process.stdout:
                kind, value = json.loads(line)
                self.said.put((self, kind, value))
        status = self.process.wait()
        how = strsignal(-status) if status < 0 else f"status {status}"
        self.said.put((self, "error", f"the process that ran the case has ended: {how}"))

    def begin(self, order: str) -> None:
        """Run the case."""
        if self.process.poll() is not None:  # something has ended it while it waited
            self.__post_init__()
        self.done = False
        with suppress(OSError):  # it has ended, which is heard
            assert self.process.stdin
            print(order, file=self.process.stdin, flush=True)

    def hear(self, kind: str) -> None:
        """Note how far the process is by what it says."""
        self.began = min(self.began, time.monotonic())  # from now on the time is the case's
        self.drawn = self.drawn or kind == "drawing"
        self.done = kind == "error"

    def late(self, limit: float | None) -> str:
        """Give the error of a process that takes too long, and count it as done; else nothing."""
        most, what = (_WHOLE, "") if self.drawn else (_DRAWING, " to draw")
        most = most if limit is None else limit
        if self.done or time.monotonic() - self.began < most:
            return ""
        self.done = True
        return f"the case takes more than {most:g} s{what}: it was ended"
