"""Strength in lines: stresses, factors of safety with what governs, lives."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from functools import partial

from ..engine.section_stress import KINDS
from ..errors import DeclarationError
from ..model.scene import Scene
from ..model.wanted_names import among
from ..results.elastic.vibration import vibration
from ..results.solution import Solution
from ..results.strength.all_parts import not_evaluated
from ..results.strength.safety import Life, Safety
from ..results.strength.stress import StressPeak
from ..studies.strength_peaks import refine_safety, refine_stress
from .report import NOT_FOUND, card, ratio

_BAR = 40
_GUESS = 1e3
"""Cycles below which a life is a guess."""

_FROM = {"ends": "from the line between its ends", "base": "from its axis at the base"}


def strength_lines(
    solution: Solution, wanted: Sequence[str], scene: Scene | None = None
) -> Iterator[str]:
    """Write the strength and the deflection of the parts that ``wanted`` names; of a part that is
    wanted as one of its kind and cannot be evaluated, the reason.

    Peaks are those of all times if the ``scene`` is given, else those of the instants.
    """
    beams, fitted = solution.description.beams, solution.description.fitted
    tables = (
        ("stress", beams, "stresses along the links, largest in size:", _stresses),
        (
            "safety",
            [*beams, *fitted],
            "factors of safety; utilisation is one over the least of them:",
            _factors,
        ),
        ("life", beams, f"lives, {solution.t[-1] - solution.t[0]:.5g} s repeated:", _lives),
        ("deflection", beams, "deflections across the links, largest in size:", _deflections),
    )
    for kind, parts, title, lines in tables:
        if chosen := among(kind, parts, wanted):
            yield title
            for part in chosen:
                yield from evaluated(part, partial(lines, solution, scene))


def strength_cards(
    solution: Solution, wanted: Sequence[str], scene: Scene | None = None
) -> Iterator[str]:
    """Write the largest deflection and stress, the shortest life, and the least factor of safety of
    each part.

    What is ``wanted`` and ``scene`` are as in :func:`strength_lines`.
    """
    beams = solution.description.beams

    def deflection(link: str) -> tuple[float, str]:
        line = next(_deflections(solution, scene, link))
        return -solution.deflection(link).peak().value, card("deflection", line)

    def stress(link: str) -> tuple[float, str]:
        peak = _peaks(solution, scene, link)("von_mises")
        return -peak.value, card("stress", _peak(link, peak))

    def life(link: str) -> tuple[float, str]:
        found = solution.life(link)
        return found.cycles, card("life", _life(found))

    for kind, find in {"deflection": deflection, "stress": stress, "life": life}.items():
        yield from worst(among(kind, beams, wanted), find)
    if parts := among("safety", [*beams, *solution.description.fitted], wanted):
        yield "least factor of safety of each part:"
        for part in parts:
            yield from evaluated(part, lambda name: [_least(_safety(solution, scene, name))])


def not_evaluated_lines(solution: Solution, besides: Collection[str] = ()) -> Iterator[str]:
    """Lines on links and joints without figures and tables of strength, and the reasons, except
    those reported before.
    """
    yield from (
        f"note: no factor of safety of '{part}': {why}"
        for part, why in not_evaluated(solution).items()
        if part not in besides
    )


def safety_lines(found: Safety) -> Iterator[str]:
    """The factors of safety of a link, a bar of its utilisation first."""
    share = found.utilisation
    bar = "#" * math.ceil(min(1.0, share) * _BAR)
    fails = ", FAILS" if share > 1.0 else ""
    yield f"  {found.link:<20} {share:>8.4g} |{bar:<{_BAR}}| {found.governs.against} governs{fails}"
    yield from (
        f"    {verdict.against:<18} {verdict.factor:>8.4g} {verdict.where}"
        for verdict in found.verdicts
    )
    yield from (f"    not evaluated: {word}" for word in found.not_evaluated)


def evaluated(part: str, lines: Callable[[str], Iterable[str]]) -> Iterator[str]:
    """Write the lines of a part, or why it cannot be evaluated."""
    try:
        yield from list(lines(part))
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


def _safety(solution: Solution, scene: Scene | None, part: str) -> Safety:
    if scene is None or part in solution.description.joints:
        return solution.safety(part)
    return refine_safety(scene, solution, part)


def _factors(solution: Solution, scene: Scene | None, part: str) -> Iterator[str]:
    return safety_lines(_safety(solution, scene, part))


def _stresses(solution: Solution, scene: Scene | None, link: str) -> Iterator[str]:
    peak = _peaks(solution, scene, link)
    yield from (_peak(link, peak(kind)) for kind in KINDS)
    if solution.description.beams[link].notches:
        yield _peak(link, peak("von_mises", notches=True))


def _peaks(solution: Solution, scene: Scene | None, link: str) -> Callable[..., StressPeak]:
    """Return what finds the peak of a kind of stress: of all times, or of the instants."""
    if scene is None:
        return solution.stress(link).peak
    return partial(refine_stress, scene, solution, link)


def _peak(link: str, peak: StressPeak) -> str:
    where = (
        f"t = {peak.t:.5g} s, xi/l = {ratio(peak.xi)},"
        f" {peak.fibre}{', with the factors of its notch' if peak.notch else ''}"
    )
    least = peak.least
    value = f"{peak.value / 1e6 + 0.0:.6g}" if least is None else f">= {least / 1e6:.6g}"
    more = "" if least is None else NOT_FOUND
    return f"  {f'stress:{link}:{peak.kind}':<28} {value:>12} MPa  at {where}{more}"


def _lives(solution: Solution, _scene: Scene | None, link: str) -> Iterator[str]:
    yield _life(solution.life(link))


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


def _deflections(solution: Solution, _scene: Scene | None, link: str) -> Iterator[str]:
    found = solution.deflection(link)
    peak = found.peak()
    where = f"t = {peak.t:.5g} s, xi/l = {ratio(peak.xi)}, {_FROM[found.against]}"
    yield f"  {f'deflection:{link}':<28} {peak.value * 1e3 + 0.0:>12.6g} mm   at {where}"
    yield f"    {vibration(solution, link).words}"
