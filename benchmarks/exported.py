"""Exported C beside the package's own scalar C: the same instants of a case, one after another, in
one process.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from lagrange_casadi import compile_scene, export, load_case
from lagrange_casadi.engine import codegen
from lagrange_casadi.engine.codegen.compiler import FLAGS
from lagrange_casadi.engine.instants.backends import rows

N = 1000
_ROUNDS = 300


def report(case: str) -> str:
    """Nanoseconds an instant of both, all outputs, the best of many rounds that take turns."""
    scene = load_case(Path(__file__).parent.parent / "cases" / case).scene
    program, compiler = compile_scene(scene), codegen.find_compiler("c")
    if compiler is None or program.newton is not None:
        raise RuntimeError("needs a C compiler, and a case without iterated loops")
    t, p = np.linspace(*scene.t[:2], N), np.array(list(scene.mechanism.values().values()))
    out, z, status = rows(len(program.columns), N), np.empty((0, N)), np.zeros(N, dtype=np.int32)
    library = codegen.load(codegen.emit(program), compiler)
    with tempfile.TemporaryDirectory() as folder:
        batch = _batch(scene, compiler, Path(folder), t)
        both: list[Callable[[], Any]] = [library.evaluation(t, p, z, z, out, status), batch]
        best = [np.inf, np.inf]
        for _ in range(_ROUNDS):
            for k, call in enumerate(both):
                start = time.perf_counter()
                call()
                best[k] = min(best[k], time.perf_counter() - start)
    package, exported = (1e9 * seconds / N for seconds in best)
    return (
        f"exported C {exported:.1f} ns an instant, the package's scalar C {package:.1f} ns, ratio"
        f" {exported / package:.2f}"
    )


def _batch(
    scene: Any, compiler: codegen.Compiler, folder: Path, t: np.ndarray[Any, Any]
) -> Callable[[], Any]:
    """A call that evaluates the instants by exported C, compiled with the flags of the package's
    own.
    """
    made = export(scene, folder)
    target = folder / "exported.so"
    command = [
        *compiler.command,
        *FLAGS["c"],
        "-fvisibility=default",
        str(folder / f"{made.prefix}.c"),
        "-o",
        str(target),
        "-lm",
    ]
    subprocess.run(command, check=True)
    loaded = ctypes.CDLL(str(target))
    model, inputs = ctypes.create_string_buffer(1 << 16), np.empty((t.size, len(made.inputs)))
    outputs, statuses = np.empty((t.size, len(made.outputs))), np.empty(t.size, dtype=np.int32)
    motion = getattr(loaded, f"{made.prefix}_motion")
    motion.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p]
    getattr(loaded, f"{made.prefix}_prepare")(model, *([None] if made.settings else []))
    for row, instant in zip(inputs, t, strict=True):
        assert motion(model, instant, row.ctypes.data) == 0
    entry = getattr(loaded, f"{made.prefix}_batch")
    entry.argtypes = [ctypes.c_void_p, ctypes.c_long, *[ctypes.c_void_p] * 3]
    places = [array.ctypes.data for array in (inputs, outputs, statuses)]

    def call() -> Any:
        assert entry(model, t.size, *places) == 0
        return inputs, outputs, statuses, loaded

    return call
