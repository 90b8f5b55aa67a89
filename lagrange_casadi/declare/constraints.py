"""Constraints and non-holonomic rows: what may be declared as one."""

from __future__ import annotations

import casadi as ca

from ..errors import DeclarationError
from .joints import Joint
from .ownership import Ownership
from .parts import Constraint, Row


def constraint(own: Ownership, name: str, phi: ca.SX) -> Constraint:
    """A constraint Phi = 0 of a mechanism. Raises :class:`DeclarationError` for what is none."""
    m = own.mechanism
    own.free("constraint", name, m.constraints)
    phi = own.expression(f"constraint '{name}'", phi, moving=True)
    if not isinstance(phi, ca.SX) or not ca.depends_on(phi, m.measures.places):
        raise DeclarationError(
            f"constraint '{name}' depends on no coordinate; expected an expression of"
            " coordinate(JOINT), place(POINT) or direction(LINK)"
        )
    if ca.depends_on(phi, m.measures.rates):
        raise DeclarationError(
            f"constraint '{name}' depends on rates; expected m.nonholonomic() for it"
        )
    return Constraint(name, phi)


def row(own: Ownership, name: str, expression: ca.SX, replaces: Joint) -> Row:
    """A non-holonomic row of a mechanism. Raises :class:`DeclarationError` for what is none."""
    m = own.mechanism
    own.free("non-holonomic constraint", name, m.rows)
    what = f"non-holonomic constraint '{name}'"
    expression = own.expression(what, expression, moving=True)
    if not isinstance(expression, ca.SX) or not ca.depends_on(expression, m.measures.rates):
        raise DeclarationError(
            f"{what} depends on no rate; expected an expression of rate(JOINT) or velocity(POINT)"
        )
    if ca.depends_on(ca.jacobian(expression, m.measures.rates), m.measures.rates):
        raise DeclarationError(f"{what} must be linear in the rates")
    found = Row(name, expression, own.joint(replaces).name)
    for other in m.rows.values():
        if other.replaces == found.replaces:
            raise DeclarationError(
                f"{what}: '{other.name}' already replaces the drive of joint '{found.replaces}'"
            )
    return found
