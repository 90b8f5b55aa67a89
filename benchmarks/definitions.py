"""What is measured, as data: one entry a figure, each a program that a fresh interpreter runs."""

from __future__ import annotations

from dataclasses import dataclass

CASE = "cases/slider_crank"


@dataclass(frozen=True)
class Benchmark:
    """A program, run ``repeat`` times in a process of its own.

    ``program`` is Python; ``cold`` empties the compiler's cache before every run. ``bytes_returned`` is the size of what the
    program returns, for the ratio of peak memory to it.
    """

    name: str
    what: str
    program: str
    cold: bool = False
    repeat: int = 5
    bytes_returned: int = 0


_RUN = f"from lagrange_casadi.cli import main; raise SystemExit(main(['run', '{CASE}'{{}}]))"
_MILLION = (
    "from lagrange_casadi import load_case, evaluate; "
    f"evaluate(load_case('{CASE}').scene, t=(0, 0.08, 1_000_000), wanted=['section:rod'])"
)

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
)
