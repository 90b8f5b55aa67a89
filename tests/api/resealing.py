"""Files damaged at random and sealed anew, so that HDF5 sees the damage, each read in a process of
its own.

``python tests resealing FILE SEED COUNT`` prints how each reading ended, a line each.
"""

from __future__ import annotations

import hashlib
import importlib
import os
import random
import resource
import select
import signal
import subprocess
import sys
import time
from collections.abc import Container
from pathlib import Path

import h5py
from damaging import damaged
from internals import SCHEMA
from internals import base_seal as seal

import lagrange_casadi.cli  # noqa: F401
from lagrange_casadi.errors import LagrangeCasadiError

SECONDS, MEMORY = 10.0, 8 << 30
found_in = importlib.import_module("lagrange_casadi.cli.check").found_in

LISTS = ("DIMENSION_LIST", "REFERENCE_LIST")
"""What HDF5 keeps of axes: references, which are places in the file."""

_MADE_BY = {"schema_version", "versions", "backend", "precision", "compiler", "flags", "rung"}
ONCE = {
    SCHEMA: _MADE_BY | {"figures", "error_estimate"},
    f"{SCHEMA}-sweep": _MADE_BY | {"keep", "sources", "scene"},
    f"{SCHEMA}-optimum": {
        "case",
        "minimised",
        "unit",
        "residual",
        "curvature",
        "transmission",
        "evaluations",
        "multiplier",
    },
}
"""Attributes that nothing else in a file tells, and from which nothing else follows: with what
numbers were made, how far they may be off, what a search was for. Only the seal tells whether they
were changed, so a forged seal hides that. Versions of a schema that are read are all read alike."""


def contents(path: Path, once: Container[str]) -> str:
    """A digest of all that a file says, but for attributes that are told ``once``."""
    said: list[str] = []

    def visit(place: str, item: object) -> None:
        attributes = {
            name: repr(value)
            for name, value in item.attrs.items()
            if name not in LISTS and name not in once
        }
        said.append(
            f"{place} {attributes} {item[()].tobytes() if isinstance(item, h5py.Dataset) else ''}"
        )

    with h5py.File(path) as file:
        visit("/", file)
        file.visititems(visit)
    return hashlib.sha256("\n".join(said).encode(errors="replace")).hexdigest()


def read_file(path: Path, out: int, original: str, once: Container[str]) -> None:
    """Check a file; how that ended."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    try:
        word = "found" if found_in(str(path)) else "accepted"
        if word == "accepted" and contents(path, once) == original:
            word = "accepted unchanged"
    except (LagrangeCasadiError, MemoryError):
        word = "refused"
    except Exception as error:
        word = f"traceback {error!r}"
    os.write(out, word.encode())


def ending(read, *arguments: object) -> str:
    """How a reading ended that was given a process of its own."""
    out, into = os.pipe()
    child = os.fork()
    if child == 0:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.close(out)
        read(arguments[0], into, *arguments[1:])
        os._exit(0)
    os.close(into)
    told = b"" if not select.select([out], [], [], SECONDS)[0] else os.read(out, 1 << 16)
    os.close(out)
    until = time.monotonic() + (1.0 if told else 0.0)
    done, status = os.waitpid(child, os.WNOHANG)
    while not done and time.monotonic() < until:
        time.sleep(0.001)
        done, status = os.waitpid(child, os.WNOHANG)
    if not done and not told:
        time.sleep(0.2)  # a pipe that closed because the process ends
        done, status = os.waitpid(child, os.WNOHANG)
    if not done:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        return "hang"
    if os.WIFSIGNALED(status):
        return f"crash {os.WTERMSIG(status)}"
    return told.decode() or f"traceback status {status}"


def checked(path: Path) -> str:
    """What the command itself makes of a file that crashes or stalls: a line and status 1, or else
    this tells.
    """
    command = [
        sys.executable,
        "-m",
        "lagrange_casadi",
        "check",
        "--untrusted",
        "--time-limit",
        f"{SECONDS:g}",
        str(path),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=6 * SECONDS, check=False)
    one = (
        done.returncode == 1
        and not done.stdout
        and done.stderr.count("\n") == 1
        and done.stderr.startswith("error: ")
    )
    return "told" if one else f"unnoticed: {done.returncode} {done.stdout}{done.stderr}"


def run(source: Path, seed: int, count: int) -> None:
    """Damage, seal and read so many times."""
    chance, path = random.Random(seed), Path("damaged.h5").absolute()
    kind, content = seal.kind_of(source), source.read_bytes()[: -seal.SIZE]
    known = contents(source, ONCE[kind])
    for number in range(count):
        path.write_bytes(damaged(content, chance))
        seal.seal(path, kind)
        word = ending(read_file, path, known, ONCE[kind])
        if word.startswith(("hang", "crash")):
            word += f" {checked(path)}"
        print(number, word, flush=True)


if __name__ == "__main__":
    run(Path(sys.argv[1]).absolute(), int(sys.argv[2]), int(sys.argv[3]))
