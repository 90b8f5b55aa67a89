"""What is measured, as data: whole programs, methods, and the work that they are compared by."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

CASE = "cases/slider_crank"
CHAINS = (1, 2, 4, 8, 16, 32, 64)


@dataclass(frozen=True)
class Program:
    """Python that a fresh interpreter runs ``repeat`` times.

    Where it ``reports``, the last line that it prints is shown; ``cold`` empties the compiler's
    cache before every run. ``bytes_returned`` is the size of its result, to set its memory against.
    """

    name: str
    what: str
    text: str
    cold: bool = False
    repeat: int = 5
    bytes_returned: int = 0
    reports: bool = False


@dataclass(frozen=True)
class Method:
    """A module of this folder whose functions, named as the work is, make it ready and return what
    does it.

    ``largest`` is how many values it can be waited for.
    """

    what: str
    module: str
    options: dict[str, Any] = field(default_factory=dict)
    largest: float = math.inf


@dataclass(frozen=True)
class Comparison:
    """Work that several methods do: ``t`` instants, ``xi`` ratios, of so many designs or links.

    Ratios are to ``base``.
    """

    name: str
    what: str
    work: str
    methods: tuple[str, ...]
    base: str
    unit: str
    t: int
    xi: int = 1
    designs: int = 1
    links: int = 1

    @property
    def units(self) -> int:
        """How many of what the time is given for."""
        return self.t * self.xi * self.designs

    @property
    def values(self) -> int:
        """How many numbers the result has."""
        own = {
            "instants": 40,
            "designs": 40,
            "efforts": self.links,
            "arm_efforts": 6,
            "arm_sections": 6,
            "arm_resultants": 2,
        }
        each = own.get(self.work, 3)
        return self.units * each


_RUN = f"from lagrange_casadi.cli import main; raise SystemExit(main(['run', '{CASE}'{{}}]))"
_LAW = (
    "from lagrange_casadi import load_case, evaluate; "
    f"evaluate(load_case('{CASE}').scene, t=(0, 0.08, 1_000_000), wanted=['section:rod'])"
)
_GRID = (
    f"from lagrange_casadi import load_case, evaluate; s = evaluate(load_case('{CASE}').scene,"
    " t=(0, 0.08, 100_000), xi=(0, 1, 101), wanted=['section:rod']).section('rod'); s.axial,"
    " s.shear, s.bending"
)
_STAGES = """
import time
from lagrange_casadi import compile_scene, load_case
from lagrange_casadi.engine import codegen
scene = load_case("cases/{0}").scene
start = time.perf_counter()
graph = compile_scene(scene)
derived = time.perf_counter()
source = codegen.emit(graph)
said = f"{{sum(graph.instructions.values())}} instructions; "
said += f"derive {{1e3 * (derived - start):.0f}} ms, "
said += f"emit {{1e3 * (time.perf_counter() - derived):.0f}} ms"
for language in ("c", "c++"):
    compiler = codegen.find_compiler(language)
    for state in ("cold", "warm"):
        start = time.perf_counter()
        codegen.load(source, compiler)
        said += f", {{language}} {{state}} {{1e3 * (time.perf_counter() - start):.1f}} ms"
print(said)
"""
_EXPORTED = "from benchmarks.exported import report; print(report('{0}'))"
_SWEPT = "from benchmarks.sweeps import report; print(report({0}, {1}, {2}))"
_OPTIMUM = "from benchmarks.optimum import report; print(report(5))"
_GRADIENTS = "from benchmarks.gradients import report; print(report(20))"
_PEAKS = "from benchmarks.peaks import report; print(report(200))"
_STEADY = "from benchmarks.steady import report; print(report(5))"
_IDENTIFY = "from benchmarks.identification import report; print(report(3))"
_LARGE = "from benchmarks.large import report; print(report({0}))"

PROGRAMS = (
    Program("import", "import lagrange_casadi", "import lagrange_casadi"),
    Program("run-cold", "run the paper's case with figures, nothing compiled", _RUN.format(""),
        cold=True, repeat=3),
    Program("run-warm", "the same, compiled before", _RUN.format("")),
    Program("run-warm-plain", "the same without figures: 801 x 101 values of each force",
        _RUN.format(", '--no-figures'")),
    Program(
        "run-1e8",
        "10^8 section forces of one link, streamed to the file",
        _RUN.format(", '--no-figures', '--want', 'section:rod', '--t', '0:0.08:330034'"),
        repeat=1,
    ),
    Program("memory-law", "a million instants of one link's law", _LAW,
        bytes_returned=8 * 1_000_000 * 8),
    Program("memory-grid", "grids of 100 000 x 101 values of each force", _GRID,
        bytes_returned=3 * 8 * 100_000 * 101),
    *(
        Program(f"stages-{case}", f"{case}, everything", _STAGES.format(case), cold=True, repeat=3,
            reports=True)
        for case in ("slider_crank", "six_bar", "andrews_squeezer", "rrr3")
    ),
    Program("stages-sympy", "SymPy derives and lambdifies the same three forces",
        "from benchmarks.peers.sympy_lambdify import *\n"
        "from benchmarks.peers.paper_case import SliderCrank\n"
        "sections(SliderCrank(), np.zeros(1), np.zeros(1))", repeat=3),
    *(
        Program(f"exported-{case}", f"{case}, everything, by exported C", _EXPORTED.format(case),
            repeat=1, reports=True)
        for case in ("slider_crank", "four_bar", "andrews_squeezer")
    ),
    Program("sweep-1e5", "10^5 designs of the slider-crank", _SWEPT.format(10**5, 128, 5), repeat=1,
        reports=True),
    Program("sweep-1e6", "10^6 designs of the slider-crank", _SWEPT.format(10**6, 128, 2), repeat=1,
        reports=True),
    Program("sweep-801", "10^5 designs at the case's own instants", _SWEPT.format(10**5, 801, 2),
        repeat=1, reports=True),
    Program("optimum", "the least peak torque of the slider-crank under a limit, two parameters",
        _OPTIMUM, repeat=1, reports=True),
    Program("peaks", "peaks of 200 designs of the slider-crank, beside their outputs over time",
        _PEAKS, repeat=1, reports=True),
    Program("gradients", "the gradient of all peaks by all parameters, of the peaks alone",
        _GRADIENTS, repeat=1, reports=True),
    Program("steady", "the steady cycle of the punch press, of an evaluation of it",
        _STEADY, repeat=1, reports=True),
    Program("identify", "73 parameters of an arm from 6000 instants, of an evaluation of them",
        _IDENTIFY, repeat=1, reports=True),
    *(
        Program(f"large-{n}", f"an open chain of {n} links, everything", _LARGE.format(n),
            cold=True, repeat=1, reports=True)
        for n in (16, 64, 256, 750)
    ),
)  # fmt: skip

METHODS = {
    "memcpy": Method("a copy of the result, from one place in memory to another", "peers.memory"),
    "lanes x cores": Method(
        "this package: packs of instants, a thread a core",
        "engine",
        {"backend": "lanes", "threads": 0},
    ),
    "lanes": Method("this package: packs of instants, one thread", "engine", {"backend": "lanes"}),
    "c": Method("this package: scalar C, one thread", "engine", {"backend": "c"}),
    "vm": Method(
        "this package: CasADi's virtual machine", "engine", {"backend": "vm"}, largest=4e6
    ),
    "fill": Method("this package: the grids, one thread", "engine"),
    "fill x cores": Method("this package: the grids, a thread a core", "engine", {"threads": 0}),
    "by hand": Method("scalar C for this one mechanism, written by hand", "peers.handwritten"),
    "by hand, vectors": Method(
        "the same, as the compiler vectorises it: -O3 -march=native",
        "peers.handwritten",
        {"flags": ("-O3", "-march=native")},
    ),
    "numpy": Method(
        "NumPy of the closed form, written by hand", "peers.numpy_closed", largest=1.2e7
    ),
    "sympy": Method("SymPy's lambdify with cse, to NumPy", "peers.sympy_lambdify", largest=1.2e7),
    "pinocchio": Method(
        "Pinocchio's rnea, the rod in as many pieces as ratios and one",
        "peers.pinocchio_split",
        largest=3e6,
    ),
    "mujoco": Method(
        "MuJoCo's inverse dynamics, the same pieces", "peers.mujoco_split", largest=3e6
    ),
    "exudyn": Method(
        "Exudyn's residual, a rod split once for each ratio", "peers.exudyn_split", largest=3e5
    ),
    "pinocchio rnea": Method("Pinocchio's rnea", "peers.pinocchio_chain"),
    "arm x cores": Method(
        "this package: packs of instants, a thread a core",
        "arm",
        {"backend": "lanes", "threads": 0},
    ),
    "arm": Method("this package: packs of instants, one thread", "arm", {"backend": "lanes"}),
    "arm c": Method("this package: scalar C, one thread", "arm", {"backend": "c"}),
    "arm fill": Method("this package: the grids, one thread", "arm"),
    "arm fill x cores": Method("this package: the grids, a thread a core", "arm", {"threads": 0}),
    "rnea x cores": Method(
        "Pinocchio's rneaInParallel, two threads",
        "peers.pinocchio_arm",
        {"threads": 2},
        largest=3e6,
    ),
    "rnea": Method("Pinocchio's rneaInParallel, one thread", "peers.pinocchio_arm", largest=3e6),
    "pinocchio native": Method(
        "Pinocchio's rnea by its headers, built with -O3 -march=native",
        "peers.compiled_chains",
        {"library": "pinocchio"},
    ),
    "dynibo": Method(
        "dynibo's inverse dynamics, built by Rust for this machine",
        "peers.compiled_chains",
        {"library": "dynibo"},
    ),
    "pinocchio casadi": Method(
        "Pinocchio's rnea as a graph of CasADi, in its virtual machine", "peers.pinocchio_casadi"
    ),
}

_ENGINE = ("lanes x cores", "lanes", "c", "vm")
_HAND = ("by hand", "by hand, vectors", "numpy")
_RATIOS = 32

COMPARISONS = (
    *(
        Comparison(f"instants-{n}", f"{n} instants of the slider-crank, all 40 outputs", "instants",
            (*_ENGINE, *_HAND),
                   "by hand", "ns/instant", t=n)
        for n in (1, 1000, 20_000, 1_000_000)
    ),
    *(
        Comparison(f"grid-1e{e}",
            f"the law and its grids of (t, xi), 10^{e} values, {_RATIOS} ratios", "sections",
                   (*_ENGINE, *_HAND, "sympy", "pinocchio", "mujoco", "exudyn"), "lanes",
                       "ns/(t, xi)",
                   t=max(2, round(10**e / 3 / _RATIOS)), xi=_RATIOS)
        for e in range(3, 9)
    ),
    *(
        Comparison(f"fill-1e{e}",
            f"grids filled from a law that is there, 10^{e} values, 101 ratios", "fill",
                   ("memcpy", "fill x cores", "fill"), "memcpy", "ns/(t, xi)", t=max(2,
                       round(10**e / 3 / 101)), xi=101)
        for e in range(5, 9)
    ),
    Comparison("arm-efforts", "efforts of an arm in space of six slender links, 10 000 instants",
        "arm_efforts",
               ("arm x cores", "arm", "arm c", "rnea x cores", "rnea", "pinocchio native",
                   "dynibo"), "rnea", "ns/instant",
                   t=10_000),
    Comparison("arm-1", "efforts of that arm, 1 instant by a call from Python", "arm_efforts",
               ("arm", "arm c", "rnea", "pinocchio native", "dynibo"), "rnea", "ns/instant", t=1),
    Comparison("arm-sections",
        "six section forces of its second link: the law and its grids, 32 ratios", "arm_sections",
               ("arm x cores", "arm", "arm c", "rnea x cores", "rnea"), "rnea", "ns/(t, xi)",
                   t=2_000, xi=_RATIOS),
    *(
        Comparison(f"arm-fill-1e{e}",
            f"grids of two resultants from a law that is there, 10^{e} values, 101 ratios",
                   "arm_resultants", ("memcpy", "arm fill x cores", "arm fill"), "memcpy",
                       "ns/(t, xi)",
                   t=max(2, round(10**e / 2 / 101)), xi=101)
        for e in range(5, 9)
    ),
    Comparison("designs-1000", "1000 lengths of the rod x 128 instants, all 40 outputs", "designs",
               ("lanes", "c", *_HAND), "by hand", "ns/instant", t=128, designs=1000),
    *(
        Comparison(f"chain-{n}", f"efforts of an open chain of {n} links, 1000 instants", "efforts",
                   (*_ENGINE, "pinocchio rnea", "pinocchio native", "dynibo", "pinocchio casadi"),
                   "pinocchio rnea", "ns/instant",
                       t=1000, links=n)
        for n in CHAINS
    ),
)  # fmt: skip
