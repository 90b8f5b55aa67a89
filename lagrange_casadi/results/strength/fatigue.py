"""Fatigue: how a mean stress lowers what amplitude is borne, lives by S-N lines, and damage by
Miner's sum.

Stresses of several components count by von Mises: of a swing between two instants the amplitude is
half that of the differences of the components (ASME Boiler and Pressure Vessel Code VIII-2, 5.5.3),
so stresses out of phase are counted as they are. The mean is that of the components half-way, where
a normal stress in compression counts as none (Shigley, *Mechanical Engineering Design*, 9th
edition, sections 6-12 and 6-14). Which swings there are is counted along the direction of the
largest difference.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from ...base.arguments import Numeric, public
from ...base.arrays import Array, Operand
from ...errors import check_known
from ...model.beams.material import Material
from ...model.beams.properties import larger
from .rainflow import StressCycle, counted

_LEAST = 1e3
"""Cycles from which on S-N lines hold."""

_NOTHING = 1e-300
"""Amplitude [Pa] in the place of none."""


CRITERIA = {
    "goodman": "ultimate",
    "gerber": "ultimate",
    "soderberg": "yield_strength",
    "morrow": "fatigue_strength",
}
"""Treatments of a mean stress, and the material's number for a mean stress alone."""

_SQUARED = "gerber"
"""The treatment by which the mean counts squared."""


def strengths(material: Material, criterion: str) -> tuple[float, float]:
    """The endurance limit, and the strength that bears a mean stress alone.

    Raises :class:`.UnknownNameError` for no criterion, :class:`.DeclarationError` for numbers that
    the material has not.
    """
    names = _needed(material, criterion)
    endurance, strength = material.needs(f"fatigue by {criterion}", *names)
    return endurance, strength if names[1] == CRITERIA[criterion] else strength + 345e6


def _needed(material: Material, criterion: str) -> tuple[str, str]:
    check_known("fatigue criterion", [criterion], CRITERIA)
    name = CRITERIA[criterion]
    missing = name == "fatigue_strength" and material.fatigue_strength is None
    return "endurance", "ultimate" if missing else name


@public
def factor(
    amplitude: Annotated[Numeric, "Pa"],
    mean: Annotated[Numeric, "Pa"],
    material: Material,
    criterion: str = "goodman",
) -> Numeric:
    """Return the factor by which amplitude and mean may grow together without failure by fatigue.

    Parameters
    ----------
    amplitude, mean : float or array
        Amplitude and mean of the stress [Pa]. A negative mean counts as zero.
    material : Material
        Has the endurance limit S_e, and the strength S that the criterion needs.
    criterion : str
        One of :data:`.CRITERIA`: ``"goodman"``, ``"gerber"``, ``"soderberg"`` or ``"morrow"``.

    Returns
    -------
    float or array
        The factor of safety n.

    Raises
    ------
    UnknownNameError
        For another criterion.
    DeclarationError
        If the material lacks a number that is needed.

    Notes
    -----
    Goodman, Soderberg and Morrow: a/S_e + m/S = 1/n; Gerber: n a/S_e + (n m/S)^2 = 1 (Shigley, eq.
    6-45 to 6-48; Dowling for Morrow).
    """
    with np.errstate(divide="ignore"):
        return 1.0 / used(np.asarray(amplitude), np.asarray(mean), material, criterion)


def used(amplitude: Array, mean: Array, material: Material, criterion: str = "goodman") -> Operand:
    """Utilisation of a material by amplitude and mean, one over :func:`factor`; of numbers, arrays
    or expressions.
    """
    endurance, strength = strengths(material, criterion)
    a, m = amplitude / endurance, larger(mean, 0.0) / strength
    return (a + (a * a + 4.0 * m * m) ** 0.5) / 2 if criterion == _SQUARED else a + m


def lacking(material: Material, criterion: str = "goodman") -> str:
    """Say why fatigue of a material is open by a criterion, or on Findley's planes: which numbers
    it has not; empty if none.
    """
    needed = _needed(material, criterion) if criterion in CRITERIA else ("endurance",)
    missing = [name for name in needed if getattr(material, name) is None]
    return (
        f"fatigue: material '{material.name}' has no {' and no '.join(missing)}" if missing else ""
    )


@public
def reversed_amplitude(
    amplitude: Annotated[Numeric, "Pa"],
    mean: Annotated[Numeric, "Pa"],
    material: Material,
    criterion: str = "goodman",
) -> Numeric:
    """Return the fully reversed amplitude with the same damage as an amplitude with a mean.

    Parameters
    ----------
    amplitude, mean : float or array
        Amplitude and mean of the stress [Pa]. A negative mean counts as zero.
    material : Material
        Has the strength that the criterion needs.
    criterion : str
        One of :data:`.CRITERIA`.

    Returns
    -------
    float or array
        The amplitude [Pa], infinite if the mean alone causes failure.

    Raises
    ------
    UnknownNameError
        For another criterion.
    DeclarationError
        If the material lacks a number that is needed.
    """
    _, strength = strengths(material, criterion)
    m = np.maximum(mean, 0.0) / strength
    remaining = 1.0 - (m * m if criterion == _SQUARED else m)
    return np.where(
        remaining > 0.0, np.asarray(amplitude) / np.where(remaining > 0.0, remaining, 1.0), np.inf
    )


def line(material: Material) -> tuple[float, float, float]:
    """The endurance limit, the amplitude that is borne a thousand times [Pa], and the exponent of a
    material's S-N line.

    Raises :class:`.DeclarationError` for numbers that the material has not.
    """
    endurance, ultimate = material.needs("a life", "endurance", "ultimate")
    start = material.fatigue_share * ultimate
    return (
        endurance,
        start,
        math.log10(material.endurance_cycles / _LEAST) / math.log10(endurance / start),
    )


@public
def cycles(amplitude: Annotated[Numeric, "Pa"], material: Material) -> Numeric:
    """Return the number of cycles to failure at a fully reversed amplitude.

    Parameters
    ----------
    amplitude : float or array
        Amplitude of stress [Pa].
    material : Material
        Has the S-N line: ultimate strength, endurance limit and its number of cycles.

    Returns
    -------
    float or array
        Cycles by the S-N line, infinite below the endurance limit of an ``endless`` material. The
        line begins at 1000 cycles; a smaller number is an estimate, from the same line continued.

    Raises
    ------
    DeclarationError
        If the material has no endurance limit.
    """
    endurance, start, slope = line(material)
    size = np.abs(amplitude)
    with np.errstate(divide="ignore", over="ignore"):
        found = _LEAST * (size / start) ** slope
    return np.where((size <= endurance) & material.endless, np.inf, found)


class Loaded(NamedTuple):
    """The swings at a place and fibre: amplitudes and means [Pa], how often each comes in a cycle,
    and between which instants.
    """

    amplitude: Array
    mean: Array
    times: Array
    instants: list[tuple[int, int]]


def loaded(values: Array) -> Loaded:
    """The swings of a history of stresses (3, t), normal and shear along y and z, which repeats for
    ever.
    """
    vector, (first, last) = values * _VON_MISES, widest(values)
    along = vector[:, last] - vector[:, first]
    size = float(np.linalg.norm(along))
    stress_cycles = counted(along @ vector / size, repeating=True) if size else []
    # Where nothing is more than rounding, there is one swing of none.
    stress_cycles = stress_cycles or [StressCycle(0.0, 0.0, 1.0, first, first)]
    _, _, counts, *ends = zip(*stress_cycles, strict=True)
    a, b = (values[:, list(side)] for side in ends)
    amplitude, mean = (np.sqrt(square) for square in cycle_squares(a, b))
    return Loaded(amplitude, mean, np.array(counts), list(zip(*ends, strict=True)))


_VON_MISES = np.array([[1.0], [math.sqrt(3.0)], [math.sqrt(3.0)]])


def cycle_squares(first: Operand, last: Operand) -> tuple[Operand, Operand]:
    """The squares of amplitude and mean of a swing from some stresses, normal and shear, to others.

    They are numbers, arrays or expressions.
    """
    far, *across = (b - a for a, b in zip(first, last, strict=True))
    normal, *shears = ((a + b) / 2 for a, b in zip(first, last, strict=True))
    amplitude = (far**2 + 3.0 * sum(shear**2 for shear in across)) / 4
    return amplitude, larger(normal, 0.0) ** 2 + 3.0 * sum(shear**2 for shear in shears)


def widest(values: Array) -> tuple[int, int]:
    """The two instants between which stresses (3, t) differ most, by von Mises: of those that are
    outermost in many directions, and from there on uphill.
    """
    points = values * _VON_MISES
    sheared = [axis for axis in (1, 2) if points[axis].any()]
    if not sheared:
        return int(np.argmin(points[0])), int(np.argmax(points[0]))
    if len(sheared) == 1:
        points = points[[0, *sheared]]
    levels = _DIRECTIONS[len(points)] @ points
    low, high = np.argmin(levels, axis=1), np.argmax(levels, axis=1)
    k = int(np.argmax(_squares(points[:, high] - points[:, low])))
    first, last, best = int(low[k]), int(high[k]), -1.0
    while (size := float(_squares(points[:, last] - points[:, first]))) > best:
        best = size
        first, last = last, int(np.argmax(_squares(points - points[:, last : last + 1])))
    return first, last


def _squares(vectors: Array) -> Array:
    return np.asarray(np.einsum("i...,i...->...", vectors, vectors))


def _directions() -> dict[int, Array]:
    """Half of all directions: in the plane of normal and one shear stress, and all around."""
    angles = np.arange(32) * math.pi / 32
    zero, c, s = np.zeros(32), np.cos(angles), np.sin(angles)
    # The even spirals of Saff and Kuijlaars.
    z = (np.arange(64) + 0.5) / 64
    turn = math.pi * (1.0 + math.sqrt(5.0)) * np.arange(64)
    r = np.sqrt(1.0 - z * z)
    around = np.stack([z, r * np.cos(turn), r * np.sin(turn)], 1)
    planes = [np.stack([c, s, zero], 1), np.stack([c, zero, s], 1)]
    return {2: np.stack([c, s], 1), 3: np.vstack([*planes, around])}


_DIRECTIONS = _directions()
"""Directions by the number of stresses that are not zero throughout."""


@dataclass(frozen=True, eq=False)
class Score:
    """Measure that is largest where a link is worst, ``of`` stresses (3, t) at a place.

    ``bound`` of stresses (k, ..., t), of which the first are normal stresses and all others shear
    stresses, is convex in them, and no score is above it. If it is ``exact`` it is the score of
    normal stress alone. ``swing`` says how bad a swing is by its amplitude and its mean.
    """

    of: Callable[[Array], float]
    bound: Callable[[Array], Array]
    swing: Callable[[Array, Array], Operand]
    exact: bool = False

    def of_swing(self, stresses: Array) -> Array:
        """Rate swings (...) between two stresses, (k, ..., 2)."""
        amplitude, mean = cycle_squares(stresses[..., 0], stresses[..., 1])
        return np.asarray(self.swing(np.sqrt(amplitude), np.sqrt(mean)))


def use_score(material: Material, criterion: str = "goodman") -> Score:
    """The utilisation against fatigue. Raises what :func:`strengths` does.

    Of a history of normal stress alone the swing from its smallest to its largest value is the
    worst, as long as means count for less than amplitudes.
    """
    endurance, strength = strengths(material, criterion)
    exact = strength >= (2.0 if criterion == _SQUARED else 1.0) * endurance
    swing = partial(used, material=material, criterion=criterion)

    def of(values: Array) -> float:
        found = loaded(values)
        return float(np.max(swing(found.amplitude, found.mean)))

    return Score(of, lambda stresses: _bound(swing, stresses, exact=exact), swing, exact)


def damage_score(material: Material, criterion: str = "goodman") -> Score:
    """The damage by Miner's sum; where there is none, minus one over the largest amplitude.

    It raises what :func:`strengths` does when it is asked.
    """

    def score(amplitude: Array, mean: Array, times: Array | float, axis: int | tuple[()]) -> Array:
        sizes = np.asarray(reversed_amplitude(amplitude, mean, material, criterion))
        with np.errstate(divide="ignore"):
            damage = np.sum(times / cycles(sizes, material), axis=axis)
        nothing = -1.0 / np.maximum(np.max(sizes, axis=axis), _NOTHING)
        return np.asarray(np.where(damage > 0.0, damage, nothing))

    def of(values: Array) -> float:
        found = loaded(values)
        return float(score(found.amplitude, found.mean, found.times, 0))

    def bound(stresses: Array) -> Array:
        times = stresses.shape[-1] / 2 + 1
        return _bound(lambda amplitude, mean: score(amplitude, mean, times, ()), stresses)

    return Score(of, bound, partial(used, material=material, criterion=criterion))


def _bound(
    swing: Callable[[Array, Array], Operand], stresses: Array, *, exact: bool = False
) -> Array:
    """Bound on how bad any ``swing`` in stresses (k, ..., t) is.

    Shear stress counts as the widest, about the largest. Then a swing is no worse than one between
    the smallest and the largest normal stress, or than one of shear alone at the largest. The
    first is the worst of normal stress alone if a score is ``exact``.
    """
    low, high = stresses.min(axis=-1), stresses.max(axis=-1)
    if exact and len(stresses) == 1:
        return np.asarray(swing((high[0] - low[0]) / 2, (high[0] + low[0]) / 2))
    ranges = 3.0 * np.sum((high[1:] - low[1:]) ** 2, axis=0)
    sizes = 3.0 * np.sum(np.maximum(high[1:], -low[1:]) ** 2, axis=0)
    corners = [
        swing(np.sqrt((high[0] - first) ** 2 + ranges) / 2, np.sqrt(larger(mean, 0.0) ** 2 + sizes))
        for first, mean in ((low[0], (low[0] + high[0]) / 2), (high[0], high[0]))
    ]
    return np.asarray(np.maximum(*corners))
