"""Whole programs, timed from outside, each in a process of its own."""

from __future__ import annotations

import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path
from typing import Any

from .definitions import PROGRAMS, Program

ROOT = Path(__file__).parent.parent


def measure(program: Program) -> dict[str, Any]:
    """Times of whole runs, and the process's own peak memory over that of one that imports the
    package and no more.
    """
    with tempfile.TemporaryDirectory() as work:
        (Path(work) / "cases").symlink_to(ROOT / "cases")
        environment = os.environ | {"XDG_CACHE_HOME": f"{work}/cache", "PYTHONPATH": str(ROOT)}
        if not program.cold:
            _once(program, work, environment)
        runs = []
        for _ in range(program.repeat):
            if program.cold:
                shutil.rmtree(f"{work}/cache", ignore_errors=True)
            runs.append(_once(program, work, environment))
    peak = max(peak for _, peak, _ in runs)
    return {
        "median": statistics.median(seconds for seconds, _, _ in runs),
        "min": min(seconds for seconds, _, _ in runs),
        "peak": peak,
        "over_import": peak - _floor() if program is not PROGRAMS[0] else 0,
        "runs": len(runs),
        "says": runs[-1][2] if program.reports else "",
    }


def row(program: Program, found: dict[str, Any]) -> str:
    """A line of the table."""
    memory = f"{found['over_import'] / 1e6:>9.0f}"
    if program.bytes_returned:
        memory += f" = result {(found['over_import'] - program.bytes_returned) / 1e6:+.0f}"
    says = f": {found['says']}" if found["says"] else ""
    return (
        f"{program.name:<26}{found['median']:>9.3f}{found['min']:>9.3f}{memory:<24} "
        f" {program.what}{says}"
    )


HEADER = f"{'program':<26}{'median s':>9}{'min s':>9}{'MB over import':>15}"


@cache
def _floor() -> int:
    return int(measure(PROGRAMS[0])["peak"])


def _once(program: Program, work: str, environment: dict[str, str]) -> tuple[float, int, str]:
    start = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-c", program.text],
        cwd=work,
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    with process.stdout as printed:
        lines = printed.read().splitlines()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"benchmark {program.name} failed with status {process.returncode}")
    return (
        seconds,
        usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024),
        lines[-1] if lines else "",
    )
