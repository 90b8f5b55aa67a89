"""The figures that a sweep has unless others are asked for: which columns together, over which
parameters, by what names.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from ...base.quantities import Output
from ...errors import DeclarationError, NoDesignError, check_known
from ...studies.sweep.axes import DESIGN
from ...studies.sweep.reading import Sweep
from .designs import draw_along, draw_front, draw_peaks
from .panels import varied

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_INTERVALS, _ROWS, _ACROSS = 9, 4, 3
_TOGETHER = {"effort": "effort", "load": "loads", "multiplier": "multipliers", "motion": "motion"}


def default_plots(
    sweep: Sweep,
    over: Sequence[str],
    at: Mapping[str, float],
    against: Sequence[tuple[str, str]],
) -> dict[str, Callable[[Sweep], Figure]]:
    """The usual drawings of a sweep, by their names: over the one or two parameters given, or the
    first ones that vary, the others ``at`` values.

    Of a list they are over each of the parameters named, or over all. Raises
    :class:`UnknownNameError` for what is not there, :class:`NoDesignError` where no design has a
    result, :class:`DeclarationError` for more than two parameters of a grid, for one that does not
    vary, is in ``over`` twice or in ``at`` as well, for a value that no design has, and where
    nothing can be drawn.
    """
    names = _over(sweep, tuple(over), at)
    counts = sweep.counts()
    if not counts.get(0):
        why = "; ".join(
            f"{count} x {sweep.statuses[status][1]}" for status, count in counts.items() if count
        )
        raise NoDesignError(
            f"{sweep.path}: no design has a result ({why}): there is nothing to draw"
        )
    listed = DESIGN in sweep.dimensions
    found: dict[str, Callable[[Sweep], Figure]] = {}
    free = [name for name in varied(sweep.select(**at)) if name not in names]
    family = free[0] if free and len(names) == 1 and not listed else ""
    rows, across = (_ROWS, _ACROSS) if listed else (_INTERVALS, 2)
    for group, columns in _groups(sweep).items() if names else ():
        pages = [*product(_pages(columns, rows), _pages(names, across))]
        for k, (some, few) in enumerate(pages, 1):
            name = f"peak_{group}_{k}" if len(pages) > 1 else f"peak_{group}"
            found[name] = partial(draw_peaks, columns=some, over=few, family=family, at=at)
    links = dict.fromkeys(output.part for output in _of_kind(sweep, "peak_at").values())
    for link in () if listed else links:
        along = (names or tuple(sweep.dimensions))[0]
        found[f"along_{link}"] = partial(draw_along, link=link, over=along, at=at)
    for first, second in dict.fromkeys(against) or usual_pair(sweep, at):
        for name in (first, second):
            if name not in sweep.parameters and sweep.column(name).axes:
                raise DeclarationError(
                    f"column '{name}' has no single value of a design to draw against another"
                )
        if first == second:
            raise DeclarationError(
                f"expected two columns to draw against each other, got '{first}' twice"
            )
        name = f"front_{first}_{second}".replace(":", "-")
        found[name] = partial(draw_front, pair=(first, second), at=at)
    if not found:
        why = (
            "it has only one design"
            if sweep.select(**at).size == 1
            else "it keeps no peak of an effort, a reaction, a section force or a load"
        )
        raise DeclarationError(f"{sweep.path}: there is nothing to draw: {why}")
    return found


def _over(sweep: Sweep, over: tuple[str, ...], at: Mapping[str, float]) -> tuple[str, ...]:
    """The parameters to draw over; none where nothing varies."""
    check_known("swept parameter", (*over, *at), sweep.parameters)
    sweep.select(**at)
    changed, listed = varied(sweep), DESIGN in sweep.dimensions
    for name in over:
        if name in at:
            raise DeclarationError(
                f"parameter '{name}' cannot be drawn over and stay at {at[name]:g} as well"
            )
        if over.count(name) > 1:
            raise DeclarationError(f"over: parameter '{name}' is listed twice")
        if name not in changed:
            others = f"; those that vary: {', '.join(changed)}" if changed else ""
            raise DeclarationError(
                f"parameter '{name}' cannot be drawn over: it is {sweep[name][0]:g} in all"
                f" designs{others}"
            )
    if len(over) > 2 and not listed:
        raise DeclarationError(
            f"a grid is drawn over one parameter or two, got {len(over)}: {', '.join(over)}"
        )
    free = tuple(name for name in changed if name not in at)
    return over or (free if listed else free[:2])


def _groups(sweep: Sweep) -> dict[str, list[str]]:
    """The columns that are drawn together, by what the file's name says."""
    groups: dict[str, list[str]] = {}
    moment = "moment" if sweep.description.space else "mz"
    reactions = {"resultant": "reactions", moment: "reaction_moments"}
    for name, output in _of_kind(sweep, "peak").items():
        together = _TOGETHER | {
            "section": f"section_{output.part}",
            "reaction": reactions.get(output.member, ""),
        }
        if group := together.get(output.group):
            groups.setdefault(group, []).append(name)
    return groups


def _of_kind(sweep: Sweep, kind: str) -> dict[str, Output]:
    """The columns of a kind, and what they are of."""
    named = ((name, *name.split(":", 1)) for name in sweep.columns if ":" in name)
    return {name: Output.of(of) for name, prefix, of in named if prefix == kind}


def usual_pair(sweep: Sweep, at: Mapping[str, float]) -> list[tuple[str, str]]:
    """An effort, or else an axial force, and the bending moment of the last link, in the order of
    the mechanism.
    """
    peaks = {output: name for name, output in _of_kind(sweep, "peak").items()}
    first = next(
        (
            name
            for output, name in peaks.items()
            if output.group == "effort" or output.member == "axial"
        ),
        "",
    )
    bending = [Output("section", body, "bending") for body in sweep.description.bodies]
    second = next((peaks[output] for output in reversed(bending) if output in peaks), "")
    return [(first, second)] if first and second and sweep.select(**at).size > 1 else []


def _pages(items: Sequence[str], most: int) -> list[tuple[str, ...]]:
    """Split items into as few even parts as hold no more than ``most``."""
    count = -(-len(items) // most)
    return [tuple(part) for part in np.array_split(np.array(items, object), count)]
