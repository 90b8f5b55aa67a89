"""Worst place along a link of a solution, and its fibre, for fatigue."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np

from ..base.arrays import Array
from ..beams.beam import Notch
from ..instants.section_law import Side
from .fatigue import Histories, Loaded, Score, notch_factor
from .stress import Stress

FEW = 65
"""Ratios that are looked at first."""

_ROUNDS, _ZOOM = 3, 9
"""Number of refinements of the worst place, and their fineness."""

_NUMBERS = 1 << 20
"""Stresses that are at hand at once."""

_SIDES: tuple[Side, Side] = ("base", "tip")


class Place(NamedTuple):
    """Place on a link: a ratio xi/l, its side, and the notch whose factors count."""

    xi: float
    side: Side
    notch: Notch | None


def worst(stress: Stress, score: Score) -> tuple[tuple[float, ...], Place, str, Loaded]:
    """Place along a link, and fibre, at which a score is smallest: its value, the place, the fibre,
    and the stress cycles there.

    Ratios are looked at evenly, at both sides of stations and steps, and at notches; where it is
    worst, finer and finer.
    """
    found: list[tuple[tuple[float, ...], Place, str, Loaded]] = []

    def assess(places: Iterable[Place]) -> Place:
        for values, fibres in stresses_at(stress, places):
            best = Histories.of(values).worst(score, found[0][0] if found else None)
            if best is not None:
                value, k, cycles = best
                found[:] = [(value, *fibres[k], cycles)]
        return found[0][1]

    sought(stress, assess)
    return found[0]


def sought(stress: Stress, assess: Callable[[Iterable[Place]], Place]) -> None:
    """Look at the places of a link, and then around the one that ``look`` says is the worst so far,
    finer and finer.
    """
    place, step = assess(places(stress)), 1.0 / (FEW - 1)
    for _ in range(_ROUNDS):
        if place.notch is not None:
            return
        around = np.linspace(place.xi - step, place.xi + step, _ZOOM).tolist()
        place, step = (
            assess(Place(x, "tip", None) for x in around if 0.0 <= x <= 1.0),
            step * 2 / (_ZOOM - 1),
        )


def places(stress: Stress) -> Iterator[Place]:
    """Places along a link at which fatigue is evaluated first: evenly, at both sides of load points
    and steps, and at notches.
    """
    member = stress.member
    still = [float(mark[0]) for mark in member.marks if np.ptp(mark) == 0.0]
    steps = {*still, *(cell.low for cell in member.cells), *(cell.high for cell in member.cells)}
    yield from (Place(x, "tip", None) for x in np.linspace(0.0, 1.0, FEW).tolist())
    yield from (Place(x, side, None) for x, side in itertools.product(sorted(steps), _SIDES))
    yield from (
        Place(float(notch.at), side, notch_factor(notch))
        for notch, side in itertools.product(member.beam.notches, _SIDES)
    )


def stresses_at(
    stress: Stress, places: Iterable[Place]
) -> Iterator[tuple[Array, list[tuple[Place, str]]]]:
    """The stresses at places, (3, fibres of all of them, t), and the place and the name of each
    fibre; some places after others.
    """
    values, fibres, size = list[Array](), list[tuple[Place, str]](), 0
    for place in places:
        values.append(stress.at(place.xi, place.side, place.notch))
        fibres += [(place, name) for name in stress.fibres(place.xi, place.side)]
        size += values[-1].size
        if size > _NUMBERS:
            yield np.concatenate(values, axis=1), fibres
            values, fibres, size = [], [], 0
    if values:
        yield np.concatenate(values, axis=1), fibres
