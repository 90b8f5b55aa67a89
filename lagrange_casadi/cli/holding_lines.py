"""Lines on the efforts that hold a mechanism at rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..instants.solution import Solution
from ..study.holding import Holding


def holding_lines(solution: Solution, ranges: Mapping[str, Holding]) -> Iterator[str]:
    """The range of each effort that friction at rest leaves open, or why it is not told."""
    for name, held in ranges.items():
        there = solution.resting & np.isnan(solution.effort(name))
        if held.untold:
            yield f"  held at rest: effort:{name} is not told: {held.untold}"
        elif there.any():
            unit, least, largest = solution.unit(f"effort:{name}"), held.least[there].min(), held.largest[there].max()
            yield f"  held at rest: effort:{name} may be anything from {least:.5g} to {largest:.5g} {unit}"
