"""Two runs, or two designs, side by side on one page: what is largest in each, their curves in one
chart, and both mechanisms in motion.

Each mechanism is a report within the page. Both pictures have one scale and one clock: they show
the same time, or where both runs are over the same joint, the same place of it.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ...base.arrays import Json
from ...errors import DeclarationError
from ...results.ordering import error_of, ordered
from ...results.solution import Solution
from .array_block import Arrays
from .instants import drive_entry, shown_instants
from .page import COMPARISON_SCRIPTS, assembled, page, script, viewer, write_page
from .page_contents import series_of
from .words import GROUPS, what


def write_comparison(
    solutions: Sequence[Solution], path: str | os.PathLike[str], names: Sequence[str] = ()
) -> None:
    """Write a page that shows two solutions side by side.

    Parameters
    ----------
    solutions
        Two solutions, with the motion of their bodies.
    path
        A file whose name ends in .html; it is replaced whole or not at all.
    names
        Names of the two on the page; by default their cases, or the parameters that differ.

    Raises
    ------
    DeclarationError
        For two that have no quantity in common.
    """
    first, second = solutions
    words = tuple(names) or _names(first, second)
    write_page(Path(path), lambda: _page((first, second), words))


def _page(solutions: tuple[Solution, Solution], names: Sequence[str]) -> str:
    rows = list(_rows(solutions))
    if not rows:
        raise DeclarationError(
            "report: nothing to compare: the two runs have no quantity in common"
        )
    arrays = Arrays()
    clock = _clock(solutions)
    cases = " and ".join(dict.fromkeys(solution.case for solution in solutions))
    content: dict[str, Json] = {
        "case": cases,
        "runs": [
            _run(solution, name, clock, arrays)
            for solution, name in zip(solutions, names, strict=True)
        ],
        "rows": rows,
        "groups": GROUPS,
        "clock": clock,
        "same": same_runs(*solutions),
        "arrays": arrays.places,
        "numbers": arrays.block(),
    }
    return assembled(
        f"{cases}: two runs",
        content,
        [script(name) for name in COMPARISON_SCRIPTS],
        others=[viewer(live=False)],
    )


def _run(solution: Solution, name: str, clock: Json, arrays: Arrays) -> dict[str, Json]:
    """One of the two: its curves, its parameters, and its page."""
    chosen = shown_instants(solution)
    return {
        "name": name,
        "case": solution.case,
        "certified": solution.certified,
        "t": arrays.add(solution.t[chosen]),
        "over": drive_entry(solution, chosen, arrays),
        "series": [*series_of(solution, chosen, arrays)],
        "parameters": {
            parameter: [entry.value, entry.unit]
            for parameter, entry in solution.description.parameters.items()
        },
        "frame": page(solution, clock=clock),
    }


def same_runs(first: Solution, second: Solution) -> bool:
    """Return whether two runs have the same instants, and the same values of all quantities."""
    return (
        np.array_equal(first.t, second.t)
        and first.outputs.keys() == second.outputs.keys()
        and all(
            np.array_equal(values, second.outputs[output], equal_nan=True)
            for output, values in first.outputs.items()
        )
    )


def _clock(solutions: tuple[Solution, Solution]) -> dict[str, Json]:
    """Time or the coordinate along which both runs are shown, and the ends of both times [s]."""
    first, second = (solution.over for solution in solutions)
    if first and second and (first.joint, first.unit) == (second.joint, second.unit):
        return {"name": "over"}
    times = [float(t) for solution in solutions for t in solution.t]
    return {"name": "t", "ends": [min(times), max(times)]}


def _rows(solutions: tuple[Solution, Solution]) -> Iterator[dict[str, Json]]:
    """The quantities that both have, each with its peaks and how far these may be off."""
    first, second = solutions
    others = {str(output) for output in ordered(second)}
    for output in ordered(first):
        if (
            str(output) not in others
            or first.unit(output) != second.unit(output)
            or not all(one.determined(output) for one in solutions)
        ):
            continue
        peaks = [solution.peak(output) for solution in solutions]
        yield {
            "name": str(output),
            "group": output.group,
            "part": output.part,
            "what": what(output, first.table),
            "unit": first.unit(output),
            "values": [peak.value + 0.0 for peak in peaks],
            "t": [peak.t for peak in peaks],
            "xi": [peak.xi for peak in peaks],
            "errors": [error_of(solution, output) for solution in solutions],
        }


def _names(first: Solution, second: Solution) -> tuple[str, str]:
    """Names to distinguish two solutions: their cases, otherwise the parameters that differ,
    otherwise numbers.
    """
    if first.case != second.case:
        return first.case, second.case
    values = [one.description.values for one in (first, second)]
    differ = [name for name, value in values[0].items() if value != values[1].get(name)]
    if not differ:
        return "first run", "second run"
    one, other = (
        ", ".join(f"{name} = {named[name]:.5g}" for name in differ[:3] if name in named)
        for named in values
    )
    return one, other
