"""Sensitivities of peaks to parameters, in lines."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ..base.quantities import AVERAGED, Output
from ..base.vocabulary import Backend
from ..declare.scene import Scene
from ..errors import DeclarationError
from ..instants.ordering import ordered
from ..instants.solution import Solution
from ..sensitivity.peaks import PeakKind
from ..studies.sensitivities import Changes, sensitivities

_WIDTH = 13
_WORDS = {
    PeakKind.END: "at an end of the instants",
    PeakKind.SWITCH: "at a kink or a jump",
    PeakKind.LINK_END: "at an end of the link",
    PeakKind.UNKNOWN: "at a kink or a jump of unknown origin",
}


def slope_lines(solution: Solution, scene: Scene, backend: Backend) -> Iterator[str]:
    """The derivatives of the peaks and means that a run prints, if sensitivities were wanted: a
    column for each parameter.
    """
    by = solution.sensitivities.parameters
    names = [str(output) for output in ordered(solution) if solution.determined(output)]
    if not by or not names:
        return
    try:
        found = sensitivities(scene, solution, backend=backend)
        changes = found.peaks(names)
    except DeclarationError as error:  # of a table that is very rough
        yield f"derivatives of peaks are not available: {error}"
        return
    units = {name: solution.description["parameters"][name]["unit"] for name in by}
    yield "derivatives of peaks, between the instants too, per unit of"
    yield f"{'':<30}" + " ".join(f"{f'{name} [{units[name]}]':>{_WIDTH}}" for name in by)
    for name, change in zip(names, changes, strict=True):
        yield _line(name, change, by)
    averaged = [name for name in names if Output.of(name).group in AVERAGED]
    if averaged:
        yield "derivatives of means over time and of root mean squares"
    for name in averaged:
        yield _line(f"mean:{name}", found.mean(name), by)
        yield _line(f"rms:{name}", found.rms(name), by)


def _line(name: str, change: Changes, by: tuple[str, ...]) -> str:
    cells = [
        f"{slope + 0.0:.6g}" if math.isfinite(slope) else "none"
        for slope in (change.slopes[parameter] for parameter in by)
    ]
    where = _WORDS.get(change.kind) if change.kind is not None else None
    if change.tied:
        where = f"{where + ', ' if where else ''}equally large elsewhere, with other derivatives"
    return (
        f"  {name:<28}"
        + " ".join(f"{cell:>{_WIDTH}}" for cell in cells)
        + (f"  {where}" if where else "")
    )
