"""What exported functions answer, beside the statuses of instants."""

import itertools

from internals import SHARED, STATUSES, Status

PARAMETERS = {Status.INVALID, Status.IMPOSSIBLE}
OF_DESIGNS = {
    Status.PASSES_DEAD_CENTRE,
    Status.UNCERTIFIED,
    Status.PEAK_NOT_LOCATED,
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
