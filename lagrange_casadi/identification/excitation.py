"""Motions that determine parameters best: Fourier series within the limits of a machine.

Swevers et al., *Optimal robot excitation and identification*, IEEE Trans. Robotics and Automation
13, 1997.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import casadi as ca
import numpy as np

from ..arguments import Count, Positive, public
from ..base.arrays import Array, Expression
from ..base.vocabulary import Backend
from ..case import Case, scene_of
from ..declare.motion import Motion, expression
from ..declare.scene import Scene
from ..errors import AssemblyError, DeclarationError, UnknownNameError
from ..instants.evaluation_method import EvaluationMethod
from .base import Base, Ranking, base_of
from .regressor import DrivenMotion, Regressor

_SAMPLES = 64
"""Instants for each harmonic: between them a series exceeds its largest sample by 0.12 %."""

_MARGIN = 1.0 - (math.pi / _SAMPLES) ** 2 / 2.0
_INSTANTS = 96
"""Instants at which derivatives are evaluated."""

_DRAWN = 64
_GROWS, _SHRINKS = 1.5, 0.9
"""Factors of the width of the search after a step that is better, and one that is not."""


@public
@dataclass(frozen=True, eq=False)
class Excitation:
    """A periodic motion of drives, and how well it determines the parameters.

    ``sines`` and ``cosines`` are amplitudes of each harmonic, and ``centres`` the means, by drive
    [rad or m]. ``condition`` is that of the base, in columns of norm 1, and ``first`` that of the
    best of the motions drawn at random from which the search began. ``base`` are the combinations
    that the motion determines.
    """

    period: float
    centres: Mapping[str, float]
    sines: Mapping[str, Array]
    cosines: Mapping[str, Array]
    condition: float
    first: float
    base: tuple[str, ...]

    @property
    def motion(self) -> dict[str, Motion]:
        """Laws of motion by drive, for a :class:`.Scene`."""
        return {drive: expression(partial(self._law, drive)) for drive in self.centres}

    def _law(self, drive: str, t: ca.SX) -> Expression:
        law = ca.SX(self.centres[drive])
        for k, (a, b) in enumerate(zip(self.sines[drive], self.cosines[drive], strict=True), 1):
            angle = k * math.tau / self.period * t
            law += float(a) * ca.sin(angle) + float(b) * ca.cos(angle)
        return law


@public
def excite(
    scene: Scene | Case,
    limits: Mapping[str, Sequence[float]],
    unknown: Sequence[str] | None = None,
    *,
    quantities: Sequence[str] | None = None,
    period: Positive = 10.0,
    harmonics: Count = 4,
    steps: Count = 300,
    parameters: Mapping[str, float] | None = None,
    backend: Backend = "auto",
) -> Excitation:
    """Return a motion within limits that determines unknown parameters well.

    A random search, the same in every run, minimises the condition number of the base. The motion
    reaches a limit of each drive.

    Parameters
    ----------
    scene
        The scene, or a case.
    limits
        Least and largest coordinate, largest speed and largest acceleration [rad or m, s], by
        drive.
    unknown
        Names of parameters; by default all that the scene declares.
    quantities
        What is measured, as in :class:`.Measurements`; by default the efforts of all drives.
    period
        Period of the motion [s].
    harmonics
        Number of harmonics of each drive.
    steps
        Number of motions that are tried after the first 64.
    parameters
        Values of parameters, in place of the defaults.
    backend
        As in :func:`.evaluate`.

    Returns
    -------
    Excitation
        The motion, and the combinations of parameters that it determines.

    Raises
    ------
    UnknownNameError
        For parameters and quantities that there are not.
    DeclarationError
        For limits that leave no motion.
    AssemblyError
        If the mechanism cannot follow any motion within the limits.
    """
    scene = scene_of(scene)
    values = scene.values(parameters)
    names = tuple(scene.parameters) if unknown is None else tuple(dict.fromkeys(unknown))
    if quantities is None:
        efforts = scene.needs_drives if scene.weights is None else scene.weights
        quantities = [f"effort:{drive}" for drive in efforts]
    regressor = Regressor.of(scene, tuple(quantities), names, EvaluationMethod(backend))
    drives = regressor.program.driven
    if lost := [drive for drive in drives if drive not in limits]:
        raise UnknownNameError("drive of limits=", lost, limits)
    bounds = np.array([_limits(drive, limits[drive]) for drive in drives])
    p = np.array(list(values.values()))
    search = _Search(regressor, names, bounds, p, float(period), harmonics)
    return search.run(steps)


def _limits(drive: str, given: Sequence[float]) -> list[float]:
    numbers = [float(number) for number in given]
    if len(numbers) != 4 or not (numbers[0] < numbers[1] and numbers[2] > 0.0 < numbers[3]):
        raise DeclarationError(
            f"limits of '{drive}': expected the least and the largest coordinate, a speed and an"
            f" acceleration above 0, got {', '.join(f'{x:g}' for x in numbers)}"
        )
    return numbers


@dataclass(frozen=True, eq=False)
class _Search:
    """A search among series with amplitudes (drives, 2, harmonics) over the limits (drives, 4)."""

    regressor: Regressor
    names: tuple[str, ...]
    limits: Array
    p: Array
    period: float
    harmonics: int

    def run(self, steps: int) -> Excitation:
        """Draw motions, and change the best by normal deviates whose width adapts."""
        generator = np.random.default_rng(0)
        shape = len(self.limits), 2, self.harmonics
        drawn = [generator.standard_normal(shape) for _ in range(_DRAWN)]
        (rank, first), best = min(((self._cost(x), k) for k, x in enumerate(drawn)), key=_first)
        if not math.isfinite(first):
            raise AssemblyError(
                f"mechanism '{self.regressor.program.data.name}' cannot follow any of {_DRAWN}"
                " random motions within the limits; expected narrower limits"
            )
        x, cost, width = drawn[best], (rank, first), 0.5
        for _ in range(steps):
            other = x + width * generator.standard_normal(shape)
            if (found := self._cost(other)) < cost:
                x, cost, width = other, found, width * _GROWS
            else:
                width = max(width * _SHRINKS, 1e-3)
        centres, amplitudes = self._scaled(x)
        base = self._base(centres, amplitudes)
        drives = self.regressor.program.driven
        return Excitation(
            self.period,
            dict(zip(drives, centres.tolist(), strict=True)),
            dict(zip(drives, amplitudes[:, 0], strict=True)),
            dict(zip(drives, amplitudes[:, 1], strict=True)),
            base.condition,
            first,
            base.words(self.names),
        )

    def _cost(self, x: Array) -> tuple[int, float]:
        """Return the number of combinations that a motion leaves unexcited, and its condition."""
        try:
            base = self._base(*self._scaled(x))
        except AssemblyError:
            return len(self.names), math.inf
        return len(self.names) - len(base.chosen), base.condition

    def _scaled(self, x: Array) -> tuple[Array, Array]:
        """Return the centres and amplitudes with which each drive touches one of its limits."""
        x = x / np.arange(1, self.harmonics + 1)
        count = _SAMPLES * self.harmonics
        d, rate, acceleration = self._series(x, np.arange(count) * self.period / count)
        low, high, speed, most = self.limits.T
        scale = np.minimum(
            speed / np.abs(rate).max(axis=0), most / np.abs(acceleration).max(axis=0)
        )
        scale = _MARGIN * np.minimum(scale, (high - low) / np.ptp(d, axis=0))
        middle = (d.max(axis=0) + d.min(axis=0)) / 2.0
        return (low + high) / 2.0 - scale * middle, x * scale[:, None, None]

    def _series(self, x: Array, t: Array) -> tuple[Array, Array, Array]:
        """Return coordinates, rates and accelerations (n, drives) of amplitudes."""
        order = np.arange(1, self.harmonics + 1) * math.tau / self.period
        sine, cosine = np.sin(np.outer(t, order)), np.cos(np.outer(t, order))
        a, b = x[:, 0].T, x[:, 1].T
        rate = (cosine * order) @ a - (sine * order) @ b
        return sine @ a + cosine @ b, rate, -(sine * order**2) @ a - (cosine * order**2) @ b

    def _base(self, centres: Array, amplitudes: Array) -> Base:
        t = np.arange(_INSTANTS) * self.period / _INSTANTS
        d, rate, acceleration = self._series(amplitudes, t)
        motion = DrivenMotion(t, d + centres, rate, acceleration)
        z = self.regressor.follow(motion, self.p)
        slopes = self.regressor.at(motion, z, self.p)[1].reshape(-1, len(self.names))
        slopes = slopes[np.isfinite(slopes).all(axis=1)]
        if len(slopes) < len(self.names):
            raise AssemblyError("the mechanism cannot follow the motion at enough instants")
        numbers = [list(self.regressor.program.data.parameters).index(name) for name in self.names]
        units = [self.regressor.program.data.parameters[name].unit for name in self.names]
        return base_of(slopes, Ranking.of(self.p[numbers], units))


def _first(pair: tuple[tuple[int, float], int]) -> tuple[int, float]:
    return pair[0]
