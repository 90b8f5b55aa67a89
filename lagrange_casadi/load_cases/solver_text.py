"""Load cases as text that input files include: of CalculiX and Abaqus, and Nastran's bulk data."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping

from .loads import LoadCase, listed, nodes_of, set_names


def calculix(case: LoadCase, file: str, nodes: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines of a file for a step of CalculiX or Abaqus."""
    known = nodes_of(case)
    names, elements = set_names(known, nodes), nodes.get(case.link, case.link)
    yield from _head(case, "**", f"Within a step: *INCLUDE, INPUT={file}")
    yield f"** Element set {elements}: mass {case.mass:.9g} kg, centre {listed(case.centre)} m"
    yield "** Node sets, each of the one node that takes a joint's load:"
    yield from (f"**   {names[name]} at {listed(at)} m" for name, (at, _, _) in known.items())
    yield "** Moments are on degrees of freedom 4 to 6 of that node. Of a *RIGID BODY of CalculiX"
    yield "** they are on 1 to 3 of its ROT NODE."
    yield "*CLOAD"
    for name, (_, force, moment) in known.items():
        for k, value in enumerate((*force, *moment), 1):
            if value != 0.0:
                yield f"{names[name]}, {k}, {value:.12g}"
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
    """Yield bulk data of the load set ``number``, which adds up sets of one kind each."""
    known = nodes_of(case)
    grids = _grids(set_names(known, nodes))
    yield from _head(case, "$", f"In case control: LOAD = {number}")
    yield f"$ Mass {case.mass:.9g} kg, centre {listed(case.centre)} m"
    yield "$ Grid points, each takes a joint's load:"
    yield from (
        f"$   {grids[name]}: {name} at {listed(at)} m" for name, (at, _, _) in known.items()
    )
    sets = (number + k for k in itertools.count(1))
    used, own = [], next(sets)
    for name, (_, force, moment) in known.items():
        for word, vector in (("FORCE", force), ("MOMENT", moment)):
            if any(vector):
                yield from _card(word, own, grids[name], 0, 1.0, *vector)
                used = [own]
    weight, size, spin = _field(case)
    if size:
        used.append(next(sets))
        yield "$ gravity less the acceleration of the origin"
        yield from _card("GRAV", used[-1], 0, 1.0, *weight)
    if spin:
        used.append(next(sets))
        yield "$ angular velocity, in turns"
        yield from _card("RFORCE", used[-1], 0, 0, 1.0 / math.tau, *case.omega)
    if any(case.alpha):
        used.append(next(sets))
        yield "$ angular acceleration, in turns, negative: the force of RACC is m (alpha x r)"
        negative = [0.0 - x for x in case.alpha]
        yield from _card("RFORCE", used[-1], 0, 0, 0.0, *negative, "", 1.0 / math.tau)
    pairs = "".join(f"{1.0:>8}{one:>8}" for one in used)
    yield f"LOAD    {number:>8}{1.0:>8}{pairs[:48]}"
    if pairs[48:]:
        yield f"        {pairs[48:]}"


def _head(case: LoadCase, mark: str, use: str) -> Iterator[str]:
    yield f"{mark} {case.link} at t = {case.t:.9g} s: {', '.join(case.governs) or 'as asked'}"
    yield f"{mark} SI units, on the axes of the link, from its origin. {use}"


def _field(case: LoadCase) -> tuple[list[float], float, float]:
    """Return gravity less the acceleration of the origin, its size, and the angular speed."""
    weight = [g - a for g, a in zip(case.gravity, case.acceleration, strict=True)]
    return weight, math.hypot(*weight), math.hypot(*case.omega)


def _grids(names: Mapping[str, str]) -> dict[str, int]:
    """Return numbers of grid points: those that were chosen, else the first that are free."""
    taken = {int(name) for name in names.values() if name.isdigit()}
    free = (k for k in itertools.count(1) if k not in taken)
    return {name: int(own) if own.isdigit() else next(free) for name, own in names.items()}


def _card(word: str, *fields: float | str) -> Iterator[str]:
    """Yield an entry in fields of 16 characters, four in a line."""
    texts = [f"{x:.9E}" if isinstance(x, float) else str(x) for x in fields]
    for start in range(0, len(texts), 4):
        row = "".join(f"{text:>16}" for text in texts[start : start + 4])
        yield f"{word + '*' if not start else '*':<8}{row}"
