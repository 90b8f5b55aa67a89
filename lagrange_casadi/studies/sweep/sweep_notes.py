"""Notes on a sweep: joints that rub and rest in its designs, whole turns of drives in all of them,
and fatigue that is left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

import numpy as np

from ...base.arrays import spread
from ...base.status import Status
from ...engine.model_data import template
from ...errors import LagrangeCasadiError
from ...model.notes import rest_note
from ...model.revolutions import note
from ...model.scene import Scene
from ...model.times import Over, Times, Timing
from ...results.strength.fatigue import lacking
from ..evaluate import evaluate
from .axes import DesignsLike, designs_of, filled
from .meanings import LEAST
from .reading import Sweep

_RESTS_OF = 16
"""Designs of a sweep, from the first to the last that has a result."""

_TURNS_OF = 1024
"""Designs, evenly spread over all of them."""


def fatigue_notes(found: Sweep) -> Iterator[str]:
    """Say of each link with a factor of safety why none against fatigue is kept."""
    materials = found.description.materials
    for name in found.description.bodies:
        if (
            f"{LEAST}:safety:{name}" in found.columns
            and f"{LEAST}:fatigue:{name}" not in found.columns
        ):
            yield (
                f"no factor against fatigue of '{name}' is kept:"
                f" {lacking(materials[name]).partition(': ')[2]}"
            )


def resting_note(
    scene: Scene,
    found: Sweep,
    fixed: Mapping[str, float],
    *,
    t: Times | None = None,
    over: Over | None = None,
    wanted: Sequence[str] | None = None,
) -> str:
    """A line where a joint that rubs rests in some design that is looked at, of all those with a
    result; empty where none does.
    """
    if not found.description.has_friction:
        return ""
    right = np.concatenate(
        [numbers[values["status"] == Status.OK] for numbers, values in found.blocks(["status"])]
    )
    some = right[spread(right.size, _RESTS_OF)]
    lines = []
    for number in some.tolist():
        design = {**fixed, **found.design(number)}
        with suppress(LagrangeCasadiError):  # the sweep is written, and right by its own rules
            solution = evaluate(
                scene,
                parameters=design,
                t=t,
                over=over,
                wanted=wanted,
                backend="vm",
                certificate=False,
            )
            if solution.resting.any():
                lines.append(
                    f"in design {number}"
                    f" {rest_note(solution.t, solution.outputs, solution.resting)}"
                )
    if not lines:
        return ""
    return (
        f"{lines[0]}; so it is in {len(lines)} of {some.size} designs that were evaluated"
        if some.size > 1
        else lines[0]
    )


def turning_note(
    scene: Scene, timing: Timing, grid: DesignsLike, fixed: Mapping[str, float]
) -> str:
    """A line where the drive turns, and makes less than a turn, or not the same in every design of
    a ``grid``.
    """
    designs, values = designs_of(grid, scene.parameters), scene.values(fixed)
    some = spread(designs.size, _TURNS_OF).tolist()
    rows = np.concatenate([designs.block(number, number + 1) for number in some])
    p = filled(values, designs.names, rows)
    return note(scene.prescribed, template(scene).content.kinds, timing, p)
