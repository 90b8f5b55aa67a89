"""Closed forms of legs in space: two ends that meet, one of which turns about an axis that is
known.

A turn about an axis u through A keeps two numbers of the end X that it turns: how far it is from A,
and its height along the axis. So of X = P two equations are free of the turn,

    |X - A|^2 = |P - A|^2    and    u . (X - P) = 0,

and where one of them holds a single freedom, the two are solved one after another; the turn is then
what leads X to P. So the slide of a leg with a universal joint at its foot (UPS) is known by the
distance and its second turn by the height; the same way go a leg that bends (URS), a link between a
turn and a slide, and a point in cylindrical coordinates. Across the axis, where heights meet
already, the distance alone is left: so go planar dyads, however their plane lies.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import casadi as ca

from ..base.arrays import Expression
from ..base.vectors import Vector, cross, dot, minus, times
from ..model.joints import Joint
from .loops import ClosedForm, Verified, at_rest, held, solve_in_turn
from .multibody import Coordinate, Multibody
from .sampling import Sampling


def solve_leg(
    joint: Joint, unknown: Sequence[Coordinate], multibody: Multibody, verified: Verified
) -> tuple[ClosedForm, ...]:
    """The closed forms, one after another, by which the two points of a joint meet; none where no
    pattern was ``verified``.
    """
    if not multibody.mechanism.space or joint.slides:
        return ()
    for first in unknown:
        if first.name in multibody.axes:
            forms = _leg(joint, first, [c for c in unknown if c is not first], multibody)
            if forms and verified(forms):
                return forms
    return ()


def _leg(
    joint: Joint, first: Coordinate, later: Sequence[Coordinate], multibody: Multibody
) -> tuple[ClosedForm, ...]:
    branch = multibody.tree.branch_of[multibody.mechanism.coordinates[first.name][0].name]
    foot = multibody.frames[branch.near.body.name].place_of(branch.near.place)
    axis = times(branch.sign, multibody.axes[first.name])
    ends = [
        multibody.frames[point.body.name].place_of(point.place)
        for point in (joint.parent, joint.child)
    ]
    ends.sort(key=lambda end: not held(end, (first,)))
    head, target = (minus(end, foot) for end in ends)
    if held((*target, *foot), (first,)) or held(axis, (first, *later)):
        return ()
    if len(later) == 1:
        head, target = cross(axis, head), cross(axis, target)
    sampling = Sampling.of(multibody)
    squares = _in_fewest(dot(head, head), later, sampling), dot(target, target)
    # One of the two is a length that nothing changes: beside it the gap is one in metres.
    fixed = next(
        (square for square in squares if square is not None and not held((square,), later)), None
    )
    if squares[0] is None or fixed is None:
        return ()
    length = ca.sqrt(fixed)
    near, far = (length if square is fixed else square / length for square in squares)
    equations = [(near - far) / 2]
    if len(later) == 2:
        height = _in_fewest(dot(axis, head), later, sampling)
        if height is None:
            return ()
        equations.append(height - dot(axis, target))
    forms = solve_in_turn(equations, later, sampling)
    return (*forms, _turned(first, axis, head, target, across=len(later) == 1)) if forms else ()


def _in_fewest(
    expression: Expression, later: Sequence[Coordinate], sampling: Sampling
) -> Expression | None:
    """An expression with all coordinates at rest but as few of the ``later`` ones as change it;
    None where others change it too.
    """
    for count in range(len(later) + 1):
        for kept in combinations(later, count):
            plain = at_rest(expression, [c for c in sampling.coordinates if c not in kept])
            if sampling.vanish(expression - plain, expression):
                return plain
    return None


def _turned(
    first: Coordinate, axis: Vector, head: Vector, target: Vector, *, across: bool
) -> ClosedForm:
    """The turn about an axis that leads from where the head is without it to the target, or where
    both are ``across`` the axis.

    A target on the axis determines no turn: the closure is the square of the sine between the two.
    """
    x, y, z = ca.vertsplit(at_rest(ca.vertcat(*head), (first,)))
    start, beside = (x, y, z), cross(axis, target)
    cosine = dot(start, target) - (0 if across else dot(axis, start) * dot(axis, target))
    sine = -dot(start, beside)
    length = ca.sqrt(cosine * cosine + sine * sine)
    variables = ca.vertcat(cosine / length, sine / length, ca.atan2(sine, cosine))
    closure = None if across else dot(beside, beside) / dot(target, target)
    return ClosedForm((variables,), closure, unknown=(first,))
