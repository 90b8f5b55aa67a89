"""The table rung as a user has it: the graph's numbers within what it claims, in both precisions,
after many turns.
"""

from pathlib import Path

import numpy as np
import pytest
from mechanisms import slider_crank

from lagrange_casadi import evaluate, load_case

CASES = Path(__file__).parents[2] / "cases"
CLAIM = 3.0  # what a table claims is what it was seen to miss halfway between its nodes


def gaps(exact, read):
    """By quantity: how far it is off, and the peak."""
    for name in exact.names():
        yield (
            name,
            np.max(np.abs(exact.array(name) - read.array(name))),
            np.max(np.abs(exact.array(name))),
        )


@pytest.mark.sampled(9)
@pytest.mark.parametrize(
    "method",
    [
        {"table": 1e-9},
        {"table": 64},
        {"table": 1e-6, "backend": "vm"},
        {"table": 64, "precision": "single"},
    ],
)
@pytest.mark.parametrize("name", ["slider_crank", "four_bar", "andrews_squeezer"])
def test_a_table_is_right_within_what_it_claims(name, method):
    scene = load_case(CASES / name).scene
    exact, read = evaluate(scene), evaluate(scene, **method)
    for quantity, gap, _ in gaps(exact, read):
        assert gap <= CLAIM * read.errors[quantity] + exact.errors[quantity], quantity
    assert (
        max(residuals.max() for name, residuals in read.certificate.items() if name != "condition")
        < 1e-5
    )


LATE = ((1e6, {"table": 1e-9}, 1e-9), (3600.0, {"table": 1e-6, "precision": "single"}, 2e-6))


@pytest.mark.parametrize(("start", "method", "least"), LATE)
def test_phases_outlast_many_turns(start, method, least):
    scene = slider_crank(["effort", "reaction:guide"])
    exact, read = (evaluate(scene, t=(start, start + 0.01, 50), **words) for words in ({}, method))
    assert max(gap / peak for _, gap, peak in gaps(exact, read) if peak) < least


def test_angles_count_turns():
    """Of the crank, and of the rod, which swings: the joint between them counts turns backward."""
    scene = slider_crank(["motion"])
    exact, read = (evaluate(scene, t=(0, 1.0, 2001), **words) for words in ({}, {"table": 1e-10}))
    assert exact.motion("A").value[-1] < -70
    for name, gap, _ in gaps(exact, read):
        assert gap < 1e-5 * max(1.0, np.max(np.abs(exact.array(name)))), name
    np.testing.assert_allclose(read.motion("A").value, exact.motion("A").value, atol=1e-9)
    np.testing.assert_allclose(read.pose("rod").angle, exact.pose("rod").angle, atol=1e-9)
