"""Lines on the terminal.

Whatever they quote, names of files and what is in them, moves no cursor and fakes no other line.
"""

from __future__ import annotations

import click

from ..errors import escaped


def echo(line: str, err: bool = False) -> None:
    """Print a line on standard output, or on standard error; control characters
    in it are escaped.
    """
    click.echo(escaped(line), err=err)


def say_step(number: int, what: str) -> None:
    """Say which step of a live report begins."""
    echo(f"step {number} of 4: {what}", err=True)
