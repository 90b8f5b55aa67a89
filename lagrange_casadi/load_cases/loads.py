"""A load case as data: loads on a link, its inertia, and the nodes that take the loads."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from ..beams.beam import Beam
from ..declare.density import NumericDensity
from ..declare.stated import Triple

_SAME = 1e-9
"""Distance of two places [m] that are one node."""


@dataclass(frozen=True, eq=False)
class Rod:
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


@dataclass(frozen=True)
class LoadCase:
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


def nodes_of(case: LoadCase) -> dict[str, tuple[Triple, Triple, Triple]]:
    """Return places by names of node sets, each with the sum of its forces and moments: two loads
    at one place are one node's.
    """
    found: dict[str, tuple[Triple, Triple, Triple]] = {}
    for load in case.loads:
        for name, (at, force, moment) in found.items():
            if math.dist(at, load.at) <= _SAME:
                found[name] = (at, _sum(force, load.force), _sum(moment, load.moment))
                break
        else:
            name = load.name.partition(":")[2].replace(":", "_")
            while name.upper() in {other.upper() for other in found}:
                name += "_"
            found[name] = (load.at, load.force, load.moment)
    return found


def set_names(names: Iterable[str], chosen: Mapping[str, str]) -> dict[str, str]:
    """Return names of node sets: those that were chosen, and else those of the loads."""
    return {name: chosen.get(name, name) for name in names}


def _sum(a: Triple, b: Triple) -> Triple:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def listed(numbers: Sequence[float]) -> str:
    """Return numbers as a line of an input file; a longer number would be cut by CalculiX."""
    return ", ".join(f"{x:.12g}" for x in numbers)
