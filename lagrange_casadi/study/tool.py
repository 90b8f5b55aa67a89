"""How far a point moves because links bend, by the unit-load method.

The displacement of a point along a direction is the sum over all links of section forces, times compliance, times the section
forces of a unit force there (Castigliano; Timoshenko, *Strength of Materials*, part I, on strain energy), the drives held. The
latter are the difference of two evaluations, with a force as large as the machine's own, and without.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..declare.density import Array
from ..declare.mechanism import Mechanism
from ..declare.parts import Body, Force, Link, Point, PointMass
from ..declare.scene import Scene
from ..declare.times import Over, Times
from ..elastic.compliance import Compliance, nodes
from ..errors import DeclarationError
from ..evaluate import evaluate
from ..instants.solution import Solution
from ..strength.member import Member

_LOAD = "tool deflection"


@dataclass(frozen=True, eq=False)
class ToolDeflection:
    """How far a point moves because links bend, stretch and twist, at instants ``t`` [s].

    ``by_link`` is the part of every link that has a beam, in ground axes [m], (t, 2), in space (t, 3); other links are rigid.
    """

    t: Array
    by_link: Mapping[str, Array]

    @property
    def moved(self) -> Array:
        """The displacement."""
        return np.asarray(sum(self.by_link.values()))

    @property
    def size(self) -> Array:
        """How far it is, (t,)."""
        return np.asarray(np.linalg.norm(self.moved, axis=1))

    @property
    def largest(self) -> float:
        """The largest over the instants."""
        return float(self.size.max())


def tool_deflection(
    scene: Scene,
    point: Body | Point,
    *,
    parameters: Mapping[str, float] | None = None,
    t: Times | None = None,
    over: Over | None = None,
) -> ToolDeflection:
    """How far a point of a scene moves because links bend, quasi-statically, the drives held where they are.

    Links that have a beam give way, others are rigid. Where equilibrium leaves forces open, least strain energy tells them.
    Parameters are those of :func:`.evaluate`.

    Raises :class:`.DeclarationError` where no link has a beam, a material has no elasticity, forces of a link that gives way stay
    open, or the point is on the ground or of another mechanism; and what :func:`.evaluate` does.
    """
    mechanism = scene.mechanism
    if not isinstance(point, (Point, Link, PointMass)):
        raise DeclarationError(f"tool_deflection: expected a point of the mechanism, got {point!r}")
    place = point if isinstance(point, Point) else Point(point, 0.0, 0.0)
    if mechanism.bodies.get(place.body.name) is not place.body or place.body is mechanism.ground:
        raise DeclarationError(
            f"tool_deflection: the point is on '{place.body.name}', expected a moving body of '{mechanism.name}'"
        )
    links = [name for name, link in mechanism.links.items() if link.beam is not None]
    if not links:
        raise DeclarationError("tool_deflection: no link has a beam, which says what it is made of; all are rigid")

    def sections(some: Scene) -> Solution:
        wanted = [f"section:{link}" for link in links]
        return evaluate(some, parameters=parameters, t=t, over=over, wanted=wanted, certificate=False, elastic=links)

    plain = sections(scene)
    members = {link: Compliance.of(Member.of(plain, link), f"tool_deflection: link '{link}'") for link in links}
    push = _size(plain, links)
    ways = 3 if mechanism.space else 2
    by_link = {link: np.zeros((plain.t.size, ways)) for link in links}
    for way in range(ways):
        unit = sections(replace(scene, mechanism=_pushed(mechanism, place, way, push), assembly=dict(scene.assembly)))
        for link, beam in members.items():
            at = nodes(beam.member)
            own = beam.member.at(at.u)
            pushed = np.stack([unit.section(link).law.at(force, at.u) for force in beam.member.forces])
            strained = beam.strains(own, at.index, at.u)
            by_link[link][:, way] = np.sum(strained * (pushed - own) * at.weights, axis=(0, 2)) / push
    return ToolDeflection(plain.t, by_link)


def _size(solution: Solution, links: list[str]) -> float:
    """A force as large as those in the links, so that nothing is lost in the difference."""
    forces = ("axial", "shear")
    most = max(float(np.abs(solution.section(link).law.extreme(force)[1]).max()) for link in links for force in forces)
    return most or 1.0


def _pushed(mechanism: Mechanism, place: Point, way: int, push: float) -> Mechanism:
    """The mechanism with one force more."""
    found: Any = copy.copy(mechanism)
    along = [push if k == way else 0.0 for k in range(3)]
    found.loads = dict(mechanism.loads) | {_LOAD: Force(_LOAD, place, along[0], along[1], False, along[2])}
    return found  # type: ignore[no-any-return]
