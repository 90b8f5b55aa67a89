"""Exported C on a bare Cortex-M4F, which has no doubles: it computes what it computes elsewhere,
and is small.
"""

import re
from pathlib import Path

import pytest
from cortex_m4f.target import METHODS, exported, missing

CASES = sorted(path.parent.name for path in (Path(__file__).parents[2] / "cases").glob("*/case.py"))
TABLED = ("slider_crank", "four_bar", "six_bar", "andrews_squeezer")
TABLE = "table 1e-6, effort"
PAIRS = (
    [(name, "single") for name in CASES]
    + [(name, TABLE) for name in TABLED]
    + [("slider_crank", "double")]
)

pytestmark = pytest.mark.skipif(missing() != "", reason=missing())


@pytest.mark.sampled(97)
@pytest.mark.parametrize(("name", "method"), PAIRS)
def test_the_selftest_passes_on_the_machine(name, method, tmp_path):
    assert re.search(
        r": \d+ numbers at 9 instants, .*; 0 wrong$",
        exported(name, method, tmp_path / name).selftest(),
    )


@pytest.mark.sampled(34)
@pytest.mark.parametrize(("name", "method"), [pair for pair in PAIRS if pair[1] != "double"])
def test_single_precision_asks_for_no_arithmetic_of_doubles(name, method, tmp_path):
    target = exported(name, method, tmp_path / name)
    assert target.doubles(target.object) == set()
    assert target.doubles(target.whole) == set()
    assert all(
        re.fullmatch(r"[a-z]+[0-9]?f|mem(set|cpy)", function) for function in target.needed
    ), target.needed
    assert target.sections(target.object)["data"] == target.sections(target.object)["bss"] == 0


@pytest.mark.sampled(7)
@pytest.mark.parametrize("optimized", ["-O2", "-Os"])
@pytest.mark.parametrize("method", METHODS)
def test_the_marks_of_a_small_machine(method, optimized, tmp_path):
    """Code and constants, with those of the libraries, under 64 kB, and the stack under 16 kB: here
    far below.
    """
    target = exported("slider_crank", method, tmp_path / "slider_crank", optimized)
    used = max(value for key, value in target.measured.items() if key.startswith("stack"))
    assert 100 < used <= target.stated < 4_000
    assert 1_000 < sum(target.sections(target.whole).values()) < 20_000


def test_the_machine_counts_instructions(tmp_path):
    """A loop of 200000 is counted as that, to a tick of 40; an evaluation is dearer than a motion,
    and cheaper than in doubles.
    """
    single = exported("slider_crank", "single", tmp_path / "single").measured
    double = exported("slider_crank", "double", tmp_path / "double").measured
    for measured in (single, double):
        assert abs(measured["instructions known"] - 200_000) <= 80
        assert (
            measured["instructions motion"]
            < measured["instructions evaluate"]
            <= measured["instructions worst"]
        )
    assert 500 < single["instructions evaluate"] < 1_500
    assert double["instructions evaluate"] > 8 * single["instructions evaluate"]
