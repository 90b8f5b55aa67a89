"""The derivatives of a solution in a file: under /sensitivity/PARAMETER the same places that what
they are of has under /.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import h5py
import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.wanted_names import SENSITIVITY
from ..derivatives import Derivatives, derivatives
from ..histories import Histories
from ..solution import Solution
from .dataset_words import place_of, say, unlike, without_scale
from .scales import Scales
from .untrusted import numbers


def add_slopes(
    file: h5py.File,
    scales: Scales,
    solution: Solution,
    create: Callable[[str, tuple[int, ...]], h5py.Dataset],
) -> None:
    """Write all; ``create`` makes an empty dataset at a place, of a shape."""
    for found in derivatives(solution, solution.sensitivities):
        dataset = create(place_of(found.name), found.values.shape)
        dataset[...] = found.values
        say(dataset, found.unit, found.attributes)
        scales.attach(dataset, found.output.quantity.axes)


def slopes_of(file: h5py.File, histories: Histories) -> Derivatives:
    """Read the sensitivities of a file.

    Raises ``ValueError`` where it is not whole.
    """
    group = file.get(SENSITIVITY, {})
    lengths = {"t": histories.t.size, "xi": histories.xi.size}
    expected = [output for output in histories.quantities() if histories.determined(output)]
    found: dict[str, dict[Output, Array]] = {}
    places: list[str] = []
    if group:
        group.visititems(
            lambda place, item: places.append(place) if isinstance(item, h5py.Dataset) else None
        )
    if set(group) - histories.description.parameters.keys():
        raise ValueError("there are sensitivities by names that are not parameters")
    expected_names = {f"{name}/{place_of(o)}": (name, o) for name in group for o in expected}
    if set(places) != set(expected_names):
        raise ValueError("the sensitivities are not of all quantities")
    for place, (name, output) in expected_names.items():
        shape = tuple(lengths[axis] for axis in output.quantity.axes)
        found.setdefault(name, {})[output] = numbers(group[place], shape)
    return Derivatives(
        {name: found[name] for name in histories.description.parameters if name in found}
    )


def check_slopes(file: h5py.File, solution: Solution) -> Iterator[str]:
    """Faults of a file's sensitivities: they must be finite where their quantities are, in their
    units, on their axes.
    """
    for found in derivatives(solution, solution.sensitivities):
        place, rests = (
            place_of(found.name),
            solution.resting.reshape(-1, *[1] * (found.values.ndim - 1)),
        )
        if not (np.isfinite(found.values) | (rests & np.isnan(found.values))).all():
            yield f"{place}: values that are not finite"
        yield from unlike(file[place], found.unit, found.attributes)
        yield from without_scale(file[place], found.output.quantity.axes)
