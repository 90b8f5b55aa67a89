"""The unit and the meaning of each column and axis of a sweep, by name: what its file says, and
what ``check`` compares.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output, quotient
from ...base.status import Status
from ...base.tables import ANGLE, LENGTH, Table, table_of
from ...engine.model_data import ModelData
from ...model.description import Description
from ...model.even_points import points
from ...model.mass_properties import ALL
from ...model.times import Timing, instants_of
from ...model.wanted_names import SENSITIVITY
from .axes import DESIGN

OVER, CYCLE = "over", "cycle"
"""Axes beside ``t``: the coordinate of a drive that all designs have in common; and from 0 to 1,
where they have none.
"""

_WORDS = {OVER: "the drive's coordinate", CYCLE: "the cycle"}

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


@dataclass(frozen=True)
class Kind:
    """A kind of columns: ``words`` before those of their quantity, their ``unit`` if it is not the
    quantity's, and their ``label`` in figures.

    Those with ``sign`` have that of their quantity. Files in which no column is of an ``optional``
    kind have no group of its name.
    """

    words: str = ""
    unit: str = ""
    label: str = ""
    sign: bool = False
    optional: bool = False


KINDS: Mapping[str, Kind] = {
    STATUS: Kind(),
    "peak": Kind("largest magnitude over time: ", label="|peak|", sign=True),
    "peak_t": Kind("instant of the peak: ", "s", "instant of the peak"),
    "peak_over": Kind(label="coordinate of the drive at the peak", optional=True),
    "peak_xi": Kind("ratio xi/l of the peak: ", "1", r"$\xi/l$ of the peak"),
    ERROR: Kind(
        "bound of how much larger the peak is between the instants, infinite if none: ",
        label="error of the peak",
        optional=True,
    ),
    "mean": Kind("mean over time: ", label="mean", sign=True),
    "rms": Kind("root of the mean square over time: ", label="rms"),
    FLUCTUATION: Kind(
        "fluctuation of the energy beyond that of the mean: ", "J", "fluctuation", optional=True
    ),
    SENSITIVITY: Kind(optional=True),
    "peak_at": Kind("largest magnitude over the instants: ", label="peak", sign=True),
    "history": Kind(sign=True),
    LEAST: Kind(optional=True),
    LIFE: Kind(optional=True),
    MASS: Kind(optional=True),
}
"""Kinds of columns, in the order in which they are listed."""

_AGAINST = {mode: f"against {'yielding' if mode == 'yield' else mode}" for mode in WAYS}

Meaning = tuple[str, dict[str, str]]
"""A unit, and what else a file says."""


def in_words(axes: Sequence[str]) -> str:
    """Axes of columns in words."""
    return " and ".join(_WORDS.get(axis, axis) for axis in axes)


@dataclass(frozen=True, eq=False)
class InstantAxis:
    """An axis: its name in the file and values (t,)."""

    name: str
    values: Array

    @classmethod
    def of(cls, data: ModelData, timing: Timing) -> InstantAxis:
        """Axis of a mechanism's designs."""
        if timing.shared:
            return cls("t", instants_of(data.laws, timing, data.values(data.defaults)).t)
        if timing.joint and timing.fixed:
            start, stop, _ = timing.bounds(np.zeros((1, 0)))
            coordinates = points((float(start[0]), float(stop[0]), timing.count))
            return cls(OVER, coordinates)
        places = points((0.0, 1.0, timing.count)) if timing.count > 1 else np.zeros(1)
        return cls(CYCLE, places)


@dataclass(frozen=True)
class Column:
    """One dataset: its full name, unit, what a file says of it, the axes beyond those of the
    designs, their lengths, and its type.
    """

    name: str
    unit: str
    attributes: Mapping[str, str]
    axes: tuple[str, ...] = ()
    lengths: tuple[int, ...] = ()
    dtype: str = "<f8"

    @property
    def long_name(self) -> str:
        """Meaning in words."""
        return self.attributes["long_name"]

    @property
    def place(self) -> str:
        """The dataset's path in the file."""
        return self.name.replace(":", "/")

    @property
    def width(self) -> int:
        """Bytes a design."""
        return np.dtype(self.dtype).itemsize * math.prod(self.lengths)


@dataclass(frozen=True)
class Meanings:
    """Meanings of columns and axes in a described mechanism, whose instants are asked for by a
    ``joint``, or by time; ``shared`` says that all designs have the same.
    """

    description: Description
    joint: str
    shared: bool

    @property
    def table(self) -> Table:
        """The table of its outputs."""
        return table_of(self.description.space)

    @property
    def drive_unit(self) -> str:
        """Unit of the joint's coordinate."""
        return LENGTH if self.description.driven[self.joint] == "slide" else ANGLE

    def of_column(self, name: str, among: Collection[str] = ()) -> Meaning:
        """The meaning of a column by its full name, ``among`` the names of all.

        Raises ``KeyError`` for a name that is none.
        """
        kinds, (kind, _, rest) = self.description.kinds, name.partition(":")
        if name == STATUS:
            # Designs that share their instants have some.
            said = [
                (number, *words)
                for number, words in STATUSES.items()
                if not self.shared or number != Status.NO_INSTANTS
            ]
            return "1", {
                "long_name": "status: validity of the result, or the reason why there is none",
                "flag_meanings": " ".join(word for _, word, _ in said),
                "sentences": json.dumps({number: sentence for number, _, sentence in said}),
            }
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
            unit = quotient(output.unit(kinds), self.description.parameters[parameter].unit)
            return unit, {"long_name": what, "missing": NO_SLOPE}
        output = Output.of(rest)
        words = output.meant(self.table).attributes
        if KINDS[kind].sign:
            sampled = kind == "peak" and f"{ERROR}:{rest}" in among
            begin = KINDS["peak_at" if sampled else kind].words
            return output.unit(kinds), words | {"long_name": begin + words["long_name"]}
        if kind == "peak_over":
            return self.drive_unit, {
                "long_name": f"coordinate of joint '{self.joint}' at the peak: {words['long_name']}"
            }
        unit = KINDS[kind].unit or output.unit(kinds)
        return unit, {"long_name": KINDS[kind].words + words["long_name"]}

    def of_axis(self, name: str) -> Meaning:
        """The meaning of an axis: one that every sweep may have, or that of a parameter."""
        if name == OVER:
            return self.drive_unit, {"long_name": f"coordinate of joint '{self.joint}'"}
        unit, long_name = {
            "t": ("s", "time"),
            "xi": ("1", "position along a link, ratio xi/l"),
            CYCLE: ("1", "fraction of the cycle, from the first instant of a design to its last"),
            DESIGN: ("1", "number of the design"),
        }.get(name) or (self.description.parameters[name].unit, f"parameter {name}")
        return unit, {"long_name": long_name}


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
