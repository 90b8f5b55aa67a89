"""What the gradient of all peaks by all parameters costs beside the peaks themselves, of every case
that has parameters.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from lagrange_casadi import load_case, prepare
from lagrange_casadi.base.shipped_cases import shipped_cases


def report(rounds: int) -> str:
    """Of each case how many times as long as ``f.peaks()`` a gradient takes, both turn by turn, and
    the largest of them.
    """
    found: dict[str, float] = {}
    for name, folder in shipped_cases().items():
        scene = load_case(folder).scene
        if not scene.mechanism.parameters:
            continue
        f = prepare(scene)
        f.gradient()  # derived and compiled

        def seconds(work: Callable[[], object]) -> float:
            start = time.perf_counter()
            work()
            return time.perf_counter() - start

        times = [(seconds(f.peaks), seconds(f.gradient)) for _ in range(rounds)]
        peaks, gradient = (min(column) for column in zip(*times, strict=True))
        found[name] = gradient / peaks
        print(
            f"{name}: {len(f.quantities)} peaks {1e6 * peaks:.0f} us, by {len(f.parameters)}"
            f" parameters {found[name]:.2f} times"
        )
    said = ", ".join(
        f"{name} {ratio:.1f}" for name, ratio in sorted(found.items(), key=lambda one: -one[1])
    )
    return f"gradients, of the time of all peaks: {said}"
