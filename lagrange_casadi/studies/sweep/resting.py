"""Whether joints that rub come to rest in the designs of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress

import numpy as np

from ...declare.notes import rest_note
from ...declare.scene import Scene
from ...declare.times import Over, Times
from ...errors import LagrangeCasadiError
from ...instants.refusal import Status
from ..evaluate import evaluate
from .reading import Sweep

_LOOKED_AT = 16
"""Designs of a sweep, from the first to the last that has a result."""


def resting_note(
    scene: Scene,
    found: Sweep,
    fixed: Mapping[str, float],
    *,
    t: Times | None = None,
    over: Over | None = None,
    wanted: Sequence[str] | None = None,
) -> str:
    """A line where a joint that rubs rests in some design that is looked at, of all those with a result; empty where none does."""
    told = found.description
    if "losses" not in told and not any("friction" in load for load in told["loads"].values()):
        return ""
    right = np.concatenate([numbers[values["status"] == Status.OK] for numbers, values in found.blocks(["status"])])
    some = right[np.unique(np.linspace(0, right.size - 1, min(right.size, _LOOKED_AT)).astype(int))]
    lines = []
    for number in some.tolist():
        design = {**fixed, **found.design(number)}
        with suppress(LagrangeCasadiError):  # the sweep is written, and right by its own rules
            solution = evaluate(scene, parameters=design, t=t, over=over, wanted=wanted, backend="vm", certificate=False)
            if solution.resting.any():
                lines.append(f"in design {number} {rest_note(solution.t, solution.outputs, solution.resting)}")
    if not lines:
        return ""
    return f"{lines[0]}; so it is in {len(lines)} of {some.size} designs that were looked at" if some.size > 1 else lines[0]
