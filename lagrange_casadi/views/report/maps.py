"""Maps along links that a page holds as numbers: stresses and deflections, which the viewer has no
law of.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...base.arrays import Array, Json, spread
from ...results.elastic.deflection import bending_of
from ...results.solution import Solution
from ...results.statistics import counted
from ...results.strength.all_parts import strong_of
from ...results.strength.stress import Stress
from .array_block import Arrays
from .instants import mark

_RATIOS = np.linspace(0.0, 1.0, 51)
"""Equal ratios xi/l of a map, both ends included."""

INSTANTS = 201
"""Instants of a map at most, and that of its peak: a map is no wider on a screen than some hundred
points.
"""

_BESIDE = 0.98


def map_entries(solution: Solution, arrays: Arrays) -> Iterator[dict[str, Json]]:
    """The maps of the links that have a beam, values over time and along the link: von Mises'
    stress, and where the material's elasticity is known the deflection.

    Arrays are by their numbers: times ``t`` (t,), ratios ``xi`` (xi,), and ``values`` (t, xi), all
    of an instant together; ``over`` has the drive's coordinate (t,) where instants are over one.
    ``where`` says more of the peak's place.
    """
    for link in strong_of(solution):
        stress = solution.stress(link)
        peak = stress.peak("von_mises")
        chosen = _instants(solution, peak.t)
        grid = Stress(stress.member.during(chosen)).grid("von_mises", _RATIOS)
        yield {
            "name": f"stress:{link}",
            "link": link,
            "what": "von Mises' stress",
            "unit": "Pa",
            "signed": False,
            **_numbers(solution, chosen, grid, arrays),
            "peak": mark(solution, peak.value, peak.t, peak.xi),
            "where": peak.fibre,
        }
    for link in bending_of(solution):
        bent = solution.deflection(link)
        sizes = bent.size(np.broadcast_to(_RATIOS, (solution.t.size, _RATIOS.size)))
        most = np.abs(sizes).max(axis=1)
        if not counted(most).any():
            continue
        # A smooth line has its summit no farther above such a grid, so other instants need no
        # search along it.
        largest = (
            solution.during(most >= _BESIDE * float(np.fmax.reduce(most))).deflection(link).peak()
        )
        chosen = _instants(solution, largest.t)
        line = "the line between its ends" if bent.against == "ends" else "its axis at the base"
        yield {
            "name": f"deflection:{link}",
            "link": link,
            "what": "deflection across the link",
            "unit": "m",
            "signed": not bent.member.space,
            **_numbers(solution, chosen, sizes[chosen], arrays),
            "peak": mark(solution, largest.value, largest.t, largest.xi),
            "where": f"from {line}",
        }


def _instants(solution: Solution, t: float) -> Array:
    return np.unique([*spread(solution.t.size, INSTANTS), int(np.argmax(solution.t == t))])


def _numbers(solution: Solution, chosen: Array, grid: Array, arrays: Arrays) -> dict[str, Any]:
    """Numbers of the arrays of a map, of the instants that are chosen."""
    return {
        "over": arrays.add(solution.over.values[chosen]) if solution.over else None,
        "t": arrays.add(solution.t[chosen]),
        "xi": arrays.add(_RATIOS),
        "values": arrays.add(grid.ravel()),
    }
