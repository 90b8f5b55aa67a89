"""The C compiler: which one there is, and a cache of what it has built.

A library is named by the hash of its source, of the flags and of the compiler, built under another name and renamed, so any
number of processes may build the same one at once and none ever sees half of it.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from ..errors import CompilerError

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
"""No contraction: a product and a sum round as written, so every machine gives the same digits."""


@dataclass(frozen=True)
class Compiler:
    """A C compiler: the command that runs it and the first line of its version, which holds no path."""

    command: tuple[str, ...]
    version: str


def find_compiler() -> Compiler | None:
    """$CC, else cc, gcc, clang, else the wheel ziglang; None where there is none.

    Raises :class:`CompilerError` where $CC is set and does not run.
    """
    chosen = os.environ.get("CC", "").strip()
    if chosen:
        try:
            command = tuple(shlex.split(chosen))
        except ValueError as error:
            raise CompilerError(f"$CC = {chosen!r} cannot be split into words: {error}") from None
        version = _version(command)
        if version is None:
            raise CompilerError(f"$CC = {chosen!r} does not run; unset it, or name a C compiler such as cc, gcc or clang")
        return Compiler(command, version)
    candidates = [(name,) for name in ("cc", "gcc", "clang") if shutil.which(name)]
    commands: list[tuple[str, ...]] = [*candidates]
    if importlib.util.find_spec("ziglang"):
        commands.append((sys.executable, "-m", "ziglang", "cc"))
    for command in commands:
        version = _version(command)
        if version is not None:
            return Compiler(command, version)
    return None


def _version(command: tuple[str, ...]) -> str | None:
    try:
        run = subprocess.run([*command, "--version"], capture_output=True, text=True, timeout=60, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return run.stdout.partition("\n")[0].strip() or "unknown version"


def cache_folder() -> Path:
    """Where built libraries are kept: the user's cache directory."""
    return Path(platformdirs.user_cache_dir("lagrange_casadi", appauthor=False))


def build(source: str, compiler: Compiler) -> Path:
    """The shared library of a C source, from the cache or newly built.

    Raises :class:`CompilerError` where the compiler refuses the source; its whole message is kept beside the source in the cache.
    """
    identity = "\0".join([source, *FLAGS, *compiler.command, compiler.version])
    name = hashlib.sha256(identity.encode()).hexdigest()[:32]
    folder = _folder()
    library = folder / f"{name}.so"
    if library.exists():
        return library
    code = folder / f"{name}.c"
    with tempfile.TemporaryDirectory(dir=folder, prefix="build-") as work:
        draft, built = Path(work) / f"{name}.c", Path(work) / f"{name}.so"
        draft.write_text(source)
        run = subprocess.run(
            [*compiler.command, *FLAGS, str(draft), "-o", str(built), "-lm"], capture_output=True, text=True, check=False
        )
        os.replace(draft, code)
        if run.returncode != 0 or not built.exists():
            log = folder / f"{name}.log"
            log.write_text(run.stderr)
            first = next((line for line in run.stderr.splitlines() if "error" in line.lower()), run.stderr.strip() or "no message")
            raise CompilerError(
                f"{' '.join(compiler.command)} failed with status {run.returncode}: {first.strip()} (whole message in {log})"
            )
        os.replace(built, library)
    return library


def _folder() -> Path:
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise CompilerError(f"cannot write into the cache folder {folder}: {error.strerror}") from None
    return folder
