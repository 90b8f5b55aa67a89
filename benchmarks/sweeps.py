"""Sweeps beside a plain loop of the engine that keeps nothing: the same designs in one process,
turn by turn.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from lagrange_casadi import load_case, sweep
from lagrange_casadi.base.space import cores
from lagrange_casadi.studies.designs.engine import DesignEngine

WANTED = (
    "effort",
    "reaction:O",
    "reaction:A",
    "reaction:B",
    "reaction:guide",
    "section:crank",
    "section:rod",
)
_BLOCK = 8192


def report(count: int, instants: int, rounds: int) -> str:
    """Design-instants a second of the loop, on one core and on all; what a sweep takes more, of
    time and processors; its file.
    """
    scene = load_case(Path(__file__).parent.parent / "cases" / "slider_crank").scene
    t = (0.0, 0.08, instants)
    side = round(count**0.5)
    axes = {"l": (0.25, 0.5, side), "r": (0.05, 0.1, side)}
    engine = DesignEngine.of(scene, WANTED, t)
    names = list(engine.parameters)
    p = np.tile(list(scene.mechanism.values().values()), (side * side, 1))
    lengths, radii = np.meshgrid(*(np.linspace(*axis) for axis in axes.values()), indexing="ij")
    p[:, names.index("l")], p[:, names.index("r")] = lengths.ravel(), radii.ravel()
    work, said = (
        len(p) * instants,
        [f"{len(engine.quantities)} peaks of {len(p)} designs x {instants} instants"],
    )
    engine.evaluate(p[:64])
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "sweep.h5"
        for threads in sorted({1, cores()}):

            def loop(threads: int = threads) -> None:
                for start in range(0, len(p), _BLOCK * threads):
                    engine.evaluate(p[start : start + _BLOCK * threads], threads=threads)

            def swept(threads: int = threads) -> None:
                sweep(scene, axes, out=out, t=t, wanted=WANTED, workers=threads, force=True)

            plain, whole = _turns((loop, swept), rounds)
            more = ", ".join(
                f"{100 * (b / a - 1):+.0f} % {what}"
                for what, a, b in zip(("time", "cpu"), plain, whole, strict=True)
            )
            said.append(f"{threads} threads {work / plain[0]:.3g}/s, a sweep {more}")
        said.append(f"file {out.stat().st_size / 1e6:.0f} MB")
    return "; ".join(said)


def _turns(calls: tuple[Callable[[], None], ...], rounds: int) -> list[tuple[float, float]]:
    """The least time, and the least time of all processors together, of each of some calls that
    take turns.
    """
    found = [(np.inf, np.inf)] * len(calls)
    for _ in range(rounds):
        for k, call in enumerate(calls):
            start, busy = time.perf_counter(), time.process_time()
            call()
            found[k] = (
                min(found[k][0], time.perf_counter() - start),
                min(found[k][1], time.process_time() - busy),
            )
    return found
