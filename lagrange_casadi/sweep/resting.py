"""Whether joints that rub come to rest in the designs of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..declare.notes import rest_note
from ..declare.scene import Scene
from ..declare.times import Over, Times
from ..equations.meshes import transmissions_of
from ..equations.pressing import frictions_of
from ..errors import LagrangeCasadiError
from ..evaluate import evaluate
from ..instants.refusal import Status
from .reading import Sweep


def resting_note(
    scene: Scene,
    found: Sweep,
    fixed: Mapping[str, float],
    *,
    t: Times | None = None,
    over: Over | None = None,
    wanted: Sequence[str] | None = None,
) -> str:
    """A line where a joint that rubs rests in the first design that has a result; empty where none does."""
    rub = transmissions_of(scene.mechanism).values()
    if not frictions_of(scene.mechanism) and all(transmission.loss is None for transmission in rub):
        return ""
    for numbers, values in found.blocks(["status"]):
        right = np.flatnonzero(values["status"] == Status.OK)
        if not right.size:
            continue
        number = int(numbers[right[0]])
        design = {**fixed, **found.design(number)}
        try:
            solution = evaluate(scene, parameters=design, t=t, over=over, wanted=wanted, backend="vm", certificate=False)
        except LagrangeCasadiError:  # the sweep is written, and right by its own rules
            return ""
        told = rest_note(solution.t, solution.outputs, solution.resting) if solution.resting.any() else ""
        return told and f"in design {number} {told}"
    return ""
