"""``lagrange-casadi check``: the faults of a file."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import click

from ..base.seal import kind_of
from ..base.space import memory
from ..base.vocabulary import TIME_LIMIT
from ..codegen import programs
from ..errors import LagrangeCasadiError, PathError, StoreError, one_line
from ..store import runs as store
from ..store.opening import IDENTIFICATION, check_identification
from ..store.untrusted import parsed
from ..studies.optimise.file import check_optimum, is_optimum
from ..studies.sweep import is_sweep
from ..studies.sweep.checking import check_sweep, progress, unfinished
from .echo import echo

_PLACE = Path(__file__).parents[2]
_PROGRAM = f"""
import sys
sys.path = [place for place in sys.path if place] + sys.argv[2:]
from {__name__} import answer
answer(sys.argv[1])
"""
"""The process that reads a file of unknown origin.

Modules in the current folder, where files arrive, are not for it.
"""

_VARIABLES = {"HDF5_PLUGIN_PRELOAD": "::"}
"""Environment by which HDF5 loads no filters from outside."""

_ANSWER = {"findings": [str], "refused": str, "status": int}
_LONGEST = 1e6
_LINES, _LENGTH = 100, 1000
"""Findings that are reported at most, and characters of each."""


def check(file: Path, untrusted: bool, time_limit: float | None) -> int:
    """See :func:`.commands.check`."""
    if time_limit is not None and not untrusted:
        raise click.UsageError("--time-limit goes with --untrusted")
    seconds = TIME_LIMIT if time_limit is None else time_limit
    if not 0.0 < seconds <= _LONGEST:
        raise click.UsageError(
            f"--time-limit: expected seconds above 0, up to {_LONGEST:g}, got {seconds:g}"
        )
    findings = _findings_apart(file, seconds) if untrusted else _findings(file)
    for finding in findings:
        echo(f"{file}: {finding}", err=True)
    if not findings:
        echo(f"{file}: whole and consistent")
    return 1 if findings else 0


def _findings(file: Path) -> list[str]:
    folder = unfinished(file)
    if folder:
        return [progress(folder), *folder.flaws()]
    if is_optimum(file):
        return check_optimum(file)
    if kind_of(file) == IDENTIFICATION:
        return check_identification(file)
    return check_sweep(file) if is_sweep(file) else store.check(file)


def _findings_apart(file: Path, seconds: float) -> list[str]:
    """Check a file in another process.

    Raises :class:`StoreError` where it does not end in time, or ends without an answer.
    """
    command = [sys.executable, "-c", _PROGRAM, str(file), str(_PLACE)]
    try:
        done = programs.run(command, seconds, variables=_VARIABLES)
    except subprocess.TimeoutExpired:
        raise StoreError(
            f"{file}: was not read within {seconds:g} s, so it is large or forged; --time-limit"
            " sets another limit"
        ) from None
    if done.returncode < 0:
        raise StoreError(
            f"{file}: reading it crashed ({signal.strsignal(-done.returncode)}): it is damaged or"
            " forged"
        )
    try:
        answer = parsed(done.stdout, _ANSWER)
    except (ValueError, RecursionError):
        last = done.stderr.strip().rpartition("\n")[2][:_LENGTH]
        raise StoreError(
            f"{file}: the process that reads it gave no answer (status"
            f" {done.returncode}){last and ': '}{last}"
        ) from None
    if answer["refused"]:
        raise (PathError if answer["status"] == PathError.exit_status else StoreError)(
            answer["refused"]
        )
    return list(answer["findings"])


def answer(file: str) -> None:
    """Check a file within limits and print what is found as JSON, and nothing else, whatever
    libraries print.
    """
    found, refused, status = list[str](), "", 1
    with os.fdopen(os.dup(1), "w") as out:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for number in (1, 2):
            os.dup2(nowhere, number)
        _limit()
        try:
            found = _findings(Path(file))
        except LagrangeCasadiError as error:
            refused, status = str(error), error.exit_status
        except MemoryError:
            refused = f"{file}: takes more memory to read than half of what is free"
        except Exception as error:
            refused = f"{file}: cannot be read: {type(error).__name__}: {one_line(error)}"
        more = [f"and {len(found) - _LINES} more"] if len(found) > _LINES else []
        findings = [line[:_LENGTH] for line in found[:_LINES]] + more
        out.write(
            json.dumps({"findings": findings, "refused": refused[:_LENGTH], "status": status})
        )


def _limit() -> None:
    """Let this process take half of the memory that is free, and leave no image of it behind, where
    the system can see to that.
    """
    with suppress(ImportError, OSError, ValueError):
        import resource  # there is none on Windows

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        most = int(min(taken + memory() / 2, sys.maxsize))
        resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))
