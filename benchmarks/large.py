"""Large graphs: how long compilers take, at their levels of optimization, and what that brings."""

from __future__ import annotations

import sys
import time

import numpy as np

from lagrange_casadi.engine import codegen
from lagrange_casadi.engine.codegen.compiler import Language

from .engine import chain

LEVELS: tuple[tuple[Language, str], ...] = (
    ("c", "-O1"),
    ("c", "-O3"),
    ("c++", "-O1"),
    ("c++", "-O3"),
)


def report(links: int) -> str:
    """Of an open chain, everything: stages in seconds, and the time of an instant by each level."""
    start = time.perf_counter()
    program = chain(links, ("all",))
    derived = time.perf_counter()
    source = codegen.emit(program)
    said = (
        f"{program.instructions['instant']} instructions, derive {derived - start:.2f} s, emit"
        f" {time.perf_counter() - derived:.2f} s"
    )
    for language, level in LEVELS:
        compiler = codegen.find_compiler(language)
        if compiler is None:
            continue
        start = time.perf_counter()
        library = codegen.load(source, compiler, (level,))
        compiled = time.perf_counter() - start
        said += (
            f"; {language} {level} {compiled:.2f} s,"
            f" {_instant(library, len(program.columns)) * 1e6:.2f} us/instant"
        )
    return said


def _instant(library: codegen.Library, columns: int, n: int = 1024) -> float:
    t, p = np.linspace(0.0, 1.0, n), np.zeros(0)
    out, status, z = (
        np.empty((columns, n + 8))[:, :n],
        np.zeros(n, dtype=np.int32),
        np.empty((0, n)),
    )
    times = []
    for _ in range(5):
        start = time.perf_counter()
        library.evaluation(t, p, z, z, out, status)()
        times.append(time.perf_counter() - start)
    return min(times) / n


if __name__ == "__main__":
    print(report(int(sys.argv[1])))
