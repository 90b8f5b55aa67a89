"""A load case as data: loads on a link, its inertia, and the nodes that take the loads."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ...base.arrays import Array
from ...base.brief import Brief
from ...errors import DeclarationError
from ...model.description import BodyNumbers, Triple
from ...results.verification.instant_vectors import constant
from ...results.verification.placing import Moving

_SAME = 1e-9
"""Distance of two places [m] that are one node."""


@dataclass(frozen=True, repr=False)
class Load(Brief):
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

    ``governs`` are the quantities that are largest at this instant. The link bears ``loads``, and
    on each of its masses at r the inertia and weight ``gravity - acceleration - alpha x r - omega x
    (omega x r)``: ``acceleration`` of the origin [m/s^2], angular velocity ``omega`` [rad/s],
    angular acceleration ``alpha`` [rad/s^2]. With ``mass`` [kg], its ``centre`` [m] and the
    ``inertia`` about it [kg m^2] these are in equilibrium, but for ``residual``: of forces, and of
    moments about the centre, each relative to the largest on the link. ``rod`` describes a link
    that has a beam.
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
    rod: BodyNumbers | None = field(default=None, repr=False, compare=False)


def on_own_axes(acceleration: Array, omega: Array, alpha: Array) -> Moving:
    """Return the motion of a link whose vectors are on its own axes, from its origin."""
    origin = np.multiply.outer([0.0, 0.0, 1.0], acceleration)
    return Moving.of(origin, constant(np.eye(len(acceleration))), np.array([omega, alpha]))


def title(case: LoadCase) -> str:
    """Return one line: link, time, and what governs."""
    return f"{case.link} at t = {case.t:.9g} s: {', '.join(case.governs) or 'as asked'}"


@dataclass(frozen=True, eq=False)
class Node:
    """A node at the place ``at``: the ``name`` of the first load there, that of its ``set`` in a
    mesh, and the sum of force and moment of all loads there (6).
    """

    name: str
    set: str
    at: Triple
    wrench: Array


def nodes_of(case: LoadCase, chosen: Mapping[str, str]) -> list[Node]:
    """Return the nodes that take the loads; their sets have the names that were ``chosen``, else
    those of the loads, which are without their kinds.
    """
    found: list[Node] = []
    for load in case.loads:
        wrench = np.array([*load.force, *load.moment])
        if same := [node for node in found if math.dist(node.at, load.at) <= _SAME]:
            same[0].wrench[:] += wrench
            continue
        name = load.name.partition(":")[2].replace(":", "_")
        name = unlike(name, [node.name for node in found])
        found.append(Node(name, chosen.get(name, name), load.at, wrench))
    for own in found:
        if len(same := [node for node in found if node.set.upper() == own.set.upper()]) > 1:
            names = " and ".join(node.name for node in same)
            why = f"{names} are at several places, but each has the node '{own.set}'"
            raise refused(case.link, f"{why}; expected a node for each")
    return found


def refused(link: str, why: str) -> DeclarationError:
    """Return the error of what is asked of a link's load cases."""
    return DeclarationError(f"load cases of link '{link}': {why}")


def unlike(name: str, taken: Collection[str]) -> str:
    """Return a name, with underscores if it is taken: to solvers, capitals are small letters."""
    while name.upper() in map(str.upper, taken):
        name += "_"
    return name


def listed(numbers: Sequence[float]) -> str:
    """Return numbers as a line of an input file; a longer number would be cut by CalculiX."""
    return ", ".join(f"{x:.12g}" for x in numbers)
