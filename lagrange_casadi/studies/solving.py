"""A scene over its instants: derived, compiled, evaluated, refused if it is no result, and given
with the evidence that it is right.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..base.quantities import Output
from ..base.space import cores, in_words, require
from ..engine.derive import derived
from ..engine.instants.determinacy import completed, determinate, undetermined
from ..engine.instants.evaluation_method import EvaluationMethod, seconds
from ..engine.instants.from_table import columns
from ..engine.instants.phases import outputs_of, phases
from ..engine.instants.refusing import refuse, refuse_laws
from ..engine.placement import explained
from ..engine.program import Program
from ..errors import CertificateWarning, DeclarationError, warn
from ..model.even_points import checked_ratios, points
from ..model.scene import Scene
from ..model.scene_arguments import Elastic
from ..model.times import checked_span, instants_of
from ..model.wanted_names import by_parameters
from ..results.derivatives import Derivatives
from ..results.holding import held_at_rest
from ..results.ordering import in_order
from ..results.sensitivity.series import series_slopes
from ..results.solution import Solution
from ..results.verification.certificate import failure, tolerance
from ..results.verification.evidence import verified
from .request import Request

_BESIDE, _CHECKED = 8, 2
"""Rows beside the outputs, and how many times both are in memory while they are checked."""

_LONG = 60.0
"""Seconds of which nothing need be said."""


def solve(
    scene: Scene,
    request: Request,
    *,
    threads: int | None = None,
    certificate: bool = True,
    elastic: Elastic | None = None,
) -> Solution:
    """Evaluate a scene: see :func:`.evaluate`."""
    scene, method = scene.with_elastic(elastic), request.method
    if scene.elastic and method.table is not None:
        raise DeclarationError(
            "elastic: a table cannot hold statically indeterminate forces; evaluate without a table"
        )
    values, timing = scene.values(request.parameters), scene.timing(request.t, request.over)
    scene.checked(values)
    ratios = checked_ratios(scene.xi if request.xi is None else request.xi)
    names = scene.wanted if request.wanted is None else request.wanted

    with explained(scene, values):
        program, _ = derived(scene, names, values)
    data, p = program.data, np.array(list(values.values()))
    method.check(program)
    refuse_laws(data, checked_span(data.laws, timing, values), tuple(p.tolist()))
    copies = _CHECKED if certificate else 1
    require("the outputs over time", (copies, len(program.columns) + _BESIDE, timing.count))
    _announce(program, timing.count, method, threads or cores())
    instants = instants_of(data.laws, timing, values)
    data.corners.refuse_laws(instants.t, p.tolist())

    indeterminate: tuple[Output, ...] = ()
    if method.table is not None:
        program, indeterminate = determinate(program, instants.t, p)
    evaluated, provenance = columns(program, instants.t, p, method, threads)
    with explained(scene, values):
        refuse(program, evaluated, instants.t, p, method)
    out = np.asarray(evaluated.out, float)
    data.corners.refuse_constraints(
        lambda name: out[..., program.seen_columns(name), :], p.tolist()
    )
    indeterminate += undetermined(program, out, p, method)

    elasticity, unbalanced = completed(program, evaluated, instants.t, p, indeterminate)
    within = phases(program, out, instants.t, p) if certificate else {}
    unknown = {output: np.full(instants.t.size, np.nan) for output in indeterminate}
    description = program.described(p, out)
    histories = Solution(
        case=data.name,
        t=instants.t,
        xi=points(ratios),
        outputs=in_order(outputs_of(program, out) | unknown, description),
        description=description,
        provenance=provenance,
        indeterminate=indeterminate,
        over=instants.over,
    )
    residuals, errors = (
        verified(program, evaluated, histories, p, within, unbalanced) if certificate else ({}, {})
    )
    by = by_parameters(data.parameters, names)
    solution = replace(
        histories,
        certificate=residuals,
        errors=errors,
        tolerance=tolerance(histories),
        elasticity=elasticity,
        sensitivities=Derivatives(series_slopes(program, histories, p, by, method) if by else {}),
        holding=held_at_rest(scene, histories),
    )
    if solution.failed:
        warn(f"{failure(solution)}; the solution is not certified", CertificateWarning)
    return solution


def _announce(program: Program, count: int, method: EvaluationMethod, threads: int) -> None:
    """Warn of what takes long."""
    if method.table is not None:
        return
    # Iterated loops are followed by one thread.
    shared = 1 if program.newton is not None or method.backend == "vm" else threads
    takes = seconds(program, count, method) / shared
    if takes > _LONG:
        many, each = (
            f"{count:,}".replace(",", " "),
            "" if method.newton is None else f" of {method.newton} Newton steps each",
        )
        warn(f"{many} instants{each} take about {in_words(takes)}")
