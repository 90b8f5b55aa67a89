"""The reduction of a design's instants to what is kept of it, and its C."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from string import Template
from typing import Any, get_args

import numpy as np

from ...base.arrays import Flags
from ...base.status import Status
from ...base.vocabulary import Precision
from ...model.limits import END
from ..compensated import DTYPES
from ..dead_centres import CLOSURES, FAR, POINTS, ROUNDS, TOUCHES
from ..program import Program
from ..sharpness import Watch
from ..verdicts import Beside
from .along_links import Along, along, pieces
from .calls import Call
from .compiler import written
from .peak_search import BASE, OFF, TIP, TOPS, Tables, interface
from .printer import defined, function_name, print_functions

DESIGNS = "lagrange_casadi_designs"
CALL = Call(
    "lagrange_casadi_designs_call",
    {
        "designs": "long long",
        "instants": "const lagrange_casadi_instants*",
        "t": "const double*",
        "t_apart": "long long",
        "p": "const double*",
        "hiding": "signed char*",
        "bent_apart": "long long",
        "search": "const lagrange_casadi_search_call*",
        "find": "lagrange_casadi_find*",
        "status": "signed char*",
        "value": "double*",
        "peak_t": "double*",
        "xi": "double*",
        "mean": "double*",
        "rms": "double*",
        "history": "real*",
        "iterated": "real*",
        "tops": "double*",
        "error": "double*",
        "near": "signed char*",
    },
)
"""Arguments of :data:`DESIGNS`; the C says which it reads and writes."""

_PLACES = {"BASE": BASE, "TIP": TIP, "OFF": OFF}


@dataclass(frozen=True, eq=False)
class Reduction:
    """Reduction of the instants of a design: the results that are kept, in numbers of columns.

    ``quantities`` off links are one column, or the size of a vector of two; then come the forces of
    each of ``links``. ``units`` numbers the units of all of them, ``efforts`` says which have
    means. ``checks`` are the columns of a graph's bounds and what these are seen beside, then the
    sizes of rows' terms; ``indeterminate_checks`` are the checks that leave a quantity open, by
    number of both. ``matter(p)`` gives first ``margins`` numbers that must not be negative,
    ``positive`` of them not zero either: the first is the mechanism's extent [m]. Then comes what
    ``pieces.c`` takes for each link, and the limits of bounds. ``watches`` are what the last
    columns are watched for, ``knots`` times of kinks, and ``depends`` (watches, quantities) which
    quantity depends on which watched function: see :class:`.Sharpness`. ``marks`` are of the
    columns after these, marks of motions and constraints (:class:`.Smooth`): whether they count at
    whole numbers.
    """

    quantities: tuple[tuple[int, ...], ...]
    links: tuple[Along, ...]
    units: tuple[int, ...]
    efforts: tuple[int, ...]
    checks: tuple[tuple[int, Beside], ...]
    indeterminate_checks: tuple[tuple[int, int], ...]
    mass_properties: Any
    positive: int
    margins: int
    watches: tuple[Watch, ...]
    knots: tuple[float, ...]
    depends: Flags
    marks: tuple[bool, ...]

    @property
    def watched(self) -> int:
        """Number of the last columns, which are no outputs."""
        return len(self.watches) + len(self.marks)

    @cached_property
    def curves(self) -> list[tuple[int, int, int]]:
        """Quantity of a curve, its link or -1, and its place, see :data:`.peak_search.CURVES`."""
        found = [(q, -1, OFF) for q in range(len(self.quantities))]
        q, first = len(self.quantities), 0
        for k, link in enumerate(self.links):
            for places in link.places:
                found += [
                    (q, k, _PLACES[place] if isinstance(place, str) else first + place)
                    for place in places
                ]
                q += 1
            first += link.rows
        return found

    @cached_property
    def places(self) -> int:
        """Rows of places along links."""
        return sum(link.rows for link in self.links)

    @cached_property
    def rows(self) -> int:
        """Rows of one design that are kept while it is evaluated, beside those of times and
        iterated coordinates.
        """
        return len(self.curves) + self.places + len(self.checks) + self.watched

    def tables(self, precision: Precision) -> Tables:
        """The curves as the search takes them."""
        return Tables.of(self.curves, self.units, self.watches, self.knots, self.depends, precision)


def reduced(program: Program, reduction: Reduction, precision: Precision) -> str:
    """The C that follows that of a scene's instants: :data:`DESIGNS`, and what it calls."""
    functions = {"matter_of": reduction.mass_properties, "status_of": program.status}
    return (
        print_functions(functions, precision, prefix="matter", packs=True)
        + interface()
        + CALL.text()
        + defined("DESIGNS", _macros(program, reduction, precision))
        + _tables(program, reduction)
        + "\n"
        + pieces(reduction.links)
        + _curves(reduction)
        + "\n"
        + written("designs.c").replace("DESIGNS_CENTRE\n", centre(1 + len(program.driven)), 1)
    )


def centre(slopes: int) -> str:
    """C of the rule of dead centres (:func:`.passes`), for so many slopes of a loop; the types
    ``centre_real`` and ``centre_step``, and ``centre_path``, stand before it.
    """
    values = {"points": POINTS, "rounds": ROUNDS, "far": int(FAR), "slopes": slopes}
    values |= {"least_order": int(TOUCHES[0]), "most_order": int(TOUCHES[1])}
    return Template(written("dead_centre.c")).substitute(values)


def _macros(program: Program, reduction: Reduction, precision: Precision) -> dict[str, object]:
    checks, curves = len(reduction.checks), len(reduction.curves)
    quantities = len(reduction.quantities) + sum(len(link.places) for link in reduction.links)
    numbers = np.finfo(DTYPES[precision])
    return {
        "ROOT": function_name("sqrt", precision),
        "HALF": "((lanes_real) 0.5)",
        "CLOSE": _real(math.sqrt(float(numbers.eps))),
        "LARGEST": _real(float(numbers.max)),
        "MATTER": max(1, reduction.mass_properties.size1_out(0)),
        "MARGINS": reduction.margins,
        "LIMITS": reduction.mass_properties.size1_out(0) - len(program.bounds),
        "POSITIVE": reduction.positive,
        "QUANTITIES": quantities,
        "CURVES": curves,
        "PLACES": reduction.places,
        "WATCHED": curves + reduction.places,
        "CHECKED": curves + reduction.places + len(reduction.watches),
        "WATCHES": len(reduction.watches),
        "MARKS": len(reduction.marks),
        "CHECKS": checks,
        "BOUNDS": len(program.bounds),
        "DOUBTS": len(reduction.indeterminate_checks),
        "EFFORTS": len(reduction.efforts),
        "CLOSINGS": sum(bound.beside in CLOSURES for bound in program.bounds),
        "SLOPES": 1 + len(program.driven),
        "POINTS": POINTS,
        "TOPS": TOPS,
        "END": _real(END[precision]),
        **{f"IS_{beside}": k for k, beside in enumerate(get_args(Beside)[1:])},
    }


def _real(value: float) -> str:
    return f"((lanes_real) {value:.17g})"


def _tables(program: Program, reduction: Reduction) -> str:
    columns, kinds = zip(*reduction.checks, strict=True) if reduction.checks else ((0,), ("",))
    sizes = itertools.count(len(program.bounds))
    sized = [next(sizes) if bound.beside == "ROW" else -1 for bound in program.bounds] or [-1]
    closings = itertools.count()
    closed = [next(closings) if bound.beside in CLOSURES else -1 for bound in program.bounds]
    statuses = [Status.OK, *(rule.status for rule, _ in program.rules)]
    breaks = [
        _table("lanes_real", f"designs_breaks{k}", map(_real, link.breaks))
        for k, link in enumerate(reduction.links)
        if not link.even
    ]
    shown_by, indeterminate = zip(*(reduction.indeterminate_checks or [(0, 0)]), strict=True)
    tables: dict[str, Iterable[float | str]] = {
        "checked": columns,
        "kind": (f"DESIGNS_IS_{kind}" if kind else -1 for kind in kinds),
        "sized": sized,
        "status": map(int, statuses),
        "effort": reduction.efforts or (0,),
        "whole": map(int, reduction.marks or (False,)),
        "doubted": shown_by,
        "doubtful": indeterminate,
    }
    tables |= {"closed": closed} if max(closed, default=-1) >= 0 else {}
    lines = [_table("int", f"designs_{name}", values) for name, values in tables.items()]
    return "".join([*lines, *breaks])


def _table(kind: str, name: str, values: Iterable[float | str]) -> str:
    return f"static const {kind} {name}[] = {{{', '.join(str(value) for value in values)}}};\n"


def _curves(reduction: Reduction) -> str:
    """The function that makes curves of columns."""
    lines = []
    for k, columns in enumerate(reduction.quantities):
        squares = " + ".join(f"y[{c}]*y[{c}]" for c in columns)
        lines.append(
            f"  value[{k}] ="
            f" {f'DESIGNS_ROOT({squares})' if len(columns) > 1 else f'y[{columns[0]}]'};\n"
        )
    value, place, offset = len(reduction.quantities), 0, reduction.margins
    for k, link in enumerate(reduction.links):
        lines.append(along(k, link, f"value + {value}, place + {place}", offset))
        value += sum(map(len, link.places))
        place += link.rows
        offset += 1 + (len(link.breaks) - 1) * link.terms
    return f"""
static void designs_curves(const casadi_real* y, const casadi_real* matter, unsigned long long need,
                           casadi_real* value, casadi_real* place) {{
  (void) matter; (void) need; (void) place;
{"".join(lines)}}}
"""
