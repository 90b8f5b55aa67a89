"""Standard streams that whoever started the program has closed: nothing goes there, and no file
takes their place.

A file that is opened gets the lowest number that is free. Were it that of standard error, messages
would be written into it.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress

from .interrupts import is_program

_NAMES = ("stdin", "stdout", "stderr")


def fill() -> None:
    """Let streams that are closed lead nowhere."""
    for number, name in enumerate(_NAMES):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "w" if number else "r", closefd=False))


def lead_nowhere() -> None:
    """Let standard output lead nowhere from now on, once its reader has gone: what is left in it is
    not an error at the end.
    """
    with suppress(OSError, ValueError):  # of a test, it may be no file
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


if is_program():
    fill()
