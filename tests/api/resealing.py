"""Files damaged at random and sealed anew, so that HDF5 sees the damage, each read in a process of
its own.

``python tests resealing FILE SEED COUNT`` prints how each reading ended, a line each.
"""

from __future__ import annotations

import hashlib
import importlib
import multiprocessing
import os
import random
import resource
import subprocess
import sys
from collections.abc import Container
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path

import h5py
from damaging import damaged
from forging import attributes
from internals import opening

import lagrange_casadi.cli  # noqa: F401
from lagrange_casadi.errors import LagrangeCasadiError

SECONDS, MEMORY = 10.0, 8 << 30
FORK = multiprocessing.get_context("fork")
found_in = importlib.import_module("lagrange_casadi.cli.check").found_in

_MADE_BY = {"schema_version", "versions", "backend", "precision", "compiler", "flags", "rung"}
ONCE = {
    "lagrange-casadi": _MADE_BY | {"figures", "error_estimate"},
    "lagrange-casadi-sweep": _MADE_BY | {"keep", "sources", "scene"},
    "lagrange-casadi-optimum": {
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
    digest = hashlib.sha256()

    def visit(place: str, item: object) -> None:
        digest.update(place.encode(errors="replace"))
        if isinstance(item, h5py.Dataset):
            digest.update(item[()].tobytes())

    with h5py.File(path) as file:
        file.visititems(visit)
        for place, name, value in attributes(file):
            if name not in once:
                digest.update(f"{place} {name} {value!r}".encode(errors="replace"))
    return digest.hexdigest()


def read_file(path: Path, original: str, once: Container[str], out: Connection) -> None:
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
    out.send(word)


def ending(*arguments: object) -> str:
    """How a reading ended that was given a process of its own."""
    told, out = FORK.Pipe(duplex=False)
    child, word = FORK.Process(target=read_file, args=(*arguments, out)), ""
    child.start()
    out.close()
    with suppress(EOFError):
        word = told.recv() if told.poll(SECONDS) else ""
    child.join(1.0)
    if child.exitcode is None:
        child.kill()
        return "hang"
    return f"crash {-child.exitcode}" if child.exitcode < 0 else word or "traceback"


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
    kind, content = opening.kind_of(source), source.read_bytes()[: -opening.SIZE]
    known = contents(source, ONCE[kind])
    for number in range(count):
        path.write_bytes(damaged(content, chance))
        with path.open("ab") as file:
            opening.seal(file, kind)
        word = ending(path, known, ONCE[kind])
        if word.startswith(("hang", "crash")):
            word += f" {checked(path)}"
        print(number, word, flush=True)


if __name__ == "__main__":
    run(Path(sys.argv[1]).absolute(), int(sys.argv[2]), int(sys.argv[3]))
