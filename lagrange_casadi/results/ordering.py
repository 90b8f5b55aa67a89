"""The order in which a solution keeps its outputs, and in which they are listed, with how far each
may be off.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping

from ..base.arrays import Array
from ..base.quantities import Output
from ..base.tables import LARGEST, table_of
from ..model.description import Description
from .histories import Histories
from .solution import Solution


def in_order(outputs: Mapping[Output, Array], description: Description) -> dict[Output, Array]:
    """Outputs in the order in which a solution keeps them: by kind, then by part as declared, then
    as in the table.

    Raises ``ValueError`` for one of a part that is not declared.
    """
    order = _order(tuple(outputs), tuple(description.parts), description.space)
    return {output: outputs[output] for output in order}


@functools.lru_cache(maxsize=64)
def _order(outputs: tuple[Output, ...], parts: tuple[str, ...], space: bool) -> list[Output]:
    """Outputs in the order of :func:`in_order`."""
    table = table_of(space)
    rows = table.rows
    groups = list(dict.fromkeys(q.group for q in rows))
    sections = groups.index("section")

    def rank(output: Output) -> tuple[int, int, str, str, int, int]:
        group = sections if output.along else groups.index(output.group)
        part, _, axis = output.part.partition(":")
        return (
            group,
            parts.index(part),
            axis,
            output.load_point,
            rows.index(output.meant(table)),
            output.power or 0,
        )

    return sorted(outputs, key=rank)


ON_PARTS = ("load", "friction")
"""The groups of what single elements bear: however many quantities there are, all are listed."""

_GROUPS = ("effort", "reaction", "friction", "section", *LARGEST, "output")


def ordered(histories: Histories) -> Iterator[Output]:
    """Efforts, reactions with their resultants, how large loads are, section forces, what is
    largest along links, and own outputs.
    """
    description = histories.description
    for output in histories.quantities():
        if output.group in _GROUPS:
            yield output
            for member in histories.table.reactions:
                resultant = Output("reaction", output.part, member)
                if output == histories.made_of(resultant)[-1]:
                    yield resultant
        elif output.group == "load" and output.member == "fx":
            size = description.loads[output.part].size
            if size:
                planar = size == "moment" and not description.space
                yield Output("load", output.part, "mz" if planar else size)


def error_of(solution: Solution, name: str | Output) -> float | None:
    """Error bound of a quantity, in its unit, or None; that of a force's size is at most the sum of
    its components'.
    """
    errors = [
        solution.errors.get(str(component)) for component in solution.made_of(Output.of(name))
    ]
    known = [error for error in errors if error is not None]
    return math.hypot(*known) if len(known) == len(errors) else None


def vanishes(solution: Solution, name: str | Output) -> bool:
    """Return whether a quantity is zero but for rounding, by the estimate of its error."""
    error = error_of(solution, name)
    return error is not None and abs(solution.peak(name).value) <= 2.0 * error
