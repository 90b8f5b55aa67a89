"""The cubic spline through points once more, by its slopes at the points and a full matrix."""

from __future__ import annotations

import numpy as np


def by_hand(x, y, periodic):
    """Value, slope and second derivative of the same spline, from its slopes at the points, by a
    full matrix.
    """
    n, h = x.size, np.diff(x)
    matrix, right = np.zeros((n, n)), np.zeros(n)
    rise = np.diff(y) / h
    for i in range(1, n - 1):
        matrix[i, i - 1 : i + 2] = h[i], 2 * (h[i - 1] + h[i]), h[i - 1]
        right[i] = 3 * (h[i] * rise[i - 1] + h[i - 1] * rise[i])
    if periodic:
        matrix[0, [0, 1, n - 2]] = 2 * (h[-1] + h[0]), h[-1], h[0]
        right[0] = 3 * (h[0] * rise[-1] + h[-1] * rise[0])
        matrix[-1, [0, -1]] = 1, -1
    else:
        # The third derivatives of the first two pieces are one, and those of the last two.
        for row, i, j in ((0, 0, 1), (n - 1, n - 3, n - 2)):
            for k, sign in ((i, 1), (j, -1)):
                matrix[row, [k, k + 1]] += sign / h[k] ** 2
                right[row] += sign * 2 * rise[k] / h[k] ** 2
    slopes = np.linalg.solve(matrix, right)

    def at(place):
        place = (place - x[0]) % (x[-1] - x[0]) + x[0] if periodic else place
        i = min(max(int(np.searchsorted(x, float(place), side="right")) - 1, 0), n - 2)
        u, a, b = place - x[i], slopes[i], slopes[i + 1]
        c, d = (3 * rise[i] - 2 * a - b) / h[i], (a + b - 2 * rise[i]) / h[i] ** 2
        return y[i] + u * (a + u * (c + u * d)), a + u * (2 * c + 3 * u * d), 2 * c + 6 * u * d

    return at
