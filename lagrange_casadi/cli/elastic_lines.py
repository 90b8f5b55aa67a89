"""Deflections in lines: how far links bend, and whether rigid links are enough."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..declare.description import beams_of
from ..declare.wanted_names import among
from ..elastic.vibration import vibration
from ..instants.solution import Solution
from .strength_lines import told

_FROM = {"ends": "from the line between its ends", "base": "from its axis at the base"}


def elastic_lines(solution: Solution, wanted: Sequence[str]) -> Iterator[str]:
    """The deflections that are wanted of links that have a beam; or why they cannot be told."""
    if links := among("deflection", beams_of(solution.description), wanted):
        yield "deflections across the links, largest in size:"
        for link in links:
            yield from told(link, lambda name: list(_lines(solution, name)))


def _lines(solution: Solution, link: str) -> Iterator[str]:
    found = solution.deflection(link)
    peak = found.peak()
    where = f"t = {peak.t:.5g} s, xi/l = {peak.xi:.4f}, {_FROM[found.against]}"
    yield f"  {f'deflection:{link}':<28}{peak.value * 1e3 + 0.0:>13.6g} mm at {where}"
    yield f"    {vibration(solution, link).words}"
