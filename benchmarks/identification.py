"""What it costs to identify 73 parameters of an arm of seven joints from 6000 instants, beside an
evaluation of its efforts at as many instants.
"""

from __future__ import annotations

import time

from lagrange_casadi import Measurements, Scene, SpatialMechanism, evaluate, identify
from lagrange_casadi.motion import harmonic

COUNT = 6000
FRICTIONS = 3


def arm() -> Scene:
    """Declare seven links with ten parameters each, and viscous friction in the first joints."""
    m = SpatialMechanism("arm7")
    before, motion = m.ground.at(0.0, 0.0, 0.0), {}
    for k in range(7):
        mass = m.parameter(f"m{k}", 3.0 - 0.3 * k, "kg")
        h = [m.parameter(f"h{x}{k}", 0.1, "kg m") for x in "xyz"]
        xx, xy, xz, yy, yz, zz = (
            m.parameter(f"J{n}{k}", 0.2 * (n[0] == n[1]), "kg m^2")
            for n in ("xx", "xy", "xz", "yy", "yz", "zz")
        )
        about = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]  # the joint, so that forces are linear
        square = sum(x * x for x in h)
        inertia = tuple(
            tuple(about[i][j] - ((i == j) * square - h[i] * h[j]) / mass for j in range(3))
            for i in range(3)
        )
        centre = tuple(x / mass for x in h)
        link = m.link(f"l{k}", length=0.3, mass=mass, centre=centre, inertia=inertia)
        axis = ((0, 0, 1), (0, 1, 0), (1, 0, 0))[k % 3]
        joint = m.revolute(f"q{k}", before, link, axis=axis)
        if k < FRICTIONS:
            m.torsion_spring(
                f"d{k}", joint, stiffness=0.0, damping=m.parameter(f"c{k}", 0.2, "N m s")
            )
        motion[f"q{k}"] = harmonic(0.1 * k, 0.5, 0.3 + 0.07 * k, k)
        before = link.tip
    return Scene(m, motion, wanted=["effort", "motion"], t=(0, 10, COUNT))


def report(rounds: int) -> str:
    """Of so many rounds, turn by turn, the least times of both."""
    scene = arm()
    times: list[tuple[float, float]] = []
    for _ in range(rounds + 1):  # the first compiles
        start = time.perf_counter()
        solution = evaluate(scene, certificate=False)
        given = time.perf_counter() - start
        columns = {
            f"{drive}{end}": solution.array(f"motion:{drive}{end}")
            for drive in scene.laws
            for end in ("", "_rate", "_acceleration")
        }
        columns |= {f"effort:{drive}": solution.array(f"effort:{drive}") for drive in scene.laws}
        start = time.perf_counter()
        found = identify(scene, Measurements(solution.t, columns))
        times.append((given, time.perf_counter() - start))
    evaluated, identified = (min(column) for column in zip(*times[1:], strict=True))
    return (
        f"identification, {COUNT} instants x 7 efforts x {len(found.values)} parameters,"
        f" {len(found.base)} combinations: {identified:.2f} s,"
        f" {identified / evaluated:.0f} times an evaluation"
    )
