"""Closed forms of planar loops: a loop's equations solved for its unknown coordinates without iteration.

Phi is affine in the (cosine, sine) of every angle and in every slide, so all five planar dyads come down to two problems:

* one direction on a line, A c + B s + C = 0: what is left of RRP, RPR, and of a point guided along a line, when the slide is
  projected out;
* two directions, L1 e1 + L2 e2 + p = 0: two circles meet, RRR.

Each has two solutions, told apart by a sign. What stands under the root is a product of a sum and a difference, so nothing
cancels near a dead centre; divided by its largest value it is the square of the sine of the transmission angle, here called
the *closure*: negative where the links do not reach, zero at a dead centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from .multibody import Coordinate


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """Solved variables, one column a coordinate, as expressions in what is known and in ``branch`` (+1 or -1).

    ``closure`` is None where the solution is unique (slides, and angles that are tied to others).
    """

    branch: Any
    variables: tuple[Any, ...]
    closure: Any | None


def solve_loop(phi: Any, unknown: Sequence[Coordinate]) -> ClosedForm | None:
    """The closed form of Phi = 0 for one or two unknown coordinates, or None where there is none."""
    branch = ca.SX.sym("branch")
    kinds = "".join(sorted(c.kind[0] for c in unknown))
    counted = ca.vertcat(ca.SX(0, 1), *(c.value for c in unknown if c.kind == "angle"))
    if ca.depends_on(phi, counted):
        return _tied(phi, unknown[0], branch) if phi.numel() == 1 and kinds == "a" else None
    if phi.numel() == 1 and kinds == "a":
        solved = _direction_on_line(phi, unknown[0], branch)
        return solved and ClosedForm(branch, (_variables(solved[0]),), solved[1])
    if phi.numel() == 2 and kinds == "aa":
        return _two_circles(phi, unknown, branch)
    if phi.numel() == 2 and kinds == "as":
        angle, slide = sorted(unknown, key=lambda c: c.kind)
        form = _direction_and_slide(phi, angle, slide, branch)
        if form is not None and unknown[0] is slide:
            form = ClosedForm(branch, form.variables[::-1], form.closure)
        return form
    if kinds in ("s", "ss") and phi.numel() == len(unknown):
        return _slides(phi, unknown, branch)
    return None


def _affine(phi: Any, symbols: Any, all_unknown: Any) -> tuple[Any, Any] | None:
    """Slope and rest of Phi = slope @ symbols + rest, or None where the slope depends on an unknown."""
    slope = ca.jacobian(phi, symbols)
    if ca.depends_on(slope, all_unknown):
        return None
    return slope, ca.substitute(phi, symbols, ca.SX.zeros(symbols.numel()))


def _direction_on_line(phi: Any, angle: Coordinate, branch: Any) -> tuple[Any, Any] | None:
    affine = _affine(phi, _pair(angle), _pair(angle))
    if affine is None:
        return None
    slope, rest = affine
    a, b = slope[0], slope[1]
    if a.is_zero() and b.is_zero():
        return None
    if a.is_zero() or b.is_zero():
        reach = b if a.is_zero() else a
        cross = branch * ca.sqrt((reach - rest) * (reach + rest)) / reach
        along = -rest / reach
        closure = (reach - rest) * (reach + rest) / _square(reach)
        return (ca.vertcat(cross, along) if a.is_zero() else ca.vertcat(along, cross)), closure
    squared = _square(a) + _square(b)
    reach = ca.sqrt(squared)
    if rest.is_zero():
        return branch * ca.vertcat(-b, a) / reach, ca.SX(1)
    root = (reach - rest) * (reach + rest)
    w = branch * ca.sqrt(root)
    return ca.vertcat(-a * rest - b * w, -b * rest + a * w) / squared, root / squared


def _two_circles(phi: Any, unknown: Sequence[Coordinate], branch: Any) -> ClosedForm | None:
    symbols = ca.vertcat(*(_pair(c) for c in unknown))
    affine = _affine(phi, symbols, symbols)
    if affine is None:
        return None
    slope, rest = affine
    arms = [(slope[0, 2 * i], slope[1, 2 * i]) for i in range(2)]
    l1, l2 = (_norm(*arm) for arm in arms)
    px, py = -rest[0], -rest[1]
    squared = _square(px) + _square(py)
    d = ca.sqrt(squared)
    further, nearer = d + l2, d - l2
    root = ((l1 + l2 + d) * (l1 + l2 - d)) * ((further - l1) * (nearer + l1)) / 4
    w = branch * ca.sqrt(root)
    reach = (_square(l1) + nearer * further) / 2
    first = ((px * reach - py * w) / squared, (py * reach + px * w) / squared)
    # What is left of p: its error is what p's own rounding makes of this arm.
    second = (px - first[0], py - first[1])
    directions = tuple(_variables(_direction(v, arm)) for v, arm in zip((first, second), arms, strict=True))
    return ClosedForm(branch, directions, root / _square(l1 * l2))


def _direction_and_slide(phi: Any, angle: Coordinate, slide: Coordinate, branch: Any) -> ClosedForm | None:
    """Project the slide out along its own axis, a unit vector; what is left is a direction on a line."""
    pair = _pair(angle)
    unknown = ca.vertcat(pair, slide.variables)
    axis = ca.jacobian(phi, slide.variables)
    if not ca.depends_on(axis, unknown):
        across = -axis[1] * phi[0] + axis[0] * phi[1]
        rest = ca.substitute(across, slide.variables, 0)
        if ca.depends_on(ca.jacobian(across, slide.variables), unknown):
            return None
        along = axis[0] * phi[0] + axis[1] * phi[1]
    else:
        # The axis turns with the angle: Phi = p + R (b + axis sigma), and R' Phi is affine where R' R need not be formed.
        turned = ca.jacobian(phi, pair)
        fixed = ca.substitute(phi, pair, ca.SX.zeros(2))
        if ca.depends_on(fixed, slide.variables) or ca.depends_on(turned, pair):
            return None
        own = ca.jacobian(turned[:, 0], slide.variables)
        arm = ca.substitute(turned[:, 0], slide.variables, 0)
        if ca.depends_on(own, unknown):
            return None
        c, s = pair[0], pair[1]
        resolved = (c * fixed[0] + s * fixed[1] + arm[0], c * fixed[1] - s * fixed[0] + arm[1])
        rest = own[0] * resolved[1] - own[1] * resolved[0]
        along = own[0] * resolved[0] + own[1] * resolved[1]
    solved = _direction_on_line(rest, angle, branch)
    if solved is None:
        return None
    direction, closure = solved
    place = -ca.substitute(along, unknown, ca.vertcat(direction, 0))
    return ClosedForm(branch, (_variables(direction), place), closure)


def _tied(phi: Any, angle: Coordinate, branch: Any) -> ClosedForm | None:
    """An angle that counts turns and follows another one, as in a gear."""
    affine = _affine(phi, angle.value, angle.variables)
    if affine is None or ca.depends_on(affine[1], _pair(angle)):
        return None
    value = -affine[1] / affine[0]
    return ClosedForm(branch, (ca.vertcat(ca.cos(value), ca.sin(value), value),), None)


def _slides(phi: Any, unknown: Sequence[Coordinate], branch: Any) -> ClosedForm | None:
    symbols = ca.vertcat(*(c.variables for c in unknown))
    affine = _affine(phi, symbols, symbols)
    if affine is None:
        return None
    places = ca.solve(affine[0], -affine[1])
    return ClosedForm(branch, tuple(places[i] for i in range(len(unknown))), None)


def _norm(x: Any, y: Any) -> Any:
    if x.is_zero() or y.is_zero():
        return ca.fabs(x if y.is_zero() else y)
    return ca.sqrt(_square(x) + _square(y))


def _direction(vector: tuple[Any, Any], arm: tuple[Any, Any]) -> Any:
    """The direction that turns ``arm`` into ``vector``."""
    (x, y), (a, b) = vector, arm
    if b.is_zero():
        return ca.vertcat(x / a, y / a)
    return ca.vertcat(a * x + b * y, a * y - b * x) / (_square(a) + _square(b))


def _pair(angle: Coordinate) -> Any:
    return angle.variables[:2]


def _variables(direction: Any) -> Any:
    return ca.vertcat(direction, ca.atan2(direction[1], direction[0]))


def _square(x: Any) -> Any:
    return x * x
