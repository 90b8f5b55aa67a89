"""Derivatives of the outputs by parameters in an exported program: their function, their names in
C, and what they must be.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output, quotient
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.program import Program
from ...errors import DeclarationError
from ...model.wanted_names import SENSITIVITY
from ...results.sensitivity.jacobian import total
from ...results.sensitivity.series import at_instants
from .contract import Contract, Member
from .exported_calls import call
from .text import comment, indented, member, template

FUNCTION = "slopes_of"
"""Name of CasADi's function in C."""

_ROUNDING, _FAINT = 1e-9, 1e-11
"""Relative error of a derivative, of its largest value over the cycle, and of the largest
derivative of its unit by the same parameter.
"""


@dataclass(frozen=True, eq=False)
class ExportedSlopes:
    """The derivatives of all outputs of a contract ``by`` some of its parameters, or by none.

    ``function`` is :func:`.total`; ``expected`` (instants, derivatives) are what it must give at
    the instants of the self-test, each within ``off`` (derivatives): of each output those by all
    parameters.
    """

    by: tuple[Member, ...] = ()
    function: Any = None
    expected: Sequence[Array] = ()
    off: Sequence[float] = ()


def exported_slopes(
    program: Program, contract: Contract, by: Sequence[str], p: Array, t: Array, chosen: Array
) -> ExportedSlopes:
    """Derivatives of a graph by parameters of these names; the self-test's instants are ``chosen``
    among those of the cycle ``t``.
    """
    rows = [Output.of(member.source) for member in contract.outputs]
    numbers = [list(program.data.parameters).index(name) for name in by]
    function = total(program, [program.outputs[output] for output in rows], numbers)
    both = at_instants(program, rows, t, p, numbers, EvaluationMethod("vm"))
    found, largest = both[:, :, 1:], np.abs(both).max(axis=0)
    values, largest = largest[:, :1], largest[:, 1:]
    off = _ROUNDING * largest
    over = np.divide(1.0, np.abs(p[numbers]), out=np.zeros(len(numbers)), where=p[numbers] != 0.0)
    for unit in {one.unit for one in contract.outputs}:
        same = [k for k, member in enumerate(contract.outputs) if member.unit == unit]
        off[same] += _FAINT * (largest[same].max(axis=0) + values[same].max() * over)
    settings = tuple(setting for setting in contract.settings if setting.source in by)
    expected = [at.ravel() for at in found[np.searchsorted(t, chosen)]]
    return ExportedSlopes(settings, function, expected, off.ravel().tolist())


def check_method(method: EvaluationMethod) -> None:
    """Raise :class:`.DeclarationError` for a method by which exported C computes no derivatives."""
    if method.precision == "single" or method.newton is not None or method.table is not None:
        raise DeclarationError(
            f"export: output '{SENSITIVITY}' needs double precision, no Newton steps and no table;"
            " leave it out of wanted"
        )


def changes(c: Contract, slopes: ExportedSlopes) -> Iterator[str]:
    """Yield the members of the struct that has the derivatives of an output."""
    for s in slopes.by:
        yield member(c.prefix, s.name, f"by {s.meaning}, for a unit of it [{s.unit}]")


def sensitivities(c: Contract, slopes: ExportedSlopes) -> Iterator[str]:
    """Yield the members of the struct that has such a struct for each output."""
    for m in c.outputs:
        units = "; ".join(quotient(m.unit, s.unit) for s in slopes.by)
        yield f"  {c.prefix}_changes {m.name}; /* [{comment(units)}] */"


def code(c: Contract, slopes: ExportedSlopes) -> str:
    """The function, for the source."""
    pairs = itertools.product(c.outputs, slopes.by)
    put = (f"sensitivities->{m.name}.{s.name} = s[{k}];" for k, (m, s) in enumerate(pairs))
    return template(
        "sensitivity.c",
        **c.words,
        many=len(c.outputs) * len(slopes.by),
        drives=len(c.drives),
        put=indented(put),
        given=indented(f"  {line}" for line in _given(c, slopes)),
    )


def _given(c: Contract, slopes: ExportedSlopes) -> Iterator[str]:
    for name, members in zip(("d", "rate", "acceleration"), c.motion, strict=True):
        yield from (f"{name}[{k}] = inputs->{member};" for k, member in enumerate(members))
    yield from call({FUNCTION: slopes.function}, FUNCTION)


def compared(c: Contract, slopes: ExportedSlopes) -> Iterator[str]:
    """Yield the comparisons of the self-test."""
    for i, (m, s) in enumerate(itertools.product(c.outputs, slopes.by)):
        yield (
            f'compare("{m.name} by {s.name}", slopes_at[k][{i}], (double) found.{m.name}.{s.name},'
            f" slopes_off[{i}], 0);"
        )
