"""Fatigue: how a mean stress lowers what amplitude is borne, lives by S-N lines, and damage by Miner's sum.

Stresses of several components count by von Mises: of a swing between two instants the amplitude is half that of the differences of
the components (ASME Boiler and Pressure Vessel Code VIII-2, 5.5.3), so stresses out of phase are counted as they are. The mean is
that of the components half-way, where a normal stress in compression counts as none (Shigley, *Mechanical Engineering Design*, 9th
edition, sections 6-12 and 6-14). Which swings there are is counted along the direction of the largest difference.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..arguments import Numeric, public
from ..base.arrays import Array
from ..beams.beam import Notch
from ..beams.material import Material
from ..errors import UnknownNameError
from ..instants.section_law import Side
from .rainflow import rainflow
from .stress import Stress

FEW = 65
"""Ratios that are looked at first."""

_ROUNDS, _ZOOM = 3, 9
"""How often and how finely the place that is worst is looked at again."""

_LEAST = 1e3
"""Cycles from which on S-N lines hold."""

_SIDES: tuple[Side, Side] = ("base", "tip")


@dataclass(frozen=True)
class Criterion:
    """How a mean stress counts: ``strength`` is the material's number that bears it alone; ``square`` where it counts squared."""

    strength: str
    square: bool = False


CRITERIA = {
    "goodman": Criterion("ultimate"),
    "gerber": Criterion("ultimate", square=True),
    "soderberg": Criterion("yield_strength"),
    "morrow": Criterion("fatigue_strength"),
}


def criterion_of(name: str) -> Criterion:
    """A criterion by its name. Raises :class:`.UnknownNameError` for none."""
    if name not in CRITERIA:
        raise UnknownNameError("fatigue criterion", name, CRITERIA)
    return CRITERIA[name]


def strengths(material: Material, criterion: str) -> tuple[float, float]:
    """The endurance limit, and the strength that bears a mean stress alone.

    Raises :class:`.DeclarationError` for numbers that the material has not.
    """
    name, what = criterion_of(criterion).strength, f"fatigue by {criterion}"
    (endurance,) = material.needs(what, "endurance")
    if name == "fatigue_strength" and material.fatigue_strength is None:
        (ultimate,) = material.needs(what, "ultimate")
        return endurance, ultimate + 345e6
    return endurance, material.needs(what, name)[0]


@public
def factor(amplitude: Numeric, mean: Numeric, material: Material, criterion: str = "goodman") -> Any:
    """By how much amplitude and mean may grow together until the part no longer lasts for ever; of numbers or arrays.

    Goodman, Soderberg and Morrow: a/S_e + m/S = 1/n; Gerber: n a/S_e + (n m/S)^2 = 1 (Shigley, eq. 6-45 to 6-48; Dowling for
    Morrow). A mean in compression counts as none.
    """
    endurance, strength = strengths(material, criterion)
    a, m = np.asarray(amplitude) / endurance, np.maximum(mean, 0.0) / strength
    share = (a + np.sqrt(a * a + 4.0 * m * m)) / 2 if criterion_of(criterion).square else a + m
    with np.errstate(divide="ignore"):
        return 1.0 / share


@public
def reversed_amplitude(amplitude: Numeric, mean: Numeric, material: Material, criterion: str = "goodman") -> Any:
    """The amplitude without a mean that does the same damage; infinite where the mean alone is too much."""
    _, strength = strengths(material, criterion)
    m = np.maximum(mean, 0.0) / strength
    left = 1.0 - (m * m if criterion_of(criterion).square else m)
    return np.where(left > 0.0, np.asarray(amplitude) / np.where(left > 0.0, left, 1.0), np.inf)


def line(material: Material) -> tuple[float, float, float]:
    """The endurance limit, the amplitude that is borne a thousand times [Pa], and the exponent of a material's S-N line.

    Raises :class:`.DeclarationError` for numbers that the material has not.
    """
    endurance, ultimate = material.needs("a life", "endurance", "ultimate")
    start = material.fatigue_share * ultimate
    return endurance, start, math.log10(material.endurance_cycles / _LEAST) / math.log10(endurance / start)


@public
def cycles(amplitude: Numeric, material: Material) -> Any:
    """How often a fully reversed amplitude is borne: on the material's S-N line, and endlessly below its endurance limit.

    Above the line's beginning, at a thousand cycles, it goes straight on, and is a guess; of infinite amplitudes it is none.
    """
    endurance, start, slope = line(material)
    size = np.abs(amplitude)
    with np.errstate(divide="ignore", over="ignore"):
        found = _LEAST * (size / start) ** slope
    return np.where((size <= endurance) & material.endless, np.inf, found)


class Place(NamedTuple):
    """Where a link is looked at: a ratio xi/l, the side of it, and the notch whose factors count."""

    xi: float
    side: Side
    notch: Notch | None


class Loaded(NamedTuple):
    """The swings at a place and fibre: amplitudes and means [Pa], how often each comes in a cycle, and between which instants."""

    amplitude: Array
    mean: Array
    times: Array
    instants: list[tuple[int, int]]


def loaded(values: Array) -> Loaded:
    """The swings of a history of stresses (3, t), normal and shear along y and z, which repeats for ever."""
    vector = values * np.array([1.0, math.sqrt(3.0), math.sqrt(3.0)])[:, None]
    first, last = _farthest(vector)
    along = vector[:, last] - vector[:, first]
    size = float(np.linalg.norm(along))
    swings = rainflow(along @ vector / size, repeating=True) if size else []
    if not swings:  # none that is more than rounding
        pairs, counts = [(first, first)], [1.0]
    else:
        pairs, counts = [(s.first, s.last) for s in swings], [s.times for s in swings]
    a, b = (vector[:, list(side)] for side in zip(*pairs, strict=True))
    middle = (a + b) / 2
    mean = np.sqrt(np.maximum(middle[0], 0.0) ** 2 + middle[1] ** 2 + middle[2] ** 2)
    return Loaded(np.linalg.norm(b - a, axis=0) / 2, mean, np.array(counts), pairs)


def _farthest(points: Array) -> tuple[int, int]:
    """Two points (3, t) farthest from each other: those that are outermost in many directions, and from there on uphill."""
    if not points[1:].any():
        return int(np.argmin(points[0])), int(np.argmax(points[0]))
    levels = _DIRECTIONS @ points
    low, high = np.argmin(levels, axis=1), np.argmax(levels, axis=1)
    k = int(np.argmax(np.linalg.norm(points[:, high] - points[:, low], axis=0)))
    first, last, best = int(low[k]), int(high[k]), -1.0
    while (size := float(np.linalg.norm(points[:, last] - points[:, first]))) > best:
        best = size
        first, last = last, int(np.argmax(np.linalg.norm(points - points[:, last : last + 1], axis=0)))
    return first, last


def _directions() -> Array:
    """Half of all directions: in the planes of normal stress and one shear stress, and all around."""
    angles = np.arange(32) * math.pi / 32
    zero, c, s = np.zeros(32), np.cos(angles), np.sin(angles)
    # The even spirals of Saff and Kuijlaars.
    z = (np.arange(64) + 0.5) / 64
    turn = math.pi * (1.0 + math.sqrt(5.0)) * np.arange(64)
    r = np.sqrt(1.0 - z * z)
    return np.vstack([np.stack([c, s, zero], 1), np.stack([c, zero, s], 1), np.stack([z, r * np.cos(turn), r * np.sin(turn)], 1)])


_DIRECTIONS = _directions()


Score = Callable[[Loaded], tuple[float, ...]]
"""What is smallest where it is worst; of equals the second number tells."""


def factor_score(material: Material, criterion: str) -> Score:
    """The factor of safety against fatigue. Raises what :func:`strengths` does."""
    strengths(material, criterion)
    return lambda swings: (float(np.min(factor(swings.amplitude, swings.mean, material, criterion))),)


def damage_score(material: Material, criterion: str) -> Score:
    """The damage by Miner's sum, and where there is none the largest amplitude; times -1. Raises what :func:`strengths` does."""
    strengths(material, criterion)

    def score(swings: Loaded) -> tuple[float, float]:
        sizes = reversed_amplitude(swings.amplitude, swings.mean, material, criterion)
        with np.errstate(divide="ignore"):
            return -float(np.sum(swings.times / cycles(sizes, material))), -float(np.max(sizes))

    return score


def worst(stress: Stress, score: Score) -> tuple[tuple[float, ...], Place, str, Loaded]:
    """Where along a link and at which fibre a score is smallest: its value, the place, the fibre, and the swings there.

    Ratios are looked at evenly, at both sides of stations and steps, and at notches; where it is worst, finer and finer.
    """
    found: list[tuple[tuple[float, ...], Place, str, Loaded]] = []

    def look(places: Iterable[Place]) -> Place:
        found[:] = [min([*found, *(_at(stress, place, score) for place in places)], key=lambda one: one[0])]
        return found[0][1]

    sought(stress, look)
    return found[0]


def sought(stress: Stress, look: Callable[[Iterable[Place]], Place]) -> None:
    """Look at the places of a link, and then around the one that ``look`` says is the worst so far, finer and finer."""
    place, step = look(places(stress)), 1.0 / (FEW - 1)
    for _ in range(_ROUNDS):
        if place.notch is not None:
            return
        around = np.linspace(place.xi - step, place.xi + step, _ZOOM).tolist()
        place, step = look(Place(x, "tip", None) for x in around if 0.0 <= x <= 1.0), step * 2 / (_ZOOM - 1)


def places(stress: Stress) -> Iterator[Place]:
    """Where along a link fatigue is looked at first: evenly, at both sides of stations and steps, and at notches."""
    member = stress.member
    still = [float(mark[0]) for mark in member.marks if np.ptp(mark) == 0.0]
    steps = {*still, *(cell.low for cell in member.cells), *(cell.high for cell in member.cells)}
    yield from (Place(x, "tip", None) for x in np.linspace(0.0, 1.0, FEW).tolist())
    yield from (Place(x, side, None) for x, side in itertools.product(sorted(steps), _SIDES))
    yield from (Place(float(notch.at), side, felt(notch)) for notch, side in itertools.product(member.beam.notches, _SIDES))


def felt(notch: Notch) -> Notch:
    """What fatigue feels of a notch: K_f = 1 + q (K_t - 1) (Shigley, eq. 6-32)."""
    q = notch.sensitivity
    return Notch(notch.at, *(1.0 + q * (k - 1.0) for k in (notch.axial, notch.bending, notch.shear)))


def _at(stress: Stress, place: Place, score: Score) -> tuple[tuple[float, ...], Place, str, Loaded]:
    values = stress.at(place.xi, place.side, place.notch)
    every = [loaded(values[:, k]) for k in range(values.shape[1])]
    scores = [score(one) for one in every]
    k = scores.index(min(scores))
    return scores[k], place, stress.fibres(place.xi, place.side)[k], every[k]
