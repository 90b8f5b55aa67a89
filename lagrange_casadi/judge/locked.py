"""Gimbal lock of joints that loops set: their three turns, which are told of them alone, say nothing there, and little near it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..base.quantities import Output
from ..declare.description import Description
from ..instants.solution import Solution

_NEAR = 1e-3
"""The square of the cosine of a second turn below which the turns' rates have lost digits of the body's."""


def without_locked(solution: Solution) -> Solution:
    """A solution in space without such joints' turns among what is measured: their bodies are taken where they are reported."""
    locked = [name for joint in solution.description["joints"].values() for name in _locked(solution, joint)]
    if not locked:
        return solution
    description = solution.description | {"unmeasured": [*solution.description["unmeasured"], *locked]}
    return replace(solution, description=description)


def _locked(solution: Solution, joint: Description) -> Iterator[str]:
    """The turns of a joint that come near to gimbal lock at some instant, and are told."""
    turns = [name for name, kind in joint["coordinates"].items() if kind == "angle"]
    if len(turns) < 3 or {*turns} & {*joint["driven"], *solution.description["unmeasured"]}:
        return
    second = solution.outputs[Output("motion", turns[1])]
    if not np.min(np.cos(second) ** 2) > _NEAR:
        yield from turns
