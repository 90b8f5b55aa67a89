"""What the steady cycle of the punch press costs beside an evaluation of the press, whose motion is
given.
"""

from __future__ import annotations

import time

from lagrange_casadi import evaluate, forward, free, load_case

MOTOR = forward.induction_motor(8.0, 0.2, 157.08).geared(25.0)


def report(rounds: int) -> str:
    """Of so many rounds, turn by turn, the least times of both, and what remains of energy."""
    scene = load_case("cases/punch_press").scene
    wanted = ["effort", "motion", "reaction"]
    times: list[tuple[float, float]] = []
    energy = 0.0
    for _ in range(rounds + 1):  # the first compiles
        start = time.perf_counter()
        evaluate(scene, wanted=wanted)
        given = time.perf_counter()
        found = free(scene, drive=MOTOR, inertia=60.0, steady=True, wanted=wanted)
        times.append((given - start, time.perf_counter() - given))
        energy = float(found.energy.max())
    evaluated, steady = (min(column) for column in zip(*times[1:], strict=True))
    return (
        f"steady cycle of the punch press: {1e3 * steady:.0f} ms, {steady / evaluated:.1f} times an"
        f" evaluation of as many instants; energy to {energy:.0e}"
    )
