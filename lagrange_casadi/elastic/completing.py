"""A solution that elasticity completed: the errors of what it told, and what of it was wanted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..arithmetic.compensated import ROUNDING
from ..base.arrays import Array
from ..base.quantities import Output
from ..base.tables import FORCE, MOMENT
from ..declare.scene import Wanted
from ..instants.solution import Solution
from ..judge.accuracy import ALONG, most
from .least_energy import Completed

_ROUNDINGS = 8.0


def told_errors(
    errors: Mapping[Output, float], solution: Solution, before: Mapping[Output, Array], done: Completed
) -> dict[Output, float]:
    """Errors of a completed solution, by those of the equilibrium ``before`` that it was found from.

    What was put to that is off by the relative error of all forces, as much as least squares may magnify it.
    """
    if not errors:
        return {}
    part = _ROUNDINGS * ROUNDING["double"]
    for unit in (FORCE, MOMENT):
        own = [output for output in before if output in errors and output.quantity.unit == unit]
        size, worst = max(map(most, (before[o] for o in own)), default=0.0), max((errors[o] for o in own), default=0.0)
        part = max(part, worst / size if size > 0.0 else 0.0)
    part *= 2.0 * done.magnified  # the equilibrium is off, and so is what is put to it
    found = dict(errors)
    for output in done.told:
        if output in found:
            found[output] += part * most(solution.outputs[output] - before[output])
    for link in solution.links_with_sections:
        law = solution.section(link).law
        old = law.of(link, before)
        u = np.broadcast_to(ALONG, (solution.t.size, ALONG.size))
        for force in solution.table.forces:
            output = Output("section", link, force)
            if output in found:
                found[output] += part * max(most(law.at(force, u, side) - old.at(force, u, side)) for side in ("base", "tip"))
    return found


def wanted_alone(solution: Solution, want: Wanted) -> Solution:
    """A solution without what was evaluated for elasticity alone."""
    outputs = {output: values for output, values in solution.outputs.items() if _wanted(output, want)}
    kept = (*outputs, *(Output("section", link, force) for link in want.sections for force in solution.table.forces))
    names = {str(output) for output in kept}
    return replace(
        solution,
        outputs=outputs,
        errors={name: error for name, error in solution.errors.items() if name in names},
        left_open=tuple(output for output in solution.left_open if output in outputs),
        sensitivities=solution.sensitivities.of(set(kept)),
        elasticity=replace(solution.elasticity, told=tuple(output for output in solution.elasticity.told if output in outputs)),
    )


def _wanted(output: Output, want: Wanted) -> bool:
    """Whether an output is of what is wanted."""
    if output.group in ("effort", "motion"):
        return want.effort if output.group == "effort" else want.motion
    if output.group == "pose":
        return want.motion
    if output.along:
        return output.part in want.sections
    parts = {
        "reaction": want.reactions,
        "multiplier": want.multipliers,
        "load": want.loads,
        "friction": want.frictions,
        "output": want.own,
        "stress": want.stressed,
        "utilisation": want.used,
        "deflection": want.bent,
    }
    return output.part in parts[output.group]
