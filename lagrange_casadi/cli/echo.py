"""Lines on the terminal.

Whatever they quote, names of files and what is in them, moves no cursor and fakes no other line.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click

from ..errors import StoreError, escaped


def echo(*lines: str, err: bool = False) -> None:
    """Print lines on standard output, or on standard error; control characters in them are
    escaped.
    """
    try:
        for line in lines:
            click.echo(escaped(line), err=err)
    except OSError as error:
        if err or isinstance(error, BrokenPipeError):  # nobody reads it
            raise
        raise StoreError(f"cannot write to standard output: {error.strerror}") from None


def write_asked(path: Path | None, write: Callable[[Path], object]) -> None:
    """Write a file, if it was asked for, and say so."""
    if path is not None:
        write(path)
        echo(f"wrote {path}")


def say_step(number: int, what: str) -> None:
    """Say which step of a live report begins."""
    echo(f"step {number} of 4: {what}", err=True)
