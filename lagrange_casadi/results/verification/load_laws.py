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
from .instant_vectors import NIL, Axes, Vector, total
from .placing import Placed
from .reported import NEARBY
from .unplaced import stacked

Acts = tuple[Vector, Vector]
"""A force and a couple on the first of a load's places, in ground axes."""

_TRIALS, _MOST = 8, 1e9
"""Number of trials for turns, and the largest number of turns."""


def off_laws(placed: Placed, largest: float) -> Array:
    """Residuals of loads against their laws [N] (t,), couples over the size; ``largest`` is the
    largest force of the cycle.
    """
    worst = np.zeros_like(placed.reported.t)
    for law in placed.stated.laws:
        load = placed.declared.loads[law.name]
        given, (places, rates, _) = _given(placed, law.name), stacked(placed, law)
        acts = _acting(placed, law, load, law.at(places, rates, placed.reported.t))
        residual = _apart(placed, given, acts)
        if np.max(residual) > placed.reported.doubted * largest:
            places = _turned(placed, law, load, given, places, rates)
            acts = _acting(placed, law, load, law.at(places, rates, placed.reported.t))
            residual = np.maximum(
                _apart(placed, given, acts) - _open(placed, law, load, places, rates, acts),
                0.0,
            )
        worst = np.maximum(worst, residual)
    for name, load, holder in placed.frictions:
        value = placed.reported.outputs.get(Output("friction", name, "along"))
        joint = placed.declared.joints[holder]
        if value is None or joint.kind == "spherical":
            continue
        axis = next(axis for axis in joint.axes if axis.coordinate == load.coordinate)
        acts = placed.along(holder, axis, value)
        worst = np.maximum(worst, _apart(placed, _given(placed, name), acts))
    return worst


def _given(placed: Placed, name: str) -> Acts:
    return placed.reported.force("load", name), placed.reported.force("load", name, "m")


def _apart(placed: Placed, one: Acts, other: Acts) -> Array:
    residual = total((one[0] - other[0]).size, (one[1] - other[1]).size / placed.declared.size)
    return np.asarray(np.zeros_like(placed.reported.t) + residual)


def _acting(placed: Placed, law: LoadLaw, load: LoadNumbers, numbers: Array) -> Acts:
    """Load by a law of numbers (numbers, t)."""
    kind, turning = law.kind, law.turning
    if kind == "spring":
        stiffness, length, damping = numbers
        apart, closing = _stretched(placed, load)
        distance = apart.size
        tension = stiffness * (distance - length) + damping * (apart.dot(closing) / distance)
        return (tension / distance) * apart, NIL
    axes = placed.bodies[load.points[0].body].axes
    if kind == "lineload":
        return _summed(numbers, axes, turning=turning)
    acts = axes.turn(Vector(*numbers)) if turning else Vector(*numbers)
    return (acts, NIL) if kind == "force" else (NIL, acts)


def _stretched(placed: Placed, load: LoadNumbers) -> tuple[Vector, Vector]:
    """Vector from the first end of a spring to the second, and its rate."""
    first, second = (placed.bodies[point.body].point(Vector(*point.at)) for point in load.points)
    return second[0] - first[0], second[1] - first[1]


def _summed(numbers: Array, axes: Axes, *, turning: bool) -> Acts:
    """The force of a load along a link, and its couple about the middle of where it acts, added up
    at Gauss's places.
    """
    reach, powers = numbers[0], numbers[1:].reshape(-1, 3, numbers.shape[1])
    force, couple = NIL, NIL
    nodes, weights = np.polynomial.legendre.leggauss(len(powers) // 2 + 1)
    for node, weight in zip(nodes.tolist(), weights.tolist(), strict=True):
        # The polynomial's argument is one where the load begins, and zero where it ends.
        here = Vector(*sum(power * ((1.0 - node) / 2.0) ** k for k, power in enumerate(powers)))
        here = (weight / 2.0 * reach) * (axes.turn(here) if turning else here)
        force, couple = force + here, couple + ((node / 2.0 * reach) * axes.x).cross(here)
    return force, couple


def _turned(
    placed: Placed, law: LoadLaw, load: LoadNumbers, given: Acts, places: Array, rates: Array
) -> Array:
    """The places that a law sees, with the whole turns of angles that loops set: where instants are
    far apart, none are reported.

    They are those with which the law comes nearest to the load.
    """
    angles = [
        k
        for k, entry in enumerate(law.entries)
        if placed.is_angle(entry) and entry.part not in placed.declared.driven
    ]
    t = placed.reported.t

    def residual(there: Array) -> Array:
        return _apart(placed, given, _acting(placed, law, load, law.at(there, rates, t)))

    for k in angles * _TRIALS:
        tried = []
        for revolutions in (0.0, 1.0, -1.0):
            there = places.copy()
            there[k] += revolutions * math.tau
            tried.append((there, residual(there)))
        # By one turn, or by as many as a law needs that is linear in them.
        here, change = tried[0][1], (tried[2][1] - tried[1][1]) / 2.0
        many = np.rint(np.divide(here, change, out=np.zeros_like(here), where=change != 0.0))
        there = places.copy()
        there[k] += np.where(np.abs(many) < _MOST, many, 0.0) * math.tau
        tried.append((there, residual(there)))
        nearest = np.argmin([off for _, off in tried], axis=0)
        places = np.choose(nearest, [there for there, _ in tried])
    return places


def _open(
    placed: Placed,
    law: LoadLaw,
    load: LoadNumbers,
    places: Array,
    rates: Array,
    acts: Acts,
) -> Array:
    """Uncertainty of a load that ``acts`` so by the rounding of its arguments: the sum of its
    changes with each.
    """
    declared, off = placed.declared, NEARBY * placed.reported.rounding
    t, (turned, fastest, _) = placed.reported.t, placed.rates
    found = np.zeros_like(t)
    for sign in (-off, off):
        evaluated = [law.at(places, rates, t + sign * np.max(np.abs(t)))]
        for k, entry in enumerate(law.entries):
            angle = placed.is_angle(entry)
            for rows, step in (
                (places, (1.0 if angle else declared.extent) + np.abs(places[k])),
                (rates, turned if angle else fastest),
            ):
                kept = rows[k].copy()
                rows[k] += sign * step
                evaluated.append(law.at(places, rates, t))
                rows[k] = kept
        for numbers in evaluated:
            found += np.nan_to_num(_apart(placed, _acting(placed, law, load, numbers), acts))
    if law.kind == "spring":
        stiffness, _, damping = np.abs(law.at(places, rates, t))
        apart, closing = _stretched(placed, load)
        found += off * (stiffness * declared.extent + damping * fastest)
        found += off * declared.extent * (damping * closing.size + 2.0 * acts[0].size) / apart.size
    return found
