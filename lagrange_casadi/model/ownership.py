"""Checks of a declaration's arguments: parts of the same mechanism, expressions of its own symbols,
names that are free.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import get_args

import casadi as ca

from ..base.scalars import column, entries
from ..base.units import unlike
from ..errors import DeclarationError
from .constraints import Constraint, Row
from .declaration import Declaration
from .declared_parts import (
    Body,
    Expression,
    Ground,
    Link,
    Parameter,
    Path,
    Point,
    PointMass,
    UserOutput,
    Vector,
)
from .drives import Drive
from .expressions import check_name, scalar
from .joints import Axis, Joint
from .limits import END, ROUNDED
from .link_density import Density
from .loads import Load

_WORDS: dict[type[object], str] = dict.fromkeys(get_args(Load), "a load") | {
    Constraint: "a constraint",
    Drive: "a drive",
    Ground: "the ground",
    Joint: "a joint",
    Link: "a link",
    UserOutput: "an output",
    Parameter: "a parameter",
    Path: "a path",
    PointMass: "a point mass",
    Row: "a non-holonomic constraint",
}


def _by_name(parts: str, name: object, known: Mapping[str, object]) -> str:
    """Say where the part of a name stands, if that is what was given."""
    return f"; m.{parts}['{name}'] is the part" if isinstance(name, str) and name in known else ""


Part = Parameter | Body | Joint | Load | Drive | Constraint | Row | UserOutput | Path


@dataclass(frozen=True, eq=False)
class Ownership:
    """Parts and names of what is ``declared`` of a mechanism.

    Methods return what they were given, and raise :class:`.DeclarationError` for anything else.
    """

    declared: Declaration

    def point(self, what: str, place: Body | Point) -> Point:
        """A point of a body: of a link its base, of any other its origin."""
        if isinstance(place, Body):
            point = place.base if isinstance(place, Link) else Point(place, 0.0, 0.0)
        else:
            point = place
        if not isinstance(point, Point):
            raise DeclarationError(
                f"{what}: expected a link, a point mass, the ground or a point of one, as"
                f" LINK.at(0.1, 0), got {place!r}{_by_name('bodies', place, self.declared.bodies)}"
            )
        if self.declared.bodies.get(point.body.name) is not point.body:
            raise DeclarationError(
                f"{what}: '{point.body.name}' belongs to another mechanism than"
                f" '{self.declared.name}'"
            )
        place_of = f"{what}: place on '{point.body.name}'"
        x, y, z = (self.expression(place_of, number, "m") for number in point.place)
        if not self.declared.space and not (isinstance(z, float) and z == 0.0):
            raise DeclarationError(
                f"{place_of}: a planar mechanism has no z, got {z}; use SpatialMechanism for one"
                " in space"
            )
        body, end = point.body, point.end
        if isinstance(body, Link) and isinstance(body.mass, Density) and end is None:
            x = self.along(what, x, body)
        return Point(body, x, y, end, z)

    def along(self, what: str, x: Expression, link: Link) -> Expression:
        """A place of a part ``what`` along a link [m]; or where the rounding of a drawing put it
        beyond an end, by as much for any parameters, that end.
        """
        for end, beyond in ((0.0, -x), (link.length, x - link.length)):
            if ca.jacobian(ca.SX(beyond), column(ca.symvar(ca.SX(beyond)))).is_zero():
                size, far = self.at_defaults(link.length), self.at_defaults(beyond)
                if END["double"] * size < far <= ROUNDED * size:
                    self.snapped(what, distance=far)
                    return end
        return x

    def snapped(self, what: str, *, angle: float = 0.0, distance: float = 0.0) -> None:
        """Note by how much an axis [rad] or a place [m] of a part is taken as the exact one that a
        drawing rounded.
        """
        if (angle or distance) and not self.declared.frozen:
            most = self.declared.snapped.get(what, (0.0, 0.0))
            self.declared.snapped[what] = max(most[0], angle), max(most[1], distance)

    def joint(self, joint: Joint) -> Joint:
        """A joint."""
        joints = self.declared.joints
        if not isinstance(joint, Joint) or joints.get(joint.name) is not joint:
            raise DeclarationError(
                f"expected a joint of mechanism '{self.declared.name}', got {joint!r}; joints:"
                f" {', '.join(joints)}{_by_name('joints', joint, joints)}"
            )
        return joint

    def moving_joint(self, joint: Joint, name: str = "") -> tuple[Joint, Axis]:
        """A joint that has a coordinate, and the axis of that name; it needs none where the joint
        has one axis.
        """
        axes = {axis.name: axis for axis in self.joint(joint).axes}
        if not axes:
            raise DeclarationError(f"joint '{joint.name}' has no coordinate")
        if name not in axes:
            valid = ", ".join(axes) if len(axes) > 1 else "it has one coordinate, which has no name"
            raise DeclarationError(
                f"joint '{joint.name}' has no coordinate '{name}'; valid: {valid}"
            )
        return joint, axes[name]

    def expression(
        self,
        what: str,
        value: Expression,
        unit: str = "1",
        *,
        moving: bool = False,
        found: bool = False,
    ) -> Expression:
        """A finite float, or an SX scalar in parameters; if ``moving`` in time and state too; if
        ``found`` in results too.

        A number in a ``unit`` may be a text, as ``"100 mm"``; a parameter alone must be in it.
        """
        declared, measures = self.declared, self.declared.measures
        symbols = [parameter.symbol for parameter in declared.parameters.values()]
        if moving:
            symbols += entries(column((declared.time, measures.places, measures.rates)))
        symbols += (
            [*measures.accelerations, *(asked.symbol for asked in declared.asked.values())]
            if found
            else []
        )
        allowed = "parameter, time, coordinate or rate" if moving else "parameter"
        allowed = f"{allowed.replace(' or rate', ', rate')} or result" if found else allowed
        read = scalar(what, value, symbols, f"{allowed} of mechanism '{declared.name}'", unit)
        if unit != "1" and isinstance(read, ca.SX) and read.is_symbolic():
            alone = declared.parameters.get(str(read))
            if alone and ca.is_equal(read, alone.symbol) and (wrong := unlike(alone.unit, unit)):
                raise DeclarationError(f"{what}: parameter '{alone.name}' is in {wrong}")
        return read

    def vector(self, what: str, value: object, unit: str = "1") -> Vector:
        """As many expressions as there are axes, in a unit; in a plane the third is zero."""
        axes, count = self.declared.measures.components, "three" if self.declared.space else "two"
        if not isinstance(value, (tuple, list)) or len(value) != len(axes):
            raise DeclarationError(
                f"{what} must be {count} components ({', '.join(axes)}), got {value!r}"
            )
        x, y, *z = (self.expression(what, component, unit) for component in value)
        return x, y, z[0] if z else 0.0

    def at_defaults(self, expression: Expression) -> float:
        """The value of an expression in the parameters, with their defaults."""
        parameters = self.declared.parameters
        return self.declared.number(
            expression, {name: parameter.default for name, parameter in parameters.items()}
        )

    def free(self, kind: str, name: str, table: Mapping[str, Part]) -> None:
        """Raise for a name that is taken, and where nothing can be added any more."""
        m = self.declared
        self.refuse_frozen(f"add {kind} '{name}'")
        # Files and scenes know joints, loads, constraints, rows and paths by their names alone,
        # beside those of links.
        acting: tuple[Mapping[str, Part], ...] = (
            *(m.joints, m.loads, m.constraints),
            *(m.rows, m.paths, m.drives),
        )
        check_name(kind, name)
        others = (m.bodies, *acting) if any(table is other for other in acting) else (table,)
        for part in (parts[name] for parts in others if name in parts):
            bearer = next(_WORDS[known] for known in type(part).__mro__ if known in _WORDS)
            if bearer in (f"a {kind}", f"an {kind}"):
                raise DeclarationError(f"{kind} '{name}' is declared twice in mechanism '{m.name}'")
            raise DeclarationError(
                f"{kind} '{name}': the name is taken by {bearer} of mechanism '{m.name}'"
            )

    def refuse_frozen(self, what: str) -> None:
        """Raise where nothing can be changed any more."""
        if self.declared.frozen:
            raise DeclarationError(
                f"cannot {what}: mechanism '{self.declared.name}' is frozen since a scene was"
                " made of it; declare all parts before the scene"
            )
