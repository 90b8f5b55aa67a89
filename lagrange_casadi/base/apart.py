"""Functions that read foreign files with libraries that were not made for these: they run in a
process of their own, within limits of time, memory and files.
"""

from __future__ import annotations

import json
import math
import os
import signal
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..errors import (
    LagrangeCasadiError,
    MissingPackageError,
    ModelFileError,
    PathError,
    StoreError,
    one_line,
)
from . import programs
from .space import cores, memory

_PROGRAM = """
import sys
sys.path = [place for place in sys.path if place] + sys.argv[1:]
from {here} import answer
from {module} import {name}
answer({name})
"""
"""The process. Modules in the current folder, where files arrive, are not for it."""

_PLACE = str(Path(__file__).parents[2])
_ERRORS = {one.__name__: one for one in (MissingPackageError, ModelFileError, PathError)}
_LENGTH = 1000
"""Characters of a message that are returned."""


class LostError(Exception):
    """A function gave no answer; the message goes on a sentence that begins with its file."""


def run_apart(
    function: Callable[..., object],
    *given: object,
    seconds: float,
    busy: float = math.inf,
    most: float = math.inf,
    folder: Path | None = None,
    variables: Mapping[str, str] | None = None,
) -> Any:
    """Return what a function of a module returns for what is ``given``, both as JSON has them.

    It runs in a process of its own, in a folder and with ``variables`` besides those of this
    process. That process may take ``seconds``, ``busy`` seconds of processor time, half of the
    memory that is free and at most ``most`` bytes, and writes no file. It is ended, with all that
    it started, by any exception here.

    Raises errors of ours that the function raises, :class:`LostError`, and
    ``subprocess.TimeoutExpired``.
    """
    names = {"here": __name__, "module": function.__module__, "name": function.__name__}
    command = [sys.executable, "-c", _PROGRAM.format_map(names), _PLACE]
    # Should this program be killed, that process ends too.
    busy = min(busy, (seconds + 1.0) * cores())
    task = json.dumps([given, most, busy])
    done = programs.run(command, seconds, folder, variables, task)
    if 0 < -done.returncode == getattr(signal, "SIGXCPU", 0):
        raise LostError(f"takes more than {busy:g} s of processor time to read")
    if done.returncode < 0:
        crash = signal.strsignal(-done.returncode)
        raise LostError(f"reading it crashed ({crash}): it is damaged or forged")
    with suppress(ValueError, RecursionError):
        match json.loads(done.stdout):
            case {"found": found}:
                return found
            case {"lost": str() as words}:
                raise LostError(words[:_LENGTH])
            case {"error": str() as kind, "words": str() as words}:
                raise _ERRORS.get(kind, StoreError)(words[:_LENGTH])
    last = done.stderr.strip().rpartition("\n")[2][:_LENGTH]
    status = f"(status {done.returncode}){last and ': '}{last}"
    raise LostError(f"the process that reads it gave no answer {status}")


def answer(function: Callable[..., object]) -> None:
    """Run a function within limits and print what it returns as JSON, and nothing else, whatever
    libraries print.
    """
    given, most, busy = json.load(sys.stdin)
    with os.fdopen(os.dup(1), "w") as out:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for number in (1, 2):
            os.dup2(nowhere, number)
        # No image of the process is left behind, no file is written, and no more taken.
        for what, amount in (("CORE", 0), ("FSIZE", 0), ("CPU", math.ceil(busy))):
            _take_at_most(what, amount)
        limit_memory(most)
        try:
            answered: dict[str, object] = {"found": function(*given)}
        except LagrangeCasadiError as error:
            answered = {"error": type(error).__name__, "words": str(error)}
        except MemoryError:
            limit = f"{most / 1e9:g} GB or " if most < math.inf else ""
            answered = {"lost": f"takes more memory to read than {limit}half of what is free"}
        except Exception as error:
            answered = {"lost": f"cannot be read: {type(error).__name__}: {one_line(error)}"}
        out.write(json.dumps(answered))


def limit_memory(most: float) -> None:
    """Let this process take half of the memory that is free, and at most so many bytes more than
    now, where the system can see to that.
    """
    with suppress(ImportError, OSError, ValueError):
        import resource  # there is none on Windows

        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        _take_at_most("AS", taken + min(most, memory() / 2))


def _take_at_most(what: str, amount: float) -> None:
    """Limit what this process may take of a resource, where the system can."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        kind = getattr(resource, f"RLIMIT_{what}")
        hard = resource.getrlimit(kind)[1]
        there = sys.maxsize if hard == resource.RLIM_INFINITY else hard
        resource.setrlimit(kind, (int(min(amount, there)), hard))
