"""Displacement of a point by elastic links, by the unit-load method.

The displacement of a point along a direction is the sum over all links of section forces, times
compliance, times the section forces of a unit force there (Castigliano; Timoshenko, *Strength of
Materials*, part I, on strain energy), the drives held. The latter are the difference of two
evaluations, with a force as large as the machine's own, and without.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..base.arguments import public
from ..base.arrays import Array
from ..base.brief import Brief
from ..engine.model_data import template
from ..engine.strains import moduli_of
from ..errors import DeclarationError
from ..model.declared_parts import Body, Point
from ..model.pushed import with_push
from ..model.scene import Scene
from ..model.times import Over, Times
from ..results.elastic.compliance import nodes, strains_along
from ..results.solution import Solution
from ..results.strength.member import Member
from .evaluate import evaluate


@dataclass(frozen=True, eq=False, repr=False)
class ToolDeflection(Brief):
    """Displacement of a point by bending, stretch and twist of links, at instants ``t`` [s].

    ``by_link`` is the part of every link that has a beam, in ground axes [m], (t, 2), in space (t,
    3); other links are rigid.
    """

    t: Array
    by_link: Mapping[str, Array]

    @property
    def moved(self) -> Array:
        """The displacement."""
        return np.asarray(sum(self.by_link.values()))

    @property
    def size(self) -> Array:
        """Size of the displacement, (t,)."""
        return np.asarray(np.linalg.norm(self.moved, axis=1))

    @property
    def largest(self) -> float:
        """The largest over the instants."""
        return float(self.size.max())


@public
def tool_deflection(
    scene: Scene,
    point: Body | Point,
    *,
    parameters: Mapping[str, float] | None = None,
    t: Times | None = None,
    over: Over | None = None,
) -> ToolDeflection:
    """Return the quasi-static displacement of a point by elastic links, with the drives held.

    Links with a beam are elastic, others are rigid. Statically indeterminate forces follow from
    least strain energy.

    Parameters
    ----------
    scene
        The scene.
    point
        A body or a point of it.
    parameters, t, over
        As in :func:`.evaluate`.

    Returns
    -------
    ToolDeflection
        Displacement over the instants (t,) [m], in ground axes.

    Raises
    ------
    DeclarationError
        If no link has a beam, a material has no elasticity, forces of an elastic link stay
        indeterminate, or the point is on the ground or of another mechanism.
    LagrangeCasadiError
        As :func:`.evaluate`.
    """
    pushed, pushes, body = with_push(scene, point)
    links = [*template(scene).content.beams]
    if not links:
        raise DeclarationError("tool_deflection: no link has a beam=, so all are rigid")

    wanted = [f"section:{link}" for link in links]
    solved = partial(
        evaluate, pushed, t=t, over=over, wanted=wanted, certificate=False, elastic=links
    )
    plain = solved(parameters=parameters)
    # A force elsewhere pulls a bar, and bends none.
    members = {link: Member.of(plain, link, spun=link != body) for link in links}
    moduli = {
        link: moduli_of(member.beam, f"tool_deflection: link '{link}'", space=member.space)
        for link, member in members.items()
    }
    push = _size(plain, links)
    by_link = {link: np.zeros((plain.t.size, len(pushes))) for link in links}
    for k, name in enumerate(pushes):
        unit = solved(parameters={**(parameters or {}), name: push})
        for link, member in members.items():
            u, weights = nodes(member)
            section = member.at(u)
            more = replace(member, law=unit.section(link).law).at(u) - section
            strains = strains_along(member, moduli[link], section, u)
            by_link[link][:, k] = np.sum(strains * more * weights, axis=(0, 2)) / push
    return ToolDeflection(plain.t, by_link)


def _size(solution: Solution, links: list[str]) -> float:
    """A force as large as those in the links, so that nothing is lost in the difference."""
    forces = ("axial", "shear")
    most = max(
        float(np.abs(solution.section(link).law.extreme(force)[1]).max())
        for link in links
        for force in forces
    )
    return most or 1.0
