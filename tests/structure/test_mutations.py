"""Mutations change one expression of what computes numbers, and are undone."""

import mutations
import pytest

pytestmark = pytest.mark.quick

TEXT = """def force(x: tuple[float, ...]) -> float:
    text = "a" + f"{x[0] - 1}"
    total = (x[0]
             - mass * (-x[1]))
    return total if x < 1 else 0.0
"""
CHANGED = {
    "x[0] - mass * -x[1] -> (x[0] + mass * -x[1])",
    "x[0] - mass * -x[1] -> (x[0])",
    "x[0] -> (x[1])",
    "-x[1] -> (x[1])",
    "x[1] -> (x[0])",
    "x < 1 -> (x >= 1)",
}


@pytest.fixture
def package(tmp_path, monkeypatch):
    monkeypatch.setattr(mutations, "PACKAGE", tmp_path)
    return tmp_path


def test_every_sign_term_index_and_comparison_of_numbers_is_changed(package):
    (package / "force.py").write_text(TEXT)
    found = [*mutations._of_python(package / "force.py")]
    assert {f"{one.old} -> {one.new}" for one in found} == CHANGED
    assert {(one.first, one.line) for one in found} == {(3, 3), (3, 4), (5, 5)}


def test_c_is_changed_outside_comments(package):
    (package / "force.c").write_text("/* a + b */\n#if A < B\nx = a - b; /* c\n + d */\n#endif\n")
    (one,) = mutations._of_c(package / "force.c")
    assert (str(one), one.line) == ("force.c: - in 'x = a - b; /* c' -> +", 3)
