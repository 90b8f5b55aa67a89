"""The columns of a scene graph over instants: by packs, by scalar C, or by CasADi's virtual machine."""

from __future__ import annotations

import functools
import math
import warnings
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import h5py
import numpy as np
import numpy.typing as npt

from . import codegen, grids
from .codegen.emit import (
    NEWTON_DONE,
    NEWTON_RATE,
    NEWTON_ROUNDING,
    NEWTON_STEPS,
    NOT_CONVERGED,
    NOT_FINITE,
    OK,
    SLOW,
)
from .density import Array
from .errors import CompilerError, UnknownNameError
from .scene_graph import SceneGraph
from .solution import Provenance
from .version import __version__

Backend = Literal["auto", "lanes", "c", "vm"]
BACKENDS: tuple[Backend, ...] = ("auto", "lanes", "c", "vm")

_LANGUAGES: dict[Backend, tuple[codegen.Language, ...]] = {"auto": ("c++", "c"), "lanes": ("c++",), "c": ("c",), "vm": ()}
_NEEDS = {
    "lanes": "backend 'lanes' needs a C++ compiler: none of $CXX, c++, g++, clang++ or the Python package ziglang is there",
    "c": "backend 'c' needs a C compiler: none of $CC, cc, gcc, clang or the Python package ziglang is there",
}
_VM_BLOCK = 4096


@dataclass(frozen=True, eq=False)
class Table:
    """The columns of a scene graph over instants: ``out`` (columns, t) and the status of each instant (t)."""

    out: Array
    status: npt.NDArray[np.int32]


def run(graph: SceneGraph, t: Array, p: Array, backend: Backend = "auto", threads: int | None = None) -> tuple[Table, Provenance]:
    """The columns of a graph at instants ``t`` and parameters ``p``, by the given backend; nothing is checked.

    Raises :class:`CompilerError` where the backend needs a compiler and there is none, or it fails.
    """
    if backend not in BACKENDS:
        raise UnknownNameError("backend", str(backend), BACKENDS)
    compiled = _compiled(graph, backend)
    if compiled is None:
        return _interpret(graph, t, p), _provenance("vm", "", "")
    compiler, library = compiled
    guess = np.array(graph.newton.guess if graph.newton else ())
    table, z = _table(graph, t), rows(guess.size, t.size)
    library.follow(t, p, guess, z, table.status)
    library.evaluate(t, p, z, table.out, table.status, threads or codegen.cores())
    used = "lanes" if compiler.language == "c++" else "c"
    return table, _provenance(used, compiler.version, " ".join(library.flags))


def _compiled(graph: SceneGraph, backend: Backend) -> tuple[codegen.Compiler, codegen.Library] | None:
    """The library that a backend takes, and what built it; None for the virtual machine."""
    for language in _LANGUAGES[backend]:
        compiler = codegen.find_compiler(language)
        if compiler is None:
            continue
        try:
            return compiler, _library(graph, compiler)
        except CompilerError as error:
            if backend != "auto" or language == "c":
                raise
            warnings.warn(f"{error}; scalar C serves", stacklevel=4)
    if backend in _NEEDS:
        raise CompilerError(_NEEDS[backend])
    if backend == "auto":
        tried = "c++, g++, clang++, cc, gcc, clang, ziglang"
        warnings.warn(f"no C or C++ compiler found ({tried}): CasADi's virtual machine serves, slowly", stacklevel=4)
    return None


@functools.lru_cache(maxsize=32)
def _library(graph: SceneGraph, compiler: codegen.Compiler) -> codegen.Library:
    return codegen.load(codegen.emit(graph), compiler)


def _table(graph: SceneGraph, t: Array) -> Table:
    return Table(rows(len(graph.columns), t.size), np.full(t.size, OK, dtype=np.int32))


def rows(count: int, size: int) -> Array:
    """Rows an odd number of cache lines apart: at a power of two all would share the same few lines of the cache."""
    stride = 8 * (-(-size // 8) | 1)
    return grids.empty("the outputs over time", (count, stride))[:, :size]


def _provenance(backend: str, compiler: str, flags: str) -> Provenance:
    versions = {
        "lagrange_casadi": __version__,
        "casadi": ca.CasadiMeta.version(),
        "numpy": np.__version__,
        "h5py": h5py.__version__,
        "hdf5": h5py.version.hdf5_version,
    }
    return Provenance(backend, "double", compiler, flags, versions)


def _interpret(graph: SceneGraph, t: Array, p: Array) -> Table:
    """What the emitted C does, by CasADi's virtual machine."""
    table = _table(graph, t)
    z, table.status[:] = follow(graph, t, p)
    for start in range(0, t.size, _VM_BLOCK):
        block = slice(start, min(start + _VM_BLOCK, t.size))
        table.out[:, block] = graph.instant(t[None, block], *graph.motion(t[None, block], p), z[:, block], p).full()
    unclean = ~np.isfinite(table.out).all(axis=0) & (table.status == OK)
    table.status[unclean] = NOT_FINITE
    return table


def follow(graph: SceneGraph, t: Array, p: Array, guess: Array | None = None) -> tuple[Array, npt.NDArray[np.int32]]:
    """Iterated coordinates (z, t), each instant from the one before, the first from ``guess`` or the graph's own; and statuses."""
    if graph.newton is None:
        return np.zeros((0, t.size)), np.full(t.size, OK, dtype=np.int32)
    last = np.array(graph.newton.guess) if guess is None else guess
    z, status = rows(last.size, t.size), np.full(t.size, OK, dtype=np.int32)
    for start in range(0, t.size, _VM_BLOCK):
        driven = np.atleast_2d(graph.motion(t[None, start : start + _VM_BLOCK], p)[0].full())
        for i, d in enumerate(driven.T, start):
            z[:, i], status[i] = _iterate(graph.newton.step, last, t[i], d, p)
            last = last if status[i] == NOT_CONVERGED else z[:, i]
    return z, status


def _iterate(step: ca.Function, z: Array, t: float, d: Array, p: Array) -> tuple[Array, int]:
    guess, size = z, 1.0
    for _ in range(NEWTON_STEPS):
        before = size
        correction, relative = (x.full().ravel() for x in step(z, t, d, p))
        size = float(relative[0])
        if not math.isfinite(size):
            break
        z = z + correction
        if size < NEWTON_DONE:
            return z, SLOW if size > NEWTON_RATE * before and size > NEWTON_ROUNDING else OK
    return guess, NOT_CONVERGED
