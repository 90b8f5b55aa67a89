"""Results in lines: the largest values first, then one table with a row for each quantity."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from ..base.quantities import Output
from ..base.table_writers import aligned
from ..model.scene import Scene, margins, strokes
from ..results.histories import Peak
from ..results.ordering import ON_PARTS, error_of, ordered
from ..results.solution import Solution
from ..results.statistics import Extreme, Statistics

_ROUNDING = 5e-7
"""Errors below this share of the largest value of their unit are rounding."""
_DIGITS = 6
NOT_FOUND = "; the peak between the instants was not found"
"""End of the line of a peak of which only the ``least`` size is known."""

_INDETERMINATE = "indeterminate"
_CARDS = {
    ("effort", ""): "effort",
    ("reaction", "resultant"): "reaction force",
    ("reaction", "moment"): "reaction moment",
    ("reaction", "mz"): "reaction moment",
    ("section", "axial"): "axial force",
    ("section", "shear"): "shear force",
    ("section", "torsion"): "torsion moment",
    ("section", "bending"): "bending moment",
}


@dataclass(frozen=True)
class Row:
    """A quantity with its statistics, its peak and the estimated ``error`` of it in its unit.

    ``found`` and ``peak`` are None if the quantity is statically indeterminate.
    """

    output: Output
    unit: str
    found: Statistics | None = None
    peak: Peak | None = None
    error: float | None = None

    @property
    def card(self) -> str:
        """Words for the largest of its kind, which has a line on the first screen; empty for
        others.
        """
        return _CARDS.get((self.output.group, self.output.member), "")


@dataclass(frozen=True)
class Rows:
    """The quantities of a solution, in order; ``switching`` names loads of which no peak was found
    between the instants, ``margins`` those of contacts, and ``strokes`` shares that are out.
    """

    solution: Solution
    rows: tuple[Row, ...]
    switching: tuple[str, ...] = ()
    margins: tuple[str, ...] = ()
    strokes: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        scene: Scene,
        solution: Solution,
        refined: Sequence[Peak] = (),
        asked: Collection[str] = (),
        verbose: bool = False,
    ) -> Rows:
        """Collect efforts, reactions with their resultants, section forces and user outputs.

        Welds inside bent bars are left out, unless they are ``asked`` for by name or all is to be
        listed.
        """
        peaks = {peak.name: peak for peak in refined}
        inner = () if verbose else solution.description.bends
        outputs = [
            output
            for output in ordered(solution)
            if output.part not in inner or f"reaction:{output.part}" in asked
        ]
        lost = [Output.of(peak.name) for peak in refined if peak.least is not None]
        loads = dict.fromkeys(output.part for output in lost if output.group == "load")
        return cls(
            solution,
            tuple(_row(solution, output, peaks) for output in outputs),
            tuple(loads),
            tuple(margins(scene)),
            tuple(strokes(scene)),
        )

    @classmethod
    def of_all(cls, solution: Solution) -> Rows:
        """Collect all quantities of a solution."""
        return cls(solution, tuple(_row(solution, one, {}) for one in solution.quantities()))

    def cards(self) -> Iterator[str]:
        """Write the largest effort, reaction and section forces, each with its place and time, and
        the least margin of contacts.
        """
        cards = []
        # Efforts of drives that turn and of drives that slide do not compare.
        for words, unit in product(dict.fromkeys(_CARDS.values()), self._scales):
            rows = (row for row in self.rows if (row.card, row.unit) == (words, unit))
            largest = max(rows, key=lambda row: _size(row.peak), default=None)
            if largest and largest.peak and not self._nothing(largest):
                cards.append((words, largest.peak))
        width = max([28, *(len(peak.name) for _, peak in cards)])
        if found := self._nearest:
            cards.append(("least margin", _peak(self.solution, found, found.smallest)))
        for words, peak in cards:
            yield card(words, peak_line(self.solution, peak, self._scales[peak.unit], width))

    def table(self, capacity: int | None = None) -> Iterator[str]:
        """Write a row for each quantity, or for the most important ones if ``capacity`` is for
        some only.
        """
        if not self.rows:
            return
        rows = (
            self.rows
            if capacity is None or len(self.rows) <= capacity
            else self._first(capacity - 1)
        )
        over = self.solution.over
        at = [over.label if over else "t [s]", "xi/l"]
        heads = ["", "peak", "", *at, "min", "max", "mean", "rms"]
        # Names and units begin at the left.
        yield from aligned(heads, [self._cells(row) for row in rows], left=(0, 2))
        if len(rows) < len(self.rows):
            yield (
                f"  {len(rows)} of {len(self.rows)} quantities, the largest of each kind;"
                " --verbose lists all"
            )

    def notes(self) -> Iterator[str]:
        """Say what the words of the table mean."""
        if any(row.peak is None for row in self.rows):
            yield (
                "note: equilibrium does not determine what is indeterminate: the mechanism is"
                " over-constrained; beams of its links and --elastic may determine it"
            )
        missing = [row.output for row in self.rows if row.peak and row.peak.least is not None]
        if missing:
            loads = ", ".join(map(repr, self.switching))
            what = f"load {loads}" if loads else "a comparison or a remainder"
            yield (
                f"note: >= marks a peak that was not found between the instants ({missing[0]}):"
                f" {what} switches too often there, or has no bound; smooth what switches, as by"
                " tanh in place of sign"
            )

    @cached_property
    def _nearest(self) -> Statistics | None:
        """The margin of the contact that is nearest to sliding or pulling, if there are contacts
        whose forces are determined.
        """
        found = [row.found for row in self.rows if row.found and row.found.name in self.margins]
        return min(found, key=lambda one: one.smallest.value, default=None)

    @cached_property
    def _scales(self) -> dict[str, float]:
        """The largest size of each unit."""
        return {
            unit: max(_size(row.peak) for row in self.rows if row.unit == unit)
            for unit in dict.fromkeys(row.unit for row in self.rows)
        }

    def _nothing(self, row: Row) -> bool:
        """Mark what is zero within rounding, or indeterminate."""
        return readable(_size(row.peak), row.error, self._scales[row.unit]) == "0"

    def _first(self, count: int) -> tuple[Row, ...]:
        """Choose what single elements bear, the strokes and the least margin; beside these the
        largest of each kind, then the second largest, and so on.

        Components of resultants come after that, and what is zero or indeterminate at the end.
        """
        chosen = {
            id(row)
            for row in self.rows
            if row.output.group in ON_PARTS
            or str(row.output) in self.strokes
            or (row.found and row.found is self._nearest)
        }
        kinds: dict[tuple[bool, str, str], list[Row]] = {}
        for row in (row for row in self.rows if id(row) not in chosen):
            output = row.output
            kind = (self._component(output), output.group, output.member or output.part)
            kinds.setdefault(kind, []).append(row)
        ranked = [
            (component, rank, k, row)
            for k, ((component, *_), rows) in enumerate(kinds.items())
            for rank, row in enumerate(sorted(rows, key=lambda row: -_size(row.peak)))
        ]
        ranked.sort(key=lambda entry: (self._nothing(entry[3]), *entry[:3]))
        chosen.update(id(row) for *_, row in ranked[: max(count - len(chosen), count // 2)])
        return tuple(row for row in self.rows if id(row) in chosen)

    def _component(self, output: Output) -> bool:
        """Distinguish a component of a resultant from a quantity of its own."""
        table = self.solution.table
        if output.group == "reaction":
            planar_moment = output.member == "mz" and "moment" not in table.reactions
            return output.member not in table.reactions and not planar_moment
        return output.group == "section" and output.member.endswith(("_y", "_z"))

    def _cells(self, row: Row) -> list[str]:
        peak, found, scale = row.peak, row.found, self._scales[row.unit]
        if peak is None or found is None:
            return [str(row.output), _INDETERMINATE]
        value = shown(peak, row.error, scale)
        at = ["", ""] if value == "0" else self._place(peak)
        numbers = (found.smallest.value, found.largest.value, found.mean, found.rms)
        return [
            str(row.output),
            value,
            row.unit,
            *at,
            *("" if number is None else readable(number, row.error, scale) for number in numbers),
        ]

    def _place(self, peak: Peak) -> list[str]:
        """Write the time of a peak, or the coordinate of the drive, and the ratio xi/l."""
        over = self.solution.over
        at = over.drawn(peak.over) if over and peak.over is not None else peak.t
        return [f"{at:.5g}", "" if peak.xi is None else ratio(peak.xi)]


def card(words: str, line: str) -> str:
    """Write a line of the first screen: what is largest, and the line of its peak."""
    return f"  {words:<15} {line.strip()}"


def readable(value: float, error: float | None, scale: float) -> str:
    """Write a number; what is zero but for rounding is 0.

    ``error`` estimates how far the value may be off, ``scale`` is the largest value of its unit.
    """
    if error is not None and abs(value) <= error <= _ROUNDING * scale:
        return "0"
    return f"{value + 0.0:.{_DIGITS}g}"


def ratio(xi: float) -> str:
    """Write a ratio xi/l."""
    return f"{round(xi, 4) + 0.0:g}"


def shown(peak: Peak, error: float | None, scale: float) -> str:
    """Write the value of a peak, with its error if that reaches the digits shown."""
    if peak.least is not None:
        return f">= {peak.least:.{_DIGITS}g}"
    value = readable(peak.value, error, scale)
    return f"{value} +- {error:.0e}" if error is not None and _matters(value, error) else value


def _matters(value: str, error: float) -> bool:
    """Return whether an error reaches the last digit shown of a value."""
    size = abs(float(value))
    if not (math.isfinite(error) and 0.0 < size < math.inf):
        return False
    return error >= 0.5 * 10.0 ** (math.floor(math.log10(size)) + 1 - _DIGITS)


def peak_line(solution: Solution, peak: Peak, scale: float, width: int) -> str:
    """Write a peak with its name, its place, and how far it may be off if that shows."""
    over = "" if peak.over is None or not solution.over else f"{solution.over.shown(peak.over)}, "
    xi = "" if peak.xi is None else f", xi/l = {ratio(peak.xi)}"
    value = shown(peak, error_of(solution, peak.name), scale)
    more = "" if peak.least is None else NOT_FOUND
    return (
        f"  {peak.name:<{width}} {value:>12} {peak.unit:<4} at {over}t = {peak.t:.5g} s{xi}{more}"
    )


def _row(solution: Solution, output: Output, peaks: Mapping[str, Peak]) -> Row:
    if not solution.determined(output):
        return Row(output, solution.unit(output))
    found = solution.statistics(output)
    peak = peaks.get(found.name) or _peak(solution, found, found.peak)
    return Row(output, found.unit, found, peak, error_of(solution, found.name))


def _peak(solution: Solution, found: Statistics, at: Extreme) -> Peak:
    """A value of a quantity as a peak, with the coordinate of the drive there."""
    over = solution.over
    coordinate = None if over is None else float(over.values[int(np.argmax(solution.t == at.t))])
    return Peak(found.name, at.value, found.unit, at.t, at.xi, over=coordinate)


def _size(peak: Peak | None) -> float:
    """The size of a peak, or the largest size that was found of it; 0 of no number."""
    if peak is None:
        return 0.0
    size = abs(peak.value) if peak.least is None else peak.least
    return 0.0 if math.isnan(size) else size


def asked_line(words: Sequence[float | str], slides: bool) -> str:
    """Line on how the instants are defined, from :meth:`.Timing.words`, for a joint that ``slides``
    or turns.
    """
    start, stop, count, *joint = words
    ends = [
        word.partition(" #")[0] if isinstance(word, str) else f"{word:g}" for word in (start, stop)
    ]
    what = f"{joint[0]} [{'m' if slides else 'rad'}]" if joint else "t [s]"
    return f"{what}: {ends[0]} to {ends[1]}, {count} points"
