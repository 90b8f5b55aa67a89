"""Gaps of loops that do not close: between what ends they are, how wide, how far links reach, and
which lengths would close them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import casadi as ca
import numpy as np

from ..base.arrays import Array, Flags
from ..base.scalars import column
from ..base.tables import LENGTH
from ..model.declared_parts import Point
from ..model.joints import Joint
from .joint_closure import carried
from .multibody import LoopEquations, Multibody
from .nearest import Nearest
from .released_loops import State
from .sizes import directs

_OFFERED = 3
"""Changes of lengths that are said."""


@dataclass(frozen=True, eq=False)
class Gap:
    """A loop that does not close.

    ``ends`` (2, 3) are the places on the two bodies that the loop joins, in ground axes [m], which
    should be one; none of a constraint. ``size`` is how wide the gap is, in its ``unit``; that of a
    constraint is its residual, which has none. ``sentence`` says it in words.
    """

    ends: Array
    size: float
    unit: Literal["m", "rad", ""]
    sentence: str


def gaps_of(nearest: Nearest, state: State, left: Sequence[int]) -> tuple[Gap, ...]:
    """The gaps of the loops that are ``left`` open in a state."""
    closed = nearest.rows([k for k in range(len(nearest.released.loops)) if k not in left])
    held = nearest.held(state, closed) if left else set()
    found = []
    for k in left:
        gap = _gap(nearest, nearest.multibody.loop_equations[k])
        words = _reach(nearest, nearest.multibody.loop_equations[k], held) or gap.sentence
        if lengths := " or ".join(_lengths(nearest, state, closed, nearest.rows([k]))):
            words += f"; it closes with {lengths}"
        found.append(replace(gap, sentence=words))
    return tuple(found)


def joined(loop: LoopEquations) -> tuple[Point, Point]:
    """The points of two bodies that a joint or a two-force link joins."""
    if (bar := loop.two_force_link) is not None:
        one, other = bar.joints
        return bar.other(one), bar.other(other)
    assert loop.joint is not None
    return loop.joint.parent, loop.joint.child


def ends_of(multibody: Multibody, loop: LoopEquations) -> ca.SX:
    """Ends of the joint or two-force link that closes a loop, over coordinates (7,): the two places
    that should be one, in ground axes [m], and the sine of the angle between the bodies.
    """
    one, last = (
        column(multibody.frames[point.body.name].place_of(point.place)) for point in joined(loop)
    )
    if loop.two_force_link is not None:
        wide = ca.norm_2(last - one)
        along = (last - one) / ca.if_else(wide > 0.0, wide, 1.0)
        return column([one + loop.two_force_link.length * along, last, 0.0])
    assert loop.joint is not None
    parent, child = (multibody.frames[body.name] for body in loop.joint.bodies)
    sines = loop.residual[np.flatnonzero(directs(loop)).tolist()]
    there = parent.place_of(carried(loop.joint, parent, child))
    return column([*there, last, ca.sqrt(ca.sumsqr(sines))])


def _gap(nearest: Nearest, loop: LoopEquations) -> Gap:
    """The gap of a loop, and in words what is apart."""
    if loop.declared:
        (residual,) = nearest.numbers.of(loop.residual)
        words = f"constraint '{loop.name}' is {residual:.6g} in place of 0"
        return Gap(np.zeros((0, 3)), abs(residual), "", words)
    *places, sine = nearest.numbers.of(ends_of(nearest.multibody, loop))
    ends, angle = np.reshape(places, (2, 3)), math.asin(min(1.0, sine))
    one, other = (point.body.name for point in joined(loop))
    wide, where = float(np.linalg.norm(ends[1] - ends[0])), f"at {loop.kind} '{loop.name}'"
    turned = angle * nearest.size > wide
    by_turn = f"turned by {math.degrees(angle):.3g} deg against each other"
    return Gap(
        ends,
        angle if turned else wide,
        "rad" if turned else "m",
        f"{one} and {other} are {by_turn if turned else f'{wide:.3g} m apart'} {where}",
    )


def _reach(nearest: Nearest, loop: LoopEquations, held: Collection[str]) -> str:
    """Say how far the ends of links are apart, and how far these reach, in words; nothing where the
    loop is no chain of links that turn, between bodies that are ``held``, or where they reach.
    """
    steps = nearest.multibody.tree.around(loop.joint) if loop.joint is not None else []
    still = [leaving.body.name in held for leaving, _, _ in steps]
    starts = [k for k, one in enumerate(still) if one and not still[(k + 1) % len(steps)]]
    if len(starts) != 1:
        return ""
    run = [*steps[starts[0] :], *steps[: starts[0]]][: 1 + still.count(False)]
    kinds = [_kind(nearest, joint) for _, joint, _ in run]
    pins = [k for k, kind in enumerate(kinds) if kind == "pin"]
    lines = [joint for (_, joint, _), kind in zip(run, kinds, strict=True) if kind == "line"]
    if "other" in kinds or len(pins) < 2 or len(lines) > 1:
        return ""
    lengths = [
        float(np.linalg.norm(nearest.place(run[one][2]) - nearest.place(run[other][0])))
        for one, other in itertools.pairwise(pins)
    ]
    apart, least = nearest.place(run[pins[-1]][2]) - nearest.place(run[pins[0]][0]), 0.0
    for line in lines:
        if line.parent.body.name not in held:
            return ""
        carrier = nearest.multibody.frames[line.parent.body.name].rotation
        along = np.array(nearest.numbers.of(column(carrier.apply(line.triad[0]))))
        # To the line, not to where the gap leaves what should be on it.
        back = nearest.place(line.parent) - nearest.place(line.child)
        apart = apart + (back if kinds[0] != "line" else -back)
        apart = apart - along * (along @ apart)
    far, most = float(np.linalg.norm(apart)), sum(lengths)
    if not lines:
        least = max(0.0, 2.0 * max(lengths) - most)
    gap = max(far - most, least - far)
    if gap <= 0.0:
        return ""
    between = {entering.body.name for _, _, entering in run[pins[0] : pins[-1]]}
    *links, link = [name for name in nearest.multibody.mechanism.bodies if name in between]
    names = f"{', '.join(links)} and {link}" if links else link
    led = f" at least, as joint '{lines[0].name}' leads them" if lines else ""
    reach = (
        _read(most, gap) if lines or least == most else f"{_read(least, gap)} to {_read(most, gap)}"
    )
    return (
        f"the ends of {names} are {_read(far, gap)} m apart{led}; with"
        f" {'these lengths' if links else 'this length'} they reach {reach} m"
    )


def _kind(nearest: Nearest, joint: Joint) -> str:
    """Say whether links turn about a joint in all ways, slide along a line, or rest there."""
    driven = joint.axes and all(axis.coordinate in nearest.drives for axis in joint.axes)
    if joint.kind == "weld" or (driven and joint.kind != "slot"):
        return "fixed"
    if joint.kind == "spherical" or (joint.planar and joint.kind == "revolute"):
        return "pin"
    return "line" if joint.kind == "prismatic" else "other"


def _lengths(nearest: Nearest, state: State, closed: Flags, rows: Flags) -> Iterator[str]:
    """The changes of one length each that close a gap, in words, the least of them first."""
    found = []
    for k, parameter in enumerate(nearest.multibody.mechanism.parameters.values()):
        before = state[3][k]
        value = nearest.closing(state, closed, rows, k) if parameter.unit == LENGTH else None
        if value not in (None, before) and max(parameter.low, 0.0) < value <= parameter.high:
            change = f"{value - before:+.3g}"
            words = f"{parameter.name} {_read(value, value - before)} m ({change} m)"
            found.append((abs(float(change)), k, words))
    yield from (words for _, _, words in sorted(found)[:_OFFERED])


def _read(value: float, beside: float) -> str:
    """A number with three digits, or so many that a difference has two of its own."""
    digits = 2 + math.ceil(math.log10(max(abs(value / beside), 1e-300)))
    return f"{value:.{min(max(digits, 3), 15)}g}"
