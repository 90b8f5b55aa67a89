"""An arm of six revolute joints in space with slender links: the package's own ways to do each
piece of work.
"""

from __future__ import annotations

import numpy as np

from lagrange_casadi import Scene, SpatialMechanism, compile_scene
from lagrange_casadi.base.tables import SPACE
from lagrange_casadi.base.vocabulary import Backend
from lagrange_casadi.engine.instants.evaluation_method import Provenance
from lagrange_casadi.engine.instants.grids import empty
from lagrange_casadi.engine.program import Program
from lagrange_casadi.model.motion_laws import polynomial
from lagrange_casadi.results.ordering import in_order
from lagrange_casadi.results.section_laws import SectionLaw
from lagrange_casadi.results.solution import Solution

from .engine import columns_of
from .peers.arm_data import AXES, FIRST, LENGTHS, MASSES, RATE, TURN
from .peers.paper_case import Array, Work

FORCES = SPACE.forces[:6]
LINK = "link2"


def program(wanted: tuple[str, ...]) -> Program:
    """The arm, every joint driven."""
    m = SpatialMechanism("arm")
    links = [
        m.link(f"link{k}", length=l, mass=mass)
        for k, (l, mass) in enumerate(zip(LENGTHS, MASSES, strict=True), 1)
    ]
    for k, (link, axis) in enumerate(zip(links, AXES, strict=True)):
        turned = [("y", "-90 deg")] if k == 0 else []
        m.revolute(f"joint{k}", links[k - 1].tip if k else m.ground, link, axis=axis, turned=turned)
    laws = {f"joint{k}": polynomial(FIRST[k], RATE[k], TURN[k]) for k in range(len(links))}
    return compile_scene(Scene(m, laws, wanted=wanted))


def arm_efforts(t: Array, backend: Backend = "lanes", threads: int = 1) -> Work:
    """Efforts of the six joints, (6, t)."""
    return columns_of(program(("effort",)), np.zeros(0), t, backend, threads)


def arm_sections(t: Array, xi: Array, backend: Backend = "lanes", threads: int = 1) -> Work:
    """Six section forces of the second link, (6, t, xi): the law at every instant, and the grids
    from it.
    """
    work, law = _law(t, backend, threads)
    fill = _fills(law, FORCES, t, xi, threads)

    def call() -> Array:
        work()
        return fill()

    return call


def arm_resultants(t: Array, xi: Array, threads: int = 1) -> Work:
    """Grids of the resultants of shear and of bending, (2, t, xi), from a law that is there."""
    return _fills(_law(t, "lanes", 1)[1], ("shear", "bending"), t, xi, threads)


def _fills(law: SectionLaw, forces: tuple[str, ...], t: Array, xi: Array, threads: int) -> Work:
    out = empty("the grids", (len(forces), t.size, xi.size))

    def call() -> Array:
        law.on_grids(forces, xi, out, threads or None)
        return out

    return call


def _law(t: Array, backend: Backend, threads: int) -> tuple[Work, SectionLaw]:
    found = program((f"section:{LINK}",))
    work = columns_of(found, np.zeros(0), t, backend, threads)
    description = found.data.at(found.data.defaults)
    outputs = in_order(dict(zip(found.outputs, work(), strict=True)), description)
    return work, Solution(
        "arm", t, t, outputs, description, Provenance("", "", "", "", "", {})
    ).section(LINK).law
