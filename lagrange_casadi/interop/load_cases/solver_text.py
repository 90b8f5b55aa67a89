"""Load cases as text that input files include: of CalculiX and Abaqus, and Nastran's bulk data."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from typing import Any

from .loads import LoadCase, listed, nodes_of, title

_SETS = 10
"""Numbers of Nastran's load sets of a load case."""


def calculix(case: LoadCase, number: int, nodes: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines of a file for a step of CalculiX or Abaqus."""
    found, elements = nodes_of(case, nodes), nodes.get(case.link, case.link)
    yield from _head(case, "**", f"Within a step: *INCLUDE, INPUT={case.link}_{number}.inp")
    yield f"** Element set {elements}: mass {case.mass:.9g} kg, centre {listed(case.centre)} m"
    yield "** Node sets, each of the one node that takes a joint's load:"
    yield from (f"**   {node.set} at {listed(node.at)} m" for node in found)
    yield "** Moments are on degrees of freedom 4 to 6 of that node. Of a *RIGID BODY of CalculiX"
    yield from ("** they are on 1 to 3 of its ROT NODE.", "*CLOAD")
    for node in found:
        yield from (f"{node.set}, {k}, {x:.12g}" for k, x in enumerate(node.wrench, 1) if x)
    weight, size, spin = _field(case)
    if size or spin:
        yield "*DLOAD"
    if size:
        yield "** gravity less the acceleration of the origin"
        yield f"{elements}, GRAV, {size:.12g}, {listed([x / size for x in weight])}"
    if spin:
        yield "** square of the angular velocity, a point of its axis, its direction"
        axis = [x / spin for x in case.omega]
        yield f"{elements}, CENTRIF, {spin**2:.12g}, 0., 0., 0., {listed(axis)}"
    if any(case.alpha):
        yield f"** Angular acceleration [rad/s^2]: {listed(case.alpha)}"
        yield "** CalculiX has no load for it: add the force -m (alpha x r) on the mass m of each"
        yield "** node at r. Without it the loads are not in equilibrium."


def nastran(case: LoadCase, number: int, nodes: Mapping[str, str]) -> Iterator[str]:
    """Yield bulk data of a load set, which adds up sets of one kind each."""
    found, whole = nodes_of(case, nodes), _SETS * number
    taken = {int(node.set) for node in found if node.set.isdecimal()}
    free = (k for k in itertools.count(1) if k not in taken)
    grids = [(int(one.set) if one.set.isdecimal() else next(free), one) for one in found]
    yield from _head(case, "$", f"In case control: LOAD = {whole}")
    yield f"$ Mass {case.mass:.9g} kg, centre {listed(case.centre)} m"
    yield "$ Grid points, each takes a joint's load:"
    yield from (f"$   {grid}: {node.name} at {listed(node.at)} m" for grid, node in grids)
    used = []
    for grid, node in grids:
        for word, vector in (("FORCE", node.wrench[:3]), ("MOMENT", node.wrench[3:])):
            if vector.any():
                yield from _card(word, whole + 1, grid, 0, 1.0, *vector)
                used = [whole + 1]
    weight, size, spin = _field(case)
    negative, turn = [0.0 - x for x in case.alpha], 1.0 / math.tau
    about = "angular acceleration, in turns, negative: the force of RACC is m (alpha x r)"
    inertia: list[tuple[Any, ...]] = [
        (size, "gravity less the acceleration of the origin", "GRAV", 0, 1.0, *weight),
        (spin, "angular velocity, in turns", "RFORCE", 0, 0, turn, *case.omega),
        (any(negative), about, "RFORCE", 0, 0, 0.0, *negative, "", turn),
    ]
    for own, (_, about, word, *fields) in enumerate((x for x in inertia if x[0]), whole + 2):
        yield f"$ {about}"
        yield from _card(word, own, *fields)
        used.append(own)
    pairs = "".join(f"{1.0:>8}{one:>8}" for one in used)
    yield f"LOAD    {whole:>8}{1.0:>8}{pairs[:48]}"
    if pairs[48:]:
        yield f"        {pairs[48:]}"


def _head(case: LoadCase, mark: str, use: str) -> Iterator[str]:
    yield f"{mark} {title(case)}"
    yield f"{mark} SI units, on the axes of the link, from its origin. {use}"


def _field(case: LoadCase) -> tuple[list[float], float, float]:
    """Return gravity less the acceleration of the origin, its size, and the angular speed."""
    weight = [g - a for g, a in zip(case.gravity, case.acceleration, strict=True)]
    return weight, math.hypot(*weight), math.hypot(*case.omega)


def _card(word: str, *fields: float | str) -> Iterator[str]:
    """Yield an entry in fields of 16 characters, four in a line."""
    texts = [f"{x:.9E}" if isinstance(x, float) else str(x) for x in fields]
    for start in range(0, len(texts), 4):
        row = "".join(f"{text:>16}" for text in texts[start : start + 4])
        yield f"{word + '*' if not start else '*':<8}{row}"
