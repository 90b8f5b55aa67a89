"""What a load along a link does, for the oracle: forces at points along the part of it that is
beyond a cut.

Newton and Cotes' rule on nine points is exact for the load and its arms, where the load is a
polynomial of degree eight at most.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

_POINTS = 9


@dataclass(frozen=True)
class Spread:
    """A load along a body's axis from ``start`` to ``end`` [m]; ``at(x)`` is its force per length
    there, in ground axes.
    """

    body: str
    start: float
    end: float
    at: Callable


@functools.cache
def weights():
    """Places k/8 and the weights of the values there, by the moments of the powers: exact
    fractions.
    """
    places = [Fraction(k, _POINTS - 1) for k in range(_POINTS)]
    found = []
    for k, own in enumerate(places):
        others = [x for i, x in enumerate(places) if i != k]
        powers = [Fraction(1)]
        for x in others:
            powers = [
                a - x * b
                for a, b in zip([Fraction(0), *powers], [*powers, Fraction(0)], strict=True)
            ]
        found.append(
            sum(c / (j + 1) for j, c in enumerate(powers)) / math.prod(own - x for x in others)
        )
    return list(zip(places, found, strict=True))


def forces(spreads, arithmetic, link=None, cut=None):
    """Forces (point, fx, fy, 0): of all of them, or of those on a ``link``, so much of them as is
    beyond a ``cut`` [m].
    """
    found = []
    for one in spreads:
        low = one.start if cut is None or cut < one.start else cut
        if link in (None, one.body) and low < one.end:
            for place, weight in weights():
                at = low + (one.end - low) * arithmetic.number(place.numerator) / place.denominator
                share = (one.end - low) * arithmetic.number(weight.numerator) / weight.denominator
                fx, fy = one.at(at)
                found.append(
                    (
                        (one.body, at, arithmetic.number(0)),
                        share * fx,
                        share * fy,
                        arithmetic.number(0),
                    )
                )
    return found
