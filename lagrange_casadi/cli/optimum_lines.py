"""Console output of a search for designs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from ..base.table_writers import aligned
from ..studies.optimise import Front, Optimum
from ..studies.optimise.front import FrontPoint
from ..studies.sweep.axes import counted

_RELAXED = " per SI unit by which it is relaxed"


def optimum_lines(found: Optimum) -> Iterator[str]:
    """Lines of a search's result."""
    yield (
        f"{found.case}: {found.minimised} = {found.objective:.8g} {found.unit} at"
        f" {_design(found.values, 8)}"
    )
    if found.stopped:
        yield "stopped: the best design so far; --resume continues"
    for limit in found.limits:
        excess = limit.constraint.excess(limit.value)
        kept = (
            "active" if limit.active else f"VIOLATED by {excess:.4g}" if excess > 0.0 else "holds"
        )
        gain = f"; the objective falls by {limit.multiplier:.4g} {found.unit}{_RELAXED}"
        relaxed = gain if limit.active and found.feasible else ""
        yield f"  {limit.constraint}: {limit.value:.8g}, {kept}{relaxed}"
    for name, multiplier in found.bounds.items():
        if multiplier and found.feasible:
            end = "least" if multiplier < 0.0 else "largest"
            gain = f"{abs(multiplier):.4g} {found.unit}{_RELAXED}"
            yield f"  {name} is at its {end} value; the objective falls by {gain}"
    angle = (
        ""
        if math.isnan(found.transmission)
        else f", least sine of transmission angles {found.transmission:.4g}"
    )
    converged = sum(one.ending == "converged" for one in found.starts)
    yield (
        f"  {converged} of {len(found.starts)} starts converged, {found.evaluations} designs{angle}"
    )
    if found.feasible:
        yield f"  residual of the first-order conditions {found.residual:.1e}{_second(found)}"
    if len(found.optima) > 1:
        yield f"  {len(found.optima)} local optima:"
        yield from (
            f"    {one.objective:.8g} {found.unit} at {_design(one.values, 6)}, of"
            f" {counted(one.starts, 'start')}"
            for one in found.optima
        )
    if not found.feasible:
        yield "  no design that was found is within all limits"
    elif not found.converged:
        yield f"  not known to be an optimum: {found.start.ending}"
    yield from (f"  note: {note}" for note in found.notes)


def front_lines(front: Front) -> Iterator[str]:
    """The points of a front, a line each."""
    first, *others = front.minimised
    yield (
        f"{front.case}: {len(front.points)} designs, none of which is better in all of"
        f" {', '.join(map(str, front.minimised))}"
    )
    if front.stopped:
        yield "stopped: the front so far; --resume continues"
    heads = [f"{term} [{unit}]" for term, unit in zip(front.minimised, front.units, strict=True)]
    heads += [*(f"gain by {term.name}" for term in others), "at", ""]
    yield from aligned(heads, [*map(_cells, front.points)], left=(len(heads) - 2, len(heads) - 1))
    for point in front.points:
        for limit in point.optimum.limits:
            excess = limit.constraint.excess(limit.value)
            if not point.optimum.feasible and excess > 0.0:
                yield f"  {limit.constraint}: {limit.value:.8g}, VIOLATED by {excess:.4g}"
    yield (
        f"  gain: decrease of {first} per unit of the other objective; {front.evaluations} designs"
        " evaluated"
    )
    yield from (f"  note: {note}" for note in front.notes)


def _cells(point: FrontPoint) -> list[str]:
    """A row of the table of a front: objectives, gains, the design, and why it is no optimum."""
    optimum = point.optimum
    ending = optimum.start.ending if optimum.feasible else "beyond a limit"
    return [
        *(f"{value:.6g}" for value in point.objectives),
        *(f"{trade:.4g}" for trade in point.trades),
        _design(optimum.values, 6),
        "" if optimum.converged else ending,
    ]


def _second(found: Optimum) -> str:
    """The conditions of the second order, in words."""
    if math.isnan(found.curvature):
        return ""
    if math.isinf(found.curvature):
        bounds = all(value != 0.0 for value in found.bounds.values())
        return f", {'all parameters are at limits' if bounds else 'limits leave no parameter free'}"
    return f", least curvature {found.curvature:.3g}"


def _design(values: Mapping[str, float], digits: int) -> str:
    return ", ".join(f"{name} = {value:.{digits}g}" for name, value in values.items())
