"""Symbols by which a user's own outputs see what is found: accelerations, and forces.

Loads and constraints cannot see them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias, overload

import casadi as ca

from ..base.quantities import Output, force_members
from ..base.tables import table_of
from ..errors import DeclarationError, UnknownNameError
from .constraints import Constraint, Row
from .declared_parts import Asked, Body, Expression, Link, Point
from .joints import Joint
from .limits import no_sections
from .link_density import Density
from .loads import Friction, Load
from .ownership import Ownership

_Part: TypeAlias = Load | Friction | Constraint | Row
"""Part of a mechanism that has results of its own."""


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

    ownership: Ownership

    @overload
    def acceleration(self, of: Joint) -> ca.SX: ...

    @overload
    def acceleration(self, of: Body | Point) -> tuple[ca.SX, ...]: ...

    def acceleration(self, of: Joint | Body | Point) -> ca.SX | tuple[ca.SX, ...]:
        """The symbol of the acceleration of a joint's coordinate; or those of a point's, in ground
        axes [m/s^2].
        """
        measures = self.ownership.declared.measures
        if isinstance(of, Joint):
            return measures.joint(*self.ownership.moving_joint(of)).accelerations[0]
        return measures.point(self.ownership.point("acceleration", of)).accelerations

    def effort(self, joint: Joint, *, passive: bool = False) -> ca.SX:
        """The symbol of the effort of the drive at a joint, along its coordinate.

        If ``passive``, the joint may be no drive, and its effort is zero then.
        """
        coordinate = self.ownership.moving_joint(joint)[1].coordinate
        return self._ask(Output("effort", coordinate), passive=passive)

    def reaction(self, joint: Joint) -> Force | SpatialForce:
        """The symbols of a joint's reaction: what its parent does to its child, without the drive's
        effort.
        """
        joint = self.ownership.joint(joint)
        return self._force("reaction", joint.name, moment=joint.bears_moment)

    def load(self, load: Load) -> Force | SpatialForce:
        """The symbols of what a load does to the body of its first point."""
        name = self._own("load", load, self.ownership.declared.loads.values())
        return self._force("load", name, moment=True)

    def friction(self, friction: Friction) -> FrictionSymbols:
        """The symbols of a friction and of the power that it takes."""
        loads = self.ownership.declared.loads.values()
        name = self._own("friction", friction, [x for x in loads if isinstance(x, Friction)])
        return FrictionSymbols(
            self._ask(Output("friction", name, "along")),
            self._ask(Output("friction", name, "loss")),
        )

    def multiplier(self, of: Constraint | Row) -> ca.SX:
        """The symbol of the multiplier of a constraint or a non-holonomic constraint."""
        declared = self.ownership.declared
        name = self._own(
            "constraint", of, [*declared.constraints.values(), *declared.rows.values()]
        )
        return self._ask(Output("multiplier", name))

    def section(self, link: Link, ratio: Expression) -> SectionForces | SpatialSectionForces:
        """The symbols of the forces at a section of a link, at a ratio xi/l from 0 to 1; at a
        station, on its tip's side.

        The ratio is a number, or an expression of parameters.
        """
        declared = self.ownership.declared
        body = self.ownership.point("section", link).body
        if not isinstance(body, Link) or not isinstance(body.mass, Density):
            raise DeclarationError(
                "section:"
                f" {no_sections(body.name, link=isinstance(body, Link), links=declared.links)}"
            )
        ratio = self.ownership.expression(f"section of '{body.name}': ratio", ratio)
        if not isinstance(ratio, ca.SX) and not 0.0 <= ratio <= 1.0:
            raise DeclarationError(
                f"section of '{body.name}': expected a ratio xi/l from 0 to 1, got {ratio:g}"
            )
        forces = (
            self._ask(Output("section", body.name, member), ratio)
            for member in table_of(declared.space).sections
        )
        return SpatialSectionForces(*forces) if declared.space else SectionForces(*forces)

    def _force(self, group: str, part: str, *, moment: bool) -> Force | SpatialForce:
        space = self.ownership.declared.space
        known = force_members(space, moment=moment)
        found = [
            self._ask(Output(group, part, member)) if member in known else 0.0
            for member in force_members(space)
        ]
        return SpatialForce(*found) if space else Force(*found)

    def _ask(
        self, output: Output, ratio: Expression | None = None, *, passive: bool = False
    ) -> ca.SX:
        asked = self.ownership.declared.asked
        key = output, ratio.element_hash() if isinstance(ratio, ca.SX) else ratio, passive
        if key not in asked:
            asked[key] = Asked(output, ca.SX.sym(str(output)), ratio, passive)
        return asked[key].symbol

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
                f"{kind} of mechanism '{self.ownership.declared.name}'",
                str(name),
                [one.name for one in parts],
            )
        return str(part.name)
