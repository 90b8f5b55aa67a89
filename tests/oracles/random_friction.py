"""Random mechanisms of which up to three joints rub."""

from dataclasses import dataclass

import numpy as np
import rubbing
from random_mechanisms import draw
from random_verdict import is_regular

# fmt: off
RUB = [
    0, 4, 7, 8, 11, 15, 16, 18, 19, 22, 26, 30, 31, 36, 38, 39, 41, 43, 46, 49, 54, 62, 65, 66, 67,
    68, 71, 76, 80, 86, 90, 91, 92, 98, 101, 103, 105, 108, 109, 113, 115, 117,
]
# fmt: on
"""Those of which something rubs."""
_RUBS, _INSTANTS = 3, 3
_STEADY = 0.05


@dataclass(frozen=True)
class Rubbed:
    """A random mechanism with friction: its source, where it is looked at, and the draft that the
    oracle is made of.
    """

    source: str
    t: tuple[float, ...]
    drawn: object

    def scene(self):
        space: dict = {}
        exec(compile(self.source, "random mechanism that rubs", "exec"), space)
        return space["scene"]


def rubbed(seed):
    """Friction in up to three joints of a regular mechanism that moves, and whose reactions are all
    told; None for others.
    """
    drawn, rng = draw(seed), np.random.default_rng((seed, 77))
    smoothed, dry = (np.random.default_rng((seed, own)) for own in (82, 83))
    d = drawn.draft
    if (
        not is_regular(drawn)
        or drawn.grid[2] < 2
        or drawn.path.steadiness < _STEADY
        or "wanted" in drawn.keywords
    ):
        return None
    times = np.linspace(*drawn.grid[:2], _INSTANTS + 2)[1:-1].tolist()
    results = [d.oracle(t).solve(d.drives(t), drawn.path.near(t)) for t in times]
    if any(result.open or result.vague for result in results):
        return None
    size, lines = d.oracle(d.start).size, []
    joints = [
        j
        for name, j in d.joints.items()
        if name in d.movable() and (j.slides or all(_oriented(d, p) for p in _ends(j)))
    ]
    for joint in (joints[k] for k in rng.permutation(len(joints))[:_RUBS]):
        rates = [
            abs(rubbing.Rub(joint).rate(d.oracle(t).places(r)))
            for t, r in zip(times, results, strict=True)
        ]
        if min(rates) < 1e-3 * max(rates) or min(rates) < 1e-6:
            continue
        numbers = {"mu": rng.uniform(0.0, 0.15)}
        if not joint.slides:
            numbers["radius"] = size * rng.uniform(0.002, 0.03)
        elif joint.kind == "prismatic" and all(_oriented(d, point) for point in _ends(joint)):
            numbers["length"] = size * rng.uniform(0.3, 0.9)
        if rng.random() < 0.3:
            numbers |= {"static": rng.uniform(0.05, 0.2), "stribeck": rng.uniform(0.05, 1.0)}
        if rng.random() < 0.3:
            numbers["viscous"] = rng.uniform(0.0, 2.0)
        if smoothed.random() < 0.15:
            numbers["smooth"] = smoothed.uniform(0.2, 2.0) * max(rates)
        if dry.random() < 0.2:
            kept = {
                word: number for word, number in numbers.items() if word in ("viscous", "smooth")
            }
            numbers = kept | {"coulomb": dry.uniform(0.0, 10.0)}
        told = ", ".join(f"{word}={float(number)!r}" for word, number in numbers.items())
        lines.append(f'm.friction("rub_{joint.name}", m.joints["{joint.name}"], {told})')
    if not lines:
        return None
    before, scene = drawn.source.split("scene = Scene(", 1)
    return Rubbed(
        "\n".join([before.rstrip(), *lines, f"scene = Scene({scene}"]), tuple(times), drawn
    )


def _ends(joint):
    return joint.parent[0], joint.child[0]


def _oriented(d, body):
    return body == "ground" or d.bodies[body].oriented
