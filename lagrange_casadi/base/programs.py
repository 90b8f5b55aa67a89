"""Programs that are started here, compilers mostly: within a time limit, and ended with all that
they started in turn.
"""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from .interrupts import uninterrupted

_GRACE = 0.5
"""Seconds in which a program may tidy up after it was asked to end."""


def run(
    command: Sequence[str],
    seconds: float,
    folder: Path | None = None,
    variables: Mapping[str, str] | None = None,
    given: str = "",
) -> subprocess.CompletedProcess[str]:
    """Run a program to its end, in a folder, with ``variables`` besides those of this process. It
    reads what is ``given``; what it says is read as UTF-8, whatever it is.

    Raises ``OSError`` where it cannot be started, ``subprocess.TimeoutExpired`` where it has not
    ended in time.
    """
    process = None
    try:
        with uninterrupted():  # else one may have been started that nobody knows of
            process = start(command, folder, variables, stderr=subprocess.PIPE)
        out, err = process.communicate(given, timeout=seconds)
    except BaseException:
        if process:
            end(process)
        raise
    return subprocess.CompletedProcess(command, process.returncode, out, err)


def start(
    command: Sequence[str],
    folder: Path | None = None,
    variables: Mapping[str, str] | None = None,
    stderr: int | None = None,
) -> subprocess.Popen[str]:
    """Start a program as the first of a session of its own, with pipes of UTF-8 to and from it."""
    return subprocess.Popen(
        command,
        cwd=folder,
        env={**os.environ, **(variables or {})},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=stderr,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
    )


def end(process: subprocess.Popen[str]) -> None:
    """End a program and what it started: a compiler's driver has others do its work, which hold its
    pipes open.
    """
    for number in (signal.SIGTERM, getattr(signal, "SIGKILL", signal.SIGTERM)):
        with suppress(OSError):
            if hasattr(os, "killpg"):
                os.killpg(process.pid, number)
            else:
                process.kill()
        with suppress(subprocess.TimeoutExpired):
            process.wait(_GRACE)
    for pipe in (process.stdin, process.stdout, process.stderr):
        if pipe:
            with suppress(OSError):
                pipe.close()
