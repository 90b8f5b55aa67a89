"""A load case as data: loads on a link, its inertia, and the nodes that take the loads."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.arrays import Array
from ..base.brief import Brief
from ..beams.beam import Beam
from ..declare.density import NumericDensity
from ..declare.stated import Triple

_SAME = 1e-9
"""Distance of two places [m] that are one node."""


@dataclass(frozen=True, eq=False, repr=False)
class Rod(Brief):
    """A link along x: its length [m], its mass and the second moments yy, zz, yz of its slices,
    each by the ratio x/length, and its beam.
    """

    length: float
    density: NumericDensity
    slices: tuple[NumericDensity, ...]
    beam: Beam


@dataclass(frozen=True)
class Load:
    """A force [N] and a moment [N m] about the place ``at`` [m], on the link's axes.

    ``name`` is that of the output it is reported as: ``reaction:A``, ``effort:O``, ``load:gas``,
    ``multiplier:mesh``. A line load is its resultant.
    """

    name: str
    at: Triple
    force: Triple
    moment: Triple


@dataclass(frozen=True, repr=False)
class LoadCase(Brief):
    """Everything that loads a link at time ``t`` [s], on its own axes, from its origin.

    ``governs`` are the quantities that are largest at this instant. ``rod`` is the link as a bar,
    where it has a beam. The link bears ``loads``, and
    on each of its masses at r the inertia and weight ``gravity - acceleration - alpha x r - omega x
    (omega x r)``: ``acceleration`` of the origin [m/s^2], angular velocity ``omega`` [rad/s],
    angular acceleration ``alpha`` [rad/s^2]. With ``mass`` [kg], its ``centre`` [m] and the
    ``inertia`` about it [kg m^2] these are in equilibrium, but for ``residual``: of forces, and of
    moments about the centre, each relative to the largest on the link.
    """

    link: str
    t: float
    governs: tuple[str, ...]
    loads: tuple[Load, ...]
    acceleration: Triple
    omega: Triple
    alpha: Triple
    gravity: Triple
    mass: float
    centre: Triple
    inertia: tuple[Triple, Triple, Triple]
    residual: tuple[float, float]
    rod: Rod | None = None


def inertia_field(moved: Array, at: Array) -> Array:
    """Return inertia and weight of a unit of mass [m/s^2] at places of a link, as in
    :class:`LoadCase`; ``moved`` are acceleration, omega, alpha and gravity (4, ..., 3).
    """
    acceleration, omega, alpha, gravity = moved
    change = acceleration + np.cross(alpha, at) + np.cross(omega, np.cross(omega, at))
    return np.asarray(gravity - change)


def title(case: LoadCase) -> str:
    """Return one line: link, time, and what governs."""
    return f"{case.link} at t = {case.t:.9g} s: {', '.join(case.governs) or 'as asked'}"


def node_sets(case: LoadCase, chosen: Mapping[str, str]) -> list[tuple[str, Load]]:
    """Return node sets with what each bears: two loads at one place are one node's. A set has the
    name that was ``chosen``, else that of the load, which is without its kind.
    """
    found: dict[str, Load] = {}
    for load in case.loads:
        for name, node in found.items():
            if math.dist(node.at, load.at) <= _SAME:
                force, moment = _sum(node.force, load.force), _sum(node.moment, load.moment)
                found[name] = replace(node, force=force, moment=moment)
                break
        else:
            name = load.name.partition(":")[2].replace(":", "_")
            while name.upper() in map(str.upper, found):
                name += "_"
            found[name] = replace(load, name=name)
    return [(chosen.get(name, name), node) for name, node in found.items()]


def _sum(a: Triple, b: Triple) -> Triple:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def listed(numbers: Sequence[float]) -> str:
    """Return numbers as a line of an input file; a longer number would be cut by CalculiX."""
    return ", ".join(f"{x:.12g}" for x in numbers)
