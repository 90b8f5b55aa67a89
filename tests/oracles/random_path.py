"""The motion of a random mechanism, followed by the oracle from its posture, step by step."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
import oracle

_TRIES = 12
_STEPS = 8
NEAR = 0.02
"""Of the least singular value of the gaps' slope: less is near a dead centre."""

_LEAST_STEP = 1e-5
"""Of the whole time: shorter steps are those that creep up to a dead centre."""

_OFF = 0.1
"""How far Newton's method may go from what the step before foretells, in parts of the step."""


@dataclass(frozen=True, eq=False)
class Path:
    """Motions at some instants, in the order of time.

    ``end`` is how far they go, ``steadiness`` the least on the way, ``passes`` after which instant
    it first goes through zero: there the mechanism may go on in two ways.
    """

    times: list[float]
    motions: list[oracle.Result]
    end: float
    steadiness: float
    passes: float

    def until(self, t: float) -> Path:
        """As much of it as there is up to an instant."""
        kept = max(int(np.searchsorted(self.times, t, side="right")), 1)
        return _path(self.times[:kept], self.motions[:kept], min(self.end, t))

    def near(self, t: float) -> dict[str, tuple[float, float, float]]:
        """The posture at an instant, foretold by the motion before it."""
        k = max(int(np.searchsorted(self.times, t, side="right")) - 1, 0)
        return ahead(self.motions[k], min(t, self.end) - self.times[k])


def ahead(motion: oracle.Result, h: float) -> dict[str, tuple[float, float, float]]:
    """The posture after a time, by Taylor's formula."""
    return {name: tuple(x.v + h * x.d + h * h * x.a / 2 for x in q) for name, q in motion.q.items()}


def follow(d, stop: float, largest: float, start: float | None = None, poses=None) -> Path:
    """The path of a draft to an instant, from its posture or from other poses at another start, or
    as far as it goes.

    ``largest`` is how far anything may move in a step, in radians and sizes of the mechanism.
    """
    t = d.start if start is None else start
    size = d.oracle(t).size
    try:
        motion = d.oracle(t).move(d.drives(t), d.poses if poses is None else poses)
    except oracle.OpenLoopError:
        return _path([], [], t)
    times, motions = [t], [motion]
    while t < stop and motion.steadiness > oracle.LEAST_STEADY:
        parts = [
            (x, scale)
            for q in motion.q.values()
            for x, scale in zip(q, (size, size, 1.0), strict=True)
        ]
        speed = max(abs(x.d) / scale for x, scale in parts)
        bend = max(abs(x.a) / scale for x, scale in parts)
        h = min(stop - t, largest / max(speed, math.sqrt(largest * bend), largest / (stop - t)))
        found = None
        for _ in range(_TRIES):
            found = _step(d, motion, t, h if h < stop - t else stop - t, size)
            if found is not None:
                break
            h /= 2
        if found is None or h < _LEAST_STEP * (stop - times[0]):
            break
        t, motion = (stop if h >= stop - t else float(t + h)), found
        times.append(t)
        motions.append(motion)
    return _path(times, motions, t)


def _path(times, motions, end):
    steadiness = min((motion.steadiness for motion in motions), default=0.0)
    passes = (
        times[k] for k, pair in enumerate(itertools.pairwise(motions)) if oracle.passed(*pair)
    )
    return Path(times, motions, end, steadiness, next(passes, math.inf))


def _step(d, motion, t, h, size):
    """The motion after a step, or None where it is not surely the one that follows."""
    guess = ahead(motion, h)
    try:
        found = d.oracle(t + h).move(d.drives(t + h), guess, _STEPS)
    except oracle.OpenLoopError:
        return None
    scales = (size, size, 1.0)
    off = max(
        abs(x.v - y) / s
        for name in guess
        for x, y, s in zip(found.q[name], guess[name], scales, strict=True)
    )
    gone = max(
        abs(x.v - y.v) / s
        for name in guess
        for x, y, s in zip(found.q[name], motion.q[name], scales, strict=True)
    )
    return found if off <= _OFF * gone + 1e-9 else None
