"""Loads of a solution compared with their declared laws: from the reported motions, and not from
the graphs.

A law that jumps may be on either side of its jump. The rounding of reported places and rates also
changes the value of a steep law: a difference that this rounding explains is not counted. The law
of friction is in :mod:`.friction`; this module has only the points at which friction acts.
"""

from __future__ import annotations

import math

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.description import LoadNumbers
from ...model.stated import LoadLaw
from .instant_vectors import NIL, cross, dot, size, turn
from .placing import Placed
from .reported import NEARBY
from .unplaced import stacked

Acts = tuple[Array, Array]
"""A force and a couple of a load on the first of its places, in ground axes."""

_TRIALS, _MOST = 8, 1e9
"""Number of trials for turns, and the largest number of turns."""


def off_laws(placed: Placed, largest: float) -> Array:
    """Residuals of loads against their laws [N] (t,), couples over the size; ``largest`` is the
    largest force of the cycle.
    """
    t = placed.reported.t
    worst = np.zeros_like(t)
    for law in placed.stated.laws:
        given, moved = placed.reported.acts("load", law.name), stacked(placed, law)
        residual = _apart(placed, given, _acting(placed, law, moved, t))
        if np.max(residual) > placed.reported.doubted * largest:
            moved = _turned(placed, law, given, moved)
            acts = _acting(placed, law, moved, t)
            residual = _apart(placed, given, acts) - _open(placed, law, moved, acts)
        worst = np.maximum(worst, residual)
    for name, load, holder in placed.frictions:
        value = placed.reported.outputs.get(Output("friction", name, "along"))
        if value is None or placed.declared.joints[holder].kind == "spherical":
            continue
        given, acts = placed.reported.acts("load", name), placed.along(load.coordinate, value)
        worst = np.maximum(worst, _apart(placed, given, acts))
    return worst


def _apart(placed: Placed, one: Acts, other: Acts) -> Array:
    return np.asarray(size(one[0] - other[0]) + size(one[1] - other[1]) / placed.declared.size)


def _acting(placed: Placed, law: LoadLaw, moved: Array, t: Array) -> Acts:
    """The force and the couple of a load by its law, of what it measures (3, entries, t)."""
    numbers, load, reported = law.at(moved, t), placed.declared.loads[law.name], placed.reported
    axes = placed.bodies[load.points[0].body].axes if load.turning else reported.ground
    if load.kind == "spring":
        stiffness, length, damping = numbers
        apart, closing = _stretched(placed, load)
        distance = size(apart)
        tension = stiffness * (distance - length) + damping * (dot(apart, closing) / distance)
        return (tension / distance) * apart, NIL
    if load.kind == "lineload":
        return _summed(numbers, axes, placed.bodies[load.points[0].body].axes[0])
    if load.kind == "force":
        return turn(axes, reported.straight(numbers)), NIL
    return NIL, turn(axes, reported.turning(numbers))


def _stretched(placed: Placed, load: LoadNumbers) -> Array:
    """Vector from the first end of a spring to the second, and its rate, (2, 3, t)."""
    first, second = (placed.bodies[point.body].point(point.at) for point in load.points)
    return (second - first)[:2]


def _summed(numbers: Array, axes: Array, along: Array) -> Acts:
    """The force of a load along a link, and its couple about the middle of where it acts, added up
    at Gauss's places.
    """
    reach, powers = numbers[0], numbers[1:].reshape(-1, 3, numbers.shape[1])[:, : len(axes)]
    force = couple = NIL
    nodes, weights = np.polynomial.legendre.leggauss(len(powers) // 2 + 1)
    for node, weight in zip(nodes.tolist(), weights.tolist(), strict=True):
        # The polynomial's argument is one where the load begins, and zero where it ends.
        here = sum(power * ((1.0 - node) / 2.0) ** k for k, power in enumerate(powers))
        here = (weight / 2.0 * reach) * turn(axes, here)
        force, couple = force + here, couple + cross((node / 2.0 * reach) * along, here)
    return force, couple


def _turned(placed: Placed, law: LoadLaw, given: Acts, moved: Array) -> Array:
    """Measured entries of a law, with the whole turns of angles that loops set: where instants are
    far apart, none are reported.

    They are those with which the law comes nearest to the load.
    """
    angles = [
        k
        for k, entry in enumerate(law.entries)
        if placed.is_angle(entry) and entry.part not in placed.declared.driven
    ]

    def tried(k: int, revolutions: Array | float) -> tuple[Array, Array]:
        there = moved.copy()
        there[0, k] += revolutions * math.tau
        return there, _apart(placed, given, _acting(placed, law, there, placed.reported.t))

    for k in angles * _TRIALS:
        places, off = zip(*(tried(k, revolutions) for revolutions in (0.0, 1.0, -1.0)), strict=True)
        # By one turn, or by as many as a law needs that is linear in them.
        change = (off[2] - off[1]) / 2.0
        many = np.rint(np.divide(off[0], change, out=np.zeros_like(change), where=change != 0.0))
        linear, least = tried(k, np.where(np.abs(many) < _MOST, many, 0.0))
        moved = np.choose(np.argmin([*off, least], axis=0), [*places, linear])
    return moved


def _open(placed: Placed, law: LoadLaw, moved: Array, acts: Acts) -> Array:
    """Uncertainty of a load that ``acts`` so by the rounding of its arguments: the sum of its
    changes with each.
    """
    declared, off = placed.declared, NEARBY * placed.reported.rounding
    t, (turned, fastest, _) = placed.reported.t, placed.rates
    found = np.zeros_like(t)
    for sign in (-off, off):
        acting = [_acting(placed, law, moved, t + sign * np.max(np.abs(t)))]
        for k, entry in enumerate(law.entries):
            scale, rate = (1.0, turned) if placed.is_angle(entry) else (declared.extent, fastest)
            for order, step in enumerate((scale + np.abs(moved[0, k]), rate)):
                there = moved.copy()
                there[order, k] += sign * step
                acting.append(_acting(placed, law, there, t))
        for one in acting:
            found += np.nan_to_num(_apart(placed, one, acts))
    load = declared.loads[law.name]
    if load.kind == "spring":
        stiffness, _, damping = np.abs(law.at(moved, t))
        apart, closing = _stretched(placed, load)
        found += off * (stiffness * declared.extent + damping * fastest)
        lost = damping * size(closing) + 2.0 * size(acts[0])
        found += off * declared.extent * lost / size(apart)
    return found
