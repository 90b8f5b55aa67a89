"""``python -m benchmarks [PATTERN ...]``: measure on this machine; a table to read, and JSON lines with ``--json FILE``."""

from __future__ import annotations

import argparse
import fnmatch
import json
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import psutil

from lagrange_casadi.codegen import find_compiler
from lagrange_casadi.codegen.compiler import FLAGS
from lagrange_casadi.version import __version__

from .definitions import BENCHMARKS, Benchmark

ROOT = Path(__file__).parent.parent


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("patterns", nargs="*", default=["*"], help="names, with wildcards; default: all")
    parser.add_argument("--json", type=Path, help="append one JSON line a benchmark to this file")
    arguments = parser.parse_args()
    chosen = [b for b in BENCHMARKS if any(fnmatch.fnmatch(b.name, pattern) for pattern in arguments.patterns)]
    if not chosen:
        parser.error(f"no benchmark matches; valid: {', '.join(b.name for b in BENCHMARKS)}")
    machine = describe_machine()
    print(" | ".join(f"{key} {value}" for key, value in machine.items()))
    print(f"{'name':<16}{'median s':>10}{'min s':>10}{'peak MB':>10}{'over import':>15}  what")
    floor = measure(BENCHMARKS[0])["peak"]
    for benchmark in chosen:
        result = measure(benchmark)
        extra = result["peak"] - floor
        ratio = f"{extra / benchmark.bytes_returned:.2f} x result" if benchmark.bytes_returned else ""
        figures = f"{result['median']:>10.3f}{result['min']:>10.3f}{result['peak'] / 1e6:>10.0f}{ratio:>15}"
        print(f"{benchmark.name:<16}{figures}  {benchmark.what}{': ' + result['says'] if result['says'] else ''}")
        if arguments.json:
            with arguments.json.open("a") as lines:
                lines.write(json.dumps({"name": benchmark.name, **result, "memory_over_import": extra, **machine}) + "\n")
    return 0


def describe_machine() -> dict[str, str]:
    compiler = find_compiler()
    return {
        "package": __version__,
        "python": platform.python_version(),
        "machine": f"{platform.machine()}, {psutil.cpu_count()} cores, {psutil.virtual_memory().total / 2**30:.0f} GiB",
        "compiler": compiler.version if compiler else "none",
        "flags": " ".join(FLAGS),
    }


def measure(benchmark: Benchmark) -> dict[str, Any]:
    """Whole processes, timed from outside; the peak is the process's own resident memory."""
    with tempfile.TemporaryDirectory() as work:
        (Path(work) / "cases").symlink_to(ROOT / "cases")
        environment = os.environ | {"XDG_CACHE_HOME": f"{work}/cache", "PYTHONPATH": str(ROOT)}
        if not benchmark.cold:
            run_once(benchmark, work, environment)
        runs = []
        for _ in range(benchmark.repeat):
            if benchmark.cold:
                shutil.rmtree(f"{work}/cache", ignore_errors=True)
            runs.append(run_once(benchmark, work, environment))
    times = [seconds for seconds, _, _ in runs]
    says = runs[-1][2] if benchmark.reports else ""
    return {
        "median": statistics.median(times),
        "min": min(times),
        "peak": max(peak for _, peak, _ in runs),
        "runs": len(runs),
        "says": says,
    }


def run_once(benchmark: Benchmark, work: str, environment: dict[str, str]) -> tuple[float, int, str]:
    start = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-c", benchmark.program], cwd=work, env=environment, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    with process.stdout as printed:
        lines = printed.read().splitlines()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"benchmark {benchmark.name} failed with status {process.returncode}")
    return seconds, usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024), lines[-1] if lines else ""


if __name__ == "__main__":
    sys.exit(main())
