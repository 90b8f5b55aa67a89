"""Joints of a plane, from what a user says of them."""

from __future__ import annotations

from ..errors import DeclarationError
from .expressions import unit_vector
from .joints import Joint, JointKind
from .ownership import Ownership
from .parts import Body, Expression, Point


def in_plane(
    ownership: Ownership,
    name: str,
    kind: JointKind,
    parent: Body | Point,
    child: Body | Point,
    axis: tuple[Expression, Expression] | None,
    angle: Expression | None,
) -> Joint:
    """A joint between points of two bodies.

    Raises :class:`DeclarationError` for one that cannot be.
    """
    what = f"joint '{name}'"
    start, end = ownership.point(what, parent), ownership.point(what, child)
    if start.body is end.body:
        raise DeclarationError(f"{what} joins '{start.body.name}' to itself")
    if kind != "revolute" and not start.body.oriented:
        raise DeclarationError(
            f"{what}: its parent '{start.body.name}' is a point mass, which has no direction for"
            f" {'the weld' if kind == 'weld' else 'the axis'}; make the other body the parent"
        )
    unit = (
        (1.0, 0.0)
        if axis is None
        else unit_vector(what, axis, lambda a: ownership.expression(f"{what}: axis", a))
    )
    turn = 0.0 if angle is None else ownership.expression(f"{what}: angle", angle, "rad")
    return Joint(name, kind, start, end, unit, turn, turn_given=angle is not None)
