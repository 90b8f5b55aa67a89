"""Signals that stop the program, and their first handling while modules are imported.

The package imports this first. In any other program than its own it changes nothing.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

STATUS = 130
"""The exit status of a program that was interrupted."""

SENTENCE = "interrupted; no file was left incomplete"

_NAMES = ("SIGINT", "SIGTERM", "SIGHUP")


def interrupts() -> list[signal.Signals]:
    """The signals that stop the program: Ctrl-C (SIGINT), a request to end (SIGTERM), and a
    terminal that closes (SIGHUP).

    Those that the platform lacks are left out, and so are those that are ignored: ``nohup``, and a
    shell that runs something in the background, start a program that ignores some, and it goes on
    ignoring them.
    """
    numbers = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    return [number for number in numbers if signal.getsignal(number) not in (signal.SIG_IGN, None)]


@contextmanager
def uninterrupted() -> Iterator[Callable[[], None]]:
    """Hold interrupts back, for HDF5 does not survive an exception in its midst.

    What is yielded lets one through where it is called; one that nobody let through comes at the
    end.
    """
    noticed = threading.Event()

    def breathe() -> None:
        if noticed.is_set():
            raise KeyboardInterrupt

    repeated = [signal.SIGALRM] if hasattr(signal, "SIGALRM") else []
    able = threading.current_thread() is threading.main_thread()
    before = (
        [
            (number, signal.signal(number, lambda *_: noticed.set()))
            for number in (*interrupts(), *repeated)
        ]
        if able
        else []
    )
    try:
        yield breathe
    finally:
        for number, handler in before:
            signal.signal(number, handler)
    breathe()


def is_program() -> bool:
    """Return whether this process is the command line: the installed script, or ``python -m`` while
    that looks for the package.

    A process that the program started has the same name.
    """
    helpers = sys.modules.get("multiprocessing.process")
    if helpers is not None and helpers.parent_process() is not None:
        return False
    name = sys.argv[0] if sys.argv else ""
    return Path(name).stem == "lagrange-casadi" or (
        name == "-m" and __package__.partition(".")[0] in sys.orig_argv
    )


def _end(_number: int, _frame: FrameType | None) -> None:
    # No exception: what is being imported may take one for its own.
    with suppress(OSError):
        os.write(2, f"error: {SENTENCE}\n".encode())
    os._exit(STATUS)


def keep_status() -> None:
    """Let a program that was interrupted end with the status it gives.

    If an interrupt came while Python executed text, as when a dataclass is made, Python ends the
    program by SIGINT, whatever became of the exception. It forgets that when it executes another
    text.
    """
    exec("")


if is_program():
    for _signal in interrupts():
        signal.signal(_signal, _end)
