"""Tables as constants in C: those of a cycle, and how large all of them are."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from ...base.lookups import lookup
from ...base.vocabulary import Precision
from ...engine.codegen.compiler import written
from ...engine.codegen.printer import Format, function_name
from ...engine.instants.cycle_table import CycleTable
from ...errors import SizeError
from .exported_program import ExportedProgram

LARGEST: dict[Precision, int] = {"double": 16_000_000, "single": 64_000}
"""Bytes of a table, unless more are allowed: what a large and what a small machine has room for."""

_LINE = 6

_ALONE = {
    r"^(#.*|typedef REAL real;)\n": "",
    r"restrict ": "",
    r"\b(BLOCK|PACK)\b": "1",
    r"\bTILE\b": "32",
    r"\bWEIGHTS\b": "6",
    r"\bFACTORS\b": "4",
    # A number becomes a long by one instruction of a small machine, a long long by a library's
    # arithmetic of doubles.
    r"long long": "long",
    r"\breal\b": "casadi_real",
}
"""Changes to the C that reads a table, where instants come one by one and without macros."""


def check_size(exported: ExportedProgram, limit: int) -> None:
    """Raise :class:`SizeError` where a table is larger than ``limit`` bytes."""
    called = {
        inner.name(): lookup(inner)
        for function in exported.functions.values()
        for inner in function.find_functions()
    }
    curves = sum(table.numbers.size for table in called.values() if table is not None)
    cycle = 0 if exported.cycle is None else exported.cycle.coefficients.size
    for what, numbers in (
        ("what curves and motions by samples look up", curves),
        ("the table of the cycle", cycle),
    ):
        size = numbers * (4 if exported.contract.rests else 8)
        if size > limit:
            raise SizeError(
                f"{what} takes {size} bytes of constants, and the limit is {limit}: take fewer"
                " numbers, or raise the limit"
            )


def table_text(exported: ExportedProgram) -> str:
    """A table of the cycle, and what reads it."""
    cycle = exported.cycle
    if cycle is None:
        return ""
    text = written("interpolate.c")
    for pattern, words in _ALONE.items():
        text = re.sub(pattern, words, text, flags=re.MULTILINE)
    text = text.replace("floor(", f"{function_name('floor', exported.contract.precision)}(")
    reals = {"cell": cycle.cell, "slopes": cycle.slopes, "coefficients": cycle.coefficients}
    for name, values in reals.items():
        text += _array("casadi_real", name, map(exported.number, values.ravel().tolist()))
    for name, values in {"order": cycle.layout.order, "runs": cycle.layout.runs}.items():
        text += _array("int", name, map(str, values.ravel().tolist()))
    return "\n" + text


def table_call(cycle: CycleTable, number: Format) -> Iterable[str]:
    """Statements that read the columns ``y`` from a table, for what the drive's own graph gave."""
    phase = f"drive[{2 + cycle.turns}]"
    yield (
        f"interpolate(1, 1, &{phase}, drive + 1, drive + 2, {cycle.nodes}, cell,"
        f" {cycle.coefficients.shape[1]}, coefficients, {len(cycle.columns)}, order, slopes,"
        f" {len(cycle.layout.runs)}, runs, y);"
    )
    for k in np.flatnonzero(cycle.drift):
        yield f"y[{k}] = y[{k}] + {number(cycle.drift[k])}*(drive[0] - {phase});"


def _array(kind: str, name: str, numbers: Iterable[str]) -> str:
    words = [*numbers]
    rows = (", ".join(words[i : i + _LINE]) for i in range(0, len(words), _LINE))
    body = ",\n  ".join(rows) if words else "0"
    return f"static const {kind} {name}[] = {{\n  {body}\n}};\n"
