"""Deflections in lines: how far links bend, and whether rigid links are enough."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..declare.description import beams_of
from ..declare.wanted_names import among
from ..elastic.vibration import vibration
from ..instants.solution import Solution
from .report import card, ratio
from .strength_lines import evaluated, worst

_FROM = {"ends": "from the line between its ends", "base": "from its axis at the base"}


def elastic_lines(solution: Solution, wanted: Sequence[str]) -> Iterator[str]:
    """Write the deflections that are wanted of links that have a beam, or why there are none."""
    if links := among("deflection", beams_of(solution.description), wanted):
        yield "deflections across the links, largest in size:"
        for link in links:
            yield from evaluated(link, lambda name: list(_lines(solution, name)))


def elastic_card(solution: Solution, wanted: Sequence[str]) -> Iterator[str]:
    """Write the largest deflection that is wanted."""

    def deflection(link: str) -> tuple[float, str]:
        line = next(_lines(solution, link))
        return -solution.deflection(link).peak().value, card("deflection", line)

    yield from worst(among("deflection", beams_of(solution.description), wanted), deflection)


def _lines(solution: Solution, link: str) -> Iterator[str]:
    found = solution.deflection(link)
    peak = found.peak()
    where = f"t = {peak.t:.5g} s, xi/l = {ratio(peak.xi)}, {_FROM[found.against]}"
    yield f"  {f'deflection:{link}':<28} {peak.value * 1e3 + 0.0:>12.6g} mm   at {where}"
    yield f"    {vibration(solution, link).words}"
