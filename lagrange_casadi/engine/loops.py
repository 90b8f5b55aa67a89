"""Closed forms of planar loops: a loop's equations solved for its unknown coordinates without
iteration.

The planar dyads, and points that are guided along lines in any way, come down to two problems:

* one direction on a line, A c + B s + C = 0: a point guided along a line; and what is left of
  equations that are linear in one direction and one slide, when the slide is eliminated (RRP, RPR,
  a bar guided at two of its points, ladders and trammels);
* two directions, L1 e1 + L2 e2 + p = 0: two circles meet, RRR.

Each has two solutions, distinguished by a sign. What stands under the root is a product of a sum
and a difference, so nothing cancels near a dead centre; divided by its largest value it is the
square of the sine of the transmission angle, here called the *closure*: negative where the links do
not reach, zero at a dead centre.

Two equations may be the x and y of one pin, or be written by different joints and constraints, and
look alike. So a form is applied where its pattern was verified, coefficient by coefficient, and
what it gives was put back into the equations (:mod:`.sampling`); what has no form is iterated.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, TypeAlias

import casadi as ca

from ..base.arrays import Expression
from ..base.scalars import column
from .linear import LinearSystem
from .multibody import Coordinate
from .sampling import Sampling


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """Solved variables of ``unknown`` coordinates, one column each, as expressions in what is known
    and in ``branches``.

    Each of the branches is a symbol of a sign (+1 or -1); there are none where the solution is
    unique. ``closure`` is None where it cannot fail but by a division by zero.
    """

    variables: tuple[Any, ...]
    closure: Any | None = None
    branches: tuple[Any, ...] = ()
    unknown: tuple[Coordinate, ...] = ()

    def without(self, absent: Sequence[Coordinate]) -> ClosedForm:
        """The form with coordinates that it must not hold at rest, for they stand in it by rounding
        alone.
        """
        absent = held((*self.variables, *(() if self.closure is None else (self.closure,))), absent)
        if not absent:
            return self
        closure = None if self.closure is None else at_rest(self.closure, absent)
        return replace(
            self, variables=tuple(at_rest(v, absent) for v in self.variables), closure=closure
        )


Verified: TypeAlias = Callable[[Sequence[ClosedForm]], bool]
"""Function that is true if solutions, one after another, satisfy the equations of a loop."""


def solve_loop(
    phi: ca.SX,
    unknown: Sequence[Coordinate],
    sampling: Sampling,
    verified: Verified,
    *,
    units: Expression = 1,
    two_force_link: bool = False,
) -> ClosedForm | None:
    """The closed form of Phi = 0 for some unknown ones of all coordinates, or None where there is
    none that was ``verified``.

    Phi of a ``bar`` is half of a square, and may be one of the unknown. By the factors ``units`` [a
    column, or one for all] equations are beside each other.
    """
    form = _spanned(phi, unknown, sampling) if two_force_link and len(unknown) == 1 else None
    form = form or _matching(phi, unknown, sampling, units)
    if form is None:
        return None
    form = replace(form, unknown=tuple(unknown))
    return form if verified((form,)) else None


def solve_in_turn(
    equations: Sequence[ca.SX], unknown: Sequence[Coordinate], sampling: Sampling
) -> tuple[ClosedForm, ...]:
    """The closed forms of equations, one after another, each of which holds one unknown more; none
    where they do not.

    An equation may be half of a square. The solutions are not put back.
    """
    forms: list[ClosedForm] = []
    rest = list(unknown)
    for equation in sorted(equations, key=lambda equation: len(held((equation,), unknown))):
        held_alone = held((equation,), rest)
        form = (
            _matching(equation, held_alone, sampling) or _spanned(equation, held_alone, sampling)
            if len(held_alone) == 1
            else None
        )
        if form is None:
            return ()
        forms.append(replace(form, unknown=tuple(held_alone)))
        rest.remove(held_alone[0])
    return tuple(forms)


def held(expressions: Sequence[Expression], coordinates: Sequence[Coordinate]) -> list[Coordinate]:
    """The coordinates that expressions hold."""
    parts = ca.veccat(*map(ca.SX, expressions))
    return [c for c in coordinates if ca.depends_on(parts, c.variables)]


def at_rest(expression: Expression, coordinates: Sequence[Coordinate]) -> Expression:
    """An expression with coordinates that are zero."""
    symbols = column(c.variables for c in coordinates)
    return ca.substitute(expression, symbols, column(ca.DM(c.resting) for c in coordinates))


def _spanned(phi: ca.SX, unknown: Sequence[Coordinate], sampling: Sampling) -> ClosedForm | None:
    """A bar's end that turns about one axis, or slides along one: two points of a circle or a line
    are so far from another one.

    The closure is the square of the sine between the bar and the arm that turns. That between the
    arm and the line from its axis to the bar's other end would be zero at the same instants, but
    that line may be short: it is a difference, and its rounding by far the larger.

    What turns may also lie askew, and its distance from an axis be given: a sine, or a cosine, of
    either sign, and both ways round.
    """
    (coordinate,) = unknown
    symbols = _pair(coordinate) if coordinate.kind == "angle" else coordinate.variables
    curvature = ca.hessian(phi, symbols)[0]
    if phi.numel() != 1 or ca.depends_on(curvature, coordinate.variables):
        return None
    if coordinate.kind == "angle":
        if not sampling.vanish(curvature[0, 1], curvature):
            return None
        if not sampling.vanish(curvature[0, 0] - curvature[1, 1], curvature):
            return _askew(phi, coordinate, curvature, sampling)
        # Where the squares of cosine and sine have one factor, they are one number.
        square = curvature[0, 0]
        straight = phi - square * (ca.sumsqr(symbols) - 1) / 2
        slope, rest = (
            ca.substitute(e, symbols, ca.SX.zeros(2))
            for e in (ca.jacobian(straight, symbols), straight)
        )
        # For an arm c, a line d to the bar's other end and a bar b, Phi = (X X - b b)/2, this is
        # c c d d + c c (c c - (d d + c c - b b)) = (b c)^2.
        largest = ca.sumsqr(slope) + square * (square - 2 * rest)
        return _direction_on_line(slope @ symbols + rest, coordinate, largest)
    slope, rest = (ca.substitute(e, symbols, 0) for e in (ca.jacobian(phi, symbols), phi))
    # The slope of Phi at its zeros, which is the cosine between bar and slide.
    squared, branch = slope**2 - 2 * curvature * rest, ca.SX.sym("branch")
    return ClosedForm(((branch * ca.sqrt(squared) - slope) / curvature,), squared, (branch,))


def _askew(
    phi: ca.SX, angle: Coordinate, curvature: ca.SX, sampling: Sampling
) -> ClosedForm | None:
    """A square of a sine, or of a cosine, and that sine are known to be of one sum: of two signs,
    each with two ways round.
    """
    pair = _pair(angle)
    slope, rest = (ca.substitute(e, pair, ca.SX.zeros(2)) for e in (ca.jacobian(phi, pair), phi))
    number = 0 if curvature[1, 1].is_zero() or not sampling.vanish(slope[0], curvature) else 1
    other = 1 - number
    if not sampling.vanish(slope[other], curvature):
        return None
    # With the square of the other one, which is one less this one's: bend x x + 2 slope x + rest =
    # 0.
    bend = curvature[number, number] - curvature[other, other]
    rest = rest + rest + curvature[other, other]
    signs = ca.SX.sym("branch"), ca.SX.sym("other_branch")
    if sampling.vanish(slope, curvature):
        squared = -rest / bend
        found = signs[0] * ca.sqrt(squared)
    else:
        squared = (slope[number] ** 2 - bend * rest) / bend**2
        found = signs[0] * ca.sqrt(squared) - slope[number] / bend
    beside = (1 - found) * (1 + found)
    direction = ca.vertcat(found, signs[1] * ca.sqrt(beside))
    return ClosedForm(
        (_variables(direction if number == 0 else direction[::-1]),),
        ca.fmin(squared, beside),
        signs,
    )


def _matching(
    phi: ca.SX, unknown: Sequence[Coordinate], sampling: Sampling, units: Expression = 1
) -> ClosedForm | None:
    """The closed form of the pattern that the equations have; None where they have none."""
    kinds = "".join(sorted(c.kind[0] for c in unknown))
    if phi.numel() != len(unknown):
        return None
    counted = column(c.value for c in unknown if c.kind == "angle")
    if set(kinds) == {"s"} or ca.depends_on(phi, counted):
        return _tied(phi, unknown, units)
    if kinds == "a":
        return _direction_on_line(phi, unknown[0])
    if kinds == "aa":
        return _two_circles(phi, unknown, sampling)
    if kinds != "as":
        return None
    angle, slide = sorted(unknown, key=lambda c: c.kind)
    form = _direction_and_slide(phi, angle, slide, sampling)
    return replace(form, variables=form.variables[::-1]) if form and unknown[0] is slide else form


def solves(forms: Sequence[ClosedForm], phi: ca.SX, sampling: Sampling) -> bool:
    """Return whether solutions, each of which may depend on those before, are ones of Phi = 0 on
    all branches.

    The equations of Phi have one unit: a gap is judged beside the largest of them.
    """
    symbols = column(c.variables for form in forms for c in form.unknown)
    # The size of what is added up in an equation: its slopes times what they are slopes of.
    size = ca.mmax(ca.fabs(ca.jacobian(phi, symbols)) @ ca.fabs(symbols))
    residual = ca.vertcat(phi, size)
    for form in reversed(forms):
        # Beside their squares: where links do not reach, by far where they are short, both are
        # large and imaginary.
        pairs = [c[:2] for c in form.variables if c.numel() > 1]
        directions = [
            (ca.sumsqr(pair) - 1) / (ca.sumsqr(ca.fabs(pair[0]) + ca.fabs(pair[1])) + 1)
            for pair in pairs
        ]
        residual = ca.vertcat(
            residual[:-1], *(residual[-1] * off for off in directions), residual[-1]
        )
        residual = ca.substitute(
            residual, column(c.variables for c in form.unknown), column(form.variables)
        )
    branches = column(branch for form in forms for branch in form.branches)
    ways = [
        ca.substitute(residual, branches, ca.SX(ca.DM(signs)))
        for signs in product((1, -1), repeat=branches.numel())
    ]
    return sampling.vanish(
        column(branch[:-1] for branch in ways), column(branch[-1] for branch in ways)
    )


def _affine(phi: ca.SX, symbols: ca.SX, all_unknown: ca.SX) -> tuple[ca.SX, ca.SX] | None:
    """Slope and rest of Phi = slope @ symbols + rest, or None where the slope depends on an
    unknown.
    """
    slope = ca.jacobian(phi, symbols)
    if ca.depends_on(slope, all_unknown):
        return None
    return slope, ca.substitute(phi, symbols, ca.SX.zeros(symbols.numel()))


def _direction_on_line(
    phi: ca.SX, angle: Coordinate, largest: ca.SX | None = None
) -> ClosedForm | None:
    """The direction for which phi = 0, and the closure: beside the square of its slope, or beside
    the ``largest`` there may be.
    """
    affine = _affine(phi, _pair(angle), _pair(angle))
    if affine is None:
        return None
    slope, rest = affine
    a, b, branch = slope[0], slope[1], ca.SX.sym("branch")
    if a.is_zero() and b.is_zero():
        return None
    squared = a**2 + b**2
    reach = b if a.is_zero() else a if b.is_zero() else ca.sqrt(squared)
    root = (reach - rest) * (reach + rest)
    if a.is_zero() or b.is_zero():
        cross, along = branch * ca.sqrt(root) / reach, -rest / reach
        direction = ca.vertcat(cross, along) if a.is_zero() else ca.vertcat(along, cross)
    elif rest.is_zero():
        direction, root = branch * ca.vertcat(-b, a) / reach, squared
    else:
        w = branch * ca.sqrt(root)
        direction = ca.vertcat(-a * rest - b * w, -b * rest + a * w) / squared
    closure = root / (squared if largest is None else largest)
    return ClosedForm((_variables(direction),), closure, (branch,))


def _two_circles(
    phi: ca.SX, unknown: Sequence[Coordinate], sampling: Sampling
) -> ClosedForm | None:
    symbols = ca.vertcat(*(_pair(c) for c in unknown))
    affine = _affine(phi, symbols, symbols)
    if affine is None or not all(
        _turns(affine[0][:, 2 * i : 2 * i + 2], sampling) for i in range(2)
    ):
        return None
    slope, rest = affine
    branch = ca.SX.sym("branch")
    arms = [(slope[0, 2 * i], slope[1, 2 * i]) for i in range(2)]
    l1, l2 = (ca.sqrt(x**2 + y**2) for x, y in arms)
    px, py = -rest[0], -rest[1]
    squared = px**2 + py**2
    d = ca.sqrt(squared)
    further, nearer = d + l2, d - l2
    # Four times the square of twice the triangle's area, and twice the projection of the first arm
    # on p, times p.
    root = ((further + l1) * (l1 - nearer)) * ((further - l1) * (nearer + l1))
    w = branch * ca.sqrt(root)
    reach = l1**2 + nearer * further
    twice = squared + squared
    first = ((px * reach - py * w) / twice, (py * reach + px * w) / twice)
    # What is left of p: its error is what p's own rounding makes of this arm.
    second = (px - first[0], py - first[1])
    directions = tuple(
        _variables(_direction(v, arm)) for v, arm in zip((first, second), arms, strict=True)
    )
    return ClosedForm(directions, root / (2 * (l1 * l2)) ** 2, (branch,))


def _turns(columns: ca.SX, sampling: Sampling) -> bool:
    """Return whether two columns, slopes by a cosine and a sine, are those of a rotating arm: (u,
    v) and (-v, u).
    """
    return sampling.vanish(columns[:, 1] - ca.vertcat(-columns[1, 0], columns[0, 0]), columns)


def _direction_and_slide(
    phi: ca.SX, angle: Coordinate, slide: Coordinate, sampling: Sampling
) -> ClosedForm | None:
    """Eliminate the slide; what is left is a direction on a line."""
    pair = _pair(angle)
    unknown = ca.vertcat(pair, slide.variables)
    axis, turned = ca.jacobian(phi, slide.variables), ca.jacobian(phi, pair)
    largest = None
    if not ca.depends_on(ca.vertcat(axis, ca.vec(turned)), unknown):
        along_axis, equations = axis, (phi[0], phi[1])
        if not (sampling.vanish(ca.sumsqr(axis) - 1) and _turns(turned, sampling)):
            # Not the x and y of one point that slides along a line: the lines may come to be
            # parallel.
            largest = ca.sumsqr(axis) * ca.sumsqr(turned)
    else:
        # The axis turns with the angle: Phi = p + R (b + axis sigma), and R' Phi is affine where R'
        # R need not be formed.
        fixed = ca.substitute(phi, pair, ca.SX.zeros(2))
        if (
            ca.depends_on(fixed, slide.variables)
            or ca.depends_on(turned, pair)
            or not _turns(turned, sampling)
        ):
            return None
        along_axis = ca.jacobian(turned[:, 0], slide.variables)
        arm = ca.substitute(turned[:, 0], slide.variables, 0)
        if ca.depends_on(along_axis, unknown):
            return None
        c, s = pair[0], pair[1]
        equations = (c * fixed[0] + s * fixed[1] + arm[0], c * fixed[1] - s * fixed[0] + arm[1])
    across = along_axis[0] * equations[1] - along_axis[1] * equations[0]
    form = _direction_on_line(ca.substitute(across, slide.variables, 0), angle, largest)
    if form is None:
        return None
    along = along_axis[0] * equations[0] + along_axis[1] * equations[1]
    place = -ca.substitute(along, unknown, ca.vertcat(form.variables[0][:2], 0))
    if not sampling.vanish(ca.sumsqr(along_axis) - 1):
        place = place / ca.sumsqr(along_axis)
    return replace(form, variables=(*form.variables, place))


def _tied(phi: ca.SX, unknown: Sequence[Coordinate], units: Expression) -> ClosedForm | None:
    """Angles that count turns, and slides, that follow others, as in a train of gears, and slides
    along lines that none of them turns; of several, the closure is the square of the volume that
    their slopes span.
    """
    if any(c.kind == "ball" for c in unknown):
        return None
    affine = _affine(phi, column(c.value for c in unknown), column(c.variables for c in unknown))
    if affine is None or ca.depends_on(affine[1], column(c.variables for c in unknown)):
        return None
    if len(unknown) == 1:
        return ClosedForm((_with_sine(unknown[0], -affine[1] / affine[0]),))
    system = LinearSystem.of(affine[0], units)
    values = ca.vertsplit(system.solve(-affine[1]))
    return ClosedForm(
        tuple(_with_sine(c, value) for c, value in zip(unknown, values, strict=True)),
        system.volume**2,
    )


def _with_sine(coordinate: Coordinate, value: Expression) -> Expression:
    return value if coordinate.kind == "slide" else ca.vertcat(ca.cos(value), ca.sin(value), value)


def _direction(vector: tuple[ca.SX, ca.SX], arm: tuple[ca.SX, ca.SX]) -> ca.SX:
    """The direction that turns ``arm`` into ``vector``."""
    (x, y), (a, b) = vector, arm
    if b.is_zero():
        return ca.vertcat(x / a, y / a)
    return ca.vertcat(a * x + b * y, a * y - b * x) / (a**2 + b**2)


def _pair(angle: Coordinate) -> Expression:
    return angle.variables[:2]


def _variables(direction: ca.SX) -> ca.SX:
    return ca.vertcat(direction, ca.atan2(direction[1], direction[0]))
