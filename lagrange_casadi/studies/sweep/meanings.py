"""The unit and the meaning of each column and axis of a sweep, by name: what its file says, and
what ``check`` compares.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from ...base.quantities import Kinds, Output, quotient
from ...base.status import Status
from ...base.tables import ANGLE, LENGTH, Table
from ...declare.description import Description, kinds_of_described, motions_of
from ...declare.mass_properties import ALL
from ...declare.wanted_names import SENSITIVITY
from ...instants.ordering import table_of_described
from .axes import DESIGN

OVER, CYCLE = "over", "cycle"
"""Axes beside ``t``: the coordinate of a drive that all designs have in common; and from 0 to 1,
where they have none.
"""

STATUS = "status"
"""The one column whose name stands alone: why a design has no result, 0 where it has one."""

STATUSES: Mapping[int, tuple[str, str]] = {
    int(status): (status.name.lower(), status.meaning) for status in Status
}
"""A word and a sentence for each status."""

TIMES = "history:t"
"""The times of a design's instants, where these are over anything else."""

ERROR = "peak_error"
"""Kind of columns that bound how much larger a peak between instants may be than at them."""

FLUCTUATION = "fluctuation"
"""Kind of columns of the fluctuation of energy of drives."""

LEAST, LIFE, MASS = "least", "life", "mass"
"""Kinds of columns on the strength of links."""

WAYS = ("yield", "buckling", "fatigue")
"""Modes of failure of links."""

NO_SLOPE = "NaN for designs for which it has no derivative"

SLOPES_OF = {"peak": "peak", "mean": "mean over time", "rms": "root of the mean square over time"}
"""Quantities whose derivatives are kept, in words."""

_OF_OUTPUTS = {
    "peak": "largest magnitude over time: ",
    "mean": "mean over time: ",
    "peak_at": "largest magnitude over the instants: ",
    "history": "",
}
"""Kinds of columns that have the sign of their quantity."""

_BESIDE = {
    "peak_t": ("instant of the peak: ", "s"),
    "peak_xi": ("ratio xi/l of the peak: ", "1"),
    ERROR: ("bound of how much larger the peak is between the instants, infinite if none: ", ""),
    "rms": ("root of the mean square over time: ", ""),
    FLUCTUATION: ("fluctuation of the energy beyond that of the mean: ", "J"),
}
"""Kinds that have none, and their units, if these are not the quantity's."""

_AGAINST = {mode: f"against {'yielding' if mode == 'yield' else mode}" for mode in WAYS}

Meaning = tuple[str, dict[str, str]]
"""A unit, and what else a file says."""


@dataclass(frozen=True)
class Meanings:
    """Meanings of columns and axes in a mechanism.

    Its outputs are those of a ``table``, in units by ``kinds``; ``parameters`` are the units of its
    parameters. Instants are along an ``axis``, asked for by a ``joint``, whose coordinate has the
    unit ``drive_unit``, or by time.
    """

    table: Table
    kinds: Kinds
    parameters: Mapping[str, str]
    axis: str
    joint: str = ""
    drive_unit: str = ""

    @classmethod
    def of(cls, description: Description, axis: str, joint: str) -> Meanings:
        """Make them for a described mechanism."""
        units = {
            name: str(parameter["unit"]) for name, parameter in description["parameters"].items()
        }
        drive_unit = (
            "" if not joint else LENGTH if motions_of(description)[joint] == "slide" else ANGLE
        )
        return cls(
            table_of_described(description),
            kinds_of_described(description),
            units,
            axis,
            joint,
            drive_unit,
        )

    def of_column(self, name: str, among: Collection[str] = ()) -> Meaning:
        """The meaning of a column by its full name, ``among`` the names of all.

        Raises ``KeyError`` for a name that is none.
        """
        kind, _, rest = name.partition(":")
        if name == STATUS:
            return "1", self._of_status()
        if name == TIMES:
            return "s", {"long_name": "time"}
        if kind in (LEAST, LIFE, MASS):
            return _of_strength(kind, rest, among)
        if kind == SENSITIVITY:
            parameter, of, quantity = rest.split(":", 2)
            output = Output.of(quantity)
            what = (
                f"derivative by {parameter} of the {SLOPES_OF[of]}:"
                f" {output.meant(self.table).long_name}"
            )
            return quotient(output.unit(self.kinds), self.parameters[parameter]), {
                "long_name": what,
                "missing": NO_SLOPE,
            }
        output = Output.of(rest)
        words = output.meant(self.table).attributes
        if kind in _OF_OUTPUTS:
            sampled = kind == "peak" and f"{ERROR}:{rest}" in among
            return output.unit(self.kinds), words | {
                "long_name": _OF_OUTPUTS["peak_at" if sampled else kind] + words["long_name"]
            }
        if kind == "peak_over":
            return self.drive_unit, {
                "long_name": f"coordinate of joint '{self.joint}' at the peak: {words['long_name']}"
            }
        prefix, unit = _BESIDE[kind]
        return unit or output.unit(self.kinds), {"long_name": prefix + words["long_name"]}

    def of_axis(self, name: str) -> Meaning:
        """The meaning of an axis: one that every sweep may have, or that of a parameter."""
        unit, long_name = {
            "t": ("s", "time"),
            "xi": ("1", "position along a link, ratio xi/l"),
            OVER: (self.drive_unit, f"coordinate of joint '{self.joint}'"),
            CYCLE: ("1", "fraction of the cycle, from the first instant of a design to its last"),
            DESIGN: ("1", "number of the design"),
        }.get(name) or (self.parameters[name], f"parameter {name}")
        return unit, {"long_name": long_name}

    def _of_status(self) -> dict[str, str]:
        words_by_number = {
            number: words
            for number, words in STATUSES.items()
            if self.axis != "t" or number != Status.NO_INSTANTS
        }
        return {
            "long_name": "status: validity of the result, or the reason why there is none",
            "flag_meanings": " ".join(word for word, _ in words_by_number.values()),
            "sentences": json.dumps(
                {number: sentence for number, (_, sentence) in words_by_number.items()}
            ),
        }


def _of_strength(kind: str, rest: str, among: Collection[str]) -> Meaning:
    """The meaning of a column of the strength of a link."""
    if kind == MASS:
        return "kg", {
            "long_name": "mass of all links and point masses" if rest == ALL else "mass of the link"
        }
    if kind == LIFE:
        return "1", {"long_name": "life in cycles of the whole time span"}
    mode, _, link = rest.partition(":")
    if mode in WAYS:
        return "1", {"long_name": f"least factor of safety {_AGAINST[mode]}"}
    known = (_AGAINST[each] for each in WAYS if f"{LEAST}:{each}:{link}" in among)
    return "1", {"long_name": f"least factor of safety, the smallest of those {', '.join(known)}"}
