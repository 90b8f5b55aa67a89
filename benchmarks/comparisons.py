"""The same work by several methods, side by side in one run, with the error of each beside its
time.
"""

from __future__ import annotations

import importlib
import io
import math
import statistics
import time
from collections.abc import Iterator
from contextlib import redirect_stdout
from typing import Any

import numpy as np
import psutil

from . import engine
from .definitions import METHODS, Comparison
from .peers import arm_reference, reference
from .peers.paper_case import Array, SliderCrank, Work

TOLERANCE = 1e-9
"""Of the peak. A method that misses by more has done other work, and its time is not reported."""

_SAMPLE = 7
_REST = 1e-3
_ROUND, _ROUNDS, _PATIENCE = 2e-3, 9, 20.0
_SHARED_ROUND, _SHARED_ROUNDS = 2e-4, 300
"""On a machine that others use, the least of many short samples is what nobody disturbed."""

CASE = SliderCrank()
DURATION = 0.08


def measure(comparison: Comparison, shared: bool = False) -> Iterator[dict[str, Any]]:
    """One row a method: time a unit [ns], its ratio to the base's, error, or why there is none.

    The time is the median, and the ratio that of the ratios in each round; or, where the machine is
    ``shared``, the time is the least, and the ratio that of these.
    """
    works: dict[str, Work] = {}
    rows: dict[str, dict[str, Any]] = {}
    for name in comparison.methods:
        rows[name] = {"name": comparison.name, "method": name, "values": comparison.values}
        try:
            with redirect_stdout(io.StringIO()):  # some say hello when they are imported
                works[name] = _work(comparison, name)
            error = _error(comparison, works[name]())
        except ImportError as missing:
            rows[name]["why"] = f"not installed ({missing.name or missing}): pip install '.[bench]'"
            continue
        except (_TooLargeError, RuntimeError) as refused:
            rows[name]["why"] = str(refused)
            works.pop(name, None)
            continue
        rows[name]["error"] = error
        if not error <= TOLERANCE:
            rows[name]["why"] = f"wrong: {error:.1e} of the peak"
            del works[name]
    times = _times(works, shared)
    base = comparison.base if comparison.base in times else next(iter(times), "")
    for name, samples in times.items():
        typical = min(samples) if shared else statistics.median(samples)
        rows[name]["ns"] = typical / comparison.units * 1e9
        rows[name]["ratio"] = (
            min(samples) / min(times[base])
            if shared
            else statistics.median(a / b for a, b in zip(samples, times[base], strict=True))
        )
        rows[name]["base"] = base
    yield from rows.values()


def row(found: dict[str, Any]) -> str:
    """A line of the table."""
    what = METHODS[found["method"]].what
    if "ns" not in found:
        return f"  {found['method']:<18}{'':>12}{'':>10}{'':>10}  {found['why']}"
    return (
        f"  {found['method']:<18}{found['ns']:>12.4g}{found['ratio']:>10.3g}{found['error']:>10.1e}"
        f"  {what}"
    )


def header(comparison: Comparison) -> str:
    """What the table of a comparison is headed by."""
    return (
        f"\n{comparison.name}: {comparison.what}\n "
        f" {'method':<18}{comparison.unit:>12}{'ratio':>10}{'error':>10}"
    )


class _TooLargeError(Exception):
    pass


def _work(comparison: Comparison, name: str) -> Work:
    method = METHODS[name]
    if comparison.values > method.largest:
        raise _TooLargeError("too slow for so many values")
    if 24.0 * comparison.values > 0.5 * psutil.virtual_memory().available:
        raise _TooLargeError("too little memory")
    function = getattr(importlib.import_module(f"benchmarks.{method.module}"), comparison.work)
    t = np.linspace(0.0, DURATION, comparison.t)
    arguments: tuple[Any, ...] = {
        "instants": (CASE, t),
        "designs": (CASE, t, _lengths(comparison)),
        "sections": (CASE, t, _ratios(comparison)),
        "fill": (CASE, t, _ratios(comparison)),
        "efforts": (comparison.links, t),
        "arm_efforts": (t,),
        "arm_sections": (t, _ratios(comparison)),
        "arm_resultants": (t, _ratios(comparison)),
    }[comparison.work]
    work: Work = function(*arguments, **method.options)
    return work


def _ratios(comparison: Comparison) -> Array:
    """Within the rod: where a link is split at its very end, one piece has no mass."""
    return (np.arange(comparison.xi) + 0.5) / comparison.xi


def _lengths(comparison: Comparison) -> Array:
    return np.linspace(0.15, 0.4, comparison.designs)


def _error(comparison: Comparison, found: Array) -> float:
    """The largest error over a sample, of each quantity's peak."""
    t = np.linspace(0.0, DURATION, comparison.t)
    instants = np.unique(np.linspace(0, t.size - 1, _SAMPLE).astype(int))
    if comparison.work in ("sections", "fill"):
        xi = _ratios(comparison)
        places = np.unique(np.linspace(0, xi.size - 1, _SAMPLE).astype(int))
        expected = reference.sections(CASE, t[instants], xi[places])
        return _worst(found[:, instants[:, None], places], expected)
    if comparison.work == "arm_efforts":
        return _worst(found[:, instants], arm_reference.efforts(t[instants]))
    if comparison.work.startswith("arm_"):
        xi = _ratios(comparison)
        places = np.unique(np.linspace(0, xi.size - 1, _SAMPLE).astype(int))
        expected = getattr(arm_reference, comparison.work.removeprefix("arm_"))(
            t[instants], xi[places]
        )
        return _worst(found[:, instants[:, None], places], expected)
    if comparison.work == "efforts":
        return _worst(found[:, instants], reference.chain(comparison.links, t[instants]))
    case = SliderCrank(l=float(_lengths(comparison)[-1])) if comparison.work == "designs" else CASE
    names, known = engine.columns(), reference.instants(case, t[instants])
    worst = 0.0
    for name, expected in known.items():
        gap = found[names.index(name), instants] - expected
        if name == "motion:A":
            gap = np.vectorize(math.remainder)(gap, math.tau)
        worst = max(worst, float(np.max(np.abs(gap)) / (np.max(np.abs(expected)) or 1.0)))
    return worst


def _worst(found: Array, expected: Array) -> float:
    rest = tuple(range(1, expected.ndim))
    return float(
        np.max(np.max(np.abs(found - expected), axis=rest) / np.max(np.abs(expected), axis=rest))
    )


def _times(works: dict[str, Work], shared: bool) -> dict[str, list[float]]:
    """Seconds a call, one sample a round; in a round every method has its turn."""
    span, rounds = (_SHARED_ROUND, _SHARED_ROUNDS) if shared else (_ROUND, _ROUNDS)
    repeats = {
        name: max(1, math.ceil(span / max(_sample(work, 1), 1e-9))) for name, work in works.items()
    }
    times: dict[str, list[float]] = {name: [] for name in works}
    start = time.perf_counter()
    for number in range(rounds):
        if number >= 3 and time.perf_counter() - start > _PATIENCE:
            break
        for name, work in works.items():
            # No method pays for threads, or for caches, as the one before it left them.
            time.sleep(_REST)
            work()
            times[name].append(_sample(work, repeats[name]))
    return times


def _sample(work: Work, repeat: int) -> float:
    start = time.perf_counter()
    for _ in range(repeat):
        work()
    return (time.perf_counter() - start) / repeat
