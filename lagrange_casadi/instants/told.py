"""What is told of a solution wherever its results are listed: which quantities, in which order, and how far each may be off."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ..base.quantities import Output
from ..base.tables import LARGEST
from .solution import Solution

_GROUPS = ("effort", "reaction", "friction", "section", *LARGEST, "output")


def told(solution: Solution) -> Iterator[Output]:
    """Efforts, reactions with their resultants, section forces, what is largest along links, and own outputs."""
    for output in solution.quantities():
        if output.group in _GROUPS:
            yield output
            for member in solution.table.reactions:
                resultant = Output("reaction", output.part, member)
                if output == solution.made_of(resultant)[-1]:
                    yield resultant


def error_of(solution: Solution, name: str | Output) -> float | None:
    """How far a quantity may be off, in its unit, or None; the size of a force by no more than its components together."""
    errors = [solution.errors.get(str(component)) for component in solution.made_of(Output.of(name))]
    known = [error for error in errors if error is not None]
    return math.hypot(*known) if len(known) == len(errors) else None
