"""The functions of an exported program: what of a scene graph it evaluates, how much of it, and
from what constants.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ...base.arrays import Array
from ...base.quantities import Check, Column, Output
from ...base.scalars import column
from ...base.status import Status
from ...base.symbolic import symbolic
from ...base.vocabulary import Precision
from ...engine.codegen.emit import hoisted
from ...engine.codegen.printer import Format, literal
from ...engine.codegen.stages import controlled
from ...engine.dead_centres import CLOSURES
from ...engine.instants.cycle_table import CycleTable
from ...engine.instants.from_table import drive_of
from ...engine.instants.tabulate import still
from ...engine.program import Program
from ...engine.section_function import SectionInputs, section
from ...model.limits import END
from .contract import Contract
from .exported_calls import CALLS
from .statuses import ANSWERS


@dataclass(frozen=True, eq=False)
class ExportedProgram:
    """Source of an exported program: the functions of a ``program`` that a ``contract`` offers.

    ``columns`` are those of a table or of ``functions``, in order. ``cycle`` is a table to be read
    instead of an instant, and ``still`` are stations that are given beside it, for they do not
    move. ``sections`` are, of each link that has them, the name of the function that gives its
    section forces, and what that takes. ``positive`` of the margins must be positive, others not
    negative; the mechanism's extent is the first of matter if ``extent_first``.
    """

    program: Program
    contract: Contract
    functions: Mapping[str, ca.Function]
    columns: tuple[Column, ...]
    newton: int | None
    cycle: CycleTable | None
    still: Mapping[Output, float]
    sections: Mapping[str, tuple[str, SectionInputs]]
    positive: int
    extent_first: bool

    @property
    def sizes(self) -> Counter[str]:
        """The lengths of the vectors that its functions fill or take, 0 of those that none does."""
        found = Counter[str]()
        for name in self.called(CALLS):
            found |= {vector: n for _, vector, n in CALLS[name].places(self.functions[name])}
        return found

    def called(self, calls: Iterable[str]) -> list[str]:
        """Return those of some functions that it has, in order."""
        return [name for name in calls if name in self.functions]

    @property
    def number(self) -> Format:
        """Literal of C for a number of the precision."""
        return literal(self.contract.precision)

    def column(self, output: str) -> str:
        """The column of an output, by its full name, as C and other languages write it; of what
        stands still its number.
        """
        named = Output.of(output)
        if named in self.still:
            return self.number(self.still[named])
        return f"y[{self.columns.index(named)}]"

    @property
    def guess(self) -> Sequence[float]:
        """The unknowns of iterated loops at which these begin."""
        newton = self.program.newton
        return newton.guess if newton is not None and "loops" in self.functions else ()

    def answers(self) -> Iterator[str]:
        """Answer for each rule that may be broken, by its number."""
        yield "OK"
        for rule, _ in self.program.rules:
            yield "UNDETERMINED" if rule.status == Status.OK else ANSWERS[rule.status]

    @property
    def zeros(self) -> list[float]:
        """Limits below which the squares of ``closing`` are zero within rounding."""
        program = self.program
        most = program.limits(self.contract.precision, self.newton, 0.0)
        return [
            float(limit) ** 2 if bound.beside == "BRANCH" else float(limit)
            for bound, limit in zip(program.bounds, most, strict=True)
            if bound.beside in CLOSURES
        ]


@symbolic
def exported(
    program: Program,
    contract: Contract,
    newton: int | None,
    p: Array,
    cycle: CycleTable | None,
) -> ExportedProgram:
    """The program of a graph; ``cycle`` is a table to be read for parameters ``p``, by the graph of
    the drive alone.
    """
    precision, fixed = contract.precision, cycle is not None
    evaluated = drive_of(program) if fixed else program
    stages = controlled(evaluated, precision, tuple(p.tolist()) if fixed else None)
    hidden = {*evaluated.checks("turns").values(), *evaluated.checks("multiplier").values()}
    kept = [k for k in range(len(evaluated.columns)) if k not in hidden]
    columns = program.columns if fixed else tuple(evaluated.columns[k] for k in kept)
    constants, instant = hoisted(stages.instant, kept)
    symbols = program.data.symbols
    gapped = not fixed and any(
        isinstance(column, Check) and column.kind in ("gap", "open") for column in columns
    )
    sound, positive = _sound(program, symbols, precision)
    given = {
        "law": stages.law,
        "count": stages.drive,
        "constants_of": constants,
        "matter": _mass_properties(program, symbols, extent_first=gapped),
        "beyond": program.laws.beyond,
    }
    if fixed:  # the parameters are numbers, which were checked when they were fixed
        given = {name: f if f is None else _fixed(f, p) for name, f in given.items()}
    of_sections, sections = _sections(program, symbols, precision)
    values = p if fixed else None
    functions = {
        **given,
        **of_sections,
        "sound": None if fixed else sound,
        "instant": instant,
        "status": (
            _status(program, columns, precision, newton, gapped, values) if program.rules else None
        ),
        "loops": stages.loops,
        "closing": stages.closing,
    }
    filled = {name: f for name, f in functions.items() if f is not None and f.size1_out(0)}
    return ExportedProgram(
        program,
        contract,
        filled,
        columns,
        newton,
        cycle=cycle,
        still=still(program, tuple(p.tolist())) if fixed else {},
        sections=sections,
        positive=positive,
        extent_first=gapped,
    )


def _status(
    program: Program,
    columns: Sequence[Column],
    precision: Precision,
    newton: int | None,
    gapped: bool,
    p: Array | None,
) -> ca.Function:
    """``status(y, matter, iterated)``, with the limits as numbers, of all columns; the extent is
    the first of matter if ``gapped``.

    What is read from a table has gaps between its nodes, which say nothing.
    """
    y, mass_properties, iterated = (
        ca.SX.sym("y", len(columns)),
        ca.SX.sym("matter", int(gapped)),
        ca.SX.sym("iterated"),
    )
    extent = mass_properties[0] if gapped else program.extent(p) if p is not None else 0.0
    most = program.limits(precision, newton, extent)
    most = [
        math.inf if bound.kind == "gap" and p is not None else limit
        for bound, limit in zip(program.bounds, most, strict=True)
    ]
    where = {column: k for k, column in enumerate(columns)}
    given = [y[where[program.columns[bound.column]]] for bound in program.bounds]
    sizes = [
        y[where[program.columns[bound.size]]] if bound.beside == "ROW" else 0.0
        for bound in program.bounds
    ]
    rule = program.status(*(column(each) for each in (given, most, sizes)), iterated)
    return ca.Function("status", [y, mass_properties, iterated], [ca.densify(rule)], {"cse": True})


def _fixed(function: ca.Function, p: Array) -> ca.Function:
    """A function with numbers for its parameters, which are its last input."""
    inputs = function.sx_in()
    return ca.Function(
        function.name(),
        [*inputs[:-1], ca.SX(0, 1)],
        function.call([*inputs[:-1], ca.DM(p)]),
        {"cse": True},
    )


def _mass_properties(program: Program, symbols: ca.SX, *, extent_first: bool) -> ca.Function:
    """``matter(p)``: of each link with sections its length, and the coefficients of its density per
    unit of the ratio.

    With ``extent_first`` the mechanism's extent comes before all of them, for the gaps of loops to
    be compared with.
    """
    found: list[Any] = [program.data.extent(symbols)] if extent_first else []
    for name in program.links:
        length, density = program.data.mass_properties(name, symbols)
        found += [length, *(c for cell in density.cells for c in cell)]
    return ca.Function("matter", [symbols], [ca.densify(column(found))])


def _sections(
    program: Program, symbols: ca.SX, precision: Precision
) -> tuple[dict[str, ca.Function], dict[str, tuple[str, SectionInputs]]]:
    """The functions that give section forces, by name; and of each link which of them does, and
    what that takes.
    """
    named: dict[Any, str] = {}
    functions: dict[str, Any] = {}
    found: dict[str, tuple[str, SectionInputs]] = {}
    for link in program.links:
        inputs = SectionInputs.of(program.outputs, link)
        _, density = program.data.mass_properties(link, symbols)
        kind = inputs.alike(), density.breaks, tuple(map(len, density.cells))
        if kind not in named:
            named[kind] = f"section_of_{len(named)}"
            functions[named[kind]] = section(*kind, END[precision], named[kind])
        found[link] = named[kind], inputs
    return functions, found


def _sound(program: Program, symbols: ca.SX, precision: Precision) -> tuple[ca.Function, int]:
    """``sound(p)``: what parameters change and must not be negative for the parts to be possible;
    and how many must be positive.

    Those come first.
    """
    both = program.data.margins[precision].in_order(symbols)
    positive, others = (
        [x for x in values if isinstance(x, ca.SX) and not x.is_constant()] for values in both
    )
    out = ca.densify(column([*positive, *others]))
    return ca.Function("sound", [symbols], [out], {"cse": True}), len(positive)
