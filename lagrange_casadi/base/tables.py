"""The tables of all quantities, one of planar mechanisms and one of spatial ones: axes, unit, sign
and meaning.

Nothing else in the package states a unit or a sign. :mod:`.base.quantities` has the outputs that
they are of.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from .brief import Brief

CF = "CF-1.8"
"""Conventions of units, names and scales in files: the climate and forecast metadata
conventions.
"""

FORCE, MOMENT, LENGTH, ANGLE = "N", "N m", "m", "rad"


@dataclass(frozen=True)
class Quantity:
    """One kind of output.

    ``unit`` holds ``{q}`` where it depends on whether the joint's coordinate is an angle (rad) or a
    slide (m), and ``{Q}`` where it depends on the effort that works on it (N m or N). A
    multiplier's unit is that of power over its own equation's: the file says ``1`` where the
    equation's unit is the user's affair. An output of the user's own has the unit that it was
    declared with. A resultant is the size ``of`` other members of the same part, of those that
    its table has.
    """

    group: str
    member: str
    unit: str
    long_name: str
    sign: str = ""
    of: tuple[str, ...] = ()

    @property
    def axes(self) -> tuple[str, ...]:
        """``("t",)``, or of section forces ``("t", "xi")``."""
        return ("t", "xi") if self.group == "section" else ("t",)

    def unit_for(self, kind: str) -> str:
        """The unit for a coordinate of the given kind, ``"angle"`` or ``"slide"``."""
        angular = kind == "angle"
        return self.unit.format(q=ANGLE if angular else LENGTH, Q=MOMENT if angular else FORCE)

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of this quantity in a file, except its unit."""
        return {"long_name": self.long_name} | ({"sign": self.sign} if self.sign else {})


@dataclass(frozen=True)
class Terms:
    """Terms of a section force: members of the law, and the contribution of point loads.

    The ``coefficients`` are those of functions along the link: of 1, mu0 and mu1 for a force, of 1
    alone for torsion. A bending moment has a ``shear``, another section force, whose coefficients
    are those behind its first one: d(bending)/d(xi) = -``arm`` shear, with ``arm`` 1 or -1.
    ``spread`` is what a load along the link adds, beside powers along it, and ``couple`` what the
    rotary inertia of slices does.
    """

    coefficients: tuple[str, ...]
    acting: str
    distributed: str = ""
    shear: str = ""
    arm: int = 0
    couple: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class Table(Brief):
    """All outputs of planar mechanisms, or of spatial ones.

    ``rows`` are in the order in which a solution keeps them. ``sizes`` are resultants that follow
    from these, and are no series of their own. ``sections`` says what each section force is made
    of, resultants left out.
    """

    conventions: str
    rows: tuple[Quantity, ...]
    sizes: tuple[Quantity, ...]
    sections: Mapping[str, Terms]

    def __contains__(self, key: tuple[str, str]) -> bool:
        """Return whether a group has such a member."""
        return key in self._by_key

    def row(self, group: str, member: str) -> Quantity:
        """The row of a group's member. Raises ``KeyError`` where there is none."""
        return self._by_key[group, member]

    def parts(self, group: str, member: str) -> tuple[str, ...]:
        """The members whose size a resultant is; of any other member itself."""
        of = self.row(group, member).of if (group, member) in self else ()
        return tuple(part for part in of if (group, part) in self) or (member,)

    @cached_property
    def law(self) -> tuple[str, ...]:
        """The members of a link's law."""
        return self._members("law")

    @cached_property
    def load_point(self) -> tuple[str, ...]:
        """The members of what acts on a link at a station."""
        return self._members("station")

    @cached_property
    def distributed(self) -> tuple[str, ...]:
        """The members of a load along a link that come once for each power of the place: its
        directions, that of the axis first.
        """
        return tuple(
            dict.fromkeys(
                terms.distributed for terms in self.sections.values() if terms.distributed
            )
        )

    @cached_property
    def couples(self) -> tuple[str, ...]:
        """The members of the rotary inertia of slices that come once for each power of the place,
        that about the axis first.
        """
        return tuple(terms.couple for terms in self.sections.values() if terms.couple)

    @cached_property
    def place_first(self) -> tuple[str, ...]:
        """Members of ``station`` in the order of emitted C and of a law's loads."""
        return ("station", *(member for member in self.load_point if member != "station"))

    @cached_property
    def forces(self) -> tuple[str, ...]:
        """The section forces, resultants last."""
        return self._members("section")

    @cached_property
    def reactions(self) -> tuple[str, ...]:
        """The resultants of a reaction."""
        return tuple(row.member for row in self.sizes if row.group == "reaction")

    @cached_property
    def _by_key(self) -> Mapping[tuple[str, str], Quantity]:
        return {(row.group, row.member): row for row in (*self.rows, *self.sizes)}

    def _members(self, group: str) -> tuple[str, ...]:
        return tuple(row.member for row in self.rows if row.group == group)


LARGEST = ("stress", "utilisation", "deflection")
"""The groups of what is largest along a link at an instant."""

ON_INBOARD = "action of the part towards the tip on the part towards the base"
_ON_CHILD = "action of the parent side on the child side"
_ON_FIRST = "on the body of the load's first point"
_ALONG = "positive along the joint's coordinate"
_BY_HAND = f"{ON_INBOARD}, by the right hand about"
_ABOUT = "moment of the joint about its point on the child"
_COORDINATE_OF = "coordinate of the joint: child against parent"
_MOTION = (
    Quantity("motion", "rate", "{q}/s", "rate of the joint's coordinate"),
    Quantity("motion", "acceleration", "{q}/s^2", "acceleration of the joint's coordinate"),
    Quantity("pose", "x", LENGTH, "place of the base, x"),
    Quantity("pose", "y", LENGTH, "place of the base, y"),
)
_DRIVES_AND_REACTION = (
    Quantity("effort", "", "{Q}", "effort of the drive", _ALONG),
    Quantity(
        "holding",
        "least",
        "{Q}",
        "least effort that holds the mechanism while joints with friction rest",
        _ALONG,
    ),
    Quantity("holding", "largest", "{Q}", "largest effort that holds it there", _ALONG),
    Quantity("reaction", "fx", FORCE, "reaction of the joint, x", _ON_CHILD),
    Quantity("reaction", "fy", FORCE, "reaction of the joint, y", _ON_CHILD),
)
_MULTIPLIER_AND_LOAD = (
    Quantity("multiplier", "", "1", "multiplier of a constraint or a non-holonomic row"),
    Quantity("load", "fx", FORCE, "applied force, x", _ON_FIRST),
    Quantity("load", "fy", FORCE, "applied force, y", _ON_FIRST),
)
_RESIDUALS = {
    "balance": "Newton-Euler balance of all bodies, over the largest force of the cycle",
    "power": "balance of power, over the largest force times speed of the cycle",
    "closure": "gaps of joints and residuals of user-defined equations, over the length of all"
    " links",
    "friction": "residual of the friction laws, over the largest friction of the cycle",
    "ends": "section forces at the base less the forces that act there, over the largest force of"
    " the cycle",
    "elasticity": "distance of the strain energy from its minimum, as a cosine",
    "energy": "error of the energy balance of a free machine, relative to its largest energy",
    "drive": "effort of a free machine less that of its drive, over the largest torque",
    "condition": "condition of the loops: 1/sin(transmission angle), or 2/volume",
}
"""Meanings of the residuals of a certificate."""

_OTHERS = (
    Quantity(
        "friction", "along", "{Q}", "friction along the joint's coordinate, on the child", _ALONG
    ),
    Quantity(
        "friction",
        "loss",
        "W",
        "power that friction takes from the mechanism",
        "positive where it brakes",
    ),
    Quantity("output", "", "1", "user-defined output"),
    Quantity(
        "stress",
        "von_mises",
        "Pa",
        "von Mises' stress, the largest along the link",
        "never negative",
    ),
    Quantity(
        "utilisation", "yield", "1", "one over the factor of safety against yielding, by von Mises"
    ),
    Quantity("utilisation", "buckling", "1", "one over the factor of safety against buckling"),
    Quantity(
        "deflection",
        "across",
        LENGTH,
        "deflection across the link, the largest along it",
        "never negative",
    ),
    *(Quantity("certificate", name, "1", meaning) for name, meaning in _RESIDUALS.items()),
    Quantity(
        "section",
        "axial",
        FORCE,
        "axial force",
        f"tension is positive: {ON_INBOARD}, along the axis",
    ),
)
_LOAD_POINT_N = Quantity("station", "n", FORCE, "force on the link at a load point, along the axis")


def _spread(member: str, direction: str) -> Quantity:
    meaning = f"load along the link {direction}: coefficient of a power of (end - xi/l)/width"
    return Quantity("spread", member, "N/m", meaning)


_LOAD_PLACE = (
    Quantity("station", "station", "1", "position of the load point, ratio xi/l"),
    Quantity(
        "spread", "width", "1", "on how much of the link the load along it acts, as a ratio to l"
    ),
    Quantity("spread", "end", "1", "where the load along the link ends, ratio xi/l"),
    _spread("qn", "in the direction of the axis"),
)


def _law(prefix: str, force: str) -> tuple[Quantity, ...]:
    unit_of = f"{force} for a unit of the"
    rest = "from the section to the tip"
    return (
        Quantity("law", f"{prefix}0", FORCE, f"{force} at the tip"),
        Quantity("law", f"{prefix}1", "m/s^2", f"{unit_of} mass mu0 {rest}"),
        Quantity("law", f"{prefix}2", "1/s^2", f"{unit_of} first moment mu1 {rest}"),
    )


_AXIAL_LAW = _law("n", "axial force")

_N, _F, _FY, _FZ = ((f"{x}0", f"{x}1", f"{x}2") for x in ("n", "f", "fy", "fz"))
_FORCE_SIZES = (
    Quantity("reaction", "resultant", FORCE, "resultant of the joint's reaction",
        of=("fx", "fy", "fz")),
    Quantity("load", "resultant", FORCE, "size of the applied force", "never negative",
        ("fx", "fy", "fz")),
)  # fmt: skip

PLANE = Table(
    conventions=(
        "SI units; plane x-y; angles in rad, counter-clockwise; a link's axis e runs from its"
        " base (xi = 0) to its tip (xi = 1), n is 90 deg counter-clockwise of e; section forces"
        " are the action of the part towards the tip on the part towards the base, resolved on"
        " (e, n, z), so axial > 0 is tension and d(bending)/d(xi l) = -shear; a reaction is the"
        " action of the joint's parent on its child, in ground axes, its moment about the joint's"
        " point on the child; an effort is positive along its coordinate"
    ),
    rows=(
        Quantity("motion", "", "{q}", _COORDINATE_OF, "counter-clockwise, or along the axis"),
        *_MOTION,
        Quantity("pose", "angle", ANGLE, "direction of the axis, continuous in time",
            "counter-clockwise from x"),
        *_DRIVES_AND_REACTION,
        Quantity("reaction", "mz", MOMENT, _ABOUT, _ON_CHILD),
        *_MULTIPLIER_AND_LOAD,
        Quantity("load", "mz", MOMENT, "applied torque", _ON_FIRST),
        *_OTHERS,
        Quantity("section", "shear", FORCE, "shear force",
            f"{ON_INBOARD}, 90 deg counter-clockwise of the axis"),
        Quantity("section", "bending", MOMENT, "bending moment",
            f"{ON_INBOARD}, counter-clockwise"),
        *_AXIAL_LAW,
        *_law("f", "shear force"),
        Quantity("law", "m0", MOMENT, "bending moment at the tip"),
        _LOAD_POINT_N,
        Quantity("station", "f", FORCE,
            "force on the link at a load point, 90 deg counter-clockwise of the axis"),
        Quantity("station", "m", MOMENT, "moment on the link at a load point"),
        *_LOAD_PLACE,
        _spread("qf", "90 deg counter-clockwise of the axis"),
    ),
    sizes=_FORCE_SIZES,
    sections={
        "axial": Terms(_N, "n", "qn"),
        "shear": Terms(_F, "f", "qf"),
        "bending": Terms(("m0", *_F), "m", "qf", "shear", 1),
    },
)  # fmt: skip
SPACE = Table(
    conventions=(
        "SI units; axes x, y, z, right-handed; angles in rad, by the right hand about their axis;"
        " a link's axis x runs from its base (xi = 0) to its tip (xi = 1), y and z are its"
        " cross-section's axes; section forces are the action of the part towards the tip on the"
        " part towards the base, resolved on the link's axes, so axial > 0 is tension,"
        " d(bending_z)/d(xi l) = -shear_y and d(bending_y)/d(xi l) = shear_z; shear and bending"
        " are the resultants of both components; a reaction is the action of the joint's parent"
        " on its child, in ground axes, its moment about the joint's point on the child, and"
        " again on the joint's own axes u, v, w, which its parent carries; an effort is positive"
        " along its coordinate"
    ),
    rows=(
        Quantity("motion", "", "{q}", _COORDINATE_OF,
            "by the right hand about, or along, the axis"),
        *_MOTION,
        Quantity("pose", "z", LENGTH, "place of the base, z"),
        *(Quantity("pose", f"{axis}{of}", "1",
            f"direction of the body's axis {axis}, {of}") for axis in "xyz" for of in "xyz"),
        *_DRIVES_AND_REACTION,
        Quantity("reaction", "fz", FORCE, "reaction of the joint, z", _ON_CHILD),
        *(Quantity("reaction", f"m{x}", MOMENT, f"{_ABOUT}, {x}", _ON_CHILD) for x in "xyz"),
        *(Quantity("reaction", f"f{u}", FORCE, f"reaction along the joint's own axis {u}",
            _ON_CHILD) for u in "uvw"),
        *(Quantity("reaction", f"m{u}", MOMENT, f"{_ABOUT}, about its own axis {u}",
            _ON_CHILD) for u in "uvw"),
        *_MULTIPLIER_AND_LOAD,
        Quantity("load", "fz", FORCE, "applied force, z", _ON_FIRST),
        *(Quantity("load", f"m{x}", MOMENT, f"applied torque, {x}", _ON_FIRST) for x in "xyz"),
        *_OTHERS,
        Quantity("section", "shear_y", FORCE, "shear force, y",
            f"{ON_INBOARD}, along the link's y"),
        Quantity("section", "shear_z", FORCE, "shear force, z",
            f"{ON_INBOARD}, along the link's z"),
        Quantity("section", "torsion", MOMENT, "torsional moment", f"{_BY_HAND} the axis"),
        Quantity("section", "bending_y", MOMENT, "bending moment, y", f"{_BY_HAND} its y"),
        Quantity("section", "bending_z", MOMENT, "bending moment, z", f"{_BY_HAND} its z"),
        Quantity("section", "shear", FORCE, "resultant shear force", "never negative",
            ("shear_y", "shear_z")),
        Quantity("section", "bending", MOMENT, "resultant bending moment", "never negative",
            ("bending_y", "bending_z")),
        *_AXIAL_LAW,
        *_law("fy", "shear force, y,"),
        Quantity("law", "mz0", MOMENT, "bending moment at the tip, z"),
        *_law("fz", "shear force, z,"),
        Quantity("law", "my0", MOMENT, "bending moment at the tip, y"),
        Quantity("law", "mx0", MOMENT, "torsional moment at the tip"),
        _LOAD_POINT_N,
        Quantity("station", "fy", FORCE, "force on the link at a load point, along the link's y"),
        Quantity("station", "fz", FORCE, "force on the link at a load point, along the link's z"),
        Quantity("station", "mx", MOMENT, "moment on the link at a load point, about the axis"),
        Quantity("station", "my", MOMENT, "moment on the link at a load point, about the link's y"),
        Quantity("station", "mz", MOMENT, "moment on the link at a load point, about the link's z"),
        *_LOAD_PLACE,
        _spread("qfy", "in the direction of the link's y"),
        _spread("qfz", "in the direction of the link's z"),
        *(Quantity("spread", f"c{x}", FORCE, f"couple of the slices' rotary inertia, {x}:"
            " coefficient of a power of (end - xi/l)/width") for x in "xyz"),
    ),
    sizes=(
        *_FORCE_SIZES,
        Quantity("reaction", "moment", MOMENT, "resultant of the joint's moment",
            of=("mx", "my", "mz")),
        Quantity("load", "moment", MOMENT, "size of the applied torque", "never negative",
            ("mx", "my", "mz")),
    ),
    sections={
        "axial": Terms(_N, "n", "qn"),
        "shear_y": Terms(_FY, "fy", "qfy"),
        "shear_z": Terms(_FZ, "fz", "qfz"),
        "torsion": Terms(("mx0",), "mx", couple="cx"),
        "bending_y": Terms(("my0", *_FZ), "my", "qfz", "shear_z", -1, "cy"),
        "bending_z": Terms(("mz0", *_FY), "mz", "qfy", "shear_y", 1, "cz"),
    },
)  # fmt: skip


def table_of(space: bool) -> Table:
    """The table of spatial mechanisms, or that of planar ones."""
    return SPACE if space else PLANE
