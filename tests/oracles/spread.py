"""What a load along a link does, for the oracle: forces at points along the part of it that is
beyond a cut.

Gauss' rule is exact for the load and its arms, where the load is a polynomial.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from arithmetic import GAUSS


@dataclass(frozen=True)
class Spread:
    """A load along a body's axis from ``start`` to ``end`` [m]; ``at(x)`` is its force per length
    there, in ground axes.
    """

    body: str
    start: float
    end: float
    at: Callable


def forces(spreads, link=None, cut=None):
    """Forces (point, fx, fy, 0): of all of them, or of those on a ``link``, so much of them as is
    beyond a ``cut`` [m].
    """
    found = []
    for one in spreads:
        low = one.start if cut is None or cut < one.start else cut
        if link in (None, one.body) and low < one.end:
            for node, weight in zip(*GAUSS, strict=True):
                at = low + (one.end - low) * (node + 1.0) / 2.0
                share = (one.end - low) * weight / 2.0
                fx, fy = one.at(at)
                found.append(
                    (
                        (one.body, at, 0.0),
                        share * fx,
                        share * fy,
                        0.0,
                    )
                )
    return found
