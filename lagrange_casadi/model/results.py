"""Symbols by which a user's own outputs see what is found: accelerations, and forces.

Loads and constraints cannot see them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, overload

import casadi as ca

from ..base.brief import Brief
from ..base.quantities import Output, force_members
from ..base.tables import table_of
from ..errors import DeclarationError, UnknownNameError
from .density import Density
from .joints import Joint
from .limits import no_sections
from .parts import Body, Constraint, Expression, Friction, Link, Load, Point, Row

if TYPE_CHECKING:
    from .mechanism import Mechanism

_Part: TypeAlias = Load | Friction | Constraint | Row
"""Part of a mechanism that has results of its own."""


@dataclass(frozen=True, eq=False)
class Asked:
    """A result that an output is made of, and the symbol that stands for it; of a section force the
    ratio xi/l.

    A ``passive`` effort is zero if the joint is not a drive; any other is refused.
    """

    output: Output
    symbol: ca.SX
    ratio: Expression | None = None
    passive: bool = False

    @property
    def wanted(self) -> str:
        """Outputs that must be wanted for it."""
        return (
            "effort" if self.output.group == "effort" else f"{self.output.group}:{self.output.part}"
        )


@dataclass(frozen=True, eq=False, repr=False)
class UserOutput(Brief):
    """An output of the user's own: an expression of time, parameters, measures and results, and its
    unit.
    """

    name: str
    expression: ca.SX
    unit: str
    made_of: tuple[Asked, ...]


class Force(NamedTuple):
    """The symbols of a force in ground axes [N], and of its moment [N m], which is 0 where there is
    none.
    """

    fx: Any
    fy: Any
    mz: Any


class SpatialForce(NamedTuple):
    """The symbols of a force in space, in ground axes [N], and of its moment [N m], which is 0
    where there is none.
    """

    fx: Any
    fy: Any
    fz: Any
    mx: Any
    my: Any
    mz: Any


class SpatialSectionForces(NamedTuple):
    """The symbols of the forces at a section in space, on the link's axes [N, N m]."""

    axial: Any
    shear_y: Any
    shear_z: Any
    torsion: Any
    bending_y: Any
    bending_z: Any


class FrictionSymbols(NamedTuple):
    """The symbols of friction along a joint's coordinate, on the child [N or N m], and of the power
    that it takes [W].
    """

    along: Any
    loss: Any


class SectionForces(NamedTuple):
    """The symbols of the forces at a section: axial and shear force [N], bending moment [N m]."""

    axial: Any
    shear: Any
    bending: Any


@dataclass(frozen=True, eq=False)
class Results:
    """Symbols for :meth:`.Mechanism.output` beside those for loads: accelerations and forces, in SI
    units.

    Methods raise :class:`.DeclarationError` for a part of another mechanism, or one that has no
    such result.
    """

    mechanism: Mechanism

    @overload
    def acceleration(self, of: Joint) -> ca.SX: ...

    @overload
    def acceleration(self, of: Body | Point) -> tuple[ca.SX, ...]: ...

    def acceleration(self, of: Joint | Body | Point) -> ca.SX | tuple[ca.SX, ...]:
        """The symbol of the acceleration of a joint's coordinate; or those of a point's, in ground
        axes [m/s^2].
        """
        measures, ownership = self.mechanism.measures, self.mechanism.ownership
        if isinstance(of, Joint):
            return measures.joint(*ownership.moving_joint(of)).accelerations[0]
        return measures.point(ownership.point("acceleration", of)).accelerations

    def effort(self, joint: Joint, *, passive: bool = False) -> ca.SX:
        """The symbol of the effort of the drive at a joint, along its coordinate.

        If ``passive``, the joint may be no drive, and its effort is zero then.
        """
        coordinate = self.mechanism.ownership.moving_joint(joint)[1].coordinate
        return self._ask(Output("effort", coordinate), passive=passive)

    def reaction(self, joint: Joint) -> Force | SpatialForce:
        """The symbols of a joint's reaction: what its parent does to its child, without the drive's
        effort.
        """
        joint = self.mechanism.ownership.joint(joint)
        return self._force("reaction", joint.name, moment=joint.bears_moment)

    def load(self, load: Load) -> Force | SpatialForce:
        """The symbols of what a load does to the body of its first point."""
        return self._force(
            "load", self._own("load", load, self.mechanism.loads.values()), moment=True
        )

    def friction(self, friction: Friction) -> FrictionSymbols:
        """The symbols of a friction and of the power that it takes."""
        sliding = [load for load in self.mechanism.loads.values() if isinstance(load, Friction)]
        name = self._own("friction", friction, sliding)
        return FrictionSymbols(
            self._ask(Output("friction", name, "along")),
            self._ask(Output("friction", name, "loss")),
        )

    def multiplier(self, of: Constraint | Row) -> ca.SX:
        """The symbol of the multiplier of a constraint or a non-holonomic constraint."""
        ownership: tuple[_Part, ...] = (
            *self.mechanism.constraints.values(),
            *self.mechanism.rows.values(),
        )
        return self._ask(Output("multiplier", self._own("constraint", of, ownership)))

    def section(self, link: Link, ratio: Expression) -> SectionForces | SpatialSectionForces:
        """The symbols of the forces at a section of a link, at a ratio xi/l from 0 to 1; at a
        station, on its tip's side.

        The ratio is a number, or an expression of parameters.
        """
        mechanism = self.mechanism
        body = mechanism.ownership.point("section", link).body
        if not isinstance(body, Link) or not isinstance(body.mass, Density):
            raise DeclarationError(
                "section:"
                f" {no_sections(body.name, link=isinstance(body, Link), links=mechanism.links)}"
            )
        ratio = mechanism.ownership.expression(f"section of '{body.name}': ratio", ratio)
        if not isinstance(ratio, ca.SX) and not 0.0 <= ratio <= 1.0:
            raise DeclarationError(
                f"section of '{body.name}': expected a ratio xi/l from 0 to 1, got {ratio:g}"
            )
        forces = (
            self._ask(Output("section", body.name, member), ratio)
            for member in table_of(mechanism.space).sections
        )
        return SpatialSectionForces(*forces) if mechanism.space else SectionForces(*forces)

    def _force(self, group: str, part: str, *, moment: bool) -> Force | SpatialForce:
        space = self.mechanism.space
        forces = [
            self._ask(Output(group, part, member)) for member in force_members(space, moment=False)
        ]
        moments = force_members(space)[len(forces) :]
        found = [
            *forces,
            *(self._ask(Output(group, part, member)) if moment else 0.0 for member in moments),
        ]
        return SpatialForce(*found) if space else Force(*found)

    def _ask(
        self, output: Output, ratio: Expression | None = None, *, passive: bool = False
    ) -> ca.SX:
        asked = self.mechanism.asked
        for one in asked:
            same = one.ratio is ratio or (
                isinstance(ratio, float) and isinstance(one.ratio, float) and one.ratio == ratio
            )
            if one.output == output and same and one.passive == passive:
                return one.symbol
        asked.append(Asked(output, ca.SX.sym(str(output)), ratio, passive))
        return asked[-1].symbol

    def _own(
        self,
        kind: str,
        part: _Part,
        declared: Iterable[_Part],
    ) -> str:
        parts = list(declared)
        if isinstance(part, str) and part in [one.name for one in parts]:
            raise DeclarationError(
                f"expected the {kind} that its declaration returned, got its name '{part}'"
            )
        if not any(part is one for one in parts):
            name = getattr(part, "name", part)
            raise UnknownNameError(
                f"{kind} of mechanism '{self.mechanism.name}'",
                str(name),
                [one.name for one in parts],
            )
        return str(part.name)
