"""Source of an exported program from a scene: derived, evaluated once, and compared with that
result.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...engine.derive import derived
from ...engine.identity import declaration
from ...engine.instants.determinacy import determinate
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.instants.from_table import table_of
from ...errors import CertificateError, DeclarationError
from ...model.expressions import check_line
from ...model.scene import Scene
from ...model.times import checked_span, instants_of
from ...model.wanted_names import by_parameters, others, without_fitted, without_life
from ...results.verification.certificate import failure
from ...studies.evaluate import evaluate
from .contract import contract
from .data import check_size
from .exported_program import exported
from .exported_slopes import FUNCTION, ExportedSlopes, check_method, exported_slopes
from .golden import golden
from .source import Source


def sourced(
    scene: Scene,
    name: str,
    parameters: Mapping[str, float] | None,
    wanted: Sequence[str] | None,
    method: EvaluationMethod,
    largest: int,
) -> Source:
    """The program of a scene, called ``name``, else as its mechanism, with ``parameters`` as its
    defaults.

    A table takes ``largest`` bytes at most.

    Raises :class:`SizeError` for a table that is too large, :class:`CertificateError` where the
    scene's own cycle fails its certificate, and what :func:`.evaluate` raises.
    """
    named, values = () if wanted is None else wanted, scene.values(parameters)
    without_life(named, "exports")
    names, p = scene.wanted if wanted is None else wanted, np.array(list(values.values()))
    compiled, near = derived(scene, names, values)
    data = compiled.data
    name, by, wanted = name or data.name, by_parameters(data.parameters, names), others(names)
    check_line("name", name)
    without_fitted(data.content.fitted, named, "exports")
    if by:
        check_method(method)
    precision, newton, table = method.precision, method.newton, method.table
    declared = declaration(near, compiled.wanted) or compiled.dumps()
    method.check(compiled)
    if not compiled.driven:
        raise DeclarationError(
            f"export: '{data.name}' has no drive, so C would have no inputs; use evaluate"
        )
    scene.checked(values)
    checked_span(compiled.laws, data.timing, values)
    instants = instants_of(compiled.laws, data.timing, values).t
    whole, (compiled, indeterminate) = (
        compiled,
        determinate(compiled, instants, p, reusable=table is None),
    )
    # What rounding alone makes of it: all steps that loops want, and no table.
    exact = evaluate(scene, parameters=values, wanted=wanted, backend="vm")
    if exact.failed:
        raise CertificateError(f"cannot export {name}: {failure(exact)}")
    solution = exact
    if newton is not None or table is not None:
        # It is held to the exact one, and as far off as that was asked for.
        solution = evaluate(
            scene,
            parameters=values,
            wanted=wanted,
            newton=newton,
            table=table,
            backend="vm",
            certificate=False,
        )
    cycle = None if table is None else table_of(compiled, solution.t, p, method)
    agreed = contract(compiled, name, precision, solution, indeterminate, fixed=table is not None)
    emitted = exported(compiled, agreed, newton, p, cycle)
    check_size(emitted, largest)
    vectors, slopes = golden(whole, agreed, solution, exact, p), ExportedSlopes()
    if by:
        slopes = exported_slopes(compiled, agreed, by, p, exact.t, vectors.times)
        emitted = replace(emitted, functions={**emitted.functions, FUNCTION: slopes.function})
    declared_hash = hashlib.sha256(f"{declared}\0{json.dumps(values)}".encode()).hexdigest()[:32]
    return Source(emitted, declared_hash, method.options, values, vectors, slopes)
