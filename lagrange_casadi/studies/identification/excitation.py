"""Motions that determine parameters best: Fourier series within the limits of a machine.

Swevers et al., *Optimal robot excitation and identification*, IEEE Trans. Robotics and Automation
13, 1997.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import casadi as ca
import numpy as np

from ...base.arguments import Count, Time, public
from ...base.arrays import Array, Expression
from ...base.brief import Brief
from ...base.ipopt import ipopt
from ...base.symbolic import symbolic
from ...base.units import Number, quantity
from ...base.vocabulary import Backend
from ...engine.instants.evaluation_method import EvaluationMethod
from ...errors import AssemblyError, DeclarationError, check_known, shown
from ...model.motion_laws import Motion, expression
from ...model.scene import Scene
from ..case import Case, scene_of
from .base import Base, base_of, triangle
from .regressor import DrivenMotion, Regressor

_SAMPLES, _HELD = 64, 32
"""Instants for each harmonic at which limits are checked, and held while a motion is improved:
between the former a series exceeds its largest sample by 0.12 %.
"""

_MARGIN = 1.0 - (math.pi / _SAMPLES) ** 2 / 2.0
_INSTANTS = 96
"""Instants at which derivatives are evaluated."""

_DRAWN, _STARTS = 64, 3
"""Motions that are drawn, and how many of the best are improved."""

_OPTIONS = {"tol": 1e-4, "hessian_approximation": "limited-memory"}


@public
@dataclass(frozen=True, eq=False, repr=False)
class Excitation(Brief):
    """A periodic motion of drives, and how well it determines the parameters.

    ``sines`` and ``cosines`` are amplitudes of each harmonic, and ``centres`` the means, by drive
    [rad or m]. ``condition`` is that of the base, in columns of norm 1, and ``first`` that of the
    best of the motions drawn at random from which the search began. ``base`` are the combinations
    that the motion determines. ``error`` is the geometric mean of their standard errors, over that
    of the best motion drawn.
    """

    period: float
    centres: Mapping[str, float]
    sines: Mapping[str, Array]
    cosines: Mapping[str, Array]
    condition: float
    first: float
    base: tuple[str, ...]
    error: float

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
    limits: Mapping[str, Sequence[Number]],
    unknown: Sequence[str] | None = None,
    *,
    quantities: Sequence[str] | None = None,
    period: Time = 10.0,
    harmonics: Count = 4,
    steps: Count = 100,
    parameters: Mapping[str, float] | None = None,
    backend: Backend = "auto",
) -> Excitation:
    """Return a motion within limits that determines unknown parameters well.

    The motion is D-optimal: it makes the determinant of the regressor's square largest, so the
    volume in which the parameters are uncertain least, for noise that is equal in all quantities.
    IPOPT finds it with exact derivatives, from the best of 64 random motions, which are the same in
    every run.

    Parameters
    ----------
    scene
        The scene, or a case.
    limits
        Least and largest coordinate, largest speed and largest acceleration [rad or m, s], by
        drive; texts as ``"50 deg"`` and ``"90 deg/s"`` too.
    unknown
        Names of parameters; by default all that the scene declares.
    quantities
        What is measured, as in :class:`.Measurements`; by default the efforts of all drives.
    period
        Period of the motion [s].
    harmonics
        Number of harmonics of each drive.
    steps
        Number of iterations of IPOPT at most, from each of three motions.
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
    check_known("drive of limits=", limits, drives)
    if lost := [drive for drive in drives if drive not in limits]:
        raise DeclarationError(f"limits=: expected those of drive '{lost[0]}' too")
    p = np.array(list(values.values()))
    kinds = regressor.program.data.kinds.coordinates
    low, high, speed, most = np.array([_limits(one, kinds[one], limits[one]) for one in drives]).T
    ends = np.array([[low, -speed, -most], [high, speed, most]])
    return _Search(regressor, ends, p, float(period), harmonics).run(steps)


def _limits(drive: str, kind: str, given: Sequence[Number]) -> list[float]:
    what, unit = f"limits of '{drive}'", "m" if kind == "slide" else "rad"
    units = unit, unit, f"{unit}/s", f"{unit}/s^2"
    try:
        numbers = [quantity(what, one, of) for one, of in zip(given, units, strict=True)]
        valid = len(numbers) == 4 and numbers[0] < numbers[1] and numbers[2] > 0.0 < numbers[3]
    except (TypeError, ValueError):
        valid = False
    if not valid:
        raise DeclarationError(
            f"{what}: expected the least and the largest coordinate, a speed and an"
            f" acceleration above 0, got {shown(given)}"
        )
    return numbers


class _Judged(NamedTuple):
    """A series of coefficients (1 + 2 harmonics, drives), those of the mean, the sines and the
    cosines; the base that it determines, and the geometric mean of its standard errors for noise 1.
    """

    series: Array
    base: Base
    error: float

    @property
    def order(self) -> tuple[int, float]:
        """Key by which the best motion is the first."""
        return -len(self.base.chosen), self.error


@dataclass(frozen=True, eq=False)
class _Search:
    """A search among series whose coordinates, rates and accelerations are between the least and
    the largest (2, 3, drives).
    """

    regressor: Regressor
    ends: Array
    p: Array
    period: float
    harmonics: int

    def run(self, steps: int) -> Excitation:
        """Draw motions, and improve the best of them."""
        generator, drives = np.random.default_rng(0), self.regressor.program.driven
        shape = len(drives), 2, self.harmonics
        motions = [
            self._judged(self._drawn(generator.standard_normal(shape))) for _ in range(_DRAWN)
        ]
        drawn = sorted(filter(None, motions), key=lambda one: one.order)
        if not drawn:
            raise AssemblyError(
                f"mechanism '{self.regressor.program.data.name}' cannot follow any of {_DRAWN}"
                " random motions within the limits; expected narrower limits"
            )
        improved = [self._judged(series) for series in self._improved(drawn[:_STARTS], steps)]
        best = min([drawn[0], *filter(None, improved)], key=lambda one: one.order)
        sines, cosines = np.split(best.series[1:], 2)
        return Excitation(
            self.period,
            dict(zip(drives, best.series[0].tolist(), strict=True)),
            dict(zip(drives, sines.T, strict=True)),
            dict(zip(drives, cosines.T, strict=True)),
            best.base.condition,
            drawn[0].base.condition,
            best.base.words(self.regressor.unknown),
            best.error / drawn[0].error,
        )

    def _rows(self, count: int) -> Array:
        """Return the rows by which coefficients give coordinates, rates and accelerations at so
        many instants of the period: (3, count, 1 + 2 harmonics).
        """
        order = np.arange(1, self.harmonics + 1) * math.tau / self.period
        angle = np.outer(self._times(count), order)
        sine, cosine, one = np.sin(angle), np.cos(angle), np.ones((count, 1))
        return np.stack(
            [
                np.hstack([one, sine, cosine]),
                np.hstack([0.0 * one, order * cosine, -order * sine]),
                np.hstack([0.0 * one, -(order**2) * sine, -(order**2) * cosine]),
            ]
        )

    def _times(self, count: int) -> Array:
        return np.arange(count) * self.period / count

    def _drawn(self, x: Array) -> Array:
        """Return the series of deviates (drives, 2, harmonics) that reaches limits of drives."""
        x = x / np.arange(1, self.harmonics + 1)
        series = np.vstack([np.zeros((1, len(x))), x[:, 0].T, x[:, 1].T])
        d = self._rows(_SAMPLES * self.harmonics)[0] @ series
        low, high = self.ends[:, 0]
        scale = (high - low) / np.ptp(d, axis=0)
        series *= scale
        series[0] = (low + high) / 2.0 - scale * (d.max(axis=0) + d.min(axis=0)) / 2.0
        return self._within(series)

    def _within(self, series: Array) -> Array:
        """Return a series whose amplitudes are reduced to the limits."""
        away, ends = self._rows(_SAMPLES * self.harmonics) @ series, self.ends.copy()
        away[0] -= series[0]
        ends[:, 0] -= series[0]
        shares = (away / ends[:, :, None]).max(axis=(0, 1, 2))
        series[1:] /= np.maximum(shares / _MARGIN, 1.0)
        return series

    def _followed(self, series: Array) -> tuple[DrivenMotion, Array]:
        """Return the motion of a series at some instants, and the iterated coordinates."""
        motion = DrivenMotion(self._times(_INSTANTS), *(self._rows(_INSTANTS) @ series))
        return motion, self.regressor.follow(motion, self.p)

    def _judged(self, series: Array) -> _Judged | None:
        """Return how well a motion determines parameters; None if it cannot be followed."""
        try:
            values, slopes = self.regressor.at(*self._followed(series), self.p)
        except AssemblyError:
            return None
        slopes = slopes.reshape(-1, len(self.regressor.unknown))
        slopes = slopes[np.isfinite(slopes).all(axis=1)]
        if len(slopes) < len(self.regressor.unknown):
            return None
        whole = float(np.linalg.norm(values[np.isfinite(values)]))
        base = base_of(slopes, self.regressor.ranking(self.p), whole)
        if not base.chosen:
            raise self.regressor.unchanged
        sizes = np.abs(np.diag(triangle(slopes[:, list(base.chosen)])))
        return _Judged(series, base, float(np.exp(-np.log(sizes).mean())))

    @symbolic
    def _improved(self, starts: Sequence[_Judged], steps: int) -> list[Array]:
        """Return the series that IPOPT finds from others. Iterated coordinates are unknowns too, so
        loops need not close on the way.
        """
        t, loop = self._times(_INSTANTS), self.regressor.program.newton
        (least, largest), held = self.ends, self._rows(_HELD * self.harmonics)
        span = largest - least
        size = np.tile(span[0] / 2.0, (1 + 2 * self.harmonics, 1))
        x = ca.MX.sym("x", *size.shape)
        z = ca.MX.sym("z", 0 if loop is None else len(loop.guess), t.size)
        motion = [ca.mtimes(ca.DM(rows), x * size).T for rows in self._rows(t.size)]
        given, p = ca.DM(t).T, ca.repmat(ca.DM(self.p), 1, t.size)
        found = self.regressor.batch.function.map(t.size)(given, *motion, z, p)
        slopes = ca.reshape(found, 1 + len(self.regressor.unknown), -1)
        slopes = slopes[[1 + k for k in starts[0].base.chosen], :]
        square = ca.SX.sym("square", slopes.size1(), slopes.size1())
        roots = ca.log(ca.diag(ca.chol(square)))
        error = ca.Function("error", [square], [-ca.sum1(roots) / slopes.size1()])
        limited = [
            ca.mtimes(ca.DM(rows), x * (size / s)) for rows, s in zip(held, span, strict=True)
        ]
        if loop is not None:
            limited.append(loop.step.map(t.size)(z, given, motion[0], p)[0])
        program = {"x": ca.veccat(x, z), "f": error(ca.mtimes(slopes, slopes.T))}
        program["g"] = ca.veccat(*limited)
        solver = ipopt("excite", program, **_OPTIONS, max_iter=steps)
        bounds = {
            name: np.append(np.repeat(ends / span, held.shape[1]), np.zeros(z.numel()))
            for name, ends in (("lbg", least), ("ubg", largest))
        }
        improved = []
        for start in starts:
            begun = self._followed(start.series)[1].ravel()
            found = solver(x0=np.concatenate([(start.series / size).T.ravel(), begun]), **bounds)
            series = np.asarray(found["x"]).ravel()[: size.size].reshape(size.T.shape).T * size
            improved.append(self._within(series))
        return improved
