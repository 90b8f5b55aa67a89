"""Mutations of the package: a suite is as good as those that it notices.

``python tests/mutations.py map [PYTEST ARGUMENTS]`` runs tests, and keeps which of them reach which
line of the package. ``python tests/mutations.py draw --seed SEED`` draws places in what computes
numbers, changes one at a time in a copy of the package, and runs tests that reach its line, those
that reach the fewest lines first. It prints what no test notices; those that change no number are
set apart by reading in ``equivalent.txt``.
"""

from __future__ import annotations

import argparse
import ast
import functools
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import psutil
import pytest

TESTS = Path(__file__).parent
ROOT, MAPS, EQUIVALENT = TESTS.parent, TESTS / "maps", TESTS / "equivalent.txt"
PACKAGE = ROOT / "lagrange_casadi"

NUMBERS = (
    *("base/bernstein.py", "base/frames.py", "base/interpret.py", "engine/compensated.py"),
    *("base/ipopt.py", "base/lookups.py", "base/rotation.py"),
    *("base/scalars.py", "base/vectors.py", "model", "engine", "results", "studies/designs"),
    *("studies/peaks_between.py", "studies/forward", "studies/actuators", "studies/identification"),
)
"""Folders and modules that compute numbers, C that is compiled among them."""

PROCESSES, SECONDS = 2, 30.0
"""Processes that run tests of one mutation, and seconds of a processor that each may take."""

MOST = 200
"""Tests that are asked at most: more take longer than there is, and to collect them takes time."""

_SWAPS: dict[type[ast.AST], type[ast.AST]] = {ast.Add: ast.Sub, ast.Eq: ast.NotEq}
_SWAPS |= {ast.Lt: ast.GtE, ast.Gt: ast.LtE}
_SWAPS |= {swapped: sign for sign, swapped in _SWAPS.items()}
_C_SWAPS = {"+": "-", "<": ">=", ">": "<=", "==": "!="}
_C_SWAPS |= {swapped: sign for sign, swapped in _C_SWAPS.items()}
_NO_NUMBERS = (ast.JoinedStr, ast.List, ast.Tuple, ast.Dict, ast.ListComp, ast.Set)


@dataclass(frozen=True)
class Mutation:
    """A change of one expression in a file, from ``start`` to ``end`` in bytes.

    ``line`` is the line of the expression, ``first`` that of its statement.
    """

    file: str
    first: int
    line: int
    start: int
    end: int
    old: str
    new: str

    def __str__(self) -> str:
        return f"{self.file}: {self.old} -> {self.new}"

    def apply(self, package: Path) -> None:
        text = (PACKAGE / self.file).read_bytes()
        changed = text[: self.start] + self.new.encode() + text[self.end :]
        (package / self.file).write_bytes(changed)

    def undo(self, package: Path) -> None:
        shutil.copyfile(PACKAGE / self.file, package / self.file)


def mutations() -> Iterator[Mutation]:
    """Yield all mutations of what computes numbers."""
    for name in NUMBERS:
        path = PACKAGE / name
        for file in sorted(path.rglob("*.*")) if path.is_dir() else [path]:
            if file.suffix == ".py":
                yield from _of_python(file)
            elif file.suffix in (".c", ".h"):
                yield from _of_c(file)


def _of_python(file: Path) -> Iterator[Mutation]:
    text, name = file.read_bytes(), file.relative_to(PACKAGE).as_posix()
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for node, new, first in _changes(ast.parse(text), 0):
        start = starts[node.lineno - 1] + node.col_offset
        end = starts[node.end_lineno - 1] + node.end_col_offset
        old, changed = ast.unparse(node), f"({ast.unparse(new)})"
        yield Mutation(name, first, node.lineno, start, end, old, changed)


def _changes(tree: ast.AST, first: int) -> Iterator[tuple[ast.expr, ast.expr, int]]:
    """Yield expressions of numbers, each with another in its place, and their statement's line."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Raise | ast.Assert | ast.JoinedStr | ast.arguments):
            continue
        line = node.lineno if isinstance(node, ast.stmt) else first
        for new in _changed(node):
            yield node, new, line
        types = [getattr(node, "returns", None), getattr(node, "annotation", None)]
        left = [child for child in ast.iter_child_nodes(node) if child not in types]
        yield from _changes(ast.Module(left, []), line)


def _changed(node: ast.AST) -> Iterator[ast.expr]:
    """Yield what may stand in place of an expression."""
    match node:
        case ast.BinOp(left=a, right=b, op=ast.Add() | ast.Sub() as sign):
            if not any(isinstance(x, _NO_NUMBERS) or _is_text(x) for x in (a, b)):
                yield ast.BinOp(a, _SWAPS[type(sign)](), b)
                yield a
        case ast.UnaryOp(op=ast.USub(), operand=x) if not isinstance(x, ast.Constant):
            yield x
        case ast.Compare(ops=[sign], left=a, comparators=[b]) if type(sign) in _SWAPS:
            if not (_is_text(a) or _is_text(b)):
                yield ast.Compare(a, [_SWAPS[type(sign)]()], [b])
        case ast.Subscript(value=x, slice=ast.Constant(value=int(k)), ctx=ast.Load()):
            yield ast.Subscript(x, ast.Constant(k + 1 if k == 0 else k - 1))


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _of_c(file: Path) -> Iterator[Mutation]:
    text, name = file.read_text(), file.relative_to(PACKAGE).as_posix()
    code = re.sub(r"/\*.*?\*/|^#.*?$", lambda m: " " * len(m[0]), text, flags=re.DOTALL | re.M)
    for found in re.finditer(r"(?<= )(?:[-+<>]|[<>=!]=)(?= )", code):
        start, end = (len(text[:k].encode()) for k in found.span())
        number = text.count("\n", 0, start) + 1
        shown = text.splitlines()[number - 1].strip()
        yield Mutation(
            name, number, number, start, end, f"{found[0]} in {shown!r}", _C_SWAPS[found[0]]
        )


class Map:
    """Tests by the lines of the package that they reach."""

    def __init__(self, path: Path) -> None:
        from coverage import CoverageData

        self.data = CoverageData(str(path))
        self.data.read()
        self.cases = ElementTree.parse(path.with_suffix(".xml")).iter("testcase")

    @cached_property
    def lines(self) -> dict[str, dict[int, set[str]]]:
        """Tests by file and line; a line that runs while modules are imported has none."""
        return {
            Path(file).relative_to(PACKAGE).as_posix(): {
                line: {context.rpartition("|")[0] for context in contexts} - {""}
                for line, contexts in self.data.contexts_by_lineno(file).items()
            }
            for file in self.data.measured_files()
            if Path(file).exists()
        }

    @cached_property
    def counts(self) -> Counter[str]:
        """How many lines each test reaches."""
        found = (
            test for lines in self.lines.values() for tests in lines.values() for test in tests
        )
        return Counter(found)

    def reaching(self, mutation: Mutation) -> Counter[str]:
        """Return how many lines of a mutation's statement each test reaches.

        Lines of the whole module count for C, and for a statement that an import runs.
        """
        module = mutation.file
        if module not in self.lines:
            path = Path(module)
            near = sorted(self.lines, key=lambda one: (Path(one).parent != path.parent, one))
            quoted = re.compile(f"""["']{re.escape(path.name)}["']""")
            module = next(one for one in near if quoted.search((PACKAGE / one).read_text()))
        lines = self.lines[module]
        own = [lines[k] for k in range(mutation.first, mutation.line + 1) if k in lines]
        if module != mutation.file or (own and not any(own)):
            own = [*lines.values()]
        return Counter(test for tests in own for test in tests)

    @cached_property
    def seconds(self) -> dict[str, float]:
        """Seconds that each test took, by its module's file and its name."""
        return {
            f"{case.get('classname', '').replace('.', '/')}.py::{case.get('name')}": float(
                case.get("time", 0.0)
            )
            for case in self.cases
        }

    @cached_property
    def collected(self) -> set[str]:
        """Tests that there are."""
        command = [sys.executable, "-m", "pytest", "--collect-only", "-n0"]
        found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        return {line for line in found.stdout.splitlines() if "::" in line}

    def tests(self, mutation: Mutation) -> list[str]:
        """Return tests that reach a statement, in the order in which they are asked.

        Each function is asked once before any is asked again, those first that take little time
        and reach few other lines; of the functions that draw random mechanisms one mechanism
        follows every two other tests. Those that hold C alone to drawn inputs come before all. For
        C those are asked next that reach much of the module and ask whether all ways agree: what
        they compile is small.
        """
        found, compiled = self.reaching(mutation), not mutation.file.endswith(".py")
        there = [test for test in found if test in self.collected]
        much = max(found.values(), default=0) // 2

        def worth(test: str) -> tuple[float, float, str]:
            seconds = 0.2 + self.seconds.get(test, 1.0)
            share = -min(found[test], much) if compiled else 0.0
            return share, seconds * self.counts[test] ** 0.5, test

        asked, turns = Counter(), {}
        for test in sorted(there, key=worth):
            function = test.partition("[")[0]
            turns[test] = compiled and "tests/agree/" not in test, asked[function]
            asked[function] += 1
        ordered = sorted(turns, key=turns.__getitem__)
        mixed = [test for test in ordered if "_alone.py" in test]
        drawn = [test for test in ordered if "test_random" in test]
        others = [test for test in ordered if test not in {*mixed, *drawn}]
        while others or drawn:
            mixed += [*others[:2], *drawn[:1]]
            others, drawn = others[2:], drawn[1:]
        return mixed[:MOST]


def place() -> Path:
    """Return where the map of the package as it stands is kept."""
    names = ["git", "-C", str(ROOT), "rev-parse", "HEAD:lagrange_casadi"]
    tree = subprocess.run(names, capture_output=True, text=True, check=True).stdout.strip()
    return MAPS / f"{tree}.coverage"


class Copy:
    """A copy of the package, in which tests run."""

    def __init__(self, folder: Path) -> None:
        self.root, self.package = folder, folder / PACKAGE.name
        shutil.copytree(PACKAGE, self.package)
        for path in ROOT.iterdir():
            if path != PACKAGE and path.name != ".git":
                (folder / path.name).symlink_to(path)

    def run(self, tests: list[str], seconds: float) -> tuple[int | None, list[str], float]:
        """Return pytest's status, None if the seconds are over; failed tests; seconds taken."""
        options = ["-x", f"-n{PROCESSES}", "--maxschedchunk=1", "-rfE", "--tb=no"]
        options += ["-o", f"cache_dir={self.root / '.cache'}"]
        given = {"cwd": self.root, "env": os.environ | {"PYTHONPATH": str(self.root)}}
        with tempfile.TemporaryFile("w+") as out:
            command = [sys.executable, "-m", "pytest", *options, *tests]
            process = psutil.Popen(
                command, stdout=out, stderr=subprocess.STDOUT, start_new_session=True, **given
            )
            spent: dict[int, float] = {}
            while process.poll() is None and sum(spent.values()) < seconds:
                time.sleep(0.2)
                _note_spent(process, spent)
            status = process.poll()
            if status is None:
                os.killpg(process.pid, 9)
                process.wait()
            out.seek(0)
            failed = re.findall(r"^(?:FAILED|ERROR) (.*?)(?: - .*)?$", out.read(), re.MULTILINE)
        return status, failed, sum(spent.values())

    def judge(self, tests: list[str], seconds: float) -> tuple[str, str]:
        """Return a verdict on the mutation that is applied, and the test that notices it.

        Raises :class:`RuntimeError` where pytest runs no test.
        """
        if not tests:
            return "unreached", ""
        status, failed, _ = self.run(tests, PROCESSES * seconds)
        if status is None:
            return "unnoticed", "its time is over"
        if status == 0:
            return "unnoticed", f"{len(tests)} tests pass"
        if status in (pytest.ExitCode.USAGE_ERROR, pytest.ExitCode.NO_TESTS_COLLECTED):
            raise RuntimeError(f"pytest ran no test of {' '.join(tests)}")
        return "noticed", failed[0] if failed else f"pytest ends with status {status}"


def _note_spent(process: psutil.Popen, spent: dict[int, float]) -> None:
    """Keep the seconds of the processor that a process and each of its children took."""
    with suppress(psutil.NoSuchProcess):
        for one in (process, *process.children(recursive=True)):
            with suppress(psutil.NoSuchProcess):
                spent[one.pid] = max(spent.get(one.pid, 0.0), sum(one.cpu_times()[:2]))


def equivalent() -> dict[str, str]:
    """Return the reasons of mutations that change no number, by their texts."""
    lines = EQUIVALENT.read_text().splitlines()
    return {line: reason.strip() for line, reason in pairwise(lines) if reason.startswith("    ")}


def draw(seed: int, count: int, seconds: float, reached: Map) -> None:
    """Judge mutations drawn by a seed, and print the figure and what is not noticed."""
    drawn = random.Random(seed).sample(sorted(mutations(), key=str), count)
    known, verdicts, by = equivalent(), {}, {}
    with tempfile.TemporaryDirectory() as folder:
        copy = Copy(Path(folder))
        for number, mutation in enumerate(drawn, 1):
            if str(mutation) in known:
                verdict, why = "equivalent", known[str(mutation)]
            else:
                mutation.apply(copy.package)
                verdict, why = copy.judge(reached.tests(mutation), seconds)
                mutation.undo(copy.package)
            verdicts[mutation] = verdict
            by[mutation] = why
            print(f"{number}: {verdict}: {mutation} (line {mutation.line}; {why})", flush=True)
        noticing = sorted({by[m] for m, verdict in verdicts.items() if verdict == "noticed"})
        tests = [test for test in noticing if "::" in test]
        for test in tests:  # one that fails without any mutation notices nothing
            if copy.run([test], 10 * seconds)[0] != 0:
                print(f"fails without any mutation: {test}")
                verdicts |= {m: "unnoticed" for m in drawn if by[m] == test}
    figures = Counter(verdicts.values())
    judged = count - figures["equivalent"]
    print(f"seed {seed}: {figures['noticed']} of {judged} are noticed; {dict(figures)}")


def pytest_runtest_setup() -> None:
    """Forget what functions of the package keep, so that the map has all that a test reaches."""
    for module in [sys.modules[name] for name in sys.modules if name.startswith(PACKAGE.name)]:
        members = [*vars(module).values()]
        inner = [part for one in members if isinstance(one, type) for part in vars(one).values()]
        for part in members + inner:
            if isinstance(part, functools._lru_cache_wrapper):
                part.cache_clear()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(dest="task", required=True)
    commands.add_parser("map", help="further arguments are pytest's")
    drawing = commands.add_parser("draw")
    drawing.add_argument("--seed", type=int, required=True)
    drawing.add_argument("--count", type=int, default=120)
    drawing.add_argument("--seconds", type=float, default=SECONDS)
    asked, more = parser.parse_known_args()
    MAPS.mkdir(exist_ok=True)
    if asked.task == "draw":
        draw(asked.seed, asked.count, asked.seconds, Map(place()))
        return
    options = [f"--cov={PACKAGE.name}", "--cov-branch", "--cov-context=test", "--cov-report="]
    options += ["--cov-append", f"--junitxml={place().with_suffix('.xml')}"]
    options += ["-p", Path(__file__).stem]
    environment = os.environ | {"COVERAGE_FILE": str(place()), "PYTHONPATH": str(TESTS)}
    command = [sys.executable, "-m", "pytest", *options, *more]
    sys.exit(subprocess.run(command, cwd=ROOT, env=environment).returncode)


if __name__ == "__main__":
    main()
