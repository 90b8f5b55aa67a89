"""The least peak torque of the slider-crank under a limit of its rod's bending, by this package and
by others.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from lagrange_casadi import evaluate, load_case, optimise, prepare, refine

from .peers.opti_slider_crank import solved
from .peers.paper_case import SliderCrank

BOUNDS = {"l": (0.12, 0.8), "r": (0.07, 0.1)}
START = {"l": 0.5, "r": 0.09}
LIMIT = 1.2
"""N m."""

_EFFORT, _BENDING = "effort:O", "section:rod:bending"
_WANTED = ("effort", "section:rod")

Way = Callable[[], tuple[float, Mapping[str, float]]]


def report(rounds: int) -> str:
    """Milliseconds of each way from one start, turn by turn, and how far its peak torque is from
    this package's.
    """
    scene = load_case("slider_crank").scene
    asked: dict[str, Any] = {
        "minimise": f"peak:{_EFFORT}",
        "over": BOUNDS,
        "subject_to": [f"peak:{_BENDING} <= {LIMIT}"],
    }
    f = prepare(scene, wanted=_WANTED)
    effort, bending = (f.quantities.index(name) for name in (_EFFORT, _BENDING))

    def ours() -> tuple[float, Mapping[str, float]]:
        found = optimise(scene, **asked, starts=[START])
        assert found.converged
        return found.objective, found.values

    def ours_of_a_thousand() -> tuple[float, Mapping[str, float]]:
        found = optimise(scene, **asked, starts=1, screen=1000)
        return found.objective, found.values

    def by_hand() -> tuple[float, Mapping[str, float]]:
        t = np.linspace(0.0, 0.08, 801)
        values, level = solved(SliderCrank(), t, np.linspace(0, 1, 11), LIMIT, BOUNDS, START)
        return level, values

    def differences(peaks: Callable[[dict[str, float]], tuple[float, float]]) -> Way:
        def way() -> tuple[float, Mapping[str, float]]:
            from scipy.optimize import minimize

            names, low = list(BOUNDS), np.array([b[0] for b in BOUNDS.values()])
            wide = np.array([b[1] for b in BOUNDS.values()]) - low

            def design(x: Any) -> dict[str, float]:
                return dict(zip(names, (low + np.clip(x, 0.0, 1.0) * wide).tolist(), strict=True))

            found = minimize(
                lambda x: peaks(design(x))[0],
                (np.array(list(START.values())) - low) / wide,
                method="SLSQP",
                bounds=[(0.0, 1.0)] * len(names),
                constraints={"type": "ineq", "fun": lambda x: LIMIT - peaks(design(x))[1]},
            )
            return float(found.fun), design(found.x)

        return way

    def prepared(values: dict[str, float]) -> tuple[float, float]:
        found = f.peaks(values).value
        return abs(float(found[effort])), abs(float(found[bending]))

    def evaluated(values: dict[str, float]) -> tuple[float, float]:
        solution = evaluate(scene, parameters=values, wanted=_WANTED, certificate=False)
        found = {peak.name: peak.value for peak in refine(scene, solution, (_EFFORT, _BENDING))}
        return abs(found[_EFFORT]), abs(found[_BENDING])

    ways: dict[str, Way] = {
        "optimise": ours,
        "of 1000 starts": ours_of_a_thousand,
        "by hand in Opti": by_hand,
        "SLSQP over prepare": differences(prepared),
        "SLSQP over evaluate": differences(evaluated),
    }
    times: dict[str, float] = dict.fromkeys(ways, np.inf)
    found: dict[str, float] = {}
    why: dict[str, str] = {}
    for _ in range(rounds):
        for name, way in ways.items():
            start = time.perf_counter()
            try:
                found[name], _ = way()
            except ImportError as missing:
                why[name] = f"not installed ({missing.name}): pip install '.[bench]'"
                continue
            times[name] = min(times[name], time.perf_counter() - start)
    least = found["optimise"]
    said = [
        f"{name} {1e3 * times[name]:.0f} ms ({found[name] / least - 1:+.1e})"
        for name in ways
        if name in found
    ]
    return "; ".join([*said, *(f"{name} {reason}" for name, reason in why.items())])
