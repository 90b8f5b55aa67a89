"""Random mechanisms in space of which up to four coordinates rub."""

import numpy as np
from spatial_bridge import plain
from spatial_mechanisms import FAMILIES, tree
from spatial_rubbing import Rub

RUBBING = ("revolute", "prismatic", "cylindrical", "screw", "spherical")
CASES = [("tree", seed) for seed in range(40)] + [("loop", seed) for seed in range(16)]
CASES += [(name, seed) for name in ("rsur", "rsup", "rssr", "rssp") for seed in range(3)]
_RUBS = 4


def rubbing(case):
    """A random mechanism, an instant, and friction in up to four of its coordinates that move; none
    in others.
    """
    name, seed = case
    drawn = plain(tree(seed, kinds=RUBBING) if name == "tree" else FAMILIES[name](seed))
    rng, t = np.random.default_rng((seed, 78)), 0.4 * drawn.span
    found, rubs = drawn.solve(t), []
    open_ = {joint for joint, _ in found.open}
    for joint in drawn.mechanism.joints:
        own = [
            Rub(joint, k) for k in (range(1) if joint.kind == "spherical" else range(joint.count))
        ]
        if (
            joint.kind not in RUBBING
            or joint.name in open_
            or len(rubs) >= _RUBS
            or (drawn.idle and joint.kind == "spherical")
        ):
            continue
        if min(abs(rub.rate(found)) for rub in own) < 1e-3:
            continue
        numbers = {"mu": rng.uniform(0.0, 0.15), "radius": found.size * rng.uniform(0.01, 0.05)}
        if joint.kind != "screw" and rng.random() < 0.4:
            numbers |= {"static": rng.uniform(0.05, 0.2), "stribeck": rng.uniform(0.05, 1.0)}
        if joint.kind not in ("screw", "spherical"):
            numbers["length"] = found.size * rng.uniform(0.4, 0.9)
        if rng.random() < 0.3:
            numbers["viscous"] = rng.uniform(0.0, 2.0)
        rubs += [Rub(joint, rub.index, numbers) for rub in own]
    return drawn, t, rubs
