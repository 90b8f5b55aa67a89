"""What the peaks of designs cost beside their outputs over time: the same designs of the
slider-crank, turn by turn, on one core.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import get_args

import numpy as np

from lagrange_casadi.base.arrays import Array
from lagrange_casadi.base.vocabulary import PeakSearch
from lagrange_casadi.studies.designs.engine import DesignEngine
from lagrange_casadi.studies.designs.outcome import KEPT

from .engine import SCENE
from .sweeps import WANTED

_DESIGNS, _INSTANTS = 200, 128


def report(rounds: int) -> str:
    """Nanoseconds for an instant of a design, the least of some rounds: the status alone, outputs
    over time alone, sampled peaks, exact peaks.
    """
    works: dict[str, Callable[[], object]] = {}
    for peaks in get_args(PeakSearch):
        engine = DesignEngine.of(SCENE, WANTED, (0.0, 0.08, _INSTANTS), peaks=peaks)
        p = np.tile([*SCENE.mechanism.values().values()], (_DESIGNS, 1))
        p[:, engine.parameters.index("l")] = np.linspace(0.25, 0.5, _DESIGNS)
        if peaks == "exact":
            works["status alone"] = _series(engine, p, None)
            columns = np.empty((_DESIGNS, len(engine.program.columns), _INSTANTS))
            works["outputs over time"] = _series(engine, p, columns)
        works[f"{peaks} peaks"] = _peaks(engine, p)
    best = dict.fromkeys(works, np.inf)
    for _ in range(rounds):
        for key, work in works.items():
            start = time.perf_counter()
            work()
            best[key] = min(best[key], time.perf_counter() - start)
    each = 1e9 / (_DESIGNS * _INSTANTS)
    said = ", ".join(f"{what} {seconds * each:.1f} ns" for what, seconds in best.items())
    return (
        f"{len(engine.columns)} outputs, {len(engine.quantities)} peaks, {_DESIGNS} designs x"
        f" {_INSTANTS} instants: {said}"
    )


def _peaks(engine: DesignEngine, p: Array) -> Callable[[], object]:
    return lambda: engine.evaluate(p, threads=1)


def _series(engine: DesignEngine, p: Array, columns: Array | None) -> Callable[[], object]:
    """What evaluates the instants of designs and seeks no peaks."""
    t, _ = engine.times.of(p, asked=False)
    found = {"status": np.zeros(len(p), np.int8), "history": columns, **dict.fromkeys(KEPT)}
    nowhere = np.zeros((1, 0), bool)
    return lambda: engine.library.designs(t, nowhere, p, found)
