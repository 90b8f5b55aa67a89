"""The frozen corpus: all that cases and random mechanisms have at one commit, beside which later
commits are judged.

``python tests corpus make`` writes a file for each mechanism: its declaration as text, and
outputs, peaks, statuses and stated errors, of every fifth mechanism by every way to evaluate.
Cases, scenes of ``every_way`` and mechanisms in space are told as calls of what declares them: of
these the declaration is the one of the commit that reads it.
``check`` evaluates the text of one file in five, ``check --whole`` of every file. It prints what
differs by more than the error that the commit of the corpus stated, and is not in ``allowed.txt``.
"""

from __future__ import annotations

import argparse
import contextlib
import fnmatch
import json
import os
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from functools import cached_property, partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import exported
import numpy as np

import lagrange_casadi as lc

HERE = Path(__file__).parent
ROOT = HERE.parents[1]

FROZEN, ALLOWED = HERE / "frozen", HERE / "allowed.txt"
INSTANTS, RATIOS = 24, (0.0, 1.0, 5)
EVERY = 5
"""One mechanism in so many is evaluated in every way."""

SUBSET = 5
"""One file in so many is checked unless all are asked for."""

TIMES, ROUNDING, SEARCHED = 4.0, 1e-13, 1e-12
"""A number may be off by so many stated errors, and by such a part of the largest number of its
unit: rounding, or the error of a search for a peak.
"""

FORCES = ("effort", "reaction", "section", "multiplier", "friction", "output")
BUILT = "-O0"  # in a third of the time; no bit depends on it
RUBBED = """from spatial_bridge import declared
from spatial_friction import rubbing
drawn, t, rubs = rubbing({!r})
scene = declared(drawn, t, rubs=rubs)
"""
PLANAR, RUBBING, FAMILY, ANYHOW, RUBBING_IN_SPACE = 150, 40, 4, 34, 24
"""Random mechanisms of each kind: 300 in all."""


def declarations() -> Iterator[tuple[str, str]]:
    """Yield a name and Python that makes ``scene`` and ``keywords`` for each mechanism."""
    import every_way
    import random_friction
    import random_mechanisms
    import spatial_friction
    import spatial_mechanisms

    for path in sorted((ROOT / "cases").glob("*/case.py")):
        name = path.parent.name
        yield name, f"from lagrange_casadi import load_case\nscene = load_case({name!r}).scene\n"
    for name in every_way.DECLARED:
        yield name, f"from every_way import DECLARED\nscene = DECLARED[{name!r}]()\n"
    for seed in range(PLANAR):
        drawn = random_mechanisms.draw(seed)
        yield f"planar_{seed}", f"{drawn.source}keywords = {drawn.keywords!r}\n"
    for seed in random_friction.RUB[:RUBBING]:
        made = random_friction.rubbed(seed)
        parameters = made.drawn.keywords.get("parameters")
        keywords = {"t": made.drawn.grid, "parameters": parameters}
        yield f"rubbing_{seed}", f"{made.source}keywords = {keywords!r}\n"
    seeds = [(name, seed) for name in spatial_mechanisms.FAMILIES for seed in range(FAMILY)]
    for name, seed in [*seeds, *(("anyhow", seed) for seed in range(ANYHOW))]:
        drawn = f"from every_way import spatial\nscene = spatial({name!r}, {seed})\n"
        yield f"{name}_{seed}", drawn
    rubbing = [case for case in spatial_friction.CASES if spatial_friction.rubbing(case)[2]]
    for k, case in enumerate(rubbing[:RUBBING_IN_SPACE]):
        yield f"rubbing_in_space_{k}", RUBBED.format(case)


@dataclass(frozen=True)
class Record:
    """Results of one way to evaluate: a status, arrays by name, and the gap allowed to each."""

    status: str
    values: dict[str, np.ndarray] = field(default_factory=dict)
    within: dict[str, float] = field(default_factory=dict)


class Mechanism:
    """A mechanism as a text declares it, and all that it has."""

    def __init__(self, text: str) -> None:
        space: dict[str, Any] = {"keywords": {}}
        exec(compile(text, "declaration", "exec"), space)
        self.scene, self.keywords = space["scene"], space["keywords"]

    def evaluate(self, **method: Any) -> lc.Solution:
        flags = "" if method.get("backend") == "vm" else BUILT
        return lc.evaluate(self.scene, **{"xi": RATIOS, "flags": flags, **self.keywords, **method})

    @cached_property
    def solution(self) -> lc.Solution:
        return self.evaluate()

    def ways(self, every: bool) -> dict[str, Callable[[], Record]]:
        """Return all ways but the first by name."""
        first = {"errors": self.errors, "peaks": self.peaks}
        methods: dict[str, dict[str, Any]] = {
            "c": {"backend": "c"},
            "vm": {"backend": "vm"},
            "single": {"precision": "single"},
            "newton": {"newton": 4},
            "table": {"table": 1e-6},
        }
        others = {name: partial(self.evaluated, **method) for name, method in methods.items()}
        more = {"prepare": self.prepared, "sweep": self.swept, "export": self.exported}
        return first | (others | more if every else {})

    def evaluated(self, **method: Any) -> Record:
        """All quantities at some instants; section forces at some ratios."""
        solution = self.evaluate(**method) if method else self.solution
        values = {name: solution.array(name)[_some(solution.t)] for name in solution.names()}
        verdict = "certified" if solution.certified else f"fails {sorted(solution.failed)}"
        return Record(verdict, values, _within(solution))

    def errors(self) -> Record:
        """Decimal orders of stated errors: an estimate is right within a factor of ten."""
        solution, sizes = self.solution, _sizes(self.solution)
        names = [name for name in solution.names() if name in solution.errors]
        least = {name: 1e-16 * sizes[solution.unit(name)] + 1e-300 for name in names}
        values = {name: np.log10(max(solution.errors[name], least[name])) for name in names}
        return Record("stated", values, dict.fromkeys(values, 1.0))

    def peaks(self) -> Record:
        """Sizes of the largest forces over all times; their instants would be of no digits."""
        solution = self.solution
        names = [n for n in solution.names() if n.startswith(FORCES) and solution.determined(n)]
        peaks = {peak.name: abs(peak.value) for peak in lc.refine(self.scene, solution, names)}
        return Record("refined", peaks, _within(solution, SEARCHED))

    def prepared(self) -> Record:
        keywords = {"flags": BUILT, **self.keywords}
        values = self.scene.mechanism.values(keywords.pop("parameters", None))
        keywords.pop("xi", None)
        series = lc.prepare(self.scene, **keywords)(**values)
        names = [name for name in series if name in self.solution.names()]
        some = _some(self.solution.t)
        return Record("ok", {n: series[n][some].copy() for n in names}, _within(self.solution))

    def swept(self) -> Record:
        """Two designs by the first parameter that is not zero."""
        values = self.scene.mechanism.values(self.keywords.get("parameters"))
        name = next((name for name, value in values.items() if value), None)
        if name is None:
            return Record("has no parameter")
        value = values.pop(name)
        keywords = {k: x for k, x in self.keywords.items() if k in ("t", "over", "wanted")}
        axis, given = {name: (value, 1.001 * value, 2)}, {"parameters": values, "flags": BUILT}
        swept = lc.sweep(self.scene, axis, **given, **keywords, workers=1)
        kinds = ("status", "peak:", "mean:", "rms:")
        columns = {k: np.asarray(swept[k]) for k in swept if k.startswith(kinds)}
        within, largest = {}, Counter[str]()
        for column in columns:
            size = float(np.nanmax(np.abs(columns[column]), initial=0.0))
            largest[swept.unit(column)] = max(largest[swept.unit(column)], size)
        stated = _within(self.solution)
        for column in columns:
            own = stated.get(column.partition(":")[2], 0.0)
            within[column] = own + SEARCHED * largest[swept.unit(column)]
        return Record("ok", columns, within)

    def exported(self) -> Record:
        """Numbers of exported C, built by itself."""
        if "parameters" in self.keywords:
            return Record("is exported with its defaults")
        wanted = {"wanted": self.keywords["wanted"]} if "wanted" in self.keywords else {}
        t, stated = self.solution.t[_some(self.solution.t)], _within(self.solution)
        with tempfile.TemporaryDirectory() as folder:
            _, told = exported.exported(self.scene, Path(folder), **wanted)
            rows = exported.by_c99(
                Path(folder), told, exported.instants(t, "double"), ("-O0", "-ffp-contract=off")
            )
        names = [row["path"].replace("/", ":") for row in told["outputs"]]
        columns = dict(zip(names, rows.T, strict=False))
        values = {name: column for name, column in columns.items() if name in stated}
        return Record("ok", values, stated)


def results(text: str, every: bool) -> dict[str, Record]:
    """Return what a declaration has in each way; an exception is the status of its way."""
    found: dict[str, Record] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            mechanism = Mechanism(text)
            found["evaluate"] = mechanism.evaluated()
        except Exception as error:  # also one that is not ours: none may come anew
            return {"evaluate": Record(f"{type(error).__name__}: {error}")}
        for way, evaluate in mechanism.ways(every).items():
            try:
                found[way] = evaluate()
            except Exception as error:
                found[way] = Record(f"{type(error).__name__}: {error}")
    return found


def _some(t: np.ndarray) -> np.ndarray:
    """Return some of the instants."""
    return np.unique(np.linspace(0, t.size - 1, INSTANTS).round().astype(int))


def _sizes(solution: lc.Solution) -> dict[str, float]:
    """Return the largest number of each unit."""
    sizes: dict[str, float] = {}
    for name in solution.names():
        unit, values = solution.unit(name), np.abs(solution.array(name))
        sizes[unit] = max(sizes.get(unit, 0.0), float(np.nanmax(values, initial=0.0)))
    return sizes


def _within(solution: lc.Solution, rounding: float = ROUNDING) -> dict[str, float]:
    """Return how far each quantity may be off: by what its solution states, and by rounding."""
    sizes = _sizes(solution)
    return {
        name: TIMES * solution.errors.get(name, 0.0) + rounding * sizes[solution.unit(name)]
        for name in solution.names()
    }


def differences(was: dict[str, Record], now: dict[str, Record]) -> Iterator[tuple[str, str]]:
    """Yield WAY/NAME and words for all that is not as it was; of numbers the largest gap."""
    for way in [*was, *(set(now) - set(was))]:
        old, new = was.get(way, Record("is new")), now.get(way, Record("is gone"))
        if old.status.partition(":")[0] != new.status.partition(":")[0]:
            yield f"{way}/status", f"was {old.status!r}, is {new.status!r}"
            continue
        for name in sorted({*old.values, *new.values}):
            if name not in new.values or name not in old.values:
                yield f"{way}/{name}", "is gone" if name in old.values else "is new"
                continue
            a, b = (np.asarray(values[name], float) for values in (old.values, new.values))
            numbers, most = np.isfinite(a), old.within.get(name, 0.0)
            if a.shape != b.shape or not np.array_equal(a[~numbers], b[~numbers], equal_nan=True):
                yield f"{way}/{name}", "has another shape, or no numbers elsewhere"
                continue
            gap = float(np.max(np.abs(b[numbers] - a[numbers]), initial=0.0))
            if not gap <= most:
                yield f"{way}/{name}", f"off by {gap:.2g}, more than {most:.2g}"


def make(name: str, text: str, folder: Path, every: bool, commit: str) -> str:
    """Write the file of a mechanism, and return a line on it."""
    made = results(text, every)
    told = {"commit": commit, "text": text, "every": every, "ways": {}}
    arrays = {}
    for way, one in made.items():
        told["ways"][way] = {"status": one.status, "within": one.within}
        arrays |= {f"{way}/{k}": np.asarray(x, float) for k, x in one.values.items()}
    flat = np.concatenate([np.zeros(0), *(x.ravel() for x in arrays.values())])
    told["shapes"] = {key: x.shape for key, x in arrays.items()}
    np.savez_compressed(folder / f"{name}.npz", told=json.dumps(told), numbers=flat)
    statuses = {one.status for one in made.values() if ":" in one.status}
    return f"{name}: {flat.size} numbers {'; '.join(sorted(statuses))[:200]}"


def read(path: Path) -> tuple[str, bool, dict[str, Record]]:
    """Return the text of a file, whether all ways are in it, and what they had."""
    with np.load(path) as file:
        told, flat = json.loads(str(file["told"])), file["numbers"]
    found = {way: Record(one["status"], {}, one["within"]) for way, one in told["ways"].items()}
    at = 0
    for key, shape in told["shapes"].items():
        way, _, name = key.partition("/")
        size = int(np.prod(shape))
        found[way].values[name] = flat[at : at + size].reshape(shape)
        at += size
    return told["text"], told["every"], found


def check(path: Path) -> list[tuple[str, str]]:
    """Return what is not as it was for the mechanism of a file, by ENTRY/WAY/NAME."""
    text, every, was = read(path)
    now = results(text, every)
    return [(f"{path.stem}/{where}", words) for where, words in differences(was, now)]


def allowances(text: str) -> dict[str, str]:
    """Return the reasons of differences that are allowed, by their patterns."""
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    found = {}
    for line in lines:
        pattern, _, reason = line.partition(" ")
        if not reason.strip():
            raise ValueError(f"allowed.txt: {pattern} has no reason; expected 'PATTERN reason'")
        found[pattern] = reason.strip()
    return found


def judged(found: list[tuple[str, str]], allowed: dict[str, str]) -> tuple[list[str], Counter[str]]:
    """Return a line for each difference that is not allowed, and how often each pattern is used."""
    used, lines = Counter[str](), []
    for where, words in found:
        patterns = [pattern for pattern in allowed if fnmatch.fnmatchcase(where, pattern)]
        used.update(patterns)
        lines += [] if patterns else [f"{where}: {words}"]
    return lines, used


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("task", choices=["make", "check"])
    parser.add_argument("--folder", type=Path, default=FROZEN)
    parser.add_argument("--whole", action="store_true", help="check all files")
    parser.add_argument("--only", default="*", help="a pattern of names")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    asked = parser.parse_args(arguments)
    asked.folder.mkdir(exist_ok=True)
    with contextlib.ExitStack() as stack:
        os.environ["XDG_CACHE_HOME"] = stack.enter_context(tempfile.TemporaryDirectory())
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        pool = stack.enter_context(ProcessPoolExecutor(asked.jobs, get_context("spawn")))
        if asked.task == "make":
            describe = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--abbrev=40"]
            commit = subprocess.run(describe, capture_output=True, text=True).stdout.strip()
            made = [
                pool.submit(make, name, text, asked.folder, k % EVERY == 0, commit)
                for k, (name, text) in enumerate(declarations())
                if fnmatch.fnmatchcase(name, asked.only)
            ]
            for one in as_completed(made):
                print(one.result(), flush=True)
            return 0
        paths = sorted(asked.folder.glob(f"{asked.only}.npz"))
        if not paths:
            sys.exit(f"{asked.folder} has no such files; make them at the commit to compare with")
        paths = paths if asked.whole else paths[::SUBSET]
        found = [difference for one in pool.map(check, paths) for difference in one]
    allowed = allowances(ALLOWED.read_text())
    lines, used = judged(found, allowed)
    unused = [pattern for pattern in allowed if pattern not in used] if asked.whole else []
    for line in [*lines, *(f"allowed.txt: {pattern} is not used" for pattern in unused)]:
        print(line)
    print(f"{len(paths)} mechanisms, {len(lines)} differences, {used.total()} allowed")
    return 1 if lines or unused else 0


if __name__ == "__main__":
    sys.exit(main())
