"""The benchmarks' own machinery: what they measure is right, and what is wrong gets no time."""

import pytest

from benchmarks import comparisons
from benchmarks.definitions import Comparison


@pytest.fixture(autouse=True)
def _short(monkeypatch):
    monkeypatch.setattr(comparisons, "_ROUNDS", 1)
    monkeypatch.setattr(comparisons, "_ROUND", 0.0)


def rows(work, methods, base="by hand", **sizes):
    comparison = Comparison("trial", "a trial", work, methods, base, "ns", **sizes)
    return {row["method"]: row for row in comparisons.measure(comparison)}


ENGINE = ("lanes x cores", "lanes", "c", "vm")


ARM = ("arm", "arm c", "arm x cores")
FILLS = {
    ("instants", (*ENGINE, "by hand", "by hand, vectors", "numpy")): {"t": 21},
    ("sections", (*ENGINE, "by hand", "numpy")): {"t": 21, "xi": 9},
    ("designs", (*ENGINE[:3], "by hand", "numpy")): {"t": 21, "designs": 3},
    ("efforts", ENGINE): {"t": 11, "links": 3},
    ("fill", ("memcpy", "fill", "fill x cores")): {"t": 30, "xi": 9},
    ("arm_efforts", ARM): {"t": 11},
    ("arm_sections", ARM): {"t": 11, "xi": 9},
    ("arm_resultants", ("memcpy", "arm fill", "arm fill x cores")): {"t": 30, "xi": 9},
}
"""Works, the methods that do each, and sizes."""


@pytest.mark.parametrize(("work", "methods"), FILLS)
def test_every_method_does_the_work(work, methods):
    base = "by hand" if "by hand" in methods else methods[0]
    found = rows(work, methods, base, **FILLS[work, methods])
    assert all(row["error"] < 1e-13 and row["ns"] > 0 for row in found.values()), found
    assert found[base]["ratio"] == 1.0


def test_a_method_whose_result_is_wrong_reports_no_time(monkeypatch):
    right = comparisons._work

    def wrong(comparison, name):
        work = right(comparison, name)
        return (lambda: work() * (1 + 1e-8)) if name == "c" else work

    monkeypatch.setattr(comparisons, "_work", wrong)
    found = rows("instants", ("c", "by hand"), t=9)
    assert "ns" not in found["c"]
    assert found["c"]["why"].startswith("wrong: 1.0e-08 of the peak")
    assert "wrong" in comparisons.row(found["c"])
