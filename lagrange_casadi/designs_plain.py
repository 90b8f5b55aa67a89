"""What is kept of a design where there is no compiler: the same as the emitted C keeps, by CasADi's virtual machine and NumPy."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .backends import follow, run
from .codegen.designs import NOTHING, POLE, ROUNDING
from .codegen.emit import NOT_CONVERGED
from .density import Array, Density, NumericDensity
from .designs_plan import Kept
from .determinacy import undetermined
from .mechanism import Mechanism
from .mobility import LAW
from .refusal import Status, refusal
from .rung import Rung
from .scene_graph import SceneGraph
from .section_law import FORCES, SectionLaw, StationLoad

_CUTS, _ROUNDS = 8, 20
_EACH, _SAME = 8, 1e-6


@dataclass(frozen=True, eq=False)
class Row:
    """What is kept of a design that has a result: peaks (3, q) as value, time and ratio, means (2, e), and columns (columns, t)."""

    peaks: Array
    means: Array
    columns: Array


def outcome(graph: SceneGraph, kept: Kept, t: Array, p: Array, newton: int | None) -> tuple[Status, Row | None]:
    """What is kept of a design, or why it has no result."""
    if not np.isfinite(p).all():
        return Status.INVALID, None
    plan = kept.plan
    margins = plan.matter(p).full().ravel()[: plan.margins]
    if not (np.isfinite(margins).all() and (margins >= 0.0).all() and (margins[: plan.positive] > 0.0).all()):
        return Status.IMPOSSIBLE, None
    rung = Rung("vm", newton=newton)
    table, _ = run(graph, t, p, rung)
    why = refusal(graph, table, t, p, rung)
    if why is not None:
        return why.status, None
    mechanism = graph.scene.mechanism
    matter = _matter(kept, mechanism, dict(zip(mechanism.parameters, p.tolist(), strict=True)))
    design = _Design(graph, kept, t, p, newton, table.iterated, matter)
    efforts = table.out[[graph.columns.index(name) for name in kept.efforts]]
    with np.errstate(all="ignore"):
        peaks, means = design.peaks(table.out), np.stack(_means(efforts))
    left_open = undetermined(graph, table.out, p, rung)
    rows = [graph.doubtful[name] for name in left_open]
    for check, quantity in plan.doubts:
        if plan.checks[check][0] in rows:
            peaks[:, quantity] = np.nan
            means[:, [effort == quantity for effort in plan.efforts]] = np.nan
    return Status.OK, Row(peaks, means, table.out)


def _means(rows: Array) -> tuple[Array, Array]:
    """Mean and root of the mean square over time, by trapezia."""
    weights = np.ones(rows.shape[1])
    weights[[0, -1]] = 0.5 if rows.shape[1] > 1 else 1.0
    weights /= weights.sum()
    return rows @ weights, np.sqrt(rows**2 @ weights)


@dataclass(frozen=True, eq=False)
class _Design:
    """One design, and what its quantities are at any time."""

    graph: SceneGraph
    kept: Kept
    t: Array
    p: Array
    newton: int | None
    iterated: Array
    matter: list[tuple[float, NumericDensity]]

    def peaks(self, out: Array) -> Array:
        """Value, time and ratio of each quantity's peak, (3, q): next to each summit of the instants it is enclosed ever closer."""
        sizes, places = self.quantities(out)
        largest = np.argmax(np.abs(sizes), axis=1)
        rows = np.arange(len(largest))
        best = np.stack([sizes[rows, largest], self.t[largest], places[rows, largest]])
        units = np.array(self.kept.plan.units)
        scale = [np.abs(best[0])[units == unit].max() for unit in units]
        for q in rows[np.abs(best[0]) > NOTHING * np.array(scale)] if self.t.size > 1 else ():
            summits = _summits(np.abs(sizes[q]))[:_EACH]
            found = [tuple(best[:, q]), *(self.enclose(q, i, sizes[q], places[q]) for i in summits)]
            # Of some that are as large but for rounding, the first: else rounding would choose their sign.
            least = max(abs(value) for value, *_ in found) * (1.0 - ROUNDING["double"])
            best[:, q] = min((peak for peak in found if abs(peak[0]) >= least), key=lambda peak: peak[1])
        return best

    def enclose(self, q: int, i: int, row: Array, places: Array) -> tuple[float, float, float]:
        """The largest value of a quantity next to an instant, its time and its ratio."""
        near = [max(i - 1, 0), i, min(i + 1, self.t.size - 1)]
        times, found, ratios = self.t[near], row[near], places[near]
        for _ in range(_ROUNDS):
            inside = np.linspace(times[0], times[-1], _CUTS + 2)[1:-1]
            # Of two that are all but at the same time neither encloses.
            inside = inside[np.abs(inside[:, None] - times).min(axis=1) > _SAME * np.ptp(times)]
            sizes, where = self.quantity(q, self.columns(inside, i))
            times, found, ratios = np.append(times, inside), np.append(found, sizes), np.append(ratios, where)
            order = np.argsort(times, kind="stable")
            k = int(np.nanargmax(np.abs(found[order])))
            order = order[max(k - 1, 0) : k + 2]
            times, found, ratios = times[order], found[order], ratios[order]
            if np.ptp(found) <= ROUNDING["double"] * np.abs(found).max() or np.ptp(times) <= 8 * np.spacing(np.abs(times).max()):
                break
        k = int(np.argmax(np.abs(found)))
        # At a pole a value goes on growing however near it is.
        endless = abs(found[k]) > POLE * abs(row[i]) and (np.abs(np.delete(found, k)) < 0.9 * abs(found[k])).all()
        return math.copysign(math.inf, found[k]) if endless else found[k], times[k], ratios[k]

    def columns(self, t: Array, i: int) -> Array:
        """The columns at times next to an instant; NaN where iterated loops do not close."""
        z = np.zeros((self.iterated.shape[0], t.size))
        failed = np.zeros(t.size, dtype=bool)
        for k in range(t.size if self.graph.newton else 0):
            at, status = follow(self.graph, t[k : k + 1], self.p, self.iterated[:, i], newton=self.newton)
            z[:, k], failed[k] = at[:, 0], status[0] == NOT_CONVERGED
        driven = self.graph.motion(t[None], self.p)
        return np.where(failed, np.nan, self.graph.instant(t[None], *driven, z, self.p).full())

    def quantities(self, out: Array) -> tuple[Array, Array]:
        """Values and ratios xi/l of all quantities, each (q, t), of columns (columns, t)."""
        found = [self.quantity(q, out) for q in range(len(self.kept.quantities))]
        return np.stack([values for values, _ in found]), np.stack([places for _, places in found])

    def quantity(self, q: int, out: Array) -> tuple[Array, Array]:
        """The same of one of them, each (t,)."""
        plan, plain = self.kept.plan, len(self.kept.plan.quantities)
        if q < plain:
            values = out[list(plan.quantities[q])]
            return np.hypot(*values) if len(values) > 1 else values[0], np.full(out.shape[1], np.nan)
        along = plan.links[(q - plain) // 3]
        length, density = self.matter[(q - plain) // 3]
        coefficients = dict(zip(LAW, out[list(along.law)], strict=True))
        law = SectionLaw(length, density, coefficients, tuple(StationLoad("", *out[list(s)]) for s in along.stations))
        places, values = law.extreme(FORCES[(q - plain) % 3])
        return values, places


def _matter(kept: Kept, mechanism: Mechanism, values: Mapping[str, float]) -> list[tuple[float, NumericDensity]]:
    """Lengths and densities of the links that have section forces."""

    def number(expression: Any) -> float:
        return mechanism.number(expression, values)

    links = [mechanism.links[name] for name in kept.links]
    lengths = [number(link.length) for link in links]
    return [
        (length, link.mass.at(number, length))
        for link, length in zip(links, lengths, strict=True)
        if isinstance(link.mass, Density)
    ]


def _summits(sizes: Array) -> list[int]:
    """Instants next to which the largest value may lie, the likeliest first: see ``summits.c``."""
    around = np.concatenate([[-np.inf], sizes, [-np.inf]])
    found = np.flatnonzero((sizes > around[:-2]) & (sizes >= around[2:]))
    inner = np.clip(found, 1, max(sizes.size - 2, 1))
    rise = np.full(found.size, np.inf)
    if sizes.size > 2:
        rise = (2 * sizes[inner] - sizes[inner - 1] - sizes[inner + 1]) / 2
    best = sizes.max()
    worth = (rise > ROUNDING["double"] * best) & (sizes[found] + rise > best)
    return [int(i) for i in found[worth][np.argsort(-(sizes[found] + rise)[worth], kind="stable")]]
