"""Grids of section forces: compiled or not, in one piece or in many, the same bits."""

import numpy as np
import pytest
from internals import grids

pytestmark = pytest.mark.quick

random = np.random.default_rng(4)


@pytest.mark.parametrize("many", [0, 2])
@pytest.mark.parametrize("planes", [1, 2])
@pytest.mark.parametrize("terms", [1, 2, 3, 4, 5, 9])
def test_sums_of_any_length_agree_to_the_last_bit(terms, planes, many, monkeypatch):
    """A link with loads along it has more terms than others: a resultant of five once lost its last
    one in compiled code.
    """
    n, k = 97, 521
    columns, rows = [*random.normal(size=(planes * terms, n))], random.normal(size=(terms, k))
    rows[0] = 1.0
    loads = [tuple(random.uniform(0, 1, size=(3, n))) for _ in range(planes * many)]
    u, found, tops = np.linspace(0, 1, k), [], []
    for worth, share, streaming in (
        (10**12, 1, 0),
        (0, 10**9, 10**12),
        (0, 1000, 10**12),
        (0, 10**9, 0),
        (0, 1000, 0),
    ):
        monkeypatch.setattr(grids, "WORTH_COMPILING", worth)
        monkeypatch.setattr(grids, "_SHARE", share)
        monkeypatch.setattr(grids, "_STREAMING", streaming)
        found.append(np.full((n + 1, k), np.nan))
        given = grids.Columns(columns, loads, planes), grids.Functions(rows)
        grids.fill([given], u, found[-1][None, :n], threads=3)
        assert np.isnan(found[-1][n]).all()
        design = [row[None] for row in columns], [tuple(row[None] for row in x) for x in loads]
        given = grids.Columns(*design, planes), grids.Functions(rows[:, None])
        tops.append(grids.largest(given, u))
    assert len({grid.tobytes() for grid in found}) == len({top.tobytes() for top in tops}) == 1
    sums = np.zeros((planes, n, k))
    for plane in range(planes):
        for m in range(plane * terms, (plane + 1) * terms):
            sums[plane] += columns[m][:, None] * rows[m - plane * terms]
        for station, constant, slope in loads[plane * many : (plane + 1) * many]:
            sums[plane] += np.where(
                u < station[:, None],
                constant[:, None] + slope[:, None] * (station[:, None] - u),
                0.0,
            )
    expected = np.hypot(*sums) if planes == 2 else sums[0]
    np.testing.assert_allclose(found[0][:n], expected, rtol=0, atol=1e-13)
    np.testing.assert_allclose(np.abs(tops[0][0]), np.abs(expected).max(axis=0), atol=1e-13)
