"""Maps along links that a page holds as numbers: stresses and deflections, which the viewer has no
law of.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..base.arrays import Array
from ..instants.solution import Solution
from ..instants.statistics import counted
from ..strength.parts import bending_of, strong_of
from ..strength.stress import Stress
from .arrays import Arrays
from .marks import Mark, mark

RATIOS = 51
"""Equal ratios xi/l of a map, both ends included."""

INSTANTS = 201
"""Instants of a map at most, and that of its peak: a map is no wider on a screen than some hundred
points.
"""

_BESIDE = 0.98


@dataclass(frozen=True)
class Map:
    """Values of a link over time and along it.

    ``t``, ``xi`` and ``values`` are numbers of arrays: times (t,), ratios (xi,), and values (t,
    xi), all of an instant together; ``over`` that of the drive's coordinate (t,) where instants are
    over one. ``where`` says more of the peak's place.
    """

    name: str
    link: str
    what: str
    unit: str
    signed: bool
    t: int
    over: int | None
    xi: int
    values: int
    peak: Mark
    where: str


def map_entries(solution: Solution, arrays: Arrays) -> Iterator[dict[str, Any]]:
    """The maps of the links that have a beam: von Mises' stress, and where the material's
    elasticity is known the deflection.
    """
    for link in strong_of(solution):
        stress = solution.stress(link)
        peak = stress.peak("von_mises")
        chosen = _instants(solution, peak.t)
        grid = Stress(stress.member.during(chosen)).grid("von_mises", _ratios())
        top = mark(solution, peak.value, peak.t, peak.xi)
        yield _entry(
            f"stress:{link}",
            link,
            "von Mises' stress",
            "Pa",
            False,
            top,
            peak.fibre,
            chosen,
            grid,
            solution,
            arrays,
        )
    for link in bending_of(solution):
        bent = solution.deflection(link)
        sizes = bent.size(np.broadcast_to(_ratios(), (solution.t.size, RATIOS)))
        most = np.abs(sizes).max(axis=1)
        if not counted(most).any():
            continue
        # A smooth line has its summit no farther above such a grid, so other instants need no
        # search along it.
        largest = (
            solution.during(most >= _BESIDE * float(np.fmax.reduce(most))).deflection(link).peak()
        )
        chosen = _instants(solution, largest.t)
        grid = sizes[chosen]
        top = mark(solution, largest.value, largest.t, largest.xi)
        from_where = (
            "from the line between its ends"
            if bent.against == "ends"
            else "from its axis at the base"
        )
        words, signed = "deflection across the link", not bent.member.space
        yield _entry(
            f"deflection:{link}",
            link,
            words,
            "m",
            signed,
            top,
            from_where,
            chosen,
            grid,
            solution,
            arrays,
        )


def _ratios() -> Array:
    return np.linspace(0.0, 1.0, RATIOS)


def _instants(solution: Solution, t: float) -> Array:
    total = solution.t.size
    spread = np.linspace(0, total - 1, min(total, INSTANTS)).astype(np.intp)
    return np.unique(np.append(spread, int(np.argmax(solution.t == t))))


def _entry(
    name: str,
    link: str,
    what: str,
    unit: str,
    signed: bool,
    peak: Mark,
    where: str,
    chosen: Array,
    grid: Array,
    solution: Solution,
    arrays: Arrays,
) -> dict[str, Any]:
    over = arrays.add(solution.over.values[chosen]) if solution.over else None
    times, ratios, values = (
        arrays.add(solution.t[chosen]),
        arrays.add(_ratios()),
        arrays.add(grid.ravel()),
    )
    return asdict(Map(name, link, what, unit, signed, times, over, ratios, values, peak, where))
