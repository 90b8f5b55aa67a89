"""The compilers: which there are, with what flags, and a cache of what they have built.

A library is named by the hash of its source, of the flags, of the compiler, and of the machine, of
its kind alone where the code serves any of that kind. It is built under another name and renamed,
so any number of processes may build the same one at once and none ever sees half of it; its digest
lies beside it, for a truncated library can load and then crash. Whatever of this is not as it was
left is built again.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import importlib.util
import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from ...base import cache, programs
from ...base.files import digest
from ...base.numerals import real
from ...base.vocabulary import Precision
from ...errors import CompilerError, lacking, warn

if TYPE_CHECKING:
    from _ctypes import CFuncPtr

Language = Literal["c", "c++"]

_COMMON = (
    "-fno-math-errno",
    "-ffp-contract=off",
    "-fvisibility=hidden",
    "-fPIC",
    "-shared",
    "-nostartfiles",
)
LEVEL = "-O3"
FLAGS: dict[Language, tuple[str, ...]] = {
    "c": ("-std=c99", LEVEL, *_COMMON),
    "c++": ("-std=c++11", LEVEL, "-march=native", *_COMMON),
}
"""No contraction: a product and a sum round as written. Nobody reads errno; without it a root is an
instruction, no call. No start files: those that gcc links in where -ffast-math is asked for make
the whole process flush to zero what is subnormal."""

VARIABLE = "LAGRANGE_CASADI_COMPILER_TIMEOUT"
"""The variable that sets another time limit of compilers, in seconds."""

_LIMIT, _LONGEST = 600.0, 1e6
LANES_PLACE = "/* As C++ for packs of instants, lanes.h goes here. */\n"
"""Place of ``lanes.h`` in an emitted file."""

_START = (
    LANES_PLACE
    + """\
#include <math.h>
#include <string.h>
#define casadi_int long long
#ifndef casadi_real
#define casadi_real double
#endif
#ifdef LANES
#define LAGRANGE_CASADI_C extern "C"
#else
#define LANES 1
#define LANES_INLINE static inline
#define LAGRANGE_CASADI_C
#ifdef LANES_SINGLE
#define lanes_real float
#define lanes_size fabsf
#else
#define lanes_real double
#define lanes_size fabs
#endif
#define lanes_pack lanes_real
#define lanes_choose(where, a) ((where) ? (a) : 0)
#define lanes_sign(x) ((x) < 0 ? -1 : (x) > 0 ? 1 : (x))
#define lanes_less(x, y, a, b) ((x) < (y) ? (a) : (b))
#define lanes_larger(x, y) ((x) < (y) ? (y) : (x))
#define lanes_where_less(x, y) ((x) < (y))
#define lanes_any_nan(x) ((x) != (x))
#if defined(__clang__)
#define lanes_stream(to, x) __builtin_nontemporal_store(x, to)
#elif defined(__GNUC__) && defined(__x86_64__) && !defined(LANES_SINGLE)
LANES_INLINE void lanes_stream(double* to, double x) {
  long long bits;
  memcpy(&bits, &x, sizeof bits);
  __builtin_ia32_movnti64((long long*) to, bits);
}
#else
#define lanes_stream(to, x) (*(to) = (x))
#endif
#endif
#ifdef __SSE2__
#define lanes_streamed() __builtin_ia32_sfence()
#else
#define lanes_streamed() ((void) 0)
#endif
#ifdef __GNUC__
#define LAGRANGE_CASADI_EXPORT LAGRANGE_CASADI_C __attribute__((visibility("default")))
#define LAGRANGE_CASADI_PART __attribute__((noinline))
#define LAGRANGE_CASADI_RARE __attribute__((noinline, cold))
#else
#define LAGRANGE_CASADI_RARE
#define LAGRANGE_CASADI_PART
#define LAGRANGE_CASADI_EXPORT LAGRANGE_CASADI_C
#endif
"""
)
_SINGLE = "#define LANES_SINGLE\n#define casadi_real float\n"

WIDE = """
#undef casadi_real
#define casadi_real lanes_pack
"""
"""Definitions for packs of instants."""


_LINE = 300
"""Characters of a compiler's message that are quoted at most."""

_ANSWER = 20
"""Divisor of the time limit for the query of a compiler's version."""

LARGE = 20_000
"""Statements from which on a file is compiled with -O1: see ``docs/speed.md`` for what that saves
and costs.
"""

_RARE = "LAGRANGE_CASADI_RARE "
"""First word of functions that are compiled for size, after ``static``."""

INSTALL = "pip install 'lagrange_casadi[compiler]'"
"""The command that installs a compiler."""

_NAMES: dict[Language, tuple[str, tuple[str, ...]]] = {
    "c": ("CC", ("cc", "gcc", "clang")),
    "c++": ("CXX", ("c++", "g++", "clang++")),
}


@dataclass(frozen=True)
class Compiler:
    """A compiler: its language, the command that runs it and the first line of its version, which
    holds no path.
    """

    language: Language
    command: tuple[str, ...]
    version: str

    def flags(self, source: str, level: str = LEVEL) -> tuple[str, ...]:
        """The flags for a source, at a level of optimization where it is not large."""
        level = level if statements(source) < LARGE else "-O1"
        return tuple(level if flag == LEVEL else flag for flag in FLAGS[self.language])


def statements(source: str) -> int:
    """Number of statements of a source, about, without those of rare functions: a measure of the
    time to compile and to run it.
    """
    functions = source.split("\nstatic ")
    return sum(text.count(";\n") for text in functions if not text.startswith(_RARE))


def no_compiler(needs: str, *languages: Language) -> CompilerError:
    """Message that something needs a compiler, of one of ``languages`` or of any, and how to
    install one.
    """
    tried = (_NAMES[language] for language in languages or ("c++", "c"))
    words = ", ".join(name for variable, names in tried for name in (f"${variable}", *names))
    return CompilerError(f"{needs}: none of {words} or the package ziglang was found; {INSTALL}")


def find_compiler(language: Language = "c") -> Compiler | None:
    """$CC, else cc, gcc, clang (of C++: $CXX, c++, g++, clang++), else the wheel ziglang; None
    where there is none.

    Raises :class:`CompilerError` where the variable is set and does not run, or the system starts
    no program.
    """
    return _find_compiler(
        language, os.environ.get(_NAMES[language][0], "").strip(), os.environ.get("PATH", "")
    )


@functools.lru_cache(maxsize=16)
def _find_compiler(language: Language, chosen: str, _path: str) -> Compiler | None:
    """Find the compiler of the environment, which a process may change."""
    variable, names = _NAMES[language]
    if chosen:
        try:
            command = tuple(shlex.split(chosen))
        except ValueError as error:
            raise CompilerError(
                f"${variable} = {chosen!r} cannot be split into words: {error}"
            ) from None
        try:
            version = _version(command)
        except subprocess.TimeoutExpired as error:
            raise CompilerError(f"${variable} = {chosen!r} {_silent(error)}") from None
        if version is None:
            raise CompilerError(
                f"${variable} = {chosen!r} does not run; unset it, or name a compiler such as"
                f" {', '.join(names)}"
            )
        return Compiler(language, command, version)
    commands: list[tuple[str, ...]] = [(name,) for name in names if shutil.which(name)]
    if _has_zig():
        # Its C library has no libmvec to link with.
        commands.append(
            (
                sys.executable,
                "-m",
                "ziglang",
                *(("cc",) if language == "c" else ("c++", "-DLANES_LIBMVEC=0")),
            )
        )
    for command in commands:
        try:
            version = _version(command)
        except subprocess.TimeoutExpired as error:
            warn(f"the compiler {' '.join(command)} is passed over: it {_silent(error)}")
            continue
        if version is not None:
            return Compiler(language, command, version)
    return None


def _has_zig() -> bool:
    try:
        return importlib.util.find_spec("ziglang") is not None
    except OSError:
        return False


def _version(command: tuple[str, ...]) -> str | None:
    """The first line of a compiler's version, None where it does not run.

    Raises ``subprocess.TimeoutExpired``.
    """
    try:
        run = programs.run([*command, "--version"], limit() / _ANSWER)
    except OSError as error:
        if lacking(error):
            raise CompilerError(f"cannot start {' '.join(command)}: {error.strerror}") from None
        return None
    if run.returncode != 0:
        return None
    return run.stdout.partition("\n")[0].strip() or "unknown version"


def _silent(error: subprocess.TimeoutExpired) -> str:
    return (
        f"did not report its version within {error.timeout:g} s; ${VARIABLE} sets"
        f" {_ANSWER} times as many"
    )


def start(precision: Precision) -> str:
    """First lines of an emitted file; until :data:`WIDE` stands, ``casadi_real`` is one number."""
    return (_SINGLE if precision == "single" else "") + _START


def written(*names: str) -> str:
    """C that is written by hand: files of this folder, one after another."""
    folder = resources.files(__package__)
    return "\n".join(folder.joinpath(name).read_text() for name in names)


def loaded(
    source: str, compiler: Compiler, extra: tuple[str, ...] = (), level: str = LEVEL
) -> ctypes.CDLL:
    """The shared library of a source, for C++ with packs before it, from the cache or newly built.

    ``extra`` flags come after the package's own. Warns where the cache cannot be used, and where
    what it held was damaged. Raises :class:`CompilerError` where the compiler refuses the source,
    whose whole message is kept beside the source in the cache, does not end in time, or builds what
    does not load.
    """
    if compiler.language == "c++":
        source = source.replace(LANES_PLACE, written("lanes.h"), 1)
    flags = (*compiler.flags(source, level), *extra)
    machine = _machine() if "-march=native" in flags else platform.machine()
    identity = "\0".join([source, *flags, *compiler.command, compiler.version, machine])
    name = hashlib.sha256(identity.encode()).hexdigest()[:32]
    folder = cache.folder()
    kept = None if folder is None else _kept(folder / f"{name}.so")
    if kept is not None:
        return kept
    with cache.working_folder() as work:
        fresh = _compile(source, compiler, flags, work / name, folder)
        if folder is not None:
            try:
                cache.keep(
                    [fresh.with_suffix(suffix) for suffix in (_suffix(compiler), ".sha256", ".so")],
                    folder,
                )
            except OSError as error:
                warn(
                    f"cannot keep a library in {folder}: {error.strerror}; compiled for this time"
                    " only"
                )
        try:
            return ctypes.CDLL(str(fresh))
        except OSError as error:
            raise broken(compiler, error) from None


def entry_of(library: ctypes.CDLL, name: str, compiler: Compiler) -> CFuncPtr:
    """A function of a library. Raises :class:`CompilerError` where it lacks it."""
    try:
        found: CFuncPtr = getattr(library, name)
    except AttributeError as error:
        raise broken(compiler, error) from None
    return found


def broken(compiler: Compiler, error: Exception) -> CompilerError:
    """Message on a library that does not load, or lacks a function."""
    return CompilerError(
        f"the library built by {' '.join(compiler.command)} does not load: {error}"
    )


def _kept(library: Path) -> ctypes.CDLL | None:
    """A library of the cache, unless it is not there, or is not what was put there."""
    try:
        found = cache.distrusted(library)
        seal, content = library.with_suffix(".sha256").read_bytes(), library.read_bytes()
    except FileNotFoundError:  # also where another process makes room meanwhile
        return None
    except OSError as error:
        why = f"cannot be read ({error.strerror})"
    else:
        if found:
            why = f"is not trusted ({found})"
        elif seal == digest(content).encode():
            try:
                there = ctypes.CDLL(str(library))
                cache.use(library)
                return there
            except OSError as error:
                if not library.exists():
                    return None
                why = f"does not load ({error})"
        else:
            why = "was damaged"
    warn(f"the cached library {library} {why} and is built again")
    return None


def _suffix(compiler: Compiler) -> str:
    return ".c" if compiler.language == "c" else ".cpp"


def _compile(
    source: str, compiler: Compiler, flags: tuple[str, ...], base: Path, folder: Path | None
) -> Path:
    """Compile beside ``base``; a message of the compiler's is kept in ``folder``."""
    code, library = base.with_suffix(_suffix(compiler)), base.with_suffix(".so")
    command = [*compiler.command, *flags, str(code), "-o", str(library), "-lm"]
    try:
        code.write_text(source, encoding="utf-8")
        run = compiled(command)
    except OSError as error:
        raise CompilerError(f"cannot compile in {base.parent}: {error.strerror}") from None
    if run.returncode != 0 or not library.exists():
        where = ""
        if folder is not None:
            log = base.with_suffix(".log")
            with suppress(OSError):
                log.write_text(run.stderr, encoding="utf-8")
                cache.keep([code, log], folder)
                where = f" (whole message in {folder / log.name})"
        raise CompilerError(f"{complaint(compiler, run)}{where}")
    library.with_suffix(".sha256").write_text(digest(library.read_bytes()))
    return library


def built(
    compiler: Compiler,
    command: Sequence[str],
    files: Mapping[str, str],
    result: str,
    check: Callable[[Path], None] = lambda path: None,
) -> bytes:
    """Compile ``files`` in a folder of their own, so that no path gets into the ``result``; what it
    holds is returned, once ``check`` has seen it.

    Raises :class:`CompilerError`.
    """
    with cache.working_folder() as work:
        try:
            for file, text in files.items():
                (work / file).write_text(text, encoding="utf-8")
            run = compiled(command, work)
            if run.returncode == 0:
                check(work / result)
                return (work / result).read_bytes()
        except OSError as error:
            raise CompilerError(f"cannot compile in {work}: {error.strerror}") from None
    raise CompilerError(complaint(compiler, run))


def limit() -> float:
    """Seconds that a compiler may take for one file.

    Raises :class:`CompilerError` where the variable is no number above 0.
    """
    text = os.environ.get(VARIABLE, "").strip()
    try:
        seconds = real(text) if text else _LIMIT
        if not seconds > 0.0:
            raise ValueError
    except ValueError:
        raise CompilerError(
            f"${VARIABLE} = '{text}': expected a number of seconds above 0; without it they are"
            f" {_LIMIT:g}"
        ) from None
    return min(seconds, _LONGEST)


def compiled(
    command: Sequence[str], folder: Path | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a compiler.

    Raises ``OSError`` where it cannot be started, :class:`CompilerError` where it does not end in
    time.
    """
    try:
        return programs.run(command, limit(), folder)
    except subprocess.TimeoutExpired as error:
        raise CompilerError(
            f"{command[0]} did not end within {error.timeout:g} s and was stopped;"
            f" ${VARIABLE} sets another limit"
        ) from None


def complaint(compiler: Compiler, run: subprocess.CompletedProcess[str]) -> str:
    """The first of what a compiler that failed has to say."""
    first = next(
        (line for line in run.stderr.splitlines() if "error" in line.lower()),
        run.stderr.strip() or "no message",
    )
    return (
        f"{' '.join(compiler.command)} failed with status {run.returncode}: {first.strip()[:_LINE]}"
    )


def _machine() -> str:
    """Description of ``native`` on this machine: several machines may share a cache."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return f"{platform.machine()} {platform.processor()}"
    return "\n".join(
        sorted({line for line in lines if line.startswith(("flags", "Features", "model name"))})
    )
