"""How long an evaluation takes, before it begins: counted, not measured, so that it is the same everywhere."""

from __future__ import annotations

from ..equations.program import Program
from .rung import Rung

_RATE, _RATE_INTERPRETED = 3e9, 3e6
"""Instructions a second of a core."""


def seconds(graph: Program, instants: float, rung: Rung, *, interpreted: bool) -> float:
    """Seconds that a core takes for so many instants, within a factor of three or so; ``interpreted`` is by the virtual machine."""
    counts = graph.instructions
    steps = counts.pop("loops", 0) * (rung.newton or 1)
    return (sum(counts.values()) + steps) * instants / (_RATE_INTERPRETED if interpreted else _RATE)
