"""Least squares for the unknown parameters: weights by noise, Huber's loss, priors, and what is
linear.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..errors import AccuracyError, DeclarationError
from .base import Base, Ranking, base_of, triangle
from .consistency import Consistency
from .measurements import Filter
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

_DETERMINED = 1e-11
"""Least singular value of what is determined, in columns of norm 1."""

_FLOOR, _COARSE = 1e-12, 1e-6
"""Least noise of a quantity, over its root mean square; with consistency, whose steps are those of
an iteration.
"""

_LOOKED, _MOVED, _LINEAR, _SLIGHT = 24, 0.15, 1e-9, 1e-3
"""Instants at which linearity is checked; relative change of a parameter there; largest change of a
derivative that is rounding, over its size, or over this share of the largest of the quantity.
"""


class Rows(NamedTuple):
    """Residuals (r,) of all that is measured, less the model, their derivatives by the unknown
    parameters (r, k), numbers of quantity and instant (r,), and residuals that are not filtered
    (r,).
    """

    residual: Array
    columns: Array
    quantity: npt.NDArray[np.intp]
    instant: npt.NDArray[np.intp]
    raw: Array


@dataclass(frozen=True, eq=False)
class Data:
    """Measured values (n, quantities) along a motion, and the model of them.

    ``defaults`` are values of all parameters, ``numbers`` of which are unknown.
    """

    regressor: Regressor
    motion: DrivenMotion
    measured: Array
    defaults: Array
    numbers: tuple[int, ...]
    low_pass: Filter | None

    def parameters(self, theta: Array) -> Array:
        """Return the values of all parameters."""
        p: Array = self.defaults.copy()
        p[list(self.numbers)] = theta
        return p

    @property
    def theta(self) -> Array:
        """Values of the unknown parameters from which a search begins."""
        return np.asarray(self.defaults[list(self.numbers)])

    def some(self, rows: npt.NDArray[np.intp]) -> Data:
        """Return the data of some of the instants, not filtered."""
        motion, measured = self.motion.some(rows), self.measured[rows]
        return Data(self.regressor, motion, measured, self.defaults, self.numbers, None)

    def rows(self, theta: Array, z: Array) -> Rows:
        """Return what is measured less the model, where both are known."""
        model, slopes = self.regressor.at(self.motion, z, self.parameters(theta))
        parts = []
        for k in range(model.shape[1]):
            raw = self.measured[:, k] - model[:, k]
            known = np.isfinite(raw) & np.isfinite(slopes[:, k]).all(axis=1)
            both = np.column_stack([raw, slopes[:, k]])
            if self.low_pass is not None:
                both = self.low_pass(both, known)
            instants = np.flatnonzero(known)
            quantity = np.full(instants.size, k)
            parts.append((both[known, 0], both[known, 1:], quantity, instants, raw[known]))
        return Rows(*(np.concatenate(each) for each in zip(*parts, strict=True)))

    def filtered(self, rows: Rows) -> Array:
        """Filter the derivatives of rows once more."""
        if self.low_pass is None:
            return rows.columns
        found = np.empty_like(rows.columns)
        for k in range(self.measured.shape[1]):
            some = rows.quantity == k
            whole, known = np.zeros((len(self.measured), found.shape[1])), rows.instant[some]
            whole[known] = rows.columns[some]
            counts = np.isin(np.arange(len(whole)), known)
            found[some] = self.low_pass(whole, counts)[known]
        return found


@dataclass(frozen=True, eq=False)
class Fit:
    """Values of the unknown parameters (k,), and how sure they are.

    ``covariance`` (k, k) is that of the combinations that are determined: of ``base`` by the
    measurements, of ``sure`` by them and prior values. ``noise`` (quantities,) are standard
    deviations, given or estimated; ``weights`` (r,) those of Huber's loss.
    """

    theta: Array
    z: Array
    base: Base
    sure: Base
    covariance: Array
    noise: Array
    weights: Array
    rows: Rows
    rounds: int


def nonlinear(
    data: Data, z: Array, names: Sequence[str], scales: Array
) -> dict[str, tuple[str, ...]]:
    """Return the parameters in which the quantities are not linear while the others are, and by
    what: derivatives by the latter change with the former.

    Of two parameters whose product matters, the one that is declared first is linear. Checked are
    the numbers: each parameter is changed alone, and then all that are linear together.
    """
    generator = np.random.default_rng(0)
    known = np.flatnonzero(np.isfinite(data.motion.acceleration).all(axis=1))
    few = np.sort(generator.permutation(known)[:_LOOKED])
    some, z = data.some(few), z[few]
    theta = data.theta
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


@dataclass(frozen=True, eq=False)
class Loss:
    """Weights of residuals: standard deviations of quantities that are known, Huber's loss, prior
    values (k,) with their standard deviations (k,), infinite where there is none, and consistency.
    """

    noise: Mapping[int, float]
    robust: bool
    prior: Array
    spread: Array
    consistency: Consistency | None

    @property
    def whole(self) -> bool:
        """True if all parameters are solved for, not the base alone."""
        return bool(np.isfinite(self.spread).any()) or self.consistency is not None


def fit(data: Data, z: Array, loss: Loss, ranking: Ranking) -> Fit:
    """Solve by Gauss and Newton's method, with exact derivatives; what is linear takes one step.

    Raises :class:`.DeclarationError` where nothing measured depends on the unknown parameters, and
    :class:`.AccuracyError` where steps do not settle.
    """
    theta = data.theta
    rows = data.rows(theta, z)
    size = np.array([_rms(data.measured[:, k]) for k in range(data.measured.shape[1])])
    size[size == 0.0] = 1.0
    noise, weights = np.array([loss.noise.get(k, s) for k, s in enumerate(size)]), np.ones(1)
    free = loss.consistency is None
    rough, still = (_SETTLED, _STILL) if free else (_ROUGH, _ROUGH**2)
    for count in range(1, _ROUNDS + 1):
        total = float(np.sqrt(np.nansum((data.measured / noise) ** 2)))
        weights = _weights(rows.raw / noise[rows.quantity], robust=loss.robust and count > 1)
        root = np.sqrt(weights) / noise[rows.quantity]
        columns, right = rows.columns * root[:, None], rows.residual * root
        base = base_of(columns, ranking)
        if not base.chosen:
            raise DeclarationError("nothing that is measured depends on the unknown parameters")
        if right.size <= len(base.chosen) and not loss.whole:
            raise DeclarationError(
                f"{right.size} measured values do not determine {theta.size - len(base.absent)}"
                " unknown parameters with a standard error; expected more rows, fewer unknown"
                " parameters, or prior values"
            )
        step = _step(columns, right, base, theta, loss)
        theta, z, rows, step = _taken(data, (theta, z, rows), step, root, loss, total)
        moved = float(np.linalg.norm(columns @ step))
        last, noise = noise, _noise(rows, size, loss, len(base.chosen))
        same = bool(np.allclose(noise, last, rtol=rough, atol=0.0))
        if same and moved <= max(_SURE, still * total):
            break
    else:
        raise AccuracyError(
            f"the unknown parameters do not converge in {_ROUNDS} steps; give better initial"
            " values, or prior values"
        )
    scaled = rows.columns / noise[rows.quantity][:, None]
    weights = _weights(rows.raw / noise[rows.quantity], robust=loss.robust)
    prior = np.diag(1.0 / loss.spread)[np.isfinite(loss.spread)]
    sure = base_of(np.vstack([triangle(scaled), prior]), ranking)
    covariance = _covariance(data, rows, noise, (prior, sure.absent), loss)
    return Fit(theta, z, base, sure, covariance, noise, weights, rows, count)


def _rms(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else 0.0


def _weights(scaled: Array, robust: bool) -> Array:
    """Return Huber's weights of residuals over their standard deviation."""
    if not robust:
        return np.ones(scaled.size)
    return np.minimum(1.0, _HUBER / np.maximum(np.abs(scaled), _HUBER))


def _noise(rows: Rows, size: Array, loss: Loss, count: int) -> Array:
    """Return standard deviations of quantities; those that are not given are of the residuals."""
    floor = _FLOOR if loss.consistency is None else _COARSE
    found, free = size * floor, max(1.0 - count / rows.raw.size, 1.0 / rows.raw.size)
    for k in range(size.size):
        own = rows.raw[rows.quantity == k]
        if own.size:
            spread = _MEDIAN * np.median(np.abs(own)) if loss.robust else _rms(own)
            found[k] = max(found[k], spread / np.sqrt(free))
        found[k] = loss.noise.get(k, found[k])
    return found


def _step(columns: Array, right: Array, base: Base, theta: Array, loss: Loss) -> Array:
    """Return the change of the parameters that makes linear residuals least."""
    step = np.zeros(theta.size)
    if loss.whole:
        columns = columns.copy()
        columns[:, list(base.absent)] = 0.0  # else their rounding counts
        prior = np.isfinite(loss.spread)
        rows = np.diag(1.0 / loss.spread)[prior]
        columns = np.vstack([columns, rows])
        right = np.concatenate([right, ((loss.prior - theta) / loss.spread)[prior]])
        if loss.consistency is not None:
            whole = triangle(np.column_stack([columns, right]))
            return loss.consistency.step(whole[:, :-1], whole[:, -1], theta)
        scale = np.linalg.norm(columns, axis=0)
        scale[scale == 0.0] = 1.0
        return np.asarray(np.linalg.lstsq(columns / scale, right, rcond=1e-13)[0] / scale)
    chosen = list(base.chosen)
    scale = np.linalg.norm(columns[:, chosen], axis=0)
    step[chosen] = np.linalg.lstsq(columns[:, chosen] / scale, right, rcond=None)[0] / scale
    return step


def _taken(
    data: Data,
    place: tuple[Array, Array, Rows],
    step: Array,
    root: Array,
    loss: Loss,
    total: float,
) -> tuple[Array, Array, Rows, Array]:
    """Take a step, or a half of it as often as it makes residuals larger, beside a ``total``."""
    (theta, z, rows), known = place, np.isfinite(loss.spread)

    def cost(rows: Rows, at: Array) -> float:
        away = ((at - loss.prior) / loss.spread)[known]
        return float(np.sqrt(np.sum((rows.residual * root) ** 2) + away @ away))

    most = cost(rows, theta) * (1.0 + _SETTLED) + _STILL * total
    for _ in range(_HALVINGS):
        there = data.regressor.follow(data.motion, data.parameters(theta + step), z)
        rows = data.rows(theta + step, there)
        held = loss.consistency is not None
        if rows.residual.size == root.size and (held or cost(rows, theta + step) <= most):
            return theta + step, there, rows, step
        step = step / 2.0
    raise AccuracyError(
        "no step of the unknown parameters was found that reduces the difference to the"
        " measurements and for which the mechanism has forces; give better initial values, or prior"
        " values"
    )


def _covariance(
    data: Data, rows: Rows, noise: Array, beside: tuple[Array, tuple[int, ...]], loss: Loss
) -> Array:
    """Return the covariance of the parameters, as far as they are determined.

    Filtered noise is not independent: its covariance goes with the filter applied once more.
    """
    (prior, absent), by_noise = beside, 1.0 / noise[rows.quantity][:, None]
    whole = np.vstack([triangle(rows.columns * by_noise), prior])
    whole[:, list(absent)] = 0.0  # else their rounding counts
    scale = np.linalg.norm(whole, axis=0)
    scale[scale == 0.0] = 1.0
    inner = np.linalg.pinv(triangle(whole / scale), rcond=_DETERMINED) / scale[:, None]
    found = inner @ inner.T
    if data.low_pass is not None:
        again = np.vstack([triangle(data.filtered(rows) * by_noise), prior])
        found = found @ (again.T @ again) @ found
    if loss.robust:
        u = rows.raw * by_noise[:, 0]
        psi = np.clip(u, -_HUBER, _HUBER)
        found = found * float(np.mean(psi**2) / np.mean(np.abs(u) < _HUBER) ** 2)
    return np.asarray(found)
