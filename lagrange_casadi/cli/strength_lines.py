"""Strength in lines: stresses, factors of safety with what governs, lives."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence

from ..declare.description import beams_of, fitted_of
from ..declare.scene import Scene
from ..declare.wanted_names import among
from ..equations.stress import KINDS
from ..errors import DeclarationError
from ..instants.solution import Solution
from ..strength.parts import untold
from ..strength.safety import Life, Safety
from ..strength.stress import StressPeak
from ..studies.strength_peaks import refine_safety, refine_stress

_BAR = 40
_GUESS = 1e3
"""Cycles below which a life is a guess."""


def strength_lines(
    solution: Solution, wanted: Sequence[str], scene: Scene | None = None
) -> Iterator[str]:
    """Lines of strength outputs of links that have a beam; of an output that is not asked for by
    name, why it is not available.

    With its ``scene`` it is that of all times, else that of the instants.
    """
    beams = beams_of(solution.description)
    if links := among("stress", beams, wanted):
        yield "stresses along the links, largest in size:"
        for link in links:
            yield from told(link, lambda name: list(_stresses(solution, name, scene)))
    if links := among("safety", [*beams, *fitted_of(solution.description)], wanted):
        yield "factors of safety, and utilisation, which is one over the least of them:"
        for link in links:
            yield from told(link, lambda name: list(safety_lines(_safety(solution, name, scene))))
    if links := among("life", beams, wanted):
        yield f"lives, {solution.t[-1] - solution.t[0]:.5g} s repeated:"
        for link in links:
            yield from told(link, lambda name: [_life(solution.life(name))])


def untold_lines(solution: Solution, besides: Collection[str] = ()) -> Iterator[str]:
    """Lines on links and joints without figures and tables of strength, and the reasons, except
    those reported before.
    """
    for part, why in untold(solution).items():
        if part not in besides:
            yield f"note: no factor of safety of '{part}' is told: {why}"


def safety_lines(found: Safety) -> Iterator[str]:
    """The factors of safety of a link, a bar of its utilisation first."""
    share = found.utilisation
    bar = "#" * min(_BAR, math.ceil(share * _BAR)) if math.isfinite(share) else "#" * _BAR
    fails = ", FAILS" if share > 1.0 else ""
    yield f"  {found.link:<20} {share:>8.4g} |{bar:<{_BAR}}| {found.governs.against} governs{fails}"
    for verdict in found.verdicts:
        yield f"    {verdict.against:<18} {verdict.factor:>8.4g} {verdict.where}"
    for word in found.is_open:
        yield f"    open: {word}"


def told(link: str, lines: Callable[[str], Sequence[str]]) -> Iterator[str]:
    """The lines of a link, or why they cannot be told."""
    try:
        yield from lines(link)
    except DeclarationError as error:
        yield f"  {link:<20} {'open':>8} {error}"


def _safety(solution: Solution, part: str, scene: Scene | None) -> Safety:
    if scene is None or part in solution.description["joints"]:
        return solution.safety(part)
    return refine_safety(scene, solution, part)


def _stresses(solution: Solution, link: str, scene: Scene | None) -> Iterator[str]:
    stress = solution.stress(link)
    asked = [(kind, False) for kind in KINDS] + [("von_mises", True)] * bool(
        stress.member.beam.notches
    )
    for kind, notches in asked:
        if scene is None:
            yield _peak(link, stress.peak(kind, notches=notches))
        else:
            yield _peak(link, refine_stress(scene, solution, link, kind, notches=notches))


def _peak(link: str, peak: StressPeak) -> str:
    where = (
        f"t = {peak.t:.5g} s, xi/l = {peak.xi:.4f},"
        f" {peak.fibre}{', with the factors of its notch' if peak.notch else ''}"
    )
    if peak.least is not None:
        return (
            f"  {f'stress:{link}:{peak.kind}':<28}{'not told':>13} at least {peak.least / 1e6:.6g}"
            f" MPa at {where}"
        )
    return f"  {f'stress:{link}:{peak.kind}':<28}{peak.value / 1e6 + 0.0:>13.6g} MPa at {where}"


def _life(found: Life) -> str:
    if math.isinf(found.cycles):
        return (
            f"  {found.link:<20}  endless: no swing is above the endurance limit; nearest at xi/l ="
            f" {found.xi:.4f}, {found.fibre}"
        )
    guess = ", a guess: the S-N line begins at 1000 cycles" if found.cycles < _GUESS else ""
    return (
        f"  {found.link:<20} {found.cycles:>8.4g} cycles, {found.hours:.4g} h, at xi/l ="
        f" {found.xi:.4f}, {found.fibre}{guess}"
    )
