"""What is measured, as data: one entry a figure, each a program that a fresh interpreter runs."""

from __future__ import annotations

from dataclasses import dataclass

CASE = "cases/slider_crank"
CHAINS = (1, 2, 4, 8, 16, 32, 64)


@dataclass(frozen=True)
class Benchmark:
    """A program, run ``repeat`` times in a process of its own.

    ``program`` is Python, and where it ``reports``, the last line that it prints is shown; ``cold`` empties the compiler's cache
    before every run. ``bytes_returned`` is the size of what the program returns, for the ratio of peak memory to it.
    """

    name: str
    what: str
    program: str
    cold: bool = False
    repeat: int = 5
    bytes_returned: int = 0
    reports: bool = False


_RUN = f"from lagrange_casadi.cli import main; raise SystemExit(main(['run', '{CASE}'{{}}]))"
_MILLION = (
    "from lagrange_casadi import load_case, evaluate; "
    f"evaluate(load_case('{CASE}').scene, t=(0, 0.08, 1_000_000), wanted=['section:rod'])"
)

_SQUEEZER = """
import time
from lagrange_casadi import codegen, derive, load_case
from lagrange_casadi.codegen.compiler import build
start = time.perf_counter()
source = codegen.emit(derive(load_case("cases/andrews_squeezer").scene))
derived = time.perf_counter()
build(source, codegen.find_compiler())
print(f"derive and emit {derived - start:.2f} s, compile {time.perf_counter() - derived:.2f} s")
"""
_CHAIN = """
from lagrange_casadi import Mechanism, Scene, codegen, derive
from lagrange_casadi.motion import polynomial
m = Mechanism("chain")
near, motion = m.ground, {{}}
for i in range({0}):
    link = m.link(f"link{{i}}", length=0.5, mass=1.0)
    m.revolute(f"joint{{i}}", near, link)
    motion[f"joint{{i}}"] = polynomial(0.1 * i, 1.0, 0.2)
    near = link.tip
scene = Scene(m, motion, t=(0, 1, 2))
counts = {{wanted: derive(scene, [wanted]).instructions["instant"] for wanted in ("effort", "all")}}
codegen.emit(derive(scene))
print(", ".join(f"{{wanted}}: {{count}} instructions, {{count / {0}:.0f}} a link" for wanted, count in counts.items()))
"""

BENCHMARKS = (
    Benchmark("import", "import lagrange_casadi", "import lagrange_casadi"),
    Benchmark("run-cold", "run the paper's case with figures, nothing compiled", _RUN.format(""), cold=True, repeat=3),
    Benchmark("run-warm", "the same, compiled before", _RUN.format("")),
    Benchmark("run-warm-plain", "the same without figures", _RUN.format(", '--no-figures'")),
    Benchmark(
        "law-1e6",
        "a million instants of one link's section law",
        _MILLION,
        bytes_returned=8 * 1_000_000 * 8,  # the instants and the seven coefficients
    ),
    Benchmark("squeezer", "derive and emit the squeezer, and compile it cold", _SQUEEZER, cold=True, repeat=3, reports=True),
    *(
        Benchmark(f"chain-{n}", f"derive and emit an open chain of {n} links", _CHAIN.format(n), repeat=3, reports=True)
        for n in CHAINS
    ),
)
