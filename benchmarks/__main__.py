"""``python -m benchmarks [PATTERN ...]``: measure on this machine; tables to read, JSON lines, and
a plot.
"""

from __future__ import annotations

import argparse
import fnmatch
import json
import os
import platform
import sys
from pathlib import Path
from typing import Any

import psutil

from lagrange_casadi.engine.codegen import find_compiler
from lagrange_casadi.engine.codegen.compiler import FLAGS
from lagrange_casadi.version import __version__

from . import comparisons, plot, programs
from .definitions import COMPARISONS, PROGRAMS


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument(
        "patterns",
        nargs="*",
        default=["*"],
        help="names, with wildcards; default: all, for about half an hour",
    )
    parser.add_argument("--list", action="store_true", help="say which there are")
    parser.add_argument(
        "--shared",
        action="store_true",
        help="the machine has other work: tell the least of many short samples, not the median",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="append JSON lines to this file")
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw what was compared")
    arguments = parser.parse_args()
    names = {b.name: b.what for b in PROGRAMS} | {b.name: b.what for b in COMPARISONS}
    chosen = {
        name
        for name in names
        if any(fnmatch.fnmatch(name, pattern) for pattern in arguments.patterns)
    }
    if arguments.list:
        print("\n".join(f"{name:<26}{what}" for name, what in names.items()))
        return 0
    if not chosen:
        parser.error(f"no benchmark matches; valid: {', '.join(names)}")
    for target in (arguments.json, arguments.plot):
        try:
            if target:
                target.open("a").close()
        except OSError as error:
            parser.error(f"cannot write {target}: {error.strerror}")
    if arguments.plot and arguments.plot.suffix not in (".png", ".svg", ".pdf"):
        parser.error(f"--plot {arguments.plot}: expected a name that ends in .png, .svg or .pdf")
    machine = describe_machine()
    print(" | ".join(f"{key} {value}" for key, value in machine.items()))
    # Numerical libraries of the peers would else share the cores among themselves while one thread
    # is timed.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    rows = [*run_programs(chosen), *run_comparisons(chosen, arguments.shared)]
    if arguments.json:
        with arguments.json.open("a") as lines:
            lines.writelines(json.dumps(row | machine) + "\n" for row in rows)
    if arguments.plot:
        plot.draw(rows, arguments.plot)
    return 0


def run_programs(chosen: set[str]) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    for program in PROGRAMS:
        if program.name in chosen:
            if not rows:
                print(programs.HEADER)
            found = programs.measure(program)
            print(programs.row(program, found), flush=True)
            rows.append({"name": program.name, **found})
    return rows


def run_comparisons(chosen: set[str], shared: bool = False) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    for comparison in COMPARISONS:
        if comparison.name in chosen:
            print(comparisons.header(comparison), flush=True)
            for found in comparisons.measure(comparison, shared):
                print(comparisons.row(found), flush=True)
                rows.append(found)
    return rows


def describe_machine() -> dict[str, str]:
    compilers = {language: find_compiler(language) for language in FLAGS}
    return {
        "package": __version__,
        "python": platform.python_version(),
        "machine": (
            f"{platform.machine()}, {psutil.cpu_count()} cores,"
            f" {psutil.virtual_memory().total / 2**30:.0f} GiB"
        ),
        **{
            language: f"{c.version}: {' '.join(c.flags(''))}" if c else "none"
            for language, c in compilers.items()
        },
    }


if __name__ == "__main__":
    sys.exit(main())
