"""Commands as they are typed."""

import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from conftest import CASES

from lagrange_casadi.cli import main


def words(line):
    """The words of a command line; CASE stands for the paper's case."""
    return [str(CASES / "slider_crank") if word == "CASE" else word for word in shlex.split(line)]


def command(line, *more):
    """The status of a command, which further words may follow."""
    return main([*words(line), *map(str, more)])


def python(program, *words):
    """What a program prints in a process of its own."""
    asked = [sys.executable, "-c", program, *words]
    return subprocess.run(asked, capture_output=True, text=True, check=True).stdout


def run_here(function, *given, folder, **_):
    """What a function gives that the package runs apart, in a process that takes a second to
    begin.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        return function(*given)


def missing(stated, printed):
    """Return the first stated piece that is not printed; an ellipsis stands for anything."""
    rest = " ".join(printed.split())
    for piece in filter(None, (" ".join(part.split()) for part in stated.split("..."))):
        _, found, rest = rest.partition(piece)
        if not found:
            return f"{piece!r} is not in:\n{printed}"
    return None


class Hung(BaseException):
    """A call that does not end."""


@contextmanager
def limited(seconds: int) -> Iterator[None]:
    """Raise :class:`Hung` in what does not end within some seconds."""

    def hung(*_: object) -> None:
        raise Hung

    before = signal.signal(signal.SIGALRM, hung)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
