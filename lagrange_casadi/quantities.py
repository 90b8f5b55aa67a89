"""The one table of every output: its name, axes, unit, sign and meaning.

An output is a :class:`Output` wherever it is worked with. Its full name is a text, ``group:part:member`` (``section:rod:bending``,
``reaction:guide:fy``, ``effort:O``), which users write and read; the same name with slashes is its place in the file. Nothing else
in the package states a unit or a sign, or takes a name apart.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

CONVENTIONS = (
    "SI units; plane x-y; angles in rad, counter-clockwise; a link's axis e runs from its base (xi = 0) to its tip (xi = 1), "
    "n is 90 deg counter-clockwise of e; section forces are the action of the part towards the tip on the part towards the "
    "base, resolved on (e, n, z), so axial > 0 is tension and d(bending)/d(xi l) = -shear; a reaction is the action of the "
    "joint's parent on its child, in ground axes, its moment about the joint's point on the child; an effort is positive "
    "along its coordinate"
)

CF = "CF-1.8"
"""What programs may expect of units, names and scales in files: the climate and forecast metadata conventions."""

FORCE, MOMENT, LENGTH, ANGLE = "N", "N m", "m", "rad"


@dataclass(frozen=True)
class Quantity:
    """One kind of output.

    ``axes`` is ``("t",)`` or ``("t", "xi")``. ``unit`` holds ``{q}`` where it depends on whether the joint's coordinate
    is an angle (rad) or a slide (m), and ``{Q}`` where it depends on the effort that works on it (N m or N). A multiplier's unit is
    that of power over its own equation's: the file says ``1`` where the equation's unit is the user's affair. An output of the
    user's own has the unit that it was declared with.
    """

    group: str
    member: str
    axes: tuple[str, ...]
    unit: str
    long_name: str
    sign: str = ""

    def unit_for(self, kind: str) -> str:
        """The unit for a coordinate of the given kind, ``"angle"`` or ``"slide"``."""
        angular = kind == "angle"
        return self.unit.format(q=ANGLE if angular else LENGTH, Q=MOMENT if angular else FORCE)

    @property
    def attributes(self) -> dict[str, str]:
        """What a file says of this quantity, its unit left out."""
        return {"long_name": self.long_name} | ({"sign": self.sign} if self.sign else {})


_ON_INBOARD = "action of the part towards the tip on the part towards the base"
_ON_CHILD = "action of the parent side on the child side"
_ON_FIRST = "on the body of the load's first point"
_ALONG = "positive along the joint's coordinate"

QUANTITIES = (
    Quantity("motion", "", ("t",), "{q}", "coordinate of the joint: child against parent", "counter-clockwise, or along the axis"),
    Quantity("motion", "rate", ("t",), "{q}/s", "rate of the joint's coordinate"),
    Quantity("motion", "acceleration", ("t",), "{q}/s^2", "acceleration of the joint's coordinate"),
    Quantity("pose", "x", ("t",), LENGTH, "place of the base, x"),
    Quantity("pose", "y", ("t",), LENGTH, "place of the base, y"),
    Quantity("pose", "angle", ("t",), ANGLE, "direction of the axis, continuous in time", "counter-clockwise from x"),
    Quantity("effort", "", ("t",), "{Q}", "effort of the drive", _ALONG),
    Quantity("reaction", "fx", ("t",), FORCE, "reaction of the joint, x", _ON_CHILD),
    Quantity("reaction", "fy", ("t",), FORCE, "reaction of the joint, y", _ON_CHILD),
    Quantity("reaction", "mz", ("t",), MOMENT, "moment of the joint about its point on the child", _ON_CHILD),
    Quantity("multiplier", "", ("t",), "1", "multiplier of a constraint or a non-holonomic row"),
    Quantity("load", "fx", ("t",), FORCE, "applied force, x", _ON_FIRST),
    Quantity("load", "fy", ("t",), FORCE, "applied force, y", _ON_FIRST),
    Quantity("load", "mz", ("t",), MOMENT, "applied torque", _ON_FIRST),
    Quantity("output", "", ("t",), "1", "output of the user's own"),
    Quantity("certificate", "balance", ("t",), "1", "Newton-Euler balance of all bodies, over the largest force of the cycle"),
    Quantity("certificate", "power", ("t",), "1", "balance of power, over the largest force times speed of the cycle"),
    Quantity("certificate", "closure", ("t",), "1", "gaps of joints, and what users' equations miss, over the length of all links"),
    Quantity("certificate", "ends", ("t",), "1", "sections at the base and what acts there, over the largest force of the cycle"),
    Quantity("certificate", "condition", ("t",), "1", "how much the loops magnify: 1/sin(transmission angle), or 2/volume"),
    Quantity("section", "axial", ("t", "xi"), FORCE, "axial force", f"tension is positive: {_ON_INBOARD}, along the axis"),
    Quantity("section", "shear", ("t", "xi"), FORCE, "shear force", f"{_ON_INBOARD}, 90 deg counter-clockwise of the axis"),
    Quantity("section", "bending", ("t", "xi"), MOMENT, "bending moment", f"{_ON_INBOARD}, counter-clockwise"),
    Quantity("law", "n0", ("t",), FORCE, "axial force at the tip"),
    Quantity("law", "n1", ("t",), "m/s^2", "axial force for a unit of the mass mu0 from the section to the tip"),
    Quantity("law", "n2", ("t",), "1/s^2", "axial force for a unit of the first moment mu1 from the section to the tip"),
    Quantity("law", "f0", ("t",), FORCE, "shear force at the tip"),
    Quantity("law", "f1", ("t",), "m/s^2", "shear force for a unit of the mass mu0 from the section to the tip"),
    Quantity("law", "f2", ("t",), "1/s^2", "shear force for a unit of the first moment mu1 from the section to the tip"),
    Quantity("law", "m0", ("t",), MOMENT, "bending moment at the tip"),
    Quantity("station", "n", ("t",), FORCE, "force on the link at a station, along the axis"),
    Quantity("station", "f", ("t",), FORCE, "force on the link at a station, 90 deg counter-clockwise of the axis"),
    Quantity("station", "m", ("t",), MOMENT, "moment on the link at a station"),
    Quantity("station", "station", ("t",), "1", "place of the station, ratio xi/l"),
)  # fmt: skip

RESULTANT = Quantity("reaction", "resultant", ("t",), FORCE, "resultant of the joint's reaction")
"""The size of a reaction's force: it follows from the reaction, and is no series of its own."""

_BY_KEY = {(q.group, q.member): q for q in (*QUANTITIES, RESULTANT)}
LAW = tuple(q.member for q in QUANTITIES if q.group == "law")
STATION = tuple(q.member for q in QUANTITIES if q.group == "station")
PLACE_FIRST = ("station", "n", "f", "m")
"""The same as ``STATION``, in the order in which emitted C and :class:`.StationLoad` take them."""

FORCES = tuple(q.member for q in QUANTITIES if q.group == "section")
_LAW_IN_SPACE = ("n0", "n1", "n2", "fy0", "fy1", "fy2", "mz0", "fz0", "fz1", "fz2", "my0", "mx0")


def law_members(space: bool) -> tuple[str, ...]:
    """The coefficients of a link's section law."""
    return _LAW_IN_SPACE if space else LAW


def station_members(space: bool) -> tuple[str, ...]:
    """What is told of a station of a link."""
    return ("n", "fy", "fz", "mx", "my", "mz", "station") if space else STATION


def force_members(space: bool, *, moment: bool = True) -> tuple[str, ...]:
    """The components of a force, and of its moment where it has one."""
    forces, moments = (("fx", "fy", "fz"), ("mx", "my", "mz")) if space else (("fx", "fy"), ("mz",))
    return (*forces, *moments) if moment else forces


_ENDINGS = {"rate": "_rate", "acceleration": "_acceleration"}
_COORDINATE = ".coordinate"


class Declared(Protocol):
    """What the units of outputs depend on: the coordinates and the user's outputs of a mechanism, by name."""

    @property
    def coordinates(self) -> Mapping[str, tuple[Any, Any]]:
        """The joint and the axis of each coordinate."""

    @property
    def outputs(self) -> Mapping[str, Any]:
        """The user's outputs."""


@dataclass(frozen=True)
class Output:
    """One output of a mechanism: what it is of its ``part``.

    ``group`` and ``member`` are those of its :class:`Quantity`. The certificate is of no ``part``. ``station`` names what acts on a
    link at a station.
    """

    group: str
    part: str
    member: str = ""
    station: str = ""

    @classmethod
    def of(cls, name: str | Output) -> Output:
        """The output that a full name says. Raises ``KeyError`` for a text that is none."""
        if isinstance(name, Output):
            return name
        group, _, text = name.partition(":")
        part, *rest = text.split(":")
        if group in ("motion", "effort"):
            for member, ending in (("", _COORDINATE), *_ENDINGS.items()) if group == "motion" else ():
                if text.endswith(ending):
                    return cls(group, text.removesuffix(ending), member)
            return cls(group, text)
        if group == "section" and len(rest) == 2:
            station, member = rest
            return cls("law", part, member) if station == "law" and member in LAW else cls("station", part, member, station)
        if group == "certificate" and not rest:
            return cls(group, "", part)
        if len(rest) > 1:
            raise KeyError(name)
        return cls(group, part, *rest)

    def __str__(self) -> str:
        """The full name."""
        if self.group == "motion":
            plain = _COORDINATE if self.part.endswith(tuple(_ENDINGS.values())) else ""
            return f"motion:{self.part}{_ENDINGS.get(self.member, plain)}"
        if self.group in ("law", "station"):
            return f"section:{self.part}:{self.station or 'law'}:{self.member}"
        return ":".join(word for word in (self.group, self.part, self.member) if word)

    @property
    def quantity(self) -> Quantity:
        """Its row of the table. Raises ``KeyError`` where there is none."""
        return _BY_KEY[self.group, self.member]

    @property
    def components(self) -> tuple[Output, ...]:
        """Of what it is the size: the outputs of a resultant, else itself."""
        if self.group != RESULTANT.group or self.member != RESULTANT.member:
            return (self,)
        return Output(self.group, self.part, "fx"), Output(self.group, self.part, "fy")

    @property
    def along(self) -> bool:
        """Whether it goes into the section forces of a link."""
        return self.group in ("law", "station")

    def unit(self, mechanism: Declared) -> str:
        """The unit in a mechanism."""
        if self.group == "output":
            return str(mechanism.outputs[self.part].unit)
        found = mechanism.coordinates.get(self.part) if self.group in ("motion", "effort") else None
        return self.quantity.unit_for("angle" if found is None else found[1].kind)


def quantity_of(name: str) -> Quantity:
    """The table's row for a full name such as ``motion:O_rate`` or ``section:rod:law:n0``.

    Raises ``KeyError`` for a name that is none of the table's.
    """
    return Output.of(name).quantity
