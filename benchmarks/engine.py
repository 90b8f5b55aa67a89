"""The package's own ways to do each piece of work, into arrays that are made once; ``threads`` is 0
for one a core.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from lagrange_casadi import Mechanism, Scene, compile_scene, load_case
from lagrange_casadi.base.space import cores
from lagrange_casadi.base.tables import PLANE
from lagrange_casadi.base.vocabulary import Backend
from lagrange_casadi.engine import codegen
from lagrange_casadi.engine.instants.backends import rows, run
from lagrange_casadi.engine.instants.evaluation_method import EvaluationMethod, Provenance
from lagrange_casadi.engine.instants.grids import empty
from lagrange_casadi.engine.program import Program
from lagrange_casadi.model.motion_laws import polynomial
from lagrange_casadi.results.ordering import in_order
from lagrange_casadi.results.section_laws import SectionLaw
from lagrange_casadi.results.solution import Solution
from lagrange_casadi.studies.designs.engine import DesignEngine
from lagrange_casadi.studies.designs.outcome import KEPT

from .peers.paper_case import Array, SliderCrank, Work

SCENE = load_case(Path(__file__).parent.parent / "cases" / "slider_crank").scene


def chain(n: int, wanted: tuple[str, ...] = ("effort",)) -> Program:
    """An open chain of n uniform links that are driven at every joint."""
    m = Mechanism("chain")
    near: Any = m.ground
    motion = {}
    for i in range(n):
        link = m.link(f"link{i}", length=0.5, mass=1.0)
        m.revolute(f"joint{i}", near, link)
        motion[f"joint{i}"] = polynomial(0.1 * i, 1.0, 0.2)
        near = link.tip
    return compile_scene(Scene(m, motion, wanted=wanted))


def instants(case: SliderCrank, t: Array, backend: Backend = "lanes", threads: int = 1) -> Work:
    """Every column of ``wanted="all"``, (columns, t)."""
    return columns_of(compile_scene(SCENE, ["all"]), np.array(case.parameters), t, backend, threads)


def designs(
    case: SliderCrank, t: Array, lengths: Array, backend: Backend = "lanes", threads: int = 1
) -> Work:
    """The same for one length of the rod after another, by what evaluates designs; what is left is
    the last one's.
    """
    span, method = (float(t[0]), float(t[-1]), t.size), EvaluationMethod(backend)
    engine = DesignEngine.of(SCENE, ["all"], t=span, method=method)
    program, p = engine.program, np.array([case.parameters], float)
    out, first = (
        np.empty((1, len(program.columns), t.size)),
        len(program.columns) - len(program.outputs),
    )
    results = {"status": np.zeros(1, np.int8), **dict.fromkeys(KEPT), "history": out}
    evaluate = engine.library.bound(t[None], np.zeros((1, 0), bool), p, results)

    def call() -> Array:
        for length in lengths:
            p[0, 1] = length
            evaluate()
        return out[0, first:]

    return call


def sections(
    case: SliderCrank, t: Array, xi: Array, backend: Backend = "lanes", threads: int = 1
) -> Work:
    """Axial, shear and bending of the rod, (3, t, xi): the law at every instant, and the grids from
    it.
    """
    work, law = _law(case, t, backend, threads)
    fills = _fills(law, t, xi, threads)

    def call() -> Array:
        work()
        return fills()

    return call


def fill(case: SliderCrank, t: Array, xi: Array, threads: int = 1) -> Work:
    """The grids alone, from a law that is there."""
    return _fills(_law(case, t, "lanes", 1)[1], t, xi, threads)


def _fills(law: SectionLaw, t: Array, xi: Array, threads: int) -> Work:
    out = empty("the grids", (3, t.size, xi.size))

    def call() -> Array:
        law.on_grids(PLANE.forces, xi, out, threads or None)
        return out

    return call


def efforts(n: int, t: Array, backend: Backend = "lanes", threads: int = 1) -> Work:
    """Efforts of the chain, (n, t)."""
    return columns_of(chain(n), np.zeros(0), t, backend, threads)


def columns() -> tuple[str, ...]:
    """The names of what :func:`instants` gives."""
    return tuple(map(str, compile_scene(SCENE, ["all"]).outputs))


def columns_of(program: Program, p: Array, t: Array, backend: Backend, threads: int) -> Work:
    """The outputs, the same array at every call, (columns, t)."""
    compiler = codegen.find_compiler("c++" if backend == "lanes" else "c")
    if compiler is None:
        raise RuntimeError(f"no compiler for the backend {backend}")
    out, status = rows(len(program.columns), t.size), np.zeros(t.size, dtype=np.int32)
    library, z = codegen.load(codegen.emit(program), compiler), np.empty((0, t.size))
    first = len(program.columns) - len(program.outputs)
    evaluate = library.evaluation(t, p, z, z, out, status, threads or cores())

    def call() -> Array:
        if backend == "vm":
            out[:] = run(program, t, p, EvaluationMethod("vm"))[0].out
        else:
            evaluate()
        return out[first:]

    return call


def _law(case: SliderCrank, t: Array, backend: Backend, threads: int) -> tuple[Work, SectionLaw]:
    """What works out the rod's law, and the law, whose arrays that fills."""
    program = compile_scene(SCENE, ["section:rod"])
    work = columns_of(program, np.array(case.parameters), t, backend, threads)
    description = program.data.at(case.parameters)
    outputs = in_order(dict(zip(program.outputs, work(), strict=True)), description)
    return work, Solution(
        "slider_crank", t, t, outputs, description, Provenance("", "", "", "", "", {})
    ).section("rod").law
