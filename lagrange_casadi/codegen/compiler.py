"""The compilers: which there are, with what flags, and a cache of what they have built.

A library is named by the hash of its source, of the flags, of the compiler, and of the machine where the code is for this one
alone. It is built under another name and renamed, so any number of processes may build the same one at once and none ever sees
half of it; its digest lies beside it, for a truncated library can load and then crash.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from .. import cache
from ..errors import CompilerError

Language = Literal["c", "c++"]

_COMMON = ("-fno-math-errno", "-ffp-contract=off", "-fvisibility=hidden", "-fPIC", "-shared", "-nostartfiles")
FLAGS: dict[Language, tuple[str, ...]] = {
    "c": ("-std=c99", "-O3", *_COMMON),
    "c++": ("-std=c++11", "-O3", "-march=native", *_COMMON),
}
"""No contraction: a product and a sum round as written. Nobody reads errno; without it a root is an instruction, no call.
No start files: those that gcc links in where -ffast-math is asked for make the whole process flush to zero what is subnormal."""

LARGE = 20_000
"""Statements from which on a file is compiled with -O1: see ``docs/speed.md`` for what that saves and costs."""

_NAMES: dict[Language, tuple[str, tuple[str, ...]]] = {
    "c": ("CC", ("cc", "gcc", "clang")),
    "c++": ("CXX", ("c++", "g++", "clang++")),
}


@dataclass(frozen=True)
class Compiler:
    """A compiler: its language, the command that runs it and the first line of its version, which holds no path."""

    language: Language
    command: tuple[str, ...]
    version: str

    def flags(self, source: str) -> tuple[str, ...]:
        """The flags for a source."""
        flags = FLAGS[self.language]
        if statements(source) < LARGE:
            return flags
        return tuple("-O1" if flag.startswith("-O") else flag for flag in flags)


def statements(source: str) -> int:
    """How many statements a source has, about: a measure of what it costs to compile and to run."""
    return source.count(";\n")


def find_compiler(language: Language = "c") -> Compiler | None:
    """$CC, else cc, gcc, clang (of C++: $CXX, c++, g++, clang++), else the wheel ziglang; None where there is none.

    Raises :class:`CompilerError` where the variable is set and does not run.
    """
    return _find_compiler(language, os.environ.get(_NAMES[language][0], "").strip(), os.environ.get("PATH", ""))


@functools.lru_cache(maxsize=16)
def _find_compiler(language: Language, chosen: str, _path: str) -> Compiler | None:
    """The same for what the environment says, which a process may change."""
    variable, names = _NAMES[language]
    if chosen:
        try:
            command = tuple(shlex.split(chosen))
        except ValueError as error:
            raise CompilerError(f"${variable} = {chosen!r} cannot be split into words: {error}") from None
        version = _version(command)
        if version is None:
            raise CompilerError(f"${variable} = {chosen!r} does not run; unset it, or name a compiler such as {', '.join(names)}")
        return Compiler(language, command, version)
    commands: list[tuple[str, ...]] = [(name,) for name in names if shutil.which(name)]
    if importlib.util.find_spec("ziglang"):
        # Its C library has no libmvec to link with.
        commands.append((sys.executable, "-m", "ziglang", *(("cc",) if language == "c" else ("c++", "-DLANES_LIBMVEC=0"))))
    for command in commands:
        version = _version(command)
        if version is not None:
            return Compiler(language, command, version)
    return None


@functools.lru_cache
def _version(command: tuple[str, ...]) -> str | None:
    try:
        run = subprocess.run([*command, "--version"], capture_output=True, text=True, timeout=60, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return run.stdout.partition("\n")[0].strip() or "unknown version"


@contextmanager
def built(source: str, compiler: Compiler, extra: tuple[str, ...] = ()) -> Iterator[Path]:
    """The shared library of a source, from the cache or newly built; it need not outlive the block.

    ``extra`` flags come after the package's own. Warns where the cache cannot be used, and where what it held was damaged. Raises
    :class:`CompilerError` where the compiler refuses the source; its whole message is kept beside the source in the cache.
    """
    flags = (*compiler.flags(source), *extra)
    machine = _machine() if "-march=native" in flags else ""
    identity = "\0".join([source, *flags, *compiler.command, compiler.version, machine])
    name = hashlib.sha256(identity.encode()).hexdigest()[:32]
    folder = cache.folder()
    kept = None if folder is None else _kept(folder / f"{name}.so")
    if kept is not None:
        yield kept
        return
    with tempfile.TemporaryDirectory(prefix="lagrange_casadi-") as work:
        fresh = _compile(source, compiler, flags, Path(work) / name, folder)
        if folder is not None:
            try:
                cache.keep([fresh.with_suffix(suffix) for suffix in (_suffix(compiler), ".sha256", ".so")], folder)
            except OSError as error:
                warnings.warn(f"cannot keep a library in {folder}: {error.strerror}; compiled for this time only", stacklevel=3)
        yield fresh


def _kept(library: Path) -> Path | None:
    if not library.exists():
        return None
    seal = library.with_suffix(".sha256")
    if seal.exists() and seal.read_bytes() == cache.digest(library.read_bytes()).encode():
        return library
    warnings.warn(f"the cached library {library} was damaged and is built again", stacklevel=4)
    return None


def _suffix(compiler: Compiler) -> str:
    return ".c" if compiler.language == "c" else ".cpp"


def _compile(source: str, compiler: Compiler, flags: tuple[str, ...], base: Path, folder: Path | None) -> Path:
    """Compile beside ``base``; a message of the compiler's is kept in ``folder``."""
    code, library = base.with_suffix(_suffix(compiler)), base.with_suffix(".so")
    command = [*compiler.command, *flags, str(code), "-o", str(library), "-lm"]
    try:
        code.write_text(source)
        run = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise CompilerError(f"cannot compile in {base.parent}: {error.strerror}") from None
    if run.returncode != 0 or not library.exists():
        where = ""
        if folder is not None:
            log = base.with_suffix(".log")
            with suppress(OSError):
                log.write_text(run.stderr)
                cache.keep([code, log], folder)
                where = f" (whole message in {folder / log.name})"
        raise CompilerError(f"{complaint(compiler, run)}{where}")
    library.with_suffix(".sha256").write_text(cache.digest(library.read_bytes()))
    return library


def complaint(compiler: Compiler, run: subprocess.CompletedProcess[str]) -> str:
    """The first of what a compiler that failed has to say."""
    first = next((line for line in run.stderr.splitlines() if "error" in line.lower()), run.stderr.strip() or "no message")
    return f"{' '.join(compiler.command)} failed with status {run.returncode}: {first.strip()}"


def _machine() -> str:
    """What ``native`` means here: a cache may be shared by several machines."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return f"{platform.machine()} {platform.processor()}"
    return "\n".join(sorted({line for line in lines if line.startswith(("flags", "Features", "model name"))}))
