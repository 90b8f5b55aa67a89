"""From a scene to the source of an exported program: derived, evaluated once, and held to what that gives."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..declare.scene import Scene, Wanted, without_fitted, without_life
from ..declare.times import instants_of
from ..declare.wanted_slopes import by_parameters, others
from ..equations.derive import as_derived, assembled, compile_scene
from ..equations.fingerprint import declaration
from ..errors import CertificateError, DeclarationError
from ..instants.determinacy import determinate
from ..instants.from_table import drive_of, table_of
from ..instants.rung import Rung
from ..judge.certificate import failure
from ..studies.evaluate import evaluate
from ..studies.solving import checked_span
from .contract import contract
from .data import check_size
from .golden import golden
from .program import program
from .slopes import FUNCTION, check_rung, exported_slopes
from .source import Source


def sourced(
    scene: Scene, name: str, parameters: Mapping[str, float] | None, wanted: Sequence[str] | None, rung: Rung, largest: int
) -> Source:
    """The program of a scene, called ``name``, with ``parameters`` as its defaults; a table takes ``largest`` bytes at most.

    Raises :class:`SizeError` for a table that is too large, :class:`CertificateError` where the scene's own cycle fails its
    certificate, and what :func:`.evaluate` raises.
    """
    without_life(() if wanted is None else wanted, "exports")
    without_fitted(scene.mechanism, () if wanted is None else wanted, "exports")
    names = scene.wanted if wanted is None else wanted
    by = by_parameters(scene.mechanism, names)
    if by:
        check_rung(rung)
        Wanted.of(scene.mechanism, names)
        wanted = others(names)
    precision, newton, table = rung.precision, rung.newton, rung.table
    values = scene.mechanism.values(parameters)
    p = np.array(list(values.values()))
    scene = assembled(scene, values, wanted)
    graph = compile_scene(scene, wanted)
    declared = declaration(as_derived(scene, scene.wanted if wanted is None else wanted), graph.wanted) or graph.dumps()
    rung.check(graph)
    if not graph.driven:
        raise DeclarationError(f"export: '{scene.mechanism.name}' has no drive, and C without inputs computes nothing; evaluate it")
    scene.checked(values)
    checked_span(graph.laws, graph.data.timing, values)
    instants = instants_of(graph.laws, graph.data.timing, values).t
    whole, (graph, left_open) = graph, determinate(graph, instants, p, telling=table is None)
    # What rounding alone makes of it: all steps that loops want, and no table.
    exact = evaluate(scene, parameters=values, wanted=wanted, backend="vm")
    if exact.failed:
        raise CertificateError(f"cannot export {name}: {failure(exact)}")
    solution = exact
    if newton is not None or table is not None:
        # It is held to the exact one, and as far off as that was asked for.
        words: dict[str, Any] = {"parameters": values, "wanted": wanted, "newton": newton, "table": table}
        solution = evaluate(scene, **words, backend="vm", certificate=False)
    read = None if table is None else (drive_of(graph), table_of(graph, solution.t, p, rung))
    agreed = contract(graph, name, precision, solution, left_open, fixed=table is not None)
    emitted = program(graph, precision, newton, p, read)
    check_size(emitted, largest)
    guess = graph.newton.guess if graph.newton is not None and read is None else ()
    vectors = golden(whole, agreed, solution, exact, p)
    slopes = exported_slopes(graph, agreed, by, p, exact.t, vectors.times) if by else None
    if slopes is not None:
        emitted = replace(emitted, functions={**emitted.functions, FUNCTION: slopes.function})
    return Source(agreed, emitted, _hash(declared, values), guess, rung.options, values, vectors, slopes)


def _hash(declared: str, values: Mapping[str, float]) -> str:
    """The hash of what is declared, wanted and set."""
    return hashlib.sha256("\0".join([declared, json.dumps(values)]).encode()).hexdigest()[:32]
