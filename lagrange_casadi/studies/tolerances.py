"""Effect of parameters' tolerances on peaks: to first order by exact derivatives, and by designs
drawn at random.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ..base.arguments import Outputs, public
from ..base.arrays import Array
from ..base.brief import Brief
from ..base.numerals import real
from ..base.status import Status
from ..base.units import Within, number, typed
from ..base.vocabulary import SAMPLES, Compiled
from ..errors import DeclarationError, check_known
from ..model.declared_parts import Parameter
from ..model.scene import Scene
from ..model.times import Over, Times
from .designs.prepared import prepare

_LARGEST = 1_000_000


@dataclass(frozen=True, eq=False, repr=False)
class Spread(Brief):
    """Spread of the peak of a quantity.

    ``nominal`` is the peak without tolerances, with its sign. To first order ``worst`` is how far
    it may be off, if every parameter is at the worse end of its tolerance, and ``sigma`` its
    standard deviation; ``shares`` are by parameter what of the variance is due to it, the largest
    first. Both are NaN where the peak has no derivative. ``mean``, ``deviation``, ``low`` and
    ``high`` are those of the designs that were drawn: mean, standard deviation, least and largest.
    """

    quantity: str
    unit: str
    nominal: float
    worst: float
    sigma: float
    shares: Mapping[str, float]
    mean: float
    deviation: float
    low: float
    high: float


@dataclass(frozen=True, eq=False, repr=False)
class Spreads(Brief):
    """Effect of tolerances [units of the parameters] on a scene's peaks, by full name, the one with
    the largest relative spread first.

    ``drawn`` designs were evaluated, of which ``failed`` have no result.
    """

    case: str
    tolerances: Mapping[str, float]
    drawn: int
    failed: int
    peaks: Mapping[str, Spread]


def read_tolerance(
    parameters: Mapping[str, Parameter], name: str, value: float | str, nominal: float
) -> float:
    """A tolerance in the parameter's unit: a number, or a text such as ``0.1mm``, ``0.5deg``,
    ``2g`` or ``1%``.

    Raises :class:`UnknownNameError` for what is no parameter, :class:`DeclarationError` for what is
    no tolerance of it.
    """
    check_known("parameter", [name], parameters)
    unit, text = parameters[name].unit, value.strip() if isinstance(value, str) else ""
    try:
        if text.endswith("%"):
            found = real(text[:-1]) / 100.0 * abs(nominal)
        elif text and not typed(text)[1]:
            found = real(text)
        else:
            found = number(value, unit)
        if not 0.0 < found < np.inf:
            raise ValueError
    except ValueError:
        raise DeclarationError(
            f"tolerance of '{name}': expected a number above 0 in {unit or '1'}, or a text such as"
            f" '0.1mm', '0.5deg', '2g' or '1%', got {value!r}"
        ) from None
    return found


@public
def tolerances(
    scene: Scene,
    within: Mapping[str, float | str],
    *,
    parameters: Mapping[str, float] | None = None,
    wanted: Outputs | None = None,
    t: Times | None = None,
    over: Over | None = None,
    samples: Annotated[int, Within(2, _LARGEST)] = SAMPLES,
    backend: Compiled = "auto",
) -> Spreads:
    """Return the spread of peaks if parameters vary within tolerances.

    It is computed to first order by exact derivatives, and by samples, the same ones in every run.
    A standard deviation is that of uniform distributions: a tolerance over the root of 3.

    Parameters
    ----------
    scene
        The scene.
    within
        Set the tolerance of a parameter, plus or minus this value [SI unit, unit or %].

        Tolerances by parameter, as ``{"l": "0.1mm"}``.
    parameters, wanted, t, over
        As of :func:`.studies.evaluate.evaluate`.
    backend
        As of :func:`.studies.sweep.sweeping.sweep`.
    samples
        Draw this number of designs at random.

        Parameters are drawn uniformly and independently.

    Returns
    -------
    Spreads
        Spread of each peak, and the share of each parameter.

    Raises
    ------
    DeclarationError
        For an invalid tolerance.
    LagrangeCasadiError
        As :func:`.evaluate`.
    """
    if not isinstance(within, Mapping) or not within:
        raise DeclarationError(
            f"tolerances: expected tolerances by parameter, as {{'l': '0.1mm'}}, got {within!r}"
        )
    values = scene.values(parameters)
    sizes = {
        name: read_tolerance(scene.parameters, name, value, values.get(name, 0.0))
        for name, value in within.items()
    }
    for name, size in sizes.items():
        for end in (values[name] - size, values[name] + size):
            scene.parameters[name].check(end)
    f = prepare(scene, wanted=wanted, t=t, over=over, backend=backend)
    gradient = f.gradient(values)
    places = [f.parameters.index(name) for name in sizes]
    reach = np.array(list(sizes.values()))
    p = np.tile(np.array(list(values.values())), (samples, 1))
    p[:, places] += reach * np.random.default_rng(0).uniform(-1.0, 1.0, (samples, reach.size))
    drawn = f.designs(p)
    ok = drawn.status == Status.OK
    moves = gradient.slopes[:, places] * reach
    spreads = [
        _spread(
            quantity,
            f.units[k],
            float(gradient.value[k]),
            moves[k],
            tuple(sizes),
            drawn.value[ok, k],
        )
        for k, quantity in enumerate(f.quantities)
    ]
    ranked = sorted(spreads, key=lambda spread: -_relative(spread))
    return Spreads(
        scene.name,
        sizes,
        samples,
        int(np.count_nonzero(~ok)),
        {spread.quantity: spread for spread in ranked},
    )


def _spread(
    quantity: str, unit: str, nominal: float, moves: Array, names: Sequence[str], values: Array
) -> Spread:
    # The sign of a peak may turn where two are nearly as large.
    values = values * np.sign(values) * (np.sign(nominal) or 1.0)
    variances = moves**2 / 3.0
    total = float(variances.sum())
    shares = variances / total if total > 0.0 else np.zeros_like(variances)
    order = sorted(range(len(names)), key=lambda k: -shares[k] if shares[k] == shares[k] else 0.0)
    finite = values.size > 0 and bool(np.isfinite(values).all())
    mean, deviation, low, high = (
        (float(x) for x in (values.mean(), values.std(), values.min(), values.max()))
        if finite
        else (float("nan"),) * 4
    )
    by_name = {names[k]: float(shares[k]) for k in order}
    return Spread(
        quantity,
        unit,
        nominal,
        float(np.abs(moves).sum()),
        total**0.5,
        by_name,
        mean,
        deviation,
        low,
        high,
    )


def _relative(spread: Spread) -> float:
    share = spread.sigma / abs(spread.nominal) if spread.nominal else 0.0
    return share if np.isfinite(share) else -1.0
