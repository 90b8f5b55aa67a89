"""Strength in lines: stresses, factors of safety with what governs, lives."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence

from ..engine.section_stress import KINDS
from ..errors import DeclarationError
from ..model.scene import Scene
from ..model.wanted_names import among
from ..results.solution import Solution
from ..results.strength.all_parts import not_evaluated
from ..results.strength.safety import Life, Safety
from ..results.strength.stress import Stress, StressPeak
from ..studies.strength_peaks import refine_safety, refine_stress
from .report import NOT_FOUND, card, ratio

_BAR = 40
_GUESS = 1e3
"""Cycles below which a life is a guess."""


def strength_lines(
    solution: Solution, wanted: Sequence[str], scene: Scene | None = None
) -> Iterator[str]:
    """Write the strength of the parts that ``wanted`` names; of a part that is wanted as one of
    its kind and cannot be evaluated, the reason.

    Peaks are those of all times if the ``scene`` is given, else those of the instants.
    """
    beams = solution.description.beams
    if links := among("stress", beams, wanted):
        yield "stresses along the links, largest in size:"
        for link in links:
            yield from evaluated(link, lambda name: list(_stresses(solution, name, scene)))
    if parts := among("safety", [*beams, *solution.description.fitted], wanted):
        yield "factors of safety; utilisation is one over the least of them:"
        for part in parts:
            yield from evaluated(
                part, lambda name: list(safety_lines(_safety(solution, name, scene)))
            )
    if links := among("life", beams, wanted):
        yield f"lives, {solution.t[-1] - solution.t[0]:.5g} s repeated:"
        for link in links:
            yield from evaluated(link, lambda name: [_life(solution.life(name))])


def strength_cards(
    solution: Solution, wanted: Sequence[str], scene: Scene | None = None
) -> Iterator[str]:
    """Write the largest stress, the least factor of safety of each part, and the shortest life.

    What is ``wanted`` and ``scene`` are as in :func:`strength_lines`.
    """
    beams = solution.description.beams

    def stress(link: str) -> tuple[float, str]:
        peak = _stress_peak(solution, solution.stress(link), "von_mises", False, scene)
        return -peak.value, card("stress", _peak(link, peak))

    def life(link: str) -> tuple[float, str]:
        found = solution.life(link)
        return found.cycles, card("life", _life(found))

    yield from worst(among("stress", beams, wanted), stress)
    yield from worst(among("life", beams, wanted), life)
    if parts := among("safety", [*beams, *solution.description.fitted], wanted):
        yield "least factor of safety of each part:"
        for part in parts:
            yield from evaluated(part, lambda name: [_least(_safety(solution, name, scene))])


def not_evaluated_lines(solution: Solution, besides: Collection[str] = ()) -> Iterator[str]:
    """Lines on links and joints without figures and tables of strength, and the reasons, except
    those reported before.
    """
    for part, why in not_evaluated(solution).items():
        if part not in besides:
            yield f"note: no factor of safety of '{part}': {why}"


def safety_lines(found: Safety) -> Iterator[str]:
    """The factors of safety of a link, a bar of its utilisation first."""
    share = found.utilisation
    bar = "#" * min(_BAR, math.ceil(share * _BAR)) if math.isfinite(share) else "#" * _BAR
    fails = ", FAILS" if share > 1.0 else ""
    yield f"  {found.link:<20} {share:>8.4g} |{bar:<{_BAR}}| {found.governs.against} governs{fails}"
    for verdict in found.verdicts:
        yield f"    {verdict.against:<18} {verdict.factor:>8.4g} {verdict.where}"
    for word in found.not_evaluated:
        yield f"    not evaluated: {word}"


def evaluated(part: str, lines: Callable[[str], Sequence[str]]) -> Iterator[str]:
    """Write the lines of a part, or why it cannot be evaluated."""
    try:
        yield from lines(part)
    except DeclarationError as error:
        yield f"  {part:<20} not evaluated: {error}"


def worst(parts: Sequence[str], find: Callable[[str], tuple[float, str]]) -> Iterator[str]:
    """Write the line of the part whose number is least, and why others cannot be evaluated."""
    found, failures = [], []
    for part in parts:
        try:
            found.append(find(part))
        except DeclarationError as error:
            failures.append(f"  {part:<20} not evaluated: {error}")
    if found:
        yield min(found)[1]
    yield from failures


def _least(found: Safety) -> str:
    governs = found.governs
    fails = ", FAILS" if governs.factor < 1.0 else ""
    return f"  {found.link:<15} {governs.factor:>8.4g} {governs.against}{fails}: {governs.where}"


def _safety(solution: Solution, part: str, scene: Scene | None) -> Safety:
    if scene is None or part in solution.description.joints:
        return solution.safety(part)
    return refine_safety(scene, solution, part)


def _stresses(solution: Solution, link: str, scene: Scene | None) -> Iterator[str]:
    stress = solution.stress(link)
    asked = [(kind, False) for kind in KINDS] + [("von_mises", True)] * bool(
        stress.member.beam.notches
    )
    for kind, notches in asked:
        yield _peak(link, _stress_peak(solution, stress, kind, notches, scene))


def _stress_peak(
    solution: Solution, stress: Stress, kind: str, notches: bool, scene: Scene | None
) -> StressPeak:
    if scene is None:
        return stress.peak(kind, notches=notches)
    return refine_stress(scene, solution, stress.member.link, kind, notches=notches)


def _peak(link: str, peak: StressPeak) -> str:
    where = (
        f"t = {peak.t:.5g} s, xi/l = {ratio(peak.xi)},"
        f" {peak.fibre}{', with the factors of its notch' if peak.notch else ''}"
    )
    least = peak.least
    value = f"{peak.value / 1e6 + 0.0:.6g}" if least is None else f">= {least / 1e6:.6g}"
    more = "" if least is None else NOT_FOUND
    return f"  {f'stress:{link}:{peak.kind}':<28} {value:>12} MPa  at {where}{more}"


def _life(found: Life) -> str:
    if math.isinf(found.cycles):
        return (
            f"  {f'life:{found.link}':<28}  infinite: no stress cycle is above the endurance limit;"
            f" nearest at xi/l = {ratio(found.xi)}, {found.fibre}"
        )
    guess = ", an estimate: the S-N line begins at 1000 cycles" if found.cycles < _GUESS else ""
    return (
        f"  {f'life:{found.link}':<28} {found.cycles:>12.4g} cycles, {found.hours:.4g} h, at xi/l ="
        f" {ratio(found.xi)}, {found.fibre}{guess}"
    )
