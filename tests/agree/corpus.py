"""The frozen corpus: all that cases and random mechanisms have at one commit, beside which later
commits are judged.

``python tests corpus make`` writes a file for each mechanism: its declaration as text, and
outputs, peaks, statuses and stated errors. ``check`` evaluates the text of one file in five,
``check --whole`` of every file. It prints what differs by more than the error that the commit of
the corpus stated. Draws must be those of that commit.
"""

from __future__ import annotations

import argparse
import contextlib
import fnmatch
import os
import pickle
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

import lagrange_casadi as lc

HERE = Path(__file__).parent
ROOT = HERE.parents[1]

FROZEN = HERE / "frozen"
INSTANTS, RATIOS = 24, (0.0, 1.0, 5)
SUBSET = 5
"""One file in so many is checked unless all are asked for."""

TIMES, ROUNDING, SEARCHED = 4.0, 1e-13, 1e-12
"""A number may be off by so many stated errors, and by such a part of the largest number of its
unit: rounding, or the error of a search for a peak.
"""

FORCES = ("effort", "reaction", "section", "multiplier", "friction", "output")
BUILT = "-O0"  # in a third of the time; no bit depends on it
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
    drawn = [(name, seed) for name in spatial_mechanisms.FAMILIES for seed in range(FAMILY)]
    for family, seed in [*drawn, *(("anyhow", seed) for seed in range(ANYHOW))]:
        yield (
            f"{family}_{seed}",
            f"from every_way import spatial\nscene = spatial({family!r}, {seed})\n",
        )
    rubs = [k for k, case in enumerate(spatial_friction.CASES) if spatial_friction.rubbing(case)[2]]
    for k in rubs[:RUBBING_IN_SPACE]:
        lines = [
            "from spatial_bridge import declared",
            "from spatial_friction import CASES, rubbing",
            f"drawn, t, rubs = rubbing(CASES[{k}])",
            "scene = declared(drawn, t, rubs=rubs)",
        ]
        yield f"rubbing_in_space_{k}", "\n".join(lines)


@dataclass(frozen=True)
class Record:
    """Results of one way to evaluate: a status, arrays by name, and the gap allowed to each."""

    status: str
    values: dict[str, np.ndarray] = field(default_factory=dict)
    within: dict[str, float] = field(default_factory=dict)


def results(text: str) -> dict[str, Record]:
    """Return what a declaration has: outputs at some instants, decimal orders of stated errors, and
    the largest forces over all times. An exception is the status of what it ends.
    """
    space: dict[str, Any] = {"keywords": {}}
    found: dict[str, Record] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            exec(compile(text, "declaration", "exec"), space)
            solution = lc.evaluate(
                space["scene"], **{"xi": RATIOS, "flags": BUILT, **space["keywords"]}
            )
        except Exception as error:  # also one that is not ours: none may come anew
            return {"evaluate": Record(f"{type(error).__name__}: {error}")}
        some = np.unique(np.linspace(0, solution.t.size - 1, INSTANTS).round().astype(int))
        values = {name: solution.array(name)[some] for name in solution.names()}
        verdict = "certified" if solution.certified else f"fails {sorted(solution.failed)}"
        found["evaluate"] = Record(verdict, values, _within(solution))
        found["errors"] = _errors(solution)
        try:
            found["peaks"] = _peaks(space["scene"], solution)
        except Exception as error:
            found["peaks"] = Record(f"{type(error).__name__}: {error}")
    return found


def _errors(solution: lc.Solution) -> Record:
    """Decimal orders of stated errors: an estimate is right within a factor of ten."""
    sizes, values = _sizes(solution), {}
    for name in solution.errors.keys() & {*solution.names()}:
        least = 1e-16 * sizes[solution.unit(name)] + 1e-300
        values[name] = np.log10(max(solution.errors[name], least))
    return Record("stated", values, dict.fromkeys(values, 1.0))


def _peaks(scene: lc.Scene, solution: lc.Solution) -> Record:
    """Sizes of the largest forces; their instants would be of no digits."""
    names = [n for n in solution.names() if n.startswith(FORCES) and solution.determined(n)]
    peaks = {peak.name: abs(peak.value) for peak in lc.refine(scene, solution, names)}
    return Record("refined", peaks, _within(solution, SEARCHED))


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


def make(name: str, text: str, folder: Path, commit: str) -> str:
    """Write the file of a mechanism, and return a line on it."""
    made = results(text)
    told = {way: vars(one) for way, one in made.items()}
    (folder / f"{name}.pickle").write_bytes(pickle.dumps((commit, text, told)))
    numbers = sum(np.size(values) for one in made.values() for values in one.values.values())
    statuses = {one.status for one in made.values() if ":" in one.status}
    return f"{name}: {numbers} numbers {'; '.join(sorted(statuses))[:200]}"


def read(path: Path) -> tuple[str, dict[str, Record]]:
    """Return the text of a file, and what its mechanism had."""
    _, text, told = pickle.loads(path.read_bytes())
    return text, {way: Record(**one) for way, one in told.items()}


def check(path: Path) -> list[tuple[str, str]]:
    """Return what is not as it was for the mechanism of a file, by ENTRY/WAY/NAME."""
    text, was = read(path)
    return [(f"{path.stem}/{where}", words) for where, words in differences(was, results(text))]


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
                pool.submit(make, name, text, asked.folder, commit)
                for name, text in declarations()
                if fnmatch.fnmatchcase(name, asked.only)
            ]
            for one in as_completed(made):
                print(one.result(), flush=True)
            return 0
        paths = sorted(asked.folder.glob(f"{asked.only}.pickle"))
        if not paths:
            sys.exit(f"{asked.folder} has no such files; make them at the commit to compare with")
        paths = paths if asked.whole else paths[::SUBSET]
        found = [difference for one in pool.map(check, paths) for difference in one]
    for where, words in found:
        print(f"{where}: {words}")
    print(f"{len(paths)} mechanisms, {len(found)} differences")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
