"""What exported functions answer, beside the statuses of instants; and what rules keep to."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from internals import SHARED, STATUSES, Status

from lagrange_casadi import derive, load_case

CASES = Path(__file__).parents[2] / "cases"

ABOVE = ("CLOSURE", "BRANCH", "JAM")

PARAMETERS = {Status.INVALID, Status.IMPOSSIBLE}
OF_DESIGNS = {
    Status.PASSES_DEAD_CENTRE,
    Status.UNCERTIFIED,
    Status.PEAK_NOT_TOLD,
    Status.NO_INSTANTS,
    Status.CORNER,
}


def test_every_reason_of_an_instant_is_told_in_the_same_words():
    told = list(itertools.chain(*SHARED.values()))
    assert len(told) == len(set(told))
    assert set(told) == set(Status) - PARAMETERS - OF_DESIGNS - {Status.OK}
    for name, statuses in SHARED.items():
        assert all(status.meaning in STATUSES[name] for status in statuses)


def test_numbers_in_c_stay():
    """Programs compare with them."""
    assert list(STATUSES) == [
        *(
            "OK",
            "NOT_PREPARED",
            "BAD_PARAMETER",
            "BAD_INPUT",
            "BAD_TIME",
            "BAD_RATIO",
            "NO_LINK",
            "NOT_ASSEMBLED",
            "DEAD_CENTRE",
        ),
        *(
            "NOT_CONVERGED",
            "JUMPED",
            "SLOW",
            "INCONSISTENT",
            "NOT_CLOSED",
            "UNDETERMINED",
            "NOT_FINITE",
            "TURNED",
        ),
        *("BEYOND_ENDS", "JAMS", "AT_REST"),
    ]


@pytest.mark.parametrize("name", ["beam_pump", "sleigh", "v_twin", "roller_cam", "cardan_shaft"])
def test_rules_are_kept_within_intervals(name):
    """If the least and the largest of some instants keep all rules, so does each between them."""
    program, rng = derive(load_case(CASES / name).scene), np.random.default_rng(33)
    many, kept = len(program.bounds), 0
    for _ in range(300):
        limits = np.abs(rng.normal(size=(many, 1)))
        # Most of what is drawn keeps its rule on one side of zero, or on both.
        lowest = np.where([[bound.kind in ABOVE] for bound in program.bounds], limits, -limits)
        checks = lowest + np.abs(rng.normal(size=(many, 6))) * rng.choice([1.0, 0.1, 0.01])
        besides = [[bound.kind == "ROW"] for bound in program.bounds] * np.ones((many, 6))
        ends = [np.array([row.min(axis=1), row.max(axis=1)]).T for row in (checks, besides)]
        if not program.status(ends[0], limits, ends[1], 0).full().any():
            kept += 1
            assert not program.status(checks, limits, besides, 0).full().any()
    assert 30 < kept < 300
