"""Parameters of a mechanism from measured motion and forces: :func:`identify`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arguments import Duration, Frequency, Positive, public
from ...base.arrays import Array
from ...base.brief import Brief
from ...base.vocabulary import Backend
from ...engine.instants.evaluation_method import EvaluationMethod
from ...errors import DeclarationError, check_known
from ...model.scene import Scene
from ..case import Case, scene_of
from .base import RANK, base_of
from .consistency import Consistency
from .fit import Comparison, Data, Fit, fit, nonlinear
from .measurements import Measurements
from .regressor import DrivenMotion, Regressor

_OPPOSITE = -0.7
"""Correlation of a force with the model from which its sign may be wrong."""

_ROUNDED = 1e-6
"""Largest share of a column that is rounding, after those of a base are subtracted from it."""


@dataclass(frozen=True)
class BaseParameter:
    """A combination of parameters that the measurements determine, in words, with its value, its
    standard error, and their ratio ``t``.

    ``name`` is the parameter that stands for it, in whose unit it is.
    """

    name: str
    words: str
    unit: str
    value: float
    error: float

    @property
    def t(self) -> float:
        """The value over its standard error."""
        return abs(self.value) / self.error if self.error > 0.0 else math.inf


@public
@dataclass(frozen=True, eq=False, repr=False)
class Identification(Brief):
    """Parameters that were found, and their standard errors.

    ``name`` is that of the mechanism. ``values`` and ``errors`` are those of the unknown
    parameters; the standard error is infinite for one that is determined only in a combination.

    ``base`` are the combinations that are determined, and ``condition`` is the condition number of
    their columns, scaled to norm 1. ``unexcited`` are combinations that only other speeds and
    accelerations at the same places would determine; ``absent`` are parameters on which no measured
    quantity depends. ``nonlinear`` are the parameters that forces are not linear in if the others
    are unknown too, each with those other parameters; their base is that at the values found.

    ``noise`` are standard deviations, given or estimated, ``outliers`` the shares of instants whose
    weight Huber's loss lowered, and ``cutoffs`` the frequencies [Hz] at which the smoothing of each
    drive's coordinate halves the power.
    ``covariance`` is that of the base parameters.

    ``initial`` are the values from which the search began, ``prior`` their standard deviations, of
    those that have one. ``impossible`` are bodies whose mass is not positive, or whose inertia no
    body can have. ``unused`` are columns of the record that are neither the motion of a drive nor a
    force. ``opposite`` are the correlations of forces with those of the initial values, if they are
    below -0.7: such a force may have been measured with another sign.
    """

    name: str
    measurements: str
    values: Mapping[str, float]
    errors: Mapping[str, float]
    units: Mapping[str, str]
    base: tuple[BaseParameter, ...]
    unexcited: tuple[str, ...]
    absent: tuple[str, ...]
    nonlinear: Mapping[str, tuple[str, ...]]
    condition: float
    noise: Mapping[str, float]
    outliers: Mapping[str, float]
    cutoffs: Mapping[str, float]
    cutoff: float | None
    rounds: int
    comparison: Comparison
    covariance: Array
    regressor: Regressor
    parameters: Mapping[str, float]
    initial: Mapping[str, float]
    prior: Mapping[str, float]
    impossible: tuple[str, ...]
    unused: tuple[str, ...]
    opposite: Mapping[str, float]

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on what the values depend on, and what was not determined."""
        found = [
            f"forces are not linear in {name}, with {', '.join(others)}: found by iteration"
            for name, others in self.nonlinear.items()
        ]
        if self.unused:
            found.append(f"columns that are not used: {', '.join(self.unused)}")
        named = {word for words in self.unexcited for word in words.split()}
        if absent := [name for name in self.absent if name not in named]:
            found.append(f"nothing measured depends on {', '.join(absent)}")
        for name, correlation in self.opposite.items():
            found.append(
                f"{name} is opposite to the model with the initial values, by a correlation of"
                f" {correlation:.2g}: check its sign"
            )
        for words in self.unexcited:
            found.append(
                f"this motion does not determine {words}; other speeds and accelerations do"
            )
        for drive, cutoff in self.cutoffs.items():
            if cutoff == 0.0:
                found.append(f"{drive} is a straight line within its noise")
            elif cutoff < math.inf:
                found.append(f"{drive} is smoothed, half the power at {cutoff:.3g} Hz")
        if self.cutoff is not None:
            found.append(
                f"forces are filtered without delay, half the power at {self.cutoff:.3g} Hz"
            )
        if self.impossible:
            found.append(
                f"no body has the mass and inertia found for {', '.join(self.impossible)};"
                " consistent=True finds some that a body can have"
            )
        return tuple(found)

    @property
    def setting(self) -> str:
        """The values with all digits, as ``m=1.2 k=300``."""
        return " ".join(f"{name}={value:.17g}" for name, value in self.values.items())

    def validate(self, measurements: Measurements, trim: Duration = 0.0) -> Comparison:
        """Compare another record with the model.

        Parameters
        ----------
        measurements
            The other record, with the same columns.
        trim
            Time at both ends that does not count [s].

        Returns
        -------
        Comparison
            Measured and model over time.

        Raises
        ------
        UnknownNameError
            If a column is missing.
        AssemblyError
            If the mechanism cannot follow the measured motion.
        """
        p = np.array(list((dict(self.parameters) | dict(self.values)).values()))
        data = Data.of(self.regressor, measurements, trim, p)
        return data.compared(data.theta, self.regressor.follow(data.motion, p))


@public
def identify(
    scene: Scene | Case,
    measurements: Measurements,
    unknown: Sequence[str] | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    prior: Mapping[str, Positive] | None = None,
    robust: bool = False,
    consistent: bool = False,
    cutoff: Frequency | None = None,
    trim: Duration = 0.0,
    backend: Backend = "auto",
) -> Identification:
    """Return the parameters of a mechanism that measured motion and forces determine.

    Parameters
    ----------
    scene
        The scene, or a case. Its laws of motion are used only to assemble the loops.
    measurements
        Coordinates of all driven joints, and forces or strains, over time.
    unknown
        Find these parameters; default: all of the scene.
    parameters
        Set a known parameter, or the first value of an unknown one, as l=0.25.
    prior
        Set the standard deviation of the first value of a parameter.

        It may come from CAD, and has the weight of one more measurement.
    robust
        Reduce the weight of outliers, by Huber's loss.
    consistent
        Find positive masses, inertias that a body can have, and parameters in their bounds.
    cutoff
        Filter forces without delay; half the power is left at this frequency [Hz].

        Measured and modelled forces alike; default: nothing is filtered.
    trim
        Leave out this time at both ends of the record [s].

        Smoothed accelerations are inaccurate there.
    backend
        As in :func:`.evaluate`.

    Returns
    -------
    Identification
        Values, base parameters, standard errors, and measurements beside the model.

    Raises
    ------
    UnknownNameError
        For parameters or columns that there are not.
    DeclarationError
        If nothing that is measured depends on the unknown parameters, for a column in a unit of
        another quantity, if there are not more measured values than combinations to determine, and
        with ``consistent`` for initial values that no body can have.
    AssemblyError
        If the mechanism cannot follow the measured motion.
    AccuracyError
        If what is nonlinear does not settle.
    """
    scene = scene_of(scene)
    names = tuple(scene.parameters) if unknown is None else tuple(dict.fromkeys(unknown))
    check_known("parameter of prior=", prior or {}, names)
    if wrong := [name for name, spread in (prior or {}).items() if not 0.0 < spread < math.inf]:
        raise DeclarationError(f"prior of '{wrong[0]}': expected a finite number above 0")
    drives = tuple(scene.laws)
    quantities = measurements.quantities(drives)
    if not quantities:
        raise DeclarationError(
            f"{measurements.name}: expected a column of a force, as effort:{drives[0]}; got"
            f" {', '.join(measurements.columns)}"
        )
    values = scene.values(parameters)
    regressor = Regressor.of(scene, quantities, names, EvaluationMethod(backend))
    p = np.array(list(values.values()))
    data = Data.of(regressor, measurements, trim, p, prior, cutoff)
    if 0.0 in data.noise:
        raise DeclarationError(
            f"{measurements.name}: noise of '{quantities[data.noise.index(0.0)]}': expected a"
            " number above 0"
        )
    z, consistency = regressor.follow(data.motion, p), Consistency.of(regressor, p)
    before, curved = data.compared(data.theta, z), nonlinear(data, z)
    found = fit(data, z, robust, consistency if consistent else None)
    base, units = found.system.base, {name: scene.parameters[name].unit for name in names}
    rows = base.rows(len(names))
    covariance = rows @ found.covariance @ rows.T
    combined = (rows @ found.theta).tolist(), np.sqrt(np.diag(covariance)).tolist()
    lowered = [found.weights[found.rows.quantity == k] < 1.0 for k in range(len(quantities))]
    return Identification(
        name=regressor.program.data.name,
        measurements=measurements.name,
        values=dict(zip(names, found.theta.tolist(), strict=True)),
        errors=dict(zip(names, found.errors.tolist(), strict=True)),
        units=units,
        base=tuple(
            BaseParameter(names[k], words, units[names[k]], value, error)
            for k, words, value, error in zip(
                base.chosen, base.words(names), *combined, strict=True
            )
        ),
        unexcited=_unexcited(data, found),
        absent=tuple(names[k] for k in base.absent),
        nonlinear=curved,
        condition=base.condition,
        noise=dict(zip(quantities, found.noise.tolist(), strict=True)),
        outliers={n: float(x.mean()) for n, x in zip(quantities, lowered, strict=True) if x.size},
        cutoffs={drive: measurements.cutoff(drive) for drive in regressor.program.driven},
        cutoff=cutoff,
        rounds=found.rounds,
        comparison=data.compared(found.theta, found.z),
        covariance=covariance,
        regressor=regressor,
        parameters=regressor.program.data.values(data.parameters(found.theta)),
        initial=dict(zip(names, data.theta.tolist(), strict=True)),
        prior=dict(prior or {}),
        impossible=consistency.impossible(found.theta),
        unused=tuple(n for n in measurements.columns if n not in regressor.expected),
        opposite=_opposite(before),
    )


def _opposite(compared: Comparison) -> dict[str, float]:
    """Return the correlations of quantities with the model that are far below zero."""
    found = {}
    for name, measured in compared.measured.items():
        both = np.stack([measured, compared.model[name]])
        x, y = both[:, np.isfinite(both).all(axis=0)]
        size = float(np.linalg.norm(x) * np.linalg.norm(y))
        if size > 0.0 and (correlation := float(x @ y) / size) < _OPPOSITE:
            found[name] = correlation
    return found


def _unexcited(data: Data, found: Fit) -> tuple[str, ...]:
    """Return combinations that other rates and accelerations would determine beside the base."""
    generator, motion, names = np.random.default_rng(0), data.motion, data.regressor.unknown
    known = np.flatnonzero(np.isfinite(motion.acceleration).all(axis=1))
    sizes = [
        np.sqrt(np.mean(part[known] ** 2)) + 1.0 for part in (motion.rate, motion.acceleration)
    ]
    rate, acceleration = (size * generator.standard_normal(motion.d.shape) for size in sizes)
    other = DrivenMotion(motion.t, motion.d, rate, acceleration)
    slopes = data.regressor.at(other, found.z, data.parameters(found.theta))[1]
    rows = (slopes / found.noise[:, None]).reshape(-1, len(names))
    rows = rows[np.isfinite(rows).all(axis=1)]
    base, more, sizes = found.system.base, rows.copy(), np.linalg.norm(rows, axis=0)
    chosen, dependent = list(base.chosen), list(base.dependent)
    more[:, chosen] = 0.0
    more[:, dependent] -= rows[:, chosen] @ base.weights
    sizes[dependent] += sizes[chosen] @ np.abs(base.weights)
    scales = data.ranking.scales
    least = RANK * (sizes * scales).max() / scales
    more[:, np.linalg.norm(more, axis=0) <= np.maximum(_ROUNDED * sizes, least)] = 0.0
    return base_of(more, data.ranking).words(names)
