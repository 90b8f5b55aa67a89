"""What drives a random mechanism, once its joints have their laws: points and poses that are led in
place of joints, moves from rest to rest, and drives elsewhere than the motion that is given.

All is drawn by generators of their own, so that the rest is drawn as without.
"""

from __future__ import annotations

import numpy as np
import oracle
from random_draft import Draft, Spot
from random_formula import Measure
from random_growth import values
from random_path import Path

_STEADY = 0.1
"""Of the gaps' slope: the least singular value with what leads or pushes."""

_LAWS = {
    "cycloidal": "{0} - sin(6.283185307179586 * {0}) / 6.283185307179586",
    "polynomial_345": "10.0 * {0}**3 - 15.0 * {0}**4 + 6.0 * {0}**5",
    "polynomial_4567": "35.0 * {0}**4 - 84.0 * {0}**5 + 70.0 * {0}**6 - 20.0 * {0}**7",
}
"""Laws of a move, by the share of its time."""


def move(d: Draft, rng: np.random.Generator) -> None:
    """Make some of the laws moves from rest to rest, longer than any draw lasts."""
    for joint in [*d.laws]:
        if d.rows or rng.random() > 0.12:
            continue
        kind, time = str(rng.choice([*_LAWS])), float(f"{rng.uniform(4.0, 6.0):.4g}")
        here = d.coordinate(joint)
        rate = d.laws[joint][1].jet(None, d.start + 0.1).d
        by = float(f"{rate * time * rng.uniform(0.3, 0.8):.4g}")
        if abs(by) > 1e-3:
            share = f"((t - {d.start!r}) / {time!r})"
            d.drive(
                joint,
                f'motion.moves([motion.move(by={by!r}, time={time!r}, law="{kind}")],'
                f" start={here!r}, begin={d.start!r})",
                f"{here!r} + {by!r} * ({_LAWS[kind].format(share)})",
            )


def lead(d: Draft, rng: np.random.Generator) -> None:
    """Give a point or a pose a motion, in place of two or three joints; these drive it."""
    count = 3 if rng.random() < 0.3 else 2
    if d.rows or len(d.laws) < count or rng.random() > 0.5:
        return
    drives = [*d.laws]
    bodies = [name for name, body in d.bodies.items() if body.oriented or count == 2]
    for body in rng.permutation(bodies)[:6]:
        spot = d.base(str(body))
        if count == 2 and d.bodies[spot.body].oriented:
            spot = d.tip(spot.body)
        if _leads(d, rng, spot, count):
            d.pushed = dict.fromkeys(drives, 1.0)
            return


def _leads(d: Draft, rng: np.random.Generator, spot: Spot, count: int) -> bool:
    """Lead a point, or a pose, in place of joints; undo it where that does not place all well."""
    name, kept = (f"path_{spot.body}" if count == 2 else spot.body), dict(d.laws)
    for joint in rng.permutation([*d.laws])[:count]:
        del d.laws[str(joint)]
    d.guides[name] = []
    place = d.posture_place()(spot.point)
    for k, here in zip(("x", "y", "angle")[:count], place, strict=False):
        speed = float(f"{rng.uniform(-0.3, 0.3):.4g}")
        law = f"{float(here.v)!r} + {speed!r} * sin(t - {d.start!r})"
        gap = d.formula(f"{k} - ({law})", {k: Measure(k, spot.point)})
        d.guides[name].append((f"motion.expression(lambda t: {law})", gap))
    if values(d, d.laws)[-1] < _STEADY / 2:
        d.laws = kept
        del d.guides[name]
        return False
    if count == 2:
        d.paths[name] = spot
        d.lines.append(f'm.path("{name}", {spot.text})')
    return True


def push(d: Draft, rng: np.random.Generator, path: Path) -> None:
    """Drive it elsewhere, perhaps by more joints than are needed."""
    needed = len(d.laws) + sum(map(len, d.guides.values()))
    if d.rows or not needed or not path.motions or rng.random() > (0.6 if d.guides else 0.3):
        _check(d, path)
        return
    chosen: list[str] = []
    left = int(np.sum(_held(d, path.motions[0], chosen) < _STEADY**2))
    for joint in rng.permutation(d.movable()):
        found = int(np.sum(_held(d, path.motions[0], [*chosen, str(joint)]) < _STEADY**2))
        if found < left:
            chosen, left = [*chosen, str(joint)], found
    if left or len(chosen) != needed:
        return
    others = [str(j) for j in rng.permutation(d.movable()) if j not in chosen]
    weights = dict.fromkeys(chosen, 1.0)
    if rng.random() < 0.4:
        more = others[: rng.integers(0, 3)]
        weights = {j: float(f"{rng.uniform(0.2, 5.0):.4g}") for j in [*chosen, *more]}
    d.pushed = weights
    _check(d, path)


def _check(d: Draft, path: Path) -> None:
    """Say whether what is pushed holds the motion all along."""
    if d.pushed:
        d.holds = all(_held(d, motion, [*d.pushed])[-1] > _STEADY / 2 for motion in path.motions)


def _held(d: Draft, motion: oracle.Result, joints) -> np.ndarray:
    """Singular values of the slope of all gaps but those that lead, with these joints held, at a
    posture of the motion.
    """
    guides, d.guides = d.guides, {}
    found = d.oracle(d.start)
    d.guides = guides
    q = np.array([x.v for name in d.bodies for x in motion.q[name]])
    slope, sizes = found.slope(q, dict.fromkeys(joints, (0.0, 0.0, 0.0))), np.zeros(q.size)
    if len(slope):
        sizes[: min(slope.shape)] = np.linalg.svd(found.scaled(slope), compute_uv=False)
    return sizes


def over(d: Draft, rng: np.random.Generator, instants, grid) -> tuple | None:
    """Instants in equal steps of a coordinate that is driven, where it does not turn back."""
    if rng.random() > 0.15 or grid[2] < 3:
        return None
    times = np.linspace(min(instants[0], grid[0]), grid[1], 25)
    for joint in rng.permutation([*d.laws]):
        law = d.laws[str(joint)][1]
        rates = np.array([law.jet(None, t).d for t in times])
        if min(abs(rates)) > 1e-2 * max(abs(rates)) > 1e-4 and len({*np.sign(rates)}) == 1:
            ends = (float(law.jet(None, t).v) for t in grid[:2])
            return (str(joint), *ends, grid[2])
    return None


def ask(d: Draft, rng: np.random.Generator) -> None:
    """Outputs of a user's own, each so many times a force."""
    for _ in range(2):
        if rng.random() > 0.2:
            continue
        factor, name = float(f"{rng.uniform(-3.0, 3.0):.4g}"), d.new("o")
        kind = str(rng.choice(["reaction", "effort", "section"]))
        if kind == "reaction":
            joint, k = str(rng.choice([*d.joints])), str(rng.choice(["fx", "fy"]))
            text, of = f"m.results.reaction({joint}).{k}", f"reaction:{joint}:{k}"
        elif kind == "effort" and (driven := [*(d.pushed or d.laws)]) and not d.rows:
            joint = str(rng.choice(driven))
            text, of = f"m.results.effort({joint})", f"effort:{joint}"
        elif d.limited:
            link = str(rng.choice(sorted(d.limited)))
            k = str(rng.choice(["axial", "shear", "bending"]))
            ratio = float(rng.choice([0.0, 1.0, round(rng.uniform(0.05, 0.95), 5)]))
            text, of = f"m.results.section({link}, {ratio!r}).{k}", f"section:{link}:{k}@{ratio!r}"
        else:
            continue
        d.outputs[name] = of, factor
        d.lines.append(f'{name} = m.output("{name}", {factor!r} * {text}, unit="N")')
