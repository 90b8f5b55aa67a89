"""Least squares for the unknown parameters: weights by noise, Huber's loss, prior values, and which
parameters are linear.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.brief import Brief
from ...base.units import differs
from ...errors import AccuracyError, DeclarationError, check_known
from .base import Base, Ranking, base_of, triangle
from .consistency import Consistency
from .measurements import Measurements, filtered
from .regressor import DrivenMotion, Regressor

_HUBER = 1.345
"""Residual over its standard deviation from which it counts linearly: 95 % efficient for normal
noise (Huber, *Robust Statistics*, 1981).
"""
_MEDIAN = 1.4826
_ROUNDS, _HALVINGS = 100, 30
_STILL, _SETTLED, _ROUGH = 1e-12, 1e-6, 1e-2
"""Relative change of the model, and of noise and residuals, that is none; and of noise where steps
are those of an iteration themselves.
"""

_SURE = 1e-5
"""Change of all the model, over its noise, that is none."""

_FLOOR, _COARSE = 1e-12, 1e-6
"""Least noise of a quantity, over its root mean square; with consistency, whose steps are those of
an iteration.
"""

_LOOKED, _MOVED, _LINEAR, _SLIGHT = 24, 0.15, 1e-9, 1e-3
"""Instants at which linearity is checked; relative change of a parameter there; largest change of a
derivative that is rounding, over its size, or over this share of the largest of the quantity.
"""


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Brief):
    """Measured quantities beside the model of them, each (t,); NaN where one is missing."""

    t: Array
    measured: Mapping[str, Array]
    model: Mapping[str, Array]
    units: Mapping[str, str]

    @property
    def residual(self) -> dict[str, float]:
        """Root mean square of measured less model, by quantity."""
        return {name: _rms(self.measured[name] - self.model[name]) for name in self.measured}

    @property
    def relative(self) -> dict[str, float]:
        """Residuals over the root mean square of what is measured."""
        found = {}
        for name, residual in self.residual.items():
            both = np.where(np.isfinite(self.model[name]), self.measured[name], np.nan)
            size = _rms(both)
            found[name] = residual / size if size else math.nan
        return found


class Rows(NamedTuple):
    """Residuals (r,) of all that is measured, less the model, their derivatives by the unknown
    parameters (r, k), numbers of quantity and instant (r,), and residuals that are not filtered
    (r,).

    The last rows are those of prior values, each with a number of its own after the quantities.
    """

    residual: Array
    columns: Array
    quantity: npt.NDArray[np.intp]
    instant: npt.NDArray[np.intp]
    raw: Array


@dataclass(frozen=True, eq=False)
class Data:
    """Measured values (n, quantities) along a motion, and the model of them.

    ``defaults`` are values of all parameters. ``noise`` are standard deviations of the quantities,
    NaN if they are to be estimated, and ``prior`` those of first values, by the place of a
    parameter among the unknown ones. At ``cutoff`` [Hz] a filter halves the power, if there is one.
    """

    regressor: Regressor
    motion: DrivenMotion
    measured: Array
    defaults: Array
    noise: tuple[float, ...]
    prior: Mapping[int, float]
    cutoff: float | None

    @classmethod
    def of(
        cls,
        regressor: Regressor,
        measurements: Measurements,
        trim: float,
        defaults: Array,
        prior: Mapping[str, float] | None = None,
        cutoff: float | None = None,
    ) -> Data:
        """Take the motion and the quantities of measurements, whose units are checked."""
        for name, unit in regressor.expected.items():
            if wrong := differs(measurements.units.get(name, unit), unit):
                raise DeclarationError(f"{measurements.name}: column '{name}' is in {wrong}")
        columns, names = measurements.columns, regressor.quantities
        check_known("column", names, columns, place=measurements.name)
        return cls(
            regressor,
            measurements.motion(regressor.program.driven, trim),
            np.stack([columns[name] for name in names], axis=1),
            defaults,
            tuple(measurements.noise.get(name, math.nan) for name in names),
            {regressor.unknown.index(name): spread for name, spread in (prior or {}).items()},
            cutoff,
        )

    @cached_property
    def ranking(self) -> Ranking:
        """Ranking of the unknown parameters, with the sizes of their first values."""
        return self.regressor.ranking(self.defaults)

    def parameters(self, theta: Array) -> Array:
        """Return the values of all parameters."""
        p: Array = self.defaults.copy()
        p[self.regressor.numbers] = theta
        return p

    @property
    def theta(self) -> Array:
        """Values of the unknown parameters from which a search begins."""
        return np.asarray(self.defaults[self.regressor.numbers])

    def compared(self, theta: Array, z: Array) -> Comparison:
        """Return what is measured beside the model."""
        model = self.regressor.at(self.motion, z, self.parameters(theta))[0]
        each = self.measured.T, model.T, self.regressor.units
        names = self.regressor.quantities
        return Comparison(self.motion.t, *(dict(zip(names, x, strict=True)) for x in each))

    def rows(self, theta: Array, z: Array) -> Rows:
        """Return what is measured less the model, if both are known, and prior values less those
        of the parameters.
        """
        model, slopes = self.regressor.at(self.motion, z, self.parameters(theta))
        raw = self.measured - model
        known = np.isfinite(raw) & np.isfinite(slopes).all(axis=2)
        both = np.concatenate([raw[..., None], slopes], axis=2)
        if self.cutoff is not None:
            both = filtered(self.motion.t, self.cutoff, both, known)
        quantity, instant = np.nonzero(known.T)
        prior, numbers = list(self.prior), np.arange(len(self.prior))
        away = (self.theta - theta)[prior]
        return Rows(
            np.concatenate([both[instant, quantity, 0], away]),
            np.concatenate([both[instant, quantity, 1:], np.eye(theta.size)[prior]]),
            np.concatenate([quantity, model.shape[1] + numbers]),
            np.concatenate([instant, 0 * numbers]),
            np.concatenate([raw[instant, quantity], away]),
        )

    def filtered(self, rows: Rows) -> Array:
        """Filter the derivatives of rows once more."""
        if self.cutoff is None:
            return rows.columns
        found: Array = rows.columns.copy()
        some = rows.quantity < self.measured.shape[1]
        known = np.zeros(self.measured.shape, bool)
        whole: Array = np.zeros((*known.shape, found.shape[1]))
        at = rows.instant[some], rows.quantity[some]
        known[at], whole[at] = True, found[some]
        found[some] = filtered(self.motion.t, self.cutoff, whole, known)[at]
        return found


def nonlinear(data: Data, z: Array) -> dict[str, tuple[str, ...]]:
    """Return the parameters in which the quantities are not linear while the others are, and by
    what: derivatives by the latter change with the former.

    Of two parameters whose product matters, the one that is declared first is linear. Checked are
    the numbers: each parameter is changed alone, and then all that are linear together.
    """
    generator = np.random.default_rng(0)
    known = np.flatnonzero(np.isfinite(data.motion.acceleration).all(axis=1))
    few = np.sort(generator.permutation(known)[:_LOOKED])
    motion, z = DrivenMotion(*(part[few] for part in data.motion)), z[few]
    some = replace(data, motion=motion, measured=data.measured[few], cutoff=None)
    theta, names, scales = data.theta, data.regressor.unknown, data.ranking.scales
    before = _slopes(some, theta, z)
    changes = np.zeros((theta.size, theta.size), bool)
    moved = theta + _MOVED * np.where(theta == 0.0, 1.0, theta)
    for k in range(theta.size):
        other = theta.copy()
        other[k] = moved[k]
        changes[k] = _differ(before, _slopes(some, other, z), scales)
    changes |= changes.T
    left = [k for k in range(theta.size) if not changes[k, k]]
    while left and (pairs := changes[np.ix_(left, left)].sum(axis=0)).any():
        left.pop(len(left) - 1 - int(np.argmax(pairs[::-1])))
    together = theta.copy()
    together[left] += (moved - theta)[left] * generator.uniform(0.2, 1.0, len(left))
    if _differ(before, _slopes(some, together, z), scales)[left].any():
        left = []
    return {
        name: tuple(names[j] for j in np.flatnonzero(changes[k]).tolist()) or (name,)
        for k, name in enumerate(names)
        if k not in left
    }


def _slopes(data: Data, theta: Array, z: Array) -> Array:
    p = data.parameters(theta)
    z = data.regressor.follow(data.motion, p, z)
    return data.regressor.at(data.motion, z, p)[1]


def _differ(before: Array, after: Array, scales: Array) -> npt.NDArray[np.bool_]:
    """Return by which parameters (k,), of usual sizes ``scales``, derivatives (n, quantities, k)
    have changed.
    """
    known = np.isfinite(before)
    change = np.where(known, np.abs(np.where(np.isfinite(after), after, np.inf) - before), 0.0)
    size = np.where(known, np.maximum(np.abs(before), np.abs(after)), 0.0).max(axis=0)
    size, change = size * scales, change.max(axis=0) * scales
    size = np.maximum(size, _SLIGHT * np.nan_to_num(size).max(axis=1, keepdims=True))
    return np.asarray((change > _LINEAR * np.nan_to_num(size)).any(axis=0))


class System(NamedTuple):
    """Derivatives and residuals over their noise, as few rows: ``base`` is what measurements
    determine, ``sure`` what they and prior values determine.
    """

    columns: Array
    right: Array
    base: Base
    sure: Base

    @classmethod
    def of(cls, rows: Rows, root: Array, quantities: int, ranking: Ranking, total: float) -> System:
        """Reduce rows, each times its ``root`` (r,), of measurements whose norm is ``total``."""
        both = np.column_stack([rows.columns, rows.residual]) * root[:, None]
        measured = rows.quantity < quantities
        part = triangle(both[measured])
        base = sure = base_of(part[:, :-1], ranking, total)
        part[:, list(base.absent)] = 0.0  # else their rounding counts
        whole = np.vstack([part, both[~measured]])
        if not measured.all():
            sure = base_of(whole[:, :-1], ranking, total)
        return cls(whole[:, :-1], whole[:, -1], base, sure)

    @property
    def inverse(self) -> Array:
        """Pseudo-inverse of the columns that stand for combinations."""
        columns = self.columns[:, list(self.sure.chosen)]
        scale = np.linalg.norm(columns, axis=0)
        return np.asarray(np.linalg.pinv(columns / scale) / scale[:, None])


@dataclass(frozen=True, eq=False)
class Fit:
    """Values of the unknown parameters (k,), and how sure they are.

    ``covariance`` (k, k) is that of the parameters that stand for the combinations of
    ``system.sure``. ``noise`` (quantities,) are standard deviations, given or estimated;
    ``weights`` (r,) those of Huber's loss.
    """

    theta: Array
    z: Array
    system: System
    covariance: Array
    noise: Array
    weights: Array
    rows: Rows
    rounds: int

    @property
    def errors(self) -> Array:
        """Standard errors of the unknown parameters, infinite for those in combinations only."""
        sure, found = self.system.sure, np.full(self.theta.size, np.inf)
        alone = [k for k, row in zip(sure.chosen, sure.weights, strict=True) if not row.any()]
        found[alone] = np.sqrt(np.diag(self.covariance))[alone]
        return found


def fit(data: Data, z: Array, robust: bool, consistency: Consistency | None) -> Fit:
    """Solve by Gauss and Newton's method, with exact derivatives; what is linear takes one step.

    Raises :class:`.DeclarationError` if nothing measured depends on the unknown parameters, and
    :class:`.AccuracyError` if steps do not settle.
    """
    given, ranking = np.array([*data.noise, *data.prior.values()]), data.ranking
    theta, rows, quantities = data.theta, data.rows(data.theta, z), data.measured.shape[1]
    size = np.array([*map(_rms, data.measured.T), *(1.0 for _ in data.prior)])
    size[~(size > 0.0)] = 1.0
    noise, weights = np.where(np.isnan(given), size, given), np.ones(rows.raw.size)
    free = consistency is None
    rough, still, floor = (_SETTLED, _STILL, _FLOOR) if free else (_ROUGH, _ROUGH**2, _COARSE)
    for rounds in range(1, _ROUNDS + 1):
        total = float(np.sqrt(np.nansum((data.measured / noise[:quantities]) ** 2)))
        root = np.sqrt(weights) / noise[rows.quantity]
        system = System.of(rows, root, quantities, ranking, total)
        if not system.base.chosen:
            raise data.regressor.unchanged
        if rows.raw.size <= len(system.sure.chosen) and free:
            raise DeclarationError(
                f"{rows.raw.size - len(data.prior)} measured values do not determine"
                f" {theta.size - len(system.base.absent)} unknown parameters with a standard error;"
                " expected more rows, fewer unknown parameters, or prior values"
            )
        if consistency is None:
            step = np.zeros(theta.size)
            step[list(system.sure.chosen)] = system.inverse @ system.right
        else:
            step = consistency.step(system.columns, system.right, theta)
        most = np.linalg.norm(rows.residual * root) * (1.0 + _SETTLED) + _STILL * total
        step, z, rows = _taken(data, theta, z, step, root, most if free else math.inf)
        theta = theta + step
        moved = float(np.linalg.norm(system.columns @ step))
        freedom = rows.raw.size - len(data.prior) - len(system.base.chosen)
        last, noise = noise, _noise(rows, given, floor * size, robust, freedom)
        if robust:
            scaled = np.abs(rows.raw / noise[rows.quantity])
            weights = np.minimum(1.0, _HUBER / np.maximum(scaled, _HUBER))
        same = bool(np.allclose(noise, last, rtol=rough, atol=0.0))
        if same and moved <= max(_SURE, still * total):
            root = 1.0 / noise[rows.quantity]
            system = System.of(rows, root, quantities, ranking, total)
            covariance = _covariance(data, rows, noise, system, robust)
            return Fit(theta, z, system, covariance, noise[:quantities], weights, rows, rounds)
    raise AccuracyError(
        f"the unknown parameters do not converge in {_ROUNDS} steps; give better initial values, or"
        " prior values"
    )


def _rms(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else math.nan


def _noise(rows: Rows, given: Array, least: Array, robust: bool, freedom: int) -> Array:
    """Return standard deviations: those that are ``given``, else those of the residuals."""
    found: Array = given.copy()
    share = max(freedom, 1) / rows.raw.size
    for k in np.flatnonzero(np.isnan(given)):
        own = rows.raw[rows.quantity == k]
        spread = _MEDIAN * np.median(np.abs(own)) if robust and own.size else _rms(own)
        found[k] = max(least[k], spread / np.sqrt(share))
    return found


def _taken(
    data: Data, theta: Array, z: Array, step: Array, root: Array, most: float
) -> tuple[Array, Array, Rows]:
    """Return a step, or a half of it as often as that makes the norm of the residuals, each times
    its ``root``, larger than the ``most``; and the iterated coordinates and rows there.
    """
    for _ in range(_HALVINGS):
        there = data.regressor.follow(data.motion, data.parameters(theta + step), z)
        rows = data.rows(theta + step, there)
        if rows.residual.size == root.size and np.linalg.norm(rows.residual * root) <= most:
            return step, there, rows
        step = step / 2.0
    raise AccuracyError(
        "no step of the unknown parameters was found that reduces the difference to the"
        " measurements and for which the mechanism has forces; give better initial values, or prior"
        " values"
    )


def _covariance(data: Data, rows: Rows, noise: Array, system: System, robust: bool) -> Array:
    """Return the covariance of the parameters, as far as they stand for combinations.

    Filtered noise is not independent: its covariance goes with the filter applied once more.
    """
    chosen, root = list(system.sure.chosen), 1.0 / noise[rows.quantity]
    part = system.inverse @ system.inverse.T
    if data.cutoff is not None:
        again = triangle(data.filtered(rows)[:, chosen] * root[:, None])
        part = part @ (again.T @ again) @ part
    if robust:
        u = rows.raw * root
        psi = np.clip(u, -_HUBER, _HUBER)
        part = part * float(np.mean(psi**2) / np.mean(np.abs(u) < _HUBER) ** 2)
    found: Array = np.zeros((data.theta.size, data.theta.size))
    found[np.ix_(chosen, chosen)] = part
    return found
