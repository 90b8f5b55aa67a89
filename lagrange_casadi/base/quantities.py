"""Every output by its name; :mod:`.base.tables` has its axes, unit, sign and meaning.

An output is a :class:`Output` wherever it is worked with. Its full name is a text,
``group:part:member`` (``section:rod:bending``, ``reaction:guide:fy``, ``effort:O``), which users
write and read; the same name with slashes is its place in the file. Nothing else in the package
takes a name apart.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

from ..errors import check_kind
from .tables import PLANE, SPACE, Quantity, Table

Value = TypeVar("Value")


def force_members(space: bool, *, moment: bool = True) -> tuple[str, ...]:
    """The components of a force, and of its moment where it has one."""
    forces, moments = (("fx", "fy", "fz"), ("mx", "my", "mz")) if space else (("fx", "fy"), ("mz",))
    return (*forces, *moments) if moment else forces


AVERAGED = ("effort", "friction", "output")
"""Groups whose outputs have means over time beside their peaks."""

_LIKE = {"m": "rad", "m/s": "rad/s", "m/s^2": "rad/s^2", "N m": "N"}


def compared(units: Sequence[str]) -> list[int]:
    """Number of each unit with which sizes are compared: lengths beside angles, moments beside
    forces.

    Of a mechanism all of whose slides stand still, lengths are nothing but rounding, so angles
    count.
    """
    kinds = [_LIKE.get(unit, unit) for unit in units]
    numbers = {kind: k for k, kind in enumerate(dict.fromkeys(kinds))}
    return [numbers[kind] for kind in kinds]


_LAWS = {*PLANE.law, *SPACE.law}
_DISTRIBUTED = re.compile(
    rf"(?:({'|'.join((*PLANE.distributed, *SPACE.distributed, *SPACE.couples))})"
    r"(0|[1-9]\d*)|(width|end))"
)
_ENDINGS = {"rate": "_rate", "acceleration": "_acceleration"}
_COORDINATE = ".coordinate"


@dataclass(frozen=True)
class Kinds:
    """Parameters on which units of outputs depend, by name.

    ``coordinates`` and ``frictions`` are kinds, "angle" or "slide", of coordinates and of those
    along which joints rub; ``outputs`` are the units of the user's outputs.
    """

    coordinates: Mapping[str, str]
    frictions: Mapping[str, str]
    outputs: Mapping[str, str]


@dataclass(frozen=True)
class Output:
    """One output of a mechanism: what it is of its ``part``.

    ``group`` and ``member`` are those of its :class:`Quantity`. The certificate is of no ``part``.
    ``station`` names what acts on a link at a station, or along it; what acts along it has members
    for each ``power`` of the place.
    """

    group: str
    part: str
    member: str = ""
    load_point: str = ""
    power: int | None = None

    @classmethod
    def of(cls, name: str | Output) -> Output:
        """The output that a full name says. Raises ``KeyError`` for a text that is none."""
        if isinstance(name, Output):
            return name
        check_kind("output", name, "a full name, as 'effort:O'", str)
        group, _, text = name.partition(":")
        part, *rest = text.split(":")
        if group in ("motion", "effort"):
            for member, ending in (
                (("", _COORDINATE), *_ENDINGS.items()) if group == "motion" else ()
            ):
                if text.endswith(ending):
                    return cls(group, text.removesuffix(ending), member)
            return cls(group, text)
        if group == "section" and len(rest) == 2:
            load_point, member = rest
            if load_point == "law" and member in _LAWS:
                return cls("law", part, member)
            if found := _DISTRIBUTED.fullmatch(member):
                direction, power, end = found.groups()
                return cls(
                    "spread", part, end or direction, load_point, None if end else int(power)
                )
            return cls("station", part, member, load_point)
        if group == "holding":
            part, _, member = text.rpartition(":")
            return cls(group, part, member)
        if group == "certificate" and not rest:
            return cls(group, "", part)
        if len(rest) > 1:
            raise KeyError(name)
        return cls(group, part, "".join(rest))

    def __str__(self) -> str:
        """The full name."""
        if self.group == "motion":
            plain = _COORDINATE if self.part.endswith(tuple(_ENDINGS.values())) else ""
            return f"motion:{self.part}{_ENDINGS.get(self.member, plain)}"
        if self.along:
            power = "" if self.power is None else self.power
            return f"section:{self.part}:{self.load_point or 'law'}:{self.member}{power}"
        return ":".join(word for word in (self.group, self.part, self.member) if word)

    @property
    def quantity(self) -> Quantity:
        """Row of the table of planar mechanisms, or, if these have none, of spatial ones: axes and
        unit are the same in both.

        :meth:`meant` has its meaning in either. Raises ``KeyError`` where there is none.
        """
        return (PLANE if (self.group, self.member) in PLANE else SPACE).row(self.group, self.member)

    def meant(self, table: Table) -> Quantity:
        """Row of a table. Raises ``KeyError`` if there is none."""
        return table.row(self.group, self.member)

    def components(self, table: Table) -> tuple[Output, ...]:
        """Outputs of which this is the resultant, or itself."""
        return tuple(replace(self, member=part) for part in table.parts(self.group, self.member))

    @property
    def along(self) -> bool:
        """True if it is a part of a link's section forces."""
        return self.group in ("law", "station", "spread")

    def unit(self, kinds: Kinds) -> str:
        """The unit in a mechanism of such kinds."""
        if self.group == "output":
            return kinds.outputs[self.part]
        along = kinds.frictions if self.group == "friction" else kinds.coordinates
        return self.quantity.unit_for(along.get(self.part, "angle"))


@dataclass(frozen=True)
class Check:
    """A column of a Program that is no output: :mod:`.engine.verdicts` has those whose numbers
    decide if an instant has a result.

    ``bend`` of a friction says how much one that slides changes with those at rest (see
    :mod:`.friction`), ``rowsize`` has the size of a non-holonomic row's terms. ``turns`` are the
    whole turns of a joint's angle that its column is without, ``multiplier`` is one that was not
    wanted, ``drive`` is what a table needs of its drive, ``seen`` what a constraint sees that may
    have kinks (see :mod:`.corners`), and ``watched`` what is watched for jumps and kinks between
    instants.
    """

    kind: str
    part: str | Output

    def __str__(self) -> str:
        """A name that no output has."""
        return f"_{self.kind}:{self.part}"


Column: TypeAlias = Output | Check


def motions_of(coordinate: str) -> tuple[Output, ...]:
    """The outputs of a coordinate's motion: its value, its rate and its acceleration."""
    return tuple(Output("motion", coordinate, member) for member in ("", *_ENDINGS))


def motion_names(coordinates: Iterable[str]) -> list[list[str]]:
    """Full names of the values, of the rates and of the accelerations of coordinates."""
    by_coordinate = (map(str, motions_of(coordinate)) for coordinate in coordinates)
    return [list(names) for names in zip(*by_coordinate, strict=True)]


def quotient(unit: str, by: str) -> str:
    """The unit of a derivative: ``N m/m``, and ``N/(kg/m)`` of what is itself one."""
    return unit if by == "1" else f"{unit}/{by}" if by.isalnum() else f"{unit}/({by})"


def parts_along(outputs: Mapping[Output, Value], link: str) -> dict[Output, Value]:
    """The parts of a link's section forces among outputs."""
    return {o: value for o, value in outputs.items() if o.along and o.part == link}
