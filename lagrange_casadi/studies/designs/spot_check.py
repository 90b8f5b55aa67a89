"""One design of many, looked at as closely as a scene is: all its outputs at some instants, and
their certificate.

What a sweep keeps of its designs cannot balance a body. So a few of them are evaluated once more,
with every output and by CasADi's virtual machine. The certificate judges that, and what the
compiled code has made of the same design must agree with it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from ...base.arrays import Array, spread
from ...base.quantities import Output
from ...engine.compensated import ROUNDING
from ...engine.instants.backends import run
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.instants.phases import outputs_of, phases
from ...engine.program import Program
from ...results.histories import Histories
from ...results.vector_sizes import most
from ...results.verification.accuracy import by_unit, estimate
from ...results.verification.certificate import tolerance
from ...results.verification.evidence import residuals_of
from ...results.verification.reported import COARSE

INSTANTS = 5
_WANTED = {"stress": "stress", "utilisation": "safety", "deflection": "deflection"}
"""Outputs to be wanted that ``all`` does not include."""

_ROUNDINGS = 10.0
_AGREES = 1e-6
"""Relative difference, of the largest value of a unit, up to which two evaluations of the same
graph agree; in single precision more.
"""


def wanted_whole(outputs: Iterable[Output]) -> list[str]:
    """Return what is to be wanted for a graph of all outputs, these among them."""
    return [
        "all",
        *dict.fromkeys(f"{_WANTED[o.group]}:{o.part}" for o in outputs if o.group in _WANTED),
    ]


def failures(
    program: Program,
    p: Array,
    t: Array,
    method: EvaluationMethod,
    found: Mapping[Output, Array],
) -> dict[str, float]:
    """Failures of a design, and their size: residuals of its certificate, and under ``agreement``
    the distance of what was ``found``.

    That are the outputs that were made of it, over its instants ``t``; the ``program`` has all
    outputs.
    """
    some = spread(t.size, INSTANTS)
    # Iterated loops are followed from instant to instant.
    t, kept = (t, some) if program.newton is not None else (t[some], np.arange(some.size))
    table, provenance = run(program, t, p, EvaluationMethod("vm", newton=method.newton))
    t, rows = t[kept], table.out[:, kept]
    within = phases(program, rows, t, p)
    found_there, description = outputs_of(program, rows), program.described(p, rows)
    whole = Histories(program.data.name, t, np.zeros(0), found_there, description, provenance)
    limit = tolerance(whole) if method.newton is None else COARSE
    residuals = residuals_of(whole, program, rows, p, within).items()
    failed = {name: gap for name, gaps in residuals if not (gap := float(np.max(gaps))) <= limit}
    allowed = max(_AGREES, limit) if method.precision == "double" else COARSE
    compiled = {output: values[some] for output, values in found.items()}
    agreement = _agreement(whole, compiled, {})
    if not agreement <= allowed:
        # What is nothing but rounding has no size of its own to be compared with.
        there = replace(
            table, out=rows, status=table.status[kept], iterated=table.iterated[:, kept]
        )
        rounded = estimate(program, there, whole, p)
        coarser = ROUNDING[method.precision] / ROUNDING["double"]
        agreement = _agreement(
            whole,
            compiled,
            {output: _ROUNDINGS * coarser * error for output, error in rounded.items()},
        )
    return failed if agreement <= allowed else failed | {"agreement": agreement}


def _agreement(
    whole: Histories, found: Mapping[Output, Array], rounded: Mapping[Output, float]
) -> float:
    """Distance of outputs from those of histories, beyond what is ``rounded``, relative to the
    largest of their unit.
    """
    sizes = {output: most(values) for output, values in whole.outputs.items()}
    largest, worst = by_unit(whole.description.kinds, sizes), 0.0
    for name, values in found.items():
        there = ~np.isnan(
            values
        )  # no number is what equilibrium leaves open, or friction at rest does
        gaps, unit = values[there] - whole.outputs[name][there], whole.unit(name)
        if unit == "rad":
            gaps = gaps - math.tau * np.rint(gaps / math.tau)
        gap = max(float(np.max(np.abs(gaps), initial=0.0)) - rounded.get(name, 0.0), 0.0)
        worst = max(worst, gap / (max(largest[unit], 1.0 if unit == "rad" else 0.0) or 1.0))
    return worst
