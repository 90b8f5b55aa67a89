"""The arm in space as bare numbers: slender links, and revolute joints that turn by a polynomial of
the time.
"""

from __future__ import annotations

import numpy as np

from .paper_case import Array

LENGTHS = (0.16, 0.42, 0.39, 0.12, 0.1, 0.08)
MASSES = (3.7, 8.4, 2.3, 1.2, 1.2, 0.2)
AXES = (
    (0.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
    (1.0, 0.0, 0.0),
    (0.0, 0.0, 1.0),
    (0.0, 1.0, 0.0),
)
"""On the link before; the first link stands upright where its joint is at zero."""

UPRIGHT = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
GRAVITY = (0.0, 0.0, -9.81)
FIRST = (0.3, 0.6, 1.0, 0.4, 0.7, 0.9)
RATE = (3.0, -2.0, 4.0, 5.0, -3.0, 6.0)
TURN = (1.0, 2.0, -1.5, 0.5, 2.5, -2.0)
"""The first angles [rad], first rates, and half the accelerations."""

SECOND = 1
"""The link whose sections are asked for, by number."""


def motion(t: Array) -> tuple[Array, Array, Array]:
    """Angles, rates and accelerations, (6, t) each."""
    first, rate, half = (np.array(row)[:, None] for row in (FIRST, RATE, TURN))
    return (
        first + (rate + half * t) * t,
        rate + 2 * half * t,
        np.broadcast_to(2 * half, (len(FIRST), len(t))).copy(),
    )
